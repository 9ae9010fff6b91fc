"""Pairs whose joints need not move: what they draw is mirrored already, or each is the mirror image of the other's neighbour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.likeness.mirror import MirrorPlane
from urdfcheck.model.likeness.mirror_pairs import PLACE, MirrorPair
from urdfcheck.model.likeness.mirrored_joints import measure_axis_offset
from urdfcheck.model.likeness.shape_comparison import compute_centroid, is_alike
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Drawings that are so many times nearer to mirror images than the frames of their joints show where the parts are (chosen).
_NEARER = 5.0
# Neighbours that are so many times nearer to mirror images than namesakes are the true pairs (chosen).
_NEIGHBOURS_NEARER = 20.0
# So many other pairs are drawn on both sides of one plane before it is the robot's.
_WITNESSES = 2


def is_settled(model: Model, links: Sequence[str], pairs: Sequence[MirrorPair]) -> bool:
    """Whether some of the pairs that hold all these links are in their places, whatever their joints' origins say.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    own = [pair for pair in pairs if {*links} <= {pair.one, pair.other}]
    return any(_is_drawn_in_place(model, pair, pairs) or _is_crossed(model, pair, pairs) for pair in own)


def is_drawn_nearer(model: Model, pair: MirrorPair, distance: float) -> bool:
    """Whether what a pair draws is far nearer to mirror images than the frames of its joints, which are ``distance`` m off, and
    the joints are on the same lines, or fixed: then only the frames are placed otherwise, and a new origin would move the parts
    out of place.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    one, other = compute_centroid(model, pair.one), compute_centroid(model, pair.other)
    if one is None or other is None or not is_alike(model, pair.one, pair.other):
        return False
    is_fixed = all(model.tree.parent_joint[name].type == "fixed" for name in (pair.one, pair.other))
    across = 0.0 if is_fixed else measure_axis_offset(model, pair)
    drawn = float(np.linalg.norm(pair.plane.reflect_points(one) - other))
    return _NEARER * max(across, drawn) <= distance


def _is_drawn_in_place(model: Model, pair: MirrorPair, pairs: Sequence[MirrorPair]) -> bool:
    """Whether a pair draws one part, mirrored or not, on either side of a plane beside which other pairs are drawn too.

    A mesh may be about another point on one side, which the origin of the joint takes back.
    """
    plane = _find_plane_between(model, pair, pair.plane.normal)
    if plane is None or not is_alike(model, pair.one, pair.other):
        return False
    others = (other for other in pairs if not other.is_attached_to(pair))
    near = [between for other in others if (between := _find_plane_between(model, other, plane.normal)) is not None]
    return sum(abs(between.offset - plane.offset) <= PLACE for between in near) >= _WITNESSES


def _find_plane_between(model: Model, pair: MirrorPair, normal: Array) -> MirrorPlane | None:
    """Return the plane with a normal (3,) between what both links of a pair draw; None where they are not opposite."""
    one, other = compute_centroid(model, pair.one), compute_centroid(model, pair.other)
    if one is None or other is None:
        return None
    plane = MirrorPlane(normal, float(normal @ (one + other)) / 2.0)
    off = float(np.linalg.norm(plane.reflect_points(one) - other))
    return plane if off <= PLACE < abs(float(normal @ (one - other))) else None


def _is_crossed(model: Model, pair: MirrorPair, pairs: Sequence[MirrorPair]) -> bool:
    """Whether each link of a pair is the mirror image of a neighbour of the other one: a gripper that is rotated by half a turn
    has its first finger where the mirror has the second, and rods may be numbered from one side to the other."""
    joints = model.tree.parent_joint
    for near in pairs:
        if near is pair or near.plane.normal @ pair.plane.normal < 1 - 1e-6:
            continue
        for one, other in ((near.one, near.other), (near.other, near.one)):
            if _hang_together(joints[pair.one], joints[one]) and _hang_together(joints[pair.other], joints[other]):
                crossed = (pair.one, other), (pair.other, one)
                return _are_mirrored(model, pair, *crossed)
    ends = ((pair.one, pair.other), (pair.other, pair.one))
    return joints[pair.one].parent != joints[pair.other].parent and all(
        any(_are_mirrored(model, pair, (name, near)) for near in _list_neighbours(model, other)) for name, other in ends
    )


def _list_neighbours(model: Model, name: str) -> list[str]:
    """List the other links that joints of one type hang on what a link hangs on."""
    own = model.tree.parent_joint[name]
    return [one.child for one in model.tree.child_joints[own.parent] if one is not own and one.type == own.type]


def _hang_together(one: Joint, other: Joint) -> bool:
    return one.parent == other.parent and one.type == other.type


def _are_mirrored(model: Model, pair: MirrorPair, *crossed: tuple[str, str]) -> bool:
    """Whether the links of each ``crossed`` pair are mirror images, exactly or far more nearly than those of the pair itself."""

    def measure_offset(one: str, other: str) -> float:
        places = [model.frames[name][:3, 3] for name in (one, other)]
        return float(np.linalg.norm(pair.plane.reflect_points(places[0]) - places[1]))

    slack = max(PLACE, measure_offset(pair.one, pair.other) / _NEIGHBOURS_NEARER)
    return all(measure_offset(*names) <= slack for names in crossed)
