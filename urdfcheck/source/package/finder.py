"""Finds ROS packages without ROS, and resolves the paths that models use."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from urllib.parse import unquote

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import SLIP_LIKENESS, compile_names
from urdfcheck.source.package.build_files import LARGEST_BUILD_FILE, read_build_type, read_installed_files
from urdfcheck.source.package.installed_files import InstalledFiles
from urdfcheck.source.package.package_folders import (
    PackagesByName,
    SearchedFolders,
    find_nearest_folder,
    get_used_name,
    is_aside_folder,
    is_old_state,
    list_folders_called,
    list_subfolders,
    read_manifest_name,
    read_package_texts,
    walk_packages,
)
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.project_folders import find_project_folder, is_shared_by_all, list_shared_folders
from urdfcheck.source.reach import FileReach, is_below, resolve_real_path
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, parse_xml
from urdfcheck.system.files import note_lookup, read_regular
from urdfcheck.system.observing.questions import expand_home, read_variable

# How many levels above a model its workspace is searched.
LEVELS_UP = 6
# How deep packages are below a folder of the workspace (src/repository/package), below a given package path, and below the
# repository of a given file, where at most so many folders are looked into, the outer ones first.
LEVELS_DOWN_AROUND = 2
LEVELS_DOWN_PATHS = 3
LEVELS_DOWN_REPOSITORY = 8
MOST_FOLDERS_OF_REPOSITORY = 2_000
_SUFFIXES = frozenset({"description", "support", "gazebo", "config", "bringup", "meshes", "resources", "robot"})
_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+.-]*)://(.*)$", re.DOTALL)


def format_path(path: Path) -> str:
    """Return the name of a file in findings: its path relative to the working directory, with forward slashes."""
    try:
        return Path(os.path.relpath(path)).as_posix()
    except ValueError:  # another drive
        return path.as_posix()


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Package:
    """A folder with a package.xml."""

    name: str
    """The name in the manifest, else the folder's."""
    path: Path
    root: Element | None
    """The manifest's XML; None if it could not be read, for which ``problems`` holds the reason."""
    file: SourceFile | None
    problems: tuple[Problem, ...] = ()
    finder: PackageFinder | None = None
    """Finds the packages around it, and knows which files may be opened."""
    is_fully_checked: bool = False
    """Whether all files of the folder are checked, not just some."""

    @property
    def depends_on_ament(self) -> bool:
        """Whether it depends on the build tools of ROS 2."""
        return any(name.startswith("ament_") for name in self.dependencies)

    @property
    def dependencies(self) -> frozenset[str]:
        """The packages that the manifest depends on in any way."""
        if self.root is None:
            return frozenset()
        return frozenset(e.text.strip() for e in self.root.children if e.tag.endswith("depend"))


def is_kept_aside(file: Path, package: Package | None) -> bool:
    """Whether a file is in a folder of its package, if it has one, for files that are kept and not used."""
    if package is None:
        return False
    file, top = Path(os.path.abspath(file)), package.path.absolute()
    folders = file.relative_to(top).parts[:-1] if file.is_relative_to(top) else ()
    return any(map(is_aside_folder, folders))


def is_unnamed_copy(file: Path, package: Package, can_open: Callable[[Path], bool]) -> bool:
    """Whether the name of a file says that it is an old state, or an old copy of one beside it, and no text of its package names
    it: ``car_old.launch``, ``car (copy).launch`` of ``car.launch``."""
    original = file.with_name(get_used_name(file.name) or file.name)
    if not is_old_state(file.name) and not (original != file and can_open(original) and original.is_file()):
        return False
    own = compile_names((file.name,))
    return not any(map(own.search, read_package_texts(package.path, can_open)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Resource:
    """A path as a model writes it, parsed and looked up."""

    text: str
    kind: str
    """package | file | absolute | home | relative | other (a scheme that no loader of URDF resolves to a file)."""
    package: str | None
    path: Path | None
    """None if the package is unknown or the kind has no file."""
    exists: bool
    """Whether the file exists in exactly this upper and lower case."""
    actual_spelling: str | None = None
    """The file's name on disk; None if there is no such file in any upper and lower case."""
    allowed: bool = True
    """False for a file out of reach, whose existence is not probed: then ``exists`` is False."""


# What was found around models, by the states of the disk that were named last, see `PackageFinder`: while one types there are
# that of the quick checks and that of the last complete one.
_MOST_STATES = 2
_scanned: dict[str, dict[tuple[FileReach | None, tuple[Path, ...]], Mapping[str, Sequence[Path]]]] = {}


class PackageFinder:
    """Finds packages by name.

    In this order: ``explicit`` folders, the package that contains ``start``, folders below ``paths``, package.xml in the
    folders around ``start``, the ``known`` packages of the run (the nearest), ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and last
    a folder of that name around ``start``. ``reach``: which files may be opened besides those of the packages that were
    found; None for all. ``disk_state``: finders of one process with the same one search the same folders once; empty: each does.
    """

    def __init__(
        self,
        start: Path,
        explicit: Mapping[str, Path] | None = None,
        paths: Sequence[Path] = (),
        environment: Mapping[str, str] | None = None,
        reach: FileReach | None = None,
        known: dict[str, list[Path]] | None = None,
        disk_state: str = "",
    ) -> None:
        self.reach = reach
        self.disk_state = disk_state
        self.known: dict[str, list[Path]] = {} if known is None else known
        self.start = start if os.path.isdir(start) else start.parent  # pathlib raises for a name too long
        # Absolute, because xacro resolves a relative path from the file that names it.
        self.explicit = {name: path.absolute() for name, path in (explicit or {}).items()}
        self.paths = [path.absolute() for path in paths]
        self.read_variable = read_variable if environment is None else environment.get
        self._found: dict[str, Path | None] = {}
        self._around: Mapping[str, Sequence[Path]] | None = None
        self._workspace: dict[str, Path] | None = None
        self._below: dict[str, Path] | None = None
        self._ros: dict[str, Path] | None = None
        self._packages: dict[Path, Package | None] = {}
        self._installed: dict[Path, InstalledFiles | None] = {}
        self._resources: dict[tuple[str, Path], Resource] = {}
        self._real_folders: dict[str, str] = {}
        self._namesakes: dict[str, list[Path]] = {}

    def find(self, name: str) -> Path | None:
        """Return the folder of a package, or None."""
        if name not in self._found:
            self._found[name] = found = self._search_package(name)
            if found is not None:
                note_lookup(found / "package.xml")
        return self._found[name]

    def find_by_manifest(self, name: str) -> Path | None:
        """Return the folder of a package; one whose manifest has not this name is it only where the user says so."""
        folder = self.find(name)
        is_meant = folder is not None and (name in self.explicit or read_manifest_name(folder) == name)
        return folder if is_meant else None

    def list_meant(self, name: str, file: Path) -> list[Path]:
        """Return the folders that a package's name in a file may mean: the package around the file, or else every known one."""
        own = self.find_package_of(file.absolute())
        if own is not None and own.name == name and name not in self.explicit:
            return [own.path]
        found = self.find(name)
        return [] if found is None else list(dict.fromkeys([found, *self.list_namesakes(name)]))

    def note_packages(self, folders: Iterable[Path]) -> None:
        """Add the packages at these folders to the known ones of the run."""
        for folder in folders:
            name = read_manifest_name(folder)
            if name is not None and folder.absolute() not in (places := self.known.setdefault(name, [])):
                places.append(folder.absolute())

    def can_open(self, path: Path) -> bool:
        """Whether a file may be opened: it is in reach, or in a package that was found by its name."""
        if self.reach is None:
            return True
        real = self._resolve_path(path)
        return self.reach.has_real_path(real) or self._find_trusted_folder(real) is not None

    def _resolve_path(self, path: Path) -> str | None:
        """Do what `resolve_real_path` does; the real path of a folder with many files is found once, as that takes long."""
        folder, name = os.path.split(path)
        if os.name == "nt" or name in {"", os.curdir, os.pardir} or "\0" in str(path) or os.path.islink(path):
            return resolve_real_path(path)
        if folder not in self._real_folders:
            self._real_folders[folder] = os.path.realpath(folder)
        return os.path.join(self._real_folders[folder], name)

    def find_known_folder(self, path: Path) -> Path | None:
        """Return the real folder of the package that was found by its name and contains this file."""
        return self._find_trusted_folder(self._resolve_path(path))

    def _find_trusted_folder(self, real: str | None) -> Path | None:
        return next((f for f in self._list_trusted_folders() if real is not None and is_below(real, str(f))), None)

    def _list_trusted_folders(self) -> Iterator[Path]:
        """Yield the packages found so far, without those that a link in a stranger's workspace places elsewhere."""
        trusted = [*self.explicit.values(), *self.paths, *self._scan_ros_paths().values()]
        for folder in filter(None, self._found.values()):
            real = os.path.realpath(folder)
            around = any(is_below(real, os.path.realpath(level)) for level in self.list_parent_folders())
            if around or any(is_below(real, os.path.realpath(place)) for place in trusted):
                yield Path(real)

    def _can_follow(self, path: Path) -> bool:
        """Whether a place around the start is not a link, or is a link to a place that may be opened."""
        if self.reach is None or self.reach.can_open(path):
            return True
        real = resolve_real_path(path)
        return real is not None and any(is_below(real, os.path.realpath(level)) for level in self.list_parent_folders())

    def _search_package(self, name: str) -> Path | None:
        if not name or name in {".", ".."} or "/" in name or "\\" in name:
            return None
        own = self.find_package_of(self.start / "package.xml")
        around = self._scan_around_start()
        known = self.known.get(name)
        return (
            self.explicit.get(name)
            or (own.path if own is not None and own.name == name else None)
            or self._scan_paths().get(name)
            or (around[name][0] if name in around else None)
            or (find_nearest_folder(known, self.start) if known else None)
            or self._scan_ros_paths().get(name)
            or self._find_by_folder_name(name)
        )

    def _scan_paths(self) -> dict[str, Path]:
        if self._below is None:
            self._below = {}
            for path in self.paths:
                for name, folder in walk_packages(path, LEVELS_DOWN_PATHS):
                    self._below.setdefault(name, folder)
            for path in self.paths:
                for folder in (path, *list_subfolders(path)):
                    self._below.setdefault(folder.name, folder)
        return self._below

    def _scan_around_start(self) -> Mapping[str, Sequence[Path]]:
        if self._around is None:
            self._around = self._scan_folders(self.list_parent_folders())
        return self._around

    def _scan_folders(self, levels: Sequence[Path]) -> Mapping[str, Sequence[Path]]:
        """Return the folders of each package below these levels, those of the first level first."""
        if not self.disk_state:
            return self._walk_folders(levels)
        scans = _scanned[self.disk_state] = _scanned.pop(self.disk_state, {})
        while len(_scanned) > _MOST_STATES:
            del _scanned[next(iter(_scanned))]
        place = self.reach, tuple(levels)
        if place not in scans:
            scans[place] = self._walk_folders(levels)
        return scans[place]

    def _walk_folders(self, levels: Sequence[Path]) -> dict[str, list[Path]]:
        packages: dict[str, list[Path]] = {}
        searched: SearchedFolders = {}
        for level in levels:
            for name, folder in walk_packages(level, LEVELS_DOWN_AROUND, self._can_follow, searched=searched):
                folders = packages.setdefault(name, [])
                if folder not in folders:
                    folders.append(folder)
        return packages

    def find_repository(self) -> Path | None:
        """Return the repository around the start; without one, the outermost folder ``src`` around it, or None."""
        levels = self.list_parent_folders()
        if levels and (levels[-1] / ".git").exists():
            return levels[-1]
        return next((level for level in reversed(levels) if level.name == "src"), None)

    def walk_repository(self, root: Path) -> Iterator[tuple[str, Path]]:
        """Yield the packages of the repository around the start, as far as a bounded search finds them."""
        return walk_packages(root, LEVELS_DOWN_REPOSITORY, self._can_follow, most=MOST_FOLDERS_OF_REPOSITORY)

    def list_parent_folders(self) -> list[Path]:
        """Return the folders from the start upwards that can belong to the same workspace.

        The root of the disk, the home and the folders for everybody's temporary files belong to none.
        """
        levels: list[Path] = []
        shared = list_shared_folders()
        for level in (self.start, *self.start.parents):
            if len(levels) > LEVELS_UP or is_shared_by_all(level, shared):
                break
            levels.append(level)
            if os.path.exists(os.path.join(level, ".git")):
                break
        return levels

    def find_project_above(self, folder: Path) -> Path | None:
        """Return the repository that a folder is in, or else the folder that was named, such as an unpacked archive."""
        repository = next((outer for outer in folder.parents if os.path.exists(outer / ".git")), None)
        if repository is not None or self.reach is None:
            return repository
        root = self.reach.find_root_above(folder)
        return next((outer for outer in folder.parents if root is not None and os.path.realpath(outer) == root), None)

    def find_searched_project(self, path: Path) -> Path:
        """Return the folder whose files may use a file: its repository, or else the folder that was given, which may hold other
        packages, or else its package."""
        project = find_project_folder(path)
        return project if (project / ".git").exists() else self.find_project_above(project) or project

    def _scan_ros_paths(self) -> dict[str, Path]:
        if self._ros is None:
            self._ros = {}
            for entry in (self.read_variable("ROS_PACKAGE_PATH") or "").split(os.pathsep):
                for name, folder in walk_packages(Path(entry), LEVELS_DOWN_PATHS) if entry else ():
                    self._ros.setdefault(name, folder)
            for entry in (self.read_variable("AMENT_PREFIX_PATH") or "").split(os.pathsep):
                for folder in list_subfolders(Path(entry) / "share") if entry else ():
                    self._ros.setdefault(folder.name, folder)
        return self._ros

    def _find_by_folder_name(self, name: str) -> Path | None:
        """Return the nearest folder without a manifest."""
        return next(self._iter_folders_by_name(name), None)

    def _iter_folders_by_name(self, name: str) -> Iterator[Path]:
        """Yield folders that need no manifest, the nearest first.

        They must be in reach, because nothing else shows that they belong to the model.
        """
        for level in self.list_parent_folders():
            for folder in (level,) if level.name == name else (level / name,):
                # os.path, because pathlib raises if the name is too long or contains a NUL.
                if (self.reach is None or self.reach.can_open(folder)) and os.path.isdir(folder):
                    yield folder
                note_lookup(folder)

    def _find_in_package(self, name: str, inside: str) -> Path | None:
        """Return where a file of a package is, or would be; of folders without a manifest, in the nearest that has the file.

        A folder that is given for the package is the only one.
        """
        folder = self.find(name)
        if folder is None:
            return None
        path = folder / inside
        is_given = name in self.explicit or os.path.exists(folder / "package.xml")
        if is_given or os.path.exists(path):
            return path
        for other in self._iter_folders_by_name(name):
            note_lookup(other / inside)
            if self.can_open(other / inside) and os.path.exists(other / inside):
                return other / inside
        return None if self._has_namesake_with(name, inside) else path

    def _has_namesake_with(self, name: str, inside: str) -> bool:
        """Whether another folder of this name in the model's own package has a file: then the nearest one is not the package, but
        one of several parts that are called so (``urdf/gripper``, ``meshes/gripper``)."""
        own = self.find_package_of(self.start.absolute() / "package.xml")
        if own is None or not inside:
            return False
        if name not in self._namesakes:
            self._namesakes[name] = list_folders_called(name, own.path)
        return any(self.can_open(f / inside) and os.path.isfile(f / inside) for f in self._namesakes[name])

    def describe_search_places(self) -> list[str]:
        """Describe where packages were searched, for the finding that one is missing."""
        places = [f"--package {name}={format_path(path)}" for name, path in sorted(self.explicit.items())]
        places += [format_path(path) for path in self.paths]
        levels = self.list_parent_folders()
        if levels:
            places.append(f"package.xml from {format_path(self.start)} up to {format_path(levels[-1])}")
        if self.known:
            places.append("every package.xml below the given folders")
        for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
            value = self.read_variable(variable)
            places.append(f"{variable}={value}" if value else f"{variable} (not set)")
        return places

    def list_packages(self) -> dict[str, Path]:
        """Return every package that is found by its name, with its folder."""
        near = _take_first(self._scan_around_start())
        return {**self._scan_ros_paths(), **_take_first(self.known), **near, **self._scan_paths(), **self.explicit}

    def list_namesakes(self, name: str) -> list[Path]:
        """Return the folders of the known packages of a name: what lies around without belonging to the run is not meant."""
        return list(self.known.get(name, ()))

    def list_workspace_packages(self) -> dict[str, Path]:
        """Return the packages that may be about the model.

        These are the given ones, those of the repository around the start, and without a repository those beside its own
        package. Other packages that can be found by their names belong to other robots.
        """
        if self._workspace is None:
            levels = self.list_parent_folders()
            deeper: dict[str, Path] = {}
            if levels and (levels[-1] / ".git").exists():
                deeper = {name: f for name, f in _take_first(self.known).items() if levels[-1] in f.parents}
            elif levels:
                innermost = next((n for n, level in enumerate(levels) if (level / "package.xml").is_file()), None)
                levels = levels[: 1 if innermost is None else innermost + 2]
            near = _take_first(self._scan_folders(levels))
            self._workspace = {**deeper, **near, **self._scan_paths(), **self.explicit}
        return self._workspace

    def suggest_names(self, name: str, files: Collection[str] = ()) -> list[str]:
        """Return the names of packages in reach that are spelled like ``name`` and have one of these files.

        Without its files, a similar name is another package's; only a hyphen for an underscore and the case say enough.
        """
        names = self._list_similar_names(name)
        return [n for n in names if not files or _fold_name(n) == _fold_name(name) or self._has_any_file(n, files)]

    def _has_any_file(self, package: str, files: Iterable[str]) -> bool:
        folder = self.find(package)
        paths = [] if folder is None else [self.find_source(folder / name) for name in files]
        return any(self.can_open(path) and os.path.isfile(path) for path in paths)

    def _list_similar_names(self, name: str) -> list[str]:
        known = self.list_packages()
        alike = [k for k in sorted(known) if _fold_name(k) == _fold_name(name)]
        # Suffixes such as `_description` are common to all: the part before them must be similar.
        stem, suffix = _split_suffix(name)
        stems = {_split_suffix(k)[0]: k for k in sorted(known) if _split_suffix(k)[1] == suffix}
        import difflib

        close = [stems[s] for s in difflib.get_close_matches(stem, sorted(stems), n=3, cutoff=0.75)]
        # A suffix that is misspelt is none of these: then the part before it must be the same.
        first, _, last = name.rpartition("_")
        ends = {k.rpartition("_")[2]: k for k in sorted(known) if first and k.rpartition("_")[0] == first}
        spelt = [e for e in difflib.get_close_matches(last, sorted(ends), n=1, cutoff=SLIP_LIKENESS) if e in _SUFFIXES]
        return alike or close or [ends[end] for end in spelt]

    def find_package_of(self, path: Path) -> Package | None:
        """Return the package that a file belongs to: the nearest folder above it with a package.xml."""
        for folder in path.parents:
            if folder not in self._packages:
                manifest = os.path.join(folder, "package.xml")
                # In this order: most folders have none.
                readable = os.path.isfile(manifest) and self.can_open(Path(manifest))
                self._packages[folder] = load_package(folder) if readable else None
            package = self._packages[folder]
            if package is not None:
                return package
        return None

    def find_foreign_package(self, path: Path) -> Package | None:
        """Return the package that a file belongs to if it is another author's: of another project than the start, or a released
        one beside one that is not."""
        package, own = self.find_package_of(path), self.find_package_of(self.start.absolute() / "package.xml")
        if package is None or (own is not None and package.path == own.path):
            return None
        released = read_released_packages()
        is_released = package.name in released and (own is None or own.name not in released)
        projects = {self.find_project_above(folder.absolute() / "package.xml") for folder in (package.path, self.start)}
        is_outside = len(projects) > 1 and None not in projects
        return package if is_released or is_outside else None

    def find_source(self, path: Path) -> Path:
        """Return the file or folder that a path in a package means before the package is installed.

        That is what lies at the path, or else what the package's build installs there; the path itself if there is neither.
        """
        if os.path.lexists(path) or not self.can_open(path):
            return path
        return next(filter(os.path.exists, self._iter_installed_sources(path)), path)

    def _iter_installed_sources(self, path: Path) -> Iterator[Path]:
        """Yield the places from which a package's build may install something at a path, as far as they may be opened."""
        absolute = path.absolute()
        package = self.find_package_of(Path(os.path.normpath(absolute)))
        installed = None if package is None else self._read_installed(package)
        if package is None or installed is None or not absolute.is_relative_to(package.path):
            return
        for place in installed.resolve_path(absolute.relative_to(package.path).as_posix()):
            source = package.path / place
            if self.can_open(source):
                yield source

    def _read_installed(self, package: Package) -> InstalledFiles | None:
        """Return what the build of a package installs, from memory."""
        if package.path not in self._installed:

            def read_text(name: str) -> str | None:
                path = package.path / name
                try:
                    data = read_regular(path, LARGEST_BUILD_FILE) if self.can_open(path) else None
                except OSError:
                    return None
                return None if data is None else data.decode("utf-8-sig", "replace")

            self._installed[package.path] = read_installed_files(package.name, read_build_type(package.root), read_text)
        return self._installed[package.path]

    def resolve_resource(self, text: str, base: Path) -> Resource:
        """Parse a path of a model and look it up; a relative path starts at ``base`` (the folder of the file that names it)."""
        if (text, base) not in self._resources:
            self._resources[text, base] = self._parse_resource(text, base)
        return self._resources[text, base]

    def _parse_resource(self, text: str, base: Path) -> Resource:
        scheme = _SCHEME.match(text)
        if scheme and scheme.group(1) in {"package", "model"}:
            package, _, rest = scheme.group(2).partition("/")
            path = self._find_in_package(package, unquote(rest).lstrip("/"))
            return self._look_up_file(text, "package", path, package=package)
        if scheme and scheme.group(1) == "file":
            return self._look_up_file(text, "file", Path(unquote(scheme.group(2))))
        if scheme:
            return Resource(text=text, kind="other", package=None, path=None, exists=False)
        if text.startswith("~"):
            return self._look_up_file(text, "home", Path(expand_home(text)))
        if os.path.isabs(text) or re.match(r"^[A-Za-z]:[\\/]", text):
            return self._look_up_file(text, "absolute", Path(text))
        return self._look_up_file(text, "relative", base / text)

    def _look_up_file(self, text: str, kind: str, path: Path | None, *, package: str | None = None) -> Resource:
        if path is None:
            return Resource(text=text, kind=kind, package=package, path=None, exists=False)
        if not self.can_open(path):
            return Resource(text=text, kind=kind, package=package, path=path, exists=False, allowed=False)
        note_lookup(path)
        if kind == "package":
            path = self.find_source(path)
        try:
            exists = path.is_file()
        except (OSError, ValueError):  # the name is too long or contains a NUL
            return Resource(text=text, kind=kind, package=package, path=None, exists=False)
        actual = _find_actual_spelling(path)
        if actual is None and kind == "package":
            spellings = map(_find_actual_spelling, self._iter_installed_sources(path))
            actual = next((name for name in spellings if name is not None), None)
        # On a file system that ignores case, the file opens although its name differs.
        return Resource(
            text=text,
            kind=kind,
            package=package,
            path=path,
            exists=exists and (actual is None or actual == path.name),
            actual_spelling=actual,
        )


def load_package(folder: Path) -> Package | None:
    """Return the package at a folder; None without a package.xml. A broken manifest gives a package without root."""
    manifest = folder / "package.xml"
    if not manifest.is_file():
        return None
    shown = format_path(manifest)
    file: SourceFile | None = None
    try:
        file = SourceFile.read(manifest, shown)
        root = parse_xml(file)
    except (OSError, XmlError) as error:
        problem = Problem.from_read_error(error, "package", shown)
        return Package(name=folder.name, path=folder, root=None, file=file, problems=(problem,))
    name = root.find_child("name")
    return Package(name=name.text.strip() if name is not None else folder.name, path=folder, root=root, file=file)


def has_dependency_entry(folder: Path, package: str) -> bool:
    """Whether the package at a folder depends on another.

    The folder may be out of reach: only its package.xml is read, which was already read for the package's name.
    """
    manifest = folder / "package.xml"
    try:
        text = "" if manifest.is_symlink() else read_regular(manifest).decode("utf-8", "replace")
    except OSError:
        return False
    return re.search(rf"depend[^<>]*>\s*{re.escape(package)}\s*<", text) is not None


def _find_actual_spelling(path: Path) -> str | None:
    """Return the last parts of a path as they are spelled on disk if they differ only in case, else None.

    Compares folder by folder, so ``Meshes/Wheel.STL`` finds ``meshes/wheel.stl``.
    """
    try:
        if path.is_file() and path.name in os.listdir(path.parent):
            return path.name
        missing: list[str] = []
        folder = path
        while not folder.is_dir():
            missing.insert(0, folder.name)
            if folder.parent == folder or len(missing) > 8:
                return None
            folder = folder.parent
        spelled: list[str] = []
        for part in missing:
            match = [e for e in os.listdir(folder) if e.casefold() == part.casefold()]
            if len(match) != 1:
                return None
            spelled.append(match[0])
            folder = folder / match[0]
        return "/".join(spelled) if folder.is_file() else None
    except (OSError, ValueError):
        return None


def _take_first(folders: PackagesByName) -> dict[str, Path]:
    """Return the first folder of each name."""
    return {name: places[0] for name, places in folders.items() if places}


def _fold_name(name: str) -> str:
    """Return the name of a package in lower case with underscores for hyphens."""
    return name.replace("-", "_").lower()


def _split_suffix(name: str) -> tuple[str, str]:
    """Return a package's name without the suffix for its kind, and this suffix."""
    stem, _, suffix = name.rpartition("_")
    return (stem, suffix) if stem and suffix in _SUFFIXES else (name, "")
