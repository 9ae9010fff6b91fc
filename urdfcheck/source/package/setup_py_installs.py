"""What a setup.py installs into its package's share folder: ``data_files``, read from the syntax tree and never run.

A small subset of Python is followed: texts, lists, tuples and dictionaries, ``os.path.join``, ``glob``, loops over known
lists, ``os.walk``, and the functions that the file itself defines. A loop over ``os.walk(folder)`` is followed once, for
``folder/**``, which stands for the folder and all below it. Everything else is unknown.
"""

from __future__ import annotations

import ast
import posixpath
from collections.abc import Iterable, Sequence
from typing import Any

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.installed_files import (
    MOST_ENTRIES,
    InstalledEntry,
    InstalledFiles,
    find_share_place,
    has_magic,
    normalize_source,
)
from urdfcheck.source.text.globs import match_any_pattern

# The most expressions and statements that are followed, the deepest call, and the longest text and list.
_MOST_STEPS = 20_000
_MOST_CALLS = 20
_LONGEST = 2_000
_ALL_BELOW = "**"
# Functions that return their argument, as far as paths go.
_SAME = frozenset({"str", "Path", "list", "tuple", "sorted", "set", "normpath", "fspath", "as_posix"})


class _Unknown:
    """The value of an expression that is not followed."""


_UNKNOWN = _Unknown()


class _ReturnReachedError(Exception):
    """A function ends with a value."""

    def __init__(self, value: Any) -> None:
        self.value = value


class _TooLongError(Exception):
    """The file has more to follow than the limit."""


def read_setup_installs(tree: ast.Module, package: str) -> InstalledFiles | None:
    """Return what ``data_files`` installs for a package of this name; None if there is no such list."""
    reader = _SetupReader(package)
    try:
        reader.run_body(tree.body)
    except (_TooLongError, _ReturnReachedError, RecursionError):
        reader.is_complete = False
    if reader.data_files is None:
        return None
    return InstalledFiles(entries=tuple(reader.read_entries()), is_complete=reader.is_complete)


@dataclass(frozen=True, slots=True)
class PythonPackageData:
    """The files that a setup.py installs inside the Python package of a name, not in the share folder."""

    folder: str
    """The folder of the Python package, relative to that of setup.py."""
    patterns: tuple[str, ...]
    """Of files, relative to that folder."""

    def has_file(self, place: str, path: str) -> bool:
        """Whether the file at a place, relative to setup.py, is installed at this path in the Python package."""
        names = tuple(path.split("/"))
        # A pattern without a slash is one of the folder itself, not of those in it.
        fitting = [p for p in self.patterns if "/" in p or len(names) == 1]
        return place == posixpath.join(self.folder, path) and match_any_pattern(fitting, names)


def read_package_data(tree: ast.Module, package: str) -> PythonPackageData | None:
    """Return what ``package_data`` installs in the Python package with the name of a ROS package; None if it has none."""
    reader = _SetupReader(package)
    try:
        reader.run_body(tree.body)
    except (_TooLongError, _ReturnReachedError, RecursionError):
        return None
    data, folders = (table if isinstance(table, dict) else {} for table in (reader.package_data, reader.package_dir))
    listed = [data[name] for name in (package, "") if name in data]
    # A list that the file computes is not known: whatever is in the folder may be in it.
    patterns = [
        p if isinstance(p, str) else f"{_ALL_BELOW}/*" for v in listed for p in (v if isinstance(v, list) else [v])
    ]
    above = folders.get("", "")
    folder = folders.get(package, posixpath.join(above, package) if isinstance(above, str) else None)
    source = normalize_source(folder) if isinstance(folder, str) else None
    return PythonPackageData(source, tuple(patterns[:MOST_ENTRIES])) if patterns and source is not None else None


class _SetupReader:
    def __init__(self, package: str) -> None:
        self.package = package
        self.scopes: list[dict[str, Any]] = [{}]
        self.functions: dict[str, ast.FunctionDef] = {}
        self.data_files: Any = None
        self.package_data: Any = None
        self.package_dir: Any = None
        self.is_complete = True
        self.steps = 0

    # -- what data_files means ---------------------------------------------------------------------------------

    def read_entries(self) -> Iterable[InstalledEntry]:
        """Yield the entries of ``data_files``."""
        listed = self.data_files if isinstance(self.data_files, list) else [_UNKNOWN]
        for count, item in enumerate(listed):
            known = isinstance(item, (list, tuple)) and len(item) == 2 and isinstance(item[0], str)
            if not known or not isinstance(item[1], (list, tuple)) or count > MOST_ENTRIES:
                self.is_complete = False
                continue
            for file in item[1][:MOST_ENTRIES]:
                entry = self.build_entry(item[0], file)
                if entry is not None:
                    yield entry

    def build_entry(self, destination: str, file: Any) -> InstalledEntry | None:
        """Return where a file, or the files of a pattern, are installed; None if that is unknown or elsewhere."""
        source = normalize_source(file) if isinstance(file, str) else None
        if source is None:
            self.is_complete = False
            return None
        target = find_share_place(destination, self.package)
        if target is None:
            return None
        folder, mark, rest = source.partition(f"/{_ALL_BELOW}")
        if mark and target.endswith(_ALL_BELOW) and rest in {"", "/*"}:
            return InstalledEntry(source=folder, target=posixpath.dirname(target), kind="folder")
        if _ALL_BELOW in target or has_magic(posixpath.dirname(source)):  # which folder of several, nobody knows
            self.is_complete = False
            return None
        if has_magic(source):
            return InstalledEntry(source=source, target=target, kind="pattern")
        return InstalledEntry(source=source, target=posixpath.join(target, posixpath.basename(source)), kind="file")

    # -- statements --------------------------------------------------------------------------------------------

    def run_body(self, body: Sequence[ast.stmt]) -> None:
        for statement in body:
            self.count_step()
            self.run_statement(statement)

    def run_statement(self, node: ast.stmt) -> None:
        """Run a statement; both branches of a condition."""
        if isinstance(node, ast.FunctionDef):
            self.functions[node.name] = node
        elif isinstance(node, ast.Assign):
            value = self.evaluate(node.value)
            for target in node.targets:
                self.assign(target, value)
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            self.assign(node.target, self.evaluate(node.value))
        elif isinstance(node, ast.AugAssign):
            self.assign(node.target, _add(self.evaluate(node.target), self.evaluate(node.value)))
        elif isinstance(node, ast.For):
            self.run_loop(node)
        elif isinstance(node, ast.If):
            self.run_branch(node.body)
            self.run_branch(node.orelse)
        elif isinstance(node, (ast.With, ast.Try)):
            self.run_body(node.body)
        elif isinstance(node, ast.While):
            self.is_complete = False
        elif isinstance(node, ast.Expr):
            self.evaluate(node.value)
        elif isinstance(node, ast.Return):
            raise _ReturnReachedError(None if node.value is None else self.evaluate(node.value))

    def run_branch(self, body: Sequence[ast.stmt]) -> None:
        """Run what a condition may skip: a function may or may not end there."""
        try:
            self.run_body(body)
        except _ReturnReachedError:
            self.is_complete = False

    def run_loop(self, node: ast.For) -> None:
        values = self.list_values(self.evaluate(node.iter))
        if values is None:
            self.is_complete = False
        for value in values or ():
            self.assign(node.target, value)
            self.run_body(node.body)

    def assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self.scopes[-1][target.id] = value
        elif isinstance(target, (ast.Tuple, ast.List)):
            parts = value if isinstance(value, (list, tuple)) and len(value) == len(target.elts) else None
            for index, name in enumerate(target.elts):
                self.assign(name, _UNKNOWN if parts is None else parts[index])
        elif isinstance(target, ast.Subscript):
            owner, key = self.evaluate(target.value), self.evaluate(target.slice)
            if isinstance(owner, dict) and isinstance(key, str):
                # Both branches of a condition are run: what one of them has put there stays.
                owner[key] = [*owner[key], *value] if isinstance(value, list) and key in owner else value
            elif isinstance(owner, dict):
                self.is_complete = False

    # -- expressions -------------------------------------------------------------------------------------------

    def evaluate(self, node: ast.expr) -> Any:
        """Return the value of an expression, or ``_UNKNOWN``."""
        self.count_step()
        if isinstance(node, ast.Constant):
            return node.value if isinstance(node.value, str) else _UNKNOWN
        if isinstance(node, ast.Name):
            return next((scope[node.id] for scope in reversed(self.scopes) if node.id in scope), _UNKNOWN)
        if isinstance(node, (ast.List, ast.Tuple)):
            values = self.evaluate_items(node.elts)
            return values if isinstance(node, ast.List) else tuple(values)
        if isinstance(node, ast.Dict):
            pairs = [(self.evaluate(k), self.evaluate(v)) for k, v in zip(node.keys, node.values, strict=True) if k]
            return {key: value for key, value in pairs if isinstance(key, str)}
        if isinstance(node, ast.BinOp):
            return self.evaluate_operation(node)
        if isinstance(node, ast.JoinedStr):
            return _concatenate(
                [self.evaluate(v.value if isinstance(v, ast.FormattedValue) else v) for v in node.values]
            )
        if isinstance(node, ast.Subscript):
            owner, key = self.evaluate(node.value), self.evaluate(node.slice)
            return owner.get(key, _UNKNOWN) if isinstance(owner, dict) and isinstance(key, str) else _UNKNOWN
        if isinstance(node, (ast.ListComp, ast.GeneratorExp)) and len(node.generators) == 1:
            return self.evaluate_comprehension(node)
        if isinstance(node, ast.Call):
            return self.evaluate_call(node)
        return _UNKNOWN

    def evaluate_items(self, nodes: Sequence[ast.expr]) -> list[Any]:
        items: list[Any] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                items += self.list_values(self.evaluate(node.value)) or [_UNKNOWN]
            else:
                items.append(self.evaluate(node))
        return items[:_LONGEST]

    def evaluate_operation(self, node: ast.BinOp) -> Any:
        left, right = self.evaluate(node.left), self.evaluate(node.right)
        if isinstance(node.op, ast.Add):
            return _add(left, right)
        if isinstance(node.op, ast.Div):  # of pathlib
            return _join([left, right])
        return _UNKNOWN

    def evaluate_comprehension(self, node: ast.ListComp | ast.GeneratorExp) -> Any:
        (generator,) = node.generators
        values = self.list_values(self.evaluate(generator.iter))
        if values is None:
            return [_UNKNOWN]
        made: list[Any] = []
        self.scopes.append({})
        for value in values:
            self.assign(generator.target, value)
            made.append(self.evaluate(node.elt))
        self.scopes.pop()
        return made

    def evaluate_call(self, node: ast.Call) -> Any:
        function = node.func
        name = (
            function.attr
            if isinstance(function, ast.Attribute)
            else function.id
            if isinstance(function, ast.Name)
            else ""
        )
        if name == "setup":
            for keyword in node.keywords:
                if keyword.arg in {"data_files", "package_data", "package_dir"}:
                    setattr(self, keyword.arg, self.evaluate(keyword.value))
            return None
        arguments = self.evaluate_items(node.args)
        if isinstance(function, ast.Attribute) and not _is_module(function.value):
            return self.call_method(self.evaluate(function.value), name, arguments)
        if name in self.functions:
            named = {keyword.arg: self.evaluate(keyword.value) for keyword in node.keywords if keyword.arg}
            return self.call_function(self.functions[name], arguments, named)
        if name == "join":
            return _join(arguments)
        if name in {"glob", "iglob"} and arguments and isinstance(arguments[0], str):
            return [arguments[0]]
        if name == "walk" and arguments and isinstance(arguments[0], str):
            return [(posixpath.join(arguments[0], _ALL_BELOW), [_UNKNOWN], ["*"])]
        if name == "listdir" and arguments and isinstance(arguments[0], str):
            return ["*"]
        if name == "dirname" and len(arguments) == 1 and isinstance(arguments[0], str):
            return posixpath.dirname(arguments[0])
        if name in _SAME and len(arguments) == 1:
            return arguments[0]
        return [] if name in {"list", "dict"} and not arguments else _UNKNOWN

    def call_method(self, owner: Any, name: str, arguments: list[Any]) -> Any:
        """Call a method of a list, a dictionary or a path."""
        if isinstance(owner, list) and name in {"append", "extend"} and arguments:
            owner += [arguments[0]] if name == "append" else self.list_values(arguments[0]) or [_UNKNOWN]
            return None
        if isinstance(owner, list) and name == "insert":
            owner += arguments[1:2]
            return None
        if isinstance(owner, dict):
            views = {"keys": list(owner), "values": list(owner.values()), "items": list(owner.items())}
            if name == "setdefault" and len(arguments) == 2 and isinstance(arguments[0], str):
                return owner.setdefault(arguments[0], arguments[1])
            if name in {"setdefault", "update"}:
                self.is_complete = False
            return views.get(name, _UNKNOWN)
        if isinstance(owner, str):
            if name == "format" or owner == "":
                return _UNKNOWN
            if name in {"glob", "rglob"} and arguments:
                return [_join([owner, *([_ALL_BELOW] if name == "rglob" else []), arguments[0]])]
            return _join([owner, *arguments]) if name == "joinpath" else owner if name in _SAME else _UNKNOWN
        return _UNKNOWN

    def call_function(self, function: ast.FunctionDef, arguments: list[Any], named: dict[str, Any]) -> Any:
        if len(self.scopes) > _MOST_CALLS:
            raise _TooLongError
        names = [argument.arg for argument in function.args.args]
        defaults = function.args.defaults
        scope = {
            name: self.evaluate(node) for name, node in zip(names[len(names) - len(defaults) :], defaults, strict=True)
        }
        self.scopes.append({**scope, **dict(zip(names, arguments, strict=False)), **named})
        try:
            self.run_body(function.body)
        except _ReturnReachedError as returned:
            return returned.value
        finally:
            self.scopes.pop()
        return None

    def list_values(self, value: Any) -> list[Any] | None:
        """Return what a loop goes through; None if that is unknown."""
        if isinstance(value, (list, tuple, dict)):
            return list(value)[:_LONGEST]
        return None

    def count_step(self) -> None:
        """Count a step.

        :raises _TooLongError: beyond the limit.
        """
        self.steps += 1
        if self.steps > _MOST_STEPS:
            raise _TooLongError


def _is_module(node: ast.expr) -> bool:
    """Whether a call's owner is a module: ``os``, ``os.path``, ``glob``, ``pathlib``."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return isinstance(node, ast.Name) and node.id in {"os", "glob", "pathlib", "setuptools", "path"}


def _add(left: Any, right: Any) -> Any:
    if isinstance(left, str) and isinstance(right, str) and len(left) + len(right) < _LONGEST:
        return left + right
    if isinstance(left, list):
        return [*left, *right][:_LONGEST] if isinstance(right, (list, tuple)) else [*left, _UNKNOWN]
    return [_UNKNOWN, *right] if isinstance(right, list) else _UNKNOWN


def _concatenate(parts: list[Any]) -> Any:
    known = [part for part in parts if isinstance(part, str)]
    return "".join(known) if len(known) == len(parts) and sum(map(len, known)) < _LONGEST else _UNKNOWN


def _join(parts: list[Any]) -> Any:
    known = [part for part in parts if isinstance(part, str)]
    return (
        posixpath.join(*known) if known and len(known) == len(parts) and sum(map(len, known)) < _LONGEST else _UNKNOWN
    )
