"""GEO005 reports meshes whose visual and collision have different origins."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.model import Link, Model, Shape

if TYPE_CHECKING:
    from numpy.typing import NDArray


def check(model: Model, rule: Rule, *, distance: float, angle: float) -> Iterator[Finding]:
    for link in model.links:
        for drawn, colliding in _group_by_mesh(model, link):
            # A part that is used several times has several places, in any order.
            lone = [c for c in colliding if not any(_is_same_pose(v, c, distance, angle) for v in drawn)]
            free = [v for v in drawn if not any(_is_same_pose(v, c, distance, angle) for c in colliding)]
            for collision in lone:
                visual = min(free, key=lambda v: _measure_pose_difference(v, collision), default=None)
                if visual is None or collision.geometry_element is None:
                    continue
                moved, turned = _measure_pose_difference(visual, collision)
                yield rule.finding(
                    "differs",
                    at=collision if collision.origin.element is None else collision.origin.element,
                    related=[visual if visual.origin.element is None else visual.origin.element],
                    edits=_propose_edits(visual, collision),
                    link=link.name,
                    mesh=collision.geometry_element.get("filename").rpartition("/")[2],
                    moved=float(f"{moved:.4g}"),
                    turned=float(f"{turned:.4g}"),
                    degrees=math.degrees(turned),
                )


def _group_by_mesh(model: Model, link: Link) -> Iterator[tuple[list[Shape], list[Shape]]]:
    """The visuals and the collisions of a link that use one file at one scale, and whose origins are known."""
    groups: dict[object, tuple[list[Shape], list[Shape]]] = {}
    for shape in (*link.visuals, *link.collisions):
        use = model.meshes.by_shape.get(id(shape))
        if use is not None and shape.size is not None and shape.origin.matrix is not None:
            key = (use.resource.path or use.filename.value, shape.size)
            groups.setdefault(key, ([], []))[shape.role == "collision"].append(shape)
    yield from (group for group in groups.values() if all(group))


def _is_same_pose(one: Shape, other: Shape, distance: float, angle: float) -> bool:
    moved, turned = _measure_pose_difference(one, other)
    return moved <= distance and turned <= angle


def _measure_pose_difference(one: Shape, other: Shape) -> tuple[float, float]:
    """How far apart two shapes stand (m), and the angle of the rotation between them (rad)."""
    a, b = _get_origin_matrix(one), _get_origin_matrix(other)
    # The chord between the rotations: unlike the arc cosine of the trace, it keeps small angles.
    chord = float(np.linalg.norm(a[:3, :3] - b[:3, :3])) / math.sqrt(8)
    return float(np.linalg.norm(a[:3, 3] - b[:3, 3])), 2 * math.asin(min(1.0, chord))


def _get_origin_matrix(shape: Shape) -> NDArray[np.float64]:
    assert shape.origin.matrix is not None
    return shape.origin.matrix


def _propose_edits(visual: Shape, collision: Shape) -> list[Edit]:
    """What the visual's origin has, into the collision's, where both are typed as numbers."""
    edits = []
    for name in ("xyz", "rpy"):
        source, target = visual.origin.get_attribute(name), collision.origin.get_attribute(name)
        wanted = "0 0 0" if source is None else source.typed
        if target is None or target.value.split() == wanted.split():
            if target is None and wanted.split() != ["0", "0", "0"]:
                return []
            continue
        if target.span is None or not target.literal or (source is not None and not source.literal):
            return []
        edits.append(Edit(target.span, target.typed, wanted))
    return edits
