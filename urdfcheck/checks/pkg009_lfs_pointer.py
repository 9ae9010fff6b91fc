"""PKG009 reports mesh files that are only Git LFS pointers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.resources import ResourceUse, list_resource_uses
from urdfcheck.source.text.engine_reactions import describe_unread_visuals, describe_unreadable_mesh, name_lost_shapes
from urdfcheck.source.text.globs import match_any_pattern, split_relative_path
from urdfcheck.source.uses_elsewhere import KEPT_ASIDE, explain_kept_file
from urdfcheck.system.files import read_start

POINTER = b"version https://git-lfs.github.com/spec/"
_SIZE = re.compile(rb"^size (\d+)$", re.MULTILINE)
# A pointer of the format's first version has 130 bytes; its specification allows up to 1024.
_MAX_POINTER_BYTES = 1024
# What tells git to fetch files from LFS, and how much of the file that says it is read.
_TRACKED, _MAX_ATTRIBUTE_BYTES = "filter=lfs", 65_536
# What a plain `git lfs pull` fetches, in a file of settings.
_FETCHED = re.compile(rb"^[ \t]*fetch(?:ex|in)clude[ \t]*=", re.MULTILINE | re.IGNORECASE)
# Only a file below the root of the clone says so, perhaps in a copy of another repository, or none of its patterns fits.
_DOUBTFUL = "doubtful"


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    """Report each repository once: one command repairs all of its files that it keeps in LFS."""
    sizes: dict[Path, int | None] = {}
    by_source: dict[tuple[Path | None, str], list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        path = use.resource.path
        if use.attribute.owner.tag != "mesh" or path is None or not use.resource.exists:
            continue
        if path not in sizes:
            sizes[path] = _read_pointer_size(path)
        if sizes[path] is not None:
            repository = _find_repository(path)
            tracked = "archive" if repository is None else _find_tracking(path, repository)
            by_source.setdefault((repository, tracked), []).append(use)
    for (repository, tracked), uses in by_source.items():
        parts = [use.attribute.owner for use in uses]
        paths = list(dict.fromkeys(use.resource.path for use in uses if use.resource.path is not None))
        yield rule.finding(
            "pointer" if len(paths) == 1 else "pointers",
            at=uses[0],
            related=uses[1:],
            severity=Severity.INFO if explain_kept_file(source) == KEPT_ASIDE else None,
            cause="clone" if tracked == _DOUBTFUL else tracked,
            path=format_path(paths[0]),
            count=len(paths),
            listed=join_names((path.name for path in paths), 4),
            files=[format_path(path) for path in paths],
            consequences=describe_unreadable_mesh(parts) | describe_unread_visuals(parts),
            lost=name_lost_shapes(parts),
            bytes=sum(sizes[path] or 0 for path in paths),
            repository=None if repository is None else format_path(repository),
            repair=_describe_repair(repository, tracked),
        )


def _describe_repair(repository: Path | None, tracked: str) -> str:
    if tracked == "copy":
        return "copy the mesh itself from the repository that has it"
    where = "a clone of the repository" if repository is None else format_path(repository)
    options = ' --include="*" --exclude=""' if repository is not None and _leaves_files_out(repository) else ""
    pull = f"run `git lfs install`, then `git lfs pull{options}`, in {where}"
    pull += ": its .lfsconfig leaves files out of a plain pull" if options else ""
    return (
        f"{pull}; if they stay pointers, copy the meshes from the repository that has them"
        if tracked == _DOUBTFUL
        else pull
    )


def _leaves_files_out(repository: Path) -> bool:
    """Whether the settings of a repository for LFS say which files are fetched, or not."""
    settings = repository / ".lfsconfig"
    try:
        return settings.exists() and _FETCHED.search(read_start(settings, _MAX_ATTRIBUTE_BYTES)) is not None
    except OSError:
        return False


def _read_pointer_size(path: Path) -> int | None:
    """Return the size in bytes of the file that a pointer replaces, or None if the file is not a pointer."""
    try:
        start = read_start(path, _MAX_POINTER_BYTES)
    except OSError:
        return None
    if not start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(POINTER):
        return None
    size = _SIZE.search(start.replace(b"\r", b""))
    return int(size[1]) if size else 0


def _find_tracking(path: Path, repository: Path) -> str:
    """Return whether git fetches a file from LFS: ``clone`` if the ``.gitattributes`` at the root of its clone names it.

    ``copy`` if none in the clone mentions LFS, else `_DOUBTFUL`. One that cannot be read may say so.
    """
    folders = (repository, *(folder for folder in path.parents if repository in folder.parents))
    tracked = {folder: patterns for folder in folders if (patterns := _list_tracked_patterns(folder)) != []}
    if not tracked:
        return "copy"
    patterns = tracked.get(repository, [])
    # A name in quotes or a macro may mean any.
    is_named = patterns is None or any(pattern[0] in '"[' for pattern in patterns)
    is_named = is_named or match_any_pattern(patterns or [], split_relative_path(path, repository))
    return "clone" if is_named else _DOUBTFUL


def _list_tracked_patterns(folder: Path) -> list[str] | None:
    """Return what the ``.gitattributes`` of a folder names as files of LFS; None if it cannot be read."""
    attributes = folder / ".gitattributes"
    try:
        text = read_start(attributes, _MAX_ATTRIBUTE_BYTES) if attributes.exists() else b""
    except OSError:
        return None
    lines = [line.split() for line in text.decode("utf-8", "replace").splitlines() if _TRACKED in line]
    return [words[0] for words in lines if not words[0].startswith("#")]


def _find_repository(path: Path) -> Path | None:
    """Return the clone that contains a file, or None outside a clone, e.g. in an unpacked archive."""
    return next((folder for folder in path.parents if (folder / ".git").exists()), None)
