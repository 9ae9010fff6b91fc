"""MSH002 reports meshes with open edges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_large_count, join_names, join_numbers
from urdfcheck.facts.mesh.measure import MeshFacts
from urdfcheck.facts.mesh.topology import Boundary
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.mesh_marks import round_significant, sample_for_drawing
from urdfcheck.model.shapes.solids import compute_drawn_scale

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Vec3

# A report draws the longest rims, each thinned to this many points.
MAX_LOOPS, MAX_POINTS = 16, 64
# On a round body, holes of this share of the surface change its volume by the same share (see the page).
SMALL_SHARE = 1e-2


@dataclass(frozen=True, slots=True, eq=False)
class _OpenMesh:
    """A mesh file with open edges, and its uses."""

    uses: Sequence[MeshUse]
    facts: MeshFacts

    @property
    def use(self) -> MeshUse:
        """The first use."""
        return self.uses[0]

    @property
    def label(self) -> str:
        """``arm.stl (1,234)``: the file and its number of open edges."""
        return f"{self.use.name} ({self.open_edges:,})"

    @property
    def open_edges(self) -> int:
        """The number of edges around its holes."""
        return sum(len(hole.points) - (0 if hole.closed else 1) for hole in self.facts.holes)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    drawn: list[_OpenMesh] = []
    colliding: list[_OpenMesh] = []
    shared: list[_OpenMesh] = []
    nearly_closed: list[_OpenMesh] = []
    for uses, facts in model.meshes.list_measured():
        # The triangles at a corner that is not finite are missing: MSH007 reports it.
        if facts.open_edges and not facts.non_finite_vertices and facts.holes:
            if uses[0].shape.role != "collision":
                group = drawn
            elif facts.hole_share < SMALL_SHARE:
                group = nearly_closed
            else:
                group = shared if model.meshes.is_drawn(uses[0]) else colliding
            group.append(_OpenMesh(uses, facts))
    if colliding:
        yield _build_collision_finding(model, rule, "collision", colliding)
    if shared:
        yield _build_collision_finding(model, rule, "shared", shared)
    if nearly_closed:
        yield rule.finding(
            "small",
            at=nearly_closed[0].use.filename,
            related=[mesh.use.filename for mesh in nearly_closed[1:]],
            severity=Severity.INFO,
            share=SMALL_SHARE,
            meshes=join_names(mesh.label for mesh in nearly_closed),
        )
    if drawn:
        yield rule.finding(
            "drawn",
            at=drawn[0].use.filename,
            related=[mesh.use.filename for mesh in drawn[1:]],
            severity=Severity.INFO,
            count=len(drawn),
            meshes=join_names(mesh.label for mesh in drawn),
        )


def _build_collision_finding(model: Model, rule: Rule, message: str, meshes: Sequence[_OpenMesh]) -> Finding:
    """Return one finding for the whole robot: one exporter made all meshes, or one program simplified them."""
    rims = {mesh.use: _collect_boundary_loops(model, mesh) for mesh in meshes}
    worst = max(rims, key=lambda use: rims[use][0]["length"])
    open_edges = sum(mesh.open_edges for mesh in meshes)
    several = len(meshes) > 1
    at, *related = (use.filename for mesh in meshes for use in mesh.uses)
    finding = rule.finding(
        message,
        at=at,
        related=related,
        severity=Severity.INFO,
        meshes=f"{len(meshes)} collision meshes are" if several else f"collision mesh {worst.filename.value} is",
        which=f"{len(meshes)} collision meshes are" if several else f"mesh {worst.name} is",
        edges=format_large_count(open_edges, "open edge"),
        files=f" ({join_names(mesh.label for mesh in meshes)})" if several else "",
        open_edges=open_edges,
        places=format_large_count(sum(len(mesh.facts.holes) for mesh in meshes), "place"),
        length=rims[worst][0]["length"],
        centre=join_numbers(rims[worst][0]["centre"], digits=3, separator=" "),
        whose=f"the frame of {worst.name}" if several else "the mesh's frame",
        loops=[loop for loops in rims.values() for loop in loops],
    )
    return replace(finding, subjects=tuple(dict.fromkeys(use.filename.location.subject for use in rims)))


def _collect_boundary_loops(model: Model, mesh: _OpenMesh) -> list[dict[str, Any]]:
    """Describe the longest rims of a mesh, the longest first; a mesh of loose triangles has thousands."""
    scale = np.array(compute_drawn_scale(model, mesh.use.shape) or (1.0, 1.0, 1.0))
    lengths = [_measure_boundary_length(boundary, scale) for boundary in mesh.facts.holes]
    longest = sorted(range(len(lengths)), key=lambda i: -lengths[i])[:MAX_LOOPS]
    return [
        {
            "closed": mesh.facts.holes[i].closed,
            "length": lengths[i],
            "centre": [round_significant(float(v), 4) for v in mesh.facts.holes[i].centre * scale],
            "points": sample_for_drawing(model, mesh.use, mesh.facts.holes[i].points, most=MAX_POINTS),
        }
        for i in longest
    ]


def _measure_boundary_length(boundary: Boundary, scale: Vec3) -> float:
    """Measure the length of a rim in metres; ``scale`` (3,): metres per unit of the file."""
    points = boundary.points * scale
    steps = np.diff(points, axis=0, append=points[:1] if boundary.closed else points[-1:])
    return round_significant(float(np.linalg.norm(steps, axis=1).sum()))
