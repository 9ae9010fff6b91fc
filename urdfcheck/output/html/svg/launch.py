"""What the launch files start, as an inline SVG like rqt_graph's, and as lists for those who do not see it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.core import Span
from urdfcheck.core.scene import Scene, SceneLaunch, SceneNode, SceneParameter, ScenePort
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.svg.layers import BoxPosition, EdgeCurve, lay_out_graph
from urdfcheck.output.html.svg.tree import ADVANCE, SMALL, count_columns, shorten_name
from urdfcheck.output.html.text import escape_html, get_base_name, render_prose
from urdfcheck.output.shared.anchors import ElementKey, FindingCard, SeverityMark, compute_severity_marks
from urdfcheck.output.shared.wording import format_count

# What is drawn: a graph with more is a tangle, and the list says the same.
MOST_BOXES, MOST_LINES = 80, 200
# A box with one line and with two.
LOW_BOX, HIGH_BOX = 30.0, 44.0
MARGIN = 2
KIND_NAMES = {
    "node": "node",
    "launch file": "launch file that was not read",
    "process": "process",
    "topic": "topic",
    "service": "service",
    "parameter": "parameter",
    "file": "file",
}
UNKNOWN_PURPOSE = "what it reads and writes is not known here"


@dataclass(frozen=True, slots=True)
class LaunchBox:
    """A drawn box. ``kind`` as in `KIND_NAMES`; ``lines``: its name and, where there is one, what stands below; ``told``: its
    tooltip; ``element``: by which its findings are found; ``dashed``: it may not be there; ``off``: by default it is not."""

    kind: str
    lines: tuple[str, ...]
    tooltip: str
    element_key: ElementKey | None
    dashed: bool = False
    off_by_default: bool = False

    @property
    def size(self) -> tuple[float, float]:
        widths = [count_columns(line) * (ADVANCE if i == 0 else SMALL) for i, line in enumerate(self.lines)]
        ends = 26 if self.kind in ("service", "topic") else 20
        return round(max(widths) + 2 * ends, 1), HIGH_BOX if len(self.lines) > 1 else LOW_BOX


def render_launch_files(scene: Scene, cards: Iterable[FindingCard]) -> str:
    """A drawing and a list for each launch file that starts the model; nothing without one."""
    worst = compute_severity_marks(cards, element_spans=_iter_element_spans(scene.launches))
    return "".join(_render_launch(launch, i, worst) for i, launch in enumerate(scene.launches))


def _iter_element_spans(launches: Sequence[SceneLaunch]) -> Iterator[tuple[ElementKey, Span]]:
    for i, launch in enumerate(launches):
        for node_element, spans in (
            *((_make_node_key(i, k), node.spans) for k, node in enumerate(launch.nodes)),
            *((_make_parameter_key(i, k), parameter.spans) for k, parameter in enumerate(launch.parameters)),
        ):
            yield from ((node_element, span) for span in spans)


def _make_node_key(launch: int, index: int) -> ElementKey:
    return ("started", str(launch), str(index))


def _make_parameter_key(launch: int, index: int) -> ElementKey:
    return ("parameter", str(launch), str(index))


def _render_launch(launch: SceneLaunch, index: int, worst: Mapping[ElementKey, SeverityMark]) -> str:
    head = f"<h4><code>{escape_html(launch.file)}</code></h4>"
    notes = "".join(f"<p>{escape_html(note)}</p>" for note in launch.notes)
    if not launch.nodes and not launch.parameters:
        return f'<div class="launch">{head}{notes or "<p>It starts no node.</p>"}</div>'
    boxes, edges = _build_graph(launch, index)
    fits = len(boxes) <= MOST_BOXES and len(edges) <= MOST_LINES
    title = f"What {launch.file} starts"
    drawn = (
        f'<figure class="tree"><div class="scroll" role="group" tabindex="0" aria-label="{escape_html(title)}">'
        f"{_draw_graph(boxes, edges, worst)}</div>{_render_legend(boxes)}</figure>"
        if fits
        else f"<p>{len(boxes)} boxes with {format_count(len(edges), 'line')} are too much to draw.</p>"
    )
    opened = "" if fits else " open"
    return (
        f'<div class="launch">{head}{notes}{drawn}<details{opened}><summary>The same as a list</summary>'
        f"{_render_list(launch, index, worst)}</details></div>"
    )


# -- what is drawn -----------------------------------------------------------------------------------------------------


def _build_graph(launch: SceneLaunch, index: int) -> tuple[list[LaunchBox], list[tuple[int, int, bool]]]:
    """The boxes, and the edges between them with whether each is dashed."""
    boxes = [_make_node_box(node, _make_node_key(index, k)) for k, node in enumerate(launch.nodes)]
    at: dict[ScenePort, int] = {}
    for k, parameter in enumerate(launch.parameters):
        if parameter.port not in at and any(parameter.port in node.reads for node in launch.nodes):
            at[parameter.port] = len(boxes)
            boxes.append(_make_parameter_box(parameter, _make_parameter_key(index, k)))
    written = {port for node in launch.nodes for port in node.writes}
    for port in dict.fromkeys(p for node in launch.nodes for p in (*node.reads, *node.writes)):
        # A service that nobody calls is one of many.
        if port not in at and (port.kind != "service" or port in written):
            at[port] = len(boxes)
            boxes.append(_make_port_box(port, port in written))
    edges: dict[tuple[int, int], bool] = {}
    for k, node in enumerate(launch.nodes):
        dashed = bool(node.condition)
        edges |= {(at[port], k): dashed for port in node.reads if port in at}
        edges |= {(k, at[port]): dashed for port in node.writes}
    return boxes, [(a, b, dashed) for (a, b), dashed in edges.items()]


def _make_node_box(node: SceneNode, element: ElementKey) -> LaunchBox:
    program = get_base_name(node.program)
    package = node.program.removesuffix(program).rstrip("/")
    if node.kind == "launch file":
        lines = (program, package) if package else (program,)
    elif node.kind == "process":
        lines = (program or "a process",)
    else:
        name = node.name or "unknown"
        lines = (name,) if get_base_name(name) == program or not program else (name, program)
    told = ". ".join(
        (f"{KIND_NAMES[node.kind]} {node.name or program}", node.purpose or UNKNOWN_PURPOSE, *_describe_condition(node))
    )
    return LaunchBox(node.kind, tuple(map(shorten_name, lines)), told, element, bool(node.condition), node.off)


def _describe_condition(node_or_parameter: SceneNode | SceneParameter) -> tuple[str, ...]:
    if not node_or_parameter.condition:
        return ()
    return (f"started {node_or_parameter.condition}" + (", and not by default" if node_or_parameter.off else ""),)


def _make_parameter_box(parameter: SceneParameter, element: ElementKey) -> LaunchBox:
    origin = "origin unresolved" if parameter.problem else get_base_name(parameter.origin)
    told = f"parameter {parameter.port.name}, from {parameter.origin}"
    told = ". ".join((told, *([parameter.problem] if parameter.problem else []), *_describe_condition(parameter)))
    lines = (shorten_name(_get_parameter_name(parameter.port)), shorten_name(origin))
    return LaunchBox("parameter", lines, told, element, bool(parameter.condition or parameter.problem), parameter.off)


def _get_parameter_name(port: ScenePort) -> str:
    """In ROS 2 a parameter belongs to a node, which stands beside it in the drawing."""
    return port.name.rpartition(" ")[2]


def _make_port_box(port: ScenePort, is_written: bool) -> LaunchBox:
    if port.kind == "file":
        return LaunchBox("file", (shorten_name(get_base_name(port.name)),), f"file {port.name}", None)
    name = shorten_name(port.name.removesuffix(" (Gazebo transport)"))
    if port.kind == "parameter":
        return LaunchBox(
            "parameter", (name, "not set here"), f"parameter {port.name}, not set by this launch file", None, True
        )
    if port.kind == "topic" and not is_written:
        told = f"topic {port.name}: no node that is known here publishes it"
        return LaunchBox("topic", (name, "no known publisher"), told, None, True)
    return LaunchBox(port.kind, (name,), f"{port.kind} {port.name}", None)


# -- drawing -----------------------------------------------------------------------------------------------------------


def _draw_graph(
    boxes: Sequence[LaunchBox], edges: Sequence[tuple[int, int, bool]], worst: Mapping[ElementKey, SeverityMark]
) -> str:
    found = [None if box.element_key is None else worst.get(box.element_key) for box in boxes]
    sizes = [(w + (18 if mark else 0), h) for (w, h), mark in zip((b.size for b in boxes), found, strict=True)]
    layout = lay_out_graph(sizes, [(a, b) for a, b, _ in edges])
    width, height = round(layout.width) + 2 * MARGIN, round(layout.height) + 2 * MARGIN
    lines = "".join(_draw_edge(curve, dashed) for curve, (_, _, dashed) in zip(layout.curves, edges, strict=True))
    items = "".join(map(_draw_box, boxes, layout.positions, sizes, found))
    # Presentation attributes, so that the drawing is legible where a server's policy blocks the style.
    return (
        f'<svg class="graph" width="{width}" height="{height}" viewBox="{-MARGIN} {-MARGIN} {width} {height}" role="group" '
        f'aria-label="{format_count(sum(b.element_key is not None for b in boxes), "part")} of a launch file, drawn as a graph" '
        f'font-family="monospace" font-size="12" fill="none" stroke-width="1.5"><g>{lines}</g>{items}</svg>'
    )


def _draw_edge(curve: EdgeCurve, dashed: bool) -> str:
    if not curve.points:
        return ""
    points = list(curve.points)
    # The arrow covers the last bit of the line.
    tip, sign = (points[0], -1) if curve.is_reversed else (points[-1], 1)
    (x, y), *rest = points
    path = f"M{x:g} {y:g}"
    for k, (x1, y1) in enumerate(rest):
        middle = (x + x1) / 2
        straight = k % 2 == 0 or abs(y1 - y) < 0.5
        path += f"H{x1:g}" if straight else f"C{middle:g} {y:g} {middle:g} {y1:g} {x1:g} {y1:g}"
        x, y = x1, y1
    dashes = ' stroke-dasharray="4 3"' if dashed else ""
    arrow = f"M{tip[0]:g} {tip[1]:g}l{-8 * sign} -4v8z"
    return (
        f'<path class="edge flow" stroke="currentColor"{dashes} d="{path}"/>'
        f'<path class="arrow" fill="currentColor" stroke="none" d="{arrow}"/>'
    )


def _draw_box(box: LaunchBox, place: BoxPosition, size: tuple[float, float], mark: SeverityMark | None) -> str:
    names = [
        "node",
        box.kind.replace(" ", "-"),
        *(["off"] if box.off_by_default else []),
        *([str(mark.severity)] if mark else []),
    ]
    dashes = ' stroke-dasharray="5 3"' if box.dashed else ""
    outline = f'<path stroke="currentColor"{dashes} d="{_trace_outline(box.kind, place, size)}"/>'
    middle = place.x + size[0] / 2 + (9 if mark else 0)
    first = place.y + 4 if len(box.lines) == 1 else place.y - 4
    text = f'<text x="{middle:g}" y="{first:g}" text-anchor="middle">{escape_html(box.lines[0])}</text>'
    if len(box.lines) > 1:
        text += (
            f'<text class="type" x="{middle:g}" y="{place.y + 13:g}" text-anchor="middle" font-size="11">'
            f"{escape_html(box.lines[1])}</text>"
        )
    told = box.tooltip
    sign = ""
    if mark is not None:
        told += f". {mark.severity}" + (f", the worst of {mark.count} findings" if mark.count > 1 else "")
        left = middle - max(count_columns(box.lines[0]) * ADVANCE, count_columns(box.lines[-1]) * SMALL) / 2 - 19
        sign = f'<use href="#g-{mark.severity}" x="{left:g}" y="{place.y - 7:g}" width="14" height="14"/>'
    drawn = f'<g class="{" ".join(names)}"><title>{escape_html(told)}</title>{outline}<g fill="currentColor">{sign}{text}</g></g>'
    return drawn if mark is None else f'<a href="#{mark.anchor}">{drawn}</a>'


def _trace_outline(kind: str, place: BoxPosition, size: tuple[float, float]) -> str:
    """A box for what runs, round ends for a topic, pointed ones for a service, a folded corner for a parameter or a file, and
    bars at the sides of what holds more."""
    (w, h), x, y = size, place.x, place.y - size[1] / 2
    if kind == "topic":
        r = h / 2
        return f"M{x + r:g} {y:g}h{w - h:g}a{r:g} {r:g} 0 0 1 0 {h:g}h{h - w:g}a{r:g} {r:g} 0 0 1 0 {-h:g}z"
    if kind == "service":
        return f"M{x + 12:g} {y:g}h{w - 24:g}l12 {h / 2:g}l-12 {h / 2:g}h{24 - w:g}l-12 {-h / 2:g}z"
    if kind in ("parameter", "file"):
        return f"M{x:g} {y:g}h{w - 11:g}l11 11v{h - 11:g}h{-w:g}zM{x + w - 11:g} {y:g}v11h11"
    if kind == "launch file":
        return f"M{x:g} {y:g}h{w:g}v{h:g}h{-w:g}zM{x + 6:g} {y:g}v{h:g}M{x + w - 6:g} {y:g}v{h:g}"
    return (
        f"M{x + 6:g} {y:g}h{w - 12:g}a6 6 0 0 1 6 6v{h - 12:g}a6 6 0 0 1 -6 6h{12 - w:g}"
        f"a6 6 0 0 1 -6 -6v{12 - h:g}a6 6 0 0 1 6 -6z"
    )


def _render_legend(boxes: Sequence[LaunchBox]) -> str:
    kinds = {box.kind for box in boxes}
    items = [_render_legend_item(kind, name) for kind, name in KIND_NAMES.items() if kind in kinds]
    if any(box.dashed and box.kind in ("node", "launch file", "process") for box in boxes):
        items.append(_render_legend_item("node", "started under a condition", ' stroke-dasharray="5 3"'))
    return f'<figcaption><ul class="legend">{"".join(items)}</ul></figcaption>'


def _render_legend_item(kind: str, name: str, dashes: str = "") -> str:
    outline = _trace_outline(kind, BoxPosition(1, 9), (32, 16))
    return (
        '<li><svg class="graph" width="34" height="18" aria-hidden="true" focusable="false" fill="none" stroke-width="1.5">'
        f'<g class="node {kind.replace(" ", "-")}"><path stroke="currentColor"{dashes} d="{outline}"/></g></svg> {name}</li>'
    )


# -- list --------------------------------------------------------------------------------------------------------------


def _render_list(launch: SceneLaunch, index: int, worst: Mapping[ElementKey, SeverityMark]) -> str:
    written = {port for node in launch.nodes for port in node.writes}
    lines = [
        _render_parameter_item(p, worst.get(_make_parameter_key(index, k))) for k, p in enumerate(launch.parameters)
    ]
    known = {p.port for p in launch.parameters}
    lines += [
        _render_node_item(n, known, written, worst.get(_make_node_key(index, k))) for k, n in enumerate(launch.nodes)
    ]
    return f"<ul>{''.join(lines)}</ul>"


def _render_parameter_item(parameter: SceneParameter, mark: SeverityMark | None) -> str:
    told = [f"from <code>{escape_html(parameter.origin)}</code>"]
    told += [render_prose(parameter.problem)] if parameter.problem else []
    told += map(escape_html, _describe_condition(parameter))
    return f"<li>parameter <code>{escape_html(parameter.port.name)}</code>, {', '.join(told)}{_render_mark_link(mark)}</li>"


def _render_node_item(
    node: SceneNode, set_parameters: set[ScenePort], written: set[ScenePort], mark: SeverityMark | None
) -> str:
    name = (node.name if node.kind == "node" else node.program) or "unknown"
    text = f"{KIND_NAMES[node.kind]} <code>{escape_html(name)}</code>"
    text += f" (<code>{escape_html(node.program)}</code>)" if node.kind == "node" else ""
    text += f": {escape_html(node.purpose or UNKNOWN_PURPOSE)}"
    reads = [p for p in node.reads if p.kind != "service" or p in written]
    ports = _describe_ports(reads, {"service": "offers"}, "reads", set_parameters | written)
    ports += _describe_ports(node.writes, {"service": "calls"}, "publishes", written)
    facts = [f"{escape_html(key)} <code>{escape_html(value)}</code>" for key, value in node.facts]
    parts = [*ports, *map(escape_html, _describe_condition(node)), *facts]
    return f"<li>{'; '.join((text, *parts))}{_render_mark_link(mark)}</li>"


def _describe_ports(
    ports: Iterable[ScenePort], verbs: Mapping[str, str], verb: str, known_ports: set[ScenePort]
) -> list[str]:
    """What is read or written, a sentence for each kind."""
    missing = {"topic": " (which no node that is known here publishes)", "parameter": " (which is not set here)"}
    kinds: dict[str, list[str]] = {}
    for port in ports:
        note = "" if port in known_ports else missing.get(port.kind, "")
        kinds.setdefault(port.kind, []).append(f"<code>{escape_html(port.name)}</code>{note}")
    return [f"{verbs.get(k, verb)} {k if len(n) == 1 else k + 's'} {', '.join(n)}" for k, n in kinds.items()]


def _render_mark_link(mark: SeverityMark | None) -> str:
    if mark is None:
        return ""
    return f' <a class="{mark.severity}" href="#{mark.anchor}">{render_glyph(mark.severity)} {mark.severity}</a>'
