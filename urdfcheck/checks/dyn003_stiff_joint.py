"""DYN003 reports damping too strong for explicit integration at the simulator's time step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import list_implicit_joints, read_damping, summarize_mass_matrix
from urdfcheck.model.parts import Joint


def check(model: Model, rule: Rule, *, time_step: float) -> Iterator[Finding]:
    asked = list_implicit_joints(model)
    damped = [joint for joint in model.joints if read_damping(joint) > 0 and joint.name not in asked]
    found = summarize_mass_matrix(model) if damped else None
    if found is None:
        return
    # The joints of a link with next to no inertia feel none; DYN001 reports the link.
    light = "" if found.light_joint is None else found.light_joint.child
    damped = [
        joint for joint in damped if joint.name in found.effective_inertias and light not in {joint.parent, joint.child}
    ]
    steps = {joint.name: 2 * found.effective_inertias[joint.name] / read_damping(joint) for joint in damped}
    groups: dict[tuple[float, bool], list[Joint]] = {}
    for joint in damped:
        if steps[joint.name] < time_step:
            groups.setdefault((read_damping(joint), joint.type == "prismatic"), []).append(joint)
    for joints in groups.values():  # fingers that are alike stay in the file's order, whatever the last digits say
        yield _build_group_finding(
            rule,
            sorted(joints, key=lambda j: float(f"{steps[j.name]:.3g}")),
            found.effective_inertias,
            time_step,
            2 / found.decay_rate,
        )


def _build_group_finding(
    rule: Rule, joints: list[Joint], felt: Mapping[str, float], time_step: float, robot_step: float
) -> Finding:
    """One finding for all joints with one damping: it was written for all of them."""
    worst = joints[0]
    attributes = [
        element.attributes["damping"] for j in joints if (element := j.element.find_child("dynamics")) is not None
    ]
    slides, inertia, value = worst.type == "prismatic", felt[worst.name], read_damping(worst)
    finding = rule.finding(
        "explicit",
        at=attributes[0],
        related={a.span: a for a in attributes[1:] if a.span != attributes[0].span}.values(),
        joint=worst.name,
        damping=value,
        unit="N·s/m" if slides else "N·m·s/rad",
        inertia=inertia,
        inertia_unit="kg" if slides else "kg·m²",
        stable_step=2 * inertia / value,
        stable=_format_duration(2 * inertia / value),
        robot_step=robot_step,
        step=_format_duration(time_step),
        others=f"; so for {join_names(j.name for j in joints[1:])}" if len(joints) > 1 else "",
        most=2 * inertia / time_step,
    )
    return replace(finding, subjects=tuple(a.location.subject for a in attributes))


def _format_duration(seconds: float) -> str:
    return f"{1e3 * seconds:.2g} ms" if seconds >= 1e-4 else f"{1e6 * seconds:.2g} µs"
