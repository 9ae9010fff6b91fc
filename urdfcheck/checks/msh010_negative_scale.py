"""MSH010 reports collision meshes that are mirrored by a negative scale."""

from __future__ import annotations

from collections.abc import Iterator
from math import prod

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # Two negative factors are half a turn; one or three are a mirror.
    mirrored = [
        use
        for use in model.meshes.uses
        if use.shape.role == "collision" and use.shape.size is not None and prod(use.shape.size) < 0
    ]
    if mirrored:
        names = list(dict.fromkeys(use.name for use in mirrored))
        yield rule.finding(
            "mirrored",
            at=mirrored[0].filename,
            related=[use.filename for use in mirrored[1:]],
            severity=Severity.INFO,
            count=len(mirrored),
            meshes=join_names(names),
            shapes=format_count(len(mirrored), "collision shape mirrors", "collision shapes mirror"),
        )
