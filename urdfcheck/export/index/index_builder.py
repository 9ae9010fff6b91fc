"""The index of a model's source, for editors."""

from __future__ import annotations

from urdfcheck.export.index.computed_texts import list_computed_texts
from urdfcheck.export.index.name_places import list_name_places
from urdfcheck.export.index.robot_parts import list_robot_parts
from urdfcheck.export.index.source_index import SourceIndex
from urdfcheck.model import Model
from urdfcheck.source.load import Source


def build_index(source: Source, model: Model | None, model_id: str) -> SourceIndex:
    """Build the index of a file. ``model``: the robot; None where there is none, and for a part of others."""
    return SourceIndex(
        model=model_id,
        files=tuple(source.files),
        names=list_name_places(source),
        texts=list_computed_texts(source),
        parts=() if model is None else list_robot_parts(model),
        is_expanded=model is not None,
    )
