"""What Gazebo does with an impossible tensor of a link that is fixed to others: it checks the body that it merges them into."""

from __future__ import annotations

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.engine_floors import GAZEBO_MERGES, GAZEBO_REFUSES
from urdfcheck.model.fixed_joint_lumping import reduce_fixed_joints
from urdfcheck.model.parts import Link
from urdfcheck.model.rigid_bodies import MergedBody, weigh_body
from urdfcheck.model.robot import Model


def predict_gazebo(model: Model, link: Link, whole: MergedBody | None, rel_tol: float) -> str:
    """Predict whether Gazebo loads a link with an impossible tensor.

    :param whole: the body of all links that are fixed to it, of which Gazebo keeps some apart: those below a fixed joint with
        ``preserveFixedJoint`` or ``disableFixedJointLumping``.
    """
    if whole is None:
        return GAZEBO_REFUSES
    try:
        bodies = reduce_fixed_joints(model).body_by_link
        merged = weigh_body(model, tuple(name for name, body in bodies.items() if body == bodies[link.name]))
    except FactUnavailableError:  # the robot is in pieces, which other rules report
        return GAZEBO_MERGES if whole.is_physically_valid(rel_tol) else GAZEBO_REFUSES
    is_possible = merged is not None and MergedBody("", merged.moments, False).is_physically_valid(rel_tol)
    return GAZEBO_MERGES if is_possible else GAZEBO_REFUSES
