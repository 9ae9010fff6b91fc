"""What an XML launch file starts: nodes with their names, remaps and conditions, and robot_description.

Substitutions are resolved with the defaults of the arguments; those that are only known at launch stay as typed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field, replace

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import SceneParameter, ScenePort
from urdfcheck.source.launch.launch_file import Launch, LaunchScope, is_description, read_description
from urdfcheck.source.launch.static_transforms import get_executable
from urdfcheck.source.launch.substitutions import SubstitutionResolver, UnresolvedReason, split_command
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.xml import Element

# Limits on actions of a launch file, and on names of one of its nodes: above those of any real file.
MAX_ACTIONS = 400
MOST_NAMES = 100
# How much of a command or of its arguments is shown.
_SHOWN = 240
_NODES = frozenset({"node", "composable_node"})
_PUSHES = frozenset({"push_ros_namespace", "push-ros-namespace"})
_REMAPS = frozenset({"remap", "set_remap"})
_PACKAGE_FILE = re.compile(r"^\$\(find(?:-pkg-share)?\s+([^\s()]+)\)/(?:.*/)?([^/]+)$")
_PARAMETERS = frozenset({"robot_description", "use_sim_time", "use_gui", "source_list", "frame_prefix", "tf_prefix"})
_EXCLUDED = (("if", frozenset({"false", "0"})), ("unless", frozenset({"true", "1"})))


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchAction:
    """A node, process or unread launch file."""

    kind: str
    """As in :class:`~urdfcheck.core.SceneNode`."""
    package: str
    program: str
    name: str
    namespace: str = "/"
    words: tuple[str, ...] = ()
    """Its arguments with substitutions resolved as far as possible."""
    typed: str = ""
    """Its arguments as typed."""
    remaps: tuple[tuple[str, str], ...] = ()
    """From and to."""
    parameters: Mapping[str, str] = field(default_factory=dict)
    """Its own parameters that affect the data flow."""
    condition: str = ""
    off: bool = False
    spans: tuple[Span, ...] = ()

    @property
    def full_name(self) -> str:
        return resolve_name(self.name or self.program.rpartition("/")[2], self.namespace)


@dataclass(frozen=True, slots=True)
class LaunchContents:
    """Everything that a launch file starts and sets. ``notes``: sentences about the parts that could not be read."""

    nodes: tuple[LaunchAction, ...]
    parameters: tuple[SceneParameter, ...]
    notes: tuple[str, ...] = ()


def resolve_name(name: str, namespace: str, node: str = "") -> str:
    """Return the full name of a node, topic, service or parameter; ``~`` means the node's own full name."""
    if name.startswith("~"):
        name = f"{node}/{name[1:]}"
    elif not name.startswith("/"):
        name = f"{namespace}/{name}"
    return shorten_line(re.sub("/+", "/", name))


def shorten_line(text: str) -> str:
    """Return one line of bounded length: names and arguments are shown many times."""
    line = " ".join(text.split())
    return line if len(line) <= _SHOWN else f"{line[:_SHOWN]}…"


def describe_unresolved(obstacle: UnresolvedReason) -> str:
    """Describe why a path is unknown."""
    return {
        "package": f"package {obstacle.name} is not found",
        "argument": f"argument {obstacle.name} has no value",
        "empty": f"argument {obstacle.name} is empty",
        "file": f"{obstacle.name} does not exist",
        "relative": f"{obstacle.name} depends on the current folder",
        "circle": "the arguments refer to each other",
    }.get(obstacle.kind, "only known when it is launched")


def read_launch_actions(launch: Launch) -> LaunchContents:
    """Return what an XML launch file and those that it includes start."""
    if launch.scope is None:
        return LaunchContents((), (), ("The file could not be read.",))
    reader = _XmlActionReader(launch)
    notes = []
    try:
        reader.read_children(launch.scope.root, _ElementContext(resolver=launch.scope.resolver))
    except RecursionError:
        notes.append("The files are nested too deeply: not all of it is shown.")
    if len(reader.nodes) > MAX_ACTIONS:
        notes.append(f"No more than {MAX_ACTIONS} nodes are shown.")
    return LaunchContents(tuple(reader.nodes[:MAX_ACTIONS]), tuple(reader.parameters[:MAX_ACTIONS]), tuple(notes))


@dataclass(frozen=True, slots=True, kw_only=True)
class _ElementContext:
    """What an element inherits from the elements around it."""

    resolver: SubstitutionResolver
    namespace: str = "/"
    remaps: tuple[tuple[str, str], ...] = ()
    conditions: tuple[str, ...] = ()
    """``if …`` and ``unless …`` as typed."""
    off: bool = False
    """Whether a condition is known to exclude it."""

    def resolve_text(self, typed: str) -> str:
        resolved = self.resolver.resolve_text(typed)
        return typed if resolved is None else resolved

    def enter_element(self, element: Element) -> _ElementContext:
        """Return the context inside an element."""
        conditions, off = self.conditions, self.off
        for name, excluded in _EXCLUDED:
            if name in element.attributes:
                typed = element.get(name)
                conditions = (*conditions, f"{name} {shorten_line(typed)}")
                off = off or (self.resolver.resolve_condition(typed) or "").strip().lower() in excluded
        namespace = self.resolve_text(element.get("namespace") or element.get("ns"))
        return replace(self, namespace=resolve_name(namespace, self.namespace), conditions=conditions, off=off)


class _XmlActionReader:
    """Walks the elements in the order of the file: a remap applies to the nodes after it."""

    def __init__(self, launch: Launch) -> None:
        self.launch = launch
        self.nodes: list[LaunchAction] = []
        self.parameters: list[SceneParameter] = []

    def read_children(self, parent: Element, around: _ElementContext) -> None:
        for element in parent.children:
            inside = around.enter_element(element)
            if element.tag in _PUSHES:
                around = replace(around, namespace=inside.namespace)
            elif element.tag in _REMAPS:
                around = replace(around, remaps=(*around.remaps, _read_remap(element, around))[-MOST_NAMES:])
            elif element.tag in _NODES:
                self.read_node(element, inside)
            elif element.tag == "executable":
                typed = element.get("cmd")
                words = _split_words(typed, inside)
                program = words[0] if words else ""
                self.add_action("process", element, inside, program=program, words=words[1:], typed=shorten_line(typed))
            elif element.tag == "include":
                self.read_include(element, inside)
            elif element.tag == "param":
                self.read_parameter(
                    element, inside, resolve_name(around.resolve_text(element.get("name")), inside.namespace)
                )
            else:  # a group, or an element that may contain nodes in a future dialect
                self.read_children(element, inside)

    def read_node(self, element: Element, around: _ElementContext) -> None:
        program = shorten_line(around.resolve_text(get_executable(element) or element.get("plugin")))
        name = around.resolve_text(element.get("name"))
        full = resolve_name(name or program, around.namespace)
        inner = [e for tag in _REMAPS for e in element.find_children(tag)]
        parameters = {}
        for param in element.find_children("param"):
            key = param.get("name")
            full_key = f"{full} {key}" if self.launch.dialect == "ros2" else resolve_name(f"~{key}", "", full)
            if is_description(param):
                self.read_parameter(param, around.enter_element(param), full_key)
            elif key in _PARAMETERS:
                parameters[key] = shorten_line(around.resolve_text(param.get("value")))
        typed = element.get("args")
        self.add_action(
            "node",
            element,
            around,
            package=shorten_line(around.resolve_text(element.get("pkg"))),
            program=program,
            name=name,
            words=_split_words(typed, around),
            typed=shorten_line(typed),
            remaps=(*around.remaps, *(_read_remap(e, around) for e in inner))[-MOST_NAMES:],
            parameters=parameters,
        )

    def read_include(self, element: Element, around: _ElementContext) -> None:
        scope: LaunchScope | None = self.launch.scopes.get(element)
        if scope is not None:
            self.read_children(scope.root, replace(around, resolver=scope.resolver))
            return
        typed = element.get("file")
        match = _PACKAGE_FILE.match(typed.strip())
        package, file = match.groups() if match else ("", shorten_line(typed))
        parameters = {
            a.get("name"): shorten_line(around.resolve_text(a.get("value")))
            for a in element.find_children("arg")
            if a.get("name") in _PARAMETERS
        }
        self.add_action("launch file", element, around, package=package, program=file, parameters=parameters)

    def add_action(self, kind: str, element: Element, around: _ElementContext, **details: object) -> None:
        """Add an action with the namespace and conditions around it."""
        plain = LaunchAction(
            kind=kind,
            package="",
            program="",
            name="",
            namespace=around.namespace,
            condition=" and ".join(around.conditions),
            off=around.off,
            spans=_compute_spans(element),
        )
        self.nodes.append(replace(plain, **details))  # type: ignore[arg-type]

    def read_parameter(self, element: Element, around: _ElementContext, name: str) -> None:
        """Read robot_description and use_sim_time; no other parameter affects the data flow between nodes."""
        if not is_description(element):
            if name.endswith("/use_sim_time"):
                origin = shorten_line(around.resolve_text(element.get("value")))
                self.add_parameter(name, element, around, origin=origin)
            return
        description = read_description(element, around.resolver)
        if description is None:
            origin = "its own text" if element.get("value") else "nothing"
            self.add_parameter(name, element, around, origin=origin)
            return
        origin = shorten_line(description.file) if description.path is None else format_path(description.path)
        problem = "" if description.unresolved is None else describe_unresolved(description.unresolved)
        self.add_parameter(name, element, around, origin=origin, problem=problem, at=description.at.span)

    def add_parameter(
        self,
        name: str,
        element: Element,
        around: _ElementContext,
        *,
        origin: str,
        problem: str = "",
        at: Span | None = None,
    ) -> None:
        """Add a parameter. ``at``: the attribute with its value, if that is elsewhere."""
        spans = (*_compute_spans(element), *(() if at is None else (at,)))
        self.parameters.append(
            SceneParameter(
                port=ScenePort("parameter", name),
                origin=origin,
                problem=problem,
                condition=" and ".join(around.conditions),
                off=around.off,
                spans=spans,
            )
        )


def _split_words(typed: str, around: _ElementContext) -> tuple[str, ...]:
    return tuple(around.resolve_text(word) for word in split_command(typed))


def _read_remap(element: Element, around: _ElementContext) -> tuple[str, str]:
    return shorten_line(around.resolve_text(element.get("from"))), shorten_line(around.resolve_text(element.get("to")))


def _compute_spans(element: Element) -> tuple[Span, ...]:
    """Return the span from the element's tag to that of the last element in it."""
    first = element.span
    last = list(element.walk())[-1].span
    if first is None or last is None or first.file != last.file:
        return () if first is None else (first,)
    return (replace(first, end_line=last.end_line, end_col=last.end_col, end=last.end),)
