"""JNT006 reports limits of revolute joints that are typed in degrees."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.xml import Attribute

# How people write that there is no limit: such a number alone is no sign of degrees.
_PLACEHOLDERS = frozenset({1.0, 2.0, 5.0, 9.9, 9.99})
# Numbers of turns in radians have two decimals or more.
_ROUNDING = 0.02


def check(
    model: Model, rule: Rule, *, least_angle: float, most_angle: float, least_speed: float, most_speed: float
) -> Iterator[Finding]:
    joints = [joint for joint in model.joints if joint.type == "revolute"]
    ranges = {joint: _read_magnitudes(joint, ("lower", "upper")) for joint in joints}
    if any(_is_degree_range(sizes, least_angle, most_angle) for sizes in ranges.values()):
        # 100 may mean "no limit", unless another joint of the robot tells the unit.
        alike = [joint for joint, sizes in ranges.items() if _can_be_degree_range(sizes, least_angle, most_angle)]
        yield _build_finding("range", alike, ("lower", "upper"), rule, model)
    speeds = {joint: size for joint in joints for size in _read_magnitudes(joint, ("velocity",))}
    fast = {joint: size for joint, size in speeds.items() if least_speed < size <= most_speed and size % 5 == 0}
    told = {size for size in fast.values() if not _is_placeholder(size)}
    if len(told) > 1 or any(size % 45 == 0 for size in told):
        yield _build_finding("speed", list(fast), ("velocity",), rule, model)


def _read_limits(joint: Joint, names: Iterable[str]) -> list[float]:
    found = [joint.get_limit_value(name) for name in names]
    return [value for value in found if value is not None]


def _read_magnitudes(joint: Joint, names: Iterable[str]) -> list[float]:
    return [abs(value) for value in _read_limits(joint, names)]


def _is_degree_range(sizes: Sequence[float], least: float, most: float) -> bool:
    """Whether an end is too large for radians, and neither a placeholder nor a number of turns."""
    inside = max(sizes, default=0) <= most
    return inside and any(size >= least and not _is_placeholder(size) and not _is_quarter_turns(size) for size in sizes)


def _can_be_degree_range(sizes: Sequence[float], least: float, most: float) -> bool:
    """Whether an end is beyond a turn in radians, in a robot that has degrees elsewhere."""
    largest = max(sizes, default=0)
    return math.tau < largest <= most and (largest >= least or all(size == round(size) for size in sizes))


def _is_placeholder(size: float) -> bool:
    """1, 2 or 5 times a power of ten, or nines."""
    return round(size / 10 ** math.floor(math.log10(size)), 6) in _PLACEHOLDERS


def _is_quarter_turns(size: float) -> bool:
    """Whether it is a multiple of a quarter turn in radians, as a winch has it."""
    return size != round(size) and abs(size - round(size / (math.pi / 2)) * math.pi / 2) < _ROUNDING


def _build_finding(message: str, joints: Sequence[Joint], names: Sequence[str], rule: Rule, model: Model) -> Finding:
    """One finding for all joints: who typed degrees once typed them everywhere."""
    attributes = [
        joint.limit.attributes[name]
        for joint in joints
        for name in names
        if joint.limit is not None and name in joint.limit.attributes and joint.get_limit_value(name)
    ]
    worst = max(joints, key=lambda joint: max(map(abs, _read_limits(joint, names))))
    values = _read_limits(worst, names)
    write: Callable[[Attribute], str] = _format_xacro_radians if model.source.is_xacro else _format_radians
    places = {attribute.span: attribute for attribute in attributes if attribute.span is not None}
    finding = rule.finding(
        message,
        at=attributes[0],
        related=[attribute for span, attribute in places.items() if span != attributes[0].span],
        edits=[Edit(a.span, a.typed, write(a)) for a in places.values() if a.literal and a.span is not None],
        joints=join_names(joint.name for joint in joints),
        count="1 joint has" if len(joints) == 1 else f"{len(joints)} joints have",
        worst=worst.name,
        typed=" to ".join(f"{value:g}" for value in values),
        turns=max(map(abs, values)) / math.tau,
        radians=" to ".join(f"{math.radians(value):.6g}" for value in values),
        rpm=max(map(abs, values)) * 60 / math.tau,
    )
    return replace(finding, subjects=tuple(attribute.location.subject for attribute in attributes))


def _format_xacro_radians(attribute: Attribute) -> str:
    return f"${{radians({attribute.value.strip()})}}"


def _format_radians(attribute: Attribute) -> str:
    return repr(math.radians(float(attribute.value)))
