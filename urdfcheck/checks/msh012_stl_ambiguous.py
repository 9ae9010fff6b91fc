"""MSH012 reports STL files that are text, and binary ones that begin like text."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.source.text.shape_roles import describe_missing_mesh


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    found: dict[str, list[MeshUse]] = {}
    for uses, facts in model.meshes.list_measured():
        if facts.solid_header:
            found.setdefault("solid", []).append(uses[0])
        elif facts.format == "stl-ascii":
            found.setdefault("text", []).append(uses[0])
    for message, uses_of in found.items():
        names = [use.name for use in uses_of]
        yield rule.finding(
            message,
            at=uses_of[0].filename,
            related=[use.filename for use in uses_of[1:]],
            consequences=describe_missing_mesh(use.shape.element for use in uses_of) if message == "text" else None,
            count=len(names),
            meshes=f"STL file {names[0]} is"
            if len(names) == 1
            else f"{len(names)} STL files ({join_names(names)}) are",
            header="its header begins" if len(names) == 1 else "their headers begin",
        )
