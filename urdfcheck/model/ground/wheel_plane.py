"""How the wheels of a robot touch one plane, and the one of them that does not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.median import compute_median
from urdfcheck.facts.motion.contact import compute_rocking_gaps
from urdfcheck.model.ground.wheels import LEVEL, Wheel, find_lowest_z, is_suspended, rolling_wheels
from urdfcheck.model.robot import Model
from urdfcheck.model.wheel_names import CASTER_NAME, WHEEL_NAME

# A wheel whose lowest point is farther from the others' than this share of a radius is not meant to stand on the ground.
_AWAY = 0.2
# Two axles stand on the ground whatever their heights, with equal wheels on each; more do not.
_AXLES = 3
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
    are_axles: bool
    """Whether there are three and more axles, each with wheels at one height: raised axles are by design."""


def find_uneven_wheels(model: Model, *, rel_tol: float, abs_tol: float) -> UnevenWheels | None:
    """Find the wheels that rock by more than ``rel_tol`` (of the least radius) and ``abs_tol`` (m).

    None when they do not, one of them is suspended, or the robot also stands on others.

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
    if _has_other_support(model, wheels):
        return None
    gap = float(gaps.max())
    return UnevenWheels(wheels, gap, _find_odd_wheel(wheels, gap), _stand_on_axles(wheels, gap))


def _select_grounded_wheels(wheels: Sequence[Wheel]) -> tuple[Wheel, ...]:
    """Drop the wheels above the ground: two or more whose lowest points are elsewhere, or one of another size.

    None are left if such wheels are below the others: then it is these that the robot stands on.
    """
    usual = compute_median([wheel.radius for wheel in wheels])
    ground = compute_median([wheel.contact[2] for wheel in wheels])
    away = [wheel for wheel in wheels if abs(wheel.contact[2] - ground) > _AWAY * usual]
    alike = len(away) == 1 and abs(away[0].radius - usual) < _AWAY * usual
    if not alike and any(wheel.contact[2] < ground for wheel in away):
        return ()
    return tuple(wheel for wheel in wheels if alike or wheel not in away)


def _has_other_support(model: Model, wheels: Sequence[Wheel]) -> bool:
    """Whether a wheel or caster by its name is not among the wheels, fixed for example, and reaches as low as one of them."""
    parts = {name for wheel in wheels for name in model.tree.list_body_links(wheel.joint.child)}
    others = [link for link in model.links if link.name not in parts]
    named = (link for link in others if WHEEL_NAME.search(link.name) or CASTER_NAME.search(link.name))
    return any(find_lowest_z(model, link) <= max(wheel.bottom for wheel in wheels) for link in named)


def _stand_on_axles(wheels: Sequence[Wheel], gap: float) -> bool:
    """Whether there are three and more axles, each of two wheels and more, at one height across the robot."""
    axles: list[list[Wheel]] = []
    for wheel in wheels:
        axle = next((one for one in axles if _is_on_axle(wheel, one[0])), None)
        if axle is None:
            axles.append([wheel])
        else:
            axle.append(wheel)
    heights = [[float(wheel.contact[2]) for wheel in axle] for axle in axles]
    return len(axles) >= _AXLES and all(len(one) > 1 and max(one) - min(one) <= _EXPLAINED * gap for one in heights)


def _is_on_axle(wheel: Wheel, other: Wheel) -> bool:
    """Whether two wheels are beside each other: apart along their axis only, seen from above."""
    apart = (wheel.centre - other.centre)[:2]
    across = np.array((-other.axis[1], other.axis[0]))
    return abs(float(apart @ across)) < _AWAY * other.radius and abs(float(wheel.axis @ other.axis)) > 1 - LEVEL


def _find_odd_wheel(wheels: Sequence[Wheel], gap: float) -> OddWheel | None:
    """Find the only wheel whose lowest point is at another height than those of all others; None when several are off."""
    heights = np.array([wheel.contact[2] for wheel in wheels])
    usual = compute_median(heights)
    off = np.flatnonzero(np.abs(heights - usual) > _EXPLAINED * gap)
    if len(off) != 1:
        return None
    wheel = wheels[int(off[0])]
    radii = [other.radius for other in wheels if other is not wheel]
    smaller = max(radii) - wheel.radius if max(radii) - min(radii) < _EXPLAINED * gap else 0.0
    return OddWheel(wheel, float(heights[off[0]]) - usual, smaller)
