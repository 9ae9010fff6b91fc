"""MSH004 reports closed meshes whose triangles face inwards."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import dist, prod
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse

if TYPE_CHECKING:
    from urdfcheck.facts.mesh.measure import MeshFacts

# Pins and caps up to this diagonal (m): nobody sees their inner side.
_SMALL = 0.05


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for uses, facts in model.meshes.list_measured():
        if not facts.inside_out:
            continue
        # A mirroring scale turns the mesh right side out again in consumers that keep the order of the corners.
        upright = [use for use in uses if use.shape.size is not None and prod(use.shape.size) > 0]
        if upright:
            yield rule.finding(
                "inside_out",
                at=upright[0].filename,
                related=[use.filename for use in upright[1:]],
                severity=Severity.INFO if _is_small_drawing(upright, facts) else None,
                mesh=upright[0].filename.value,
                volume=facts.volume * prod(upright[0].shape.size or (1.0,)),
            )


def _is_small_drawing(uses: Sequence[MeshUse], facts: MeshFacts) -> bool:
    """Whether a mesh is only drawn, and smaller than what is seen of a robot."""
    scale = max(max(map(abs, use.shape.size or (1.0,))) for use in uses) * (facts.unit or 1.0)
    return all(use.shape.role == "visual" for use in uses) and dist(*facts.bounds.tolist()) * scale < _SMALL
