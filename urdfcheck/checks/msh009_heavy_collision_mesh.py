"""MSH009 reports collision meshes with too many triangles."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.shapes.repeated_drawings import find_repeated_drawings

_FINE = "use a copy decimated to a few hundred triangles (Blender: Decimate), primitives or a convex hull for collision"
_WHOLE = "export one part per link: {count} links draw one and the same body in one place"


def check(model: Model, rule: Rule, *, triangles: int, slight: float) -> Iterator[Finding]:
    heavy = [
        (uses, facts.n_triangles)
        for uses, facts in model.meshes.list_measured()
        if uses[0].shape.role == "collision" and facts.n_triangles > triangles
    ]
    whole = find_repeated_drawings(model) if heavy else frozenset()
    # The meshes of one robot are one finding: a slight one beside others is one more of them.
    is_slight = all(count < slight * triangles for _, count in heavy)
    for uses, count in heavy:
        yield rule.finding(
            "heavy",
            at=uses[0].filename,
            severity=Severity.INFO if is_slight else None,
            related=[use.filename for use in uses[1:] if use.shape.role == "collision"],
            link=uses[0].link.name,
            mesh=uses[0].filename.value,
            triangles=count,
            limit=triangles,
            advice=_WHOLE.format(count=len(whole)) if uses[0].link.name in whole else _FINE,
        )
