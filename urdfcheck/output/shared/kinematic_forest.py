"""The links, joints and launch-file transforms of a scene as a drawable forest, however broken the model is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.anchors import ElementKey, make_frame_key

LINK, LAUNCH, MISSING, REPEATED = "link", "launch", "missing", "repeated"


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeEdge:
    """A joint, or a static transform of a launch file."""

    name: str
    """Empty for a static transform."""
    kind: str
    """The type of the joint, or ``launch file``."""
    child: str
    is_joint: bool
    element_key: ElementKey


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeNode:
    """A box of the drawing, in preorder."""

    name: str
    kind: str
    """`LINK`; `LAUNCH`, a frame that only a launch file makes; `MISSING`, a name without a link; or `REPEATED`, a link drawn
    above already because it has several parents or is part of a loop."""
    depth: int
    parent: int
    """Index into the nodes, -1 for a root."""
    edge: TreeEdge | None
    """The edge from the parent; None for a root."""
    children: int
    """Number of edges that leave the node."""


def build_forest(scene: Scene) -> tuple[TreeNode, ...]:
    """Build a forest of every link and transform, each once, roots in the order of the scene; loops are cut where they close."""
    links = {link.name for link in scene.links}
    edges, kinds = _collect_edges(scene, links)
    nodes: list[TreeNode] = []
    visited: set[str] = set()
    targets = {edge.child for group in edges.values() for edge in group}
    names = list(dict.fromkeys((scene.root, *(link.name for link in scene.links), *edges)))
    names = [name for name in names if name in kinds]
    # Links still unvisited after the roots are on a loop: enter it anywhere.
    for start in (*(n for n in names if n not in targets), *names):
        if start not in visited:
            _append_subtree(start, edges=edges, kinds=kinds, visited=visited, nodes=nodes)
    return tuple(nodes)


def _collect_edges(scene: Scene, links: set[str]) -> tuple[dict[str, list[TreeEdge]], dict[str, str]]:
    edges: dict[str, list[TreeEdge]] = {}
    kinds = dict.fromkeys(links, LINK)
    for joint in scene.joints:
        edge = TreeEdge(
            name=joint.name, kind=joint.type, child=joint.child, is_joint=True, element_key=("joint", joint.name)
        )
        edges.setdefault(joint.parent, []).append(edge)
        for name in (joint.parent, joint.child):
            kinds.setdefault(name, MISSING)
    for frame in scene.frames:
        edge = TreeEdge(
            name="",
            kind="launch file",
            child=frame.child,
            is_joint=False,
            element_key=make_frame_key(frame.parent, frame.child),
        )
        edges.setdefault(frame.parent, []).append(edge)
        for name in (frame.parent, frame.child):
            kinds.setdefault(name, LAUNCH)
    return edges, kinds


def _append_subtree(
    start: str,
    *,
    edges: Mapping[str, Iterable[TreeEdge]],
    kinds: Mapping[str, str],
    visited: set[str],
    nodes: list[TreeNode],
) -> None:
    """Append ``start`` and everything below it. Iterative: a chain may be longer than Python's stack."""
    jointed = {edge.child for group in edges.values() for edge in group if edge.is_joint}
    waiting: list[tuple[str, int, int, TreeEdge | None]] = [(start, 0, -1, None)]
    while waiting:
        name, depth, parent, edge = waiting.pop()
        # A link stays below its joint even if a transform reaches it first.
        belongs_to_joint = edge is not None and not edge.is_joint and name in jointed
        if name in visited or belongs_to_joint:
            nodes.append(TreeNode(name=name, kind=REPEATED, depth=depth, parent=parent, edge=edge, children=0))
            continue
        visited.add(name)
        below = list(edges.get(name, ()))
        nodes.append(TreeNode(name=name, kind=kinds[name], depth=depth, parent=parent, edge=edge, children=len(below)))
        index = len(nodes) - 1
        waiting += [(e.child, depth + 1, index, e) for e in reversed(below)]
