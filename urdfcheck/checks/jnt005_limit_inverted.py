"""JNT005 reports limits whose lower end is not below the upper one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.repairs.edits import swap_values


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    equal: dict[float, list[Joint]] = {}
    for joint in model.joints:
        limit, lower, upper = joint.limit, joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if joint.type not in {"revolute", "prismatic"} or limit is None or lower is None or upper is None:
            continue
        typed = [limit.attributes[name] for name in ("lower", "upper") if name in limit.attributes]
        if not typed or lower < upper:
            continue  # JNT004 reports a limit with neither
        if lower == upper:
            equal.setdefault(lower, []).append(joint)
        else:
            yield rule.finding(
                "inverted",
                at=limit,
                edits=swap_values(limit.attributes.get("lower"), limit.attributes.get("upper")),
                joint=joint.name,
                lower=lower,
                upper=upper,
                unit=joint.position_unit,
            )
    # Joints with the same numbers come from one template or one exporter's default.
    for value, joints in equal.items():
        yield build_group_finding(
            rule,
            "equal",
            [joint.limit for joint in joints if joint.limit is not None],
            severity=Severity.WARNING,
            joints=join_names(joint.name for joint in joints),
            which=format_count(len(joints), "joint has", "joints have"),
            value=value,
            also=_describe_empty(joints),
        )


def _describe_empty(joints: Sequence[Joint]) -> str:
    """Say that effort and velocity are 0 too; JNT007 leaves that to this finding if the limits are 0."""
    values = {joint.get_limit_value(name) for joint in joints for name in ("lower", "effort", "velocity")}
    return ". Effort and velocity are 0 too" if values == {0} else ""
