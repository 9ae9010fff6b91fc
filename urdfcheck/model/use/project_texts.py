"""The texts of a project in which its robot may be named: manifests, launch files, scripts, worlds."""

from __future__ import annotations

import re

from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.uses_elsewhere import read_project_texts

_REMARK = re.compile(r"^[ \t]*#[^\n]*", re.MULTILINE)


@fact
def list_project_texts(model: Model) -> tuple[str, ...]:
    """List the texts of `read_project_texts` without comments."""
    return tuple(_drop_comments(text) for text in read_project_texts(model.source))


def _drop_comments(text: str) -> str:
    """Leave out comments: generated manifests mention Gazebo in theirs."""
    head, *rest = text.split("<!--")
    return _REMARK.sub("", head + "".join(piece.partition("-->")[2] for piece in rest))
