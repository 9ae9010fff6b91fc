"""MSH004 reports closed meshes whose triangles face inwards."""

from __future__ import annotations

from collections.abc import Iterator
from math import prod

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


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
                mesh=upright[0].filename.value,
                volume=facts.volume * prod(upright[0].shape.size or (1.0,)),
            )
