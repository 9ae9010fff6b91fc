"""Which files a run may open: those below the folders that were named, whatever the files of a stranger ask for."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

# How the folder of a model is called whose meshes lie beside it (robot/urdf/robot.urdf, robot/meshes/), where neither a
# package.xml nor a repository says what belongs together.
_PARTS = frozenset({"config", "launch", "sdf", "srdf", "urdf", "urdfs", "xacro"})
# What is said of a file that is not opened.
OUT_OF_REACH = "it lies outside of the folders that may be read (--allow-read)"


@dataclass(frozen=True, slots=True)
class FileReach:
    """The folders below which files may be opened, as real paths.

    A file counts by where it really is, so that a symbolic link leads nowhere else. What is hidden below a folder
    (``.git/config``, ``.env``, ``.ssh/``) belongs to no robot and is not opened either.
    """

    roots: tuple[str, ...]

    @classmethod
    def from_paths(cls, paths: Iterable[Path], folders: Iterable[Path]) -> FileReach:
        """What the given paths belong to, and these folders as they are."""
        real = dict.fromkeys(os.path.realpath(f) for f in (*map(find_project_folder, paths), *folders))
        return cls(tuple(real))

    def can_open(self, path: Path) -> bool:
        """Whether a file, or what a link of this name leads to, may be opened."""
        real = resolve_real_path(path)
        return real is not None and any(is_below(real, root) for root in self.roots)


def find_project_folder(path: Path) -> Path:
    """The folder that a path given by the user belongs to: the repository around it, or else its package, or else itself
    (of a file its folder, and the one above where that is called ``urdf`` or the like). Of a link that is where it lies, not
    where it leads: the link may be a stranger's."""
    named = Path(os.path.abspath(path))
    place = Path(os.path.realpath(named.parent), named.name)
    folder = place if place.is_dir() and not place.is_symlink() else place.parent
    home = os.path.realpath(os.path.expanduser("~"))
    around = [f for f in (folder, *folder.parents) if str(f) != home]  # some keep all of their home in a repository
    for mark in (".git", "package.xml"):
        for outer in around:
            if (outer / mark).exists():
                return outer
    return folder.parent if folder.name.lower() in _PARTS else folder


def resolve_real_path(path: Path) -> str | None:
    """Where a path really leads; None for one that no file system has (a NUL in it, links in a circle)."""
    try:
        return os.path.realpath(path)
    except (OSError, ValueError):
        return None


def is_below(real: str, root: str) -> bool:
    """Whether a real path is this folder or something in it that is not hidden."""
    if real == root:
        return True
    below = real[len(root) :] if root.endswith(os.sep) else real[len(root) + 1 :]
    inside = real.startswith(root.rstrip(os.sep) + os.sep)
    return inside and not any(part.startswith(".") for part in below.split(os.sep))
