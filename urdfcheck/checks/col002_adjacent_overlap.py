"""COL002 reports neighbouring links that overlap wherever the joint between them stands."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.collisions import (
    CollisionPair,
    Contact,
    ensure_all_shapes_read,
    locate_geometry,
    self_collisions,
)


def check(model: Model, rule: Rule, *, always: float) -> Iterator[Finding]:
    collisions = self_collisions(model)
    neighbours = [pair for pair in collisions.pairs if pair.relation == "adjacent"]
    found: dict[str | None, tuple[CollisionPair, Contact]] = {}
    for pair in neighbours:
        if pair.contact is not None and not pair.contact.touching and pair.range_share >= always:
            found.setdefault(pair.joint, (pair, pair.contact))
    if found:
        first, *rest = (locate_geometry(contact.shapes[1]) for _, contact in found.values())
        yield rule.finding(
            "overlap",
            at=first,
            related=rest,
            count=len(found),
            total=len({pair.joint for pair in neighbours}),
            joints=join_names(f"{joint} ({pair.links[0]} and {pair.links[1]})" for joint, (pair, _) in found.items()),
            percent=round(100 * always),
            samples=len(collisions.spread_poses.values),
        )
    ensure_all_shapes_read(collisions)
