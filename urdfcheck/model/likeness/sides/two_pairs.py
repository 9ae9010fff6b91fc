"""Three equal joints and another: that may also be two mirrored pairs of which one of the three is wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

# More joints that agree are no two pairs.
_TWO_PAIRS = 3
# Numbers of axes and rotations agree within this.
_SAME = 1e-2


def may_be_two_pairs(model: Model, joint: Joint, others: Sequence[Joint], attribute: str) -> bool:
    """Whether the axis or the rotation of a joint (``attribute``: ``axis`` or ``rpy``) is the mirror image of that of three equal
    joints, and nothing shows that left and right have one convention: then one of the three may be the wrong one."""
    if len(others) > _TWO_PAIRS:
        return False
    if attribute == "rpy":
        turn, like = (rpy_to_matrix(one.origin.rpy or (0.0, 0.0, 0.0)) for one in (joint, others[0]))
        mirrors = (np.diag(signs) for signs in ((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0)))
        return any(float(np.abs(mirror @ like @ mirror - turn).max()) <= _SAME for mirror in mirrors)
    typed = [np.array(one.axis or (1.0, 0.0, 0.0)) for one in (joint, others[0])]
    lines = [model.axes[one.name] for one in (joint, others[0]) if one.name in model.axes]
    is_image = any(
        len(both) == 2 and float(np.abs(np.abs(both[0]) - np.abs(both[1])).max()) <= _SAME for both in (typed, lines)
    )
    return is_image and not _have_one_convention(model, (joint, *others))


def _have_one_convention(model: Model, joints: Sequence[Joint]) -> bool:
    """Whether the next joints of all these limbs, upwards or downwards, turn about parallel axes in one direction: two mirrored
    pairs have two."""
    like = model.axes.get(joints[-1].name)
    below = [[one for one in model.tree.child_joints[joint.child] if one.is_movable] for joint in joints]
    above = [[one] if (one := model.tree.parent_joint.get(joint.parent)) is not None else [] for joint in joints]
    for found in (below, above):
        nearby = [ones[0] for ones in found if len(ones) == 1 and ones[0].name in model.axes]
        if like is None or len({one.name for one in nearby}) != len(joints):
            continue
        along = [float(model.axes[one.name] @ like) for one in nearby]
        is_one_kind = len({(one.type, remove_places(one.child)) for one in nearby}) == 1
        if is_one_kind and min(map(abs, along)) > 1 - _SAME and abs(float(np.sign(along).sum())) == len(along):
            return True
    return False
