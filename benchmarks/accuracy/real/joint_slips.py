"""Mistakes in joints, limits, shapes and names. The first line of each function says what is done."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from injections import Array, Rng

from real.changes import Change, Part, format_numbers, is_literal, list_shapes, read_numbers, replace_value, write_all
from real.kinds import Kind, Make
from urdfcheck.model.parts import MOVING_TYPES, Joint
from urdfcheck.source.text.xml import Attribute, Element


def joint_rpy_off(part: Part, rng: Rng) -> list[Change] | None:
    """One angle of the joint's origin off by 2 to 20 degrees."""
    turn = np.eye(3)[rng.integers(3)] * np.radians(rng.uniform(2, 20)) * rng.choice((-1, 1))
    return _of_joint(part, "origin", "rpy", lambda rpy: rpy + turn)


def joint_xyz_off(part: Part, rng: Rng) -> list[Change] | None:
    """The joint's origin 5 to 30 mm beside its place."""
    away = rng.normal(size=3)
    return _of_joint(part, "origin", "xyz", lambda xyz: xyz + away / np.linalg.norm(away) * rng.uniform(5e-3, 3e-2))


def joint_xyz_sign(part: Part, rng: Rng) -> list[Change] | None:
    """The largest coordinate of the joint's origin with the other sign."""
    return _of_joint(part, "origin", "xyz", lambda xyz: xyz * np.where(np.arange(3) == np.abs(xyz).argmax(), -1, 1))


def joint_xyz_mm(part: Part, rng: Rng) -> list[Change] | None:
    """The joint's origin in millimetres."""
    return _of_joint(part, "origin", "xyz", lambda xyz: xyz * 1e3)


def joint_xyz_decimal(part: Part, rng: Rng) -> list[Change] | None:
    """The largest coordinate of the joint's origin ten times too large."""
    return _of_joint(part, "origin", "xyz", lambda xyz: xyz * np.where(np.arange(3) == np.abs(xyz).argmax(), 10, 1))


def joint_rpy_degrees(part: Part, rng: Rng) -> list[Change] | None:
    """The joint's angles in degrees."""
    return _of_joint(part, "origin", "rpy", np.degrees)


def axis_reversed(part: Part, rng: Rng) -> list[Change] | None:
    """The axis with the other sign."""
    return _of_joint(part, "axis", "xyz", lambda axis: -axis) if _moves(part) else None


def axis_permuted(part: Part, rng: Rng) -> list[Change] | None:
    """The axis along another coordinate."""
    return _of_joint(part, "axis", "xyz", lambda axis: np.roll(axis, rng.integers(1, 3))) if _moves(part) else None


def axis_zero(part: Part, rng: Rng) -> list[Change] | None:
    """The axis 0 0 0."""
    return _of_joint(part, "axis", "xyz", lambda axis: axis * 0) if _moves(part) else None


def limits_degrees(part: Part, rng: Rng) -> list[Change] | None:
    """Both limits of a revolute joint in degrees."""
    lower, upper = _limits(part, "revolute")
    return _write_limits(part, {"lower": lower * 180 / np.pi, "upper": upper * 180 / np.pi}) if upper > lower else None


def limits_swapped(part: Part, rng: Rng) -> list[Change] | None:
    """The lower limit above the upper one."""
    lower, upper = _limits(part, "revolute", "prismatic")
    return _write_limits(part, {"lower": upper, "upper": lower}) if upper > lower else None


def limits_equal(part: Part, rng: Rng) -> list[Change] | None:
    """Both limits 0."""
    lower, upper = _limits(part, "revolute", "prismatic")
    return _write_limits(part, {"lower": 0.0, "upper": 0.0}) if upper > lower else None


def limits_mirrored(part: Part, rng: Rng) -> list[Change] | None:
    """The limits of the other sense of rotation."""
    lower, upper = _limits(part, "revolute", "prismatic")
    return _write_limits(part, {"lower": -upper, "upper": -lower}) if upper > lower and upper != -lower else None


def effort_zero(part: Part, rng: Rng) -> list[Change] | None:
    """The effort limit 0."""
    return _write_limits(part, {"effort": 0.0}) if _moves(part) else None


def effort_tiny(part: Part, rng: Rng) -> list[Change] | None:
    """The effort limit a thousandth."""
    effort = None if part.joint is None else part.joint.get_limit_value("effort")
    return _write_limits(part, {"effort": effort / 1e3}) if effort and _moves(part) else None


def velocity_zero(part: Part, rng: Rng) -> list[Change] | None:
    """The velocity limit 0."""
    return _write_limits(part, {"velocity": 0.0}) if _moves(part) else None


def mesh_scale(part: Part, rng: Rng) -> list[Change] | None:
    """The visual mesh a thousand times too large or too small."""
    factor = float(rng.choice((1e3, 1e-3)))
    for shape in list_shapes(part, "visual"):
        element = shape.geometry_element
        if element is None or element.tag != "mesh" or shape.mesh_filename is None:
            continue
        scale = element.attributes.get("scale")
        if scale is not None:
            values = read_numbers(element, "scale")
            return None if values is None else write_all([(scale, values.tolist(), (values * factor).tolist())])
        name = shape.mesh_filename
        if not is_literal(name) or name.span is None:
            continue
        quote = part.owner.source.files[name.span.file].text[name.span.end]
        return [replace_value(name, f"{name.typed}{quote} scale={quote}{format_numbers([factor] * 3)}")]
    return None


def collision_shifted(part: Part, rng: Rng) -> list[Change] | None:
    """The collision shape 5 to 30 cm beside its place."""
    away = rng.normal(size=3)
    away *= rng.uniform(0.05, 0.3) / np.linalg.norm(away)
    for shape in list_shapes(part, "collision"):
        changes = _change(shape.origin.element, "xyz", lambda xyz: xyz + away)
        if changes and list_shapes(part, "visual"):
            return changes
    return None


def collision_size(part: Part, rng: Rng) -> list[Change] | None:
    """A collision box, cylinder or sphere three times as large."""
    for shape in list_shapes(part, "collision"):
        for name in ("size", "radius"):
            changes = _change(shape.geometry_element, name, lambda size: size * 3)
            if changes and list_shapes(part, "visual"):
                return changes
    return None


def child_typo(part: Part, rng: Rng) -> list[Change] | None:
    """A letter missing in the name of a joint's child."""
    return None if part.joint is None else _typo(part.joint.child_attribute, rng, 0)


def mesh_typo(part: Part, rng: Rng) -> list[Change] | None:
    """A letter missing in the name of a mesh file."""
    for shape in list_shapes(part, "visual"):
        name = shape.mesh_filename
        if name is not None:
            return _typo(name, rng, name.value.rfind("/") + 1, name.value.rfind("."))
    return None


def mesh_case(part: Part, rng: Rng) -> list[Change] | None:
    """The name of a mesh file in the other case."""
    for shape in list_shapes(part, "visual"):
        name = shape.mesh_filename
        if name is not None and name.span is not None and is_literal(name):
            start = name.value.rfind("/") + 1
            return [replace_value(name, name.typed[:start] + name.typed[start:].swapcase())]
    return None


def mimic_typo(part: Part, rng: Rng) -> list[Change] | None:
    """A letter missing in the name of the joint that another one follows."""
    element = None if part.joint is None else part.joint.element.find_child("mimic")
    return None if element is None else _typo(element.attributes.get("joint"), rng, 0)


def mimic_multiplier(part: Part, rng: Rng) -> list[Change] | None:
    """The multiplier of a mimic joint with the other sign."""
    # A fixed joint follows no other, whatever its <mimic> says.
    element = part.joint.element.find_child("mimic") if part.joint is not None and _moves(part) else None
    return _change(element, "multiplier", lambda value: -value)


def _moves(part: Part) -> bool:
    return part.joint is not None and part.joint.type in MOVING_TYPES


def _limits(part: Part, *types: str) -> tuple[float, float]:
    """Lower and upper limit of a joint of one of these types; twice zero without."""
    joint = part.joint
    if joint is None or joint.type not in types:
        return 0.0, 0.0
    return joint.get_limit_value("lower") or 0.0, joint.get_limit_value("upper") or 0.0


def _write_limits(part: Part, values: dict[str, float]) -> list[Change] | None:
    element = None if part.joint is None else part.joint.limit
    if element is None:
        return None
    pairs = []
    for name, value in values.items():
        old = read_numbers(element, name)
        if old is None:
            return None
        pairs.append((element.attributes.get(name), old.tolist(), [value]))
    return write_all(pairs)


def _of_joint(part: Part, tag: str, name: str, change: Callable[[Array], Array]) -> list[Change] | None:
    joint: Joint | None = part.joint
    return None if joint is None else _change(joint.element.find_child(tag), name, change)


def _change(element: Element | None, name: str, change: Callable[[Array], Array]) -> list[Change] | None:
    """Change the numbers of an attribute; None if it has none that are typed."""
    values = read_numbers(element, name)
    if element is None or values is None:
        return None
    return write_all([(element.attributes.get(name), values.tolist(), change(values).tolist())])


def _typo(attribute: Attribute | None, rng: Rng, start: int, end: int | None = None) -> list[Change] | None:
    """A letter missing between two places of the value."""
    if attribute is None or not is_literal(attribute):
        return None
    end = len(attribute.value) if end is None else end
    if end - start < 4 or len(attribute.typed) != len(attribute.value):
        return None
    at = int(rng.integers(start + 1, end))
    return [replace_value(attribute, attribute.typed[:at] + attribute.typed[at + 1 :])]


def _kinds(family: str, *kinds: tuple[Make, str, Sequence[str]]) -> tuple[Kind, ...]:
    lossy = (axis_zero, limits_equal, effort_zero, velocity_zero)
    twin = (joint_xyz_sign, joint_xyz_decimal)
    return tuple(
        Kind(make, family, says, frozenset(codes), is_lossy=make in lossy, needs_twin=make in twin)
        for make, says, codes in kinds
    )


_ODD = ("SYM001", "SYM002", "SYM004")
KINDS = (
    *_kinds(
        "joint",
        (joint_rpy_off, "", ("SYM001", "SYM004", "JNT013", "SYM006", "JNT015", "JNT021", "COL001")),
        (joint_xyz_off, "", (*_ODD, "COL001", "SYM006", "JNT021")),
        (joint_xyz_sign, r"\bsign\b|mirror", (*_ODD, "NAM005", "COL001")),
        (joint_xyz_mm, r"\bmm\b|millimet|1000", ()),
        (joint_xyz_decimal, r"decimal|ten times|10 times", (*_ODD,)),
        (joint_rpy_degrees, "", ("JNT012",)),
        (axis_reversed, r"axis|axes|opposite|sense", ("SYM004", "SYM005", "JNT021")),
        (axis_permuted, r"axis|axes", ("JNT015", "JNT021", "SYM001", "SYM004")),
        (axis_zero, "", ("JNT001",)),
    ),
    *_kinds(
        "limits",
        (limits_degrees, "", ("JNT006",)),
        (limits_swapped, "", ("JNT005",)),
        (limits_equal, "", ("JNT005",)),
        (limits_mirrored, r"limits", ("SYM004",)),
        (effort_zero, "", ("JNT007",)),
        (effort_tiny, r"effort", ("DYN002", "SYM004")),
        (velocity_zero, "", ("JNT007",)),
    ),
    Kind(limits_degrees, "limits", "", frozenset(("JNT006",)), habit=True),
    *_kinds(
        "shape",
        (mesh_scale, r"scale|times as large", ("MSH008",)),
        (collision_shifted, "", ("GEO003", "GEO005", "COL001", "JNT015")),
        (collision_size, r"times", ("GEO003", "SYM007")),
    ),
    *_kinds(
        "name",
        (child_typo, "", ("KIN002",)),
        (mesh_typo, "", ("PKG002",)),
        (mesh_case, "", ("PKG003", "PKG002")),
        (mimic_typo, "", ("JNT009",)),
        (mimic_multiplier, r"mimic|multiplier|follows", ("JNT009",)),
    ),
)
