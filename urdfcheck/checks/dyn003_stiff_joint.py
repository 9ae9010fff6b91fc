"""DYN003 reports damping too strong for explicit integration at the simulator's time step."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.motion.joint_loads import list_implicit_joints, read_damping, summarize_mass_matrix


def check(model: Model, rule: Rule, *, time_step: float, margin: float) -> Iterator[Finding]:
    implicit = list_implicit_joints(model)
    damped = [joint for joint in model.joints if read_damping(joint) > 0 and joint.name not in implicit]
    summary = summarize_mass_matrix(model) if damped else None
    if summary is None:
        return
    inertias = summary.effective_inertias
    # The joints of a link with next to no inertia feel none; DYN001 reports the link.
    light = "" if summary.light_joint is None else summary.light_joint.child
    damped = [joint for joint in damped if joint.name in inertias and light not in {joint.parent, joint.child}]
    steps = {joint.name: 2 * inertias[joint.name] / read_damping(joint) for joint in damped}
    groups: dict[tuple[float, bool], list[Joint]] = {}
    for joint in damped:
        if margin * steps[joint.name] < time_step:
            groups.setdefault((read_damping(joint), joint.type == "prismatic"), []).append(joint)
    # Joints with the same damping are one finding: it was written for all of them.
    for joints in groups.values():
        # Equal fingers stay in the file's order, whatever their last digits.
        worst_first = sorted(joints, key=lambda joint: float(f"{steps[joint.name]:.3g}"))
        inertia = inertias[worst_first[0].name]
        yield _build_stiff_finding(
            rule, worst_first, inertia=inertia, time_step=time_step, robot_step=2 / summary.decay_rate
        )


def _build_stiff_finding(
    rule: Rule, joints: list[Joint], *, inertia: float, time_step: float, robot_step: float
) -> Finding:
    """Report joints with one damping at the worst of them, which feels ``inertia``."""
    worst = joints[0]
    slides, value = worst.type == "prismatic", read_damping(worst)
    return build_group_finding(
        rule,
        "explicit",
        [element.attributes["damping"] for j in joints if (element := j.element.find_child("dynamics")) is not None],
        severity=Severity.INFO,
        joint=worst.name,
        damping=value,
        unit="N·s/m" if slides else "N·m·s/rad",
        inertia=inertia,
        inertia_unit="kg" if slides else "kg·m²",
        stable_step=2 * inertia / value,
        stable=_format_duration(2 * inertia / value),
        robot_step=robot_step,
        step=_format_duration(time_step),
        others=f"; also {join_names(j.name for j in joints[1:])}" if len(joints) > 1 else "",
        most=2 * inertia / time_step,
    )


def _format_duration(seconds: float) -> str:
    return f"{1e3 * seconds:.2g} ms" if seconds >= 1e-4 else f"{1e6 * seconds:.2g} µs"
