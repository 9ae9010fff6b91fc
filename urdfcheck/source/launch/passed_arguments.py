"""What launch files pass to a model: the values of xacro arguments, and the texts that they replace. Nothing is executed."""

from __future__ import annotations

import ast
import fnmatch
import glob
import itertools
import os
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.launch_file import DescriptionSource, Launch, is_description, load_launch, read_description
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON, PythonLaunchReader
from urdfcheck.source.launch.python_texts import (
    MAX_LENGTH,
    DeclaredArgument,
    find_call_argument,
    get_function_name,
    read_declared_arguments,
)
from urdfcheck.source.launch.substitutions import split_command
from urdfcheck.source.package.file_kinds import is_launch
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS, drop_comments
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import read_regular, read_text_or_nothing, walk

# Limit on launch files that are read for one model: the largest repository of a hundred has 130.
MOST_LAUNCHES = 200
# Limit on folders that are searched for them.
MOST_FOLDERS = 10_000
SKIPPED_FOLDERS = BUILD_FOLDERS | {"node_modules", "__pycache__"}
# Added to the rank of what is passed to the model that an argument of the launch file names, and this is not the default.
BESIDE = 3
# A name that a command assigns, and a text in quotes.
ASSIGNMENT = re.compile(r"(?<![\w.:/-])([\w.-]+):=")
# A path in a package, and an argument of the launch file in it.
_IN_PACKAGE = re.compile(r"\$\(find ((?:[^()$]|\$\(arg [^()]+\))+)\)/(.+)")
_ARGUMENT = re.compile(r"\$\(arg [^()]+\)")
_QUOTED = re.compile(r"['\"]([^'\"\\]+)['\"]")
# So many names are followed to see whether a text is made of an argument.
_MOST_STEPS = 20
# Stands for a piece of text that is only known at launch.
_UNKNOWN = "\x01"


@dataclass(frozen=True, slots=True, kw_only=True)
class PassedArgument:
    """A value that a launch file passes to an argument of a model."""

    name: str
    value: str
    location: Location
    """Where the launch file passes it on, or declares its value."""
    rank: int
    """0: typed as it is; 1: the default of an argument of the launch file; 2: the first of its choices. `BESIDE` more where
    the launch file starts the model only if it is told to."""


def find_passed_arguments(
    model: Path, finder: PackageFinder, launches: Sequence[Path] = ()
) -> dict[str, PassedArgument]:
    """Return by name what launch files pass to the arguments of a model.

    These are ``launches``, which are checked with it, then those of its package, then those of the repository around that.
    Among each, a typed value comes before a default, and this before a choice; then the first file counts. Where an argument
    of a launch file names the model that it starts, the models beside the default may be started too.
    """
    real = os.path.realpath(model)
    package = finder.find_package_of(model.absolute())
    inner = model.absolute().parent if package is None else package.path
    outer = finder.find_project_above(inner)
    folders = [folder for folder in (inner, outer) if folder is not None and finder.can_open(folder)]
    found: dict[str, PassedArgument] = {}
    visited: set[str] = set()
    for files in (launches, *(iter_launch_files(folder, finder) for folder in folders)):
        known: dict[str, PassedArgument] = {}
        for launch in files:
            place = os.path.realpath(launch)
            if place in visited or len(visited) >= MOST_LAUNCHES:
                continue
            visited.add(place)
            for passed in read_passed_arguments(launch, real, finder):
                before = known.get(passed.name)
                if before is None or passed.rank < before.rank:
                    known[passed.name] = passed
        found = {**known, **found}
    return found


def read_passed_arguments(launch: Path, model: str, finder: PackageFinder) -> list[PassedArgument]:
    """Return what one launch file passes to the arguments of a model; ``model``: its real path."""
    try:
        data = read_regular(launch, MAX_PYTHON)
    except OSError:
        return []
    if b"xacro" not in data and b"mappings" not in data:
        return []
    if launch.suffix == ".py":
        return list(_read_python(launch, data, model, finder))
    found: list[PassedArgument] = []
    read = load_launch(launch, finder)
    for description in (*read.descriptions, *_iter_other_commands(read)):
        is_meant = description.path is not None and os.path.realpath(description.path) == model
        if is_meant or _may_name(description.file, Path(model), finder):
            at, rank = description.at.location, 0 if is_meant else BESIDE
            found += [PassedArgument(name=n, value=v, location=at, rank=rank) for n, v in description.arguments.items()]
    return found


def _iter_other_commands(launch: Launch) -> Iterator[DescriptionSource]:
    """Yield what commands of an XML launch file make for other parameters: each of several robots has its own."""
    if launch.root is None or launch.scope is None:
        return
    resolver = launch.scope.resolver
    for element in launch.root.walk():
        has_command = element.tag == "param" and "command" in element.attributes and not is_description(element)
        made = read_description(element, resolver) if has_command and resolver.is_active(element) else None
        if made is not None:
            yield made


def _may_name(typed: str, model: Path, finder: PackageFinder) -> bool:
    """Whether a typed path in a package means the model for other values of the launch arguments in it."""
    match = _IN_PACKAGE.fullmatch(typed.strip("'\""))
    package = None if match is None or "$(arg " not in typed else finder.find_package_of(model)
    if match is None or package is None or "$" in _ARGUMENT.sub("", match[2]):
        return False
    named, inside = ("*".join(map(glob.escape, _ARGUMENT.split(part))) for part in match.groups())
    place = os.path.relpath(model, os.path.realpath(package.path))
    same_kind = _get_endings(inside) in {_get_endings(place), ""}
    return same_kind and fnmatch.fnmatchcase(package.name, named) and fnmatch.fnmatchcase(place, inside)


def may_pass_argument(launch: Path, name: str) -> bool:
    """Whether the text of a launch file, outside comments, gives an argument of this name a value, as ``name:=`` or as the key of
    a mapping."""
    text = drop_comments(read_text_or_nothing(launch, MAX_PYTHON))
    return re.search(rf"(?<![\w.-]){re.escape(name)}:=|['\"]{re.escape(name)}['\"]\s*:", text) is not None


def leaves_argument_out(launch: Path, name: str, model: str, finder: PackageFinder) -> bool:
    """Whether a command or call of a launch file certainly expands a model without a value for this argument, whatever others in
    it pass; ``model``: its real path."""
    if launch.suffix != ".py":
        return is_launch(launch) and any(
            description.path is not None
            and os.path.realpath(description.path) == model
            and name not in description.arguments.keys() | description.unknown_arguments
            # a word behind the file that is computed may be any argument
            and not any(":=" not in word and "$" in word for word in _list_words_behind(description))
            for description in load_launch(launch, finder).descriptions
        )
    try:
        reader = make_reader(launch, read_regular(launch, MAX_PYTHON), finder)
        return reader is not None and XacroCallReader(reader).leaves_out(name, model)
    except (OSError, ValueError, RecursionError, MemoryError):
        return False


def _list_words_behind(description: DescriptionSource) -> list[str]:
    """Return the words of a command that follow the model's path."""
    return list(itertools.dropwhile(lambda word: word != description.file, description.words))[1:]


def passes_to_any_model(launch: Path, name: str, finder: PackageFinder) -> bool:
    """Whether a Python launch file expands whichever model one of its arguments names, with a value for this argument."""
    try:
        data = read_regular(launch, MAX_PYTHON)
        reader = make_reader(launch, data, finder) if b"xacro" in data and name.encode() in data else None
        return reader is not None and XacroCallReader(reader).passes_to_any(name)
    except (OSError, ValueError, RecursionError, MemoryError):
        return False


def find_replaced_texts(model: Path, finder: PackageFinder) -> dict[str, Location]:
    """Return the texts with a ``$`` that launch files of a model's package replace in it, with the first place of each.

    They are the first arguments of ``.replace(…)`` in the launch files that contain the model's name.
    """
    package = finder.find_package_of(model.absolute())
    found: dict[str, Location] = {}
    if package is None or not finder.can_open(package.path):
        return found
    for launch in itertools.islice(iter_launch_files(package.path, finder), MOST_LAUNCHES):
        for text, location in _read_replacements(launch, model.name, finder) if launch.suffix == ".py" else ():
            found.setdefault(text, location)
    return found


def iter_launch_files(
    folder: Path, finder: PackageFinder, *, with_unnamed: bool = False, also: tuple[str, ...] = ()
) -> Iterator[Path]:
    """Yield the launch files below a folder, in the order of their paths.

    ``with_unnamed``: also the Python files in folders named launch, whatever their own names; ``also``: more suffixes.
    """
    files: list[Path] = []
    for place, names, inside in itertools.islice(walk(folder), MOST_FOLDERS):
        names[:] = [n for n in names if not n.startswith(".") and n not in SKIPPED_FOLDERS]
        suffix = ".py" if with_unnamed and Path(place).name == "launch" else None
        paths = (Path(place, name) for name in inside)
        suffixes = {suffix, *also}
        files += [path for path in paths if (is_launch(path) or path.suffix in suffixes) and finder.can_open(path)]
    yield from sorted(files)


def is_handed_to_xacro(model: Path, finder: PackageFinder) -> bool:
    """Whether launch files of a model's package hand it to xacro, and none hands it over as it is."""
    return _find_ways(model, finder) == {True}


def is_handed_as_it_is(model: Path, finder: PackageFinder) -> bool:
    """Whether a launch file of a model's package hands it over as it is, and not to xacro."""
    return False in _find_ways(model, finder)


def _find_ways(model: Path, finder: PackageFinder) -> set[bool]:
    """Return whether xacro expands a model, as each launch file of its package says that hands it over."""
    package, real = finder.find_package_of(model.absolute()), os.path.realpath(model)
    if package is None or not finder.can_open(package.path):
        return set()
    launches = itertools.islice(iter_launch_files(package.path, finder, with_unnamed=True), MOST_LAUNCHES)
    return {is_expanded for launch in launches for is_expanded in _list_ways(launch, model.name, real, finder)}


def _list_ways(launch: Path, name: str, model: str, finder: PackageFinder) -> list[bool]:
    """Return for each time that a launch file hands over a model, given by its real path, whether xacro expands it."""
    try:
        data = read_regular(launch, MAX_PYTHON)
    except OSError:
        return []
    if name.encode() not in data:
        return []
    if launch.suffix == ".py":
        reader = make_reader(launch, data, finder)
        return [] if reader is None else list(XacroCallReader(reader).list_ways(model))
    described = (d for d in load_launch(launch, finder).descriptions if d.path is not None)
    return [d.uses_xacro for d in described if d.path is not None and os.path.realpath(d.path) == model]


def make_reader(launch: Path, data: bytes, finder: PackageFinder) -> PythonLaunchReader | None:
    """Return the reader of a Python launch file; None if it is not Python."""
    file = SourceFile(launch, format_path(launch), text=data.decode("utf-8-sig", "replace"))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return PythonLaunchReader(ast.parse(file.text), file, path=launch, finder=finder)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def _read_python(launch: Path, data: bytes, model: str, finder: PackageFinder) -> Iterator[PassedArgument]:
    reader = make_reader(launch, data, finder)
    try:
        yield from () if reader is None else XacroCallReader(reader).read(model)
    except (ValueError, RecursionError, MemoryError):
        return


def _read_replacements(launch: Path, name: str, finder: PackageFinder) -> Iterator[tuple[str, Location]]:
    try:
        data = read_regular(launch, MAX_PYTHON)
    except OSError:
        return
    reader = make_reader(launch, data, finder) if name.encode() in data and b".replace(" in data else None
    if reader is None:
        return
    for node in reader.nodes:
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "replace"):
            continue
        first = node.args[0] if node.args else None
        if isinstance(first, ast.Constant) and isinstance(first.value, str) and "$" in first.value:
            yield first.value, reader.locate_node(first)


class XacroCallReader:
    """Reads the commands and calls of a Python launch file that hand a model to xacro."""

    def __init__(self, reader: PythonLaunchReader) -> None:
        self.reader = reader
        self.declared = read_declared_arguments(reader.nodes, reader.texts)
        self.texts = reader.at_plain_launch

    def read(self, model: str) -> Iterator[PassedArgument]:
        """Yield the arguments that are passed to a model, given by its real path."""
        for node in self.reader.nodes:
            if not isinstance(node, ast.Call):
                continue
            function = get_function_name(node)
            if function == "Command" and node.args:
                yield from self.read_command(node.args[0], model)
            else:
                mappings = self.find_mappings(node, function, model)
                if mappings is not None:
                    yield from self.read_mappings(mappings)

    def find_mappings(self, node: ast.Call, function: str, model: str) -> ast.Dict | None:
        """Return the arguments that a call passes to a model as a mapping: one of xacro's, of MoveIt's, or of a function of the
        launch file's own that takes the path and the arguments, ``to_urdf(path, {"arm": "left"})``."""
        named = self.texts.follow_name(find_call_argument(node, 1, "mappings", "xacro_args"))
        if not isinstance(named, ast.Dict):
            return None
        path = find_call_argument(node, 0, "file_path", "xacro_file", "file")
        if path is not None and path is not named and self.may_mean(self.evaluate(path), model):
            return named
        is_builder = function == "robot_description"  # of MoveItConfigsBuilder, which finds the model itself
        text = "" if path is None else self.evaluate(path)
        own = os.path.realpath(self.reader.own_folder / "config")
        is_own = path is None and os.path.dirname(model) == own and model.endswith(".urdf.xacro")
        return (
            named if is_builder and (is_own or (text and _UNKNOWN not in text and model.endswith(f"/{text}"))) else None
        )

    def read_command(self, command: ast.expr, model: str) -> Iterator[PassedArgument]:
        """Yield the arguments in ``xacro FILE name:=value …``, a text or the pieces of one."""
        pieces, texts, words = self.split_command(command)
        if not words or "xacro" not in words[0]:
            return
        paths = _list_paths(words)
        if any(self.may_mean(path, model) for path in paths):
            beside = 0
        elif any(self.may_start(path, piece, model) for path in paths for piece in pieces):
            beside = BESIDE
        else:
            return
        for word in words[1:]:
            name, assigned, value = word.partition(":=")
            if assigned and name.isprintable() and _UNKNOWN not in word:
                place = _find_piece(texts, f"{name}:=")
                typed = texts[place].rstrip().endswith(":=") and place + 1 < len(pieces)
                passed = self.make_passed(name, value, pieces[place + 1] if typed else pieces[place])
                yield replace(passed, rank=passed.rank + beside)

    def read_names(self, model: str) -> Iterator[tuple[str, Span]]:
        """Yield the names of the arguments that are passed to a model, each with its place."""
        for node in self.reader.nodes:
            if not isinstance(node, ast.Call) or not node.args:
                continue
            function = get_function_name(node)
            if function == "Command":
                pieces, _, words = self.split_command(node.args[0])
                if words and "xacro" in words[0] and any(self.may_mean(path, model) for path in _list_paths(words)):
                    for piece in pieces:
                        yield from self.find_typed(piece, ASSIGNMENT)
            elif function in {"process_file", "process"} and self.may_mean(self.evaluate(node.args[0]), model):
                mappings = self.texts.follow_name(find_call_argument(node, -1, "mappings"))
                for key in mappings.keys if isinstance(mappings, ast.Dict) else ():
                    if key is not None:
                        yield from self.find_typed(key, _QUOTED)

    def leaves_out(self, name: str, model: str) -> bool:
        """Whether a command or call certainly expands a model, given by its real path, without a value for an argument."""
        calls = (node for node in self.reader.nodes if isinstance(node, ast.Call) and node.args)
        return any(
            self.is_command_without(call, name, model)
            if get_function_name(call) == "Command"
            else self.is_call_without(call, name, model)
            for call in calls
        )

    def passes_to_any(self, name: str) -> bool:
        """Whether a command or call expands the model that an argument of the launch file names, with a value for an argument."""
        calls = [
            (get_function_name(node), node) for node in self.reader.nodes if isinstance(node, ast.Call) and node.args
        ]
        for function, call in calls:
            if function == "Command":
                pieces, texts, words = self.split_command(call.args[0])
                first = next((i for i, text in enumerate(texts) if i and text.strip()), 0)
                is_passed = any(word.startswith(f"{name}:=") for word in words) and "xacro" in words[0]
                model = pieces[first] if first else None
            else:
                mappings = self.texts.follow_name(find_call_argument(call, 1, "mappings"))
                keys = (
                    mappings.keys if function in {"process_file", "process"} and isinstance(mappings, ast.Dict) else []
                )
                is_passed = name in [self.texts.evaluate(key) for key in keys if key is not None]
                model = call.args[0]
            if is_passed and model is not None and self.reads_argument(_get_last_part(self.texts.follow_name(model))):
                return True
        return False

    def reads_argument(self, node: ast.expr | None) -> bool:
        """Whether a text is made of an argument of the launch file, by at most a few names."""
        left, steps = [node], 0
        while left and steps < _MOST_STEPS:
            steps += 1
            for inner in () if (followed := self.texts.follow_name(left.pop())) is None else ast.walk(followed):
                if isinstance(inner, ast.expr) and self.texts.get_argument_name(inner):
                    return True
                if isinstance(inner, ast.Name) and self.texts.follow_name(inner) is not inner:
                    left.append(inner)
        return False

    def is_command_without(self, command: ast.Call, name: str, model: str) -> bool:
        """Whether a command expands a model and passes no argument of a name, and nothing unknown that may be one."""
        _, _, words = self.split_command(command.args[0])
        paths = [path for path in _list_paths(words) if self.may_mean(path, model)]
        if not paths or "xacro" not in words[0]:
            return False
        others = [word for word in words[1:] if word not in paths]
        return not any(word.startswith(f"{name}:=") or (":=" not in word and _UNKNOWN in word) for word in others)

    def is_call_without(self, call: ast.Call, name: str, model: str) -> bool:
        """Whether a call of xacro's own expands a model and passes no argument of a name."""
        if get_function_name(call) not in {"process_file", "process"} or not self.may_mean(
            self.evaluate(call.args[0]), model
        ):
            return False
        mappings = find_call_argument(call, -1, "mappings")
        if mappings is None:
            return len(call.args) == 1 and all(keyword.arg is not None for keyword in call.keywords)
        if not isinstance(mappings, ast.Dict):  # one with a name may be filled later
            return False
        keys = [None if key is None else self.texts.evaluate(key) for key in mappings.keys]
        return name not in keys and None not in keys

    def find_typed(self, node: ast.expr, pattern: re.Pattern[str]) -> Iterator[tuple[str, Span]]:
        """Yield what a pattern finds in the text of a node, with the place of its first group."""
        span = self.reader.locate_expression(node).span
        if span is not None:
            for match in pattern.finditer(self.reader.file.text, span.start, span.end):
                yield match[1], self.reader.file.make_span(match.start(1), match.end(1))

    def split_command(self, command: ast.expr) -> tuple[Sequence[ast.expr], list[str], tuple[str, ...]]:
        """Return the pieces of a command, their texts, and its words; no words where it is too long."""
        followed = self.texts.follow_name(command) or command
        pieces = self.texts.list_elements(followed) or [followed]
        texts = [self.evaluate(piece) for piece in pieces]
        line = "".join(texts)
        return pieces, texts, () if len(line) > MAX_LENGTH else split_command(line)

    def find_program(self, command: ast.Call, model: str) -> str:
        """Return the program that a command runs on a model; empty if the command is not certainly about this model."""
        _, _, words = self.split_command(command.args[0])
        program = words[0].rpartition("/")[2] if words else ""
        is_about_model = any(self.may_mean(path, model) for path in _list_paths(words))
        return program if is_about_model and program in {"xacro", "cat"} else ""

    def list_ways(self, model: str) -> Iterator[bool]:
        """Yield for each command or call on a model, given by its real path, whether it is xacro's."""
        for node in self.reader.nodes:
            function = get_function_name(node) if isinstance(node, ast.Call) and node.args else ""
            if not isinstance(node, ast.Call):
                continue
            program = self.find_program(node, model) if function == "Command" else ""
            if program:
                yield program == "xacro"
            elif function in {"process_file", "open"} and self.may_mean(self.evaluate(node.args[0]), model):
                yield function == "process_file"

    def read_mappings(self, mappings: ast.Dict) -> Iterator[PassedArgument]:
        """Yield the arguments of ``xacro.process_file(…, mappings={…})``."""
        for key, node in zip(mappings.keys, mappings.values, strict=True):
            name = None if key is None else self.texts.evaluate(key)
            value = self.texts.evaluate(node)
            if name and value is not None:
                yield self.make_passed(name, value, node)

    def make_passed(self, name: str, value: str, node: ast.expr) -> PassedArgument:
        """Return a value that a node passes, at the place where it is typed."""
        read = None if self.reader.texts.evaluate(node) is not None else self.find_declaration(node)
        place = self.reader.locate_node(node if read is None else read.place)
        rank = 0 if read is None else 2 if read.default is None else 1
        return PassedArgument(name=name, value=value, location=place, rank=rank)

    def find_declaration(self, node: ast.expr) -> DeclaredArgument | None:
        """Return the declaration of the launch argument that a node reads."""
        followed = self.texts.follow_name(node)
        for inner in ast.walk(followed) if followed is not None else ():
            if isinstance(inner, ast.expr) and (name := self.texts.get_argument_name(inner)):
                return self.declared.get(name)
        return None

    def evaluate(self, node: ast.expr) -> str:
        """Return the text of a node, with a mark for each part that is unknown."""
        text = self.texts.evaluate(node)
        if text is not None:
            return text
        followed = self.texts.follow_name(node)
        if not isinstance(followed, ast.Call):
            return _UNKNOWN
        function = get_function_name(followed)
        if function == "FindExecutable":
            name = find_call_argument(followed, -1, "name")
            return (None if name is None else self.texts.evaluate(name)) or _UNKNOWN
        if function == "PathJoinSubstitution" and followed.args:
            return "/".join(map(self.evaluate, self.texts.list_elements(followed.args[0])))
        if function == "join":
            return "/".join(map(self.evaluate, followed.args))
        return _UNKNOWN

    def may_mean(self, text: str, model: str) -> bool:
        """Whether a path, with marks for what is unknown, means the model: its name must be known."""
        path = text if _UNKNOWN in text or os.path.isabs(text) else str(self.reader.own_folder / text)
        if _UNKNOWN in path.rpartition("/")[2]:
            return False
        if _UNKNOWN not in path:
            return os.path.realpath(self.reader.finder.find_source(Path(path))) == model
        pattern = "*".join(map(glob.escape, path.split(_UNKNOWN)))
        return fnmatch.fnmatchcase(model, pattern if pattern.startswith(("*", "/")) else f"*/{pattern}")

    def may_start(self, path: str, piece: ast.expr, model: str) -> bool:
        """Whether a piece of a command is this path, an argument of the launch file names the file in it, and the model lies
        beside that of the default."""
        folder, _, name = path.rpartition("/")
        if self.evaluate(piece) != path or _UNKNOWN in name or not self.is_named_by_argument(piece):
            return False
        same_kind = _get_endings(name) == _get_endings(os.path.basename(model))
        return same_kind and self.may_mean(f"{folder}/{os.path.basename(model)}" if folder else "", model)

    def is_named_by_argument(self, node: ast.expr) -> bool:
        """Whether the name of the file in a path is that of an argument of the launch file."""
        followed = self.texts.follow_name(node)
        if isinstance(followed, ast.Call) and get_function_name(followed) == "PathJoinSubstitution" and followed.args:
            elements = self.texts.list_elements(followed.args[0])
            followed = self.texts.follow_name(elements[-1]) if elements else None
        return followed is not None and self.texts.get_argument_name(followed) in self.declared


def _get_last_part(path: ast.expr | None) -> ast.expr | None:
    """Return what names the file in a path that is joined of parts."""
    if not isinstance(path, ast.Call) or not path.args:
        return path
    if get_function_name(path) == "join":
        return path.args[-1]
    parts = path.args[0]
    if get_function_name(path) == "PathJoinSubstitution" and isinstance(parts, (ast.List, ast.Tuple)) and parts.elts:
        return parts.elts[-1]
    return path


def _list_paths(words: Sequence[str]) -> list[str]:
    """Return the words of a command that are neither options nor assignments."""
    return [word for word in words[1:] if ":=" not in word and not word.startswith("-")]


def _get_endings(name: str) -> str:
    """Return all that follows the first dot of a file's name."""
    return name.partition(".")[2].lower()


def _find_piece(texts: Sequence[str], begin: str) -> int:
    """Return the index of the piece that an assignment begins in."""
    return next((i for i, text in enumerate(texts) if begin in text), 0)
