"""MSH003: neighbouring triangles of a mesh face the same side."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.mesh import MeshFacts
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    drawn: list[MeshUse] = []
    for path, uses in model.meshes.by_file().items():
        facts = model.meshes.facts.get(path)
        if facts is None or facts.winding_consistent:
            continue
        if uses[0].shape.role != "collision":
            drawn.append(uses[0])
            continue
        wrong, shared = _edges(facts)
        yield rule.finding(
            "collision",
            at=uses[0].filename,
            related=[use.filename for use in uses[1:]],
            mesh=uses[0].filename.value,
            wrong=wrong,
            shared=shared,
        )
    if drawn:
        yield rule.finding(
            "drawn",
            at=drawn[0].filename,
            related=[use.filename for use in drawn[1:]],
            severity=Severity.INFO,
            count=len(drawn),
            meshes=", ".join(use.filename.value.rpartition("/")[2] for use in drawn),
        )


def _edges(facts: MeshFacts) -> tuple[int, int]:
    """Edges along which their two triangles run the same way, and all edges of two triangles."""
    directed = facts.faces[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2)
    _, inverse, count = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True)
    balance = np.bincount(inverse.ravel(), weights=np.where(directed[:, 0] < directed[:, 1], 1.0, -1.0))
    shared = count == 2
    return int((balance[shared] != 0).sum()), int(shared.sum())
