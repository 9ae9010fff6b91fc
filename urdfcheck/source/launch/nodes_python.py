"""What a Python launch file starts, as far as literal calls say it. Nothing in it is executed.

Whether a node that is made also gets into the launch description is not known; namespaces and conditions of groups are
not either.
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
from urdfcheck.source.launch.nodes_xml import MOST, MOST_NAMES, Everything, Started, resolved, shown
from urdfcheck.source.launch.python_launch_file import LAUNCH_SUFFIXES, PythonLaunch, Reader, function_of, package_named
from urdfcheck.source.package.finder import display_name
from urdfcheck.source.text.xml import SourceFile

_NODES = frozenset({"Node", "LifecycleNode", "ComposableNode"})
_GROUPS = frozenset({"GroupAction", "PushRosNamespace", "PushROSNamespace", "SetRemap", "OpaqueFunction"})
_PARAMETERS = frozenset({"use_sim_time", "source_list", "frame_prefix"})
# How much of an expression is looked at: lists of lists, their elements, and the parts of an include.
_DEEPEST, _MOST_ELEMENTS, _MOST_PARTS = 2, 20, 500


def started_by_python(launch: Launch) -> Everything:
    """What a Python launch file makes."""
    python = launch.python
    if python is None or python.file is None or python.broken is not None:
        return Everything((), (), ("The file could not be read.",))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(python.file.text)
        calls = _Calls(Reader(tree, python.file, launch.path, launch.finder), python.file, python)
        return calls.read()
    except (RecursionError, MemoryError):
        return Everything((), (), ("The file is nested too deeply.",))


class _Calls:
    def __init__(self, reader: Reader, file: SourceFile, python: PythonLaunch) -> None:
        self.reader = reader
        self.file = file
        self.calls = [n for n in reader.nodes if isinstance(n, ast.Call)]
        models = [display_name(path) for path in python.models]
        self.origin = models[0] if len(models) == 1 else ""
        self.parameters: list[SceneParameter] = []
        self.defaults = {
            name: default
            for call in self.calls
            if function_of(call) == "DeclareLaunchArgument"
            for name in (self.text(_argument(call, 0, "name")),)
            for default in (self.text(_argument(call, 1, "default_value")),)
            if name and default
        }

    def read(self) -> Everything:
        nodes = tuple(itertools.islice(self.nodes(), MOST))
        notes = [f"No more than {MOST} nodes are shown."] if len(nodes) == MOST else []
        if any(function_of(call) in _GROUPS for call in self.calls):
            notes.append("What groups and functions of this file do to its nodes is only known when it is launched.")
        return Everything(nodes, tuple(self.parameters), tuple(notes))

    def nodes(self) -> Iterator[Started]:
        # ast.walk goes by depth; the order of the file is easier to follow.
        for call in sorted(self.calls, key=lambda c: (c.lineno, c.col_offset)):
            function = function_of(call)
            if function in _NODES and (call.keywords or function == "ComposableNode"):
                yield self.node(call)
            elif function == "ExecuteProcess":
                words = self.texts(_argument(call, 0, "cmd"))
                program = words[0] if words else ""
                condition, off = self.condition(call)
                yield Started(
                    "process",
                    "",
                    program,
                    "",
                    words=words[1:],
                    typed=shown(" ".join(words)),
                    condition=condition,
                    off=off,
                    spans=self.spans(call),
                )
            elif function == "IncludeLaunchDescription":
                yield self.include(call)

    def node(self, call: ast.Call) -> Started:
        name = self.text(_argument(call, -1, "name", "node_name"))
        program = self.text(_argument(call, -1, "executable", "node_executable", "plugin"))
        namespace = resolved(self.text(_argument(call, -1, "namespace", "node_namespace")), "/")
        arguments = self.elements(_argument(call, -1, "arguments", "ros_arguments"))
        words = tuple(map(self.text, arguments))
        # Paths that are made of a package's folder are told from here.
        typed = (w if isinstance(a, ast.Constant) else _from_here(w) for a, w in zip(arguments, words, strict=True))
        condition, off = self.condition(call)
        given = self.dictionary(_argument(call, -1, "parameters"))
        plain = Started(
            "node",
            shown(self.text(_argument(call, -1, "package"))),
            shown(program),
            name,
            namespace,
            words,
            shown(" ".join(typed)),
            tuple(itertools.islice(self.remaps(_argument(call, -1, "remappings")), MOST_NAMES)),
            {key: shown(self.text(value)) for key, value in given.items() if key in _PARAMETERS},
            condition,
            off,
            self.spans(call),
        )
        if "robot_description" in given:
            value = given["robot_description"]
            origin = self.origin or shown(self.typed(value))
            problem = "" if self.origin else "only known when it is launched"
            port = ScenePort("parameter", f"{plain.full_name} robot_description")
            self.parameters.append(SceneParameter(port, origin, problem, condition, off, self.spans(value)))
        return plain

    def include(self, call: ast.Call) -> Started:
        condition, off = self.condition(call)
        source = self.followed(_argument(call, 0, "launch_description_source")) or call
        inside = list(itertools.islice(ast.walk(source), _MOST_PARTS))
        names = [n for n in inside if isinstance(n, ast.Name)]
        inside += itertools.islice((n for i in names for n in ast.walk(self.followed(i) or i)), _MOST_PARTS)
        package = next((name for n in inside if (name := package_named(n))), "")
        texts = [n.value for n in inside if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        file = next((text for text in texts if text.endswith(LAUNCH_SUFFIXES)), "")
        return Started(
            "launch file",
            package,
            shown(file.rpartition("/")[2]) or "a launch file",
            "",
            condition=condition,
            off=off,
            spans=self.spans(call),
        )

    def condition(self, call: ast.Call) -> tuple[str, bool]:
        given = self.followed(_argument(call, -1, "condition"))
        if given is None:
            return "", False
        verbs = {"IfCondition": ("if", {"false", "0"}), "UnlessCondition": ("unless", {"true", "1"})}
        verb = verbs.get(function_of(given)) if isinstance(given, ast.Call) else None
        if verb is None or not isinstance(given, ast.Call):
            return f"if {shown(self.typed(given))}", False
        text = self.text(_argument(given, 0, "predicate_expression"))
        name = text.removeprefix("$(var ").removesuffix(")")
        return f"{verb[0]} {shown(text)}", self.defaults.get(name, "").lower() in verb[1]

    def remaps(self, node: ast.expr | None) -> Iterator[tuple[str, str]]:
        for pair in self.elements(node):
            texts = [self.text(part) for part in self.elements(pair)]
            if len(texts) == 2:
                yield shown(texts[0]), shown(texts[1])

    def dictionary(self, node: ast.expr | None) -> Mapping[str, ast.expr]:
        """The parameters that dictionaries in a list name, without those of files."""
        found: dict[str, ast.expr] = {}
        for part in self.elements(node):
            if isinstance(part, ast.Dict):
                found.update(
                    (str(key.value), value)
                    for key, value in zip(part.keys, part.values, strict=True)
                    if isinstance(key, ast.Constant)
                )
        return found

    def elements(self, node: ast.expr | None) -> Sequence[ast.expr]:
        """The elements of a list, where it is one, each as it was assigned."""
        node = self.followed(node)
        parts = node.elts if isinstance(node, (ast.List, ast.Tuple)) else []
        return [self.followed(part) or part for part in parts]

    def followed(self, node: ast.expr | None) -> ast.expr | None:
        """What was assigned to a name, where it was assigned once."""
        for _ in range(8):
            if not isinstance(node, ast.Name) or node.id not in self.reader.assigned:
                break
            node = self.reader.assigned[node.id]
        return node

    def texts(self, node: ast.expr | None) -> tuple[str, ...]:
        return tuple(self.text(part) for part in self.elements(node))

    def text(self, node: ast.expr | None, depth: int = 0) -> str:
        """A text that is known; of an argument ``$(var name)``, as XML spells it; anything else as typed."""
        node = self.followed(node)
        if node is None:
            return ""
        known = self.reader.value(node)
        if known is not None:
            return known
        if isinstance(node, ast.Call) and function_of(node) == "LaunchConfiguration":
            return f"$(var {self.text(_argument(node, 0, 'variable_name'))})"
        if isinstance(node, (ast.List, ast.Tuple)) and depth < _DEEPEST:
            return "".join(self.text(part, depth + 1) for part in node.elts[:_MOST_ELEMENTS])
        return str(node.value) if isinstance(node, ast.Constant) else shown(self.typed(node))

    def typed(self, node: ast.expr) -> str:
        (span,) = self.spans(node)
        return self.file.text[span.start : span.end][:2000]

    def spans(self, node: ast.expr) -> tuple[Span, ...]:
        begin = self.reader.offset(node.lineno, node.col_offset)
        end = self.reader.offset(node.end_lineno or node.lineno, node.end_col_offset or node.col_offset)
        return (self.file.span(begin, end),)


def _from_here(path: str) -> str:
    return display_name(Path(path)) if Path(path).is_absolute() else path


def _argument(call: ast.Call, position: int, *names: str) -> ast.expr | None:
    """An argument by one of its names or, from 0 on, by its position."""
    for keyword in call.keywords:
        if keyword.arg in names:
            return keyword.value
    return call.args[position] if 0 <= position < len(call.args) else None
