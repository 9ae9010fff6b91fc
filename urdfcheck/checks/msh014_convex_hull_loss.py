"""MSH014 reports collision meshes whose convex hull is much larger than the mesh."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse

# A closed mesh with less of its hull's volume than this is a two-sided sheet, whose volume is a rounding error.
MIN_HULL_SHARE = 1e-6


def check(model: Model, rule: Rule, *, times: float) -> Iterator[Finding]:
    ratios: list[tuple[MeshUse, float]] = []
    for uses, facts in model.meshes.list_measured():
        # The volume of an open mesh is meaningless.
        if uses[0].shape.role != "collision" or not facts.closed:
            continue
        volume, hull = abs(facts.volume), facts.hull.volume
        if volume > MIN_HULL_SHARE * hull and hull > times * volume:
            ratios.append((uses[0], hull / volume))
    ratios.sort(key=lambda entry: -entry[1])
    if ratios:
        yield rule.finding(
            "fills",
            at=ratios[0][0].filename,
            related=[use.filename for use, _ in ratios[1:]],
            count=len(ratios),
            meshes=join_names(f"{use.name} ({float(f'{ratio:.2g}'):g}×)" for use, ratio in ratios),
            most=ratios[0][1],
        )
