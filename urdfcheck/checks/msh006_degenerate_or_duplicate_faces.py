"""MSH006 reports triangles of collision meshes that have no area or occur twice."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.facts.mesh.measure import MeshFacts
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.mesh_marks import sample_for_drawing

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A report draws at most this many meshes, and triangles of each.
MAX_MESHES, MAX_TRIANGLES = 8, 32


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    meshes: list[tuple[MeshUse, MeshFacts]] = [
        (uses[0], facts)
        for uses, facts in model.meshes.list_measured()
        if uses[0].shape.role == "collision" and (facts.degenerate_faces or facts.duplicate_faces)
    ]
    if meshes:
        yield rule.finding(
            "collision",
            at=meshes[0][0].filename,
            related=[use.filename for use, _ in meshes[1:]],
            degenerate=sum(facts.degenerate_faces for _, facts in meshes),
            duplicate=sum(facts.duplicate_faces for _, facts in meshes),
            meshes=join_names(f"{use.name} ({_format_face_counts(facts)})" for use, facts in meshes),
            places=[
                {
                    "mesh": use.filename.value,
                    "link": use.link.name,
                    "triangles": sample_for_drawing(model, use, _find_bad_triangles(facts), most=MAX_TRIANGLES),
                }
                for use, facts in meshes[:MAX_MESHES]
            ],
        )


def _format_face_counts(facts: MeshFacts) -> str:
    counts = [(facts.degenerate_faces, "without area"), (facts.duplicate_faces, "duplicate")]
    return ", ".join(f"{n:,} {what}" for n, what in counts if n)


def _find_bad_triangles(facts: MeshFacts) -> Array:
    """Return the corners (n, 3, 3) of the triangles without area, or duplicate, that the welded mesh still has."""
    corners = facts.vertices[facts.faces]
    sides = corners - np.roll(corners, 1, axis=1)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    degenerate = area <= 1e-14 * (sides**2).sum(axis=2).max(axis=1)
    repeated = np.ones(len(degenerate), dtype=bool)
    repeated[np.unique(np.sort(facts.faces, axis=1), axis=0, return_index=True)[1]] = False
    bad: Array = corners[degenerate | repeated]
    return bad
