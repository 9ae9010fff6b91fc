"""JNT011 reports negative damping and friction."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.model import Model
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.source.text.xml import Attribute


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        dynamics = joint.element.find_child("dynamics")
        for name in ("damping", "friction") if joint.is_movable and dynamics is not None else ():
            value = read_attribute_number(dynamics, name)
            if dynamics is not None and value is not None and value < 0:
                attribute = dynamics.attributes[name]
                yield rule.finding(name, at=attribute, edits=_propose_edits(attribute), joint=joint.name, value=value)


def _propose_edits(attribute: Attribute) -> list[Edit]:
    if not attribute.literal or attribute.span is None:
        return []
    return [Edit(attribute.span, attribute.typed, attribute.typed.replace("-", "", 1))]
