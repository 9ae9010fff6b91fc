"""INR015 reports robots whose total mass is implausible, or impossible for their size."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.shapes.bounds import compute_bounding_box

# Osmium, the densest material at room pressure (kg/m³).
DENSEST = 22_590.0


def check(model: Model, rule: Rule, *, least: float, most: float, unseen: float) -> Iterator[Finding]:
    masses = [declared.mass for declared in model.masses if declared.mass > 0]
    total = sum(masses)
    if not masses:
        return
    edge = _measure_extent(model, unseen)
    if edge is not None and total > DENSEST * edge**3:
        yield rule.finding(
            "dense",
            at=model.name_location,
            cause="grams",
            severity=Severity.ERROR,
            robot=model.name,
            total=total,
            links=len(masses),
            edge=edge,
            most=DENSEST * edge**3,
        )
    elif not least <= total <= most:
        message, cause = ("light", "tonnes") if total < least else ("heavy", "grams")
        yield rule.finding(
            message,
            at=model.name_location,
            cause=cause,
            robot=model.name,
            total=total,
            links=len(masses),
        )


def _measure_extent(model: Model, unseen: float) -> float | None:
    """Return the longest edge (m) of the box around the frames and shapes of the robot, joints at zero.

    If a mesh was not read, it is ``unseen`` times that of the others; None if nothing shows a size.
    """
    try:
        frames = model.frames
    except FactUnavailableError:
        return None
    placed = [(s, frames[link.name]) for link in model.links for s in (*link.visuals, *link.collisions)]
    boxes = [compute_bounding_box(model, [item]) for item in placed]
    known = [box for box in boxes if box is not None]
    corners = np.concatenate([*known, [frame[:3, 3] for frame in frames.values()]])
    extent = float(np.ptp(corners, axis=0).max())
    if not placed or extent == 0.0 or not np.isfinite(extent):
        return None
    return extent if len(known) == len(boxes) else unseen * extent
