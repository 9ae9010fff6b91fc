"""What a Python launch file starts, as far as literal calls show it. Nothing in it is executed.

It is unknown whether a node that is created is added to the launch description, and which namespaces and conditions groups
add.
"""

from __future__ import annotations

import ast
import itertools
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from urdfcheck.core import Span
from urdfcheck.core.scene import SceneParameter, ScenePort
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.nodes_xml import (
    MAX_ACTIONS,
    MOST_NAMES,
    LaunchAction,
    LaunchContents,
    resolve_name,
    shorten_line,
)
from urdfcheck.source.launch.python_launch_file import PythonLaunch, PythonLaunchReader
from urdfcheck.source.launch.python_texts import find_call_argument, get_function_name, get_package_name
from urdfcheck.source.package.file_kinds import LAUNCH_SUFFIXES
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.xml import SourceFile

_NODES = frozenset({"Node", "LifecycleNode", "ComposableNode"})
_GROUPS = frozenset({"GroupAction", "PushRosNamespace", "PushROSNamespace", "SetRemap", "OpaqueFunction"})
_PARAMETERS = frozenset({"use_sim_time", "source_list", "frame_prefix"})
# How much of an expression is read: depth of nested lists, their elements, and the parts of an include.
_DEEPEST, _MOST_ELEMENTS, _MOST_PARTS = 2, 20, 500


def read_python_actions(launch: Launch) -> LaunchContents:
    """Return the actions that a Python launch file creates."""
    python = launch.python
    if python is None or python.file is None or python.syntax_problem is not None:
        return LaunchContents((), (), ("The file could not be read.",))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(python.file.text)
        calls = _PythonActionReader(
            PythonLaunchReader(tree, python.file, path=launch.path, finder=launch.finder), python.file, python
        )
        return calls.read()
    except (RecursionError, MemoryError):
        return LaunchContents((), (), ("The file is nested too deeply.",))


class _PythonActionReader:
    """Reads the calls of one file."""

    def __init__(self, reader: PythonLaunchReader, file: SourceFile, python: PythonLaunch) -> None:
        self.reader = reader
        self.file = file
        self.calls = [n for n in reader.nodes if isinstance(n, ast.Call)]
        models = [format_path(path) for path in python.models]
        self.origin = models[0] if len(models) == 1 else ""
        self.parameters: list[SceneParameter] = []
        self.defaults = {
            name: default
            for call in self.calls
            if get_function_name(call) == "DeclareLaunchArgument"
            for name in (self.read_expression(find_call_argument(call, 0, "name")),)
            for default in (self.read_expression(find_call_argument(call, 1, "default_value")),)
            if name and default
        }

    def read(self) -> LaunchContents:
        nodes = tuple(itertools.islice(self.find_actions(), MAX_ACTIONS))
        notes = [f"No more than {MAX_ACTIONS} nodes are shown."] if len(nodes) == MAX_ACTIONS else []
        if any(get_function_name(call) in _GROUPS for call in self.calls):
            notes.append("What groups and functions of this file do to its nodes is only known when it is launched.")
        return LaunchContents(nodes, tuple(self.parameters), tuple(notes))

    def find_actions(self) -> Iterator[LaunchAction]:
        # In the order of the file, because ast.walk goes by depth.
        for call in sorted(self.calls, key=lambda c: (c.lineno, c.col_offset)):
            function = get_function_name(call)
            if function in _NODES and (call.keywords or function == "ComposableNode"):
                yield self.read_node(call)
            elif function == "ExecuteProcess":
                words = self.read_expressions(find_call_argument(call, 0, "cmd"))
                program = words[0] if words else ""
                condition, off = self.read_condition(call)
                yield LaunchAction(
                    kind="process",
                    package="",
                    program=program,
                    name="",
                    words=words[1:],
                    typed=shorten_line(" ".join(words)),
                    condition=condition,
                    off=off,
                    spans=self.compute_spans(call),
                )
            elif function == "IncludeLaunchDescription":
                yield self.read_include(call)

    def read_node(self, call: ast.Call) -> LaunchAction:
        name = self.read_expression(find_call_argument(call, -1, "name", "node_name"))
        program = self.read_expression(find_call_argument(call, -1, "executable", "node_executable", "plugin"))
        namespace = resolve_name(self.read_expression(find_call_argument(call, -1, "namespace", "node_namespace")), "/")
        arguments = self.list_elements(find_call_argument(call, -1, "arguments", "ros_arguments"))
        words = tuple(map(self.read_expression, arguments))
        # Paths in a package's folder are displayed relative to the working directory.
        typed = (
            w if isinstance(a, ast.Constant) else _format_absolute_path(w)
            for a, w in zip(arguments, words, strict=True)
        )
        condition, off = self.read_condition(call)
        parameters = self.read_parameters(find_call_argument(call, -1, "parameters"))
        node = LaunchAction(
            kind="node",
            package=shorten_line(self.read_expression(find_call_argument(call, -1, "package"))),
            program=shorten_line(program),
            name=name,
            namespace=namespace,
            words=words,
            typed=shorten_line(" ".join(typed)),
            remaps=tuple(itertools.islice(self.read_remaps(find_call_argument(call, -1, "remappings")), MOST_NAMES)),
            parameters={
                key: shorten_line(self.read_expression(value))
                for key, value in parameters.items()
                if key in _PARAMETERS
            },
            condition=condition,
            off=off,
            spans=self.compute_spans(call),
        )
        if "robot_description" in parameters:
            value = parameters["robot_description"]
            origin = self.origin or shorten_line(self.get_source_text(value))
            problem = "" if self.origin else "only known when it is launched"
            port = ScenePort("parameter", f"{node.full_name} robot_description")
            self.parameters.append(
                SceneParameter(
                    port=port,
                    origin=origin,
                    problem=problem,
                    condition=condition,
                    off=off,
                    spans=self.compute_spans(value),
                )
            )
        return node

    def read_include(self, call: ast.Call) -> LaunchAction:
        condition, off = self.read_condition(call)
        source = self.reader.texts.follow_name(find_call_argument(call, 0, "launch_description_source")) or call
        inside = list(itertools.islice(ast.walk(source), _MOST_PARTS))
        names = [n for n in inside if isinstance(n, ast.Name)]
        inside += itertools.islice(
            (n for i in names for n in ast.walk(self.reader.texts.follow_name(i) or i)), _MOST_PARTS
        )
        package = next((name for n in inside if (name := get_package_name(n))), "")
        texts = [n.value for n in inside if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        file = next((text for text in texts if text.endswith(LAUNCH_SUFFIXES)), "")
        return LaunchAction(
            kind="launch file",
            package=package,
            program=shorten_line(file.rpartition("/")[2]) or "a launch file",
            name="",
            condition=condition,
            off=off,
            spans=self.compute_spans(call),
        )

    def read_condition(self, call: ast.Call) -> tuple[str, bool]:
        given = self.reader.texts.follow_name(find_call_argument(call, -1, "condition"))
        if given is None:
            return "", False
        verbs = {"IfCondition": ("if", {"false", "0"}), "UnlessCondition": ("unless", {"true", "1"})}
        verb = verbs.get(get_function_name(given)) if isinstance(given, ast.Call) else None
        if verb is None or not isinstance(given, ast.Call):
            return f"if {shorten_line(self.get_source_text(given))}", False
        text = self.read_expression(find_call_argument(given, 0, "predicate_expression"))
        name = text.removeprefix("$(var ").removesuffix(")")
        return f"{verb[0]} {shorten_line(text)}", self.defaults.get(name, "").lower() in verb[1]

    def read_remaps(self, node: ast.expr | None) -> Iterator[tuple[str, str]]:
        for pair in self.list_elements(node):
            texts = [self.read_expression(part) for part in self.list_elements(pair)]
            if len(texts) == 2:
                yield shorten_line(texts[0]), shorten_line(texts[1])

    def read_parameters(self, node: ast.expr | None) -> Mapping[str, ast.expr]:
        """Return the parameters in the dictionaries of a list; those of files are unknown."""
        parameters: dict[str, ast.expr] = {}
        for part in self.list_elements(node):
            if isinstance(part, ast.Dict):
                parameters.update(
                    (str(key.value), value)
                    for key, value in zip(part.keys, part.values, strict=True)
                    if isinstance(key, ast.Constant)
                )
        return parameters

    def list_elements(self, node: ast.expr | None) -> Sequence[ast.expr]:
        """Return the elements of a list, with the values of names; none if it is not a list."""
        node = self.reader.texts.follow_name(node)
        parts = node.elts if isinstance(node, (ast.List, ast.Tuple)) else []
        return [self.reader.texts.follow_name(part) or part for part in parts]

    def read_expressions(self, node: ast.expr | None) -> tuple[str, ...]:
        return tuple(self.read_expression(part) for part in self.list_elements(node))

    def read_expression(self, node: ast.expr | None, depth: int = 0) -> str:
        """Return the known text of an expression; ``$(var name)`` for an argument, as in XML; anything else as typed."""
        node = self.reader.texts.follow_name(node)
        if node is None:
            return ""
        text = self.reader.evaluate_text(node)
        if text is not None:
            return text
        if isinstance(node, ast.Call) and get_function_name(node) == "LaunchConfiguration":
            return f"$(var {self.read_expression(find_call_argument(node, 0, 'variable_name'))})"
        if isinstance(node, (ast.List, ast.Tuple)) and depth < _DEEPEST:
            return "".join(self.read_expression(part, depth + 1) for part in node.elts[:_MOST_ELEMENTS])
        return str(node.value) if isinstance(node, ast.Constant) else shorten_line(self.get_source_text(node))

    def get_source_text(self, node: ast.expr) -> str:
        (span,) = self.compute_spans(node)
        return self.file.text[span.start : span.end][:2000]

    def compute_spans(self, node: ast.expr) -> tuple[Span, ...]:
        begin = self.reader.compute_offset(node.lineno, node.col_offset)
        end = self.reader.compute_offset(node.end_lineno or node.lineno, node.end_col_offset or node.col_offset)
        return (self.file.make_span(begin, end),)


def _format_absolute_path(path: str) -> str:
    return format_path(Path(path)) if Path(path).is_absolute() else path
