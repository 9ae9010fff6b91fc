"""GEO005 reports equal visual and collision shapes of a link that have different origins."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.small_matrices import list_entries, subtract
from urdfcheck.model import Link, Model
from urdfcheck.model.shapes.displaced_collisions import DisplacedCollision, list_displaced_collisions

# A COM is that of the collision if it is so near, as a share of the size, and so many times nearer than to the visual.
_NEAR, _NEARER = 0.25, 3.0
# Primitives are placed by hand, and drawn a little off others that would flicker: no further than the margin that Bullet adds to
# each (m; the option ``distance`` has its name), with what rounding leaves.
_MARGIN = 1.000001e-3
# So many links are drawn rotated alike on purpose.
_VIEWED = 3
_EITHER = "copy the <origin> of the <visual> to the <collision>, or vice versa, whichever is right"
# One shape may stand for several that are drawn.
_FEWER = (
    "give each of the {} visuals of this shape a <collision>, or one that covers them all; "
    "copy the <origin> of a <visual> only if just that is to collide"
)
_BOTH = (
    "if what is drawn is right, move <collision> and <inertial> there; "
    "otherwise copy the <origin> of the <collision> to the <visual>"
)
_DRAWING = (
    "nothing if a viewer needs the visuals rotated; otherwise copy the <origin> of each <collision> to the <visual>"
)


def check(
    model: Model, rule: Rule, *, distance: float, angle: float, apart: float, rotated: float
) -> Iterator[Finding]:
    all_displaced = [*list_displaced_collisions(model, distance=distance, angle=angle)]
    viewed = _list_rotated_drawings(model, all_displaced, distance=distance, angle=angle)
    for displaced in all_displaced:
        collision = displaced.collision
        # An angle in degrees is not one in radians (JNT012): how far the two are rotated is not known before it is corrected.
        is_known = not displaced.has_angles_beyond_turns
        if not is_known and displaced.moved <= distance:
            continue
        is_turned = is_known and displaced.turned > angle
        if collision.shape.kind != "mesh" and displaced.moved <= _MARGIN and not is_turned:
            continue
        xyz = collision.shape.origin.get_attribute("xyz")
        nearer = _compare_com_distances(model, displaced.link)
        is_com_there = nearer >= _NEARER and not _has_typed_com(displaced)
        is_viewed = displaced.link.name in viewed
        is_for_several = displaced.counts[0] > displaced.counts[1]
        is_wide = displaced.moved > apart or (is_known and displaced.turned > rotated)
        yield rule.finding(
            "differs",
            at=collision.place,
            related=[displaced.visual.place],
            cause="rpy_in_xyz"
            if displaced.has_angles_as_position
            else "viewer"
            if is_viewed
            else "com"
            if is_com_there
            else None,
            # The COM is on the side of the collision: to move that would spoil it.
            edits=displaced.propose_edits() if is_known and nearer <= 1.0 and not is_for_several else (),
            severity=Severity.WARNING if is_wide and not is_viewed and not _only_carries_sensors(model) else None,
            repair=_DRAWING
            if is_viewed
            else _FEWER.format(displaced.counts[0])
            if is_for_several
            else _BOTH
            if is_com_there
            else _EITHER,
            link=displaced.link.name,
            mesh=collision.what,
            shape=f"mesh {collision.what}" if collision.shape.kind == "mesh" else collision.what,
            moved=float(f"{displaced.moved:.4g}"),
            turned=float(f"{displaced.turned:.4g}"),
            degrees=math.degrees(displaced.turned),
            gap=displaced.describe_gap(with_angle=is_known),
            # Whose boxes are apart is then no news.
            explains=[f"GEO003 {displaced.link.element.label}"] if displaced.moved > apart else [],
            xyz="" if xyz is None else xyz.value,
        )


def _only_carries_sensors(model: Model) -> bool:
    """Whether a model is a stand with sensors, such as a camera on the ceiling, which hardly anything touches."""
    from urdfcheck.model.motion.fixed_base import is_sensor_stand  # loads numpy

    return is_sensor_stand(model)


def _list_rotated_drawings(
    model: Model, found: Sequence[DisplacedCollision], *, distance: float, angle: float
) -> frozenset[str]:
    """List the links of a robot whose visuals all are rotated alike against collisions on which the COMs are, in one place: they
    were drawn for a viewer that reads meshes with another axis up, and what moves and touches is right. None of a few links."""
    links = [one for one in model.links if one.visuals and one.collisions]
    displaced = {one.link.name: one for one in found}
    if len(links) < _VIEWED or len(displaced) < len(links):
        return frozenset()
    turns = [list_entries(one.collision.measure_turn(one.visual)) for one in displaced.values()]
    alike = all(abs(entry - first) <= angle for turn in turns for entry, first in zip(turn, turns[0], strict=True))
    is_quarter = all(abs(entry - round(entry)) <= angle for entry in turns[0])
    still = all(one.moved <= distance for one in displaced.values())
    if not (alike and is_quarter and still):
        return frozenset()
    fits = [_compare_com_distances(model, one.link) >= _NEARER for one in displaced.values()]
    # A COM on the axis of the rotation is as near to either.
    return frozenset(displaced) if sum(fits) * 2 >= len(fits) else frozenset()


def _compare_com_distances(model: Model, link: Link) -> float:
    """Return how many times nearer the COM of a link is to the middle of what collides than to that of what is drawn.

    1 if it is as near to the latter or nothing typed it, and at most 2 if it is not about in the middle of what collides.
    """
    from urdfcheck.model.shapes.visual_solid import measure_role_geometry  # loaded only where a finding is made

    inertial = link.inertial
    xyz = None if inertial is None else inertial.origin.xyz
    drawn, solid = (measure_role_geometry(model, link, role) for role in ("visual", "collision"))
    if xyz is None or not any(xyz) or drawn is None or solid is None:
        return 1.0
    to_drawn, to_solid = (math.dist(xyz, one.solid.com) for one in (drawn, solid))
    size = math.sqrt(float(solid.solid.covariance.trace()))
    if to_solid >= to_drawn:
        return 1.0
    return to_drawn / max(to_solid, 1e-9) if to_solid <= _NEAR * size else min(2.0, to_drawn / to_solid)


def _has_typed_com(displaced: DisplacedCollision) -> bool:
    """Whether the COM is the place of the collision as typed: then it may have been copied, and proves nothing."""
    inertial, xyz = displaced.link.inertial, displaced.collision.shape.origin.xyz or (0.0, 0.0, 0.0)
    com = None if inertial is None else inertial.origin.xyz
    return com is None or max(map(abs, subtract(com, xyz))) < 1e-6
