"""The index of a model's source, for editors."""

from __future__ import annotations

from urdfcheck.export.index.computed_texts import list_computed_texts, list_yaml_keys
from urdfcheck.export.index.expanded_elements import iter_expanded_elements
from urdfcheck.export.index.name_places import iter_xacro_names
from urdfcheck.export.index.outside_names import iter_argument_names, iter_outside_names, list_python_names
from urdfcheck.export.index.robot_names import iter_robot_names
from urdfcheck.export.index.robot_parts import list_robot_parts
from urdfcheck.export.index.source_index import DoubtfulName, SourceIndex
from urdfcheck.export.index.yaml_key_names import iter_unread_keys, iter_yaml_key_names
from urdfcheck.model import Model
from urdfcheck.source.launch.model_launches import find_model_launches
from urdfcheck.source.load import Source


def build_index(source: Source, model: Model | None, model_id: str, *, with_expansion: bool = False) -> SourceIndex:
    """Build the index of a file.

    ``model``: the robot; None where there is none, and for a part of others. ``with_expansion``: whether the index holds the
    expanded robot.
    """
    launches = () if model is None else find_model_launches(source.path, source.finder)
    names = dict.fromkeys(iter_robot_names(source))
    if source.is_xacro:
        names.update(dict.fromkeys((*iter_xacro_names(source), *iter_argument_names(source, launches))))
    names.update(dict.fromkeys(iter_yaml_key_names(source)))
    doubtful: tuple[DoubtfulName, ...] = tuple(iter_unread_keys(source))
    if model is not None:
        names.update(dict.fromkeys(iter_outside_names(model, launches)))
        certain, others = list_python_names(model)
        names.update(dict.fromkeys(certain))
        doubtful += others
    keys = list_yaml_keys(source)
    outside = (span.file for span in (*(place.span for place in names), *(key.span for key in keys)))
    return SourceIndex(
        model=model_id,
        files=tuple(dict.fromkeys((*source.files, *outside))),
        names=tuple(names),
        texts=list_computed_texts(source),
        parts=() if model is None else list_robot_parts(model),
        is_expanded=model is not None,
        yaml_keys=keys,
        doubtful_names=doubtful,
        expansion=tuple(iter_expanded_elements(model.robot)) if with_expansion and model is not None else (),
    )
