"""The nodes of a launch file and what they read and write, as boxes and edges."""

from __future__ import annotations

from dataclasses import dataclass

from urdfcheck.core.scene import SceneLaunch, SceneNode, SceneParameter, ScenePort
from urdfcheck.output.html.svg.label_text import ADVANCE, SMALL, count_columns, shorten_name
from urdfcheck.output.shared.anchors import ElementKey
from urdfcheck.output.shared.wording import get_base_name

# A box with one line and with two.
LOW_BOX, HIGH_BOX = 30.0, 44.0
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


def make_node_key(launch: int, index: int) -> ElementKey:
    return ("started", str(launch), str(index))


def make_parameter_key(launch: int, index: int) -> ElementKey:
    return ("parameter", str(launch), str(index))


def build_launch_graph(launch: SceneLaunch, index: int) -> tuple[list[LaunchBox], list[tuple[int, int, bool]]]:
    """The boxes, and the edges between them with whether each is dashed."""
    boxes = [_make_node_box(node, make_node_key(index, k)) for k, node in enumerate(launch.nodes)]
    at: dict[ScenePort, int] = {}
    for k, parameter in enumerate(launch.parameters):
        if parameter.port not in at and any(parameter.port in node.reads for node in launch.nodes):
            at[parameter.port] = len(boxes)
            boxes.append(_make_parameter_box(parameter, make_parameter_key(index, k)))
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
        (
            f"{KIND_NAMES[node.kind]} {node.name or program}",
            node.purpose or UNKNOWN_PURPOSE,
            *describe_start_condition(node),
        )
    )
    return LaunchBox(node.kind, tuple(map(shorten_name, lines)), told, element, bool(node.condition), node.off)


def describe_start_condition(node_or_parameter: SceneNode | SceneParameter) -> tuple[str, ...]:
    if not node_or_parameter.condition:
        return ()
    return (f"started {node_or_parameter.condition}" + (", and not by default" if node_or_parameter.off else ""),)


def _make_parameter_box(parameter: SceneParameter, element: ElementKey) -> LaunchBox:
    origin = "origin unresolved" if parameter.problem else get_base_name(parameter.origin)
    told = f"parameter {parameter.port.name}, from {parameter.origin}"
    told = ". ".join((told, *([parameter.problem] if parameter.problem else []), *describe_start_condition(parameter)))
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
