"""GEO005 reports meshes whose visual and collision have different origins."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Edit, Finding, Located, Rule, Severity
from urdfcheck.model import Link, Model, Shape
from urdfcheck.model.repairs.edits import edit_literals

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class _PlacedShape:
    """A visual or collision that uses a mesh, and its pose."""

    shape: Shape
    mesh_name: str
    pose: Array
    """(4, 4) in the link's frame"""

    @property
    def place(self) -> Located:
        return self.shape if self.shape.origin.element is None else self.shape.origin.element

    def measure_difference(self, other: _PlacedShape) -> tuple[float, float]:
        """Return the distance (m) and the angle of rotation (rad) between two shapes."""
        # The chord between the rotations: unlike the arc cosine of the trace, it keeps small angles.
        chord = float(np.linalg.norm(self.pose[:3, :3] - other.pose[:3, :3])) / math.sqrt(8)
        moved = float(np.linalg.norm(self.pose[:3, 3] - other.pose[:3, 3]))
        return moved, 2 * math.asin(min(1.0, chord))


def check(model: Model, rule: Rule, *, distance: float, angle: float, apart: float) -> Iterator[Finding]:
    def is_same_pose(one: _PlacedShape, other: _PlacedShape) -> bool:
        moved, turned = one.measure_difference(other)
        return moved <= distance and turned <= angle

    for link in model.links:
        for visuals, collisions in _group_by_mesh(model, link):
            # A part that is used several times has several places, in any order.
            lone = [c for c in collisions if not any(is_same_pose(v, c) for v in visuals)]
            free = [v for v in visuals if not any(is_same_pose(v, c) for c in collisions)]
            for collision in lone:
                visual = min(free, key=collision.measure_difference, default=None)
                if visual is None:
                    continue
                moved, turned = visual.measure_difference(collision)
                yield rule.finding(
                    "differs",
                    at=collision.place,
                    related=[visual.place],
                    edits=_propose_edits(visual.shape, collision.shape),
                    severity=Severity.WARNING if moved > apart else None,
                    link=link.name,
                    mesh=collision.mesh_name,
                    moved=float(f"{moved:.4g}"),
                    turned=float(f"{turned:.4g}"),
                    degrees=math.degrees(turned),
                )


def _group_by_mesh(model: Model, link: Link) -> Iterator[tuple[list[_PlacedShape], list[_PlacedShape]]]:
    """Iterate over the visuals and the collisions of a link that use one file at one scale and have a known pose."""
    groups: dict[object, tuple[list[_PlacedShape], list[_PlacedShape]]] = {}
    for shape in (*link.visuals, *link.collisions):
        use, pose = model.meshes.by_shape.get(id(shape)), shape.origin.matrix
        if use is not None and shape.size is not None and pose is not None:
            key = (use.resource.path or use.filename.value, shape.size)
            placed = _PlacedShape(shape, use.name, pose)
            groups.setdefault(key, ([], []))[shape.role == "collision"].append(placed)
    yield from (group for group in groups.values() if all(group))


def _propose_edits(visual: Shape, collision: Shape) -> list[Edit]:
    """Return the edits that give the collision the visual's origin, if both are typed as numbers."""
    wrong = []
    for name in ("xyz", "rpy"):
        source, target = visual.origin.get_attribute(name), collision.origin.get_attribute(name)
        wanted = "0 0 0" if source is None else source.typed
        if target is None and wanted.split() == ["0", "0", "0"]:
            continue
        if target is not None and target.value.split() == wanted.split():
            continue
        if source is not None and not source.literal:
            return []
        wrong.append((target, wanted))
    return edit_literals(wrong)
