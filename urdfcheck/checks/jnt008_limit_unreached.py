"""JNT008 reports limits that a joint of its type lacks or never reaches."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint

# Nobody runs into this: a way to write that there is no limit.
_ENDLESS = 1e6


def check(model: Model, rule: Rule, *, turns: float) -> Iterator[Finding]:
    found: dict[str, list[Joint]] = {"continuous": [], "fixed": [], "wide": []}
    for joint in model.joints:
        lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if lower is None or upper is None or lower == upper:
            continue  # exporters write zeros for every joint
        if joint.type == "fixed" or (joint.type == "continuous" and max(-lower, upper) < _ENDLESS):
            found[joint.type].append(joint)
        elif joint.type == "revolute" and upper - lower > turns * math.tau:
            found["wide"].append(joint)
    for message, joints in found.items():
        if joints:
            yield _build_group_finding(rule, message, joints)


def _build_group_finding(rule: Rule, message: str, joints: list[Joint]) -> Finding:
    """One finding for all joints alike: they come from one template or one exporter's default."""
    limits = [joint.limit for joint in joints if joint.limit is not None]
    lower, upper = joints[0].get_limit_value("lower"), joints[0].get_limit_value("upper")
    finding = rule.finding(
        message,
        at=limits[0],
        related={limit.span: limit for limit in limits if limit.span != limits[0].span}.values(),
        joints=join_names(joint.name for joint in joints),
        count="1 joint" if len(joints) == 1 else f"{len(joints)} joints",
        verb="has" if len(joints) == 1 else "have",
        lower=lower,
        upper=upper,
        turns=((upper or 0) - (lower or 0)) / math.tau,
    )
    return replace(finding, subjects=tuple(limit.subject for limit in limits))
