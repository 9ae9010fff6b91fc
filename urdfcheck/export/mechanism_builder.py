"""A model as a `RobotMechanism`, to compare it with another version of itself."""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError, Span
from urdfcheck.core.mechanism import (
    NO_TRACE,
    MechanismCondition,
    MechanismExtra,
    MechanismJoint,
    MechanismLink,
    MechanismShape,
    MechanismStance,
    RobotMechanism,
    Trace,
)
from urdfcheck.export.outline import normalize_path, normalize_value
from urdfcheck.export.scene_builder import find_color
from urdfcheck.model import Model
from urdfcheck.model.parts import GROUND_NAMES, TENSOR_NAMES, Inertial, Joint, Link, Pose, Shape
from urdfcheck.model.shapes.solids import compute_drawn_scale, measure_shape_solid
from urdfcheck.source.text.values import is_computable, parse_numbers, read_attribute_number
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS
from urdfcheck.source.xacro.usage import collect_definitions, list_definitions

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# What a link and a joint hold that is compared as physics; anything else in them is compared as it is written.
_KNOWN_TAGS = {
    "link": frozenset({"inertial", "visual", "collision"}),
    "joint": frozenset({"origin", "parent", "child", "axis", "limit", "mimic", "dynamics"}),
    "inertial": frozenset({"origin", "mass", "inertia"}),
    **dict.fromkeys(("visual", "collision"), frozenset({"origin", "geometry", "material"})),
}
_KNOWN_ATTRIBUTES = {
    "limit": frozenset({"lower", "upper", "effort", "velocity"}),
    "dynamics": frozenset({"damping", "friction"}),
    "mimic": frozenset({"joint", "multiplier", "offset"}),
}
# How many numbers the attributes hold that are compared as physics; origins and axes of joints must be readable anyway.
_NUMBERS = {
    **dict.fromkeys(("xyz", "rpy", "size", "scale"), 3),
    "quat_xyzw": 4,
    **dict.fromkeys(("value", *TENSOR_NAMES, "radius", "length"), 1),
    **dict.fromkeys((*_KNOWN_ATTRIBUTES["limit"], *_KNOWN_ATTRIBUTES["dynamics"], "multiplier", "offset"), 1),
}
# What a link may have several of from several blocks.
_REPEATABLE = frozenset({"plugin", "sensor"})
_LIMITED = frozenset({"revolute", "prismatic"})
_KNOWN_TYPES = frozenset({"fixed", "revolute", "continuous", "prismatic", "planar", "floating"})


def build_mechanism(model: Model, model_id: str) -> RobotMechanism:
    """Build the mechanism of a model.

    :raises FactUnavailableError: when links and joints are not one tree, or a joint has no type, pose or axis to compute with.
    """
    tree = model.tree
    return RobotMechanism(
        model=model_id,
        name=model.name,
        root=tree.root,
        name_trace=_trace_attributes([model.robot.attributes.get("name")]) or _trace_element(model.robot),
        links=tuple(_build_link(model, model.link_by_name[name]) for name in tree.order),
        joints=tuple(_build_joint(tree.parent_joint[name]) for name in tree.order[1:]),
        is_grounded=tree.root in GROUND_NAMES,
        stance=_find_stance(model),
        extras=tuple(_iter_extras(model)),
        main_file=model.source.name,
        digests={
            name: hashlib.sha256(file.text.encode("utf-8", "surrogatepass")).hexdigest()
            for name, file in model.source.files.items()
        },
        idle_lines=dict(_list_idle_lines(model)),
        conditions=tuple(_list_conditions(model)),
    )


def _find_stance(model: Model) -> MechanismStance | None:
    """Return how the robot stands; None where it does not, or where that is not known."""
    from urdfcheck.model.ground.stance import find_stance  # loads numpy

    try:
        found = find_stance(model)
    except FactUnavailableError:
        return None
    if found is None:
        return None
    touching = {model.tree.order[owner] for owner in found.owners[found.now.touching].tolist()}
    return MechanismStance(
        margin=found.now.margin,
        tip_angle=found.now.tip_angle,
        tilt=found.measure_rest_tilt(found.com).tilt,
        polygon=tuple(tuple(map(float, corner)) for corner in found.now.polygon),
        supports=tuple(name for name in model.tree.order if name in touching),
        com=tuple(map(float, found.com)),
    )


# -- links -------------------------------------------------------------------------------------------------------------


def _build_link(model: Model, link: Link) -> MechanismLink:
    inertial = link.inertial
    shapes = tuple(_build_shape(model, shape) for shape in (*link.visuals, *link.collisions))
    traces = {"link": _trace_element(link.element)}
    if inertial is None:
        return MechanismLink(name=link.name, mass=None, shapes=shapes, traces=traces)
    tensor = inertial.tensor_in_link
    return MechanismLink(
        name=link.name,
        mass=inertial.mass,
        com=inertial.origin.xyz or (),
        tensor=() if tensor is None else _list_components(tensor),
        has_inertial=True,
        shapes=shapes,
        traces={**traces, **_trace_inertial(inertial)},
    )


def _list_components(tensor: Array) -> tuple[float, ...]:
    from urdfcheck.facts.inertials.inertia_tensor import list_inertia_components

    return tuple(list_inertia_components(tensor))


def _trace_inertial(inertial: Inertial) -> dict[str, Trace]:
    whole = _trace_element(inertial.element)
    origin, tensor = inertial.origin, inertial.tensor_element
    components = [] if tensor is None else [tensor.attributes.get(name) for name in TENSOR_NAMES]
    return {
        "mass": _trace_attributes([inertial.mass_attribute]) or whole,
        "com": _trace_attributes([origin.get_attribute("xyz")]) or whole,
        # A turned inertial frame turns the tensor.
        "tensor": _trace_attributes([*components, origin.get_attribute("rpy")]) or whole,
    }


def _build_shape(model: Model, shape: Shape) -> MechanismShape:
    import numpy as np

    pose, use, facts = shape.origin.matrix, model.meshes.by_shape.get(id(shape)), model.meshes.get_facts(shape)
    size = compute_drawn_scale(model, shape) or shape.size or ()
    path = None if use is None else use.resource.path
    solid = measure_shape_solid(model, shape)
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    if facts is not None and len(size) == 3:
        corners = np.sort(facts.bounds * np.array(size), axis=0)
        low, high = (tuple(map(float, corner)) for corner in corners)
    texture = shape.element.find_child("material")
    texture = None if texture is None else texture.find_child("texture")
    whole = _trace_element(shape.element)
    geometry = shape.geometry_element
    material = shape.element.find_child("material")
    return MechanismShape(
        role=shape.role,
        kind=shape.kind or "",
        size=tuple(map(float, size)),
        pose=() if pose is None else _flatten(pose),
        mesh="" if shape.mesh_filename is None else _name_file(model, shape.mesh_filename.value),
        digest="" if path is None else model.meshes.digests.get(path, ""),
        file=str(path) if path in model.meshes.digests else "",
        low=low,
        high=high,
        volume=None if solid is None else float(solid.volume),
        closed=None if facts is None else bool(facts.closed),
        color=find_color(model, shape) or (),
        texture="" if texture is None else _name_file(model, texture.get("filename")),
        traces={
            "shape": whole,
            "pose": _trace_pose(shape.origin) or whole,
            "geometry": whole if geometry is None else _trace_attributes(geometry.attributes.values()) or whole,
            "material": whole if material is None else _trace_material(model, material),
        },
    )


# -- joints ------------------------------------------------------------------------------------------------------------


def _build_joint(joint: Joint) -> MechanismJoint:
    pose = joint.origin.matrix
    if pose is None:
        raise FactUnavailableError(f"the origin of joint {joint.name!r} is malformed")
    if joint.type not in _KNOWN_TYPES:
        raise FactUnavailableError(f"joint {joint.name!r} has no known type")
    limited = joint.type in _LIMITED and joint.limit is not None
    lower, upper = (joint.get_limit_value(name) if limited else None for name in ("lower", "upper"))
    dynamics, mimic = joint.element.find_child("dynamics"), joint.mimic
    return MechanismJoint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        pose=_flatten(pose),
        axis=_normalize_axis(joint),
        lower=lower,
        upper=upper,
        effort=None if joint.type == "fixed" else joint.get_limit_value("effort"),
        velocity=None if joint.type == "fixed" else joint.get_limit_value("velocity"),
        damping=read_attribute_number(dynamics, "damping") or 0.0,
        friction=read_attribute_number(dynamics, "friction") or 0.0,
        mimic=None if mimic is None or joint.type == "fixed" else _read_mimic(mimic),
        traces=_trace_joint(joint),
    )


def _normalize_axis(joint: Joint) -> tuple[float, ...]:
    """Return the unit axis; empty for a joint without one.

    :raises FactUnavailableError: when it is malformed or zero.
    """
    import numpy as np

    if not joint.has_axis:
        return ()
    length = 0.0 if joint.axis is None else float(np.linalg.norm(joint.axis))
    if joint.axis is None or length == 0.0:
        raise FactUnavailableError(f"the axis of joint {joint.name!r} is malformed or zero")
    return tuple(float(value) / length for value in joint.axis)


def _read_mimic(mimic: Element) -> tuple[str, float, float]:
    multiplier, offset = read_attribute_number(mimic, "multiplier"), read_attribute_number(mimic, "offset")
    return mimic.get("joint"), 1.0 if multiplier is None else multiplier, 0.0 if offset is None else offset


def _trace_joint(joint: Joint) -> dict[str, Trace]:
    element = joint.element
    whole = _trace_element(element)

    def trace(tag: str, *names: str) -> Trace:
        child = element.find_child(tag)
        if child is None:
            return whole
        return _trace_attributes(child.attributes.get(name) for name in names) or _trace_element(child)

    return {
        "joint": whole,
        "type": _trace_attributes([element.attributes.get("type")]) or whole,
        "parent": trace("parent", "link"),
        "child": trace("child", "link"),
        "pose": trace("origin", "xyz", "rpy", "quat_xyzw"),
        "axis": trace("axis", "xyz"),
        "mimic": trace("mimic", "joint", "multiplier", "offset"),
        **{name: trace("limit", name) for name in ("lower", "upper", "effort", "velocity")},
        **{name: trace("dynamics", name) for name in ("damping", "friction")},
    }


# -- everything else ---------------------------------------------------------------------------------------------------


def _iter_extras(model: Model) -> Iterator[MechanismExtra]:
    set_before: Counter[tuple[str, str]] = Counter()
    for element in model.robot.children:
        if element.tag in {"link", "joint"}:
            yield from _iter_unknown_parts(model, element)
            yield from _iter_unreadable_values(model, element)
        elif element.tag != "material":  # the shapes that use it have its colour
            number = element.get("reference") or element.get("name")
            label = f"{element.tag}[{number}]" if number else element.tag
            # Of values that several blocks set, it matters which block comes first.
            keys = {(label, child.tag) for child in element.children if child.tag not in _REPEATABLE}
            place = max((set_before[key] for key in keys), default=0) if element.tag == "gazebo" else 0
            set_before.update(keys)
            yield _build_extra(model, element, f"{label}, block {place + 1}" if place else label)


def _iter_unknown_parts(model: Model, element: Element) -> Iterator[MechanismExtra]:
    """Yield what a link or joint holds that is not compared as physics, and the names of its shapes, which sensors refer to."""
    for child in element.children:
        if child.tag not in _KNOWN_TAGS[element.tag]:
            yield _build_extra(model, child, f"{element.label}/{child.tag}")
            continue
        for inner in child.children if child.tag in _KNOWN_TAGS else ():
            if inner.tag not in _KNOWN_TAGS[child.tag]:
                yield _build_extra(model, inner, f"{element.label}/{child.tag}/{inner.tag}")
        for name, attribute in child.attributes.items():
            if name not in _KNOWN_ATTRIBUTES.get(child.tag, child.attributes):
                label, content = f"{element.label}/{child.tag}@{name}", f"{_normalize_words(model, attribute.value)}"
                yield MechanismExtra(label=label, content=content, trace=_trace_attributes([attribute]) or NO_TRACE)
        if child.tag in {"visual", "collision"} and child.get("name"):
            named = _trace_attributes([child.attributes["name"]]) or NO_TRACE
            yield MechanismExtra(label=f"{child.tag}[{child.get('name')}]", content="", trace=named)


def _iter_unreadable_values(model: Model, element: Element) -> Iterator[MechanismExtra]:
    """Yield the values of a link or joint with which nothing can be computed: they are compared as they are written."""
    for child in element.children:
        for part in child.walk() if child.tag in _KNOWN_TAGS[element.tag] else ():
            for name, attribute in part.attributes.items():
                numbers = parse_numbers(attribute.value, _NUMBERS[name]) if name in _NUMBERS else ()
                if numbers is None or not all(map(is_computable, numbers)):
                    where = child.tag if part is child else f"{child.tag}/{part.tag}"
                    yield MechanismExtra(
                        label=f"unreadable {element.label}/{where}@{name}",
                        content=f"{_normalize_words(model, attribute.value)}",
                        trace=_trace_attributes([attribute]) or NO_TRACE,
                    )


def _name_file(model: Model, value: str) -> str:
    """Return the name of a file as other copies of the package would call it."""
    path = Path(value.strip().removeprefix("file://"))
    name = normalize_path(model, value)
    if "://" in name or not path.is_absolute():
        return name
    try:
        return Path(os.path.relpath(path, model.source.path.absolute().parent)).as_posix()
    except ValueError:  # another drive
        return name


def _normalize_words(model: Model, text: str) -> tuple[str, ...]:
    """Return the words of a text, numbers and the names of files each in one notation."""
    named = (_name_file(model, word) if word.startswith(("/", "file://")) else word for word in text.split())
    return normalize_value(" ".join(named))


def _build_extra(model: Model, element: Element, label: str) -> MechanismExtra:
    spans = [part.span for part in element.walk() if part.span is not None]
    return MechanismExtra(
        label=label,
        content="".join(_iter_content(model, element)),
        trace=Trace(tuple(dict.fromkeys((*spans, *_list_definitions(element)))), tuple(reversed(element.via))),
    )


def _list_definitions(element: Element) -> list[Span]:
    return [d.span for part in element.walk() for d in part.collect_definitions() if d.span is not None]


def _iter_content(model: Model, element: Element) -> Iterator[str]:
    """Yield a description of an element in which notation, comments and the order of attributes do not count."""
    yield f"<{element.tag}"
    for name, attribute in sorted(element.attributes.items()):
        yield f" {name}={_normalize_words(model, attribute.value)}"
    yield f">{_normalize_words(model, element.text)}"
    for child in element.children:
        yield from _iter_content(model, child)
    yield "</>"


# -- what the expansion leaves out -------------------------------------------------------------------------------------


def _list_idle_lines(model: Model) -> Iterator[tuple[str, frozenset[int]]]:
    """Yield the names of the files that xacro expanded, with the lines of tags that made nothing."""
    if not model.source.is_xacro:
        return
    used: set[tuple[str, int]] = set()
    for element in model.robot.walk():
        used.update(_list_lines((element.span, *element.via)))
    for name, tree in model.source.trees.items():
        typed = _list_lines(e.span for e in tree.walk() if e is not tree and _makes_elements(e))
        idle = frozenset(line for file, line in set(typed) - used if file == name)
        if idle:
            yield name, idle


def _list_conditions(model: Model) -> Iterator[MechanismCondition]:
    definitions = collect_definitions(model.source.trees)
    for tree in model.source.trees.values():
        for element in tree.walk():
            if element.tag in {"xacro:if", "xacro:unless"} and element.span is not None:
                lines = [inner.span.end_line for inner in element.walk() if inner.span is not None]
                read = list_definitions(definitions, element.get("value"))
                spans = tuple(definition.span for definition in read if definition.span is not None)
                yield MechanismCondition(tag=element.span, end=max(lines), definitions=spans)


def _list_lines(spans: Iterable[Span | None]) -> Iterator[tuple[str, int]]:
    return ((span.file, line) for span in spans if span is not None for line in range(span.line, span.end_line + 1))


def _makes_elements(element: Element) -> bool:
    """Whether an element of a xacro file is one of the robot, or calls a macro."""
    prefix, _, name = element.tag.partition(":")
    return prefix != "xacro" or name not in BUILT_IN_TAGS


# -- traces ------------------------------------------------------------------------------------------------------------


def _trace_element(element: Element) -> Trace:
    return Trace(() if element.span is None else (element.span,), tuple(reversed(element.via)))


def _trace_attributes(attributes: Iterable[Attribute | None]) -> Trace | None:
    """Return where attributes come from; None without any."""
    known = [attribute for attribute in attributes if attribute is not None and attribute.span is not None]
    if not known:
        return None
    typed = [attribute.span for attribute in known if attribute.span is not None]
    definitions = [d.span for attribute in known for d in attribute.collect_definitions() if d.span is not None]
    calls = [span for attribute in known for span in reversed(attribute.owner.via)]
    return Trace(tuple(dict.fromkeys((*typed, *definitions))), tuple(dict.fromkeys(calls)))


def _trace_pose(pose: Pose) -> Trace | None:
    found = _trace_attributes(pose.get_attribute(name) for name in ("xyz", "rpy", "quat_xyzw"))
    return found if found is not None or pose.element is None else _trace_element(pose.element)


def _trace_material(model: Model, material: Element) -> Trace:
    """Return where a material is typed, and the robot's material of its name, with colour and texture."""
    of_this_name = [
        other for other in model.robot.find_children("material") if other.get("name") == material.get("name")
    ]
    parts = [part for element in (material, *of_this_name) for part in element.walk()]
    spans = [span for part in parts for span in (part.span, *_list_definitions(part)) if span is not None]
    return Trace(tuple(dict.fromkeys(spans)), tuple(reversed(material.via)))


def _flatten(matrix: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in matrix.ravel())
