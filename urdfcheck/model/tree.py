"""The kinematic tree of links and joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.core import Unavailable
from urdfcheck.model.parts import Joint, Link


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """``order`` lists the links from the root outwards, each after its parent."""

    root: str
    order: tuple[str, ...]
    parent_joint: Mapping[str, Joint]
    child_joints: Mapping[str, tuple[Joint, ...]]

    @classmethod
    def build(cls, links: Sequence[Link], joints: Sequence[Joint]) -> Tree:
        """:raises Unavailable: when the links and joints are not one tree."""
        names = [link.name for link in links]
        known = set(names)
        if not names:
            raise Unavailable("the model has no link")
        if len(known) != len(names) or len({j.name for j in joints}) != len(joints):
            raise Unavailable("links or joints share a name (KIN001)")
        parent_joint: dict[str, Joint] = {}
        children: dict[str, list[Joint]] = {name: [] for name in names}
        for joint in joints:
            if joint.parent not in known or joint.child not in known:
                raise Unavailable(f"joint {joint.name!r} names a link that does not exist (KIN002)")
            if joint.child in parent_joint:
                raise Unavailable(f"link {joint.child!r} has several parents (KIN003)")
            parent_joint[joint.child] = joint
            children[joint.parent].append(joint)
        roots = [name for name in names if name not in parent_joint]
        if len(roots) != 1:
            raise Unavailable(
                "the links form a cycle (KIN004)" if not roots else f"the model has {len(roots)} roots (KIN005)"
            )
        order: list[str] = []
        queue = [roots[0]]
        while queue:
            name = queue.pop(0)
            order.append(name)
            queue.extend(joint.child for joint in children[name])
        if len(order) != len(names):
            raise Unavailable("some links form a cycle apart from the root (KIN004)")
        return cls(roots[0], tuple(order), parent_joint, {k: tuple(v) for k, v in children.items()})

    def path(self, link: str) -> tuple[Joint, ...]:
        """The joints from the root to a link."""
        joints: list[Joint] = []
        while link in self.parent_joint:
            joints.append(self.parent_joint[link])
            link = joints[-1].parent
        return tuple(reversed(joints))

    def body(self, link: str) -> tuple[str, ...]:
        """The links that fixed joints make one rigid body with ``link``, the nearest to the root first."""
        while link in self.parent_joint and self.parent_joint[link].type == "fixed":
            link = self.parent_joint[link].parent
        found, queue = [], [link]
        while queue:
            name = queue.pop(0)
            found.append(name)
            queue.extend(j.child for j in self.child_joints[name] if j.type == "fixed")
        return tuple(found)

    def moves(self, link: str) -> bool:
        """Whether the link's body hangs on a joint that moves (the root's body does not)."""
        return self.body(link)[0] in self.parent_joint
