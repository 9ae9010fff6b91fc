"""How the wheels of a robot stand on one plane, and the one of them that does not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.motion.contact import compute_rocking_gaps
from urdfcheck.model.ground.wheels import Wheel, is_suspended, rolling_wheels
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A wheel whose lowest point is farther from the others' than this part of a radius was not typed wrongly but stands on nothing.
_AWAY = 0.2
# What differs by less than this part of the gap does not make it.
_EXPLAINED = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class OddWheel:
    """The one wheel that is off: by its ``rise`` (m) its lowest point is above the others', and its radius by ``smaller`` (m)
    below theirs, 0 where they differ among themselves."""

    wheel: Wheel
    rise: float
    radius_deficit: float

    @property
    def is_caused_by_radius(self) -> bool:
        """Whether its axle is where it should be, and its radius the reason."""
        return abs(self.radius_deficit - self.rise) < _EXPLAINED * abs(self.rise)


@dataclass(frozen=True, slots=True, eq=False)
class UnevenWheels:
    """Four and more ``wheels`` that do not touch one plane: whichever three the robot stands on, another hangs ``gap`` (m) in
    the air. ``odd``: the one that is the reason, None when several are off."""

    wheels: Sequence[Wheel]
    gap: float
    odd_wheel: OddWheel | None


def find_uneven_wheels(model: Model, *, rel_tol: float, abs_tol: float) -> UnevenWheels | None:
    """The wheels that rock by more than ``spread`` (parts of the least radius) and ``least`` (m); None when they do not, or one
    of them is suspended.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    found = rolling_wheels(model)
    if len(found) < 4 or any(is_suspended(model, wheel.joint.child) for wheel in found):
        return None
    found = _select_grounded_wheels(found)
    if len(found) < 4:
        return None
    gaps = compute_rocking_gaps(np.array([wheel.contact for wheel in found]))
    if gaps is None or gaps.max() <= max(rel_tol * min(wheel.radius for wheel in found), abs_tol):
        return None
    gap = float(gaps.max())
    return UnevenWheels(found, gap, _find_odd_wheel(found, gap))


def _select_grounded_wheels(found: Sequence[Wheel]) -> tuple[Wheel, ...]:
    """The wheels without those that stand on nothing: two or more whose lowest points are elsewhere, or one of another size."""
    usual = float(np.median([wheel.radius for wheel in found]))
    ground = float(np.median([wheel.contact[2] for wheel in found]))
    away = [wheel for wheel in found if abs(wheel.contact[2] - ground) > _AWAY * usual]
    alike = len(away) == 1 and abs(away[0].radius - usual) < _AWAY * usual
    return tuple(wheel for wheel in found if alike or wheel not in away)


def _find_odd_wheel(found: Sequence[Wheel], gap: float) -> OddWheel | None:
    """The only wheel whose lowest point is at another height than those of all others; None when several are off."""
    heights = np.array([wheel.contact[2] for wheel in found])
    usual = float(np.median(heights))
    off = np.flatnonzero(np.abs(heights - usual) > _EXPLAINED * gap)
    if len(off) != 1:
        return None
    wheel = found[int(off[0])]
    radii = [other.radius for other in found if other is not wheel]
    smaller = max(radii) - wheel.radius if max(radii) - min(radii) < _EXPLAINED * gap else 0.0
    return OddWheel(wheel, float(heights[off[0]]) - usual, smaller)
