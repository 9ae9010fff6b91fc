"""MSH002: meshes are closed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.mesh import Boundary, MeshFacts
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse

# What a report can draw: the longest rims, each thinned to this many points.
LOOPS, POINTS = 16, 64


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    drawn: list[MeshUse] = []
    for path, uses in model.meshes.by_file().items():
        facts = model.meshes.facts.get(path)
        if facts is None or not facts.open_edges:
            continue
        if uses[0].shape.role != "collision":
            drawn.append(uses[0])
            continue
        scale = uses[0].shape.size or (1.0, 1.0, 1.0)
        yield rule.finding(
            "collision",
            at=uses[0].filename,
            related=[use.filename for use in uses[1:]],
            mesh=uses[0].filename.value,
            **_measured(facts, scale),
        )
    if drawn:
        counts = [model.meshes.facts[use.resource.path].open_edges for use in drawn if use.resource.path]
        yield rule.finding(
            "drawn",
            at=drawn[0].filename,
            related=[use.filename for use in drawn[1:]],
            severity=Severity.INFO,
            count=len(drawn),
            meshes=", ".join(f"{_file(use)} ({n:,})" for use, n in zip(drawn, counts, strict=True)),
        )


def _file(use: MeshUse) -> str:
    return use.filename.value.rpartition("/")[2]


def _measured(facts: MeshFacts, scale: Sequence[float]) -> dict[str, Any]:
    """Sizes in metres, places in the mesh's own frame after scaling."""
    loops = [_loop(boundary, np.array(scale)) for boundary in facts.boundaries]
    loops.sort(key=lambda loop: -loop["length"])
    return {
        "open_edges": facts.open_edges,
        "edges": f"{facts.open_edges:,} edge" + "s" * (facts.open_edges > 1),
        "places": f"{len(loops):,} place" + "s" * (len(loops) > 1),
        "length": loops[0]["length"],
        "centre": " ".join(f"{v:g}" for v in loops[0]["centre"]),
        "loops": loops[:LOOPS],
    }


def _loop(boundary: Boundary, scale: np.typing.NDArray[np.float64]) -> dict[str, Any]:
    points = boundary.points * scale
    steps = np.diff(points, axis=0, append=points[:1] if boundary.closed else points[-1:])
    thinned = points[:: -(-len(points) // POINTS)]
    return {
        "closed": boundary.closed,
        "length": float(f"{np.linalg.norm(steps, axis=1).sum():.6g}"),
        "centre": [float(f"{v:.4g}") + 0.0 for v in boundary.centre * scale],
        "points": [[float(f"{v:.6g}") + 0.0 for v in point] for point in thinned],
    }
