"""The models and launch files that a Python launch file names by literal paths. Nothing in it is executed."""

from __future__ import annotations

import ast
import io
import itertools
import os
import re
import string
import token
import tokenize
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import NEWLINE, Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.built_files import list_written_expressions, may_be_built
from urdfcheck.source.launch.python_texts import (
    MAX_LENGTH,
    PythonTexts,
    find_call_argument,
    get_function_name,
    get_package_name,
    read_declared_arguments,
)
from urdfcheck.source.package.file_kinds import LAUNCH_SUFFIXES, MODEL_SUFFIXES, SRDF_SUFFIXES
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS, list_subfolders
from urdfcheck.source.text.problems import Problem, locate_start
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.encodings import is_single_byte
from urdfcheck.system.files import FileTooLargeError, read_regular, walk

# The syntax tree takes a few hundred times as much memory. The limit is about 25,000 lines.
MAX_PYTHON = 1024**2
# Limit on paths of models that are looked up, each in several folders.
MAX_PATHS = 1_000
# Limit on folders of a package in which models are searched by name.
MAX_FOLDERS = 2_000
# The characters of an expression that a message shows.
MAX_SHOWN = 40
# Limit on missing launch files that are searched in their whole package.
MAX_LAUNCHES = 64

# An f-string of one line, which may repeat its quotes inside its braces.
_NESTED_TEXT = re.compile(r"""(?<!\w)(f|rf|fr)("|')((?:\{[^{}\n]*\}|(?!\2)[^{}\n])*)\2""", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class LocatedPath:
    """A path in a Python launch file, as far as it is known, and where its last part is typed."""

    path: str
    location: Location
    depends_on: str = ""
    """What its folder is made of and only the launch decides: names as typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PythonLaunch:
    """What could be read of a Python launch file."""

    file: SourceFile | None = None
    models: tuple[Path, ...] = ()
    """The model files that it names, in its own package or in those that it names."""
    missing_models: tuple[LocatedPath, ...] = ()
    """Paths in a known package that do not exist."""
    missing_includes: tuple[LocatedPath, ...] = ()
    """Paths of launch files in a known package that do not exist."""
    unknown_models: tuple[LocatedPath, ...] = ()
    """Relative paths of models that are not found in any of these packages."""
    runs_xacro: bool = False
    """Whether it starts xacro or imports it."""
    description_location: Location | None = None
    """Where it passes robot_description on."""
    syntax_problem: Problem | None = None
    """Why it cannot be parsed, or only by a newer Python."""
    read_problem: Problem | None = None
    """Why it cannot be opened."""

    def list_real_models(self) -> set[str]:
        """Return the real paths of the models."""
        return set(map(os.path.realpath, self.models))


def read_python_launch(path: Path, finder: PackageFinder) -> PythonLaunch:
    """Read the models that a Python launch file names.

    A path may be one text, or the last texts of ``os.path.join(…)``, ``PathJoinSubstitution([…])`` and ``folder / …``.
    """
    name = format_path(path)
    start = locate_start("launch", name)
    try:
        data = read_regular(path, MAX_PYTHON)
    except FileTooLargeError as error:
        limits = {"what": "bytes", "limit": error.limit, "found": error.found}
        return PythonLaunch(read_problem=Problem(kind="too-large", message=error.message, location=start, data=limits))
    except OSError as error:
        return PythonLaunch(
            read_problem=Problem(kind="unreadable", message=error.strerror or str(error), location=start)
        )
    file = SourceFile(path, name, text=data.decode("utf-8-sig", "replace"))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's warnings about a stranger's code do not belong on the terminal
            if "\ufffd" in file.text:  # Python may refuse the bytes
                ast.parse(data)
            file = _decode_as_python(file, data)
            tree, newer = _parse(file)
            found = PythonLaunchReader(tree, file, path=path, finder=finder).read()
            return found if newer is None else replace(found, syntax_problem=newer)
    except SyntaxError as error:
        at = _find_rest_of_line(file, error.lineno, (error.offset or 1) - 1)
        return PythonLaunch(
            file=file, syntax_problem=Problem(kind="syntax", message=error.msg, location=Location("launch", at))
        )
    except (ValueError, RecursionError, MemoryError):  # a zero byte, or nested too deeply
        return PythonLaunch(
            file=file,
            syntax_problem=Problem(kind="syntax", message="it is not text, or nested too deeply", location=start),
        )


def _parse(file: SourceFile) -> tuple[ast.Module, Problem | None]:
    """Parse a file, with a problem where only Python since 3.12 can: this Python may be older than that of the file's ROS.

    :raises SyntaxError: if it is not Python.
    """
    requoted = _NESTED_TEXT.sub(_requote, file.text)
    if requoted == file.text:
        return ast.parse(file.text), None
    try:
        tree = ast.parse(file.text)
    except SyntaxError as error:
        try:
            tree = ast.parse(requoted)
        except SyntaxError:
            raise error from None
    else:
        if not _nests_quotes(file.text):
            return tree, None
    place = next(at for at, (old, new) in enumerate(zip(file.text, requoted, strict=True)) if old != new)
    problem = Problem(
        kind="newer",
        message="an f-string repeats its quotes inside its braces",
        location=Location("launch", file.make_span(place, place + 1)),
    )
    return tree, problem


def _nests_quotes(text: str) -> bool:
    """Whether an f-string of one line repeats its quotes inside its braces.

    Python before 3.12 has no tokens for the parts of an f-string, and does not parse such a one."""
    opened: list[str] = []
    for one in tokenize.generate_tokens(io.StringIO(text).readline):
        kind, quote = token.tok_name[one.type], one.string.lstrip(string.ascii_letters)[:3]
        if kind in {"FSTRING_START", "STRING"} and opened and opened[-1] == quote[:1]:
            return True
        if kind == "FSTRING_START":
            opened.append(quote)
        elif kind == "FSTRING_END":
            opened.pop()
    return False


def _requote(text: re.Match[str]) -> str:
    """Return an f-string with the other quotes in its braces: the text keeps its length."""
    quote = text[2]
    inside = re.sub(r"\{[^{}\n]*\}", lambda field: field[0].replace(quote, "'" if quote == '"' else '"'), text[3])
    return f"{text[1]}{quote}{inside}{quote}"


def _decode_as_python(file: SourceFile, data: bytes) -> SourceFile:
    """Return the file as Python reads it: in the encoding that one of its first two lines names.

    :raises SyntaxError: if it is another text then; a codec of one byte may differ beyond ASCII.
    """
    encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
    if encoding in {"utf-8", "utf-8-sig"}:
        return file
    if not is_single_byte(encoding) and data.decode(encoding, "replace") != file.text:
        raise SyntaxError(
            f"it declares the encoding {encoding!r}, in which its bytes are a different text than in UTF-8"
        )
    return SourceFile(file.path, file.name, text=data.decode(encoding, "replace"), encoding=encoding)


def _find_line_starts(text: str) -> list[int]:
    """Return the offset of each line, as Python counts them."""
    return [0, *(m.end() for m in NEWLINE.finditer(text))]


def _find_rest_of_line(file: SourceFile, line: int | None, column: int) -> Span:
    """Return the rest of a line from a column; empty if the line is shorter."""
    starts = _find_line_starts(file.text)
    begin = starts[min(max(line or 1, 1), len(starts)) - 1]
    stop = NEWLINE.search(file.text, begin)
    end = len(file.text) if stop is None else stop.start()
    return file.make_span(min(begin + max(column, 0), end), end)


class PythonLaunchReader:
    """Walks one syntax tree, outer nodes first: the pieces of a path are not paths themselves."""

    def __init__(self, tree: ast.AST, file: SourceFile, *, path: Path, finder: PackageFinder) -> None:
        self.file = file
        self.starts = _find_line_starts(file.text)
        self.finder = finder
        self.nodes = list(ast.walk(tree))
        self.texts = PythonTexts(self.nodes, finder)
        declared = read_declared_arguments(self.nodes, self.texts)
        values = {name: argument.value for name, argument in declared.items() if argument.value is not None}
        self.model_files: dict[str, list[Path]] | None = None
        self.at_plain_launch = PythonTexts(self.nodes, finder, arguments=values)
        package = finder.find_package_of(path.absolute())
        self.own_folder = package.path if package is not None else path.parent
        self.named_folders = [
            finder.find(name) for name in dict.fromkeys(filter(None, map(get_package_name, self.nodes)))
        ]

    def read(self) -> PythonLaunch:
        """Return the paths that the file names."""
        folders = [self.own_folder, *(f for f in self.named_folders if f is not None)]
        models: dict[Path, None] = {}
        missing: dict[str, ast.expr] = {}
        unknown: dict[str, ast.expr] = {}
        joined: set[int] = set()
        by_literal: dict[str, Path | None] = {}
        parts = _collect_partial_texts(self.nodes)
        around = self.find_variable_paths()
        tested = self.list_tested_paths() | self.list_written_paths()
        unread = _list_unread_nodes(self.nodes)
        for node in self.nodes:
            if id(node) in joined:
                continue
            pieces = _collect_path_pieces(node)
            exact = self.find_path_in_package(node) or self.find_plain_model(node)
            if exact is not None and self.finder.can_open(exact[0]) and os.path.isfile(exact[0]):
                model: Path | None = exact[0]
            else:
                literal = "/".join(str(p.value) for p in pieces)
                if (
                    literal not in by_literal
                    and literal.strip().lower().endswith(MODEL_SUFFIXES)
                    and len(by_literal) < MAX_PATHS
                ):
                    by_literal[literal] = _find_model_file(literal, folders, self.finder)
                model = by_literal.get(literal)
                if model is None and literal in by_literal:
                    model = self.find_variable_model(node, around, folders)
            if model is not None:
                models[model] = None
                joined.update(map(id, pieces if exact is None else ast.walk(node)))
            elif exact is not None and isinstance(node, ast.expr):
                joined.update(map(id, ast.walk(node)))
                if exact[0] in tested or id(node) in unread:
                    continue
                if str(exact[0]) in missing or (len(missing) < MAX_PATHS and not may_be_built(*exact, MODEL_SUFFIXES)):
                    missing[str(exact[0])] = node
            elif isinstance(node, ast.Constant) and id(node) not in parts | unread and _is_model_path(node.value):
                unknown[str(node.value)] = node
        if models or missing:
            unknown = {}
        includes = self.locate_paths(self.find_missing_includes(tested))
        return PythonLaunch(
            file=self.file,
            models=tuple(models),
            missing_models=self.locate_paths(missing),
            missing_includes=includes,
            unknown_models=tuple(
                replace(named, depends_on=self.describe_variables(around.get(id(unknown[named.path]))))
                for named in self.locate_paths(unknown)
            ),
            runs_xacro=any(map(_names_xacro, self.nodes)),
            description_location=self.find_description_key(),
        )

    def find_variable_paths(self) -> dict[int, ast.expr]:
        """Return by the literal name of a model the path around it, of which another part is only known at launch."""
        found: dict[int, ast.expr] = {}
        for node in self.nodes:
            parts = _list_path_parts(node, self.texts)
            if len(parts) > 1 and isinstance(node, ast.expr):
                found.setdefault(id(parts[-1]), node)
        return found

    def find_variable_model(
        self, node: ast.AST, around: Mapping[int, ast.expr], folders: Sequence[Path]
    ) -> Path | None:
        """Return the model that a literal means whose folder is not known from the text.

        It is the one at a plain launch, with the defaults of all arguments, else the only file of its name in the packages
        that the launch file names.
        """
        if not isinstance(node, ast.Constant) or not _is_model_path(node.value):
            return None
        whole = around.get(id(node))
        plain = None if whole is None else self.at_plain_launch.evaluate(whole)
        if plain is not None and self.finder.can_open(Path(plain)) and os.path.isfile(plain):
            return Path(plain)
        if self.model_files is None:
            self.model_files = _index_model_files(folder for folder in folders if (folder / "package.xml").is_file())
        tail = str(node.value)
        alike = [path for path in self.model_files.get(Path(tail).name, ()) if f"{path}".endswith(f"/{tail}")]
        return alike[0] if len(alike) == 1 and self.finder.can_open(alike[0]) else None

    def describe_variables(self, whole: ast.expr | None) -> str:
        """Return the names of the variable parts of a path, as the launch file calls them."""
        names: dict[str, None] = {}
        for part in () if whole is None else _list_path_parts(whole, self.texts):
            followed = self.texts.follow_name(part)
            if self.texts.evaluate(part) is None and followed is not None and not self.texts.is_of_packages(part):
                names[self.texts.get_argument_name(followed) or _shorten(ast.unparse(part))] = None
        return ", ".join(names)

    def list_tested_paths(self) -> set[Path]:
        """Return the paths of which the file asks whether they exist: it does without them, unless it then stops."""
        stops = [
            node.test
            for node in self.nodes
            if isinstance(node, ast.Assert)
            or (isinstance(node, ast.If) and any(isinstance(line, ast.Raise) for line in node.body))
        ]
        stopping = {id(inner) for test in stops for inner in ast.walk(test)}
        asked: list[ast.expr] = []
        for node in self.nodes:
            if not isinstance(node, ast.Call) or id(node) in stopping:
                continue
            name = get_function_name(node)
            if name in {"exists", "isfile"} and len(node.args) == 1:
                asked += node.args
            elif name in {"exists", "is_file"} and isinstance(node.func, ast.Attribute) and not node.args:
                asked.append(node.func.value)
        asked += _list_tried_arguments(self.nodes)
        return {self.finder.find_source(Path(text)) for node in asked if (text := self.evaluate_text(node))}

    def list_written_paths(self) -> set[Path]:
        """Return the paths that the file writes: what it declares for a launch argument is the value at a plain launch."""
        written = list_written_expressions(self.nodes, self.texts)
        asked = {name for node in written if (name := self.find_read_argument(node))}
        for node in self.nodes if asked else ():
            if isinstance(node, ast.Call) and get_function_name(node) == "DeclareLaunchArgument":
                named, default = find_call_argument(node, 0, "name"), find_call_argument(node, 1, "default_value")
                if named is not None and default is not None and self.texts.evaluate(named) in asked:
                    written += self.texts.list_elements(default) or [default]
        return {self.finder.find_source(Path(text)) for node in written if (text := self.evaluate_text(node))}

    def find_read_argument(self, node: ast.expr) -> str:
        """Return the launch argument that is the whole value of an expression; empty for anything else."""
        read = node
        if isinstance(node, ast.Call) and get_function_name(node) == "perform" and isinstance(node.func, ast.Attribute):
            read = node.func.value
        elif isinstance(node, ast.Call) and get_function_name(node) == "perform_substitution" and node.args:
            read = node.args[-1]
        followed = self.texts.follow_name(read)
        return "" if followed is None else self.texts.get_argument_name(followed)

    def find_missing_includes(self, tested: set[Path]) -> dict[str, ast.expr]:
        """Return the paths of launch files in a known package that do not exist, and that are not ``tested``."""
        absent: dict[Path, tuple[Path, ast.expr]] = {}
        joined = _list_unread_nodes(self.nodes)
        for node in self.nodes:
            exact = None if id(node) in joined else self.find_path_in_package(node, LAUNCH_SUFFIXES)
            if exact is None or not isinstance(node, ast.expr):
                continue
            joined.update(map(id, ast.walk(node)))
            path, package = exact
            if self.finder.can_open(path) and not os.path.isfile(path) and len(absent) < MAX_LAUNCHES:
                absent.setdefault(path, (package, node))
        return {
            str(path): node
            for path, (package, node) in absent.items()
            if path not in tested and not may_be_built(path, package, LAUNCH_SUFFIXES)
        }

    def locate_paths(self, paths: Mapping[str, ast.expr]) -> tuple[LocatedPath, ...]:
        """Return these paths with the place of each."""
        return tuple(
            LocatedPath(path, self.locate_node(node)) for path, node in itertools.islice(paths.items(), MAX_PATHS)
        )

    def find_path_in_package(
        self, node: ast.AST, suffixes: tuple[str, ...] = MODEL_SUFFIXES, *, texts: PythonTexts | None = None
    ) -> tuple[Path, Path] | None:
        """Return a path with one of the suffixes whose package is known, and the package's folder."""
        if not isinstance(node, (ast.Call, ast.BinOp, ast.JoinedStr)):
            return None
        text = (texts or self.texts).evaluate(node)
        if text is None or not text.lower().endswith(suffixes) or "\0" in text:
            return None
        for folder in self.named_folders:
            # A folder that only has the package's name may not be the package.
            if folder is not None and (folder / "package.xml").is_file() and text.startswith(f"{folder}/"):
                return self.finder.find_source(Path(text)), folder
        return None

    def find_plain_model(self, node: ast.AST) -> tuple[Path, Path] | None:
        """Return the model that a path with a computed name means at a plain launch, if it exists, and its package's folder."""
        found = self.find_path_in_package(node, texts=self.at_plain_launch)
        return found if found is not None and self.finder.can_open(found[0]) and os.path.isfile(found[0]) else None

    def evaluate_text(self, node: ast.AST) -> str | None:
        """Return the text of a node that consists of literals, names assigned once and packages' folders; else None."""
        return self.texts.evaluate(node)

    def find_description_key(self) -> Location | None:
        """Return where a node gets the parameter robot_description."""
        for node in self.nodes:
            if isinstance(node, ast.Dict):
                for key, value in zip(node.keys, node.values, strict=True):
                    if not isinstance(key, ast.Constant) or key.value != "robot_description":
                        continue
                    if not self.asks_publisher(value):
                        return self.locate_node(key)
        return None

    def asks_publisher(self, value: ast.expr) -> bool:
        """Whether a description is the one that another node has already: ``ros2 param get …`` asks that node for it."""
        followed = self.texts.follow_name(value)
        if isinstance(followed, ast.Call) and get_function_name(followed) == "ParameterValue" and followed.args:
            followed = self.texts.follow_name(followed.args[0])
        parts = [] if followed is None else ast.walk(followed)
        return any(isinstance(p, ast.Constant) and "ros2 param get " in str(p.value) for p in parts)

    def locate_node(self, node: ast.expr) -> Location:
        """Return the place of the last text in a node, where the name of a path's file is typed."""
        inner = list(ast.walk(node))
        texts: list[ast.expr] = [n for n in inner if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        if any(isinstance(n, ast.JoinedStr) for n in inner):
            texts = []  # before Python 3.12 the positions inside an f-string are not exact
        return self.locate_expression(max(texts, key=lambda n: (n.lineno, n.col_offset), default=node))

    def locate_expression(self, node: ast.expr | ast.stmt) -> Location:
        """Return the place of a whole node."""
        begin = self.compute_offset(node.lineno, node.col_offset)
        end = self.compute_offset(node.end_lineno or node.lineno, node.end_col_offset or node.col_offset)
        return Location("launch", self.file.make_span(begin, end))

    def compute_offset(self, line: int, column: int) -> int:
        """Return the offset in code points of a position of ast, whose columns count bytes of UTF-8."""
        begin = self.starts[min(line, len(self.starts)) - 1]
        text = self.file.text[begin : begin + column]  # at least as many code points as needed
        return begin + len(text.encode("utf-8", "surrogatepass")[:column].decode("utf-8", "ignore"))


def _list_tried_arguments(nodes: Iterable[ast.AST]) -> list[ast.expr]:
    """Return what calls are given in a ``try`` whose handlers all go on."""
    tries = (n for n in nodes if isinstance(n, ast.Try) and n.handlers)
    going_on = (t for t in tries if not any(isinstance(line, ast.Raise) for h in t.handlers for line in ast.walk(h)))
    inside = (inner for t in going_on for line in t.body for inner in ast.walk(line))
    return [argument for call in inside if isinstance(call, ast.Call) for argument in call.args]


def _names_xacro(node: ast.AST) -> bool:
    """Whether a node is the program xacro (alone or first in a command) or Python's module of that name."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str) and node.value.split()[:1] == ["xacro"]
    return isinstance(node, ast.Name) and node.id == "xacro"


def _collect_path_pieces(node: ast.AST) -> list[ast.Constant]:
    """Return the last texts that a node joins, or the text that it is."""
    parts: list[ast.expr] = []
    if isinstance(node, ast.Constant):
        parts = [node]
    elif isinstance(node, ast.Call):
        parts = node.args
    elif isinstance(node, (ast.List, ast.Tuple)):
        parts = node.elts
    while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        parts, node = [node.right, *parts], node.left
    texts = itertools.takewhile(lambda p: isinstance(p, ast.Constant) and isinstance(p.value, str), reversed(parts))
    return [p for p in texts if isinstance(p, ast.Constant)][::-1]


def _list_path_parts(node: ast.AST, texts: PythonTexts) -> list[ast.expr]:
    """Return the parts of a path that a call or slashes join."""
    parts: list[ast.expr] = []
    if isinstance(node, ast.Call) and get_function_name(node) == "PathJoinSubstitution" and len(node.args) == 1:
        parts = list(texts.list_elements(node.args[0]))
    elif isinstance(node, ast.Call) and get_function_name(node) in {"join", "joinpath"}:
        parts = list(node.args)
    while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        parts.insert(0, node.right)
        node = node.left
        if not isinstance(node, ast.BinOp) and isinstance(node, ast.expr):
            parts.insert(0, node)
    return parts


def _index_model_files(packages: Iterable[Path]) -> dict[str, list[Path]]:
    """Return the model files of some packages by their names, each once."""
    found: dict[str, dict[str, Path]] = {}
    for folder in packages:
        for place, names, files in itertools.islice(walk(folder), MAX_FOLDERS):
            names[:] = [n for n in names if not n.startswith(".") and n not in BUILD_FOLDERS]
            for name in files:
                if name.endswith(MODEL_SUFFIXES):
                    path = Path(place, name)
                    found.setdefault(name, {}).setdefault(os.path.realpath(path), path)
    return {name: list(paths.values()) for name, paths in found.items()}


def _find_model_file(literal: str, folders: Sequence[Path], finder: PackageFinder) -> Path | None:
    """Return the file that a literal path names, below one of these folders or in one of their subfolders."""
    tail = literal.strip().lstrip("/")
    if not tail.lower().endswith(MODEL_SUFFIXES) or len(tail) > MAX_LENGTH or any(c in tail for c in "*?[\0"):
        return None
    for base in folders:
        beside = [folder / Path(tail).name for folder in list_subfolders(base) if folder.name not in BUILD_FOLDERS]
        for candidate in (*map(finder.find_source, (base / tail, base / "urdf" / tail)), *beside):
            if finder.can_open(candidate) and os.path.isfile(candidate):
                return candidate
    return None


def _list_unread_nodes(nodes: Sequence[ast.AST]) -> set[int]:
    """Return the nodes in the values of names of functions that nothing reads, or only such a value: a path there is left over.

    Another file may read a name of the module.
    """
    values: dict[str, list[ast.AST]] = {}
    functions = [node for node in nodes if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    for node in {id(inner): inner for function in functions for inner in ast.walk(function)}.values():
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and len(targets) == 1 and isinstance(targets[0], ast.Name):
            values.setdefault(targets[0].id, []).extend([node.value] if node.value is not None else [])
    reads = [node for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)]
    unread: set[int] = set()
    while True:
        read = {node.id for node in reads if id(node) not in unread}
        further = {
            id(inner)
            for name, found in values.items()
            if name not in read
            for value in found
            for inner in ast.walk(value)
        }
        if further <= unread:
            return unread
        unread |= further


def _collect_partial_texts(nodes: Sequence[ast.AST]) -> set[int]:
    """Return the literals that are combined with other text: the names in them are incomplete."""
    parts: set[int] = set()
    for node in nodes:
        if isinstance(node, ast.JoinedStr):
            parts.update(map(id, node.values))
        elif isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Mod)):
            parts.update((id(node.left), id(node.right)))
        elif isinstance(node, ast.Attribute):
            parts.add(id(node.value))
    return parts


def _shorten(expression: str) -> str:
    return expression if len(expression) <= MAX_SHOWN else f"{expression[: MAX_SHOWN - 1]}…"


def _is_model_path(text: object) -> bool:
    """Whether a literal is a relative path of a model, with a name and without placeholders."""
    if not isinstance(text, str) or not text.lower().endswith(MODEL_SUFFIXES) or len(text) > MAX_LENGTH:
        return False
    if text.lower().endswith(SRDF_SUFFIXES):
        return False
    return re.fullmatch(r"(?:\w[\w.-]*/)*\w[\w.-]*\.(?i:urdf|xacro)", text) is not None
