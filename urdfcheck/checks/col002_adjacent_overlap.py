"""COL002 reports adjacent links that overlap at every position of the joint between them."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.collisions.at_rest import Contact
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, ensure_all_shapes_read, self_collisions
from urdfcheck.model.parts import locate_geometry


def check(model: Model, rule: Rule, *, always: float) -> Iterator[Finding]:
    collisions = self_collisions(model)
    neighbours = [pair for pair in collisions.pairs if pair.relation == "adjacent"]
    overlaps: dict[str | None, tuple[CollisionPair, Contact]] = {}
    for pair in neighbours:
        if pair.contact is not None and not pair.contact.touching and pair.range_share >= always:
            overlaps.setdefault(pair.joint, (pair, pair.contact))
    if overlaps:
        count, total = len(overlaps), len({pair.joint for pair in neighbours})
        first, *rest = (locate_geometry(contact.shapes[1]) for _, contact in overlaps.values())
        yield rule.finding(
            "overlap",
            at=first,
            related=rest,
            count=count,
            total=total,
            where=_describe_share(count, total),
            joints=join_names(
                (f"{joint} ({pair.links[0]} and {pair.links[1]})" for joint, (pair, _) in overlaps.items()), 3
            ),
            percent=round(100 * always),
            samples=len(collisions.spread_poses.values),
        )
    ensure_all_shapes_read(collisions)


def _describe_share(count: int, total: int) -> str:
    """Return ``1 joint``, ``2 of 5 joints`` or ``all 5 joints``."""
    if count < total:
        return f"{count:,} of {total:,} joints"
    return "1 joint" if total == 1 else f"all {total:,} joints"
