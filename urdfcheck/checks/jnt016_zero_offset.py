"""JNT016: an origin turned about the joint's own axis shifts the joint's zero."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint

_TURNING = frozenset({"revolute", "continuous"})


def check(
    model: Model, rule: Rule, *, parallel: float, round_to: float, round_tol: float, decimals: int
) -> Iterator[Finding]:
    for joint in model.joints:
        attribute = joint.origin.attribute("rpy")
        if joint.type not in _TURNING or attribute is None or not attribute.literal:
            continue  # an angle that was computed was meant
        angle = _turn_about_axis(joint, parallel)
        if angle is None or _is_round(angle, round_to, round_tol) or _few_decimals(attribute.value, decimals):
            continue
        yield rule.finding("shifted", at=attribute, joint=joint.name, angle=angle, degrees=math.degrees(angle))


def _turn_about_axis(joint: Joint, parallel: float) -> float | None:
    """The angle (rad) of an origin that does nothing but turn about the joint's own axis, else None."""
    import numpy as np

    from urdfcheck.facts.kinematics import log_rotation

    matrix, axis = joint.origin.matrix, joint.axis
    length = 0.0 if axis is None else math.hypot(*axis)
    if matrix is None or axis is None or length == 0:
        return None
    about, angle = log_rotation(matrix[:3, :3])
    along = float(np.dot(about, axis)) / length
    off = float(np.linalg.norm(np.cross(about, axis))) / length
    return math.copysign(angle, along) if off <= parallel and angle > 0 else None


def _is_round(angle: float, step: float, tolerance: float) -> bool:
    degrees = math.degrees(angle)
    return abs(degrees - step * round(degrees / step)) <= tolerance


def _few_decimals(text: str, most: int) -> bool:
    """Whether the angle was typed by hand: no word has more than so many decimals."""
    return all(len(word.partition(".")[2]) <= most for word in text.split())
