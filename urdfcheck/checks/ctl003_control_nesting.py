"""CTL003 reports control blocks where no parser reads them, and incomplete transmissions."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.gazebo import UNREAD_TRANSMISSIONS, find_own_hardware_sim, reads_transmissions
from urdfcheck.model.ground.drive_plugins import list_drive_plugins
from urdfcheck.model.repairs.edits import edit_content
from urdfcheck.model.use.other_programs import names_ros_control
from urdfcheck.source.package.build_files import read_build_type
from urdfcheck.source.text.xml import Element

# The interfaces of joints in the package hardware_interface of ros_control.
INTERFACES = (
    *("EffortJointInterface", "PositionJointInterface", "VelocityJointInterface", "JointStateInterface"),
    *("PosVelJointInterface", "PosVelAccJointInterface"),
)
# Those that the class takes with which gazebo_ros_control simulates the hardware by default.
_SIMULATED = INTERFACES[:3]
_PREFIX = "hardware_interface/"
_TAKEN = f"write an interface that gazebo_ros_control takes by default: {join_names(_SIMULATED)}, each with {_PREFIX} before it"
_TYPE = "<type>transmission_interface/SimpleTransmission</type>"
_UNREAD = "delete it: ROS 2 reads the transmissions inside <ros2_control> only"


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    is_read = reads_transmissions(model)
    for finding in _check_blocks(model, rule):
        is_lost = is_read or finding.message_id == "ros2_control"
        yield finding if is_lost else replace(finding, consequences={**finding.consequences, **UNREAD_TRANSMISSIONS})


def _check_blocks(model: Model, rule: Rule) -> Iterator[Finding]:
    # Without gazebo_ros_control the transmissions may be an exporter's leftovers, or for a program of another kind.
    simulated = reads_transmissions(model)
    # ROS 2 has no program that reads the hardwareInterface.
    is_ros1 = simulated or not _is_for_ros2(model)
    severity = None if simulated else Severity.WARNING
    yield from _check_nesting(model, rule, severity=severity)
    transmissions = model.robot.find_children("transmission")
    # The texts of a project are read only for a model that has one.
    if severity is not None and transmissions and not names_ros_control(model):
        severity = Severity.INFO
    driven = _list_driven_joints(model)
    for transmission in transmissions:
        yield from _check_type(rule, transmission, severity=severity, is_ros1=is_ros1)
        if is_ros1:
            yield from _check_interfaces(model, rule, transmission, severity=severity, driven=driven)
    if is_ros1:
        yield from _check_missing_prefix(model, rule)


def _is_for_ros2(model: Model) -> bool:
    """Whether the model has a block of ros2_control, or its package is built by ament."""
    package = model.source.package
    is_ament = package is not None and read_build_type(package.root).startswith("ament_")
    return is_ament or bool(model.robot.find_children("ros2_control"))


def _list_driven_joints(model: Model) -> set[str]:
    """Return the joints that a drive plugin turns itself: it needs no transmission."""
    wheels = (wheel for plugin in list_drive_plugins(model) for wheel in (*plugin.left, *plugin.right))
    return {wheel.text.strip() for wheel in wheels}


def _check_nesting(model: Model, rule: Rule, *, severity: Severity | None) -> Iterator[Finding]:
    """Report blocks that are not directly in the robot; ``severity``: that of a transmission."""
    for element in model.robot.walk():
        around = element.parent
        if around is None or around is model.robot:
            continue
        if element.tag == "ros2_control" or (
            element.tag == "transmission" and around.tag in {"gazebo", "link", "joint"}
        ):
            yield rule.finding(
                element.tag,
                at=element,
                severity=severity if element.tag == "transmission" else None,
                name=element.get("name"),
                around=around.label,
                repair=_describe_move(model, element, around),
            )


def _describe_move(model: Model, block: Element, around: Element) -> str:
    """Say where a block belongs; of the joints that one there has already, a second one is one too many."""
    joints = _collect_joints(block)
    placed = [other for other in model.robot.find_children(block.tag) if joints & _collect_joints(other)]
    if placed and joints <= set().union(*map(_collect_joints, placed)):
        return f"delete it: {placed[0].label}, directly in <robot>, has these joints"
    if placed:
        shared = join_names(sorted(joints & set().union(*map(_collect_joints, placed))))
        return f"move it out of {around.label}, directly into <robot>, without the joints that {placed[0].label} has ({shared})"
    return f"move the block out of {around.label}, directly into <robot>"


def _collect_joints(block: Element) -> set[str]:
    return {joint.get("name") for joint in block.find_children("joint")}


def _has_type(transmission: Element) -> bool:
    kind = transmission.find_child("type")
    # The attribute is the syntax of the PR2.
    return "type" in transmission.attributes or (kind is not None and bool(kind.text.strip()))


def _check_type(rule: Rule, transmission: Element, *, severity: Severity | None, is_ros1: bool) -> Iterator[Finding]:
    if not _has_type(transmission):
        yield rule.finding(
            "type",
            at=transmission,
            severity=severity if is_ros1 else Severity.INFO,
            name=transmission.get("name"),
            repair=_describe_typing(transmission, is_read=severity is None) if is_ros1 else _UNREAD,
        )


def _describe_typing(transmission: Element, *, is_read: bool) -> str:
    """Say what is to be added before ros_control reads a transmission without a type: it drops one without a part of this."""
    joints, actuators = transmission.find_children("joint"), transmission.find_children("actuator")
    lacking = [_TYPE]
    if any(joint.find_child("hardwareInterface") is None for joint in joints):
        lacking.append("a <hardwareInterface> in the <joint>")
    if not actuators or any(not actuator.get("name") for actuator in actuators):
        lacking.append("an <actuator> with a name")
    return f"add {join_names(lacking)}" + ("" if is_read else "; or delete the transmission if no program reads it")


def _check_interfaces(
    model: Model, rule: Rule, transmission: Element, *, severity: Severity | None, driven: Collection[str]
) -> Iterator[Finding]:
    if "type" in transmission.attributes:
        return
    name = transmission.get("name")
    for joint in transmission.find_children("joint"):
        interfaces = joint.find_children("hardwareInterface")
        if not any(interface.text.strip() for interface in interfaces) and _has_type(transmission):
            moved = [
                e
                for actuator in transmission.find_children("actuator")
                for e in actuator.find_children("hardwareInterface")
            ]
            misplaced = next((e for e in moved if e.text.strip()), None)
            yield rule.finding(
                "interface-missing" if misplaced is None else "interface-in-actuator",
                at=joint,
                related=[] if misplaced is None else [misplaced],
                severity=Severity.INFO if joint.get("name") in driven else severity,
                name=name,
                joint=joint.get("name"),
                interface="" if misplaced is None else misplaced.text.strip(),
            )
        for interface in interfaces:
            yield from _check_interface_name(model, rule, interface, joint=joint.get("name"), severity=severity)


def _check_interface_name(
    model: Model, rule: Rule, interface: Element, *, joint: str, severity: Severity | None
) -> Iterator[Finding]:
    text = interface.text.strip()
    package, slash, name = text.rpartition("/")
    if not name or name in INTERFACES or (slash and package != "hardware_interface"):
        return
    near = difflib.get_close_matches(name, INTERFACES, n=1, cutoff=0.8)
    if not near:
        return
    own_sim = find_own_hardware_sim(model)
    # Without gazebo_ros_control another program may take the others.
    is_taken = near[0] in _SIMULATED or severity is not None
    yield rule.finding(
        "interface-own" if own_sim else "interface-unknown",
        at=interface,
        severity=Severity.INFO if own_sim else severity,
        edits=edit_content(interface, _PREFIX + near[0], model.source.files) if is_taken and not own_sim else (),
        joint=joint,
        interface=text,
        near=_PREFIX + near[0],
        sim=own_sim,
        repair=f"write {_PREFIX}{near[0]}" if is_taken else _TAKEN,
    )


def _check_missing_prefix(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report together all interfaces in the spelling of ROS Indigo."""
    interfaces = [
        interface
        for transmission in model.robot.find_children("transmission")
        for joint in transmission.find_children("joint")
        for interface in joint.find_children("hardwareInterface")
        if interface.text.strip() in INTERFACES
    ]
    if interfaces:
        edits = [edit for e in interfaces for edit in edit_content(e, _PREFIX + e.text.strip(), model.source.files)]
        yield rule.finding(
            "prefix",
            at=interfaces[0],
            related=interfaces[1:],
            severity=Severity.INFO,
            edits={edit.span: edit for edit in edits}.values(),
            interface=interfaces[0].text.strip(),
            count="" if len(interfaces) == 1 else f" (and {len(interfaces) - 1} more)",
        )
