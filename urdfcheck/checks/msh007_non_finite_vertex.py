"""MSH007: every corner of a mesh is somewhere."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for uses, facts in model.meshes.measured():
        if facts.non_finite_vertices:
            yield rule.finding(
                "non_finite",
                at=uses[0].filename,
                related=[use.filename for use in uses[1:]],
                mesh=uses[0].filename.value,
                count=facts.non_finite_vertices,
                corners=f"{facts.non_finite_vertices:,} corner" + "s" * (facts.non_finite_vertices > 1),
            )
