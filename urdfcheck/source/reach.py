"""Which files a run may open: those below the folders that were named, whatever a stranger's files ask for."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.project_folders import find_place, is_shared_by_all, list_project_folders
from urdfcheck.system.observing.questions import expand_home

# The one hidden file that belongs to a robot: what the MoveIt Setup Assistant was told.
_VISIBLE = f"{os.sep}.setup_assistant"
# Where the folders of users are.
_HOME = re.compile(r"(?:/home|/Users|[A-Za-z]:/Users)/[^/]+/")
# The message about a file that is not opened.
OUT_OF_REACH = "it is outside the folders that may be read (--allow-read)"


@dataclass(frozen=True, slots=True)
class FileReach:
    """The folders below which files may be opened, as real paths.

    A file counts by its real path, so that a symbolic link does not lead out. Hidden files and folders (``.git/config``,
    ``.env``, ``.ssh/``) do not belong to a robot and are not opened either.
    """

    roots: tuple[str, ...]

    @classmethod
    def from_paths(cls, paths: Iterable[Path], folders: Iterable[Path]) -> FileReach:
        """Return the reach of the projects that the given paths belong to, and of these folders as they are."""
        projects = (folder for path in paths for folder in list_project_folders(path))
        return cls(tuple(dict.fromkeys(os.path.realpath(f) for f in (*projects, *folders))))

    def can_open(self, path: Path) -> bool:
        """Whether a file, or the target of a link of this name, may be opened."""
        return self.has_real_path(resolve_real_path(path))

    def find_root_above(self, folder: Path) -> str | None:
        """Return the real path of the innermost of the folders that a folder is in; none that holds all files of a user."""
        real = resolve_real_path(folder)
        roots = [root for root in self.roots if real is not None and real != root and is_below(real, root)]
        inner = max(roots, key=len, default=None)
        return None if inner is None or is_shared_by_all(Path(inner)) else inner

    def has_real_path(self, real: str | None) -> bool:
        """Whether the file of a real path may be opened; None: no file can have it."""
        return real is not None and any(is_below(real, root) for root in self.roots)


def explain_unreachable(path: Path) -> str:
    """Return why a path given by the user is not opened."""
    place = find_place(path)
    if os.path.isdir(place) and not os.path.islink(place) and is_shared_by_all(place):
        what = "the root of the disk" if place.parent == place else "a folder for all files of one user or of all users"
        shown = Path(os.path.relpath(path)).as_posix()
        return f"it is {what}: name the folders of the robots in it, or allow all of it with --allow-read {shown}"
    return OUT_OF_REACH


def is_in_home_of_another(path: Path) -> bool:
    """Whether a path leads into the home folder of another user: it is one of another machine."""
    return _HOME.match(path.as_posix()) is not None and not path.is_relative_to(expand_home("~"))


def resolve_real_path(path: Path) -> str | None:
    """Return the real path; None if it cannot exist (it contains a NUL, or its links form a circle)."""
    try:
        return os.path.realpath(path)
    except (OSError, ValueError):
        return None


def is_below(real: str, root: str) -> bool:
    """Whether a real path is this folder, or is in it and not hidden."""
    if real == root:
        return True
    below = real[len(root.rstrip(os.sep)) :]  # it begins with a separator
    inside = real.startswith(root.rstrip(os.sep) + os.sep)
    return inside and not any(part.startswith(".") for part in below.removesuffix(_VISIBLE).split(os.sep))
