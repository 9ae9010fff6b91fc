"""SRD002 reports named states of an SRDF that exceed the limits of the joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.model import Model
from urdfcheck.model.motion.planning_limits import (
    PositionRange,
    compute_position_range,
    list_own_srdfs,
    load_joint_limits,
)
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.source.ros.joint_limits import JointLimits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _OutOfRangeValue:
    """The position of a joint in a state, which its limits exclude."""

    joint: str
    attribute: Attribute
    value: float
    """rad or m"""
    range: PositionRange
    """The positions within the limits."""
    is_rotary: bool

    @property
    def excess(self) -> float:
        return max(self.range.lower - self.value, self.value - self.range.upper)

    @property
    def is_in_degrees(self) -> bool:
        """Whether the value exceeds a turn in radians, and is within the limits in degrees, but not a turn less."""
        a_turn_less = self.value - math.copysign(2 * math.pi, self.value)
        return (
            self.is_rotary
            and abs(self.value) > 2 * math.pi
            and self.range.lower <= math.radians(self.value) <= self.range.upper
            and not self.range.lower <= a_turn_less <= self.range.upper
        )


def check(model: Model, rule: Rule, *, tol: float) -> Iterator[Finding]:
    for srdf in list_own_srdfs(model):
        limits = {entry.joint.text: entry for entry in load_joint_limits(model, srdf)}
        for state in srdf.root.find_children("group_state"):
            yield from _check_state(model, rule, state=state, limits=limits, tol=tol)


def _check_state(
    model: Model, rule: Rule, *, state: Element, limits: Mapping[str, JointLimits], tol: float
) -> Iterator[Finding]:
    outside = [
        wrong
        for element in state.find_children("joint")
        if (wrong := _find_out_of_range_value(model, element, limits=limits, tol=tol)) is not None
    ]
    if outside and all(wrong.is_in_degrees for wrong in outside):
        yield rule.finding(
            "degrees",
            at=outside[0].attribute,
            related=[wrong.attribute for wrong in outside[1:]],
            edits=_propose_edits(model, state),
            state=state.get("name"),
            values=", ".join(f"{wrong.joint} = {wrong.value:g}" for wrong in outside[:6]),
            joint=outside[0].joint,
            lower=outside[0].range.lower,
            upper=outside[0].range.upper,
        )
        return
    for wrong in outside:
        yield rule.finding(
            "outside",
            at=wrong.attribute,
            related=[model.joint_by_name[wrong.joint].limit or model.joint_by_name[wrong.joint]],
            state=state.get("name"),
            joint=wrong.joint,
            value=wrong.value,
            excess=wrong.excess,
            unit="rad" if wrong.is_rotary else "m",
            bound=wrong.range.lower if wrong.value < wrong.range.lower else wrong.range.upper,
            source=wrong.range.source,
        )


def _find_out_of_range_value(
    model: Model, element: Element, *, limits: Mapping[str, JointLimits], tol: float
) -> _OutOfRangeValue | None:
    joint = model.joint_by_name.get(element.get("name").strip())
    at = element.attributes.get("value")
    value = None if at is None else parse_number(at.value)
    # The position of a mimic joint follows from that of its leader.
    if joint is None or at is None or value is None or joint.mimic is not None:
        return None
    known = compute_position_range(joint, limits)
    if known is None or known.lower - tol <= value <= known.upper + tol:
        return None
    return _OutOfRangeValue(
        joint=joint.name, attribute=at, value=value, range=known, is_rotary=joint.type == "revolute"
    )


def _propose_edits(model: Model, state: Element) -> list[Edit]:
    """Return edits that convert all angles of the state to radians; nothing if one of them cannot be edited."""
    edits: list[Edit] = []
    for element in state.find_children("joint"):
        joint, at = model.joint_by_name.get(element.get("name").strip()), element.attributes.get("value")
        value = None if at is None else parse_number(at.value)
        if joint is None or at is None or value is None or not at.literal or at.span is None or state.via:
            return []
        if joint.type in {"revolute", "continuous"} and value != 0:
            edits += edit_numbers(at, f"{math.radians(value):.5g}")
    return edits
