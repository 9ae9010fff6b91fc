"""DYN002 reports joints whose effort limit is too small to hold what they carry."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import Overload, find_overloads, find_submersible_name

# An effort that this many joints or more have, and all that have one, does not come from their drives.
_PLACEHOLDER_JOINTS = 3


def check(model: Model, rule: Rule, *, rare: float, far: float, buoyant: float) -> Iterator[Finding]:
    groups: dict[tuple[float, bool], list[Overload]] = {}
    for load in find_overloads(model):
        key = (load.joint.get_limit_value("effort") or 0.0, load.joint.type == "prismatic")
        groups.setdefault(key, []).append(load)
    # Joints with the same effort limit are one finding: it was written for all of them.
    for (effort, _), loads in groups.items():
        # Equal arms stay in the file's order, whatever their last digits.
        worst_first = sorted(loads, key=lambda load: -float(f"{load.torque:.3g}"))
        times = worst_first[0].torque / effort
        afloat = find_submersible_name(model) if times < buoyant else None
        message = "weak" if times <= far else "placeholder" if _is_placeholder(model, effort) else "far"
        is_minor = afloat is not None or max(load.count for load in loads) < rare * model.samples
        yield _build_overload_finding(
            model,
            rule,
            message if afloat is None else "afloat",
            severity=Severity.INFO if is_minor else None,
            effort=effort,
            loads=worst_first,
            afloat=afloat,
        )


def _list_efforts(model: Model) -> list[float]:
    """List the effort limits of all joints that have one."""
    efforts = (joint.get_limit_value("effort") for joint in model.joints)
    return [effort for effort in efforts if effort]


def _is_placeholder(model: Model, effort: float) -> bool:
    """Whether all joints have one effort, and a power of ten, as exporters write it: 1 for any drive."""
    efforts = _list_efforts(model)
    return len(efforts) >= _PLACEHOLDER_JOINTS and set(efforts) == {effort} and f"{effort:e}".startswith("1.000000e")


def _build_overload_finding(
    model: Model,
    rule: Rule,
    message: str,
    *,
    severity: Severity | None,
    effort: float,
    loads: list[Overload],
    afloat: str | None,
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
        afloat=afloat or "",
        limited=len(_list_efforts(model)),
        others=f"; the same limit is too small for {join_names(others)}" if others else "",
        passes=_round_up(worst.torque),
        pose=worst.joint_values,
        joints={load.joint.name: {"torque": load.torque, "passes": _round_up(load.torque)} for load in loads},
    )


def _round_up(torque: float) -> float:
    """Return the next number with three digits."""
    step = 10.0 ** (math.floor(math.log10(torque)) - 2)
    return float(f"{math.ceil(torque / step) * step:.3g}")
