"""GEO001 reports dimensions of shapes that are zero or negative."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Link, Model, Shape
from urdfcheck.model.fixed_joint_lumping import reduce_fixed_joints
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.model.rigid_bodies import compute_body_mass
from urdfcheck.model.use.gazebo_starts import is_only_for_classic
from urdfcheck.source.text.engine_reactions import describe_loss
from urdfcheck.source.text.handed_values import list_zero_sources
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import Attribute

# The attributes that hold dimensions, with the name of each of their numbers.
_DIMENSIONS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "box": {"size": ("x", "y", "z")},
    "cylinder": {"radius": ("",), "length": ("",)},
    "capsule": {"radius": ("",), "length": ("",)},
    "sphere": {"radius": ("",)},
    "mesh": {"scale": ("x", "y", "z")},
}

# MuJoCo, on a colliding shape, a mesh without volume, and a visual shape.
REFUSED = "refuses to compile: size must be positive in geom"
FLAT = "refuses to compile: mesh volume is too small"
SINGULAR = "refuses the file: a matrix is singular"
DRAWN = "loads it (it does not read visuals)"
# Drake on a sphere of radius 0, and coal on one of negative radius; other shapes differ.
POINT = "loads it as a point, which marks a contact"
INSIDE_OUT = "the sphere has a negative volume and collides only deep inside"
# Gazebo Classic on a box or a cylinder, which its own engines accept.
IN_CLASSIC = (
    "loads it in Classic, where nothing touches the shape; versions of before July 2020 crash where they draw it"
)
# The conversion to SDF drops a body without mass.
DROPPED = "drops the link, which has no mass, and the shape with it"
_REMOVE = "remove this <collision>, or write its real size"
_WRITE = "write the real {}, or remove this <collision>"
_GIVE = "{}, or leave this <collision> out there by <xacro:if>: the same line makes that of {}"
# They read the file by urdfdom, which does not know capsules.
THROUGH_URDFDOM = ("urdfdom", "gazebo", "pinocchio")
# Programs that load a sphere of radius 0 as the point that it is meant to be.
KNOW_POINTS = frozenset({"drake", "pinocchio"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    points: list[tuple[str, Attribute]] = []
    for link in model.links:
        for shape in (*link.visuals, *link.collisions):
            for name, parts in _DIMENSIONS.get(shape.kind or "", {}).items():
                attribute = None if shape.geometry_element is None else shape.geometry_element.attributes.get(name)
                values = None if attribute is None else parse_numbers(attribute.value, len(parts))
                if attribute is not None and values is not None:
                    sizes = dict(zip(parts, values, strict=True))
                    if shape.kind == "sphere" and shape.role == "collision" and not any(values):
                        points.append((link.name, attribute))
                    else:
                        yield from _check_dimensions(model, rule, shape, attribute, link=link, values=sizes)
    if points:
        yield _build_point_finding(model, rule, points)


def _build_point_finding(model: Model, rule: Rule, points: Sequence[tuple[str, Attribute]]) -> Finding:
    """Return one finding for the robot: a model that marks contacts by points does so for all of them."""
    meant = model.targets and set(model.targets) <= KNOW_POINTS
    finding = rule.finding(
        "point",
        at=points[0][1],
        related=[attribute for _, attribute in points[1:]],
        severity=Severity.INFO if meant else Severity.WARNING,
        spheres=format_count(len(points), "collision sphere has", "collision spheres have"),
        links=join_names(dict.fromkeys(name for name, _ in points)),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(attribute.location.subject for _, attribute in points)))


def _has_mass(model: Model, link: Link) -> bool:
    """Whether the link that Gazebo makes of this one has mass, as far as its joints are known."""
    try:
        bodies = reduce_fixed_joints(model).body_by_link
    except FactUnavailableError:
        bodies = {link.name: link.name}
    return bool(compute_body_mass(model, tuple(name for name, body in bodies.items() if body == bodies[link.name])))


def _has_elements_for_gazebo_alone(model: Model) -> bool:
    return model.robot.find_child("gazebo") is not None and model.robot.find_child("mujoco") is None


def _check_dimensions(
    model: Model, rule: Rule, shape: Shape, attribute: Attribute, *, link: Link, values: dict[str, float]
) -> Iterator[Finding]:
    mesh = shape.kind == "mesh"  # a negative scale mirrors it and is not a wrong size
    negative = [part for part, value in values.items() if value < 0 and not mesh]
    # A capsule without a cylinder between its caps is a sphere.
    may_be_zero = shape.kind == "capsule" and attribute.name == "length"
    zero = [part for part, value in values.items() if value == 0 and not may_be_zero]
    if not (negative or zero):
        return
    reactions = {"mujoco": DRAWN if shape.role == "visual" else FLAT if mesh else REFUSED}
    is_in_classic = bool(zero) and not mesh and is_only_for_classic(model)
    reactions |= {"gazebo": IN_CLASSIC} if is_in_classic else {}
    is_dropped = not _has_mass(model, link)
    reactions |= {"gazebo": DROPPED} if is_dropped else {}
    data: dict[str, Any] = {
        "link": link.name,
        "role": shape.role,
        "kind": shape.kind,
        "dimension": attribute.name,
        "value": attribute.value,
        "consequences": reactions,
    }
    if mesh:
        singular = shape.role == "visual" and len(zero) == len(values)
        reactions["yourdfpy"] = SINGULAR if singular else "loads it"
    if shape.kind == "capsule":
        reactions.update(dict.fromkeys(THROUGH_URDFDOM, describe_loss(shape.element)))
    if negative:
        if shape.kind == "sphere":
            reactions["pinocchio"] = INSIDE_OUT
        positive = " ".join(word.removeprefix("-") for word in attribute.typed.split())
        # What an expression computes has no minus sign to delete.
        repair = (
            f"write {attribute.name} without the minus sign"
            if attribute.literal
            else f"make {attribute.typed} positive, or what it computes with"
        )
        yield rule.finding("negative", at=attribute, edits=edit_numbers(attribute, positive), repair=repair, **data)
    elif zero and mesh:
        severity = Severity.WARNING if shape.role == "visual" else None
        yield rule.finding("flattened", at=attribute, severity=severity, axes=", ".join(zero), **data)
    elif zero and shape.role == "visual":
        if shape.kind == "sphere":
            reactions["drake"] = POINT
        yield rule.finding("drawn", at=attribute, severity=Severity.INFO, **data)
    elif zero:
        is_harmless = is_in_classic or (is_dropped and _has_elements_for_gazebo_alone(model))
        severity = Severity.WARNING if is_harmless else None
        repair = _describe_repair(model, shape, attribute)
        yield rule.finding("zero", at=attribute, severity=severity, repair=repair, **data)


def _describe_repair(model: Model, shape: Shape, attribute: Attribute) -> str:
    """Say what to do about a size of zero. Not to remove the shape where its text also makes one that has a size: what a macro
    was given is wrong."""
    for link in model.links:
        for other in link.collisions:
            element = other.geometry_element if other.element.span == shape.element.span is not None else None
            like = None if element is None else element.attributes.get(attribute.name)
            sizes = None if like is None else parse_numbers(like.value, len(like.value.split()))
            if sizes is not None and all(sizes):
                sources = join_names(list_zero_sources([attribute]))
                wrong = f"give {sources} another value than 0" if sources else f"write the real {attribute.name}"
                return _GIVE.format(wrong, link.name)
    return _REMOVE if _is_nothing(shape) else _WRITE.format(attribute.name)


def _is_nothing(shape: Shape) -> bool:
    """Whether all sizes of a shape are zero: nothing is meant to collide there."""
    element, named = shape.geometry_element, _DIMENSIONS.get(shape.kind or "", {})
    if element is None:
        return False
    sizes = [parse_numbers(element.get(name), len(parts)) for name, parts in named.items()]
    return not any(numbers is None or any(numbers) for numbers in sizes)
