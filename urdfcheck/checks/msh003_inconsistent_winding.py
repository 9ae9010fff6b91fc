"""MSH003 reports meshes whose neighbouring triangles face opposite sides."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_large_count, join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.mesh_marks import sample_for_drawing

# A triangle inside a surface has three neighbours: fewer wrong edges are a slip of a corner, and turn no part of it over.
_FEWEST_EDGES = 3


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    drawn: list[MeshUse] = []
    for uses, facts in model.meshes.list_measured():
        if facts.winding_consistent or len(facts.flipped_lines) < _FEWEST_EDGES:
            continue
        if uses[0].shape.role != "collision":
            drawn.append(uses[0])
            continue
        wrong = len(facts.flipped_lines)
        yield rule.finding(
            "collision",
            at=uses[0].filename,
            related=[use.filename for use in uses[1:]],
            severity=Severity.INFO,
            mesh=uses[0].filename.value,
            wrong=wrong,
            edges=format_large_count(wrong, "edge"),
            lines=sample_for_drawing(model, uses[0], facts.flipped_lines),
        )
    if drawn:
        yield rule.finding(
            "drawn",
            at=drawn[0].filename,
            related=[use.filename for use in drawn[1:]],
            severity=Severity.INFO,
            count=len(drawn),
            meshes=join_names(use.name for use in drawn),
        )
