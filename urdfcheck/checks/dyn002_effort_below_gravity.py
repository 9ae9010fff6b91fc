"""DYN002 reports joints whose effort limit is too small to hold what they carry."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import Overload, find_overloads


def check(model: Model, rule: Rule, *, rare: float, far: float) -> Iterator[Finding]:
    groups: dict[tuple[float, bool], list[Overload]] = {}
    for load in find_overloads(model):
        key = (load.joint.get_limit_value("effort") or 0.0, load.joint.type == "prismatic")
        groups.setdefault(key, []).append(load)
    # Joints with one effort limit are one finding: it was written for all of them.
    for (effort, _), loads in groups.items():
        # Equal arms stay in the file's order, whatever their last digits.
        worst_first = sorted(loads, key=lambda load: -float(f"{load.torque:.3g}"))
        message = "far" if worst_first[0].torque > far * effort else "weak"
        severity = Severity.INFO if max(load.count for load in loads) < rare * model.samples else None
        yield _build_overload_finding(model, rule, message, severity=severity, effort=effort, loads=worst_first)


def _build_overload_finding(
    model: Model, rule: Rule, message: str, *, severity: Severity | None, effort: float, loads: list[Overload]
) -> Finding:
    worst = loads[0]
    unit = "N" if worst.joint.type == "prismatic" else "N·m"
    others = [f"{load.joint.name} ({load.torque:.3g} {unit})" for load in loads[1:]]
    return build_group_finding(
        rule,
        message,
        [load.joint.limit.attributes["effort"] for load in loads if load.joint.limit is not None],
        severity=severity,
        joint=worst.joint.name,
        torque=worst.torque,
        effort=effort,
        times=worst.torque / effort,
        unit=unit,
        count=max(load.count for load in loads),
        samples=model.samples,
        others=f"; the same limit is too small for {join_names(others)}" if others else "",
        passes=_round_up(worst.torque),
        pose=worst.joint_values,
        joints={load.joint.name: {"torque": load.torque, "passes": _round_up(load.torque)} for load in loads},
    )


def _round_up(torque: float) -> float:
    """Return the next number with three digits."""
    step = 10.0 ** (math.floor(math.log10(torque)) - 2)
    return float(f"{math.ceil(torque / step) * step:.3g}")
