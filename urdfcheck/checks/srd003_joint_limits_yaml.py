"""SRD003 reports entries in the joint_limits.yaml of a MoveIt configuration that do not fit the model."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.core.text import find_nearest_name, format_name_hint
from urdfcheck.model import Model
from urdfcheck.model.likeness.sibling_robots import PackageNames
from urdfcheck.model.motion.planning_limits import (
    LIMITS_FILE,
    compute_position_range,
    list_own_srdfs,
    load_joint_limits,
)
from urdfcheck.model.parts import Joint
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.ros.joint_limits import JointLimits
from urdfcheck.source.ros.srdf import Srdf, find_original_model
from urdfcheck.source.ros.yaml_files import find_yaml_error
from urdfcheck.source.text.yaml.values import YamlValue
from urdfcheck.system.files import read_text_or_nothing

# ROS 2 reads these as floating-point numbers, and rejects integers; some only if the flag beside them is set.
_DOUBLES = {
    "min_position": None,
    "max_position": None,
    "max_velocity": "has_velocity_limits",
    "max_acceleration": "has_acceleration_limits",
    "max_jerk": "has_jerk_limits",
}


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    elsewhere = PackageNames(model)
    checked: set[str] = set()
    for srdf in list_own_srdfs(model):
        if str(srdf.path.parent) in checked:  # several descriptions of the robot share the file
            continue
        checked.add(str(srdf.path.parent))
        problem = find_yaml_error(srdf.path.parent / LIMITS_FILE, model.source.finder)
        if problem is not None:
            yield rule.finding(
                "broken", at=Location("yaml", problem.span), severity=Severity.ERROR, reason=str(problem)
            )
        limits = load_joint_limits(model, srdf)
        yield from _check_unknown_joints(model, rule, srdf=srdf, limits=limits, elsewhere=elsewhere)
        package = model.source.finder.find_package_of(srdf.path.absolute())
        is_ros2 = package is not None and package.depends_on_ament
        if is_ros2:
            # MoveIt asks for the limits of the joints that it has.
            own = model.joint_by_name.keys() | srdf.virtual_joints
            yield from _check_integer_values(rule, [e for e in limits if e.joint.text.partition("/")[0] in own])
        for entry in limits:
            joint = model.joint_by_name.get(entry.joint.text)
            if joint is not None and joint.mimic is None:
                yield from _check_position_limits(model, rule, srdf, entry, joint, rel_tol=rel_tol)
                if not is_ros2 or entry.is_on("has_velocity_limits"):  # MoveIt 2 reads the number only beside the flag
                    yield from _check_velocity_limit(rule, entry, joint, rel_tol=rel_tol)


def _check_unknown_joints(
    model: Model, rule: Rule, *, srdf: Srdf, limits: tuple[JointLimits, ...], elsewhere: PackageNames
) -> Iterator[Finding]:
    missing = [e for e in limits if e.joint.text not in model.joint_by_name and e.joint.text not in srdf.virtual_joints]
    if 2 * len(missing) > len(limits):
        return  # it is for another robot
    unused = model.joint_by_name.keys() - {entry.joint.text for entry in limits}
    for entry in missing:
        # MoveIt calls the variables of a joint with several degrees of freedom joint/x.
        name = entry.joint.text
        if "/" in name or elsewhere.can_package_have("joint", name):
            continue
        near = find_nearest_name(name, unused)
        edits = () if near is None else entry.joint.build_edits(near)
        yield rule.finding("unknown", at=entry.joint, edits=edits, joint=name, near=format_name_hint(name, unused))


def _check_integer_values(rule: Rule, limits: Sequence[JointLimits]) -> Iterator[Finding]:
    """Report all numbers without a decimal point, which a node of ROS 2 rejects, together."""
    typed = [
        value
        for entry in limits
        for name, flag in _DOUBLES.items()
        if (value := entry.get_setting(name)) and value.is_integer and (flag is None or entry.is_on(flag))
    ]
    if typed:
        yield rule.finding(
            "integer",
            at=typed[0],
            severity=Severity.ERROR,
            related=typed[1:],
            edits=[edit for value in typed for edit in value.build_edits(f"{value.text}.0")],
            key=typed[0].key.rpartition(".")[2],
            value=typed[0].text,
            count="" if len(typed) == 1 else f" (and {len(typed) - 1} more)",
        )


def _check_position_limits(
    model: Model, rule: Rule, srdf: Srdf, entry: JointLimits, joint: Joint, *, rel_tol: float
) -> Iterator[Finding]:
    low, high = entry.get_number("min_position"), entry.get_number("max_position")
    at = entry.get_setting("max_position") or entry.get_setting("min_position")
    if at is None:
        return
    if joint.type == "continuous":
        yield _build_continuous_finding(model, rule, srdf, joint, at=at)
        return
    if low is not None and high is not None and low >= high:
        yield rule.finding("inverted", at=at, joint=joint.name, low=low, high=high)
        return
    known = compute_position_range(joint, {})
    if known is None:
        return
    slack = rel_tol * (known.upper - known.lower)
    for name, value, bound, is_beyond in (
        ("min_position", low, known.lower, low is not None and low < known.lower - slack),
        ("max_position", high, known.upper, high is not None and high > known.upper + slack),
    ):
        if is_beyond:
            yield rule.finding(
                "position",
                at=entry.get_setting(name) or at,
                related=[joint.limit] if joint.limit is not None else [],
                joint=joint.name,
                key=name,
                value=value,
                bound=bound,
                source=known.source,
            )


def _build_continuous_finding(model: Model, rule: Rule, srdf: Srdf, joint: Joint, *, at: YamlValue) -> Finding:
    """Report position limits of a continuous joint: where the model is a copy, and the joint has a range in the file that the
    configuration was made for, the limits are right and the copy is not."""
    original = find_original_model(srdf, model.source)
    text = "" if original is None else read_text_or_nothing(original)
    named = rf'<joint\b(?=[^<>]*\bname="{re.escape(joint.name)}")[^<>]*\btype="(\w+)"'
    kinds = set(re.findall(named, text))
    if original is None or not kinds or not kinds <= {"revolute", "prismatic"}:
        return rule.finding("continuous", at=at, joint=joint.name)
    return rule.finding(
        "continuous-copy",
        at=joint.element.attributes["type"],
        related=[at],
        joint=joint.name,
        kind=kinds.pop(),
        copy=model.source.name,
        original=format_path(original),
    )


def _check_velocity_limit(rule: Rule, entry: JointLimits, joint: Joint, *, rel_tol: float) -> Iterator[Finding]:
    at, value = entry.get_setting("max_velocity"), entry.get_number("max_velocity")
    limit = joint.get_limit_value("velocity")
    if at is None or value is None or entry.is_off("has_velocity_limits"):
        return
    if value <= 0:
        yield rule.finding("zero", at=at, joint=joint.name, value=value)
    elif limit is not None and limit > 0 and value > limit * (1 + rel_tol):
        yield rule.finding(
            "velocity",
            at=at,
            related=[joint.limit] if joint.limit is not None else [],
            joint=joint.name,
            value=value,
            own=limit,
            most=f"{limit:g}" if "." in f"{limit:g}" else f"{limit:.1f}",  # MoveIt 2 rejects an integer
            unit="m/s" if joint.type == "prismatic" else "rad/s",
        )
