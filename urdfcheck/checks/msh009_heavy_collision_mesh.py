"""MSH009 reports collision meshes with too many triangles."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.shapes.repeated_drawings import find_repeated_drawings
from urdfcheck.model.use.display import is_never_collided
from urdfcheck.model.use.scenery import scenery_links
from urdfcheck.model.use.simulators import is_started_in_simulator

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
    is_untouched = bool(heavy) and (
        is_never_collided(model) or (bool(scenery_links(model)) and not is_started_in_simulator(model))
    )
    for uses, count in heavy:
        yield rule.finding(
            "heavy",
            at=uses[0].filename,
            severity=Severity.INFO if is_slight or is_untouched else None,
            related=[use.filename for use in uses[1:] if use.shape.role == "collision"],
            link=uses[0].link.name,
            mesh=uses[0].filename.value,
            triangles=count,
            limit=triangles,
            advice=_WHOLE.format(count=len(whole)) if uses[0].link.name in whole else _FINE,
        )
