"""MSH002: meshes are closed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.mesh import Boundary
from urdfcheck.model import Model
from urdfcheck.model.drawing import drawable, rounded_off
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.names import listed

# What a report can draw: the longest rims, each thinned to this many points.
LOOPS, POINTS = 16, 64


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    drawn: list[MeshUse] = []
    for uses, facts in model.meshes.measured():
        # Where a corner is nowhere, its triangles are missing: MSH007 says so.
        if not facts.open_edges or facts.non_finite_vertices:
            continue
        if uses[0].shape.role != "collision":
            drawn.append(uses[0])
            continue
        loops = [_loop(model, uses[0], boundary) for boundary in facts.boundaries]
        loops.sort(key=lambda loop: -loop["length"])
        yield rule.finding(
            "collision",
            at=uses[0].filename,
            related=[use.filename for use in uses[1:]],
            mesh=uses[0].filename.value,
            open_edges=facts.open_edges,
            edges=f"{facts.open_edges:,} edge" + "s" * (facts.open_edges > 1),
            places=f"{len(loops):,} place" + "s" * (len(loops) > 1),
            length=loops[0]["length"],
            centre=" ".join(f"{v:g}" for v in loops[0]["centre"]),
            loops=loops[:LOOPS],
        )
    if drawn:
        counts = [model.meshes.facts[use.resource.path].open_edges for use in drawn if use.resource.path]
        yield rule.finding(
            "drawn",
            at=drawn[0].filename,
            related=[use.filename for use in drawn[1:]],
            severity=Severity.INFO,
            count=len(drawn),
            meshes=listed([f"{use.name} ({n:,})" for use, n in zip(drawn, counts, strict=True)]),
        )


def _loop(model: Model, use: MeshUse, boundary: Boundary) -> dict[str, Any]:
    """Sizes in metres, places in the mesh's own frame after scaling."""
    scale = np.array(model.drawn_scale(use.shape) or (1.0, 1.0, 1.0))
    points = boundary.points * scale
    steps = np.diff(points, axis=0, append=points[:1] if boundary.closed else points[-1:])
    return {
        "closed": boundary.closed,
        "length": rounded_off(float(np.linalg.norm(steps, axis=1).sum())),
        "centre": [rounded_off(float(v), 4) for v in boundary.centre * scale],
        "points": drawable(model, use, boundary.points, POINTS),
    }
