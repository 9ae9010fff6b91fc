"""JNT005 reports limits whose lower end is not below the upper one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    equal: dict[float, list[Joint]] = {}
    for joint in model.joints:
        limit, lower, upper = joint.limit, joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if joint.type not in {"revolute", "prismatic"} or limit is None or lower is None or upper is None:
            continue
        typed = [limit.attributes[name] for name in ("lower", "upper") if name in limit.attributes]
        if not typed or lower < upper:
            continue  # neither is given: JNT004
        if lower == upper:
            equal.setdefault(lower, []).append(joint)
        else:
            yield rule.finding(
                "inverted",
                at=limit,
                edits=_propose_edits(limit),
                joint=joint.name,
                lower=lower,
                upper=upper,
                unit="rad" if joint.type == "revolute" else "m",
            )
    for value, joints in equal.items():
        yield _build_group_finding(rule, value, joints)


def _build_group_finding(rule: Rule, value: float, joints: list[Joint]) -> Finding:
    """One finding for all joints with the same numbers: they come from one template or one exporter's default."""
    limits = [joint.limit for joint in joints if joint.limit is not None]
    finding = rule.finding(
        "equal",
        at=limits[0],
        severity=Severity.WARNING,
        related={limit.span: limit for limit in limits if limit.span != limits[0].span}.values(),
        joints=join_names(j.name for j in joints),
        which="1 joint has" if len(joints) == 1 else f"{len(joints)} joints have",
        value=value,
    )
    return replace(finding, subjects=tuple(limit.subject for limit in limits))


def _propose_edits(limit: Element) -> list[Edit]:
    lower, upper = limit.attributes.get("lower"), limit.attributes.get("upper")
    if lower is None or upper is None or not (lower.literal and upper.literal) or not (lower.span and upper.span):
        return []
    return [Edit(lower.span, lower.typed, upper.typed), Edit(upper.span, upper.typed, lower.typed)]
