"""MSH002 reports meshes with open edges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.mesh.measure import Boundary
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.mesh_marks import round_significant, sample_for_drawing
from urdfcheck.model.shapes.solids import compute_drawn_scale

# What a report can draw: the longest rims, each thinned to this many points.
MAX_LOOPS, MAX_POINTS = 16, 64


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    drawn: list[MeshUse] = []
    colliding: list[Sequence[MeshUse]] = []
    for uses, facts in model.meshes.list_measured():
        # Where a corner is nowhere, its triangles are missing: MSH007 says so.
        if not facts.open_edges or facts.non_finite_vertices:
            continue
        if uses[0].shape.role != "collision":
            drawn.append(uses[0])
        else:
            colliding.append(uses)
    if colliding:
        yield _build_collision_finding(model, rule, colliding)
    if drawn:
        counts = [_count_open_edges(model, use) for use in drawn]
        yield rule.finding(
            "drawn",
            at=drawn[0].filename,
            related=[use.filename for use in drawn[1:]],
            severity=Severity.INFO,
            count=len(drawn),
            meshes=join_names([f"{use.name} ({n:,})" for use, n in zip(drawn, counts, strict=True)]),
        )


def _build_collision_finding(model: Model, rule: Rule, meshes: list[Sequence[MeshUse]]) -> Finding:
    """One finding for all of a robot: they come from one exporter, or one program that made them coarser."""
    holes = {uses[0]: _collect_boundary_loops(model, uses[0]) for uses in meshes}
    worst = max(holes, key=lambda use: holes[use][0]["length"])
    counts = [_count_open_edges(model, use) for use in holes]
    names = join_names(f"{use.name} ({n:,})" for use, n in zip(holes, counts, strict=True))
    several = len(meshes) > 1
    places = sum(map(len, holes.values()))
    first, *rest = (use.filename for uses in meshes for use in uses)
    finding = rule.finding(
        "collision",
        at=first,
        related=rest,
        meshes=f"{len(meshes)} collision meshes are" if several else f"collision mesh {worst.filename.value} is",
        edges=f"{sum(counts):,} edge" + "s" * (sum(counts) > 1) + (f", {names}," if several else ""),
        open_edges=sum(counts),
        places=f"{places:,} place" + "s" * (places > 1),
        length=holes[worst][0]["length"],
        centre=" ".join(f"{v:g}" for v in holes[worst][0]["centre"]),
        whose=f"the frame of {worst.name}" if several else "the mesh's frame",
        loops=[loop for loops in holes.values() for loop in loops[:MAX_LOOPS]],
    )
    return replace(finding, subjects=tuple(dict.fromkeys(use.filename.location.subject for use in holes)))


def _count_open_edges(model: Model, use: MeshUse) -> int:
    assert use.resource.path is not None, "its file was measured"
    return model.meshes.facts[use.resource.path].open_edges


def _collect_boundary_loops(model: Model, use: MeshUse) -> list[dict[str, Any]]:
    assert use.resource.path is not None, "its file was measured"
    loops = [
        _describe_boundary_loop(model, use, boundary) for boundary in model.meshes.facts[use.resource.path].boundaries
    ]
    return sorted(loops, key=lambda loop: -loop["length"])


def _describe_boundary_loop(model: Model, use: MeshUse, boundary: Boundary) -> dict[str, Any]:
    """Sizes in metres, places in the mesh's own frame after scaling."""
    scale = np.array(compute_drawn_scale(model, use.shape) or (1.0, 1.0, 1.0))
    points = boundary.points * scale
    steps = np.diff(points, axis=0, append=points[:1] if boundary.closed else points[-1:])
    return {
        "closed": boundary.closed,
        "length": round_significant(float(np.linalg.norm(steps, axis=1).sum())),
        "centre": [round_significant(float(v), 4) for v in boundary.centre * scale],
        "points": sample_for_drawing(model, use, boundary.points, MAX_POINTS),
    }
