"""Tensors that are too large for what the link draws."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.text import format_length
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments
from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor, propose_drawn_inertial
from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal
from urdfcheck.model.inertials.reach import measure_reach
from urdfcheck.model.parts import DeclaredTensor
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3, Vec3

# The moments of all mass at twice the drawn part's size exceed those of any part like it: no small change makes a tensor right
# that has more.
_OTHER_SIZE = 1.0
# Real parts are not uniform. Of 353 sound tensors of links that draw closed meshes (38 repositories), 92 % have all principal
# moments within this factor of the uniform part's; of 353 that are not sound, 48 %.
_UNLIKE = 2.0
# Hollow parts, and parts of several materials, are not so far from the uniform one in their smallest moment.
_THICKER = 10.0
# Points on a line have a smallest moment of 0; that of a rod ten times as long as thick is 1.5 % of the largest.
_LINE = 1e-2
# Why collision shapes replace a visual mesh in what is said to be drawn.
_STANDS_IN = frozenset({"open", "unread", "wrong size"})
# A tensor is that of no part of the robot where it needs a body so many times as long as the robot stretched out (chosen).
_BEYOND = 1.5
# Three digits of a moment, as most are typed.
_SAME_MOMENT = 5e-3


def propose_other_size(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose the drawn part's inertia where no part of its size can have the moments, so that no small change helps; None
    where one can."""
    excess = _measure_size_excess(model, declared)
    if not excess > _OTHER_SIZE:
        return None
    times, least = _format_factor(_compare_with_drawn(model, declared)), _format_factor(excess)
    stands_in = explain_collision_stand_in(model, declared.link) in _STANDS_IN
    part = "collision shape" if stands_in else "drawn part"
    claim = (
        f"; for this mass the moments are {times} times the {part}'s, and at least {least} times what its size allows"
    )
    return replace(propose_drawn_inertial(model, declared.link, claim), oversize=times)


def describe_spread_beyond_robot(model: Model, declared: DeclaredTensor) -> str:
    """Say that the tensor is one of a longer body than the robot, whatever the link draws; empty where it is not.

    The robot spans what its joints and known shapes do: a mesh that was not read hardly makes it longer.
    """
    mass = declared.inertial.mass
    try:
        reach = measure_reach(model, with_shapes=True, with_unread=False)
    except FactUnavailableError:
        return ""
    if reach is None or mass is None or not mass > 0.0:
        return ""
    # The second moment along an axis is half the sum of the moments, less the one about it.
    spread = max(0.0, sum(declared.moments) / 2.0 - declared.moments[0]) / mass
    span = 2.0 * spread**0.5  # no shorter body has such a spread
    if not span > _BEYOND * reach:
        return ""
    body = f"a body at least {format_length(span)} long"
    return f"; with {mass:.3g} kg they are those of {body}, and the robot spans {format_length(reach)}"


def is_unlike_drawn(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a link draws a closed solid, and a principal moment is less than half or more than twice that solid's: then a small
    change that makes the tensor possible does not make it right."""
    drawn = _compute_solid_tensor(model, declared)
    if drawn is None:
        return False
    moments, wanted = compute_principal_moments(declared.tensor)[0], compute_principal_moments(drawn)[0]
    return bool(((moments > _UNLIKE * wanted) | (_UNLIKE * moments < wanted)).any())


def find_thicker_part(model: Model, declared: DeclaredTensor) -> Vec3 | None:
    """Return the principal moments (3,) in kg m², ascending, of the closed solid that a link draws, if the typed tensor is one of
    points on a line, and its smallest moment less than a tenth of the solid's; None otherwise.
    """
    drawn = _compute_solid_tensor(model, declared)
    if drawn is None or explain_collision_stand_in(model, declared.link) in _STANDS_IN:
        return None
    typed, wanted = compute_principal_moments(declared.tensor)[0], compute_principal_moments(drawn)[0]
    is_line = typed[0] < _LINE * typed[2]
    return wanted if is_line and _THICKER * typed[0] < wanted[0] else None


def has_drawn_moment(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a moment is that of the closed solid which the link draws, at its mass: then the others are to be that solid's too,
    and not the nearest that a body can have."""
    drawn = _compute_solid_tensor(model, declared)
    if drawn is None:
        return False
    return bool(np.isclose(np.diag(declared.tensor), np.diag(drawn), rtol=_SAME_MOMENT, atol=0.0).any())


def _compute_solid_tensor(model: Model, declared: DeclaredTensor) -> Mat3 | None:
    """Compute the tensor (3, 3) of the closed solid that a link draws, at its mass and in the axes of its inertial."""
    geometry = measure_link_geometry(model, declared.link)
    return compute_drawn_tensor(model, declared) if geometry is not None and geometry.closed else None


def _measure_size_excess(model: Model, declared: DeclaredTensor) -> float:
    """Return how many times the moments exceed those of the link's mass at twice the drawn part's size from the COM; zero where
    nothing is drawn."""
    drawn, mass = measure_link_geometry(model, declared.link), declared.inertial.mass
    if drawn is None or mass is None or not mass > 0.0:
        return 0.0
    farthest = 2.0 * measure_extent(drawn.points)
    most = 2.0 * mass * farthest * farthest  # ∫ r² dm is half the sum of the moments
    return float(np.trace(declared.tensor)) / most if most > 0.0 else 0.0


def _compare_with_drawn(model: Model, declared: DeclaredTensor) -> float:
    """Return how many times the moments are those of what the link draws, at its mass; infinite where that has none."""
    drawn = compute_drawn_tensor(model, declared)
    size = 0.0 if drawn is None else float(np.trace(drawn))
    return float(np.trace(declared.tensor)) / size if size > 0.0 else np.inf


def _format_factor(factor: float) -> str:
    rounded = float(f"{factor:.2g}")
    return f"{rounded:,.0f}" if 100.0 <= rounded < 1e6 else f"{rounded:g}"
