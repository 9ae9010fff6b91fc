"""The texts that expressions of a Python launch file stand for. Nothing in it is executed."""

from __future__ import annotations

import ast
import os
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import PackageFinder

# A longer text is not a path: it comes from names that multiply each other.
MAX_LENGTH = 4000
# One text of Python, in which nothing is escaped.
_QUOTED = re.compile(r"(['\"])([^'\"\\\n]*)\1")


@dataclass(frozen=True, slots=True, eq=False)
class DeclaredArgument:
    """An argument that a launch file declares, with its literal default (None without one) and the values that it may have."""

    default: str | None
    choices: tuple[str, ...]
    place: ast.expr
    """Where the default is typed, else the choices, else the declaration."""

    @property
    def value(self) -> str | None:
        """The value at a plain launch: the default, else the first choice."""
        return self.choices[0] if self.default is None and self.choices else self.default


class PythonTexts:
    """Evaluates the expressions of one syntax tree that consist of literals, names assigned once and packages' folders.

    A name counts in its function. ``arguments``: values of launch arguments; without them ``LaunchConfiguration`` has no value.
    """

    def __init__(
        self, nodes: Sequence[ast.AST], finder: PackageFinder, *, arguments: Mapping[str, str] | None = None
    ) -> None:
        self.assigned = _find_single_assignments(nodes)
        self.finder = finder
        self.arguments = dict(arguments or {})
        self.values: dict[int, str | None] = {}

    def evaluate(self, node: ast.AST) -> str | None:
        """Return the text of a node; None if it is unknown."""
        if id(node) not in self.values:
            self.values[id(node)] = None  # while it is computed: a name made of itself has no value
            text = self.compute_text(node)
            self.values[id(node)] = None if text is None or len(text) > MAX_LENGTH else text
        return self.values[id(node)]

    def compute_text(self, node: ast.AST) -> str | None:
        """Return the text of a node, not from memory."""
        if isinstance(node, ast.Constant):
            return node.value if isinstance(node.value, str) else None
        if isinstance(node, ast.Name):
            return self.evaluate(self.assigned[id(node)]) if id(node) in self.assigned else None
        if isinstance(node, ast.JoinedStr):
            return self.evaluate_all(node.values, "".join)
        if isinstance(node, ast.FormattedValue):
            return self.evaluate(node.value) if node.conversion == -1 and node.format_spec is None else None
        if isinstance(node, ast.BinOp):
            joins = {ast.Add: "".join, ast.Div: join_paths}
            join = joins.get(type(node.op))
            return None if join is None else self.evaluate_all([node.left, node.right], join)
        if isinstance(node, ast.Call):
            return self.evaluate_call(node)
        return None

    def evaluate_call(self, node: ast.Call) -> str | None:
        """Return the text of a call that finds a package, joins paths or reads a launch argument."""
        package = self.get_package(node)
        if package is not None:
            folder = self.finder.find(package)
            return None if folder is None else str(folder)
        function = get_function_name(node)
        if function == "find" and isinstance(node.func, ast.Attribute):  # FindPackageShare("p").find("p")
            share = self.follow_name(node.func.value)
            return self.evaluate(share) if share is not None and is_package_lookup(share) else None
        if function in {"join", "joinpath", "Path", "PathSubstitution", "str"} and not node.keywords:
            before = [node.func.value] if function == "joinpath" and isinstance(node.func, ast.Attribute) else []
            return self.evaluate_all([*before, *node.args], join_paths)
        if function == "PathJoinSubstitution" and len(node.args) == 1:
            return self.evaluate_all(self.list_elements(node.args[0]), join_paths)
        return self.evaluate_argument(node, function)

    def evaluate_argument(self, node: ast.Call, function: str) -> str | None:
        """Return the value of the launch argument that a call reads."""
        if function == "LaunchConfiguration":
            return self.arguments.get(self.get_argument_name(node))
        if function == "PythonExpression" and node.args:
            joined = self.evaluate_all(self.list_elements(node.args[0]), "".join)
            quoted = None if joined is None else _QUOTED.fullmatch(joined.strip())
            return None if quoted is None else quoted[2]
        if function == "perform_substitution" and node.args:  # context.perform_substitution(LaunchConfiguration(…))
            return self.evaluate(node.args[-1])
        if function == "perform" and isinstance(node.func, ast.Attribute):  # LaunchConfiguration(…).perform(context)
            return self.evaluate(node.func.value)
        return None

    def get_argument_name(self, node: ast.expr) -> str:
        """Return the launch argument that ``LaunchConfiguration(…)`` reads; empty for anything else."""
        if not isinstance(node, ast.Call) or get_function_name(node) != "LaunchConfiguration":
            return ""
        name = find_call_argument(node, 0, "variable_name")
        return "" if name is None else self.evaluate(name) or ""

    def evaluate_all(self, nodes: Sequence[ast.AST], join: Callable[[list[str]], str]) -> str | None:
        """Return the texts of all nodes together; None if one is unknown."""
        texts = [self.evaluate(node) for node in nodes]
        parts = [text for text in texts if text is not None]
        return join(parts) if parts and len(parts) == len(texts) else None

    def get_package(self, node: ast.AST) -> str | None:
        """Return the package that a call looks up, if its name is known."""
        name = get_package_name(node)
        if name is not None or not is_package_lookup(node) or not isinstance(node, ast.Call):
            return name
        asked = find_call_argument(node, 0, "package", "package_name")
        return None if asked is None else self.evaluate(asked)

    def follow_name(self, node: ast.expr | None) -> ast.expr | None:
        """Return the value of a name that is assigned once; anything else as it is."""
        for _ in range(8):
            if not isinstance(node, ast.Name) or id(node) not in self.assigned:
                break
            node = self.assigned[id(node)]
        return node

    def is_of_packages(self, node: ast.expr) -> bool:
        """Whether a text is made only of literals and the folders of packages, found or not: no argument decides it."""
        followed = self.follow_name(node)
        if not isinstance(followed, ast.Call):
            return isinstance(followed, ast.Constant)
        if get_function_name(followed) == "find" and isinstance(followed.func, ast.Attribute):
            return self.is_of_packages(followed.func.value)
        is_join = get_function_name(followed) in {"join", "Path", "str"} and bool(followed.args)
        return is_package_lookup(followed) or (is_join and all(map(self.is_of_packages, followed.args)))

    def list_elements(self, node: ast.expr | None) -> Sequence[ast.expr]:
        """Return the elements of a list; none if it is not a list."""
        node = self.follow_name(node)
        return node.elts if isinstance(node, (ast.List, ast.Tuple)) else []


def read_declared_arguments(nodes: Sequence[ast.AST], texts: PythonTexts) -> dict[str, DeclaredArgument]:
    """Return the arguments that ``DeclareLaunchArgument`` declares."""
    declared: dict[str, DeclaredArgument] = {}
    for node in nodes:
        if isinstance(node, ast.Call) and get_function_name(node) == "DeclareLaunchArgument":
            name_node, default_node = find_call_argument(node, 0, "name"), find_call_argument(node, 1, "default_value")
            name = None if name_node is None else texts.evaluate(name_node)
            choices_node = find_call_argument(node, -1, "choices")
            choices = [texts.evaluate(choice) for choice in texts.list_elements(choices_node)]
            default = None if default_node is None else texts.evaluate(default_node)
            # Of one choice the value is known, whatever the default is made of: the launch refuses any other.
            if name and (default_node is None or default is not None or (len(choices) == 1 and choices[0])):
                known = tuple(choice for choice in choices if choice is not None)
                place = default_node or next(iter(texts.list_elements(choices_node)), node)
                declared.setdefault(name, DeclaredArgument(default, known, place))
    return declared


def find_call_argument(call: ast.Call, position: int, *names: str) -> ast.expr | None:
    """Return an argument of a call by one of its names or, if not negative, by its position."""
    for keyword in call.keywords:
        if keyword.arg in names:
            return keyword.value
    return call.args[position] if 0 <= position < len(call.args) else None


def get_function_name(call: ast.Call) -> str:
    """Return the last name of the called function."""
    return call.func.attr if isinstance(call.func, ast.Attribute) else str(getattr(call.func, "id", ""))


def is_package_lookup(node: ast.AST) -> bool:
    """Whether a node calls ``get_package_share_directory``, ``FindPackageShare`` or the like."""
    return isinstance(node, ast.Call) and bool(re.search("package_share|PackageShare", get_function_name(node)))


def get_package_name(node: ast.AST) -> str | None:
    """Return ``p`` of ``get_package_share_directory("p")``, ``FindPackageShare("p")`` and the like."""
    if not isinstance(node, ast.Call) or not is_package_lookup(node):
        return None
    arguments = [*node.args, *(keyword.value for keyword in node.keywords)]
    return str(arguments[0].value) if arguments and isinstance(arguments[0], ast.Constant) else None


def join_paths(parts: list[str]) -> str:
    """Join the parts of a path."""
    return os.path.normpath(os.path.join(*parts))


@dataclass(slots=True, eq=False)
class _Scope:
    """The names that a function, or the file around them, gives values."""

    around: _Scope | None
    times: Counter[str] = field(default_factory=Counter)
    """How often each name gets one."""
    values: dict[str, ast.expr] = field(default_factory=dict)
    """The value of each name in its last plain assignment."""

    def find_value(self, name: str) -> ast.expr | None:
        """Return the value of a name that is assigned in one place only of the innermost function that assigns it."""
        scope: _Scope | None = self
        while scope is not None and not scope.times[name]:
            scope = scope.around
        return scope.values.get(name) if scope is not None and scope.times[name] == 1 else None


def _find_single_assignments(nodes: Sequence[ast.AST]) -> dict[int, ast.expr]:
    """Return by the id of each node that reads a name the value of the name, where one place assigns it.

    ``nodes``: those of one tree, its root first.
    """
    reads: list[tuple[ast.Name, _Scope]] = []
    waiting: list[tuple[ast.AST, _Scope]] = [(nodes[0], _Scope(None))] if nodes else []
    while waiting:
        node, scope = waiting.pop()
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            scope = _Scope(scope)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
            reads.append((node, scope))
        elif isinstance(node, ast.Name):
            scope.times[node.id] += 1
        elif isinstance(node, ast.arg):
            scope.times[node.arg] += 1
        elif isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            scope.values[node.targets[0].id] = node.value
        elif isinstance(node, (ast.Global, ast.Nonlocal)):
            _forget_names(scope, node.names)
        waiting += [(child, scope) for child in ast.iter_child_nodes(node)]
    found = ((node, scope.find_value(node.id)) for node, scope in reads)
    return {id(node): value for node, value in found if value is not None}


def _forget_names(scope: _Scope | None, names: Sequence[str]) -> None:
    """Let names that a function shares with those around it have no known value in any of them."""
    while scope is not None:
        scope.times.update(2 * [*names])
        scope = scope.around
