"""JNT007 reports effort and velocity limits that are missing, zero or negative."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

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
    groups: dict[str, list[Joint]] = {}
    driven = [joint for joint in model.joints if joint.is_driven]
    for joint in driven:
        for kind in _classify_limits(joint):
            groups.setdefault(kind, []).append(joint)
    # Joints with the same defect come from one template or one exporter's default.
    for kind, joints in groups.items():
        message = kind.removesuffix("-locked")
        if kind == "effort-zero" and _are_passive(model, joints, driven):
            message = "effort-passive"
        yield _build_wrong_limit_finding(rule, message, joints)


def _classify_limits(joint: Joint) -> list[str]:
    """Say which limits of a joint are wrong, and how."""
    values = {name: joint.get_limit_value(name) for name in ("effort", "velocity")}
    if all(value == 0 for value in values.values()):
        # Of a joint that has no range either, nothing was filled in: JNT005 reports all of it as one defect.
        is_locked = joint.type != "continuous" and joint.get_limit_value("lower") == joint.get_limit_value("upper") == 0
        return ["both-zero-locked" if is_locked else "both-zero"]
    return [
        f"{name}-{'zero' if value == 0 else 'negative'}"
        for name, value in values.items()
        if value is not None and value <= 0
    ]


def _are_passive(model: Model, joints: Sequence[Joint], driven: Sequence[Joint]) -> bool:
    """Whether joints without effort may be meant to have no motor: most others have one, and nothing commands them."""
    limited = [joint for joint in driven if (joint.get_limit_value("effort") or 0.0) > 0]
    commanded = {
        element.get("name")
        for tag in ("ros2_control", "transmission")
        for block in model.robot.find_children(tag)
        for element in block.find_children("joint")
    }
    return len(joints) < len(limited) and commanded.isdisjoint(joint.name for joint in joints)


def _build_wrong_limit_finding(rule: Rule, message: str, joints: Sequence[Joint]) -> Finding:
    names = ("effort", "velocity") if message == "both-zero" else (message.partition("-")[0],)
    return build_group_finding(
        rule,
        message,
        [joint.limit.attributes[name] for joint in joints if joint.limit is not None for name in names],
        joints=join_names(joint.name for joint in joints),
        count=len(joints),
        noun="joint" if len(joints) == 1 else "joints",
        verb="has" if len(joints) == 1 else "have",
    )
