"""Where the files of a project lead Gazebo to look for meshes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.source.package.similar_files import FilesByName, index_files
from urdfcheck.system.files import read_text_or_nothing

# The variables of the paths on which Gazebo looks for `model://`, and the attribute of an export in a package.xml that sets one.
# SDF_PATH is also what scripts call the path of a file: only that in quotes, or set in a shell, is the variable.
RESOURCE_PATH = re.compile(
    r"gazebo_model_path|GAZEBO_MODEL_PATH|(?:GZ_SIM|IGN_GAZEBO)_RESOURCE_PATH"
    r"""|(?<=["';])SDF_PATH(?=["';])|\bSDF_PATH(?==[^=\s])"""
)
# The files that Gazebo reads of a folder of its models.
_MODEL_OF_CONFIG = re.compile(r"<sdf\b[^<>]*>\s*([^<>\s]+)\s*</sdf>")
_LARGEST_CONFIG = 100_000


@dataclass(frozen=True, slots=True)
class GazeboFolder:
    """A folder of a package to which a file leads Gazebo."""

    folder: Path
    file: Path
    """The file that sets the variable and names the folder."""
    variable: str


def read_model_config(folder: Path, can_open: Callable[[Path], bool]) -> list[str]:
    """Return the files that the model.config of a folder has Gazebo load: SDF, or URDF, which it reads too."""
    settings = folder / "model.config"
    text = read_text_or_nothing(settings, _LARGEST_CONFIG) if can_open(settings) else ""
    return _MODEL_OF_CONFIG.findall(drop_comments(text))


def find_gazebo_folder(package: Path, texts: Iterable[tuple[Path, str]], paths: Sequence[str]) -> GazeboFolder | None:
    """Return the folder of a package that has files at all these ``paths``, if one of the ``texts`` sets a path of Gazebo and
    names the folder."""
    return _find_named_folder(_list_folders_with(index_files([package]), package, paths), texts)


def select_on_gazebo_path(
    package: Path, texts: Iterable[tuple[Path, str]], paths: Sequence[str]
) -> tuple[GazeboFolder, set[str]] | None:
    """Return the same for a folder that has some of the ``paths``, with these."""
    index = index_files([package])
    places = {path: _list_folders_with(index, package, [path]) for path in paths}
    found = _find_named_folder(list(dict.fromkeys(folder for folders in places.values() for folder in folders)), texts)
    return None if found is None else (found, {path for path, folders in places.items() if found.folder in folders})


def _find_named_folder(folders: Sequence[Path], texts: Iterable[tuple[Path, str]]) -> GazeboFolder | None:
    """Return the folder that a text names which sets a path of Gazebo.

    What a launch file computes is not known: it is enough that it names both.
    """
    for file, text in texts if folders else ():
        if RESOURCE_PATH.search(text) is None:
            continue
        plain = drop_comments(text)
        variable = RESOURCE_PATH.search(plain)
        for folder in folders if variable is not None else ():
            name = rf"[\"'/]{re.escape(folder.name)}(?=[\"'/:;,)\s])"
            if variable is not None and re.search(name, plain):
                return GazeboFolder(folder, file, variable[0])
    return None


def _list_folders_with(index: FilesByName, package: Path, paths: Sequence[str]) -> list[Path]:
    """List the folders of a package that have files at all these paths below them.

    What is in the package's own folder is found without a path of Gazebo.
    """
    common = list[Path]()
    for number, path in enumerate(paths):
        parts = tuple(path.split("/"))
        depth = len(parts) - 1
        found = [
            file.parents[depth]
            for file in index.get(parts[-1].lower(), [])
            if file.parts[-len(parts) :] == parts and package in file.parents[depth].parents
        ]
        common = found if number == 0 else [folder for folder in common if folder in found]
    return common
