"""CTL007 reports drive plugins of Gazebo whose wheels are not those of the model."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import find_nearest_name, format_name_hint, format_point, join_names
from urdfcheck.model.ground.drive_plugins import DrivePlugin, list_drive_plugins
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.model import Model
    from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    for plugin in list_drive_plugins(model):
        yield from _check_plugin(model, rule, plugin, rel_tol)


def _check_plugin(model: Model, rule: Rule, plugin: DrivePlugin, rel_tol: float) -> Iterator[Finding]:
    left, right = plugin.left, plugin.right
    unknown = [element for element in (*left, *right) if element.text.strip() not in model.joint_by_name]
    turning = {name for name, joint in model.joint_by_name.items() if joint.type != "fixed"}
    free = turning - {element.text.strip() for element in (*left, *right)}
    for element in unknown:
        name = element.text.strip()
        near = format_name_hint(name, free) or _format_fixed_hint(name, set(model.joint_by_name) - turning)
        yield rule.finding("unknown", at=element, severity=Severity.ERROR, joint=name, near=near)
    fixed = [element for element in (*left, *right) if element.text.strip() in set(model.joint_by_name) - turning]
    if fixed:
        yield rule.finding(
            "fixed",
            at=fixed[0],
            related=[model.joint_by_name[element.text.strip()] for element in fixed],
            severity=Severity.ERROR,
            joint=fixed[0].text.strip(),
            joints=join_names(element.text.strip() for element in fixed),
        )
    if unknown or fixed or not left or not right:
        return
    from urdfcheck.model.ground.drive_wheels import are_wheels_sideways, measure_wheel_radii, measure_wheel_separations

    sides = [[element.text.strip() for element in side] for side in (left, right)]
    if are_wheels_sideways(model, *sides):
        yield _build_sideways_finding(model, rule, sides)
        return
    one, other = left[0].text.strip(), right[0].text.strip()
    for element, divisor in plugin.radii:
        radii = [radius for name in (one, other) for radius in measure_wheel_radii(model, name)]
        yield from _compare(rule, "radius", element, [divisor * radius for radius in radii], rel_tol, one, other)
    if len(left) == len(right) == 1:  # the track of a skid steer is tuned to the ground
        for element in plugin.separations:
            separations = measure_wheel_separations(model, one, other)
            yield from _compare(rule, "separation", element, separations, rel_tol, one, other)


def _build_sideways_finding(model: Model, rule: Rule, sides: Sequence[Sequence[str]]) -> Finding:
    joints = [model.joint_by_name[name] for side in sides for name in side]
    return rule.finding(
        "sideways",
        at=joints[0].axis_location,
        related=[joint.axis_location for joint in joints[1:]],
        left=sides[0][0],
        right=sides[1][0],
        axis=format_point(model.axes[joints[0].name], decimals=3),
    )


def _format_fixed_hint(name: str, fixed: Collection[str]) -> str:
    near = find_nearest_name(name, fixed)
    return f" ({near!r} is spelled like it, but is fixed)" if near else ""


def _compare(
    rule: Rule, message: str, element: Element, sizes: list[float], rel_tol: float, one: str, other: str
) -> Iterator[Finding]:
    value = parse_number(element.text.strip())
    if value is None or value <= 0 or not sizes or min(sizes) <= 0:
        return
    nearest = min(sizes, key=lambda size: abs(size - value))
    if abs(value - nearest) > rel_tol * nearest:
        yield rule.finding(
            message,
            at=element,
            key=element.tag,
            value=value,
            real=nearest,
            off=abs(value - nearest) / nearest,
            left=one,
            right=other,
        )
