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


@fact
def list_publishing_texts(model: Model, *, in_project: bool) -> tuple[str, ...]:
    """List the texts, without comments, of the launch files that start a static_transform_publisher: of the model's package and
    of those that depend on it, or of the whole project."""
    from urdfcheck.source.launch import model_launches  # few models name a frame that is no link

    source = model.source
    return tuple(model_launches.iter_publishing_texts(source.path, source.finder, in_project=in_project))
