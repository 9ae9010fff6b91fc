"""What inertials declare, carried over to the mirror image or the copy of a link."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

from collections.abc import Iterable
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.likeness.mirror import measure_deviation
from urdfcheck.model.likeness.mirror_pairs import CopyTransform, MirrorPair, mirror_pairs
from urdfcheck.model.likeness.shape_comparison import DIFFERENT
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model


def read_declared_inertial(link: Link) -> DeclaredInertial | None:
    """Read the link's ``<inertial>``; None when there is none, a number is malformed or the mass is not positive."""
    inertial = link.inertial
    if inertial is None or inertial.mass is None or not inertial.mass > 0 or inertial.tensor is None:
        return None
    matrix = inertial.origin.matrix
    if matrix is None:
        return None
    return DeclaredInertial(mass=inertial.mass, com=matrix[:3, 3], tensor=inertial.tensor, rotation=matrix[:3, :3])


def turn_inertial(numbers: DeclaredInertial, linear: Array, *, com: Array) -> DeclaredInertial:
    """Turn (or mirror) an inertial by an orthogonal ``linear`` (3, 3), and put its COM at ``com`` (3,)."""
    # -1 turns an improper rotation into a proper one, and leaves every tensor as it is.
    proper = linear if np.linalg.det(linear) > 0 else -linear
    return DeclaredInertial(mass=numbers.mass, com=com, tensor=numbers.tensor, rotation=proper @ numbers.rotation)


def mirror_inertial(numbers: DeclaredInertial, pair: MirrorPair, *, inverse: bool = False) -> DeclaredInertial:
    """Return what the inertial of ``pair.other`` should be by that of ``pair.one``; with ``inverse`` the other way round.

    The tensor stays, and its axes are mirrored and turned over, so that they stay right-handed.
    """
    linear = pair.linear.T if inverse else pair.linear
    shift = np.zeros(3)
    if pair.uses_shift:
        shift = -pair.linear.T @ pair.shift if inverse else pair.shift
    return turn_inertial(numbers, linear, com=linear @ numbers.com + shift)


def copy_inertial(numbers: DeclaredInertial, copy: CopyTransform, *, inverse: bool = False) -> DeclaredInertial:
    """Return the inertial of one link as that of another that holds the same part; with ``inverse`` the other way round."""
    rotation, translation = copy.rotation, copy.translation
    if inverse:
        rotation, translation = rotation.T, -rotation.T @ translation
    return turn_inertial(numbers, rotation, com=rotation @ numbers.com + translation)


def estimate_from_twin(model: Model, link: Link, among: Iterable[MirrorPair] | None = None) -> DeclaredInertial | None:
    """Estimate an inertial from the other side's link, mirrored and in the frame of this one.

    ``among``: the pairs, where they are known. Only where what both draw says that the parts are mirror images, and their poses
    are. For a symmetric part, which a copy may represent as well, it is the copy where that is nearer to what this link declares.
    """
    declared = read_declared_inertial(link)
    for pair in mirror_pairs(model) if among is None else among:
        if link.name not in {pair.one, pair.other} or pair.drawn_as not in {"mirrored", "both"}:
            continue
        inverse = pair.one == link.name
        twin = read_declared_inertial(model.link_by_name[pair.other if inverse else pair.one])
        if twin is None:
            continue
        mirrored = mirror_inertial(twin, pair, inverse=inverse)
        if declared is None:
            return mirrored
        copies = [
            copy_inertial(twin, copy, inverse=inverse) for copy in pair.copy_transforms if copy.mismatch < DIFFERENT
        ]
        choices = [(measure_deviation(declared, choice).worst, choice) for choice in (mirrored, *copies)]
        return min(choices, key=itemgetter(0))[1]
    return None
