"""JNT005 reports limits whose lower end is not below the upper one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.fixed_joint_lumping import find_preserved_names
from urdfcheck.model.gazebo import collect_plugin_texts, is_held_still, list_sensors
from urdfcheck.model.motion.controllers import collect_controlled_joints
from urdfcheck.model.repairs.edits import edit_values, swap_values
from urdfcheck.model.stated_reasons import collect_reasoned_joints
from urdfcheck.model.use.other_programs import names_bullet
from urdfcheck.model.wheel_names import WHEEL_NAME, is_revolute_wheel

# Kilograms.
_GRAM = 1e-3
# What a wheel is, unless it is not to turn.
_CONTINUOUS = 'write type="continuous" if the wheel turns, or make the joint fixed'

# The limits by which Bullet's own files and its parser say that a joint has none (lower 0, upper -1), and a copy of them.
_ENDLESS = frozenset({(0.0, -1.0), (1.0, -1.0)})
# How to say so for all programs, by the type of the joint.
_FREE = {
    "revolute": 'write type="continuous" if the joint turns without limits, as Bullet reads it',
    "prismatic": "write limits that it does not reach if the joint slides without limits, as Bullet reads it",
}
# MoveIt checks the limits of the joints that it plans for.
_FOLLOWED = "loads it: it plans in the limits of the joint that this one follows"
# The elements of a robot that is for other programs, too.
_OF_OTHERS = ("gazebo", "mujoco", "ros2_control", "transmission")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    equal: dict[tuple[float, bool], list[Joint]] = {}
    for joint in model.joints:
        limit, lower, upper = joint.limit, joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if joint.type not in {"revolute", "prismatic"} or limit is None or lower is None or upper is None:
            continue
        typed = [limit.attributes[name] for name in ("lower", "upper") if name in limit.attributes]
        if not typed or lower < upper:
            continue  # JNT004 reports a limit with neither
        if lower == upper and is_held_still(model.robot):
            continue  # no joint of it moves
        if lower == upper:
            equal.setdefault((lower, _is_empty(joint)), []).append(joint)
        else:
            led = _find_led_range(model, joint)
            mirrored = _is_mirrored(model, lower, upper)
            slip = "" if mirrored else _describe_lost_sign(lower, upper)
            is_endless = led is None and not mirrored and (lower, upper) in _ENDLESS
            swap = f"swap the two: lower {upper:g}, upper {lower:g}{slip}"
            edits = swap_values(limit.attributes.get("lower"), limit.attributes.get("upper"))
            if led is not None:
                swap = _describe_led_range(joint, led)
                edits = edit_values(
                    (limit.attributes.get(name), f"{end:g}")
                    for name, typed_end, end in zip(("lower", "upper"), (lower, upper), led, strict=True)
                    if end != typed_end
                )
            yield rule.finding(
                "inverted",
                at=limit,
                severity=Severity.WARNING if is_endless and _is_for_bullet(model) else None,
                consequences=None if joint.mimic is None else {"moveit": _FOLLOWED},
                edits=[] if (slip and led is None) or is_endless else edits,
                repair=f"{_FREE[joint.type]}; otherwise {swap}" if is_endless else swap,
                joint=joint.name,
                lower=lower,
                upper=upper,
                unit=joint.position_unit,
            )
    named = collect_plugin_texts(model) if equal else frozenset()
    kept = find_preserved_names(model) if equal else {}
    kept_links = named | {sensor.reference for sensor in list_sensors(model)} if equal else named
    commanded = named | collect_controlled_joints(model)
    # Joints with the same numbers come from one template or one exporter's default.
    for (value, is_empty), joints in equal.items():
        # Neither an exporter nor a command is behind a joint that a robot with plugins of Gazebo holds at zero.
        is_held = named and value == 0 and (not is_empty or _are_of_one_macro(joints))
        meant = [
            joint
            for joint in joints
            if joint.child in kept_links
            or joint.name in kept
            or (is_held and joint.name not in commanded and _may_be_held(joint, is_empty=is_empty))
            or (
                value == 0
                and (is_empty or joint.name not in commanded)
                and bool(named)
                and _carries_next_to_nothing(model, joint)
            )
            or joint.name in collect_reasoned_joints(model)
        ]
        others = [joint for joint in joints if joint not in meant]
        for group, severity in ((others, Severity.WARNING), (meant, Severity.INFO)):
            if group:
                keep = _describe_keeping([joint for joint in group if joint.name not in kept], named)
                yield _build_finding(model, rule, group, value, severity=severity, keep=keep, is_empty=is_empty)


def _build_finding(
    model: Model, rule: Rule, joints: Sequence[Joint], value: float, *, severity: Severity, keep: str, is_empty: bool
) -> Finding:
    """Report joints with one number as both limits together."""
    return build_group_finding(
        rule,
        "equal",
        [joint.limit for joint in joints if joint.limit is not None],
        severity=severity,
        joints=join_names(joint.name for joint in joints),
        which=format_count(len(joints), "joint has", "joints have"),
        value=value,
        instead=_describe_instead(model, joints, value),
        keep=keep,
        also=". Effort and velocity are 0 too" if is_empty else "",
        explains=[f"JNT007 {joint.element.label}" for joint in joints] if is_empty else [],
    )


def _carries_next_to_nothing(model: Model, joint: Joint) -> bool:
    """Whether all that hangs on a joint weighs a gram or less: it was made to keep a link, and not to move."""
    waiting, mass = [joint.child], 0.0
    try:
        children = model.tree.child_joints
    except FactUnavailableError:
        return False
    while waiting:
        name = waiting.pop()
        inertial = model.link_by_name[name].inertial if name in model.link_by_name else None
        if inertial is None or inertial.mass is None:
            return False
        mass += inertial.mass
        waiting += [below.child for below in children.get(name, ())]
    return 0.0 < mass <= _GRAM


def _may_be_held(joint: Joint, *, is_empty: bool) -> bool:
    """Whether a joint that a robot with plugins holds at zero may be meant so: a hinge with a drive, or a suspension without one.

    A wheel is not, nor a slide with a drive: a finger of a gripper.
    """
    return (is_empty or joint.type == "revolute") and not WHEEL_NAME.search(f"{joint.name} {joint.child}")


def _are_of_one_macro(joints: Sequence[Joint]) -> bool:
    """Whether several joints have one limit, which a macro types: an exporter writes one for each."""
    return len(joints) > 1 and len({None if joint.limit is None else joint.limit.span for joint in joints}) == 1


def _find_led_range(model: Model, joint: Joint) -> tuple[float, float] | None:
    """Find the positions to which the range of another joint moves one that follows it."""
    leader = None if joint.mimic is None else model.joint_by_name.get(joint.mimic.get("joint"))
    led, coefficients = None if leader is None else leader.position_range, joint.mimic_coefficients
    if led is None or coefficients is None or coefficients[0] == 0.0:
        return None
    low, high = sorted(coefficients[0] * position + coefficients[1] for position in led)
    return low, high


def _describe_led_range(joint: Joint, led: tuple[float, float]) -> str:
    """Say to write the range to which its leader moves a joint."""
    leader = "" if joint.mimic is None else joint.mimic.get("joint")
    return f"write lower {led[0]:g}, upper {led[1]:g}: the range of {leader}, which the joint follows, moves it so far"


def _is_mirrored(model: Model, lower: float, upper: float) -> bool:
    """Whether another joint has these limits with opposite signs: a limb was mirrored, and the order was not."""
    return any(
        joint.get_limit_value("lower") == -lower and joint.get_limit_value("upper") == -upper for joint in model.joints
    )


def _is_for_bullet(model: Model) -> bool:
    """Whether files around the model name Bullet, and none of the robot's elements is for another program."""
    return names_bullet(model) and not any(model.robot.find_child(tag) for tag in _OF_OTHERS)


def _describe_lost_sign(lower: float, upper: float) -> str:
    """Return the other repair of limits with one sign, or of which one is zero: a sign may be wrong; nothing for others."""
    if lower > 0.0 > upper:
        return ""
    return (
        f"; or lower {-lower:g} if its minus sign is missing"
        if lower > 0
        else f"; or upper {-upper:g} if its minus sign is too much"
    )


def _describe_instead(model: Model, joints: Sequence[Joint], value: float) -> str:
    """Say what to write in place of an empty range at ``value`` (rad or m): a fixed joint is at zero."""
    carriers = {joint.parent for joint in model.joints if WHEEL_NAME.search(f"{joint.name} {joint.child}")}
    if all(is_revolute_wheel(joint) and joint.child not in carriers for joint in joints):
        return _CONTINUOUS
    moved = "" if value == 0 else f", with {value:g} {joints[0].position_unit} in its <origin>"
    turned = " and an <axis> (without one it is x)" if any(joint.axis_element is None for joint in joints) else ""
    is_open = value == 0 and all(joint.type == "revolute" for joint in joints)  # else a pose is held
    endless = ' (or type="continuous" if it turns without end)' if is_open else ""
    return f"give the real range{turned}{endless}, or make the joint fixed{moved}"


def _describe_keeping(joints: Sequence[Joint], named: AbstractSet[str]) -> str:
    """Return what keeps the links of joints that are made fixed: Gazebo merges them, and a plugin finds them no longer.

    :param joints: those that the file does not keep already.
    :param named: what the plugins name. Other links may be named in a plugin's code.
    """
    if not joints or not named:
        return ""
    merged = [joint for joint in joints if joint.child in named]
    if not merged:
        return "; Gazebo merges the links of fixed joints, and plugins find them no longer"
    first = merged[0]
    others = f", and likewise for {join_names(joint.name for joint in merged[1:])}" if len(merged) > 1 else ""
    return (
        f" and keep {first.child}, which a plugin names, from being merged: "
        f'`<gazebo reference="{first.name}"><preserveFixedJoint>true</preserveFixedJoint></gazebo>`{others}'
    )


def _is_empty(joint: Joint) -> bool:
    """Whether all limits of a joint are 0: the fields of an exporter's dialog were empty."""
    return all(joint.get_limit_value(name) == 0 for name in ("lower", "upper", "effort", "velocity"))
