"""JNT004 reports revolute and prismatic joints without a range."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.source.text.grammar import is_attribute_missing


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        if joint.type not in {"revolute", "prismatic"}:
            continue
        unit = "rad" if joint.type == "revolute" else "m"
        limit = joint.limit
        if limit is None:
            instead = ", or make it continuous if it turns without end" if joint.type == "revolute" else ""
            yield rule.finding("missing", at=joint, joint=joint.name, type=joint.type, unit=unit, instead=instead)
        elif is_attribute_missing(limit, "lower") and is_attribute_missing(limit, "upper"):
            yield rule.finding("locked", at=limit, joint=joint.name, type=joint.type, unit=unit)
