"""Slips of the pen in the origin of a joint that its twin on the other side shows: a sign, or a decimal point."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.likeness.mirror import measure_outline_mismatch
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import PLACE, MirrorPair, mirror_pairs
from urdfcheck.model.likeness.mirrored_joints import WITNESSES
from urdfcheck.model.likeness.shape_comparison import ALIKE, get_outline
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Numbers agree within this share of the origin's length, three typed digits, and within a careful hand measurement.
_SAME = 0.005
# A coordinate that is smaller than this share of the origin's length, or than so many metres, has a sign by rounding.
_LEAST_SHARE, _LEAST = 0.05, 2e-3
_POWERS = (10.0, 100.0, 1000.0)
# Axes of frames are parallel within this (1 - cosine, as an element of the rotation).
_PARALLEL = 2e-3
# Joints that open by sliding may begin in one place.
_TURNING = frozenset({"revolute", "continuous"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OriginSlip:
    """A joint whose origin is that of its twin's mirror image, apart from one slip."""

    joint: Joint
    twin: Joint
    kind: str
    """``sign``: one coordinate has the other sign. ``decimal``: a coordinate, or all, are a power of ten larger."""
    expected: Array
    """(3,) in m: the origin of ``joint`` if ``twin`` is right."""
    twin_expected: Array
    """(3,) in m: the origin of ``twin`` if ``joint`` is right."""


@fact
def find_origin_slips(model: Model) -> tuple[OriginSlip, ...]:
    """Find the slips in origins of left and right joints whose parents are in their places, those nearest to the root first.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    pairs = mirror_pairs(model)
    return tuple(slip for pair in pairs if (slip := _find_slip(model, pair, pairs)) is not None)


def _find_slip(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> OriginSlip | None:
    if pair.agreeing_pairs < WITNESSES or not pair.is_named or pair.is_in_place:
        return None
    one, other = (model.tree.parent_joint.get(name) for name in (pair.one, pair.other))
    if one is None or other is None or one.type != other.type or not _has_mirrored_parents(one, other, known_pairs):
        return None
    if np.allclose(one.origin.xyz or (0, 0, 0), other.origin.xyz or (0, 0, 0), rtol=0, atol=_LEAST):
        return None  # one module on both sides
    if pair.drawn_as != "mirrored" and not _is_parallel(model, pair):
        return None  # a part that is rotated by half a turn may be placed by half a turn as well
    both = [_compute_image(model, pair, joint, twin) for joint, twin in ((one, other), (other, one))]
    for joint, twin, expected, back in ((other, one, both[1], both[0]), (one, other, both[0], both[1])):
        kind = _name_slip(np.array(joint.origin.xyz or (0.0, 0.0, 0.0)), expected)
        if kind is not None:
            return OriginSlip(joint=joint, twin=twin, kind=kind, expected=expected, twin_expected=back)
    return None


def _has_mirrored_parents(one: Joint, other: Joint, known_pairs: Sequence[MirrorPair]) -> bool:
    """Whether both joints hang on one link, or on links that are a pair in its place."""
    if one.parent == other.parent:
        return True
    parents = {one.parent, other.parent}
    return any({pair.one, pair.other} == parents and pair.is_in_place for pair in known_pairs)


def _is_parallel(model: Model, pair: MirrorPair) -> bool:
    """Whether the frames of both sides have the same axes, all joints at zero."""
    one, other = (model.frames[name][:3, :3] for name in (pair.one, pair.other))
    return bool(np.abs(one - other).max() < _PARALLEL)


def _compute_image(model: Model, pair: MirrorPair, joint: Joint, twin: Joint) -> Array:
    """Compute the origin (3,) of a joint in its parent's frame if it is the mirror image of its twin."""
    parent = model.frames[joint.parent]
    image: Array = parent[:3, :3].T @ (pair.plane.reflect_points(model.frames[twin.child][:3, 3]) - parent[:3, 3])
    return image


def _name_slip(typed: Array, expected: Array) -> str | None:
    """Name the slip that makes ``typed`` (3,) of ``expected``; None if there is no such slip."""
    length = float(np.linalg.norm(expected))
    near = min(PLACE, _SAME * length)
    least = max(_LEAST_SHARE * length, _LEAST)
    off = np.abs(typed - expected) > near
    if int(off.sum()) == 1 and abs(expected[off][0]) > least and abs(typed[off][0] + expected[off][0]) <= near:
        return "sign"
    for power in _POWERS:
        slipped = np.where(off, expected * power, expected)
        if np.abs(expected[off]).max(initial=0.0) > least and np.abs(typed - slipped).max() <= power * near:
            return "decimal"
    return None


def iter_coincident_twins(model: Model) -> Iterator[tuple[Joint, Joint]]:
    """Yield left and right joints that turn one part in one place, away from the frame of the link on which both hang.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree, frames = model.tree, model.frames
    for names in pair_by_name(tree.order):
        one, other = (tree.parent_joint.get(name) for name in names)
        if one is None or other is None or one.parent != other.parent or {one.type, other.type} - _TURNING:
            continue
        if one.mimic is not None or other.mimic is not None or one.origin.xyz is None:
            continue
        is_away = float(np.abs(one.origin.xyz).max()) > _LEAST
        is_same = np.allclose(frames[one.child], frames[other.child], rtol=0, atol=1e-6)
        if is_away and is_same and _is_one_body(model, *names):
            yield one, other


def _is_one_body(model: Model, one: str, other: str) -> bool:
    """Whether two links have one mass at one place of their frames, and draw one part there if it is known what they draw."""
    bodies = [read_declared_inertial(model.link_by_name[name]) for name in (one, other)]
    masses = [(body.mass, *np.round(body.com, 6).tolist()) for body in bodies if body is not None]
    if len(masses) != 2 or masses[0] != masses[1]:
        return False
    first, second = (get_outline(model, name) for name in (one, other))
    if first is None or second is None:
        return first is second
    return measure_outline_mismatch(first, second, linear=np.eye(3), shift=np.zeros(3)) < ALIKE
