"""CTL002 reports joints that nothing drives, and commands to joints that cannot be driven."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import find_typed

_DRIVABLE = frozenset({"revolute", "continuous", "prismatic"})
_ADDITION = "add them to the <ros2_control> block or give each a <transmission>"
_SEPARATOR = re.compile(r"[\s,;]+")
# Interfaces and transmissions of ros_control and pr2_mechanism that turn a joint's motor. Others only name joints:
# franka_hw/FrankaModelInterface names the root and the tip of a chain.
_COMMANDS = re.compile(r"(?:Position|Velocity|Effort|PosVel|PosVelAcc)JointInterface")
_DRIVES = re.compile(r"(?:Simple|Differential|FourBarLinkage|Wrist|Gripper)\w*Transmission")
# Hardware that moves the followers of a joint by itself.
_MOVES_FOLLOWERS = re.compile(
    r"(?:mock_components|fake_components|gz_ros2_control|ign_ros2_control|gazebo_ros2_control)/"
)
# The hardware of Gazebo Classic, which is not in ROS Jazzy and later.
_CLASSIC = "gazebo_ros2_control/"
# Plugins that read joints and move none.
_PUBLISHES = re.compile(r"joint_?state_?publisher", re.IGNORECASE)
# Joints without motors, by their names.
_PASSIVE = re.compile(r"cast[eo]r|swivel|passive", re.IGNORECASE)
# Joints at which hardware makes a force, by their names: a thruster need not turn in the model.
_THRUSTER = re.compile(r"thrust|propell", re.IGNORECASE)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_undriven_joints(model, rule)
    yield from _check_misplaced_commands(model, rule)


def _check_undriven_joints(model: Model, rule: Rule) -> Iterator[Finding]:
    words = _collect_control_words(model)
    # A name in other capitals is meant, and reported where it is typed (CTL001, CTL007).
    driven = {word.casefold() for word in words - model.joint_by_name.keys()}
    drivable = [joint for joint in model.joints if _has_motor(joint)]
    without = [joint for joint in drivable if joint.name not in words and joint.name.casefold() not in driven]
    none = len(without) == len(drivable)
    is_few = 2 * len(without) <= len(drivable)
    # A description without simulator extensions is controlled elsewhere, if at all.
    if without and (not none or any(model.robot.find_children("gazebo"))):
        yield rule.finding(
            "none" if none else "some" if is_few and _is_forgotten(without, drivable) else "most",
            at=model if none else without[0],
            related=without if none else without[1:],
            severity=Severity.INFO,
            joints=join_names(j.name for j in without),
            addition=_ADDITION if any(model.robot.find_children("ros2_control")) else "give each a <transmission>",
            count=len(without),
            total="joint" if len(drivable) == 1 else f"{len(drivable)} joints",
        )


def _is_forgotten(without: Sequence[Joint], drivable: Sequence[Joint]) -> bool:
    """Whether joints without a drive have a counterpart at another place (``front_left_wheel``) that has one, or a single one is
    of a series (``joint_4``)."""
    left_out = {_strip_place(joint, of_series=len(without) == 1) for joint in without}
    others = (joint for joint in drivable if joint not in without)
    return any(_strip_place(joint, of_series=len(without) == 1) in left_out for joint in others)


def _strip_place(joint: Joint, *, of_series: bool) -> tuple[str, ...]:
    words = remove_places(joint.name)
    return tuple(word for word in words if not word.isdigit()) if of_series else words


def _has_motor(joint: Joint) -> bool:
    """Whether a joint needs a motor: a follower has its leader's, and casters and free hinges have none."""
    if joint.type not in _DRIVABLE or joint.mimic is not None or _PASSIVE.search(joint.name):
        return False
    return joint.get_limit_value("effort") != 0


def _collect_control_words(model: Model) -> set[str]:
    """Return every word in a transmission, a ros2_control block or a simulator plugin, joint names among them."""
    blocks = [*model.robot.find_children("ros2_control"), *model.robot.find_children("transmission")]
    blocks += [e for extension in model.robot.find_children("gazebo") for e in extension.walk() if _is_drive(e)]
    words: set[str] = set()
    for block in blocks:
        for element in block.walk():
            words.update(_SEPARATOR.split(element.text))
            words.update(attribute.value for attribute in element.attributes.values())
    return words


def _is_drive(element: Element) -> bool:
    return element.tag == "plugin" and _PUBLISHES.search(element.get("filename")) is None


def _drives_joint(transmission: Element, joint: Element) -> bool:
    """Whether a transmission connects a joint with a motor, by the joint's interfaces, or by its own type where none is named."""
    interfaces = [e.text for e in joint.walk() if e.tag == "hardwareInterface"]
    if interfaces:
        return any(_COMMANDS.search(text) for text in interfaces)
    types = [transmission.get("type"), *(e.text for e in transmission.find_children("type"))]
    return any(_DRIVES.search(text) for text in types)


def _check_misplaced_commands(model: Model, rule: Rule) -> Iterator[Finding]:
    commanded = [
        ("mimic", Severity.WARNING if own is None else Severity.INFO, "command interface", joint)
        for control in model.robot.find_children("ros2_control")
        for own in [_find_own_hardware(model, control)]
        for joint in control.find_children("joint")
        if joint.find_child("command_interface") is not None and joint.get("mimic") != "false"
    ]
    # Gazebo Classic ignores <mimic>: there, a follower usually has its own transmission.
    commanded += [
        ("mimic-transmission", Severity.INFO, "transmission", joint)
        for transmission in model.robot.find_children("transmission")
        for joint in transmission.find_children("joint")
        if _drives_joint(transmission, joint)
    ]
    held: dict[str, list[Element]] = {}
    for message, severity, what, element in commanded:
        joint = model.joint_by_name.get(element.get("name"))
        if joint is not None and joint.type == "fixed":
            held.setdefault(what, []).append(element)
        elif joint is not None and joint.mimic is not None and not _is_of_classic(model, element.parent):
            leader = joint.mimic.get("joint")
            yield rule.finding(
                message,
                at=element,
                severity=severity,
                related=[joint.mimic],
                joint=joint.name,
                leader=leader,
                repair=_describe_mimic_repair(element),
            )
    for what, elements in held.items():
        yield _build_fixed_finding(model, rule, what, elements)


def _is_of_classic(model: Model, control: Element | None) -> bool:
    """Whether a block of ros2_control is for Gazebo Classic alone, in whichever variant of its file: Gazebo ignores ``<mimic>``
    there, and the plugin moves a follower by its own command interface. ROS Jazzy refuses that, and lacks the plugin."""
    if control is None or control.span is None or not (classes := _list_hardware(control)):
        return False
    typed = find_typed(model.source.trees, control)
    classes += [] if typed is None else [each.text.strip() for each in typed.walk() if each.tag == "plugin"]
    return all(name.startswith(_CLASSIC) for name in classes)


def _list_hardware(control: Element) -> list[str]:
    return [e.text.strip() for hardware in control.find_children("hardware") for e in hardware.find_children("plugin")]


def _find_own_hardware(model: Model, control: Element) -> str | None:
    """Return the class of a block's hardware if it is of a package that is here: its author decides how followers move."""
    packages = model.source.finder.list_workspace_packages()
    return next((name for name in _list_hardware(control) if name.partition("/")[0] in packages), None)


def _describe_mimic_repair(joint: Element) -> str:
    """Say what to delete: a class of hardware that is not known may move the follower only by its own command."""
    unknown = [] if joint.parent is None else [n for n in _list_hardware(joint.parent) if not _MOVES_FOLLOWERS.match(n)]
    if unknown:
        needed = (
            f"delete the <mimic> if {unknown[0]} moves the joint by this interface; otherwise the command interface"
        )
        return f"{needed} (state interfaces may remain)"
    return "delete the command interface (state interfaces may remain), or the <mimic>"


def _build_fixed_finding(model: Model, rule: Rule, what: str, elements: Sequence[Element]) -> Finding:
    """Report together what commands fixed joints."""
    joints = [model.joint_by_name[element.get("name")] for element in elements]
    words = _collect_control_words(model)
    # The joints that move may have other names than the blocks that are for them.
    moving = [joint.name for joint in model.joints if joint.type in _DRIVABLE and joint.name not in words]
    is_of_thrusters = what == "command interface" and all(_THRUSTER.search(joint.name) for joint in joints)
    others = (
        f"name the joints that move there ({join_names(moving)} have no drive), or "
        if len(moving) >= len(joints)
        else ""
    )
    finding = rule.finding(
        "fixed",
        at=elements[0],
        severity=Severity.INFO if is_of_thrusters else Severity.WARNING,
        related=[*elements[1:], *joints],
        joints=join_names(joint.name for joint in joints),
        count="1 fixed joint has" if len(joints) == 1 else f"{len(joints)} fixed joints have",
        what=what,
        verb="is fixed and cannot move, but has" if len(joints) == 1 else "are fixed and cannot move, but have",
        repair="nothing if the hardware makes a force there and nothing turns; otherwise change the type"
        if is_of_thrusters
        else f"if the joint is to move, change its type; otherwise leave out its {what}"
        if len(joints) == 1
        else f"{others}change the types of the joints that are to move, and leave out the {what}s of the others",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(element.location.subject for element in elements)))
