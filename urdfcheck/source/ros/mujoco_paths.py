"""Which file MuJoCo opens for a path in a URDF: `meshdir` and `strippath` of its ``<mujoco><compiler>`` decide that."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from urdfcheck.source.load import Source
from urdfcheck.source.text.engine_reactions import has_mujoco_option, read_mujoco_options
from urdfcheck.source.text.xml import Element


def takes_only_names(robot: Element) -> bool:
    """Whether MuJoCo leaves out the folders of the paths in a robot: `strippath`."""
    return has_mujoco_option(robot, "strippath", "true")


def takes_no_packages(source: Source) -> bool:
    """Whether a model has options of MuJoCo, which then opens no path that begins with a package."""
    return source.root is not None and bool(read_mujoco_options(source.root)) and not takes_only_names(source.root)


def is_found_by_mujoco(text: str, source: Source) -> bool:
    """Whether MuJoCo opens a file for this path only because of its options (checked with MuJoCo 4.0)."""
    name, _, strips = _read_options(source)
    if not name and not strips:
        return False
    path = find_for_mujoco(text, source)
    # os.path, because pathlib raises if a name is too long.
    return source.finder.can_open(path) and os.path.isfile(path)


def find_for_mujoco(text: str, source: Source) -> Path:
    """Return the file that MuJoCo opens for a path."""
    _, folder, strips = _read_options(source)
    return folder / (text.replace("\\", "/").rpartition("/")[2] if strips else text)


def describe_mujoco_path(files: Iterable[Path], source: Source) -> str:
    """Say what MuJoCo needs besides a path from the model to each of these files, beginning with a semicolon.

    Empty where its options leave such paths as they are, or lead to the same files.
    """
    name, folder, strips = _read_options(source)
    own = Path(os.path.abspath(source.path.parent))
    meant = {Path(os.path.abspath(file)).parent for file in files}
    if meant <= {folder} if strips else folder == own:
        return ""
    if strips:
        place = f'puts meshdir="{name}" before it: delete both' if name else "opens it beside the model: delete that"
        return f'; for MuJoCo, which strippath="true" leaves only the file name, and which {place}'
    if meant <= {folder}:
        return f'; for MuJoCo, which puts meshdir="{name}" before each path, write strippath="true" beside it'
    return f'; for MuJoCo, which puts meshdir="{name}" before each path, delete that'


def _read_options(source: Source) -> tuple[str, Path, bool]:
    """Return the folder that MuJoCo puts before paths, as typed and from the root, and whether it takes only their file names."""
    options = {} if source.root is None else read_mujoco_options(source.root)
    name = options.get("meshdir") or options.get("assetdir") or ""
    folder = Path(os.path.abspath(source.path.parent / name))
    return name, folder, source.root is not None and takes_only_names(source.root)
