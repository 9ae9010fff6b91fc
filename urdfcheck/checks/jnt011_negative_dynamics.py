"""JNT011 reports negative damping and friction."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.source.text.values import read_attribute_number


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        dynamics = joint.element.find_child("dynamics")
        for name in ("damping", "friction") if joint.is_movable and dynamics is not None else ():
            value = read_attribute_number(dynamics, name)
            if dynamics is not None and value is not None and value < 0:
                attribute = dynamics.attributes[name]
                edits = edit_numbers(attribute, attribute.value.replace("-", "", 1))
                yield rule.finding(name, at=attribute, edits=edits, joint=joint.name, value=value)
