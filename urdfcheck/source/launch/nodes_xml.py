"""What an XML launch file starts, as it is typed: nodes with their names, remaps and conditions, and robot_description.

The substitutions are resolved with the defaults of the arguments; what is only known at launch stays as typed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from urdfcheck.core import Span
from urdfcheck.core.scene import SceneParameter, ScenePort
from urdfcheck.source.launch.launch_file import (
    Launch,
    LaunchScope,
    SubstitutionResolver,
    UnresolvedReason,
    get_executable,
    is_description,
    read_description,
    split_command,
)
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.xml import Element

# More than any launch file starts, and more names than any of its nodes is given.
MAX_ACTIONS = 400
MOST_NAMES = 100
# How much of a command or of its arguments is told.
_SHOWN = 240
_NODES = frozenset({"node", "composable_node"})
_PUSHES = frozenset({"push_ros_namespace", "push-ros-namespace"})
_REMAPS = frozenset({"remap", "set_remap"})
_PACKAGE_FILE = re.compile(r"^\$\(find(?:-pkg-share)?\s+([^\s()]+)\)/(?:.*/)?([^/]+)$")
_PARAMETERS = frozenset({"robot_description", "use_sim_time", "use_gui", "source_list", "frame_prefix", "tf_prefix"})
_EXCLUDED = (("if", frozenset({"false", "0"})), ("unless", frozenset({"true", "1"})))


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchAction:
    """A node, process or unread launch file. ``kind`` as in :class:`~urdfcheck.core.SceneNode`; ``words``: its arguments
    with what could be resolved, ``typed`` without; ``remaps``: from and to; ``parameters``: those of its own that matter."""

    kind: str
    package: str
    program: str
    name: str
    namespace: str = "/"
    words: tuple[str, ...] = ()
    typed: str = ""
    remaps: tuple[tuple[str, str], ...] = ()
    parameters: Mapping[str, str] = field(default_factory=dict)
    condition: str = ""
    off: bool = False
    spans: tuple[Span, ...] = ()

    @property
    def full_name(self) -> str:
        return resolve_name(self.name or self.program.rpartition("/")[2], self.namespace)


@dataclass(frozen=True, slots=True)
class LaunchContents:
    """All that a launch file starts and sets. ``notes``: what could not be read, in words."""

    nodes: tuple[LaunchAction, ...]
    parameters: tuple[SceneParameter, ...]
    notes: tuple[str, ...] = ()


def resolve_name(name: str, namespace: str, node: str = "") -> str:
    """The full name of a node, topic, service or parameter; ``~`` stands for the node's own full name."""
    if name.startswith("~"):
        name = f"{node}/{name[1:]}"
    elif not name.startswith("/"):
        name = f"{namespace}/{name}"
    return shorten_line(re.sub("/+", "/", name))


def shorten_line(text: str) -> str:
    """One line of a bounded length: names and arguments are told many times over."""
    line = " ".join(text.split())
    return line if len(line) <= _SHOWN else f"{line[:_SHOWN]}…"


def describe_unresolved(obstacle: UnresolvedReason) -> str:
    """Why a path is not known, in words."""
    return {
        "package": f"package {obstacle.name} is not found",
        "argument": f"argument {obstacle.name} has no value",
        "file": f"{obstacle.name} does not exist",
        "circle": "the arguments refer to each other",
    }.get(obstacle.kind, "only known when it is launched")


def read_launch_actions(launch: Launch) -> LaunchContents:
    """What an XML launch file and those that it includes start."""
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
    """What the elements around one say: namespace, remaps and conditions."""

    resolver: SubstitutionResolver
    namespace: str = "/"
    remaps: tuple[tuple[str, str], ...] = ()
    conditions: tuple[str, ...] = ()
    off: bool = False

    def resolve_text(self, typed: str) -> str:
        known = self.resolver.resolve_text(typed)
        return typed if known is None else known

    def enter_element(self, element: Element) -> _ElementContext:
        """The same, with what the element itself says."""
        conditions, off = self.conditions, self.off
        for name, excluded in _EXCLUDED:
            if name in element.attributes:
                typed = element.get(name)
                conditions = (*conditions, f"{name} {shorten_line(typed)}")
                off = off or (self.resolver.resolve_text(typed) or "").strip().lower() in excluded
        namespace = self.resolve_text(element.get("namespace") or element.get("ns"))
        return replace(self, namespace=resolve_name(namespace, self.namespace), conditions=conditions, off=off)


class _XmlActionReader:
    """Walks the elements in the order of the file: a remap holds for the nodes below it."""

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
            else:  # a group, or what may hold nodes in a dialect to come
                self.read_children(element, inside)

    def read_node(self, element: Element, around: _ElementContext) -> None:
        program = shorten_line(around.resolve_text(get_executable(element) or element.get("plugin")))
        name = around.resolve_text(element.get("name"))
        full = resolve_name(name or program, around.namespace)
        inner = [e for tag in _REMAPS for e in element.find_children(tag)]
        parameters = {}
        for param in element.find_children("param"):
            key = param.get("name")
            own = f"{full} {key}" if self.launch.dialect == "ros2" else resolve_name(f"~{key}", "", full)
            if is_description(param):
                self.read_parameter(param, around.enter_element(param), own)
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

    def add_action(self, kind: str, element: Element, around: _ElementContext, **known: object) -> None:
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
        self.nodes.append(replace(plain, **known))  # type: ignore[arg-type]

    def read_parameter(self, element: Element, around: _ElementContext, name: str) -> None:
        """robot_description and use_sim_time; no other parameter says what the nodes have to do with each other."""
        if not is_description(element):
            if name.endswith("/use_sim_time"):
                self.add_parameter(name, shorten_line(around.resolve_text(element.get("value"))), "", element, around)
            return
        found = read_description(element, around.resolver)
        if found is None:
            self.add_parameter(name, "a text of its own" if element.get("value") else "nothing", "", element, around)
            return
        origin = shorten_line(found.file) if found.path is None else format_path(found.path)
        problem = "" if found.unresolved is None else describe_unresolved(found.unresolved)
        self.add_parameter(name, origin, problem, element, around, found.at.span)

    def add_parameter(
        self, name: str, origin: str, problem: str, element: Element, around: _ElementContext, at: Span | None = None
    ) -> None:
        spans = (*_compute_spans(element), *(() if at is None else (at,)))
        condition = " and ".join(around.conditions)
        self.parameters.append(
            SceneParameter(ScenePort("parameter", name), origin, problem, condition, around.off, spans)
        )


def _split_words(typed: str, around: _ElementContext) -> tuple[str, ...]:
    return tuple(around.resolve_text(word) for word in split_command(typed))


def _read_remap(element: Element, around: _ElementContext) -> tuple[str, str]:
    return shorten_line(around.resolve_text(element.get("from"))), shorten_line(around.resolve_text(element.get("to")))


def _compute_spans(element: Element) -> tuple[Span, ...]:
    """From the element's tag to that of the last one in it."""
    first = element.span
    last = list(element.walk())[-1].span
    if first is None or last is None or first.file != last.file:
        return () if first is None else (first,)
    return (Span(first.file, first.line, first.col, last.end_line, last.end_col, first.start, last.end),)
