"""Which folders of a ROS 2 package its CMakeLists.txt or setup.py install. Neither of them is run."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import field, replace
from pathlib import Path

from urdfcheck.core import Edit, Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.package.build_files import LARGEST_BUILD_FILE, read_build_type
from urdfcheck.source.package.cmake_installs import CmakeCommand, parse_commands, read_cmake_installs
from urdfcheck.source.package.finder import Package, format_path
from urdfcheck.source.package.installed_files import InstalledFiles
from urdfcheck.source.package.setup_py_installs import read_setup_installs
from urdfcheck.source.text.python import parse_python
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import read_regular

# The share folder of a package whose CMake project has its name.
_SHARE = "share/${PROJECT_NAME}"
# What begins a block of commands that may not run, and what selects files of an installed folder.
_BLOCKS = frozenset({"if", "foreach", "while", "function", "macro", "block"})
_SELECTING = frozenset({"FILES_MATCHING", "PATTERN", "REGEX", "CONFIGURATIONS", "COMPONENT", "OPTIONAL"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class InstallRules:
    """What a package installs, and where its build file says so."""

    installed: InstalledFiles
    at: Location
    """Where a missing folder has to be named."""
    build_form: str
    """cmake | python: how it has to be named."""
    insertion_point: Span | None = None
    """Where to insert the name; None if there is no known place."""
    insertion: tuple[str, str] = ("", "")
    """The text before and after the inserted name."""
    share: str = _SHARE
    """The package's share folder, as CMakeLists.txt can name it."""
    other_project: str = ""
    """The project of CMakeLists.txt, where that has another name than the package."""

    names: Mapping[str, str] = field(default_factory=dict)
    """The names that setup.py imports, with what each stands for, and those that it assigns."""

    def build_edits(self, folders: Sequence[str]) -> list[Edit]:
        """Return the edit that adds these folders to the others."""
        if self.insertion_point is None:
            return []
        before, after = self.insertion
        return [Edit(self.insertion_point, "", f"{before}{' '.join(folders)}{after}")]


def read_install_rules(package: Package) -> InstallRules | None:
    """Return what a ROS 2 package installs; None for another package, or without a build file."""
    build = read_build_type(package.root)
    name = {"ament_cmake": "CMakeLists.txt", "ament_python": "setup.py"}.get(build)
    file = None if name is None else _read_file(package, package.path / name)
    if file is None:
        return None
    return _read_cmake(file, package) if build == "ament_cmake" else _read_setup_py(file, package)


def _read_file(package: Package, path: Path) -> SourceFile | None:
    if package.finder is not None and not package.finder.can_open(path):
        return None
    try:
        text = read_regular(path, LARGEST_BUILD_FILE).decode("utf-8-sig", "replace")
    except OSError:
        return None
    return SourceFile(path, format_path(path), text=text)


# -- CMakeLists.txt ----------------------------------------------------------------------------------------------------


def _read_cmake(file: SourceFile, package: Package) -> InstallRules:
    def read_text(name: str) -> str | None:
        other = _read_file(package, package.path / name)
        return None if other is None else other.text

    commands = list(parse_commands(file.text))
    project = next((command.words[0] for command in commands if command.name == "project" and command.words), "")
    is_other = not project.startswith("$") and project not in {"", package.name}
    rules = InstallRules(
        installed=read_cmake_installs(commands, package.name, read_text),
        at=Location("install", None),
        build_form="cmake",
        share=f"share/{package.name}" if is_other else _SHARE,
        other_project=project if is_other else "",
    )
    return _locate_insertion(rules, file, commands=commands, package=package.name)


def _locate_insertion(
    rules: InstallRules, file: SourceFile, *, commands: Sequence[CmakeCommand], package: str
) -> InstallRules:
    """Return the rules with the place for another folder.

    It is after the folders of a command that installs some into the package's share folder, or else before the last command.
    """
    unconditional = _list_unconditional_commands(commands)
    for command in reversed(unconditional):
        folders = _find_share_folder(command, {rules.share, f"share/{package}"})
        if folders is not None:
            end = command.ends[folders]
            at = Location("install", file.make_span(command.start, command.end))
            return replace(rules, at=at, insertion_point=file.make_span(end, end), insertion=(" ", ""))
    last = next((c for c in reversed(unconditional) if c.name == "ament_package"), None)
    if last is None:
        span = file.make_span(commands[-1].start, commands[-1].end) if commands else file.make_span(0, 0)
        return replace(rules, at=Location("install", span))
    at = Location("install", file.make_span(last.start, last.end))
    insertion = ("install(DIRECTORY ", f" DESTINATION {rules.share})\n\n")
    return replace(rules, at=at, insertion_point=file.make_span(last.start, last.start), insertion=insertion)


def _list_unconditional_commands(commands: Sequence[CmakeCommand]) -> list[CmakeCommand]:
    """Return the commands outside of conditions, loops and functions: those in them may not run."""
    depth, found = 0, []
    for command in commands:
        if command.name in _BLOCKS:
            depth += 1
        elif command.name.removeprefix("end") in _BLOCKS:
            depth -= 1
        elif depth <= 0:
            found.append(command)
    return found


def _find_share_folder(command: CmakeCommand, shares: AbstractSet[str]) -> int | None:
    """Return the index of the last folder in a command that installs folders into the package's share folder, by its names."""
    words = command.words
    if command.name == "ament_auto_package" and "INSTALL_TO_SHARE" in words:
        rest = words[words.index("INSTALL_TO_SHARE") + 1 :]
        count = next((i for i, word in enumerate(rest) if word.isupper()), len(rest))
        return words.index("INSTALL_TO_SHARE") + count if count else None
    if command.name != "install" or words[:1] != ("DIRECTORY",) or "DESTINATION" not in words[2:-1]:
        return None
    if not _SELECTING.isdisjoint(words):  # only some files of its folders
        return None
    at = words.index("DESTINATION")
    share = words[at + 1].strip('"').rstrip("/")
    return at - 1 if share in shares else None


# -- setup.py ----------------------------------------------------------------------------------------------------------


def _read_setup_py(file: SourceFile, package: Package) -> InstallRules | None:
    tree = parse_python(file.text)
    if tree is None:
        return None
    nodes = list(ast.walk(tree))
    keyword = next((n for n in nodes if isinstance(n, ast.keyword) and n.arg == "data_files"), None)
    line = 1 if keyword is None else keyword.lineno
    starts = [0, *(m.end() for m in re.finditer(r"\r\n|\n|\r", file.text))]
    begin = starts[min(line, len(starts)) - 1]
    begin += len(file.text[begin:]) - len(file.text[begin:].lstrip(" \t"))
    end = begin + len("data_files") if keyword is not None else begin
    installed = read_setup_installs(tree, package.name)
    if installed is None or not installed.is_complete:
        installed = _collect_names(nodes, package)
    at = Location("install", file.make_span(begin, end))
    return InstallRules(installed=installed, at=at, build_form="python", names=_read_names(tree))


def _read_names(tree: ast.Module) -> dict[str, str]:
    """Return the names that a Python file imports, with what each stands for, and those that it assigns."""
    names: dict[str, str] = {}
    for node in tree.body:
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            inside = f"{node.module}." if isinstance(node, ast.ImportFrom) else ""
            names |= {alias.asname or alias.name: f"{inside}{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Assign):
            names |= {target.id: target.id for target in node.targets if isinstance(target, ast.Name)}
    return names


def _collect_names(nodes: Sequence[ast.AST], package: Package) -> InstalledFiles:
    """Return what a setup.py that is not understood may install: each name in its texts and in the files beside it."""
    texts = [n.value for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    for name in ("setup.cfg", "pyproject.toml", "MANIFEST.in"):
        other = _read_file(package, package.path / name)
        texts += [] if other is None else re.split(r"[\s=,\"']+", other.text)
    everything = any(text in {".", "./", "*"} or text.lstrip("./").startswith("**") for text in texts)
    names = frozenset(part for text in texts for part in text.split("/"))
    return InstalledFiles(entries=(), is_complete=not everything, other_names=names)
