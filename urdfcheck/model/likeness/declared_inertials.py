"""What inertials declare, carried over to the mirror image or the copy of a link."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from urdfcheck.facts.inertials.diagnosis import DeclaredInertial
from urdfcheck.facts.likeness.mirror import measure_deviation
from urdfcheck.model.likeness.mirror_pairs import CopyTransform, MirrorPair, mirror_pairs
from urdfcheck.model.likeness.shape_comparison import DIFFERENT
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model


def read_declared_inertial(link: Link) -> DeclaredInertial | None:
    """What the link's ``<inertial>`` says; None when there is none, a number is malformed or the mass is not positive."""
    inertial = link.inertial
    if inertial is None or inertial.mass is None or not inertial.mass > 0 or inertial.tensor is None:
        return None
    matrix = inertial.origin.matrix
    return None if matrix is None else DeclaredInertial(inertial.mass, matrix[:3, 3], inertial.tensor, matrix[:3, :3])


def mirror_inertial(numbers: DeclaredInertial, pair: MirrorPair, *, inverse: bool = False) -> DeclaredInertial:
    """The inertial of ``pair.one`` as that of ``pair.other`` should be; with ``back`` the other way round.

    It keeps the tensor and mirrors its axes, which are turned over so that they stay right-handed.
    """
    linear = pair.linear.T if inverse else pair.linear
    shift = np.zeros(3)
    if pair.uses_shift:
        shift = -pair.linear.T @ pair.shift if inverse else pair.shift
    # -1 turns an improper rotation into a proper one, and leaves every tensor as it is.
    return DeclaredInertial(numbers.mass, linear @ numbers.com + shift, numbers.tensor, -linear @ numbers.rotation)


def copy_inertial(numbers: DeclaredInertial, copy: CopyTransform, *, inverse: bool = False) -> DeclaredInertial:
    """The inertial of one link as that of another that holds the same part; with ``back`` the other way round."""
    turn, move = (
        (copy.rotation.T, -copy.rotation.T @ copy.translation) if inverse else (copy.rotation, copy.translation)
    )
    return DeclaredInertial(numbers.mass, turn @ numbers.com + move, numbers.tensor, turn @ numbers.rotation)


def estimate_from_twin(model: Model, link: Link, among: Iterable[MirrorPair] | None = None) -> DeclaredInertial | None:
    """The inertial of the other side's link, mirrored and in the frame of this one. ``among``: the pairs, where they are known.

    Only where what both draw says that the parts are mirror images, and their poses are. Of a symmetric part, which a copy
    may stand for as well, it is the copy where that is nearer to what this link declares.
    """
    own = read_declared_inertial(link)
    for pair in mirror_pairs(model) if among is None else among:
        if link.name not in {pair.one, pair.other} or pair.drawn_as not in {"mirrored", "both"}:
            continue
        back = pair.one == link.name
        other = read_declared_inertial(model.link_by_name[pair.other if back else pair.one])
        if other is not None:
            choices = [mirror_inertial(other, pair, inverse=back)]
            choices += [
                copy_inertial(other, copy, inverse=back) for copy in pair.copy_transforms if copy.mismatch < DIFFERENT
            ]
            return choices[0] if own is None else min(choices, key=lambda one: measure_deviation(own, one).worst)
    return None
