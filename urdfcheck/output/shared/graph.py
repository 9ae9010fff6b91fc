"""The links, joints and launch-file transforms of a scene as a drawable forest, however broken the model is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.anchors import Element, frame_element

LINK, LAUNCH, MISSING, REPEATED = "link", "launch", "missing", "repeated"


@dataclass(frozen=True, slots=True)
class Edge:
    """A joint (``kind`` is its type) or a static transform of a launch file (``kind`` is ``launch file``)."""

    name: str
    kind: str
    child: str
    is_joint: bool
    element: Element


@dataclass(frozen=True, slots=True)
class Node:
    """A box of the drawing, in preorder. ``parent`` is an index into the nodes, -1 for a root.

    ``kind``: a link; a frame that only a launch file makes; a name that no link has; or a link drawn above already
    (it has several parents, or is part of a loop).
    """

    name: str
    kind: str
    depth: int
    parent: int
    edge: Edge | None
    children: int


def forest(scene: Scene) -> tuple[Node, ...]:
    """Every link and every transform once, roots first in the order of the scene; loops are cut where they close."""
    links = {link.name for link in scene.links}
    edges, kinds = _edges(scene, links)
    nodes: list[Node] = []
    visited: set[str] = set()
    targets = {edge.child for group in edges.values() for edge in group}
    names = list(dict.fromkeys((scene.root, *(link.name for link in scene.links), *edges)))
    names = [name for name in names if name in kinds]
    # What is still unvisited after the roots lies on a loop: enter it anywhere.
    for start in (*(n for n in names if n not in targets), *names):
        if start not in visited:
            _grow(start, edges, kinds, visited, nodes)
    return tuple(nodes)


def _edges(scene: Scene, links: set[str]) -> tuple[dict[str, list[Edge]], dict[str, str]]:
    edges: dict[str, list[Edge]] = {}
    kinds = dict.fromkeys(links, LINK)
    for joint in scene.joints:
        edge = Edge(joint.name, joint.type, joint.child, True, ("joint", joint.name))
        edges.setdefault(joint.parent, []).append(edge)
        for name in (joint.parent, joint.child):
            kinds.setdefault(name, MISSING)
    for frame in scene.frames:
        edge = Edge("", "launch file", frame.child, False, frame_element(frame.parent, frame.child))
        edges.setdefault(frame.parent, []).append(edge)
        for name in (frame.parent, frame.child):
            kinds.setdefault(name, LAUNCH)
    return edges, kinds


def _grow(
    start: str, edges: Mapping[str, Iterable[Edge]], kinds: Mapping[str, str], visited: set[str], nodes: list[Node]
) -> None:
    """Append ``start`` and all that hangs on it. Iterative: a chain may be longer than Python's stack."""
    jointed = {edge.child for group in edges.values() for edge in group if edge.is_joint}
    waiting: list[tuple[str, int, int, Edge | None]] = [(start, 0, -1, None)]
    while waiting:
        name, depth, parent, edge = waiting.pop()
        # A transform must not take a link away from the joint that carries it.
        taken = edge is not None and not edge.is_joint and name in jointed
        if name in visited or taken:
            nodes.append(Node(name, REPEATED, depth, parent, edge, 0))
            continue
        visited.add(name)
        below = list(edges.get(name, ()))
        nodes.append(Node(name, kinds[name], depth, parent, edge, len(below)))
        index = len(nodes) - 1
        waiting += [(e.child, depth + 1, index, e) for e in reversed(below)]
