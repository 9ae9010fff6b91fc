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
    Obstacle,
    Resolver,
    Scope,
    description_of,
    executable,
    is_description,
    shell_words,
)
from urdfcheck.source.package.finder import display_name
from urdfcheck.source.text.xml import Element

# More than any launch file starts, and more names than any of its nodes is given.
MOST = 400
MOST_NAMES = 100
# How much of a command or of its arguments is told.
_SHOWN = 240
_NODES = frozenset({"node", "composable_node"})
_PUSHES = frozenset({"push_ros_namespace", "push-ros-namespace"})
_REMAPS = frozenset({"remap", "set_remap"})
_PACKAGE_FILE = re.compile(r"^\$\(find(?:-pkg-share)?\s+([^\s()]+)\)/(?:.*/)?([^/]+)$")
_PARAMETERS = frozenset({"robot_description", "use_sim_time", "use_gui", "source_list", "frame_prefix", "tf_prefix"})
_EXCLUDED = (("if", frozenset({"false", "0"})), ("unless", frozenset({"true", "1"})))


@dataclass(frozen=True, slots=True)
class Started:
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
        return resolved(self.name or self.program.rpartition("/")[2], self.namespace)


@dataclass(frozen=True, slots=True)
class Everything:
    """All that a launch file starts and sets. ``notes``: what could not be read, in words."""

    nodes: tuple[Started, ...]
    parameters: tuple[SceneParameter, ...]
    notes: tuple[str, ...] = ()


def resolved(name: str, namespace: str, node: str = "") -> str:
    """The full name of a node, topic, service or parameter; ``~`` stands for the node's own full name."""
    if name.startswith("~"):
        name = f"{node}/{name[1:]}"
    elif not name.startswith("/"):
        name = f"{namespace}/{name}"
    return shown(re.sub("/+", "/", name))


def shown(text: str) -> str:
    """One line of a bounded length: names and arguments are told many times over."""
    line = " ".join(text.split())
    return line if len(line) <= _SHOWN else f"{line[:_SHOWN]}…"


def told(obstacle: Obstacle) -> str:
    """Why a path is not known, in words."""
    return {
        "package": f"package {obstacle.name} is not found",
        "argument": f"argument {obstacle.name} has no value",
        "file": f"{obstacle.name} does not exist",
        "circle": "the arguments refer to each other",
    }.get(obstacle.kind, "only known when it is launched")


def started(launch: Launch) -> Everything:
    """What an XML launch file and those that it includes start."""
    if launch.scope is None:
        return Everything((), (), ("The file could not be read.",))
    reader = _Reader(launch)
    notes = []
    try:
        reader.children(launch.scope.root, _Around(launch.scope.resolver))
    except RecursionError:
        notes.append("The files are nested too deeply: not all of it is shown.")
    if len(reader.nodes) > MOST:
        notes.append(f"No more than {MOST} nodes are shown.")
    return Everything(tuple(reader.nodes[:MOST]), tuple(reader.parameters[:MOST]), tuple(notes))


@dataclass(frozen=True, slots=True)
class _Around:
    """What the elements around one say: namespace, remaps and conditions."""

    resolver: Resolver
    namespace: str = "/"
    remaps: tuple[tuple[str, str], ...] = ()
    conditions: tuple[str, ...] = ()
    off: bool = False

    def text(self, typed: str) -> str:
        known = self.resolver.resolve(typed)
        return typed if known is None else known

    def within(self, element: Element) -> _Around:
        """The same, with what the element itself says."""
        conditions, off = self.conditions, self.off
        for name, excluded in _EXCLUDED:
            if name in element.attributes:
                typed = element.get(name)
                conditions = (*conditions, f"{name} {shown(typed)}")
                off = off or (self.resolver.resolve(typed) or "").strip().lower() in excluded
        namespace = self.text(element.get("namespace") or element.get("ns"))
        return replace(self, namespace=resolved(namespace, self.namespace), conditions=conditions, off=off)


class _Reader:
    """Walks the elements in the order of the file: a remap holds for the nodes below it."""

    def __init__(self, launch: Launch) -> None:
        self.launch = launch
        self.nodes: list[Started] = []
        self.parameters: list[SceneParameter] = []

    def children(self, parent: Element, around: _Around) -> None:
        for element in parent.children:
            inside = around.within(element)
            if element.tag in _PUSHES:
                around = replace(around, namespace=inside.namespace)
            elif element.tag in _REMAPS:
                around = replace(around, remaps=(*around.remaps, _remap(element, around))[-MOST_NAMES:])
            elif element.tag in _NODES:
                self.node(element, inside)
            elif element.tag == "executable":
                typed = element.get("cmd")
                words = _words(typed, inside)
                program = words[0] if words else ""
                self.start("process", element, inside, program=program, words=words[1:], typed=shown(typed))
            elif element.tag == "include":
                self.include(element, inside)
            elif element.tag == "param":
                self.parameter(element, inside, resolved(around.text(element.get("name")), inside.namespace))
            else:  # a group, or what may hold nodes in a dialect to come
                self.children(element, inside)

    def node(self, element: Element, around: _Around) -> None:
        program = shown(around.text(executable(element) or element.get("plugin")))
        name = around.text(element.get("name"))
        full = resolved(name or program, around.namespace)
        inner = [e for tag in _REMAPS for e in element.all(tag)]
        parameters = {}
        for param in element.all("param"):
            key = param.get("name")
            own = f"{full} {key}" if self.launch.dialect == "ros2" else resolved(f"~{key}", "", full)
            if is_description(param):
                self.parameter(param, around.within(param), own)
            elif key in _PARAMETERS:
                parameters[key] = shown(around.text(param.get("value")))
        typed = element.get("args")
        self.start(
            "node",
            element,
            around,
            package=shown(around.text(element.get("pkg"))),
            program=program,
            name=name,
            words=_words(typed, around),
            typed=shown(typed),
            remaps=(*around.remaps, *(_remap(e, around) for e in inner))[-MOST_NAMES:],
            parameters=parameters,
        )

    def include(self, element: Element, around: _Around) -> None:
        scope: Scope | None = self.launch.scopes.get(element)
        if scope is not None:
            self.children(scope.root, replace(around, resolver=scope.resolver))
            return
        typed = element.get("file")
        match = _PACKAGE_FILE.match(typed.strip())
        package, file = match.groups() if match else ("", shown(typed))
        parameters = {
            a.get("name"): shown(around.text(a.get("value")))
            for a in element.all("arg")
            if a.get("name") in _PARAMETERS
        }
        self.start("launch file", element, around, package=package, program=file, parameters=parameters)

    def start(self, kind: str, element: Element, around: _Around, **known: object) -> None:
        plain = Started(
            kind,
            "",
            "",
            "",
            around.namespace,
            condition=" and ".join(around.conditions),
            off=around.off,
            spans=_spans(element),
        )
        self.nodes.append(replace(plain, **known))  # type: ignore[arg-type]

    def parameter(self, element: Element, around: _Around, name: str) -> None:
        """robot_description and use_sim_time; no other parameter says what the nodes have to do with each other."""
        if not is_description(element):
            if name.endswith("/use_sim_time"):
                self.set(name, shown(around.text(element.get("value"))), "", element, around)
            return
        found = description_of(element, around.resolver)
        if found is None:
            self.set(name, "a text of its own" if element.get("value") else "nothing", "", element, around)
            return
        origin = shown(found.file) if found.path is None else display_name(found.path)
        problem = "" if found.unresolved is None else told(found.unresolved)
        self.set(name, origin, problem, element, around, found.at.span)

    def set(
        self, name: str, origin: str, problem: str, element: Element, around: _Around, at: Span | None = None
    ) -> None:
        spans = (*_spans(element), *(() if at is None else (at,)))
        condition = " and ".join(around.conditions)
        self.parameters.append(
            SceneParameter(ScenePort("parameter", name), origin, problem, condition, around.off, spans)
        )


def _words(typed: str, around: _Around) -> tuple[str, ...]:
    return tuple(around.text(word) for word in shell_words(typed))


def _remap(element: Element, around: _Around) -> tuple[str, str]:
    return shown(around.text(element.get("from"))), shown(around.text(element.get("to")))


def _spans(element: Element) -> tuple[Span, ...]:
    """From the element's tag to that of the last one in it."""
    first = element.span
    last = list(element.walk())[-1].span
    if first is None or last is None or first.file != last.file:
        return () if first is None else (first,)
    return (Span(first.file, first.line, first.col, last.end_line, last.end_col, first.start, last.end),)
