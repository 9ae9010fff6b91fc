"""CTL007 reports drive plugins of Gazebo whose wheels are not those of the model."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import find_nearest_name, format_name_hint, format_point, join_names
from urdfcheck.model.ground.drive_plugins import DrivePlugin, list_drive_plugins
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.uses_elsewhere import find_other_includers

# Without the share of odometry: the plugin publishes the true pose.
_TRUE_POSE = {
    "radius": "the robot drives faster or slower than commanded",
    "separation": "the robot turns by another angle than commanded",
    "narrow": "the robot turns by less than commanded",
}
# No ground makes the track of a skid steer so much narrower than it is.
_NARROW = 0.6

_UNNAMED = "write the names of the joints of this robot's wheels, or delete the plugin if something else drives it"
_NO_WHEELS = "give the robot wheels with continuous joints of these names (no joint of it moves), or delete the plugin"

if TYPE_CHECKING:
    from urdfcheck.model import Model
    from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    plugins = list(list_drive_plugins(model))
    for plugin in plugins:
        others = [other for other in plugins if other is not plugin]
        yield from _check_plugin(model, rule, plugin, others, rel_tol)


def _check_plugin(
    model: Model, rule: Rule, plugin: DrivePlugin, plugins: Sequence[DrivePlugin], rel_tol: float
) -> Iterator[Finding]:
    if not model.joints:
        return  # a part alone
    left, right = plugin.left, plugin.right
    unknown = [element for element in (*left, *right) if element.text.strip() not in model.joint_by_name]
    turning = {name for name, joint in model.joint_by_name.items() if joint.type != "fixed"}
    free = turning - {element.text.strip() for element in (*left, *right)}
    for element in unknown:
        name = element.text.strip()
        near = (
            _describe_list(model, name)
            or format_name_hint(name, free)
            or _format_fixed_hint(name, set(model.joint_by_name) - turning)
        )
        repair = f"write the name of a joint of the robot{near}" if near else _UNNAMED if turning else _NO_WHEELS
        repair += _describe_other_users(model, element, ())
        yield rule.finding("unknown", at=element, severity=Severity.ERROR, joint=name, near=near, repair=repair)
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

    if _turns_other_parts(model, plugin, plugins):
        return
    sides = [[element.text.strip() for element in side] for side in (left, right)]
    if are_wheels_sideways(model, *sides):
        yield _build_sideways_finding(model, rule, sides)
        return
    wheels = left[0].text.strip(), right[0].text.strip()
    for element, divisor in plugin.radii:
        radii = [radius for name in wheels for radius in measure_wheel_radii(model, name)]
        sizes = [divisor * radius for radius in radii]
        yield from _compare(model, rule, "radius", plugin, element, sizes, rel_tol=rel_tol, wheels=wheels)
    for element in plugin.separations if len(left) == len(right) == 1 else ():
        separations = measure_wheel_separations(model, *wheels)
        yield from _compare(model, rule, "separation", plugin, element, separations, rel_tol=rel_tol, wheels=wheels)
    if len(left) == len(right) > 1:
        yield from _check_skid_steer(model, rule, plugin, list(zip(*sides, strict=True)))


def _check_skid_steer(
    model: Model, rule: Rule, plugin: DrivePlugin, pairs: Sequence[tuple[str, str]]
) -> Iterator[Finding]:
    """Report a separation far below that of the narrowest pair of wheels: its track is tuned to the ground, but wheels that slip
    need a wider one."""
    from urdfcheck.model.ground.drive_wheels import measure_wheel_separations

    measured = [(sizes, pair) for pair in pairs if (sizes := measure_wheel_separations(model, *pair))]
    if len(measured) < len(pairs):
        return
    sizes, narrowest = min(measured, key=lambda found: min(found[0]))
    for element in plugin.separations:
        typed = parse_number(element.text.strip())
        if typed is not None and typed < _NARROW * min(sizes):
            yield from _compare(model, rule, "narrow", plugin, element, sizes, rel_tol=0.0, wheels=narrowest)


def _turns_other_parts(model: Model, plugin: DrivePlugin, others: Sequence[DrivePlugin]) -> bool:
    """Whether a plugin turns something else than the wheels of the robot (the drums of a mechanism): none of its joints has a
    wheel that can stand on the ground, and another plugin drives such wheels."""
    from urdfcheck.model.ground.wheels import rolling_wheels

    rolling = {wheel.joint.name for wheel in rolling_wheels(model)}
    return _collect_joints(plugin).isdisjoint(rolling) and any(
        not _collect_joints(o).isdisjoint(rolling) for o in others
    )


def _collect_joints(plugin: DrivePlugin) -> set[str]:
    return {element.text.strip() for element in (*plugin.left, *plugin.right)}


def _build_sideways_finding(model: Model, rule: Rule, sides: Sequence[Sequence[str]]) -> Finding:
    from urdfcheck.model.ground.drive_wheels import turn_with_axes

    names = [name for side in sides for name in side]
    joints = [model.joint_by_name[name] for name in names]
    repair = (
        "turn the joints of the wheels, and what is drawn or collides upright already back by as much,"
        if turn_with_axes(model, names)
        else "turn the joints of the wheels, or only their axes if the wheels are drawn and collide upright,"
    )
    return rule.finding(
        "sideways",
        at=joints[0].axis_location,
        related=[joint.axis_location for joint in joints[1:]],
        left=sides[0][0],
        right=sides[1][0],
        repair=repair,
        axis=format_point(model.axes[joints[0].name], decimals=3),
    )


def _describe_list(model: Model, text: str) -> str:
    """Say that a text holds several joints, where the plugin reads one name; nothing of any other."""
    names = re.split(r"[\s,;]+", text.strip(" ,;"))
    is_list = len(names) > 1 and all(name in model.joint_by_name for name in names)
    return f" (these are {len(names)} joints: write each in a separate element)" if is_list else ""


def _format_fixed_hint(name: str, fixed: Collection[str]) -> str:
    near = find_nearest_name(name, fixed)
    return f" ({near!r} is spelled like it, but is fixed)" if near else ""


def _compare(
    model: Model,
    rule: Rule,
    message: str,
    plugin: DrivePlugin,
    element: Element,
    sizes: list[float],
    *,
    rel_tol: float,
    wheels: tuple[str, str],
) -> Iterator[Finding]:
    from urdfcheck.model.ground.drive_wheels import find_other_size

    value = parse_number(element.text.strip())
    real = None if value is None else find_other_size(value, sizes, rel_tol=rel_tol)
    if value is not None and real is not None:
        yield rule.finding(
            message,
            at=element,
            consequences=None if plugin.integrates_wheels else {"gazebo": _TRUE_POSE[message]},
            shared=_describe_other_users(model, element, wheels),
            key=element.tag,
            value=value,
            real=real,
            off=abs(value - real) / real,
            left=wheels[0],
            right=wheels[1],
        )


def _describe_other_users(model: Model, element: Element, wheels: Sequence[str]) -> str:
    """Say which other robots include the file that a plugin is in without its wheels: a number may not fit them.

    They are not expanded, so whether their wheels have the same size is left open.
    """
    files = {span.file for name in wheels if (span := model.joint_by_name[name].element.span) is not None}
    if element.span is None or element.span.file in files or not element.via:
        return ""
    others = find_other_includers(model.source, element.span.file)
    if not others:
        return ""
    what = "wheels differ" if wheels else "joints have other names"
    whose = "includes this file too: if its" if len(others) == 1 else "include this file too: if their"
    return f"; {join_names(others)} {whose} {what}, make it an argument"
