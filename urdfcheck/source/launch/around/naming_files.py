"""What the files of a launch file's project name: a frame, or the launch file itself."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from urdfcheck.core.text import compile_names
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.system.files import FileTooLargeError, read_regular, walk

# Of a project with more files, or with larger ones, it is not known what they name.
_MOST_FILES, _LARGEST = 500, 500_000
# The files that start a launch file, or say how to.
_STARTING = (
    *(".launch", ".xml", ".test", ".py", ".sh", ".bash", ".yaml", ".yml", ".json", ".service", ".md", ".rst", ".txt"),
    *("README", "Makefile", "Dockerfile"),
)


def is_started_in_project(launch: Launch) -> bool:
    """Whether another file of the project names this launch file, or one of its name, as far as that is known."""
    own, named = os.path.realpath(launch.path), compile_names((launch.path.name,))
    return any_file_names(
        launch, _STARTING, lambda path, text: named.search(text) is not None and os.path.realpath(path) != own
    )


def any_file_names(launch: Launch, suffixes: tuple[str, ...], is_named: Callable[[Path, str], bool]) -> bool:
    """Whether this holds for a file of the project whose name ends so, and for its text; True where that is not known."""
    project = launch.finder.find_searched_project(launch.path)
    # The walk itself is cut off, so the order of the folders does not decide.
    files = list(itertools.islice(_iter_files(project, suffixes), _MOST_FILES + 1))
    return len(files) > _MOST_FILES or any(_holds(launch, path, is_named) for path in files)


def _iter_files(project: Path, suffixes: tuple[str, ...]) -> Iterator[Path]:
    for here, inner, names in walk(project):
        inner[:] = sorted(name for name in inner if not name.startswith(".") and name not in BUILD_FOLDERS)
        yield from (Path(here, name) for name in sorted(names) if name.endswith(suffixes))


def _holds(launch: Launch, path: Path, is_named: Callable[[Path, str], bool]) -> bool:
    if not launch.finder.can_open(path):
        return False
    try:
        return is_named(path, read_regular(path, _LARGEST).decode("utf-8", "replace"))
    except (OSError, FileTooLargeError):
        return True
