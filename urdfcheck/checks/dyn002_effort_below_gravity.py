"""DYN002 reports joints whose effort limit is too small to hold what they carry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import Overload, find_overloads


def check(model: Model, rule: Rule, *, rare: float, far: float) -> Iterator[Finding]:
    groups: dict[tuple[float, bool], list[Overload]] = {}
    for load in find_overloads(model):
        key = (load.joint.get_limit_value("effort") or 0.0, load.joint.type == "prismatic")
        groups.setdefault(key, []).append(load)
    for (effort, slides), loads in groups.items():
        # Arms that are alike stay in the file's order, whatever the last digits say.
        worst_first = sorted(loads, key=lambda load: -float(f"{load.torque:.3g}"))
        yield _build_group_finding(rule, effort, "N" if slides else "N·m", worst_first, model.samples, rare, far)


def _build_group_finding(
    rule: Rule, effort: float, unit: str, loads: list[Overload], samples: int, rare: float, far: float
) -> Finding:
    """One finding for all joints with one effort limit: it was written for all of them."""
    worst = loads[0]
    attributes = [load.joint.limit.attributes["effort"] for load in loads if load.joint.limit is not None]
    count = max(load.count for load in loads)
    others = [f"{load.joint.name} ({load.torque:.3g} {unit})" for load in loads[1:]]
    finding = rule.finding(
        "far" if worst.torque > far * effort else "weak",
        at=attributes[0],
        related={a.span: a for a in attributes[1:] if a.span != attributes[0].span}.values(),
        severity=Severity.INFO if count < rare * samples else None,
        joint=worst.joint.name,
        torque=worst.torque,
        effort=effort,
        times=worst.torque / effort,
        unit=unit,
        count=count,
        samples=samples,
        others=f"; the same limit is too small for {join_names(others)}" if others else "",
        passes=_round_up(worst.torque),
        pose=worst.joint_values,
        joints={load.joint.name: {"torque": load.torque, "passes": _round_up(load.torque)} for load in loads},
    )
    return replace(finding, subjects=tuple(a.location.subject for a in attributes))


def _round_up(torque: float) -> float:
    """The next number with three digits."""
    step = 10.0 ** (math.floor(math.log10(torque)) - 2)
    return float(f"{math.ceil(torque / step) * step:.3g}")
