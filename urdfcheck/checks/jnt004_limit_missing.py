"""JNT004 reports revolute and prismatic joints without a range."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Joint, Model
from urdfcheck.source.text.grammar import is_attribute_missing


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        if joint.type not in {"revolute", "prismatic"}:
            continue
        data: dict[str, Any] = {"joint": joint.name, "type": joint.type, "unit": joint.position_unit}
        limit = joint.limit
        if limit is None:
            instead = ", or make it continuous if it turns without end" if joint.type == "revolute" else ""
            yield rule.finding("wheel-missing" if _is_wheel(joint) else "missing", at=joint, **data, instead=instead)
        elif is_attribute_missing(limit, "lower") and is_attribute_missing(limit, "upper"):
            yield rule.finding("wheel" if _is_wheel(joint) else "locked", at=limit, **data)


def _is_wheel(joint: Joint) -> bool:
    """Whether a revolute joint is a wheel's, by its name or its child's, and not that of what carries the wheel."""
    from urdfcheck.model.wheel_names import WHEEL_CARRIER_NAME, WHEEL_NAME  # most models have all ranges

    words = f"{joint.name} {joint.child}"
    return joint.type == "revolute" and bool(WHEEL_NAME.search(words)) and not WHEEL_CARRIER_NAME.search(words)
