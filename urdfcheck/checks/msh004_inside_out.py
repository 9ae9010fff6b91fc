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
from urdfcheck.model.use.scenery import scenery_links

if TYPE_CHECKING:
    from urdfcheck.facts.mesh.measure import MeshFacts

# Pins and caps up to this diagonal (m): nobody sees their inner side.
_SMALL = 0.05
# What turns all triangles, and what turns the bodies that face inwards alone.
_TURN_ALL = "flip the normals in the mesh editor (Blender: Mesh, Normals, Flip) and export again"
_TURN_EACH = (
    "let the mesh editor turn each body outwards (Blender: Mesh, Normals, Recalculate Outside) and export again: others of "
    "the same mesh face outwards already"
)
# What programs do where no shape with the mesh is drawn.
_UNDRAWN = {"gazebo": "loads it; automatic inertia from the mesh is negative", "rviz": "loads it"}


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
        is_slight = bool(scenery_links(model)) or all(itertools.starmap(_is_small_drawing, group))
        is_drawn = any(use.shape.role == "visual" for upright, _ in group for use in upright)
        finding = rule.finding(
            "inside_out",
            at=first[0].filename,
            related=[use.filename for upright, _ in group for use in upright[1:]],
            severity=Severity.INFO if is_slight or not is_drawn else None,
            consequences=None if is_drawn else _UNDRAWN,
            which=_describe_bodies(facts),
            repair=_TURN_EACH if any(facts.has_mixed_orientation for _, facts in group) else _TURN_ALL,
            mesh=first[0].filename.value,
            volume=facts.volume * prod(compute_drawn_scale(model, first[0].shape) or (1.0,)),
            more=f" (+{len(others)} more)" if others else "",
            others=f"; so do those of {join_names(upright[0].filename.value for upright, _ in others)}"
            if others
            else "",
        )
        yield replace(finding, subjects=tuple(upright[0].filename.location.subject for upright, _ in group))


def _describe_bodies(facts: MeshFacts) -> str:
    """Say how many bodies of a mesh face inwards; nothing where all do, apart from hollows in them."""
    if not facts.has_mixed_orientation:
        return ""
    volumes = facts.body_volumes
    return f"{int((volumes < 0.0).sum())} of the {len(volumes)} bodies of "


def _is_small_drawing(uses: Sequence[MeshUse], facts: MeshFacts) -> bool:
    """Whether a mesh is only drawn, and smaller than what is seen of a robot."""
    scale = max(max(map(abs, use.shape.size or (1.0,))) for use in uses) * (facts.unit or 1.0)
    return all(use.shape.role == "visual" for use in uses) and dist(*facts.bounds.tolist()) * scale < _SMALL
