"""CTL003 reports control blocks where no parser looks for them, and incomplete transmissions."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import find_content_span
from urdfcheck.source.text.xml import Element

# The interfaces of joints in the package hardware_interface of ros_control.
INTERFACES = (
    *("EffortJointInterface", "PositionJointInterface", "VelocityJointInterface", "JointStateInterface"),
    *("PosVelJointInterface", "PosVelAccJointInterface"),
)
_PREFIX = "hardware_interface/"
_CLASSIC = re.compile(r"gazebo_ros_control")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_nesting(model, rule)
    # gazebo_ros_control is the one that reads them; without it they may be what an exporter left.
    simulated = any(
        _CLASSIC.search(plugin.get("filename"))
        for block in model.robot.find_children("gazebo")
        for plugin in block.find_children("plugin")
    )
    for transmission in model.robot.find_children("transmission"):
        yield from _check_transmission(model, rule, transmission, None if simulated else Severity.WARNING)
    yield from _check_missing_prefix(model, rule)


def _check_nesting(model: Model, rule: Rule) -> Iterator[Finding]:
    for element in model.robot.walk():
        around = element.parent
        if around is None or around is model.robot:
            continue
        if element.tag == "ros2_control" or (
            element.tag == "transmission" and around.tag in {"gazebo", "link", "joint"}
        ):
            yield rule.finding(element.tag, at=element, name=element.get("name"), around=around.label)


def _check_transmission(
    model: Model, rule: Rule, transmission: Element, severity: Severity | None
) -> Iterator[Finding]:
    if "type" in transmission.attributes:  # as the PR2 reads them
        return
    name = transmission.get("name")
    kind = transmission.find_child("type")
    if kind is None or not kind.text.strip():
        yield rule.finding("type", at=transmission, severity=severity, name=name)
    for joint in transmission.find_children("joint"):
        interfaces = joint.find_children("hardwareInterface")
        if not any(interface.text.strip() for interface in interfaces):
            moved = [
                e
                for actuator in transmission.find_children("actuator")
                for e in actuator.find_children("hardwareInterface")
            ]
            kept = next((e for e in moved if e.text.strip()), None)
            yield rule.finding(
                "interface-missing" if kept is None else "interface-in-actuator",
                at=joint,
                related=[] if kept is None else [kept],
                severity=severity,
                name=name,
                joint=joint.get("name"),
                interface="" if kept is None else kept.text.strip(),
            )
        for interface in interfaces:
            yield from _check_interface_name(model, rule, interface, joint, severity)


def _check_interface_name(
    model: Model, rule: Rule, interface: Element, joint: Element, severity: Severity | None
) -> Iterator[Finding]:
    text = interface.text.strip()
    package, slash, own = text.rpartition("/")
    if not own or own in INTERFACES or (slash and package != "hardware_interface"):
        return
    near = difflib.get_close_matches(own, INTERFACES, n=1, cutoff=0.8)
    if near:
        yield rule.finding(
            "interface-unknown",
            at=interface,
            severity=severity,
            edits=_propose_edits(model, interface, _PREFIX + near[0]),
            joint=joint.get("name"),
            interface=text,
            near=_PREFIX + near[0],
        )


def _check_missing_prefix(model: Model, rule: Rule) -> Iterator[Finding]:
    """The spelling of ROS Indigo, all uses in one finding."""
    found = [
        interface
        for transmission in model.robot.find_children("transmission")
        for joint in transmission.find_children("joint")
        for interface in joint.find_children("hardwareInterface")
        if interface.text.strip() in INTERFACES
    ]
    if found:
        edits = {edit.span: edit for e in found for edit in _propose_edits(model, e, _PREFIX + e.text.strip())}
        yield rule.finding(
            "prefix",
            at=found[0],
            related=found[1:],
            severity=Severity.INFO,
            edits=edits.values(),
            interface=found[0].text.strip(),
            count="" if len(found) == 1 else f", and {len(found) - 1} more",
        )


def _propose_edits(model: Model, element: Element, replacement: str) -> tuple[Edit, ...]:
    """The edit of an element's text, where that stands in the file as it is."""
    content = find_content_span(element, model.source.files)
    return () if content is None else (Edit(content, element.text.strip(), replacement),)
