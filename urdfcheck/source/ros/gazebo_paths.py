"""Where the files of a project lead Gazebo to look for meshes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.similar_files import index_files
from urdfcheck.source.text.xml import COMMENT

# The variables of the paths on which Gazebo looks for `model://`, and the attribute of an export in a package.xml that sets one.
RESOURCE_PATH = re.compile(r"gazebo_model_path|GAZEBO_MODEL_PATH|(?:GZ_SIM|IGN_GAZEBO)_RESOURCE_PATH|SDF_PATH")
# How a launch file or an export names the folder of a package itself.
_SHARE = re.compile(r"get_package_share|FindPackageShare|\$\(find[\s-]|\$\{prefix\}")
_REMARK = re.compile(r"^[ \t]*#[^\n]*", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class GazeboFolder:
    """A folder of a package to which a file leads Gazebo."""

    folder: Path
    file: Path
    """The file that sets the variable and names the folder."""
    variable: str


def find_gazebo_folder(package: Path, texts: Iterable[tuple[Path, str]], paths: Sequence[str]) -> GazeboFolder | None:
    """Return the folder of a package that has files at all these ``paths``, if one of the ``texts`` sets a path of Gazebo and
    names the folder.

    What a launch file computes is not known: it is enough that it names both.
    """
    folders = _list_folders_with(package, paths)
    for file, text in texts if folders else ():
        if RESOURCE_PATH.search(text) is None:
            continue
        plain = _REMARK.sub("", COMMENT.sub("", text))
        variable = RESOURCE_PATH.search(plain)
        for folder in folders if variable is not None else ():
            name = _SHARE if folder == package else re.compile(rf"[\"'/]{re.escape(folder.name)}(?=[\"'/:;,)\s])")
            if variable is not None and name.search(plain):
                return GazeboFolder(folder, file, variable[0])
    return None


def _list_folders_with(package: Path, paths: Sequence[str]) -> list[Path]:
    """List the folders of a package, itself included, that have files at all these paths below them."""
    index, common = index_files([package]), list[Path]()
    for number, path in enumerate(paths):
        parts = tuple(path.split("/"))
        depth = len(parts) - 1
        found = [
            file.parents[depth]
            for file in index.get(parts[-1].lower(), [])
            if file.parts[-len(parts) :] == parts and file.parents[depth].is_relative_to(package)
        ]
        common = found if number == 0 else [folder for folder in common if folder in found]
    return common
