"""KIN009 reports joint types that are missing, unknown, or unknown to some programs."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.grammar import JOINT_TYPES, is_attribute_missing, is_unexpanded
from urdfcheck.source.text.xml import Attribute

# What SDF, MJCF and others call a type of URDF, or have beside it.
_SYNONYMS = {"hinge": "revolute", "rotational": "revolute", "slide": "prismatic", "slider": "prismatic",
             "linear": "prismatic", "weld": "fixed", "rigid": "fixed", "free": "floating"}  # fmt: skip
_SDF = frozenset({"ball", "screw", "universal", "revolute2", "gearbox"})
_LIKENESS, _LONGEST = 0.6, 40
# Which targets make a joint of several degrees of freedom a fixed one.
_FIXED = {"floating": frozenset({"bullet", "kdl"}), "planar": frozenset({"kdl"})}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        attribute = joint.element.attributes.get("type")
        if attribute is None:
            if is_attribute_missing(joint.element, "type"):
                yield rule.finding("missing", at=joint, joint=joint.name)
        elif joint.type not in JOINT_TYPES and not is_unexpanded(joint.type):
            yield _build_unknown_finding(rule, joint, attribute)
    for kind, targets in _FIXED.items():
        joints = [joint for joint in model.joints if joint.type == kind]
        if joints:
            fixed = targets.intersection(model.targets)
            yield _build_group_finding(rule, kind, joints, Severity.WARNING if fixed else Severity.INFO)


def _build_unknown_finding(rule: Rule, joint: Joint, attribute: Attribute) -> Finding:
    word = joint.type.strip().lower()
    close = difflib.get_close_matches(word, JOINT_TYPES, n=1, cutoff=_LIKENESS) if len(word) <= _LONGEST else []
    near = _SYNONYMS.get(word) or (close[0] if close and word not in _SDF else None)
    message = "misspelt" if near else "sdf" if word in _SDF else "unknown"
    return rule.finding(
        message,
        at=attribute,
        edits=[Edit(attribute.span, attribute.typed, near)] if near and attribute.literal and attribute.span else (),
        joint=joint.name,
        type=joint.type,
        near=near or "",
        known=", ".join(JOINT_TYPES),
    )


def _build_group_finding(rule: Rule, kind: str, joints: list[Joint], severity: Severity) -> Finding:
    """One finding for all joints of a type: what becomes of them is the same."""
    attributes = [joint.element.attributes["type"] for joint in joints]
    finding = rule.finding(
        kind,
        at=attributes[0],
        severity=severity,
        related={a.span: a for a in attributes if a.span != attributes[0].span}.values(),
        joints=join_names(joint.name for joint in joints),
        count="1 joint is" if len(joints) == 1 else f"{len(joints)} joints are",
    )
    return replace(finding, subjects=tuple(attribute.location.subject for attribute in attributes))
