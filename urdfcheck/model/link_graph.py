"""Links and joints as a graph, before it is known to be a tree: what the rules about a broken tree share."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

# Similarity (2 x common letters / all letters) of two words, one of which may be the other misspelled: `weel` and `wheel` have
# 0.89, `left` and `right` 0.44, `front` and `rear` 0.22, `upper` and `lower` 0.6.
_ALIKE = 0.7
# Each unknown name is compared with all links, letter by letter. Nobody types more links, or longer names.
_MOST_COMPARED, _LONGEST_COMPARED = 1_000, 200


@dataclass(frozen=True, slots=True, eq=False)
class KinematicGraph:
    """Links and joints as a graph, before it is known to be a tree."""

    links: tuple[str, ...]
    edges: tuple[Joint, ...]
    """The joints between two different links that exist."""
    broken: tuple[Joint, ...]
    """The other joints."""

    @classmethod
    def from_model(cls, model: Model) -> KinematicGraph:
        """Build the graph of a model.

        :raises FactUnavailableError: when xacro elements that were not expanded may still make links or joints.
        """
        if any(child.tag.startswith("xacro:") for child in model.robot.children):
            raise FactUnavailableError("the file holds xacro elements that nothing has expanded (XML009)")
        links = dict.fromkeys(name for name in model.link_by_name if name)
        edges: list[Joint] = []
        broken: list[Joint] = []
        for joint in model.joints:
            sound = joint.parent in links and joint.child in links and joint.parent != joint.child
            (edges if sound else broken).append(joint)
        return cls(tuple(links), tuple(edges), tuple(broken))

    def guess_link(self, role: str, name: str) -> str | None:
        """Return the link that an unknown ``name`` probably means; for a child, links without a parent come first.

        A macro may name its links below the name that it is given: the part ``wheel_1`` then begins with ``wheel_1/body``.
        """
        if len(self.links) > _MOST_COMPARED or len(name) > _LONGEST_COMPARED:
            return None
        child_names = {joint.child for joint in (*self.edges, *self.broken)}
        unused = [link for link in self.links if link not in child_names]
        if role == "child" and (near := _find_misspelt(name, unused) or _find_below(name, unused)):
            return near
        return _find_misspelt(name, self.links)

    def find_meant_child(self, joints: Iterable[Joint]) -> tuple[Joint, str] | None:
        """Return the joint of several with one child that has the name of a link that no joint carries, and that link.

        ``imu_joint`` means ``imu_link``. None unless the names decide it, and the joint would then connect two pieces.
        """
        pieces = self.find_components()
        carried = {joint.child for joint in (*self.edges, *self.broken)}
        found = [
            (joint, link)
            for joint in joints
            for piece in pieces
            for link in piece
            if link not in carried and joint.parent not in piece and _is_called_alike(joint.name, link)
        ]
        return found[0] if len(found) == 1 and not _is_called_alike(found[0][0].name, found[0][0].child) else None

    def map_parent_joints(self) -> Mapping[str, tuple[Joint, ...]]:
        """Return the joints that have each link as their child."""
        parents: dict[str, list[Joint]] = {name: [] for name in self.links}
        for joint in self.edges:
            parents[joint.child].append(joint)
        return {name: tuple(joints) for name, joints in parents.items()}

    def is_above(self, upper: str, lower: str) -> bool:
        """Whether joints lead from one link to another, or both are the same."""
        return upper in self._find_above(lower)

    def find_roots_above(self, link: str) -> list[str]:
        """Return the links without a parent from which joints lead to ``link``, in document order."""
        parents, above = self.map_parent_joints(), self._find_above(link)
        return [name for name in self.links if name in above and not parents[name]]

    def _find_above(self, link: str) -> set[str]:
        """Return a link with all from which joints lead to it."""
        parents = self.map_parent_joints()
        above, waiting = {link}, [link]
        while waiting:
            found = {joint.parent for joint in parents.get(waiting.pop(), ())} - above
            above |= found
            waiting += found
        return above

    def find_components(self) -> list[list[str]]:
        """Return the connected components, each in document order, the largest first (the first of equals)."""
        index = {name: i for i, name in enumerate(self.links)}
        group = list(range(len(self.links)))

        def find_representative(i: int) -> int:
            while group[i] != i:
                group[i] = group[group[i]]
                i = group[i]
            return i

        for joint in self.edges:
            a, b = find_representative(index[joint.parent]), find_representative(index[joint.child])
            group[max(a, b)] = min(a, b)
        components: dict[int, list[str]] = {}
        for name, i in index.items():
            components.setdefault(find_representative(i), []).append(name)
        return sorted(components.values(), key=len, reverse=True)

    def find_loops(self) -> list[tuple[Joint, ...]]:
        """Return the loops that the joints close, each as its joints from parent to child, one per closing joint.

        Depth-first search over the joints: an edge back to a link on the current path closes a loop.
        """
        children: dict[str, list[Joint]] = {name: [] for name in self.links}
        for edge in self.edges:
            children[edge.parent].append(edge)
        state = dict.fromkeys(self.links, 0)  # 0 unseen, 1 on the path, 2 done
        loops: list[tuple[Joint, ...]] = []
        child_names = {edge.child for edge in self.edges}
        starts = sorted(self.links, key=lambda name: name in child_names)  # from the roots first
        for start in starts:
            if state[start]:
                continue
            state[start] = 1
            path: list[Joint] = []
            stack = [iter(children[start])]
            while stack:
                joint: Joint | None = next(stack[-1], None)
                if joint is None:
                    stack.pop()
                    done = path.pop().child if path else start
                    state[done] = 2
                elif state[joint.child] == 1:
                    first = next((i for i, j in enumerate(path) if j.parent == joint.child), len(path))
                    loops.append((*path[first:], joint))
                elif state[joint.child] == 0:
                    state[joint.child] = 1
                    path.append(joint)
                    stack.append(iter(children[joint.child]))
        return loops


def _find_misspelt(name: str, known: Iterable[str]) -> str | None:
    """Return the known name of which ``name`` may be a misspelling, word by word: left_wheel is not one of right_wheel."""
    near = [k for k in known if len(k) <= _LONGEST_COMPARED]
    alike = [
        k
        for k in near
        if _strip_to_letters(name) == _strip_to_letters(k) or _is_similar(_split_words(name), _split_words(k))
    ]
    return max(alike, key=lambda k: difflib.SequenceMatcher(None, name, k).ratio(), default=None)


def _find_below(name: str, known: Iterable[str]) -> str | None:
    """Return the only known name below ``name``: ``wheel/body`` for ``wheel``."""
    below = [k for k in known if k.startswith(f"{name}/")]
    return below[0] if len(below) == 1 else None


def _is_similar(one: list[str], other: list[str]) -> bool:
    return len(one) == len(other) and all(
        a == b or (a.isalpha() and b.isalpha() and difflib.SequenceMatcher(None, a, b).ratio() >= _ALIKE)
        for a, b in zip(one, other, strict=True)
    )


def _is_called_alike(joint: str, link: str) -> bool:
    """Whether a joint and a link have the same name except for the words that say what they are."""
    words = [word for word in _split_words(joint) if word not in {"joint", "jnt"}]
    return bool(words) and words == _split_words(link)


def _strip_to_letters(name: str) -> str:
    return re.sub(r"[\W_]", "", name).lower()


def _split_words(name: str) -> list[str]:
    """Split ``Left_wheel2_link`` into left, wheel, 2, without the words that many names add."""
    words = [w.lower() for w in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\W\d_A-Za-z]+", name)]
    return [w for w in words if w not in {"link", "lnk", "frame"}] or words
