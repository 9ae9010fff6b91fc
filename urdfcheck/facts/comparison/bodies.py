"""The rigid bodies of two versions: links that only fixed joints connect are one body."""

from __future__ import annotations

from collections.abc import Mapping

from urdfcheck.core.records import dataclass
from urdfcheck.facts.comparison.alignment import PlacedPair
from urdfcheck.facts.comparison.home_pose import HomePose


@dataclass(frozen=True, slots=True)
class BodyPair:
    """A body in both versions, by the names of its links; empty where a version does not have it."""

    head: str
    """Its first link: of the first version, or of the second where the first does not have it."""
    before: tuple[str, ...]
    after: tuple[str, ...]


def pair_bodies(pair: PlacedPair) -> tuple[BodyPair, ...]:
    """Return the bodies of both versions, from the root outwards.

    A joint that is fixed in one version and moves in the other ends a body in both.
    """
    old_by_new = {new: old for old, new in pair.match.joints.items()}
    ends_before = {
        old
        for old, joint in pair.before.joints.items()
        if joint.type != "fixed" or _is_moving(pair.after, pair.match.joints.get(old))
    }
    ends_after = {
        new
        for new, joint in pair.after.joints.items()
        if joint.type != "fixed" or _is_moving(pair.before, old_by_new.get(new))
    }
    olds, news = _group_links(pair.before, ends_before), _group_links(pair.after, ends_after)
    bodies: list[BodyPair] = []
    taken: set[str] = set()
    for head, links in olds.items():
        joint = pair.before.joint_above.get(head)
        if joint is None:
            new_head: str | None = pair.after.mechanism.root
        else:
            new = pair.match.joints.get(joint.name)
            new_head = None if new is None else pair.after.joints[new].child
        others = news.get(new_head, ()) if new_head is not None and new_head not in taken else ()
        if new_head is not None and others:
            taken.add(new_head)
        bodies.append(BodyPair(head, links, others))
    bodies += [BodyPair(head, (), links) for head, links in news.items() if head not in taken]
    return tuple(bodies)


def _is_moving(home: HomePose, joint: str | None) -> bool:
    return joint is not None and home.joints[joint].type != "fixed"


def _group_links(home: HomePose, ends: set[str]) -> Mapping[str, tuple[str, ...]]:
    """Return the links of each body by its first link; ``ends``: the joints that do not connect two links to one body."""
    head: dict[str, str] = {}
    members: dict[str, list[str]] = {}
    for name in home.order:
        joint = home.joint_above.get(name)
        head[name] = name if joint is None or joint.name in ends else head[joint.parent]
        members.setdefault(head[name], []).append(name)
    return {first: tuple(names) for first, names in members.items()}
