"""Which files a run may open: those below the folders that were named, whatever a stranger's files ask for."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

# Names of folders with models whose meshes are in a sibling folder (robot/urdf/robot.urdf, robot/meshes/), without a
# package.xml or a repository around them.
_PARTS = frozenset({"config", "launch", "sdf", "srdf", "urdf", "urdfs", "xacro"})
# The message about a file that is not opened.
OUT_OF_REACH = "it lies outside of the folders that may be read (--allow-read)"


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
        real = dict.fromkeys(os.path.realpath(f) for f in (*map(find_project_folder, paths), *folders))
        return cls(tuple(real))

    def can_open(self, path: Path) -> bool:
        """Whether a file, or the target of a link of this name, may be opened."""
        real = resolve_real_path(path)
        return real is not None and any(is_below(real, root) for root in self.roots)


def find_project_folder(path: Path) -> Path:
    """Return the folder that a path given by the user belongs to.

    This is the repository around it, or else its package, or else the folder itself (for a file, the folder around it; the
    one above if that is called ``urdf`` or similar). A link counts by its own place, not by its target: the link may be a
    stranger's.
    """
    absolute = Path(os.path.abspath(path))
    place = Path(os.path.realpath(absolute.parent), absolute.name)
    # Not Path.is_dir() and Path.exists(), which raise where access is denied.
    folder = place if os.path.isdir(place) and not os.path.islink(place) else place.parent
    home = os.path.realpath(os.path.expanduser("~"))
    around = [f for f in (folder, *folder.parents) if str(f) != home]  # a whole home folder may be a repository
    for mark in (".git", "package.xml"):
        for outer in around:
            if os.path.exists(outer / mark):
                return outer
    return folder.parent if folder.name.lower() in _PARTS else folder


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
    below = real[len(root) :] if root.endswith(os.sep) else real[len(root) + 1 :]
    inside = real.startswith(root.rstrip(os.sep) + os.sep)
    return inside and not any(part.startswith(".") for part in below.split(os.sep))
