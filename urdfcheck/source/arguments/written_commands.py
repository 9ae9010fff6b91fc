"""Commands of xacro and roslaunch in build files, scripts and texts: they say what a model is expanded with, or a launch file
started with. Nothing runs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import islice
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.core.text import compile_names
from urdfcheck.source.launch.passed_arguments import PassedArgument
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import read_regular, walk

# Limits on the files that are read for one model, on the folders that are searched for them, and on the size of a file.
_MOST_FILES, _MOST_FOLDERS, _LARGEST = 100, 1_000, 200_000
_ENDINGS = ("CMakeLists.txt", ".cmake", ".sh", ".bash", ".test", ".md", ".rst", "Makefile")
# What expands a file, before its name in a command.
_PROGRAM = re.compile(r"(?<![\w/.-])xacro(?:\.py)?(?![\w/.:=-])|\bxacro_add_\w+")
# What starts a launch file.
_STARTER = re.compile(r"(?<![\w/.-])(?:roslaunch|rostest|ros2[ \t]+launch)(?![\w/.:=-])")
# A value that is typed as it is.
_ASSIGNED = re.compile(
    r"""(?<![\w.:/-])([A-Za-z_][\w.-]*):=(?:"([^"$<>{}\n]*)"|'([^'$<>{}\n]*)'|([\w./+-]+)(?![\w$<{(]))"""
)
# An argument, whatever its value.
_NAME = re.compile(r"(?<![\w.:/-])([A-Za-z_][\w.-]*):=")
# What separates two commands: the end of a line that does not go on, or of brackets, or what a shell has; in CMake only brackets.
_BORDER = re.compile(r"(?<!\\)\r?\n|[);|&>`]")
_BORDER_IN_CMAKE = re.compile(r"\)")
_LONGEST = 1_000


def find_written_arguments(model: Path, finder: PackageFinder) -> dict[str, PassedArgument]:
    """Return by name what commands in the files of a model's package pass to its arguments; of several values, the first."""
    found: dict[str, PassedArgument] = {}
    for file, begin, end in _iter_commands(model, finder):
        for assigned in _ASSIGNED.finditer(file.text, begin, end):
            value = next(group for group in assigned.groups()[1:] if group is not None)
            place = Location(f"argument[{assigned[1]}]", file.make_span(*assigned.span()))
            found.setdefault(assigned[1], PassedArgument(name=assigned[1], value=value, location=place, rank=0))
    return found


def list_arguments_of_commands(model: Path, finder: PackageFinder) -> list[frozenset[str]]:
    """List for each of these commands the names of the arguments that it passes, also those with a computed value."""
    commands = _iter_commands(model, finder)
    return [frozenset(_NAME.findall(file.text, begin, end)) for file, begin, end in commands]


def find_starting_command(launch: Path, argument: str, finder: PackageFinder) -> Path | None:
    """Find a file of the project with a command that starts a launch file and passes it an argument."""
    files = _list_files(find_project_folder(launch.absolute()), finder)
    commands = _iter_commands_in(files, launch, _STARTER)
    return next((file.path for file, begin, end in commands if argument in _NAME.findall(file.text, begin, end)), None)


def _iter_commands(model: Path, finder: PackageFinder) -> Iterator[tuple[SourceFile, int, int]]:
    """Yield the files with commands that expand a model, with the begin and the end of what follows its name."""
    package = finder.find_package_of(model.absolute())
    if package is not None:
        yield from _iter_commands_in(islice(_iter_files(package.path, finder), _MOST_FILES), model, _PROGRAM)


def _iter_commands_in(
    files: Iterable[Path], named: Path, program: re.Pattern[str]
) -> Iterator[tuple[SourceFile, int, int]]:
    """Yield those of the files with commands of a program that name one, with the begin and the end of what follows its name."""
    name = compile_names((named.name,))
    for path in files:
        try:
            text = read_regular(path, _LARGEST).decode("utf-8", "replace")
        except OSError:
            continue
        border = _BORDER_IN_CMAKE if path.name.endswith(("CMakeLists.txt", ".cmake")) else _BORDER
        file = SourceFile(path, format_path(path), text=text)
        for match in name.finditer(text):
            starts = [b.end() for b in border.finditer(text, max(0, match.start() - _LONGEST), match.start())]
            if not program.search(text, starts[-1] if starts else 0, match.start()):
                continue
            end = border.search(text, match.end(), match.end() + _LONGEST)
            yield file, match.end(), match.end() + _LONGEST if end is None else end.start()


@lru_cache(maxsize=1)  # each unknown argument of a project asks
def _list_files(folder: Path, finder: PackageFinder) -> tuple[Path, ...]:
    return tuple(islice(_iter_files(folder, finder), _MOST_FILES))


def _iter_files(package: Path, finder: PackageFinder) -> Iterator[Path]:
    if not finder.can_open(package):
        return
    for here, names, files in islice(walk(package), _MOST_FOLDERS):
        names[:] = sorted(n for n in names if not n.startswith(".") and n not in BUILD_FOLDERS)
        for path in (Path(here, name) for name in sorted(files) if name.endswith(_ENDINGS)):
            if finder.can_open(path):
                yield path
