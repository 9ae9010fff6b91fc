"""MSH004 reports closed meshes whose triangles face inwards."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import dist, prod
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.solids import compute_drawn_scale

if TYPE_CHECKING:
    from urdfcheck.facts.mesh.measure import MeshFacts

# Pins and caps up to this diagonal (m): nobody sees their inner side.
_SMALL = 0.05


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # A macro's line may name several files, each of which is to be flipped.
    files: dict[object, list[tuple[list[MeshUse], MeshFacts]]] = {}
    for uses, facts in model.meshes.list_measured():
        if not facts.inside_out:
            continue
        # A mirroring scale turns the mesh right side out again in consumers that keep the order of the corners.
        upright = [use for use in uses if use.shape.size is not None and prod(use.shape.size) > 0]
        if upright:
            place = upright[0].filename.location
            files.setdefault(place.span or place.subject, []).append((upright, facts))
    for group in files.values():
        (first, facts), *others = group
        finding = rule.finding(
            "inside_out",
            at=first[0].filename,
            related=[use.filename for upright, _ in group for use in upright[1:]],
            severity=Severity.INFO if all(itertools.starmap(_is_small_drawing, group)) else None,
            mesh=first[0].filename.value,
            volume=facts.volume * prod(compute_drawn_scale(model, first[0].shape) or (1.0,)),
            more=f" (+{len(others)} more)" if others else "",
            others=f"; so do those of {join_names(upright[0].filename.value for upright, _ in others)}"
            if others
            else "",
        )
        yield replace(finding, subjects=tuple(upright[0].filename.location.subject for upright, _ in group))


def _is_small_drawing(uses: Sequence[MeshUse], facts: MeshFacts) -> bool:
    """Whether a mesh is only drawn, and smaller than what is seen of a robot."""
    scale = max(max(map(abs, use.shape.size or (1.0,))) for use in uses) * (facts.unit or 1.0)
    return all(use.shape.role == "visual" for use in uses) and dist(*facts.bounds.tolist()) * scale < _SMALL
