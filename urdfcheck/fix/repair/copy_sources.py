"""A copy of all files that a model is read from, in which every path that it names leads to the copy."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

from urdfcheck.core import UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.run.jobs import PackageFolders
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.project_folders import find_project_folder, list_project_folders
from urdfcheck.source.reach import is_below

# What meshes draw with, beside them or in a folder beside theirs.
_DRAWN_WITH = frozenset(
    {".png", ".jpg", ".jpeg", ".tga", ".bmp", ".tif", ".tiff", ".gif", ".mtl", ".bin", ".dds", ".webp"}
)
_MESHES = frozenset({".dae", ".obj", ".gltf", ".glb", ".stl", ".ply"})
_MANIFEST = "package.xml"


@dataclass(frozen=True, slots=True, kw_only=True)
class CopiedModel:
    """Where a model and its files were copied to."""

    model: Path
    folder: Path
    files: int
    """Number of copied files."""
    packages: Mapping[str, Path]
    """Folder of each copied package, by the name of its folder and that in its manifest."""


def ensure_target(folder: Path, model: Path) -> None:
    """Reject a folder that holds anything, or that the model itself is in.

    :raises UrdfcheckError: with the reason.
    """
    target = os.path.realpath(folder)
    own = _find_package(Path(os.path.realpath(model))) or Path(os.path.realpath(model)).parent
    if is_below(target, str(own)) or is_below(os.path.realpath(model), target):
        name = format_path(folder)
        raise UrdfcheckError(f"-o {name}: the model is there, and a repair never changes it; name another folder")
    ensure_empty_folder(folder)


def ensure_empty_folder(folder: Path) -> None:
    """Reject a folder that holds anything.

    :raises UrdfcheckError: with the reason.
    """
    name = format_path(folder)
    if os.path.lexists(folder) and not os.path.isdir(folder):
        raise UrdfcheckError(f"-o {name}: it is a file; name a new or an empty folder")
    try:
        if os.path.isdir(folder) and os.listdir(folder):
            raise UrdfcheckError(f"-o {name}: it is not empty; name a new or an empty folder")
    except OSError as error:
        raise UrdfcheckError(f"-o {name}: {error.strerror or error}") from None


def copy_model(model: Path, read: Iterable[str], target: Path, packages: PackageFolders) -> CopiedModel:
    """Copy a model and the files that were read with it.

    Packages of the model's project keep their places relative to each other. Those from elsewhere go to a folder of the package's
    name, and files elsewhere that belong to no package stay where they are.

    :param packages: the packages that the command line and the configuration name.
    :raises UrdfcheckError: when a file cannot be copied.
    """
    model = Path(os.path.realpath(model))
    finder = _HomeFinder(model, packages)
    # The search for packages reads the manifests of all that are near.
    files = {os.path.realpath(path) for path in (str(model), *read) if os.path.isfile(path)}
    files = {path for path in files if os.path.basename(path) != _MANIFEST}
    files |= {drawn for path in files if Path(path).suffix.lower() in _MESHES for drawn in _list_drawn_with(Path(path))}
    homes = {path: home for path in files if (home := finder.find_home(Path(path))) is not None}
    own = {homes[str(model)], *(home for home in homes.values() if is_below(str(home), finder.project))}
    base = os.path.commonpath([finder.find_base(home) for home in own])
    copied: dict[str, Path] = {}
    for home in sorted(set(homes.values())):
        place = target / (os.path.relpath(home, base) if home in own else home.name)
        inside = [path for path, around in homes.items() if around == home]
        inside += [str(home / _MANIFEST)] if os.path.isfile(home / _MANIFEST) else []
        for path in inside:
            _copy_file(path, place / os.path.relpath(path, home))
        copied.update(dict.fromkeys(finder.list_names(home), place))
    count = sum(len(names) for _, _, names in os.walk(target))
    home = homes[str(model)]
    place = target / (os.path.relpath(home, base) if home in own else home.name)
    return CopiedModel(model=place / model.relative_to(home), folder=target, files=count, packages=copied)


class _HomeFinder:
    """Finds the package of a file, or the folder that takes its place."""

    def __init__(self, model: Path, packages: PackageFolders) -> None:
        self.project = os.path.realpath(find_project_folder(model))
        parts = [os.path.realpath(folder) for folder in list_project_folders(model)]
        # The parts of one robot (urdf, meshes …) without a manifest are beside each other.
        self.loose = os.path.dirname(self.project) if len(parts) > 1 else self.project
        if len(parts) > 1:
            self.project = self.loose
        self.named = {name: Path(os.path.realpath(folder)) for name, folder in packages.by_name.items()}
        self.by_folder: set[Path] = set()
        """Packages without a manifest: ROS finds them by the names of their folders."""
        self.searched = [os.path.realpath(folder) for folder in packages.search_path]

    def find_home(self, path: Path) -> Path | None:
        """Return the package of a file, or the folder that counts as one; None for a file of nothing that is known."""
        package = _find_package(path)
        if package is not None:
            return package
        for folder in self.named.values():
            if is_below(str(path), str(folder)):
                return folder
        for around in self.searched:
            if is_below(str(path), around) and str(path.parent) != around:
                found = Path(around, path.relative_to(around).parts[0])
                self.by_folder.add(found)
                return found
        return Path(self.loose) if is_below(str(path), self.loose) else None

    def find_base(self, home: Path) -> str:
        """Return the folder whose place the copy takes, if this is the only home."""
        is_package = home in self.by_folder or home in self.named.values() or os.path.isfile(home / _MANIFEST)
        return str(home.parent if is_package else home)

    def list_names(self, home: Path) -> list[str]:
        """List the names under which a package is found."""
        own = [name for name, folder in self.named.items() if folder == home]
        return own or ([_read_package_name(home)] if os.path.isfile(home / _MANIFEST) else [home.name])


def _find_package(path: Path) -> Path | None:
    return next((folder for folder in path.parents if os.path.isfile(folder / _MANIFEST)), None)


def _read_package_name(folder: Path) -> str:
    from urdfcheck.source.package.finder import load_package

    package = load_package(folder)
    return folder.name if package is None or not package.name else package.name


def _list_drawn_with(mesh: Path) -> set[str]:
    """List what may belong to a mesh: images and materials beside it, and in the folders beside its own; links are left out."""
    found = set()
    for folder in (str(mesh.parent), *_list_folders(mesh.parent), *_list_folders(mesh.parent.parent)):
        try:
            entries = list(os.scandir(folder))
        except OSError:
            continue
        found |= {
            os.path.realpath(entry.path)
            for entry in entries
            if entry.is_file(follow_symlinks=False) and os.path.splitext(entry.name)[1].lower() in _DRAWN_WITH
        }
    return found


def _list_folders(folder: Path) -> list[str]:
    try:
        return [entry.path for entry in os.scandir(folder) if entry.is_dir(follow_symlinks=False)]
    except OSError:
        return []


def _copy_file(path: str, place: Path) -> None:
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, place)  # not its rights: a file that is read-only can be repaired in the copy
    except OSError as error:
        raise UrdfcheckError(f"cannot copy {format_path(Path(path))}: {error.strerror or error}") from None
