"""MSH005 reports collision meshes in which more than two triangles meet in an edge."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_large_count
from urdfcheck.model import Model
from urdfcheck.model.shapes.mesh_marks import sample_for_drawing


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for uses, facts in model.meshes.list_measured():
        if uses[0].shape.role != "collision" or not facts.non_manifold_edges:
            continue
        # Closed bodies that touch along an edge still enclose their volume; MSH002 reports meshes with open edges.
        if facts.closed or facts.open_edges:
            continue
        yield rule.finding(
            "collision",
            at=uses[0].filename,
            related=[use.filename for use in uses[1:]],
            severity=Severity.INFO,
            mesh=uses[0].filename.value,
            count=facts.non_manifold_edges,
            edges=format_large_count(facts.non_manifold_edges, "edge"),
            lines=sample_for_drawing(model, uses[0], facts.non_manifold_lines),
        )
