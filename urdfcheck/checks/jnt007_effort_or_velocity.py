"""JNT007 reports effort and velocity limits that are missing, zero or negative."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
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
        zero = [joint for joint, value in values if value == 0]
        negative = [joint for joint, value in values if value is not None and value < 0]
        # Joints with the same defect come from one template or one exporter's default.
        for kind, joints in (("zero", zero), ("negative", negative)):
            if joints:
                yield _build_wrong_limit_finding(rule, name, kind, joints=joints)


def _build_wrong_limit_finding(rule: Rule, name: str, kind: str, *, joints: list[Joint]) -> Finding:
    return build_group_finding(
        rule,
        f"{name}-{kind}",
        [joint.limit.attributes[name] for joint in joints if joint.limit is not None],
        joints=join_names(joint.name for joint in joints),
        count=len(joints),
        noun="joint" if len(joints) == 1 else "joints",
        verb="has" if len(joints) == 1 else "have",
    )
