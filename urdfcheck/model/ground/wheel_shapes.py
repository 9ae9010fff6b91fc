"""What wheels collide as, against what they draw."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.ground.wheels import Wheel, rolling_wheels
from urdfcheck.model.parts import is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_shape_corners

if TYPE_CHECKING:
    from urdfcheck.facts.likeness.revolution import RoundOutline
    from urdfcheck.model.parts import Shape

# Metres: how far from the axle the frame of a link is that turns about the same one.
_SAME_AXLE = 1e-3
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
    wheels = rolling_wheels(model)
    names = {wheel.joint.child for wheel in wheels}
    for wheel in wheels:
        links = [model.link_by_name[name] for name in _list_concentric_links(model, wheel, names)]
        if not links[0].collisions or not links[0].visuals:
            continue
        if len(links) == 1:  # whether shapes are round costs more to find out than how far they reach
            reaches = [_measure_reach(model, wheel, shapes) for shapes in (links[0].visuals, links[0].collisions)]
            if min(reaches) * ratio >= max(reaches):
                continue
        drawn = _measure_round_shapes(model, wheel, {link.name: link.visuals for link in links})
        colliding = {link.name: tuple(s for s in link.collisions if not is_dummy_shape(s)) for link in links}
        collides = None if drawn is None else _measure_round_shapes(model, wheel, colliding)
        if drawn is None or collides is None:
            continue
        if drawn.radius <= _MARKER and collides.radius > 2 * drawn.radius:
            continue
        if not 1 / ratio <= collides.radius / drawn.radius <= ratio:
            yield WheelSizeDifference(wheel, collides.radius, drawn.radius)


def _measure_reach(model: Model, wheel: Wheel, shapes: tuple[Shape, ...]) -> float:
    """Measure the radius (m) of shapes about a wheel's axis, round or not; 0 where a shape is not known."""
    points = collect_shape_corners(model, shapes)
    if points is None or not len(points):
        return 0.0
    axis = model.frames[wheel.joint.child][:3, :3].T @ wheel.axis
    squares = np.einsum("ij,ij->i", points, points) - (points @ axis) ** 2
    return float(np.sqrt(max(squares.max(), 0.0)))


def _list_concentric_links(model: Model, wheel: Wheel, wheels: Collection[str]) -> list[str]:
    """List the link of a wheel, and those about the same axle that it is joined with: a rim and its tyre are one wheel."""
    tree, name = model.tree, wheel.joint.child
    joints = [joint for joint in tree.child_joints[name] if joint.type in {"fixed", "continuous", "revolute"}]
    near = [joint.child for joint in joints] + [wheel.joint.parent] * (wheel.joint.parent in wheels)
    middle = model.frames[name][:3, 3]
    offsets = [model.frames[other][:3, 3] - middle for other in near]
    concentric = [
        other
        for other, offset in zip(near, offsets, strict=True)
        if float(np.linalg.norm(offset - (offset @ wheel.axis) * wheel.axis)) <= _SAME_AXLE
    ]
    return [name, *concentric]


def _measure_round_shapes(model: Model, wheel: Wheel, shapes: Mapping[str, tuple[Shape, ...]]) -> RoundOutline | None:
    """Measure shapes by their links about the axle; None if they are not round, or not known."""
    from urdfcheck.facts.likeness.revolution import measure_outline

    placed = []
    for name, some in shapes.items():
        points = collect_shape_corners(model, some) if some else None
        if points is None and some:
            return None
        if points is not None and len(points):
            frame = model.frames[name]
            placed.append(points @ frame[:3, :3].T + frame[:3, 3])
    if not placed:
        return None
    outline = measure_outline(np.concatenate(placed), wheel.axis, model.frames[wheel.joint.child][:3, 3])
    return outline if outline.is_round() else None
