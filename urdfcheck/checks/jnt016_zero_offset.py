"""JNT016 reports origins rotated about the joint's own axis, which shifts the joint's zero."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import FactUnavailableError, Finding, Rule
from urdfcheck.facts.small_matrices import find_turn, multiply_inner, multiply_outer
from urdfcheck.model import Joint, Model
from urdfcheck.model.rigid_bodies import compute_body_inertia


def check(
    model: Model, rule: Rule, *, parallel: float, round_to: float, round_tol: float, decimals: int, eccentric: float
) -> Iterator[Finding]:
    for joint in model.joints:
        attribute = joint.origin.get_attribute("rpy")
        if joint.type not in {"revolute", "continuous"} or attribute is None or not attribute.literal:
            continue  # a computed angle is meant
        angle = _measure_turn_about_axis(joint, parallel)
        if angle is None or _is_round_angle(angle, round_to, round_tol) or _has_few_decimals(attribute.value, decimals):
            continue
        data: dict[str, Any] = {"joint": joint.name, "angle": angle, "degrees": math.degrees(angle)}
        if joint.type == "revolute":
            if joint.position_range is not None:  # otherwise it cannot turn: JNT004, JNT005
                lower, upper = map(math.degrees, joint.position_range)
                yield rule.finding("limits", at=attribute, **data, lower=lower, upper=upper)
        elif _is_asymmetric(model, joint, eccentric):
            yield rule.finding("shifted", at=attribute, **data)


def _measure_turn_about_axis(joint: Joint, parallel: float) -> float | None:
    """Return the angle (rad) of an origin that only turns about the joint's own axis, or None for any other rotation."""
    placement, axis = joint.origin.placement, joint.axis
    length = 0.0 if axis is None else math.hypot(*axis)
    if placement is None or axis is None or length == 0:
        return None
    about, angle = find_turn(placement.rotation)
    along = multiply_inner(about, axis) / length
    off = math.hypot(*multiply_outer(about, axis)) / length
    return math.copysign(angle, along) if off <= parallel and angle > 0 else None


def _is_round_angle(angle: float, step: float, tolerance: float) -> bool:
    degrees = math.degrees(angle)
    return abs(degrees - step * round(degrees / step)) <= tolerance


def _has_few_decimals(text: str, most: int) -> bool:
    """Whether the angle was typed by hand: no word has more than ``most`` decimals."""
    return all(len(word.partition(".")[2]) <= most for word in text.split())


def _is_asymmetric(model: Model, joint: Joint, eccentric: float) -> bool:
    """Whether the moved part is known not to be round about the axis.

    It carries another joint, or its mass or its drawing is eccentric.
    """
    try:
        body = model.tree.list_body_links(joint.child)
        carries = any(other.type != "fixed" for name in body for other in model.tree.child_joints[name])
        return (
            carries or _has_asymmetric_mass(model, joint, eccentric) or _has_asymmetric_drawing(model, joint, eccentric)
        )
    except FactUnavailableError:
        return False


def _has_asymmetric_mass(model: Model, joint: Joint, eccentric: float) -> bool:
    import numpy as np

    from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance

    inertia = compute_body_inertia(model, model.tree.list_body_links(joint.child))
    axis = model.axes.get(joint.name)
    if inertia is None or axis is None:
        return False
    mass, com, tensor = inertia
    across = np.eye(3) - np.outer(axis, axis)
    # Ascending: a zero along the axis, then the two across it, which are equal for a body of revolution.
    _, less, more = np.linalg.eigvalsh(across @ compute_mass_covariance(tensor, mass) @ across).tolist()
    off = float(np.linalg.norm(across @ (com - model.frames[joint.child][:3, 3])))
    size = math.sqrt(max(0.0, less + more))
    return size > 0 and (off > eccentric * size or more - less > eccentric * (more + less))


def _has_asymmetric_drawing(model: Model, joint: Joint, eccentric: float) -> bool:
    """Whether the drawn part extends unequally far in 16 directions across the axis."""
    import numpy as np

    from urdfcheck.model.shapes.corners import collect_rigid_corners

    points, axis = collect_rigid_corners(model, model.link_by_name[joint.child]), np.array(joint.axis)
    if points is None:
        return False
    axis = axis / np.linalg.norm(axis)
    side = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    side /= np.linalg.norm(side)
    angles = np.arange(16) * math.tau / 16
    directions = np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * np.cross(axis, side)
    reach = (points @ directions.T).max(axis=0)
    return bool(reach.min() < (1 - eccentric) * reach.max())
