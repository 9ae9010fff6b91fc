"""KIN009 reports joint types that are missing, unknown, or not supported by every program."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.repairs.edits import edit_value
from urdfcheck.model.use.other_programs import is_only_for_bullet
from urdfcheck.source.text.grammar import JOINT_TYPES, is_attribute_missing, is_unexpanded
from urdfcheck.source.text.xml import Attribute

# The names that SDF, MJCF and others have for a type of URDF, and the types that only they have.
_SYNONYMS = {"hinge": "revolute", "rotational": "revolute", "slide": "prismatic", "slider": "prismatic",
             "linear": "prismatic", "weld": "fixed", "rigid": "fixed", "free": "floating"}  # fmt: skip
_SDF = frozenset({"ball", "screw", "universal", "revolute2", "gearbox"})
# The type that Bullet and Isaac Gym read beside those of URDF.
_OF_BULLET = "spherical"
_LIKENESS, _LONGEST = 0.6, 40
# The targets that replace a joint of several degrees of freedom by a fixed one.
_FIXED = {"floating": frozenset({"bullet", "kdl"}), "planar": frozenset({"kdl"})}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        attribute = joint.element.attributes.get("type")
        if attribute is None:
            if is_attribute_missing(joint.element, "type"):
                yield rule.finding("missing", at=joint, joint=joint.name)
        elif joint.type not in JOINT_TYPES and not is_unexpanded(joint.type):
            yield _build_unknown_finding(model, rule, joint, attribute)
    for kind, targets in _FIXED.items():
        joints = [joint for joint in model.joints if joint.type == kind]
        if joints:
            # All joints of one type have the same consequences.
            yield build_group_finding(
                rule,
                kind,
                [joint.element.attributes["type"] for joint in joints],
                severity=Severity.WARNING if targets.intersection(model.targets) else Severity.INFO,
                joints=join_names(joint.name for joint in joints),
                count=format_count(len(joints), "joint is", "joints are"),
            )


def _build_unknown_finding(model: Model, rule: Rule, joint: Joint, attribute: Attribute) -> Finding:
    word = joint.type.strip().lower()
    close = difflib.get_close_matches(word, JOINT_TYPES, n=1, cutoff=_LIKENESS) if len(word) <= _LONGEST else []
    near = _SYNONYMS.get(word) or (close[0] if close and word not in _SDF else None)
    is_bullets = joint.type == _OF_BULLET
    message = "misspelt" if near else "sdf" if word in _SDF else "spherical" if is_bullets else "unknown"
    return rule.finding(
        message,
        at=attribute,
        severity=Severity.WARNING if is_bullets and is_only_for_bullet(model) else None,
        edits=edit_value(attribute, near) if near else (),
        joint=joint.name,
        type=joint.type,
        near=near or "",
        known=", ".join(JOINT_TYPES),
    )
