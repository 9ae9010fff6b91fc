"""The links, joints and launch-file transforms of a scene as a drawable forest, however broken the model is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.anchors import ElementKey, make_frame_key

LINK, LAUNCH, MISSING, REPEATED = "link", "launch", "missing", "repeated"


@dataclass(frozen=True, slots=True)
class TreeEdge:
    """A joint (``kind`` is its type) or a static transform of a launch file (``kind`` is ``launch file``)."""

    name: str
    kind: str
    child: str
    is_joint: bool
    element: ElementKey


@dataclass(frozen=True, slots=True)
class TreeNode:
    """A box of the drawing, in preorder. ``parent`` is an index into the nodes, -1 for a root.

    ``kind``: a link; a frame that only a launch file makes; a name that no link has; or a link drawn above already
    (it has several parents, or is part of a loop).
    """

    name: str
    kind: str
    depth: int
    parent: int
    edge: TreeEdge | None
    children: int


def build_forest(scene: Scene) -> tuple[TreeNode, ...]:
    """Every link and every transform once, roots first in the order of the scene; loops are cut where they close."""
    links = {link.name for link in scene.links}
    edges, kinds = _collect_edges(scene, links)
    nodes: list[TreeNode] = []
    visited: set[str] = set()
    targets = {edge.child for group in edges.values() for edge in group}
    names = list(dict.fromkeys((scene.root, *(link.name for link in scene.links), *edges)))
    names = [name for name in names if name in kinds]
    # What is still unvisited after the roots lies on a loop: enter it anywhere.
    for start in (*(n for n in names if n not in targets), *names):
        if start not in visited:
            _append_subtree(start, edges, kinds, visited, nodes)
    return tuple(nodes)


def _collect_edges(scene: Scene, links: set[str]) -> tuple[dict[str, list[TreeEdge]], dict[str, str]]:
    edges: dict[str, list[TreeEdge]] = {}
    kinds = dict.fromkeys(links, LINK)
    for joint in scene.joints:
        edge = TreeEdge(joint.name, joint.type, joint.child, True, ("joint", joint.name))
        edges.setdefault(joint.parent, []).append(edge)
        for name in (joint.parent, joint.child):
            kinds.setdefault(name, MISSING)
    for frame in scene.frames:
        edge = TreeEdge("", "launch file", frame.child, False, make_frame_key(frame.parent, frame.child))
        edges.setdefault(frame.parent, []).append(edge)
        for name in (frame.parent, frame.child):
            kinds.setdefault(name, LAUNCH)
    return edges, kinds


def _append_subtree(
    start: str,
    edges: Mapping[str, Iterable[TreeEdge]],
    kinds: Mapping[str, str],
    visited: set[str],
    nodes: list[TreeNode],
) -> None:
    """Append ``start`` and all that hangs on it. Iterative: a chain may be longer than Python's stack."""
    jointed = {edge.child for group in edges.values() for edge in group if edge.is_joint}
    waiting: list[tuple[str, int, int, TreeEdge | None]] = [(start, 0, -1, None)]
    while waiting:
        name, depth, parent, edge = waiting.pop()
        # A transform must not take a link away from the joint that carries it.
        taken = edge is not None and not edge.is_joint and name in jointed
        if name in visited or taken:
            nodes.append(TreeNode(name, REPEATED, depth, parent, edge, 0))
            continue
        visited.add(name)
        below = list(edges.get(name, ()))
        nodes.append(TreeNode(name, kinds[name], depth, parent, edge, len(below)))
        index = len(nodes) - 1
        waiting += [(e.child, depth + 1, index, e) for e in reversed(below)]
