"""The nodes of a launch file and what they read and write, as boxes and edges."""

from __future__ import annotations

from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import SceneLaunch, SceneNode, SceneParameter, ScenePort
from urdfcheck.output.html.svg.label_text import ADVANCE, SMALL, count_columns, shorten_name
from urdfcheck.output.shared.anchors import ElementKey
from urdfcheck.output.shared.wording import get_base_name

# Height of a box with one line and with two, in px.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchBox:
    """A drawn box."""

    kind: str
    """One of `KIND_NAMES`."""
    lines: tuple[str, ...]
    """Its name, and an optional second line."""
    tooltip: str
    element_key: ElementKey | None = None
    """Key of its findings; None for a port, which has none."""
    dashed: bool = False
    """Whether it exists only under a condition, or its origin is unknown."""
    off_by_default: bool = False

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in px."""
        widths = [count_columns(line) * (ADVANCE if i == 0 else SMALL) for i, line in enumerate(self.lines)]
        ends = 26 if self.kind in ("service", "topic") else 20
        return round(max(widths) + 2 * ends, 1), HIGH_BOX if len(self.lines) > 1 else LOW_BOX


def make_node_key(launch: int, index: int) -> ElementKey:
    """Return the key of a node by the indices of its launch file and of the node."""
    return ("started", str(launch), str(index))


def make_parameter_key(launch: int, index: int) -> ElementKey:
    """Return the key of a parameter by the indices of its launch file and of the parameter."""
    return ("parameter", str(launch), str(index))


def build_launch_graph(launch: SceneLaunch, index: int) -> tuple[list[LaunchBox], list[tuple[int, int, bool]]]:
    """Build the boxes, and the edges between them: indices of two boxes, and whether the edge is dashed."""
    boxes = [_make_node_box(node, make_node_key(index, k)) for k, node in enumerate(launch.nodes)]
    at: dict[ScenePort, int] = {}
    for k, parameter in enumerate(launch.parameters):
        if parameter.port not in at and any(parameter.port in node.reads for node in launch.nodes):
            at[parameter.port] = len(boxes)
            boxes.append(_make_parameter_box(parameter, make_parameter_key(index, k)))
    written = {port for node in launch.nodes for port in node.writes}
    for port in dict.fromkeys(p for node in launch.nodes for p in (*node.reads, *node.writes)):
        # Nodes offer many services; only those that another node calls are drawn.
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
    title = f"{KIND_NAMES[node.kind]} {node.name or program}"
    return LaunchBox(
        kind=node.kind,
        lines=tuple(map(shorten_name, lines)),
        tooltip=". ".join((title, node.purpose or UNKNOWN_PURPOSE, *describe_start_condition(node))),
        element_key=element,
        dashed=bool(node.condition),
        off_by_default=node.off,
    )


def describe_start_condition(node_or_parameter: SceneNode | SceneParameter) -> tuple[str, ...]:
    """Describe when a launch file starts a node or sets a parameter; empty if always."""
    if not node_or_parameter.condition:
        return ()
    return (f"started {node_or_parameter.condition}" + (", and not by default" if node_or_parameter.off else ""),)


def _make_parameter_box(parameter: SceneParameter, element: ElementKey) -> LaunchBox:
    origin = "origin unresolved" if parameter.problem else get_base_name(parameter.origin)
    title = f"parameter {parameter.port.name}, from {parameter.origin}"
    problem = [parameter.problem] if parameter.problem else []
    return LaunchBox(
        kind="parameter",
        lines=(shorten_name(_get_parameter_name(parameter.port)), shorten_name(origin)),
        tooltip=". ".join((title, *problem, *describe_start_condition(parameter))),
        element_key=element,
        dashed=bool(parameter.condition or parameter.problem),
        off_by_default=parameter.off,
    )


def _get_parameter_name(port: ScenePort) -> str:
    """Return the name of a parameter without its ROS 2 node, which is beside it in the drawing."""
    return port.name.rpartition(" ")[2]


def _make_port_box(port: ScenePort, is_written: bool) -> LaunchBox:
    if port.kind == "file":
        return LaunchBox(kind="file", lines=(shorten_name(get_base_name(port.name)),), tooltip=f"file {port.name}")
    name = shorten_name(port.name.removesuffix(" (Gazebo transport)"))
    if port.kind == "parameter":
        tooltip = f"parameter {port.name}, not set by this launch file"
        return LaunchBox(kind="parameter", lines=(name, "not set here"), tooltip=tooltip, dashed=True)
    if port.kind == "topic" and not is_written:
        tooltip = f"topic {port.name}: no node that is known here publishes it"
        return LaunchBox(kind="topic", lines=(name, "no known publisher"), tooltip=tooltip, dashed=True)
    return LaunchBox(kind=port.kind, lines=(name,), tooltip=f"{port.kind} {port.name}")
