"""JNT006 reports limits of revolute joints that are written in degrees."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_count, join_names, join_numbers
from urdfcheck.model import Joint, Model
from urdfcheck.model.repairs.edits import edit_literal
from urdfcheck.source.text.xml import Attribute

# Such numbers mean "no limit", and alone do not indicate degrees.
_PLACEHOLDERS = frozenset({1.0, 2.0, 5.0, 9.9, 9.99})
# Numbers of turns in radians have two decimals or more, and are turns to the last of their digits: 31.42, 31.41593.
_ROUNDING, _LAST_DIGITS = 0.02, 2.0
# Five turns in radians: the cables of a gimbal allow that.
_FEW_TURNS = 31.0


def check(
    model: Model, rule: Rule, *, least_angle: float, most_angle: float, least_speed: float, most_speed: float
) -> Iterator[Finding]:
    joints = [joint for joint in model.joints if joint.type == "revolute"]
    ranges = {joint: _read_magnitudes(joint, ("lower", "upper")) for joint in joints}
    # A few turns may be meant in a robot whose other ranges are radians.
    least = _FEW_TURNS if any(map(_is_radian_range, ranges.values())) else least_angle
    if any(_is_degree_range(sizes, least, most_angle) for sizes in ranges.values()):
        # 100 may mean "no limit", unless another joint of the robot shows the unit.
        alike = [joint for joint, sizes in ranges.items() if _can_be_degree_range(sizes, least_angle, most_angle)]
        mixed = [joint for joint in alike if _is_half_radian_range(ranges[joint])]
        if len(mixed) == len(alike) or any(map(_is_radian_range, ranges.values())):
            alike = [joint for joint in alike if joint not in mixed]
            if mixed:
                yield _build_lone_end_finding(rule, mixed)
        if alike:
            # ±15 may be turns: of a gimbal, or of a servo without a stop.
            is_sure = max(max(ranges[joint], default=0) for joint in alike) >= _FEW_TURNS
            names = "lower", "upper"
            yield _build_finding(model, rule, "range" if is_sure else "turns", joints=alike, names=names)
    # A rotor turns without end, however its joint is typed, and so fast.
    ranged = [joint for joint, sizes in ranges.items() if max(sizes, default=0) <= most_angle]
    speeds = {joint: size for joint in ranged for size in _read_magnitudes(joint, ("velocity",))}
    fast = {joint: size for joint, size in speeds.items() if least_speed < size <= most_speed and size % 5 == 0}
    meaningful = {size for size in fast.values() if not _is_placeholder(size)}
    if len(meaningful) > 1 or any(size % 45 == 0 for size in meaningful):
        yield _build_finding(model, rule, "speed", joints=list(fast), names=("velocity",))


def _read_limits(joint: Joint, names: Iterable[str]) -> list[float]:
    values = [joint.get_limit_value(name) for name in names]
    return [value for value in values if value is not None]


def _read_magnitudes(joint: Joint, names: Iterable[str]) -> list[float]:
    return [abs(value) for value in _read_limits(joint, names)]


def _is_degree_range(sizes: Sequence[float], least: float, most: float) -> bool:
    """Whether an end is too large for radians, and neither a placeholder nor a number of turns."""
    inside = max(sizes, default=0) <= most
    return inside and any(size >= least and not _is_placeholder(size) and not _is_quarter_turns(size) for size in sizes)


def _is_radian_range(sizes: Sequence[float]) -> bool:
    """Whether an end is about a quarter turn or more in radians, and has decimals: 2.967."""
    largest = max(sizes, default=0)
    return math.pi / 2 - _ROUNDING < largest < math.tau + _ROUNDING and any(size != round(size) for size in sizes)


def _is_half_radian_range(sizes: Sequence[float]) -> bool:
    """Whether one end is an angle in radians with decimals, and the other a whole number beyond a turn: ``0.94`` without its
    point is as likely as degrees."""
    return (
        len(sizes) > 1 and min(sizes) != round(min(sizes)) and max(sizes) == round(max(sizes)) > math.tau > min(sizes)
    )


def _can_be_degree_range(sizes: Sequence[float], least: float, most: float) -> bool:
    """Whether an end would be beyond a turn in radians; enough in a robot with degrees elsewhere."""
    largest = max(sizes, default=0)
    if not math.tau < largest <= most:
        return False
    # 10 means "no limit" in radians too.
    return largest >= least or all(size == round(size) and not _is_placeholder(size) for size in sizes if size)


def _is_placeholder(size: float) -> bool:
    """Whether a number is 1, 2 or 5 times a power of ten, or nines."""
    return round(size / 10 ** math.floor(math.log10(size)), 6) in _PLACEHOLDERS


def _is_quarter_turns(size: float) -> bool:
    """Whether a number is a multiple of a quarter turn in radians, such as the range of a winch, as far as its digits go."""
    decimals = len(f"{size:.15g}".partition(".")[2])
    slack = min(_ROUNDING, max(_LAST_DIGITS * 10.0**-decimals, 1e-9))
    return decimals > 0 and abs(size - round(size / (math.pi / 2)) * math.pi / 2) < slack


def _build_lone_end_finding(rule: Rule, joints: Sequence[Joint]) -> Finding:
    """Report the ends that are beyond radians; the other ends stay as they are, and no edit can know what was meant."""
    ends = [max(_list_typed_limits(joint, ("lower", "upper")), key=lambda end: abs(end[0])) for joint in joints]
    far = max(ends, key=lambda end: abs(end[0]))[0]
    worst = joints[[end[0] for end in ends].index(far)]
    typed = _read_limits(worst, ("lower", "upper"))
    finding = rule.finding(
        "point",
        at=ends[0][1],
        related=[attribute for _, attribute in ends[1:] if attribute.span != ends[0][1].span],
        joints=join_names(joint.name for joint in joints),
        count=format_count(len(joints), "joint has", "joints have"),
        worst=worst.name,
        typed=join_numbers(typed, separator=" to "),
        far=far,
        near=min(typed, key=abs),
        turns=abs(far) / math.tau,
        pointed=_restore_point(far),
        radians=math.radians(far),
    )
    return replace(finding, subjects=tuple(attribute.location.subject for _, attribute in ends))


def _list_typed_limits(joint: Joint, names: Iterable[str]) -> list[tuple[float, Attribute]]:
    """List the limits of a joint with where they are typed."""
    attributes = {} if joint.limit is None else joint.limit.attributes
    pairs = ((joint.get_limit_value(name), attributes.get(name)) for name in names)
    return [(value, attribute) for value, attribute in pairs if value is not None and attribute is not None]


def _restore_point(value: float) -> float:
    """Return the largest angle within a turn that has the digits of a number."""
    while abs(value) > math.tau:
        value /= 10
    return float(f"{value:.12g}")


def _build_finding(model: Model, rule: Rule, message: str, *, joints: Sequence[Joint], names: Sequence[str]) -> Finding:
    """Report all joints together: an author who typed degrees once typed them everywhere."""
    attributes = [
        joint.limit.attributes[name]
        for joint in joints
        for name in names
        if joint.limit is not None and name in joint.limit.attributes and joint.get_limit_value(name)
    ]
    worst = max(joints, key=lambda joint: max(map(abs, _read_limits(joint, names))))
    values = _read_limits(worst, names)
    in_xacro = model.source.is_xacro
    places = {attribute.span: attribute for attribute in attributes if attribute.span is not None}
    finding = rule.finding(
        message,
        at=attributes[0],
        related=[attribute for span, attribute in places.items() if span != attributes[0].span],
        edits=[
            edit
            for a in places.values()
            for edit in edit_literal(a, _format_radians(a, in_xacro=in_xacro))
            if message != "turns"
        ],
        joints=join_names(joint.name for joint in joints),
        count=format_count(len(joints), "joint has", "joints have"),
        worst=worst.name,
        typed=join_numbers(values, separator=" to "),
        turns=max(map(abs, values)) / math.tau,
        radians=join_numbers(map(math.radians, values), separator=" to "),
        rpm=max(map(abs, values)) * 60 / math.tau,
    )
    return replace(finding, subjects=tuple(attribute.location.subject for attribute in attributes))


def _format_radians(attribute: Attribute, *, in_xacro: bool) -> str:
    return f"${{radians({attribute.value.strip()})}}" if in_xacro else repr(math.radians(float(attribute.value)))
