"""The folder of the project that a file belongs to, and the folders that belong to no project. Every start needs it."""

from __future__ import annotations

import os
import stat
from functools import lru_cache
from pathlib import Path

from urdfcheck.system.observing.questions import expand_home, read_variable

# The folders that make up one robot without a package.xml or a repository around them (robot/urdf/robot.urdf, robot/meshes/).
_PARTS = frozenset({
    *("assets", "config", "gazebo", "launch", "materials", "media", "mesh", "meshes", "mjcf", "mujoco", "robots", "ros2_control"),
    *("rviz", "sdf", "srdf", "stl", "textures", "urdf", "urdfs", "usd", "worlds", "xacro", "xml"),
})  # fmt: skip
# One of these words makes a longer name that of a robot's part (basic_urdf, visual_meshes).
_PART_WORDS = frozenset({"mesh", "meshes", "mjcf", "stl", "textures", "urdf", "urdfs", "xacro"})
# What marks the outermost folder of a project, the first kind that is found: a repository, or a package (of rosbuild).
_MARKS = (".git", "package.xml", "manifest.xml")
_TEMPORARY = ("/tmp", "/var/tmp", "/dev/shm")


def find_project_folder(path: Path) -> Path:
    """Return the folder that a path given by the user belongs to.

    This is the repository around it, or else its package, or else the folder itself (for a file, the folder around it). A link
    counts by its own place, not by its target: the link may be a stranger's.
    """
    folder = _find_own_folder(path)
    shared = list_shared_folders()  # a whole home folder may be a repository
    around = [f for f in (folder, *folder.parents) if not is_shared_by_all(f, shared)]
    for mark in _MARKS:
        for outer in around:
            if os.path.exists(os.path.join(outer, mark)):
                return outer
    return folder


def list_project_folders(path: Path) -> list[Path]:
    """Return the folders that come into reach with a path given by the user: its project, and what belongs to that.

    The name of a folder says nothing, for it may be a stranger's. Only where the folder above holds the parts of one robot and
    no other folder (urdf, meshes …), these parts come with it, each by itself. Of the root of the disk, a home folder or a
    folder for everybody's files only the given file does; a file is its own folder then.
    """
    project = find_project_folder(path)
    if is_shared_by_all(project):
        place = find_place(path)
        return [] if place == project or os.path.islink(place) else [place]
    is_marked = any(os.path.exists(project / mark) for mark in _MARKS)
    return [project] if is_marked else [project, *_list_sibling_parts(project)]


def find_place(path: Path) -> Path:
    """Return where a path is, without following it if it is a link."""
    absolute = Path(os.path.abspath(path))
    return absolute if absolute.parent == absolute else Path(os.path.realpath(absolute.parent), absolute.name)


def _find_own_folder(path: Path) -> Path:
    place = find_place(path)
    # Not Path.is_dir(), which raises where access is denied.
    return place if os.path.isdir(place) and not os.path.islink(place) else place.parent


def is_shared_by_all(folder: Path, shared: frozenset[str] | None = None) -> bool:
    """Whether a folder is the root of the disk, the user's home or one for temporary files: it does not belong to a robot.

    ``shared``: the folders of `list_shared_folders`, for callers that ask about many.
    """
    return folder.parent == folder or str(folder) in (list_shared_folders() if shared is None else shared)


def list_shared_folders() -> frozenset[str]:
    """Return the user's home and the folders for temporary files, as real paths."""
    # Not tempfile.gettempdir(), which tries to write: a worker may not.
    named = filter(None, map(read_variable, ("TMPDIR", "TEMP", "TMP")))
    return _resolve_all((expand_home("~"), *_TEMPORARY, *named))


@lru_cache(maxsize=8)  # a check asks about the folders above each file
def _resolve_all(folders: tuple[str, ...]) -> frozenset[str]:
    return frozenset(map(os.path.realpath, folders))


def _list_sibling_parts(folder: Path) -> list[Path]:
    """Return the folders beside one that make up a robot with it; none if anything else is there."""
    above = folder.parent
    if not is_part_of_robot(folder.name) or is_shared_by_all(above) or _is_writable_by_others(above):
        return []
    try:
        with os.scandir(above) as entries:
            beside = [entry for entry in entries if not entry.name.startswith(".")]
        # A linked folder may be anything.
        folders = [above / entry.name for entry in beside if entry.is_dir(follow_symlinks=False)]
        is_robot = all(is_part_of_robot(entry.name) for entry in beside if entry.is_dir())
    except OSError:
        return []
    return sorted(other for other in folders if other != folder) if is_robot else []


def is_part_of_robot(name: str) -> bool:
    """Whether a folder's name is that of a part of a robot (urdf, meshes, visual_meshes)."""
    words = name.lower()
    return words in _PARTS or not _PART_WORDS.isdisjoint(words.replace("-", "_").split("_"))


def _is_writable_by_others(folder: Path) -> bool:
    """Whether any user may put files into a folder; unknown on Windows, where this says no."""
    try:
        return os.name == "posix" and bool(folder.stat().st_mode & stat.S_IWOTH)
    except OSError:
        return True
