"""The kinematic tree as a Mermaid flowchart, which GitHub and GitLab draw from Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Finding, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark, build_finding_cards, compute_severity_marks
from urdfcheck.output.shared.escaping import escape_one_line
from urdfcheck.output.shared.kinematic_forest import LAUNCH, REPEATED, TreeEdge, TreeNode, build_forest

# Mermaid's default limits: characters of a chart, and edges.
MOST_CHARACTERS = 50_000
MOST_EDGES = 500
LONGEST_NAME = 40
SIGNS = {Severity.ERROR: "✖", Severity.WARNING: "▲", Severity.INFO: "ℹ"}
# Legible on white and on black: each has its own background.
COLORS = {
    Severity.ERROR: ("#ffd7d5", "#cf222e"),
    Severity.WARNING: ("#fff1c2", "#9a6700"),
    Severity.INFO: ("#ddf4ff", "#0969da"),
}
# Everything except these is written as a character code: Mermaid might interpret it even between quotes.
_SPELLED = re.compile(r"[^\w ./,()-]", re.ASCII)


@dataclass(frozen=True, slots=True)
class MermaidChart:
    """A flowchart with ``shown`` of the ``total`` frames of the tree."""

    text: str
    shown: int
    total: int


def build_mermaid_chart(scene: Scene, findings: Iterable[Finding]) -> MermaidChart:
    """Draw the links and frames of a scene in the colours of their worst findings; of a large tree, those next to the root."""
    nodes = build_forest(scene)
    worst = compute_severity_marks(build_finding_cards(findings), scene.frames)
    styles = [
        f"  classDef {severity} fill:{fill},stroke:{line},color:#1f2328" for severity, (fill, line) in COLORS.items()
    ]
    lines = [f"flowchart {_choose_direction(nodes)}", *styles]
    left = MOST_CHARACTERS - sum(len(line) + 1 for line in lines)
    ids: dict[str, str] = {}
    edges = 0
    for shown, index in enumerate(sorted(range(len(nodes)), key=lambda i: nodes[i].depth)):
        added = _draw_node(nodes, index, ids=ids, worst=worst, edge_count=edges)
        left -= sum(len(line) + 1 for line in added)
        if left < 0 or edges + (nodes[index].edge is not None) > MOST_EDGES:
            return MermaidChart(_join_lines(lines), shown, len(nodes))
        edges += nodes[index].edge is not None
        lines += added
    return MermaidChart(_join_lines(lines), len(nodes), len(nodes))


def _join_lines(lines: Sequence[str]) -> str:
    return "\n".join(lines) + "\n"


def _choose_direction(nodes: Sequence[TreeNode]) -> str:
    """Choose downwards for a tree that is deeper than it is wide: a page can grow in height, not in width."""
    leaves = sum(not node.children for node in nodes)
    return "TD" if leaves <= max((node.depth for node in nodes), default=0) + 1 else "LR"


def _draw_node(
    nodes: Sequence[TreeNode],
    index: int,
    *,
    ids: dict[str, str],
    worst: Mapping[ElementKey, SeverityMark],
    edge_count: int,
) -> list[str]:
    """Return the lines of a node and of the edge to it. A link drawn already gets another arrow and no second box."""
    node = nodes[index]
    lines = []
    if node.kind != REPEATED or node.name not in ids:
        ids.setdefault(node.name, f"n{index}")
        element = node.edge.element_key if node.kind == LAUNCH and node.edge is not None else ("link", node.name)
        mark = worst.get(element)
        style = "" if mark is None else f":::{mark.severity}"
        lines.append(f'  {ids[node.name]}["{_format_sign(mark)}{format_label(node.name)}"]{style}')
    if node.edge is not None:
        mark = worst.get(node.edge.element_key)
        arrow = "-->" if node.edge.is_joint else "-.->"
        parent = ids[nodes[node.parent].name]
        lines.append(f'  {parent} {arrow}|"{_format_sign(mark)}{_format_edge_label(node.edge)}"| {ids[node.name]}')
        if mark is not None:
            lines.append(f"  linkStyle {edge_count} stroke:{COLORS[mark.severity][1]}")
    return lines


def _format_sign(mark: SeverityMark | None) -> str:
    return "" if mark is None else f"{SIGNS[mark.severity]} "


def _format_edge_label(edge: TreeEdge) -> str:
    return f"{format_label(edge.name)} ({format_label(edge.kind)})" if edge.is_joint else "launch file"


def format_label(name: str) -> str:
    """Format a name for use between quotes; a long one loses its middle, because names of links differ at both ends."""
    half = LONGEST_NAME // 2
    shown = name if len(name) <= LONGEST_NAME else f"{name[: half - 1]}…{name[-half:]}"
    return _SPELLED.sub(
        lambda match: match[0] if match[0] > "\x7f" else f"#{ord(match[0])};", escape_one_line(shown) or "(no name)"
    )
