"""The kinematic tree of links and joints."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from functools import cached_property

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.model.parts import Joint, Link

# urdfdom and Pinocchio follow a chain of links recursively: a stack of 8 MiB lasts for more than 2,000, beyond that the process
# dies. Published robots have up to 22.
MOST_LEVELS = 1_000


@dataclass(frozen=True, eq=False)
class Tree:
    """The kinematic tree."""

    root: str
    order: tuple[str, ...]
    """The links from the root outwards, each after its parent."""
    parent_joint: Mapping[str, Joint]
    """The joint on which each link but the root hangs, by its name."""
    child_joints: Mapping[str, tuple[Joint, ...]]
    """The joints that hang on each link."""

    @classmethod
    def build(cls, links: Sequence[Link], joints: Sequence[Joint]) -> Tree:
        """Build the tree of a model.

        :raises FactUnavailableError: when the links and joints are not one tree.
        """
        _ensure_names(links, joints)
        names = dict.fromkeys(link.name for link in links)
        parent_joint, child_joints = _connect_links(names, joints)
        roots = [name for name in names if name not in parent_joint]
        if len(roots) != 1:
            raise FactUnavailableError(
                "the links form a cycle (KIN004)" if not roots else f"the model has {len(roots)} roots (KIN005)"
            )
        order, level = _order_from_root(roots[0], child_joints)
        if len(order) != len(names):
            raise FactUnavailableError("some links form a cycle apart from the root (KIN004)")
        if level > MOST_LEVELS:
            raise TreeTooDeepError(level, order[-1])
        return cls(
            root=roots[0],
            order=tuple(order),
            parent_joint=parent_joint,
            child_joints={name: tuple(below) for name, below in child_joints.items()},
        )

    @classmethod
    def build_pieces(cls, links: Sequence[Link], joints: Sequence[Joint]) -> Tree:
        """Build the trees of a model in pieces: joints that name a link that does not exist are left out, several roots are kept.

        ``root`` is the first of them. Bodies, and what is fixed to what in them, are known; how the pieces are placed is not.

        :raises FactUnavailableError: when a name is missing or shared, when a link has several parents, and for a cycle.
        """
        _ensure_names(links, joints)
        names = dict.fromkeys(link.name for link in links)
        connected = [joint for joint in joints if joint.parent in names and joint.child in names]
        parent_joint, child_joints = _connect_links(names, connected)
        order: list[str] = []
        roots = [name for name in names if name not in parent_joint]
        for root in roots:
            below, level = _order_from_root(root, child_joints)
            if level > MOST_LEVELS:
                raise TreeTooDeepError(level, below[-1])
            order += below
        if len(order) != len(names):
            raise FactUnavailableError("some links form a cycle (KIN004)")
        return cls(
            root=roots[0],
            order=tuple(order),
            parent_joint=parent_joint,
            child_joints={name: tuple(below) for name, below in child_joints.items()},
        )

    def find_path_to(self, link: str) -> tuple[Joint, ...]:
        """Return the joints from the root to a link."""
        joints: list[Joint] = []
        while link in self.parent_joint:
            joints.append(self.parent_joint[link])
            link = joints[-1].parent
        return tuple(reversed(joints))

    def list_body_links(self, link: str) -> tuple[str, ...]:
        """Return the links that fixed joints merge into one rigid body with ``link``, the nearest to the root first."""
        return self._body_links[link]

    @cached_property
    def _body_links(self) -> Mapping[str, tuple[str, ...]]:
        """The links of each link's body; links of one body share one tuple."""
        head: dict[str, str] = {}
        members: dict[str, list[str]] = {}
        for name in self.order:
            joint = self.parent_joint.get(name)
            head[name] = name if joint is None or joint.type != "fixed" else head[joint.parent]
            members.setdefault(head[name], []).append(name)
        wholes = {first: tuple(names) for first, names in members.items()}
        return {name: wholes[first] for name, first in head.items()}

    def is_movable_link(self, link: str) -> bool:
        """Whether the link's body hangs on a joint that moves (the root's body does not)."""
        return self.list_body_links(link)[0] in self.parent_joint


def _connect_links(
    names: Mapping[str, None], joints: Sequence[Joint]
) -> tuple[dict[str, Joint], dict[str, list[Joint]]]:
    """Return the joint on which each link hangs, and those that hang on each.

    :raises FactUnavailableError: when a joint names a link that does not exist, or a link has several parents.
    """
    parent_joint: dict[str, Joint] = {}
    child_joints: dict[str, list[Joint]] = {name: [] for name in names}
    for joint in joints:
        _ensure_links(joint, names.keys())
        child_joints[joint.parent].append(joint)
    for joint in joints:
        if joint.child in parent_joint:
            raise FactUnavailableError(_explain_two_parents(joint.child, joints, child_joints))
        parent_joint[joint.child] = joint
    return parent_joint, child_joints


class TreeTooDeepError(FactUnavailableError):
    """A chain of ``levels`` links, down to ``link``; ``limit`` would be followed."""

    def __init__(self, levels: int, link: str) -> None:
        super().__init__(f"a chain of {levels:,} links exceeds {MOST_LEVELS:,} (URC905)")
        self.levels, self.limit = levels, MOST_LEVELS
        self.link = link


def _order_from_root(root: str, child_joints: Mapping[str, Sequence[Joint]]) -> tuple[list[str], int]:
    """Return the links that hang on the root, each after its parent, and on how many levels they are."""
    order: list[str] = []
    queue = deque(((root, 1),))
    level = 0
    while queue:
        name, level = queue.popleft()
        order.append(name)
        queue.extend((joint.child, level + 1) for joint in child_joints[name])
    return order, level


def _ensure_names(links: Sequence[Link], joints: Sequence[Joint]) -> None:
    if not links:
        raise FactUnavailableError("the model has no link (KIN007)")
    nameless = next((link for link in links if not link.name), None)
    if nameless is not None:
        code = "NAM001" if "name" in nameless.element.attributes else "XML005"
        raise FactUnavailableError(f"a link has no name ({code})")
    if len({link.name for link in links}) != len(links) or len({j.name for j in joints}) != len(joints):
        raise FactUnavailableError("links or joints share a name (KIN001)")


def _ensure_links(joint: Joint, known: AbstractSet[str]) -> None:
    if not joint.parent or not joint.child:
        raise FactUnavailableError(f"joint {joint.name!r} names no parent or no child (XML005)")
    if joint.parent not in known or joint.child not in known:
        raise FactUnavailableError(f"joint {joint.name!r} names a link that does not exist (KIN002)")
    if joint.parent == joint.child:
        raise FactUnavailableError(f"joint {joint.name!r} connects link {joint.child!r} with itself (KIN006)")


def _explain_two_parents(link: str, joints: Sequence[Joint], children: Mapping[str, Sequence[Joint]]) -> str:
    """Explain a link that several joints have as their child: several parents, or a joint that leads back to it."""
    below, queue = {link}, [link]
    while queue:
        for joint in children[queue.pop()]:
            if joint.child not in below:
                below.add(joint.child)
                queue.append(joint.child)
    outside = [joint for joint in joints if joint.child == link and joint.parent not in below]
    return f"link {link!r} has several parents (KIN003)" if len(outside) > 1 else "the links form a cycle (KIN004)"
