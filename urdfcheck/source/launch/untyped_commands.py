"""Commands whose output a ROS 2 launch file passes to a node as a parameter, without saying that it is a text.

Nothing is executed.
"""

from __future__ import annotations

import ast
import os
import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from urdfcheck.core import Edit, Location
from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.launch_file import Launch, is_description, read_description
from urdfcheck.source.launch.passed_arguments import XacroCallReader
from urdfcheck.source.launch.python_launch_file import PythonLaunchReader
from urdfcheck.source.launch.python_texts import find_call_argument, get_function_name
from urdfcheck.source.text.xml import Attribute, SourceFile

PARAMETER = "robot_description"
_TYPE = "ParameterValue"
_MODULE = "launch_ros.parameter_descriptions"
_IMPORT = f"from {_MODULE} import {_TYPE}"
# How deep a value is followed through names and lists.
_DEEPEST = 4
# Nothing but a comment may follow a statement in its line.
_REST_OF_LINE = re.compile(r"(?P<rest>[ \t]*(?:#[^\r\n]*)?)(?P<newline>\r\n|\n|\r|\Z)")


@dataclass(frozen=True, slots=True, eq=False)
class UntypedCommand:
    """A command, at the place where its output becomes the value of a parameter."""

    at: Location
    uses_xacro: bool
    """Whether it runs xacro; otherwise it shows the file as it is."""
    edits: tuple[Edit, ...]
    """They declare the value to be a text."""


def find_untyped_commands(launch: Launch, model: Path) -> list[UntypedCommand]:
    """Return the commands of a ROS 2 launch file that pass a model as ``robot_description``."""
    real = os.path.realpath(model)
    if launch.python is None:
        return list(_find_in_xml(launch, real))
    file = launch.python.file
    if file is None or launch.python.syntax_problem is not None or not _may_hand_over(file.text):
        return []
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's warnings about a stranger's code do not belong on the terminal
            tree = ast.parse(file.text)
        reader = PythonLaunchReader(tree, file, path=launch.path, finder=launch.finder)
        return list(_UntypedCommandReader(reader, file, tree).read(real))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []


def _may_hand_over(text: str) -> bool:
    return PARAMETER in text and "Command" in text and "parameters" in text


def _find_in_xml(launch: Launch, model: str) -> Iterator[UntypedCommand]:
    """Yield the ``<param>`` of this file, not of those that it includes, whose value is a command."""
    if launch.dialect != "ros2" or launch.root is None or launch.scope is None:
        return
    for element in launch.root.walk():
        value = element.attributes.get("value")
        if not is_description(element) or value is None or element.get("type") == "str":
            continue
        if element.parent is None or element.parent.tag not in {"node", "composable_node"}:
            continue
        description = read_description(element, launch.scope.resolver)
        if description is None or description.path is None or not launch.scope.resolver.is_active(element):
            continue
        if description.words and os.path.realpath(description.path) == model:
            edits = [] if "type" in element.attributes else _declare_type(value, launch)
            yield UntypedCommand(value.location, description.uses_xacro, tuple(edits))


def _declare_type(value: Attribute, launch: Launch) -> list[Edit]:
    """Return the edit that writes ``type="str"`` after a value."""
    file = None if value.span is None else launch.files.get(value.span.file)
    if file is None or value.span is None or file.text[value.span.end : value.span.end + 1] not in {'"', "'"}:
        return []
    after = value.span.end + 1
    return [Edit(file.make_span(after, after), "", ' type="str"')]


class _UntypedCommandReader:
    """Reads the parameters of the nodes of one Python launch file."""

    def __init__(self, reader: PythonLaunchReader, file: SourceFile, tree: ast.Module) -> None:
        self.reader = reader
        self.file = file
        self.tree = tree
        self.commands = XacroCallReader(reader)
        self.texts = reader.at_plain_launch

    def read(self, model: str) -> Iterator[UntypedCommand]:
        """Yield the commands that make the parameter of a model, given by its real path."""
        seen: set[int] = set()
        for value in self.find_values():
            command = None if id(value) in seen else self.find_command(value)
            seen.add(id(value))
            if command is None:
                continue
            program = self.commands.find_program(command, model)
            if program:
                at = self.reader.locate_expression(value)
                yield UntypedCommand(at, "xacro" in program, tuple(self.declare_text(value)))

    def find_values(self) -> Iterator[ast.expr]:
        """Yield the values of the parameter in the dictionaries that nodes get."""
        for node in self.reader.nodes:
            given = find_call_argument(node, -1, "parameters") if isinstance(node, ast.Call) else None
            for element in self.texts.list_elements(given):
                dictionary = self.texts.follow_name(element)
                if not isinstance(dictionary, ast.Dict):
                    continue
                for key, value in zip(dictionary.keys, dictionary.values, strict=True):
                    if isinstance(key, ast.Constant) and key.value == PARAMETER:
                        yield value

    def find_command(self, value: ast.expr, depth: int = 0) -> ast.Call | None:
        """Return the command whose output a value is as a whole, if no type is declared for it."""
        node = self.texts.follow_name(value)
        if depth > _DEEPEST or node is None:
            return None
        if isinstance(node, (ast.List, ast.Tuple)):  # substitutions in a list make one text
            return self.find_command(node.elts[0], depth + 1) if len(node.elts) == 1 else None
        if not isinstance(node, ast.Call):
            return None
        function = get_function_name(node)
        if function == _TYPE and node.args and not any(k.arg in {"value_type", None} for k in node.keywords):
            return self.find_command(node.args[0], depth + 1)
        return (
            node if function == "Command" and node.args and isinstance(node.func, (ast.Name, ast.Attribute)) else None
        )

    def declare_text(self, value: ast.expr) -> list[Edit]:
        """Return the edits that wrap a value in ``ParameterValue(…, value_type=str)`` and import it."""
        span = self.reader.locate_expression(value).span
        if span is None:
            return []
        text = self.file.text[span.start : span.end]
        if isinstance(value, ast.Call) and get_function_name(value) == _TYPE:
            end = self.file.make_span(span.end - 1, span.end - 1)
            has_comma = text[:-1].rstrip().endswith(",")
            return [Edit(end, "", " value_type=str" if has_comma else ", value_type=str")]
        imported = self.import_type()
        if imported is None:
            return []
        # Only what is new is inserted, so that the lines of a long command stay as they are.
        before, after = self.file.make_span(span.start, span.start), self.file.make_span(span.end, span.end)
        return [*imported, Edit(before, "", f"{_TYPE}("), Edit(after, "", ", value_type=str)")]

    def import_type(self) -> list[Edit] | None:
        """Return the edit that imports the class below an import at the top of the file; nothing if it is imported.

        None where each import at the top shares its line with another statement.
        """
        imports = [n for n in self.tree.body if isinstance(n, (ast.Import, ast.ImportFrom))]
        if _imports_type(imports):
            return []
        same = [n for n in imports if isinstance(n, ast.ImportFrom) and (n.module or "").startswith("launch_ros")]
        before = [n for n in same if (n.module or "") < _MODULE]
        span = self.reader.locate_expression((before or same or imports)[-1]).span if imports else None
        rest = None if span is None else _REST_OF_LINE.match(self.file.text, span.end)
        if rest is None:
            return None
        newline = rest["newline"] or "\n"
        return [Edit(self.file.make_span(rest.end("rest"), rest.end("rest")), "", f"{newline}{_IMPORT}")]


def _imports_type(nodes: Sequence[ast.AST]) -> bool:
    return any(
        isinstance(node, ast.ImportFrom) and any(a.name == _TYPE and a.asname in {None, _TYPE} for a in node.names)
        for node in nodes
    )
