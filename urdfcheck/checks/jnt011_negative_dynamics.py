"""JNT011 reports negative damping and friction."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.source.text.values import read_attribute_number

# The number that some programs write for "none".
_NONE = -1.0
_OF_NONE = "write 0 if -1 stands for none; otherwise delete the minus sign"


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        dynamics = joint.element.find_child("dynamics")
        for name in ("damping", "friction") if joint.is_movable and dynamics is not None else ():
            value = read_attribute_number(dynamics, name)
            if dynamics is not None and value is not None and value < 0:
                attribute = dynamics.attributes[name]
                is_none = value == _NONE
                edits = () if is_none else edit_numbers(attribute, attribute.value.replace("-", "", 1))
                repair = (
                    _OF_NONE
                    if is_none
                    else f"delete the minus sign: the {name} is positive and applies in both directions"
                )
                yield rule.finding(name, at=attribute, edits=edits, joint=joint.name, value=value, repair=repair)
