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
        # An angle in degrees is not one in radians (JNT012): how far the two are rotated is not known before it is corrected.
        is_known = not displaced.has_angles_beyond_turns
        if not is_known and displaced.moved <= distance:
            continue
        xyz = collision.shape.origin.get_attribute("xyz")
        yield rule.finding(
            "differs",
            at=collision.place,
            related=[displaced.visual.place],
            cause="rpy_in_xyz" if displaced.has_angles_as_position else None,
            edits=displaced.propose_edits() if is_known else (),
            severity=Severity.WARNING if displaced.moved > apart or (is_known and displaced.turned > rotated) else None,
            link=displaced.link.name,
            mesh=collision.what,
            shape=f"mesh {collision.what}" if collision.shape.kind == "mesh" else collision.what,
            moved=float(f"{displaced.moved:.4g}"),
            turned=float(f"{displaced.turned:.4g}"),
            degrees=math.degrees(displaced.turned),
            gap=displaced.describe_gap(with_angle=is_known),
            # Whose boxes are apart is then no news.
            explains=[f"GEO003 {displaced.link.element.label}"] if displaced.moved > apart else [],
            xyz="" if xyz is None else xyz.value,
        )
