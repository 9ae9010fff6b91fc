"""SRD002 reports named states of an SRDF that exceed the limits of the joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.motion.planning_limits import (
    PositionRange,
    compute_position_range,
    list_own_srdfs,
    load_joint_limits,
)
from urdfcheck.source.ros.joint_limits import JointLimits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element


@dataclass(frozen=True, slots=True, eq=False)
class _OutOfRangeValue:
    joint: str
    attribute: Attribute
    value: float
    range: PositionRange
    is_rotary: bool

    @property
    def excess(self) -> float:
        return max(self.range.lower - self.value, self.value - self.range.upper)

    @property
    def is_in_degrees(self) -> bool:
        """Whether it is no angle that a joint of so small a range is given, and fits when it is taken for degrees."""
        return (
            self.is_rotary
            and abs(self.value) > 2 * math.pi
            and self.range.lower <= math.radians(self.value) <= self.range.upper
        )


def check(model: Model, rule: Rule, *, tol: float) -> Iterator[Finding]:
    for srdf in list_own_srdfs(model):
        limits = {entry.joint.text: entry for entry in load_joint_limits(model, srdf)}
        for state in srdf.root.find_children("group_state"):
            yield from _check_state(model, rule, state, limits, tol)


def _check_state(
    model: Model, rule: Rule, state: Element, limits: Mapping[str, JointLimits], tol: float
) -> Iterator[Finding]:
    outside = [
        found
        for element in state.find_children("joint")
        if (found := _find_out_of_range_value(model, element, limits, tol)) is not None
    ]
    if outside and all(found.is_in_degrees for found in outside):
        yield rule.finding(
            "degrees",
            at=outside[0].attribute,
            related=[found.attribute for found in outside[1:]],
            edits=_propose_edits(model, state),
            state=state.get("name"),
            values=", ".join(f"{found.joint} = {found.value:g}" for found in outside[:6]),
            joint=outside[0].joint,
            lower=outside[0].range.lower,
            upper=outside[0].range.upper,
        )
        return
    for found in outside:
        bound = found.range.lower if found.value < found.range.lower else found.range.upper
        yield rule.finding(
            "outside",
            at=found.attribute,
            related=[model.joint_by_name[found.joint].limit or model.joint_by_name[found.joint]],
            state=state.get("name"),
            joint=found.joint,
            value=found.value,
            excess=found.excess,
            unit="rad" if found.is_rotary else "m",
            bound=bound,
            source=found.range.source,
        )


def _find_out_of_range_value(
    model: Model, element: Element, limits: Mapping[str, JointLimits], tol: float
) -> _OutOfRangeValue | None:
    joint = model.joint_by_name.get(element.get("name").strip())
    at = element.attributes.get("value")
    value = None if at is None else parse_number(at.value)
    # A follower is put where its leader says.
    if joint is None or at is None or value is None or joint.mimic is not None:
        return None
    known = compute_position_range(joint, limits)
    if known is None or known.lower - tol <= value <= known.upper + tol:
        return None
    return _OutOfRangeValue(joint.name, at, value, known, joint.type == "revolute")


def _propose_edits(model: Model, state: Element) -> list[Edit]:
    """Every angle of the state, where all of them can be edited."""
    edits: list[Edit] = []
    for element in state.find_children("joint"):
        joint, at = model.joint_by_name.get(element.get("name").strip()), element.attributes.get("value")
        value = None if at is None else parse_number(at.value)
        if joint is None or at is None or value is None or not at.literal or at.span is None or state.via:
            return []
        if joint.type in {"revolute", "continuous"} and value != 0:
            edits.append(Edit(at.span, at.typed, f"{math.radians(value):.5g}"))
    return edits
