"""JNT004 reports revolute and prismatic joints without a range."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.wheel_names import is_revolute_wheel
from urdfcheck.source.text.grammar import is_attribute_missing


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        if joint.type not in {"revolute", "prismatic"}:
            continue
        data: dict[str, Any] = {"joint": joint.name, "type": joint.type, "unit": joint.position_unit}
        data["instead"] = ", or make it continuous if it turns without end" if joint.type == "revolute" else ""
        limit = joint.limit
        if limit is None:
            yield rule.finding("wheel-missing" if is_revolute_wheel(joint) else "missing", at=joint, **data)
        elif is_attribute_missing(limit, "lower") and is_attribute_missing(limit, "upper"):
            yield rule.finding("wheel" if is_revolute_wheel(joint) else "locked", at=limit, **data)
