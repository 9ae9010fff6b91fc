"""JNT020 reports efforts and velocities that all joints of a robot have in common."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model

_RANGED = frozenset({"revolute", "prismatic"})


def check(model: Model, rule: Rule, *, least_joints: int) -> Iterator[Finding]:
    driven = [joint for joint in model.joints if joint.is_driven and joint.type in _RANGED and joint.limit is not None]
    pairs = {(joint.get_limit_value("effort"), joint.get_limit_value("velocity")) for joint in driven}
    if len(driven) < least_joints or len(pairs) != 1:
        return
    effort, velocity = pairs.pop()
    if effort is None or velocity is None or not (_is_round(effort) and _is_round(velocity)):
        return
    yield build_group_finding(
        rule,
        "same",
        [place for joint in driven if (place := _get_effort(joint)) is not None],
        joints=join_names(joint.name for joint in driven),
        count=len(driven),
        effort=effort,
        velocity=velocity,
    )


def _get_effort(joint: Joint) -> Located | None:
    return None if joint.limit is None else joint.limit.attributes.get("effort")


def _is_round(value: float) -> bool:
    """Whether a positive number has one digit that is not zero."""
    return value > 0 and float(f"{value:.0e}") == value
