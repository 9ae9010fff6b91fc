"""JNT007 reports effort and velocity limits that are missing, zero or negative."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.grammar import is_attribute_missing


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        limit = joint.limit
        missing = [] if limit is None else [n for n in ("effort", "velocity") if is_attribute_missing(limit, n)]
        if limit is not None and missing:
            yield rule.finding(
                "missing", at=limit, severity=Severity.ERROR, joint=joint.name, names=" and ".join(missing)
            )
    for name in ("effort", "velocity"):
        values = [(joint, joint.get_limit_value(name)) for joint in model.joints if joint.is_driven]
        yield from _build_group_finding(rule, f"{name}-zero", name, [j for j, v in values if v == 0])
        yield from _build_group_finding(
            rule, f"{name}-negative", name, [j for j, v in values if v is not None and v < 0]
        )


def _build_group_finding(rule: Rule, message: str, name: str, joints: list[Joint]) -> Iterator[Finding]:
    """One finding for all joints with the same defect: they come from one template or one exporter's default."""
    attributes = [j.limit.attributes[name] for j in joints if j.limit is not None]
    if attributes:
        finding = rule.finding(
            message,
            at=attributes[0],
            related={a.span: a for a in attributes if a.span != attributes[0].span}.values(),
            joints=join_names(j.name for j in joints),
            count=len(joints),
            noun="joint" if len(joints) == 1 else "joints",
            verb="has" if len(joints) == 1 else "have",
        )
        yield replace(finding, subjects=tuple(a.location.subject for a in attributes))
