"""The texts of a project in which its robot may be named: manifests, launch files, scripts, worlds."""

from __future__ import annotations

from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.source.uses_elsewhere import read_project_texts


@fact
def list_project_texts(model: Model) -> tuple[str, ...]:
    """List the texts of `read_project_texts` without comments."""
    return tuple(drop_comments(text) for text in read_project_texts(model.source))
