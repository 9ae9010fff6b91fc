"""The mesh and texture files that an expanded model names."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.core.records import dataclass
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package, PackageFinder, Resource
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.package.similar_files import index_files
from urdfcheck.source.ros.dependencies import find_dependent_in_project
from urdfcheck.source.ros.mujoco_paths import describe_mujoco_path, is_found_by_mujoco
from urdfcheck.source.text.engine_reactions import describe_missing_mesh, describe_unread_visuals
from urdfcheck.source.text.grammar import CHILDREN, is_unexpanded
from urdfcheck.source.text.xml import Attribute, Definition, Element
from urdfcheck.source.xacro.usage import ARGUMENT
from urdfcheck.system.files import note_lookup, read_text_or_nothing

# What Bullet leaves out of a path.
_DROPPED_SCHEME = re.compile(r"^(?:package|model)://")
# What xacro makes of `package://NAME/file` in an include: a folder `package:` beside the file.
_ADDRESS = re.compile(r"(?:^|/)package:/+([^/]+)(/.+)$")
_ONE_SLASH = re.compile(r"^(package|model|file):/?(?=[^/])")
# A file of a package that is installed there, by a release of ROS or in a workspace.
_INSTALLED = re.compile(r".*/(?:opt/ros/\w+|install(?:/[^/]+)?|devel)/share/([^/]+)/(.+)")
# What a download of a branch has behind the name of the repository.
_BRANCH = re.compile(r"-(?:main|master|devel)$")
_COMPUTED = re.compile(r"\$\((?:find|dirname|cwd|env|optenv|eval)\b|abs_filename")


@dataclass(frozen=True, slots=True, eq=False)
class ResourceUse:
    """An attribute that names a file, and the file that it means."""

    attribute: Attribute
    resource: Resource

    @property
    def location(self) -> Location:
        return self.attribute.location

    def collect_definitions(self) -> tuple[Definition, ...]:
        """Return the definitions that the path was computed from."""
        return self.attribute.collect_definitions()


@lru_cache(maxsize=1)
def list_resource_uses(source: Source) -> tuple[ResourceUse, ...]:
    """Return every mesh and texture of the expanded model in document order; none if it could not be expanded.

    A path with an unexpanded substitution is left out: XML009 reports it, and what it means is unknown.
    """
    if source.root is None:
        return ()
    base, filenames = source.path.parent, [a for a in _find_filenames(source.root) if a.value.strip()]
    filenames = [a for a in filenames if not is_unexpanded(a.value)]
    return tuple(ResourceUse(a, source.finder.resolve_resource(a.value, base)) for a in filenames)


def names_gazebo_model(use: ResourceUse) -> bool:
    """Whether a path starts at a model of Gazebo, which is not a package of ROS."""
    return use.resource.text.lower().startswith("model://")


def normalize_spelling(text: str) -> str:
    """Return the portable spelling of a path: forward slashes, two of them after the scheme, no blanks around it."""
    plain = text.strip().replace("\\", "/")
    return _ONE_SLASH.sub(r"\1://", plain)


def is_misspelt(use: ResourceUse, source: Source) -> bool:
    """Whether a path leads nowhere and its spelling is not portable: then PKG011 reports the spelling first."""
    text = use.resource.text
    if use.resource.exists:
        return False
    return normalize_spelling(text) != text or find_first_file(text, source) is not None


def find_first_file(text: str, source: Source) -> str | None:
    """Return the first of several paths in one text (``a.stl OR b.stl``) that is a file."""
    words = text.split()
    found = (source.finder.resolve_resource(word, source.path.parent) for word in words if len(words) > 1)
    return next((one.text for one in found if one.exists and one.path is not None and one.path.is_file()), None)


def find_uninstalled_files(source: Source) -> dict[str, set[str]]:
    """Return the files that the model names in packages that are right and not installed here.

    Its own package depends on these, or xacro wrote the model with their names where they were installed.
    """
    declared = frozenset() if source.package is None else source.package.dependencies
    files: dict[str, set[str]] = {}
    for use in list_resource_uses(source):
        package = use.resource.package
        if not package or use.resource.path is not None:
            continue
        if package in declared or (source.package is None and _is_right_outside(package, use, source)):
            files.setdefault(package, set()).add(use.resource.text)
    return files


def _is_right_outside(package: str, use: ResourceUse, source: Source) -> bool:
    """Whether the name of a package is right in a model that is in none, and does not only mean a folder here."""
    if find_above(use, source) or find_in_project(use, source):
        return False
    is_recorded = source.is_output_of_xacro and is_released_elsewhere(source, package)
    return is_recorded or find_dependent_in_project(package, source.finder) is not None


def is_released_elsewhere(source: Source, package: str) -> bool:
    """Whether a package that a model names is a released one, and the model is in no package that could declare it."""
    return source.package is None and package in read_released_packages()


def find_machine_path(use: ResourceUse, source: Source) -> Attribute | Definition | None:
    """Return where a path of one machine was typed: the attribute, or the property or argument that it comes from.

    None for a path that any machine can open, and for one that xacro computes on each machine
    (``file://$(find pkg)/…``), or that begins with an argument that gets its value there.
    """
    if use.resource.kind not in {"absolute", "home", "file"}:
        return None
    definitions = use.attribute.collect_definitions()
    texts = {d: _read_definition(d, source) for d in definitions}
    if _COMPUTED.search(use.attribute.typed) or any(_COMPUTED.search(t) for t in texts.values()):
        return None
    read = {d.name for d in definitions if d.kind == "argument"}
    read.update(name for text in (use.attribute.typed, *texts.values()) for name in ARGUMENT.findall(text))
    if any(_is_given(name, use, source) for name in read):
        return None
    if use.attribute.typed.lstrip().startswith("$"):
        return next((d for d, t in texts.items() if t and use.attribute.value.startswith(t.strip())), use.attribute)
    return use.attribute


def split_machine_path(path: Path) -> list[str]:
    """Return the parts of a path of any machine without ``..``: ``car/../meshes`` is outside of car."""
    return posixpath.normpath(path.as_posix().replace("\\", "/")).split("/")


def find_in_package(path: Path, package: Package | None, finder: PackageFinder) -> str | None:
    """Return the file of a package that a path of another machine means, relative to the package, if any.

    What follows the name of the package in the path must be a file of the package here.
    """
    if package is None:
        return None
    parts = split_machine_path(path)
    for index, part in enumerate(parts[:-1]):
        inside = "/".join(parts[index + 1 :])
        place = package.path / inside
        is_named = part == package.path.name or drop_branch(part) == package.name
        if is_named and finder.can_open(place) and os.path.isfile(place):
            return inside
    return None


def drop_branch(folder: str) -> str:
    """Return the name of a folder without that of a branch, which a download of it has (``arm-master``)."""
    return _BRANCH.sub("", folder)


def find_in_named_package(path: Path, finder: PackageFinder) -> tuple[str, str] | None:
    """Return the package here that a path of another machine names, and the file of it behind the name; None without one."""
    packages, parts = finder.list_packages(), split_machine_path(path)
    for index in (i for i, part in enumerate(parts[:-1]) if part in packages):
        inside = "/".join(parts[index + 1 :])
        place = packages[parts[index]] / inside
        if finder.can_open(place) and os.path.isfile(place):
            return parts[index], inside
    return None


def find_installed_file(path: Path) -> tuple[str, str] | None:
    """Return the package and the file in it that a path names by a folder in which packages are installed."""
    found = _INSTALLED.match(path.as_posix())
    return None if found is None else (found[1], found[2])


def find_package_address(path: str) -> str | None:
    """Return how xacro names the file of a path in which it took ``package://NAME/…`` for folders: ``$(find NAME)/…``."""
    match = _ADDRESS.search(path.replace("\\", "/"))
    return None if match is None else f"$(find {match[1]}){match[2]}"


def find_missing_path(use: ResourceUse, source: Source) -> Path | None:
    """Return the path of a file that does not exist, or None if it exists or another rule reports why it is not found.

    PKG003 reports another spelling, PKG004 the path of one machine, and PKG012 a path out of reach. A folder may exist there.
    """
    resource = use.resource
    if resource.exists or resource.actual_spelling is not None or not resource.allowed:
        return None
    return resource.path if resource.path is not None and find_machine_path(use, source) is None else None


def find_search_root(use: ResourceUse, source: Source) -> Path:
    """Return the folder to search for files of the same name: the package that the path names, or that of the model."""
    package = use.resource.package
    folder = source.finder.find(package) if package else None
    if folder is not None:
        return folder
    return source.path.parent if source.package is None else source.package.path


def get_path_in_package(text: str, package: str) -> str:
    """Return the part of a path that follows the name of the package."""
    return text.partition("://")[2].removeprefix(package).lstrip("/")


def find_in_project(use: ResourceUse, source: Source) -> Path | None:
    """Return the file that a path in a package means in the model's own project, whatever package has the name."""
    inside = get_path_in_package(use.resource.text, use.resource.package or "")
    paths = (folder / inside for folder in source.finder.list_parent_folders())
    return next((path for path in paths if source.finder.can_open(path) and os.path.isfile(path)), None)


def describe_project_path(files: Iterable[Path], source: Source) -> str:
    """Say how programs find the files of a project that is not a package; the first of ``files`` is the example."""
    paths = list(files)
    own, mujoco = format_path_from_model(paths[0], source), describe_mujoco_path(paths, source)
    return f"write the path from this file, `{own}`, for programs without ROS{mujoco}; ROS needs a package.xml and its name"


def describe_namesakes(uses: Iterable[ResourceUse], source: Source) -> str:
    """Say before a repair how the files of these names in the model's package, or else in its repository, are written; empty
    unless each name is there once. A relative path stays one."""
    package = source.package
    folder = source.finder.find_repository() if package is None else package.path
    if folder is None or not source.finder.can_open(folder):
        return ""
    index = index_files([folder])
    paths = {use.resource.path.name: use.resource.kind for use in uses if use.resource.path is not None}
    found = [[path for path in index.get(name.lower(), []) if path.name == name] for name in paths]
    if not found or any(len(same) != 1 for same in found):
        return ""
    first, likewise = found[0][0], ", and the others likewise" if len(found) > 1 else ""
    inside = first.relative_to(folder).as_posix()
    is_plain = set(paths.values()) == {"relative"}
    own = format_path_from_model(first, source) if package is None or is_plain else f"package://{package.name}/{inside}"
    place = "project" if package is None else "package"
    return f"if {inside} of the {place} is the file that is meant, write `{own}`{likewise}; else "


def find_above(use: ResourceUse, source: Source) -> Path | None:
    """Return the file that a path without its scheme names in the model's folder or the nearest one above it that has it.

    None if there is none in reach, or the path is absolute.
    """
    if use.resource.kind not in {"package", "relative"}:
        return None
    inside = _DROPPED_SCHEME.sub("", use.resource.text).lstrip("/")
    for folder in source.path.absolute().parents:
        path = folder / inside
        if not source.finder.can_open(path):
            continue
        note_lookup(path)
        if os.path.isfile(path):
            return Path(os.path.normpath(path))
    return None


def format_path_from_model(path: Path, source: Source) -> str:
    """Return a file's path from the folder of the model, as a model names it."""
    return Path(os.path.relpath(path, source.path.absolute().parent)).as_posix()


def describe_missing_uses(uses: Iterable[ResourceUse], source: Source) -> dict[str, str]:
    """Describe what MuJoCo, yourdfpy, Bullet and MoveIt do with meshes that are not where their paths lead.

    Bullet drops the scheme and tries each path in every folder above the model (checked with PyBullet 3.2.7), and Pinocchio in
    each of package_dirs (checked with Pinocchio 4.1).
    """
    missing = list(uses)
    parts = [use.attribute.owner for use in missing]
    told = describe_missing_mesh(parts) | describe_unread_visuals(parts)
    if all(is_found_by_mujoco(use.resource.text, source) for use in missing):
        told["mujoco"] = "loads it: its <compiler> says where the files are"
    if all(find_above(use, source) for use in missing):
        return told | {
            "bullet": "loads it: it tries the paths in every folder above the model",
            "pinocchio": "refuses the geometry of the whole robot (ValueError), unless package_dirs have the folder that the "
            "paths start from",
        }
    if _is_only_folder_in_reach(source) and all(use.resource.kind in {"package", "relative"} for use in missing):
        return told | {"bullet": "loads it if a folder above has the files, otherwise refuses it"}
    return told


def _is_only_folder_in_reach(source: Source) -> bool:
    """Whether the model belongs to no repository or package that is known, so that its surroundings were not read."""
    levels = source.finder.list_parent_folders()
    is_repository = bool(levels) and (levels[-1] / ".git").exists()
    return (
        source.package is None
        and not is_repository
        and not source.finder.can_open(source.path.absolute().parent.parent)
    )


def _is_given(argument: str, use: ResourceUse, source: Source) -> bool:
    """Whether a path begins with the value of an argument that was given on the command line, or that the launch file which
    passes it computes (``$(find pkg)/…``)."""
    value = source.arguments.get(argument, "")
    text = use.attribute.value.strip().removeprefix("file://")
    if not text.startswith(value) or not (os.path.isabs(value) or value.startswith("~")):
        return False
    return _is_typed_nowhere(argument, source)


@lru_cache(maxsize=8)  # several rules ask for each of hundreds of meshes
def _is_typed_nowhere(argument: str, source: Source) -> bool:
    """Whether the launch file that passes an argument, if it is one, does not have its value."""
    found = source.found_arguments.get(argument)
    if found is None:
        return True
    return found.span is not None and source.arguments[argument] not in read_text_or_nothing(Path(found.span.file))


def _read_definition(definition: Definition, source: Source) -> str:
    span = definition.span
    file = None if span is None else source.files.get(span.file)
    return "" if span is None or file is None else file.text[span.start : span.end]


def _find_filenames(root: Element) -> Iterator[Attribute]:
    for element in root.walk():
        inside = element.parent.tag if element.parent is not None else ""
        if element.tag == "mesh" and (_is_stray_geometry(element.parent) or _follows_shape(element)):
            continue
        if (element.tag == "mesh" and inside == "geometry") or (element.tag == "texture" and inside == "material"):
            filename = element.attributes.get("filename")
            if filename is not None:
                yield filename


def _follows_shape(mesh: Element) -> bool:
    """Whether a geometry has another shape before a mesh: urdfdom reads the first one only (XML006)."""
    shapes = [] if mesh.parent is None else [one for one in mesh.parent.children if one.tag in CHILDREN["geometry"]]
    return mesh in shapes and shapes[0] is not mesh


def _is_stray_geometry(element: Element | None) -> bool:
    """Whether a geometry is directly in a link, where no parser reads it (XML003)."""
    return (
        element is not None
        and element.tag == "geometry"
        and element.parent is not None
        and element.parent.tag == "link"
    )
