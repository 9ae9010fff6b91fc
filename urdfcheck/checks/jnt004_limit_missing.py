"""JNT004 reports revolute and prismatic joints without a range."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.use.other_programs import is_read_without_urdfdom
from urdfcheck.model.wheel_names import is_revolute_wheel
from urdfcheck.source.text.grammar import REQUIRED_ATTRIBUTES, is_attribute_missing, list_attributes_as_children
from urdfcheck.source.text.xml import Element

_USERS_OF_URDFDOM = ("urdfdom", "pinocchio", "gazebo", "moveit")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        if joint.type not in {"revolute", "prismatic"}:
            continue
        data: dict[str, Any] = {"joint": joint.name, "type": joint.type, "unit": joint.position_unit}
        data["instead"] = ", or make it continuous if it turns without end" if joint.type == "revolute" else ""
        limit = joint.limit
        if limit is None:
            yield rule.finding("wheel-missing" if is_revolute_wheel(joint) else "missing", at=joint, **data)
        elif _lacks_range(limit) and all(map(_lacks_range, joint.element.find_children("limit"))):  # else XML006
            # The simulators that have a parser of their own move the joint.
            severity = Severity.WARNING if is_read_without_urdfdom(model) else None
            yield _build_range_finding(joint, limit, rule, data, severity)


def _lacks_range(limit: Element) -> bool:
    return is_attribute_missing(limit, "lower") and is_attribute_missing(limit, "upper")


def _build_range_finding(
    joint: Joint, limit: Element, rule: Rule, data: dict[str, Any], severity: Severity | None
) -> Finding:
    """Report a limit without a range; where urdfdom refuses it for something else too, no joint is left without a range."""
    typed = list_attributes_as_children(limit)
    is_range = any(child.tag in {"lower", "upper"} for child in typed)
    is_wheel = is_revolute_wheel(joint)
    lacking = " and ".join(name for name in REQUIRED_ATTRIBUTES["limit"] if is_attribute_missing(limit, name))
    refusal = f"refuses the file: `<limit>` lacks {lacking}"
    return rule.finding(
        "children" if is_range else "wheel" if is_wheel else "locked",
        at=limit,
        related=typed if is_range else (),
        severity=severity,
        consequences=dict.fromkeys(_USERS_OF_URDFDOM, refusal) if lacking else None,
        **data,
        tags=join_names(f"<{child.tag}>" for child in typed),
        written=" ".join(f'{child.tag}="{child.text.strip()}"' for child in typed),
        state="" if lacking else " has no range",
        result=f"a limit without {lacking} makes urdfdom refuse the file"
        if lacking
        else f"the {'wheel cannot turn' if is_wheel else 'joint cannot move'} where a program applies them",
    )
