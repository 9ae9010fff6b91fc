"""MSH012 reports STL files that are text, and binary ones that begin like text."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.source.text.engine_reactions import describe_missing_mesh


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    by_message: dict[str, list[MeshUse]] = {}
    for (use, *_), facts in model.meshes.list_measured():
        if facts.solid_header:
            by_message.setdefault("solid", []).append(use)
        elif facts.format == "stl-ascii":
            by_message.setdefault("text", []).append(use)
    for message, uses in by_message.items():
        names = [use.name for use in uses]
        yield rule.finding(
            message,
            at=uses[0].filename,
            related=[use.filename for use in uses[1:]],
            severity=Severity.INFO if message == "solid" else None,
            consequences=_describe_text(uses) if message == "text" else None,
            count=len(names),
            meshes=f"STL file {names[0]} is"
            if len(names) == 1
            else f"{len(names)} STL files ({join_names(names)}) are",
            files=join_names(names),
            header="its header begins" if len(names) == 1 else "their headers begin",
        )


def _describe_text(uses: list[MeshUse]) -> dict[str, str]:
    """Describe what MuJoCo does with a text file: the same as with a missing one. yourdfpy loads it."""
    return {"mujoco": describe_missing_mesh(use.shape.element for use in uses)["mujoco"]}
