"""GEO005 reports equal visual and collision shapes of a link that have different origins."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.shapes.displaced_collisions import list_displaced_collisions


def check(
    model: Model, rule: Rule, *, distance: float, angle: float, apart: float, rotated: float
) -> Iterator[Finding]:
    for displaced in list_displaced_collisions(model, distance=distance, angle=angle):
        collision = displaced.collision
        xyz = collision.shape.origin.get_attribute("xyz")
        yield rule.finding(
            "differs",
            at=collision.place,
            related=[displaced.visual.place],
            cause="rpy_in_xyz" if displaced.has_angles_as_position else None,
            edits=displaced.propose_edits(),
            severity=Severity.WARNING if displaced.moved > apart or displaced.turned > rotated else None,
            link=displaced.link.name,
            mesh=collision.what,
            shape=f"mesh {collision.what}" if collision.shape.kind == "mesh" else collision.what,
            moved=float(f"{displaced.moved:.4g}"),
            turned=float(f"{displaced.turned:.4g}"),
            degrees=math.degrees(displaced.turned),
            gap=displaced.describe_gap(),
            # Whose boxes are apart is then no news.
            explains=[f"GEO003 {displaced.link.element.label}"] if displaced.moved > apart else [],
            xyz="" if xyz is None else xyz.value,
        )
