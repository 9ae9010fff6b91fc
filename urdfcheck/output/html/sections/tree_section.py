"""The kinematic tree as an inline SVG, and as nested lists for those who do not see it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.core.scene import Scene
from urdfcheck.output.html.element_names import render_data_attribute, render_mark_link
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.svg.tree_svg import NOTES, draw_tree, get_link_key, render_tree_legend
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark
from urdfcheck.output.shared.kinematic_forest import LINK, TreeNode, build_forest

# Chrome stops nesting elements at 512 levels, and a list that deep is unreadable.
DEEPEST_LIST = 24


def render_tree(scene: Scene, marks: Mapping[ElementKey, SeverityMark], title: str) -> str:
    """Render the drawing with its legend and its text form."""
    nodes = build_forest(scene)
    if not nodes:
        return "<p>The model has no links.</p>"
    return (
        f'<figure class="tree"><div class="scroll" role="group" tabindex="0" aria-label="{escape_html(title)}">'
        f"{draw_tree(nodes, marks)}</div>{render_tree_legend(nodes)}</figure>"
        f"<details><summary>The tree as a list</summary>{_render_list(nodes, marks)}</details>"
    )


def _render_list(nodes: Sequence[TreeNode], marks: Mapping[ElementKey, SeverityMark]) -> str:
    """Render nested lists; each line names its parent, so that nothing is lost below :data:`DEEPEST_LIST`."""
    parts: list[str] = []
    level = -1
    for node in nodes:
        depth = min(node.depth, DEEPEST_LIST)
        parts.append("<ul>" * (depth - level) if depth > level else "</li>" + "</ul></li>" * (level - depth))
        parts.append(f"<li>{_render_list_item(node, nodes, marks)}")
        level = depth
    return "".join(parts) + "</li></ul>" * (level + 1)


def _render_list_item(node: TreeNode, nodes: Sequence[TreeNode], marks: Mapping[ElementKey, SeverityMark]) -> str:
    text = f"<code{render_data_attribute(get_link_key(node))}>{escape_html(node.name)}</code>"
    if node.kind != LINK:
        text += f" ({NOTES[node.kind]})"
    text += render_mark_link(marks.get(("link", node.name)) if node.kind == LINK else None)
    if node.edge is None:
        return text
    edge = node.edge
    parent = f"<code>{escape_html(nodes[node.parent].name)}</code>"
    mark_link = render_mark_link(marks.get(edge.element_key))
    if not edge.is_joint:
        return f"{text}, placed on {parent} by a launch file{mark_link}"
    joint = f"<code{render_data_attribute(edge.element_key)}>{escape_html(edge.name)}</code> ({escape_html(edge.kind)})"
    return f"{text}, on {parent} by joint {joint}{mark_link}"
