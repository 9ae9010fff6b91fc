"""Which folders of a ROS 2 package its CMakeLists.txt or setup.py install. Neither of them is run."""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from urdfcheck.core import Edit, Location, Span
from urdfcheck.source.package.finder import Package, format_path
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import read_regular

_LARGEST = 1_000_000
# A text without an end reaches to the end of the file, so that each character is matched once.
_TOKEN = re.compile(r'#[^\n]*|"(?:[^"\\]|\\.)*(?:"|\Z)|[()]|[^\s()"#]+', re.DOTALL)
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_SOURCE_DIR_VARIABLES = frozenset(
    {"CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR", "CMAKE_CURRENT_LIST_DIR"}
)
# The most values of one variable, and of one word that contains several variables.
_MOST_VALUES = 1_000
# Commands that only name variables, or do not read a folder of the package.
_SETS = frozenset({"set", "foreach", "list", "project", "message", "find_package", "cmake_minimum_required"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class InstallRules:
    """What a package installs."""

    installs_all: bool
    """Whether it installs everything, or may do so."""
    path_parts: frozenset[str]
    """Every part of a path in a command that may install."""
    at: Location
    """Where a missing folder has to be named."""
    build_form: str
    """cmake | python: how it has to be named."""
    insertion_point: Span | None = None
    """Where to insert the name; None if there is no known place."""
    insertion: tuple[str, str] = ("", "")
    """The text before and after the inserted name."""

    def build_edits(self, folders: Sequence[str]) -> list[Edit]:
        """Return the edit that adds these folders to the others."""
        if self.insertion_point is None:
            return []
        before, after = self.insertion
        return [Edit(self.insertion_point, "", f"{before}{' '.join(folders)}{after}")]


def read_install_rules(package: Package) -> InstallRules | None:
    """Return what a ROS 2 package installs; None for another package, or without a build file."""
    build = _read_build_type(package)
    name = {"ament_cmake": "CMakeLists.txt", "ament_python": "setup.py"}.get(build)
    file = None if name is None else _read_file(package, package.path / name)
    if file is None:
        return None
    return _parse_cmake(file, package) if build == "ament_cmake" else _parse_setup_py(file, package)


def _read_build_type(package: Package) -> str:
    """Return the build type that the manifest exports: ament_cmake, ament_python …"""
    export = None if package.root is None else package.root.find_child("export")
    types = [] if export is None else [e.text.strip() for e in export.find_children("build_type")]
    return types[0] if types else ""


def _read_file(package: Package, path: Path) -> SourceFile | None:
    if package.finder is not None and not package.finder.can_open(path):
        return None
    try:
        text = read_regular(path, _LARGEST).decode("utf-8-sig", "replace")
    except OSError:
        return None
    return SourceFile(path, format_path(path), text=text)


# -- CMakeLists.txt ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _CmakeCommand:
    """A command of CMake."""

    name: str
    start: int
    end: int
    words: tuple[str, ...]
    """The arguments as typed."""
    ends: tuple[int, ...]
    """The offset at which each argument ends."""


def _parse_cmake(file: SourceFile, package: Package) -> InstallRules:
    values: dict[str, list[str]] = {"PROJECT_NAME": [package.name], **{name: ["."] for name in _SOURCE_DIR_VARIABLES}}
    names: set[str] = set()
    everything = False
    commands = list(_parse_commands(file.text))
    for command in commands:
        if command.name in _SETS:
            _assign_variable(command, values)
            continue
        installs = command.name in {"install", "ament_auto_package"}
        for word in command.words:
            for text in _expand_variables(word, values):
                everything |= installs and ("${" in text or text in {".", "./"})
                names.update(text.split("/"))
        everything |= command.name in {"add_subdirectory", "include"} and bool(command.words)
    rules = InstallRules(
        installs_all=everything, path_parts=frozenset(names), at=Location("install", None), build_form="cmake"
    )
    return _locate_insertion(rules, file, commands=commands, package=package.name)


def _locate_insertion(
    rules: InstallRules, file: SourceFile, *, commands: Sequence[_CmakeCommand], package: str
) -> InstallRules:
    """Return the rules with the place for another folder.

    It is after the folders of a command that installs some into the package's share folder, or else before the last command.
    """
    for command in reversed(commands):
        folders = _find_share_folder(command, package)
        if folders is not None:
            end = command.ends[folders]
            at = Location("install", file.make_span(command.start, command.end))
            return replace(rules, at=at, insertion_point=file.make_span(end, end), insertion=(" ", ""))
    last = next((c for c in reversed(commands) if c.name == "ament_package"), None)
    if last is None:
        span = file.make_span(commands[-1].start, commands[-1].end) if commands else file.make_span(0, 0)
        return replace(rules, at=Location("install", span))
    at = Location("install", file.make_span(last.start, last.end))
    insertion = ("install(DIRECTORY ", " DESTINATION share/${PROJECT_NAME})\n\n")
    return replace(rules, at=at, insertion_point=file.make_span(last.start, last.start), insertion=insertion)


def _find_share_folder(command: _CmakeCommand, package: str) -> int | None:
    """Return the index of the last folder in a command that installs folders into the package's share folder."""
    words = command.words
    if command.name == "ament_auto_package" and "INSTALL_TO_SHARE" in words:
        rest = words[words.index("INSTALL_TO_SHARE") + 1 :]
        count = next((i for i, word in enumerate(rest) if word.isupper()), len(rest))
        return words.index("INSTALL_TO_SHARE") + count if count else None
    if command.name != "install" or words[:1] != ("DIRECTORY",) or "DESTINATION" not in words[2:-1]:
        return None
    at = words.index("DESTINATION")
    share = words[at + 1].strip('"').rstrip("/")
    return at - 1 if share in {"share/${PROJECT_NAME}", f"share/{package}"} else None


def _parse_commands(text: str) -> Iterator[_CmakeCommand]:
    words: list[str] = []
    ends: list[int] = []
    name, start, depth = "", 0, 0
    for match in _TOKEN.finditer(text):
        token = match.group(0)
        if token.startswith("#"):
            continue
        if token == "(":
            depth += 1
        elif token == ")":
            depth = max(depth - 1, 0)
            if depth == 0 and name:
                yield _CmakeCommand(name=name, start=start, end=match.end(), words=tuple(words), ends=tuple(ends))
                name, words, ends = "", [], []
        elif depth == 0:
            name, start, words, ends = token.lower(), match.start(), [], []
        else:
            words.append(token)
            ends.append(match.end())


def _assign_variable(command: _CmakeCommand, values: dict[str, list[str]]) -> None:
    """Note the values of a variable; of a loop's variable, all of them."""
    name, *words = command.words or ("",)
    if command.name == "set":
        values[name] = [text for word in words for text in _expand_variables(word, values)][:_MOST_VALUES]
    elif command.name == "foreach":
        lists = "LISTS" in words
        plain = [word for word in words if word not in {"IN", "ITEMS", "LISTS", "RANGE"}]
        named = [f"${{{word}}}" for word in plain] if lists else plain
        values[name] = [text for word in named for text in _expand_variables(word, values)][:_MOST_VALUES]
    elif command.name == "list" and name == "APPEND" and words:
        appended = [text for word in words[1:] for text in _expand_variables(word, values)]
        values[words[0]] = [*values.get(words[0], []), *appended][:_MOST_VALUES]


def _expand_variables(word: str, values: Mapping[str, list[str]]) -> list[str]:
    """Return the texts that a word means; an unknown variable stays as it is."""
    texts = [word.strip('"')]
    for variable in dict.fromkeys(_VARIABLE.findall(word)):
        if variable in values:
            texts = [t.replace(f"${{{variable}}}", value) for t in texts for value in values[variable]][:_MOST_VALUES]
    return [part for text in texts for part in text.split(";")]


# -- setup.py ----------------------------------------------------------------------------------------------------------


def _parse_setup_py(file: SourceFile, package: Package) -> InstallRules | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's warnings about a stranger's code do not belong on the terminal
            tree = ast.parse(file.text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    nodes = list(ast.walk(tree))
    texts = [n.value for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    for name in ("setup.cfg", "pyproject.toml", "MANIFEST.in"):
        other = _read_file(package, package.path / name)
        texts += [] if other is None else re.split(r"[\s=,\"']+", other.text)
    everything = any(text in {".", "./", "*"} or text.lstrip("./").startswith("**") for text in texts)
    names = frozenset(part for text in texts for part in text.split("/"))
    keyword = next((n for n in nodes if isinstance(n, ast.keyword) and n.arg == "data_files"), None)
    line = 1 if keyword is None else keyword.lineno
    starts = [0, *(m.end() for m in re.finditer(r"\r\n|\n|\r", file.text))]
    begin = starts[min(line, len(starts)) - 1]
    begin += len(file.text[begin:]) - len(file.text[begin:].lstrip(" \t"))
    end = begin + len("data_files") if keyword is not None else begin
    return InstallRules(
        installs_all=everything,
        path_parts=names,
        at=Location("install", file.make_span(begin, end)),
        build_form="python",
    )
