"""The kinematic tree of links and joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
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
            raise Unavailable("the model has no link (KIN007)")
        nameless = next((link for link in links if not link.name), None)
        if nameless is not None:
            code = "NAM001" if "name" in nameless.element.attributes else "XML005"
            raise Unavailable(f"a link has no name ({code})")
        if len(known) != len(names) or len({j.name for j in joints}) != len(joints):
            raise Unavailable("links or joints share a name (KIN001)")
        parent_joint: dict[str, Joint] = {}
        children: dict[str, list[Joint]] = {name: [] for name in names}
        for joint in joints:
            _ensure_links(joint, known)
            children[joint.parent].append(joint)
        for joint in joints:
            if joint.child in parent_joint:
                raise Unavailable(_why_two_parents(joint.child, joints, children))
            parent_joint[joint.child] = joint
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


def _ensure_links(joint: Joint, known: Set[str]) -> None:
    if not joint.parent or not joint.child:
        raise Unavailable(f"joint {joint.name!r} names no parent or no child (XML005)")
    if joint.parent not in known or joint.child not in known:
        raise Unavailable(f"joint {joint.name!r} names a link that does not exist (KIN002)")
    if joint.parent == joint.child:
        raise Unavailable(f"joint {joint.name!r} connects link {joint.child!r} with itself (KIN006)")


def _why_two_parents(link: str, joints: Sequence[Joint], children: Mapping[str, Sequence[Joint]]) -> str:
    """A link that has several parents, or one beside the joint that leads back to it."""
    below, queue = {link}, [link]
    while queue:
        for joint in children[queue.pop()]:
            if joint.child not in below:
                below.add(joint.child)
                queue.append(joint.child)
    outside = [joint for joint in joints if joint.child == link and joint.parent not in below]
    return f"link {link!r} has several parents (KIN003)" if len(outside) > 1 else "the links form a cycle (KIN004)"
