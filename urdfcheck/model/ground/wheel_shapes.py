"""What wheels collide as, against what they draw."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.model.ground.wheels import Wheel, rolling_wheels
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_shape_corners

if TYPE_CHECKING:
    from urdfcheck.facts.likeness.revolution import RoundOutline
    from urdfcheck.model.parts import Shape

# Metres: where the drawing of the base shows the wheels, a link for a wheel draws a mark of this radius instead.
_MARKER = 0.0101


@dataclass(frozen=True, slots=True, eq=False)
class WheelSizeDifference:
    """A wheel that rolls on another radius than the drawn one."""

    wheel: Wheel
    radius: float
    """Metres: of what it collides as."""
    drawn: float
    """Metres: of what it draws."""


def find_wheel_size_differences(model: Model, *, ratio: float) -> Iterator[WheelSizeDifference]:
    """Find the wheels whose two radii differ by more than a factor of ``ratio``; both shapes are round about the joint's axis.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    for wheel in rolling_wheels(model):
        link = model.link_by_name[wheel.joint.child]
        if not link.collisions or not link.visuals:
            continue
        reaches = [_measure_reach(model, wheel, shapes) for shapes in (link.visuals, link.collisions)]
        if min(reaches) * ratio >= max(reaches):
            continue
        drawn = _measure_round_shapes(model, wheel, link.visuals)
        collides = None if drawn is None else _measure_round_shapes(model, wheel, link.collisions)
        if drawn is None or collides is None:
            continue
        if drawn.radius <= _MARKER and collides.radius > 2 * drawn.radius:
            continue
        if not 1 / ratio <= collides.radius / drawn.radius <= ratio:
            yield WheelSizeDifference(wheel, collides.radius, drawn.radius)


def _measure_reach(model: Model, wheel: Wheel, shapes: tuple[Shape, ...]) -> float:
    """Measure the radius (m) of shapes about a wheel's axis, whether they are round or not, which costs more to find out; 0 where
    a shape is not known."""
    points = collect_shape_corners(model, shapes)
    if points is None or not len(points):
        return 0.0
    axis = model.frames[wheel.joint.child][:3, :3].T @ wheel.axis
    squares = np.einsum("ij,ij->i", points, points) - (points @ axis) ** 2
    return float(np.sqrt(max(squares.max(), 0.0)))


def _measure_round_shapes(model: Model, wheel: Wheel, shapes: tuple[Shape, ...]) -> RoundOutline | None:
    from urdfcheck.facts.likeness.revolution import measure_outline

    points = collect_shape_corners(model, shapes)
    if points is None or not len(points):
        return None
    frame = model.frames[wheel.joint.child]
    outline = measure_outline(points @ frame[:3, :3].T + frame[:3, 3], wheel.axis, frame[:3, 3])
    return outline if outline.is_round() else None
