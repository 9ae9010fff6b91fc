"""MSH015 reports collision meshes without enough volume for MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.arrays import Array
from urdfcheck.facts.mesh.measure import MeshFacts
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse

# `mjMINVAL` of MuJoCo's mjtype.h, with which its user_mesh.cc compares the volume.
LEAST_VOLUME = 1e-15
# A convex hull has four corners.
LEAST_CORNERS = 4
# MuJoCo reads coordinates in single precision: the largest relative error of each.
ROUNDING = 2.0**-24
# MuJoCo refuses other formats whatever they contain (MSH011).
FORMATS = ("stl", "obj")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    flat: list[MeshUse] = []
    tiny: list[tuple[float, MeshUse]] = []
    for use in model.meshes.uses:
        facts, scale = model.meshes.get_facts(use.shape), use.shape.size
        if facts is None or scale is None or use.shape.role != "collision" or not facts.format.startswith(FORMATS):
            continue
        if not all(scale):  # GEO001
            continue
        if _is_flat(facts):
            flat.append(use)
        elif (volume := _bound_pyramid_volume(facts, np.array(scale))) < LEAST_VOLUME:
            tiny.append((volume, use))
    if flat:
        is_meant = model.robot.find_child("mujoco") is not None
        yield _build_finding(rule, "flat", flat, severity=Severity.WARNING if is_meant else None)
    if tiny:
        least, _ = min(tiny, key=lambda entry: entry[0])
        yield _build_finding(rule, "tiny", [use for _, use in tiny], volume=least, limit=LEAST_VOLUME)


def _is_flat(facts: MeshFacts) -> bool:
    """Whether all corners are in one plane however they are rounded: fewer than four of them, or a plane across an axis."""
    return facts.n_vertices < LEAST_CORNERS or not np.ptp(facts.bounds, axis=0).all()


def _bound_pyramid_volume(facts: MeshFacts, scale: Array) -> float:
    """Return the volume that MuJoCo computes, in m³, or more: the sum of the pyramids from the centre of the surface to each
    triangle, all of them positive."""
    volume = abs(facts.volume * float(scale.prod()))
    if facts.closed and volume >= LEAST_VOLUME:
        return volume  # the sum of their signed volumes, which is less
    a, b, c = (facts.vertices[column] * scale for column in facts.faces.T)
    normals, centres = np.cross(b - a, c - a) / 2.0, (a + b + c) / 3.0
    areas = np.linalg.norm(normals, axis=1)
    total = float(areas.sum())
    heights = centres - (areas @ centres) / total if total > 0.0 else 0.0 * centres
    volume = float(np.abs(np.einsum("ij,ij->i", heights, normals)).sum()) / 3.0
    # Rounding moves a corner, and the centre, by less than this. The volume of a pyramid is a sixth of a determinant of three
    # edges, none of which is longer than the diameter.
    moved = 4.0 * ROUNDING * float(np.abs(facts.bounds * scale).max())
    diameter = float(np.linalg.norm(np.ptp(facts.bounds * scale, axis=0))) + moved
    return volume + len(areas) * moved * diameter**2


def _build_finding(
    rule: Rule, message: str, uses: Sequence[MeshUse], *, severity: Severity | None = None, **data: Any
) -> Finding:
    names = list(dict.fromkeys(use.name for use in uses))
    return rule.finding(
        message,
        at=uses[0].filename,
        related=[use.filename for use in uses[1:]],
        severity=severity,
        count=len(names),
        meshes=join_names(names),
        **data,
    )
