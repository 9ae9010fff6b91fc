"""Where files beside a model name its links, joints and arguments: semantic descriptions, controllers, limits, launch files."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.export.index.source_index import ARGUMENT, JOINT, LINK, DoubtfulName, NamePlace
from urdfcheck.model import Model
from urdfcheck.source.load import Source
from urdfcheck.source.text.handed_values import find_handed_text, find_typed_value
from urdfcheck.source.text.xml import Attribute
from urdfcheck.source.xacro.usage import iter_elements_by_tag

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch
    from urdfcheck.source.ros.controllers import ControllerConfig
    from urdfcheck.source.ros.srdf import Srdf
    from urdfcheck.source.text.yaml.values import YamlValue


def iter_outside_names(model: Model, launches: Sequence[Launch]) -> Iterator[NamePlace]:
    """Yield the places of the model's links and joints in the files beside it that are about it."""
    from urdfcheck.model.motion.controllers import find_controller_configs, find_launched_configs  # these load numpy
    from urdfcheck.model.motion.planning_limits import load_joint_limits
    from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
    from urdfcheck.source.ros.srdf import is_about_model

    for srdf in semantic_descriptions(model):
        if is_about_model(srdf, model.source):
            yield from _iter_srdf_names(srdf)
            for limits in load_joint_limits(model, srdf):
                yield from _iter_yaml_names([limits.joint])
    launched = [found for launch in launches for found in find_launched_configs(launch, model)]
    for associated in (*find_controller_configs(model), *launched):
        yield from _iter_yaml_names(_iter_controller_joints(associated.configuration))
        for controller in associated.configuration.controllers:
            yield from _iter_yaml_names(_iter_yaml_frames(controller.parameters, model), LINK)
    for launch in launches:
        for transform in launch.transforms:
            for frame in (transform.parent, transform.child):
                yield from _iter_words(transform.at, frame, LINK, launch)
        for parameter, kind in _iter_naming_parameters(launch):
            yield from _iter_words(parameter, parameter.value.strip().lstrip("/"), kind, launch)


def _iter_naming_parameters(launch: Launch) -> Iterator[tuple[Attribute, str]]:
    """Yield the values of nodes' parameters that name a frame or a joint, where the launch file loads one model only."""
    from urdfcheck.source.launch.python_names import PREFIX_KEYS, classify_parameter

    parameters = [element for node in launch.nodes for element in node.children if element.tag == "param"]
    models = {os.path.realpath(found.path) for found in launch.descriptions if found.path is not None}
    if len(models) != 1 or any(element.get("name") in PREFIX_KEYS for element in parameters):
        return
    for element in parameters:
        kind, value = classify_parameter(element.get("name")), element.attributes.get("value")
        if kind and value is not None and "$" not in value.typed and value.value.strip():
            yield value, kind


def list_python_names(model: Model) -> tuple[tuple[NamePlace, ...], tuple[DoubtfulName, ...]]:
    """Return the places of the model's links and joints in the Python launch files around it, and those that may be others."""
    from urdfcheck.source.launch.model_launches import find_named_texts

    names = {LINK: {link.name for link in model.links}, JOINT: {joint.name for joint in model.joints}}
    found = list(find_named_texts(model.source.path, model.source.finder, names))
    return (
        tuple(NamePlace(text.kind, text.name, text.span, False) for text in found if not text.doubt),
        tuple(DoubtfulName(text.kind, text.name, text.span, text.doubt) for text in found if text.doubt),
    )


def _iter_srdf_names(srdf: Srdf) -> Iterator[NamePlace]:
    pairs = (*srdf.disabled_pairs, *srdf.enabled_pairs)
    links = [pair.get_link(index) for pair in pairs for index in (0, 1)]
    links += [element.attributes.get("link") for element in srdf.root.find_children("disable_default_collisions")]
    named = [(LINK, attribute) for attribute in links if attribute is not None]
    for kind, attribute in (*srdf.iter_part_names(), *named):
        if attribute.span is None or (kind == JOINT and attribute.value.strip() in srdf.virtual_joints):
            continue
        name = attribute.value.strip()
        typed = None if attribute.literal else find_typed_value(attribute) or find_handed_text(attribute, srdf.files)
        yield NamePlace(kind, name, attribute.span, False, is_handed=typed is not None)
        if typed is not None:
            yield NamePlace(kind, name, typed.span, False)


def _iter_controller_joints(configuration: ControllerConfig) -> Iterator[YamlValue]:
    """Yield the joints that controllers name, and the keys of their parameters that are the same names: gains, constraints."""
    for controller in configuration.controllers:
        yield from controller.joints
        known = {joint.text for joint in controller.joints}
        waiting = [controller.parameters]
        while waiting:
            for key, value in waiting.pop().entries:
                waiting.append(value)
                if key.text in known:
                    yield key


def _iter_yaml_frames(root: YamlValue, model: Model) -> Iterator[YamlValue]:
    """Yield the values that name a link as a frame: ``base_frame_id: base_link``."""
    from urdfcheck.source.launch.python_names import classify_parameter

    waiting = [root]
    while waiting:
        value = waiting.pop()
        waiting += value.items
        for key, inner in value.entries:
            waiting.append(inner)
            if classify_parameter(key.text) == LINK and inner.text in model.link_by_name:
                yield inner


def _iter_yaml_names(values: Iterator[YamlValue] | Sequence[YamlValue], kind: str = JOINT) -> Iterator[NamePlace]:
    for value in values:
        if value.source.text[value.span.start : value.span.end] == value.text:
            yield NamePlace(kind, value.text, value.span, False)


def _iter_words(attribute: Attribute, word: str, kind: str, launch: Launch) -> Iterator[NamePlace]:
    """Yield the places of a word in an attribute of a launch file."""
    span = attribute.span
    file = None if span is None else launch.files.get(span.file)
    if span is None or file is None:
        return
    # tf drops the slash before a frame.
    for match in re.finditer(
        rf"(?:(?<![\w/.$({{-])|(?<=\s/)|(?<=\A/)){re.escape(word)}(?![\w/.)}}-])", attribute.typed
    ):
        yield NamePlace(kind, word, file.make_span(span.start + match.start(), span.start + match.end()), False)


def iter_argument_names(source: Source, launches: Sequence[Launch]) -> Iterator[NamePlace]:
    """Yield where launch files pass values to the arguments of a model: ``prefix`` of ``prefix:=left``."""
    from urdfcheck.source.launch.model_launches import find_argument_names

    declared = {element.get("name") for element in iter_elements_by_tag(source.trees, "xacro:arg")}
    for name, span in find_argument_names(source.path, source.finder, launches) if declared else ():
        if name in declared:
            yield NamePlace(ARGUMENT, name, span, False)
