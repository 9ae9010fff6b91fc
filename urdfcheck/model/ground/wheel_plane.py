"""How the wheels of a robot touch one plane, and the one of them that does not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from urdfcheck.facts.motion.contact import compute_rocking_gaps
from urdfcheck.model.ground.wheels import Wheel, is_suspended, rolling_wheels
from urdfcheck.model.robot import Model

# A wheel whose lowest point is farther from the others' than this share of a radius is not meant to stand on the ground.
_AWAY = 0.2
# A difference below this share of the gap does not cause it.
_EXPLAINED = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class OddWheel:
    """The one wheel that is off."""

    wheel: Wheel
    rise: float
    """Metres: how far its lowest point is above the others'."""
    radius_deficit: float
    """Metres: how far its radius is below theirs; 0 where they differ among themselves."""

    @property
    def is_caused_by_radius(self) -> bool:
        """Whether its axle is where it should be, and its radius the reason."""
        return abs(self.radius_deficit - self.rise) < _EXPLAINED * abs(self.rise)


@dataclass(frozen=True, slots=True, eq=False)
class UnevenWheels:
    """Four and more wheels that do not touch one plane."""

    wheels: Sequence[Wheel]
    gap: float
    """Metres: whichever three wheels the robot stands on, another hangs this far in the air."""
    odd_wheel: OddWheel | None
    """The wheel that is the reason; None when several are off."""


def find_uneven_wheels(model: Model, *, rel_tol: float, abs_tol: float) -> UnevenWheels | None:
    """Find the wheels that rock by more than ``rel_tol`` (of the least radius) and ``abs_tol`` (m).

    None when they do not, or one of them is suspended.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    wheels = rolling_wheels(model)
    if len(wheels) < 4 or any(is_suspended(model, wheel.joint.child) for wheel in wheels):
        return None
    wheels = _select_grounded_wheels(wheels)
    if len(wheels) < 4:
        return None
    gaps = compute_rocking_gaps(np.array([wheel.contact for wheel in wheels]))
    if gaps is None or gaps.max() <= max(rel_tol * min(wheel.radius for wheel in wheels), abs_tol):
        return None
    gap = float(gaps.max())
    return UnevenWheels(wheels, gap, _find_odd_wheel(wheels, gap))


def _select_grounded_wheels(wheels: Sequence[Wheel]) -> tuple[Wheel, ...]:
    """Drop the wheels that do not stand on the ground: two or more whose lowest points are elsewhere, or one of another size."""
    usual = float(np.median([wheel.radius for wheel in wheels]))
    ground = float(np.median([wheel.contact[2] for wheel in wheels]))
    away = [wheel for wheel in wheels if abs(wheel.contact[2] - ground) > _AWAY * usual]
    alike = len(away) == 1 and abs(away[0].radius - usual) < _AWAY * usual
    return tuple(wheel for wheel in wheels if alike or wheel not in away)


def _find_odd_wheel(wheels: Sequence[Wheel], gap: float) -> OddWheel | None:
    """Find the only wheel whose lowest point is at another height than those of all others; None when several are off."""
    heights = np.array([wheel.contact[2] for wheel in wheels])
    usual = float(np.median(heights))
    off = np.flatnonzero(np.abs(heights - usual) > _EXPLAINED * gap)
    if len(off) != 1:
        return None
    wheel = wheels[int(off[0])]
    radii = [other.radius for other in wheels if other is not wheel]
    smaller = max(radii) - wheel.radius if max(radii) - min(radii) < _EXPLAINED * gap else 0.0
    return OddWheel(wheel, float(heights[off[0]]) - usual, smaller)
