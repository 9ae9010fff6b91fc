"""JNT008 reports limits that have no effect: on continuous or fixed joints, and ranges of several turns."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model

# A limit of this size means "no limit".
_ENDLESS = 1e6


def check(model: Model, rule: Rule, *, turns: float) -> Iterator[Finding]:
    joints_by_message: dict[str, list[Joint]] = {"continuous": [], "fixed": [], "wide": []}
    for joint in model.joints:
        lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if lower is None or upper is None or lower == upper:
            continue  # exporters write zeros for every joint
        if joint.type == "fixed" or (joint.type == "continuous" and max(-lower, upper) < _ENDLESS):
            joints_by_message[joint.type].append(joint)
        elif joint.type == "revolute" and upper - lower > turns * math.tau:
            joints_by_message["wide"].append(joint)
    for message, joints in joints_by_message.items():
        if joints:
            yield _build_limits_finding(rule, message, joints)


def _build_limits_finding(rule: Rule, message: str, joints: list[Joint]) -> Finding:
    """Report similar joints together: they come from one template or one exporter's default."""
    lower, upper = joints[0].get_limit_value("lower"), joints[0].get_limit_value("upper")
    return build_group_finding(
        rule,
        message,
        [joint.limit for joint in joints if joint.limit is not None],
        joints=join_names(joint.name for joint in joints),
        count=format_count(len(joints), "joint"),
        verb="has" if len(joints) == 1 else "have",
        lower=lower,
        upper=upper,
        turns=((upper or 0) - (lower or 0)) / math.tau,
    )
