"""What the launch files start, as an inline SVG like rqt_graph's, and as lists for those who do not see it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.core.scene import Scene, SceneLaunch, SceneNode, SceneParameter, ScenePort
from urdfcheck.output.html.element_names import render_mark_link
from urdfcheck.output.html.html_text import escape_html, render_prose
from urdfcheck.output.html.svg.launch_graph import (
    KIND_NAMES,
    UNKNOWN_PURPOSE,
    build_launch_graph,
    describe_start_condition,
    make_node_key,
    make_parameter_key,
)
from urdfcheck.output.html.svg.launch_svg import draw_launch_graph, render_launch_legend
from urdfcheck.output.shared.anchors import ElementKey, FindingCard, SeverityMark, compute_severity_marks
from urdfcheck.output.shared.wording import format_count

# A larger graph is unreadable and not drawn: the list has the same content.
MOST_BOXES, MOST_LINES = 80, 200


def render_launch_files(scene: Scene, cards: Iterable[FindingCard]) -> str:
    """Render a drawing and a list for each launch file that starts the model; nothing without one."""
    worst = compute_severity_marks(cards, element_spans=_iter_element_spans(scene.launches))
    return "".join(_render_launch(launch, i, worst) for i, launch in enumerate(scene.launches))


def _iter_element_spans(launches: Sequence[SceneLaunch]) -> Iterator[tuple[ElementKey, Span]]:
    for i, launch in enumerate(launches):
        for node_element, spans in (
            *((make_node_key(i, k), node.spans) for k, node in enumerate(launch.nodes)),
            *((make_parameter_key(i, k), parameter.spans) for k, parameter in enumerate(launch.parameters)),
        ):
            yield from ((node_element, span) for span in spans)


def _render_launch(launch: SceneLaunch, index: int, worst: Mapping[ElementKey, SeverityMark]) -> str:
    head = f"<h4><code>{escape_html(launch.file)}</code></h4>"
    notes = "".join(f"<p>{escape_html(note)}</p>" for note in launch.notes)
    if not launch.nodes and not launch.parameters:
        return f'<div class="launch">{head}{notes or "<p>It starts no node.</p>"}</div>'
    boxes, edges = build_launch_graph(launch, index)
    fits = len(boxes) <= MOST_BOXES and len(edges) <= MOST_LINES
    title = f"What {launch.file} starts"
    drawn = (
        f'<figure class="tree"><div class="scroll" role="group" tabindex="0" aria-label="{escape_html(title)}">'
        f"{draw_launch_graph(boxes, edges, worst)}</div>{render_launch_legend(boxes)}</figure>"
        if fits
        else f"<p>{len(boxes)} boxes with {format_count(len(edges), 'line')} are too much to draw.</p>"
    )
    opened = "" if fits else " open"
    return (
        f'<div class="launch">{head}{notes}{drawn}<details{opened}><summary>The same as a list</summary>'
        f"{_render_list(launch, index, worst)}</details></div>"
    )


def _render_list(launch: SceneLaunch, index: int, worst: Mapping[ElementKey, SeverityMark]) -> str:
    written = {port for node in launch.nodes for port in node.writes}
    parameters = {parameter.port for parameter in launch.parameters}
    items = [
        _render_parameter_item(parameter, worst.get(make_parameter_key(index, k)))
        for k, parameter in enumerate(launch.parameters)
    ]
    items += [
        _render_node_item(node, set_parameters=parameters, written=written, mark=worst.get(make_node_key(index, k)))
        for k, node in enumerate(launch.nodes)
    ]
    return f"<ul>{''.join(items)}</ul>"


def _render_parameter_item(parameter: SceneParameter, mark: SeverityMark | None) -> str:
    details = [f"from <code>{escape_html(parameter.origin)}</code>"]
    details += [render_prose(parameter.problem)] if parameter.problem else []
    details += map(escape_html, describe_start_condition(parameter))
    name = f"<code>{escape_html(parameter.port.name)}</code>"
    return f"<li>parameter {name}, {', '.join(details)}{render_mark_link(mark)}</li>"


def _render_node_item(
    node: SceneNode, *, set_parameters: set[ScenePort], written: set[ScenePort], mark: SeverityMark | None
) -> str:
    name = (node.name if node.kind == "node" else node.program) or "unknown"
    text = f"{KIND_NAMES[node.kind]} <code>{escape_html(name)}</code>"
    text += f" (<code>{escape_html(node.program)}</code>)" if node.kind == "node" else ""
    text += f": {escape_html(node.purpose or UNKNOWN_PURPOSE)}"
    reads = [p for p in node.reads if p.kind != "service" or p in written]
    ports = _describe_ports(reads, verb="reads", service_verb="offers", known_ports=set_parameters | written)
    ports += _describe_ports(node.writes, verb="publishes", service_verb="calls", known_ports=written)
    facts = [f"{escape_html(key)} <code>{escape_html(value)}</code>" for key, value in node.facts]
    parts = [*ports, *map(escape_html, describe_start_condition(node)), *facts]
    return f"<li>{'; '.join((text, *parts))}{render_mark_link(mark)}</li>"


def _describe_ports(
    ports: Iterable[ScenePort], *, verb: str, service_verb: str, known_ports: set[ScenePort]
) -> list[str]:
    """Describe what a node reads or writes, a phrase for each kind."""
    missing = {"topic": " (which no node that is known here publishes)", "parameter": " (which is not set here)"}
    kinds: dict[str, list[str]] = {}
    for port in ports:
        note = "" if port in known_ports else missing.get(port.kind, "")
        kinds.setdefault(port.kind, []).append(f"<code>{escape_html(port.name)}</code>{note}")
    return [
        f"{service_verb if kind == 'service' else verb} {kind if len(names) == 1 else kind + 's'} {', '.join(names)}"
        for kind, names in kinds.items()
    ]
