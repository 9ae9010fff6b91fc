"""COL004: pairs of links that touch whatever the robot does are disabled in its SRDF."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import listed
from urdfcheck.model import Model
from urdfcheck.model.motion.collisions import ensure_all_read
from urdfcheck.model.motion.moveit_pairs import Judged, depth_by_default, judged, moved_links


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # A file without groups or pairs is a part that others include, or was never filled.
    srdfs = [srdf for srdf in model.srdfs if srdf.disabled or srdf.root.all("group")]
    if not srdfs:
        return
    # Of several descriptions of one robot (with and without its gripper) the one that is meant says most about it.
    srdf = max(srdfs, key=lambda srdf: (len(srdf.groups_name & model.link_by_name.keys()), len(srdf.disabled)))
    moved = moved_links(model, srdf)
    always: list[tuple[Judged, float | None]] = []
    by_default: list[tuple[Judged, float | None]] = []
    for j in judged(model):
        meets = j.always or j.by_default
        if not meets or moved.isdisjoint(j.pair.links) or any(s.disables(*j.pair.links) for s in srdfs):
            continue
        depth = depth_by_default(model, j.pair) if j.by_default else None
        if depth != 0.0:  # of faces in one plane collision checkers think differently
            (always if j.always else by_default).append((j, depth))
    for message, pairs in (("always", always), ("default", by_default)):
        if pairs:
            yield rule.finding(
                message,
                at=srdf.root,
                severity=Severity.INFO if message == "default" else None,
                robot=model.name,
                count="1 pair of links collides" if len(pairs) == 1 else f"{len(pairs)} pairs of links collide",
                pairs=listed((_named(j, depth) for j, depth in pairs), most=4),
                lines=listed((_line(j) for j, _ in pairs), most=4),
                samples=f"{len(pairs[0][0].pair.hits):,}",
            )
    ensure_all_read(model.collisions)


def _named(judged: Judged, depth: float | None) -> str:
    return " and ".join(judged.pair.links) + (f" ({1000 * depth:.3g} mm)" if depth is not None else "")


def _line(judged: Judged) -> str:
    first, second = sorted(judged.pair.links)
    return f'<disable_collisions link1="{first}" link2="{second}" reason="{judged.reason}"/>'
