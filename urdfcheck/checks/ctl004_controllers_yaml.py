"""CTL004: controller configurations fit the model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Located, Location, Rule, Severity
from urdfcheck.core.text import find_nearest_name, find_only_near_name, format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.model.likeness.sibling_robots import PackageNames
from urdfcheck.model.motion.controllers import (
    AssociatedConfiguration,
    collect_command_interfaces,
    find_controller_configs,
    find_launched_configs,
    list_drive_wheels,
    list_parameter_files,
    measure_wheel_radii,
    measure_wheel_separations,
)
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.ros.controllers import Controller
from urdfcheck.source.text.yaml import YamlValue, find_yaml_error

# Each suggestion looks at all names.
MOST_HINTS = 100


def check(subject: Model | LaunchContext, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    if isinstance(subject, LaunchContext):
        model = subject.model
        found = [] if model is None else find_launched_configs(subject.launch, model)
    else:
        model, found = subject, find_controller_configs(subject)
        yield from _check_parameter_files(subject, rule)
    if model is None or not found:
        return
    elsewhere = PackageNames(model)
    for associated in found:
        yield from _check_unknown_joints(model, rule, associated, elsewhere)
        if associated.named_at is not None:
            yield from _check_command_interfaces(model, rule, associated)
    for associated in found:
        yield from _check_wheel_geometry(model, rule, associated, elsewhere, rel_tol)


def _check_parameter_files(model: Model, rule: Rule) -> Iterator[Finding]:
    """What the model's own plugins name as their parameters and nobody else has."""
    for parameters in list_parameter_files(model):
        shown = format_path(parameters.path) if parameters.path is not None else parameters.text
        problem = None if parameters.path is None else find_yaml_error(parameters.path, model.source.finder)
        if problem is not None:
            broken = Location("yaml", problem.span)
            yield rule.finding("broken", at=broken, related=[parameters.element], reason=str(problem))
        if parameters.missing:
            yield rule.finding("missing", at=parameters.element, path=parameters.text)
        elif parameters.literal and parameters.text.startswith("/"):
            yield rule.finding(
                "machine",
                at=parameters.element,
                severity=Severity.WARNING,
                path=parameters.text,
                found=f" (here it is {shown})" if parameters.path is not None else "",
            )


def _check_unknown_joints(
    model: Model, rule: Rule, associated: AssociatedConfiguration, elsewhere: PackageNames
) -> Iterator[Finding]:
    """One finding for each name that no joint has, and no other robot of the package; one for each controller of a file of
    which the robot has nothing, though it names the file itself."""
    configuration = associated.configuration
    # What ros2_control calls a joint and the robot has not is an error of that block.
    known = model.joint_by_name.keys() | (collect_command_interfaces(model) or {}).keys()
    if associated.named_at is not None and not configuration.joint_names & known:
        yield from _check_foreign_controllers(model, rule, associated, elsewhere)
        return
    uses: dict[str, list[tuple[Controller, YamlValue]]] = {}
    for controller in configuration.controllers:
        missing = [
            j for j in controller.joints if j.text not in known and not elsewhere.can_package_have("joint", j.text)
        ]
        # A controller of which the robot has nothing may be for a tool that it can be given.
        free = _list_unnamed_joints(model, controller)
        own = len(missing) < len(controller.joints) or any(
            find_nearest_name(j.text, free) for j in missing[:MOST_HINTS]
        )
        for joint in missing if own else ():
            uses.setdefault(joint.text, []).append((controller, joint))
    for index, (name, found) in enumerate(uses.items()):
        free = _list_unnamed_joints(model, found[0][0]) if index < MOST_HINTS else frozenset[str]()
        near = find_only_near_name(name, free)
        edits = [edit for _, value in found for edit in value.build_edits(near)] if near is not None else []
        yield rule.finding(
            "unknown",
            at=found[0][1],
            related=[*(value for _, value in found[1:]), *_to_list(associated.named_at)],
            edits=edits,
            controller=join_names(dict.fromkeys(controller.name for controller, _ in found)),
            joint=name,
            near=format_name_hint(name, free),
        )


def _list_unnamed_joints(model: Model, controller: Controller) -> frozenset[str]:
    """The joints that a controller does not name: what an unknown name in it may mean."""
    return frozenset(model.joint_by_name) - {joint.text for joint in controller.joints}


def _check_foreign_controllers(
    model: Model, rule: Rule, associated: AssociatedConfiguration, elsewhere: PackageNames
) -> Iterator[Finding]:
    """The controllers of another robot; not where other arguments may give the joints of this one their names."""
    for controller in associated.configuration.controllers:
        names = [joint.text for joint in controller.joints]
        if not any(elsewhere.can_variants_have("joint", name) for name in names):
            yield rule.finding(
                "none",
                at=controller.key,
                related=_to_list(associated.named_at),
                controller=controller.name,
                joints=join_names(names),
                own=join_names(joint.name for joint in model.joints if joint.is_movable) or "no joint that moves",
            )


def _check_command_interfaces(model: Model, rule: Rule, associated: AssociatedConfiguration) -> Iterator[Finding]:
    """Joints that a controller of ros2_control cannot claim."""
    offered = collect_command_interfaces(model)
    if offered is None:
        return
    told: set[str] = set()
    for controller in associated.configuration.controllers:
        wanted = controller.claimed_interfaces if controller.dialect == "ros2" else ()
        for value in controller.commanded_joints if wanted else ():
            joint = model.joint_by_name.get(value.text)
            lacking = [kind for kind in wanted if kind not in offered.get(value.text, ())]
            if joint is None or not lacking or value.text in told:
                continue
            told.add(value.text)
            data: dict[str, Any] = {"controller": controller.name, "joint": joint.name, "kind": ", ".join(lacking)}
            if joint.type == "fixed":
                yield rule.finding("fixed", at=value, related=[joint], **data)
            elif not offered.get(value.text):
                yield rule.finding("uncommanded", at=value, related=[joint], **data)
            else:
                kinds = ", ".join(sorted(offered[value.text]))
                yield rule.finding("interface", at=value, severity=Severity.WARNING, related=[joint], own=kinds, **data)


def _check_wheel_geometry(
    model: Model, rule: Rule, associated: AssociatedConfiguration, elsewhere: PackageNames, rel_tol: float
) -> Iterator[Finding]:
    for controller in associated.configuration.controllers:
        if not controller.type.startswith("diff_drive_controller/"):
            continue
        left, right = list_drive_wheels(controller)
        names = [value.text for value in (*left, *right)]
        if not left or not right or not all(name in model.joint_by_name for name in names):
            continue
        # Wheels of this name on another robot of the package: the numbers may be that one's.
        if associated.named_at is None and any(elsewhere.can_others_have("joint", name) for name in names):
            continue
        measured = [(value, "wheel_radius", measure_wheel_radii(model, value)) for value in names[:1]]
        if len(left) == len(right) == 1:  # of a skid steer the track is tuned to the ground
            measured.append(
                (names[0], "wheel_separation", measure_wheel_separations(model, left[0].text, right[0].text))
            )
        for _, key, real in measured:
            typed = controller.parameters.get(key)
            value = None if typed is None else typed.number
            if typed is None or value is None or value <= 0 or not real or min(real) <= 0:
                continue
            nearest_real = min(real, key=lambda size: abs(size - value))
            if abs(value - nearest_real) > rel_tol * nearest_real:
                yield rule.finding(
                    key.removeprefix("wheel_"),
                    at=typed,
                    related=[model.joint_by_name[name] for name in names],
                    severity=Severity.WARNING,
                    edits=typed.build_edits(f"{nearest_real:.4g}"),
                    controller=controller.name,
                    value=value,
                    real=nearest_real,
                    off=abs(value - nearest_real) / nearest_real,
                    left=names[0],
                    right=right[0].text,
                )


def _to_list(named: Located | None) -> list[Located]:
    return [] if named is None else [named]
