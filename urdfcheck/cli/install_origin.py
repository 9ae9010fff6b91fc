"""Where urdfcheck was installed from, for files that install the same elsewhere."""

from __future__ import annotations

import json

from urdfcheck.core.records import dataclass
from urdfcheck.version import __version__


@dataclass(frozen=True, slots=True, kw_only=True)
class InstallOrigin:
    """What installs the urdfcheck that runs here on another machine; empty where that is not known."""

    requirement: str = ""
    """What pip takes."""
    address: str = ""
    """The git repository, if it was installed from one."""
    revision: str = ""
    """The commit in the repository."""


def find_install_origin() -> InstallOrigin:
    """Return what pip recorded of the installation (PEP 610): a repository, an archive, or nothing, which means a package index.

    A folder or a file of this machine is unknown elsewhere, and so is a source tree that is not installed.
    """
    from importlib.metadata import PackageNotFoundError, distribution

    from urdfcheck.system.installation import name_distribution

    name = name_distribution()
    try:
        text = distribution(name).read_text("direct_url.json")
        origin = {} if text is None else json.loads(text)
    except (PackageNotFoundError, ValueError):
        return InstallOrigin()
    url, commit = origin.get("url", ""), origin.get("vcs_info", {}).get("commit_id", "")
    folder = origin.get("subdirectory")
    if commit and folder:  # of urdfcheck-core: the repository itself installs the full one
        return InstallOrigin(requirement=f"{name} @ git+{url}@{commit}#subdirectory={folder}")
    if commit:
        return InstallOrigin(requirement=f"git+{url}@{commit}", address=url, revision=commit)
    if not origin:
        return InstallOrigin(requirement=f"{name}=={__version__}")
    if "archive_info" in origin and url.startswith(("https://", "http://")):
        return InstallOrigin(requirement=f"{name} @ {url}")
    return InstallOrigin()
