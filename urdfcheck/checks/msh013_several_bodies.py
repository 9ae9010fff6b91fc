"""MSH013 reports collision meshes of several separate pieces."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    pieces: list[tuple[MeshUse, int]] = []
    for uses, facts in model.meshes.list_measured():
        if uses[0].shape.role == "collision" and len(facts.components) > 1:
            pieces.append((uses[0], len(facts.components)))
    pieces.sort(key=lambda entry: -entry[1])
    if pieces:
        yield rule.finding(
            "several",
            at=pieces[0][0].filename,
            related=[use.filename for use, _ in pieces[1:]],
            count=len(pieces),
            meshes=join_names(f"{use.name} ({count})" for use, count in pieces),
            most=pieces[0][1],
        )
