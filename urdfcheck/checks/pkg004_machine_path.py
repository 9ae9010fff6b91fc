"""PKG004 reports paths of meshes and textures that only one machine can open."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import field
from functools import lru_cache
from pathlib import Path, PurePosixPath

from urdfcheck.core import Edit, Finding, Location, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_count, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.package.similar_files import index_files
from urdfcheck.source.resources import (
    ResourceUse,
    describe_namesakes,
    drop_branch,
    find_in_named_package,
    find_in_package,
    find_installed_file,
    find_machine_path,
    format_path_from_model,
    list_resource_uses,
    split_machine_path,
)
from urdfcheck.source.ros.dependencies import describe_declaration
from urdfcheck.source.ros.mujoco_paths import describe_mujoco_path, takes_no_packages
from urdfcheck.source.text.engine_reactions import describe_missing_mesh, describe_unread_visuals, name_lost_shapes
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.uses_elsewhere import (
    CONTAINER_FILE,
    KEPT_ASIDE,
    SCRIPT_SUFFIXES,
    explain_kept_file,
    is_kept_output,
    iter_project_files,
)
from urdfcheck.system.observing.questions import note_content


@dataclass(slots=True, eq=False)
class _MachinePath:
    """A text with the path of one machine, or texts with paths into one folder of it, and the files that they name."""

    location: Location
    uses: list[ResourceUse] = field(default_factory=list)


_KINDS = {
    "absolute": ("an absolute path", "absolute paths"),
    "file": ("a file:// path", "file:// paths"),
    "home": ("a path in the home folder", "paths in the home folder"),
}
# A file:// URI with a folder where the name of a machine belongs. `file://C:/` names a drive, `file://home/ann` lacks a slash.
_HOST = re.compile(r"file://(?!(?:localhost|home|mnt|media|opt|root|tmp|usr|Users|var|workspaces?)/)([^/\\:~$]+)/")
# What examples have where a user is to write a folder.
_PLACEHOLDER = re.compile(r"/(?:path/to|(?:absolute|full|your)[_-]path)/", re.IGNORECASE)
# Folders at the top of the file system in which users have files. Another one is made for a project, as in an image of Docker.
_OF_USERS = frozenset({"Users", "Volumes", "home", "media", "mnt", "opt", "private", "root", "tmp", "usr", "var"})
# Where the packages of a release of ROS are installed.
_RELEASED = "/opt/ros/"
# A released name of one word (robot, urdf) is as often a folder of another kind.
_OF_SEVERAL_WORDS = "_"
# So many files of one package are those that are meant: fewer of these names (`meshes/base_link.stl`) many packages have.
_LEAST_FILES = 3
# So many outer folders (/, home, ann) are one place of a machine: what one author's tool wrote is one cause.
_OUTER_FOLDERS = 3


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    places: dict[object, _MachinePath] = {}
    for use in list_resource_uses(source):
        typed = find_machine_path(use, source)
        if typed is None:
            continue
        at = Location(use.location.subject, typed.span, use.location.via)
        # Paths from one definition are one cause, and so are the texts that name files in one place.
        key = _find_place(use) if typed is use.attribute else typed.span
        places.setdefault(key, _MachinePath(at)).uses.append(use)
    for place in places.values():
        yield _build_finding(place, source, rule)


def _find_place(use: ResourceUse) -> tuple[object, ...]:
    """Return the outer folders of a path, with what else belongs to one cause."""
    resource = use.resource
    parts = () if resource.path is None else resource.path.parts[:-1]
    return (*parts[:_OUTER_FOLDERS], resource.kind, _choose_message(use))


def _choose_message(use: ResourceUse) -> str:
    if _HOST.match(use.resource.text):
        return "host"
    if _find_installed_path(use) and str(use.resource.path).startswith(_RELEASED):
        return "installed"
    if _PLACEHOLDER.search(use.resource.text.replace("\\", "/")) and not use.resource.exists:
        return "placeholder"
    return "unread" if not use.resource.allowed else "here-only" if use.resource.exists else "nowhere"


def _build_finding(place: _MachinePath, source: Source, rule: Rule) -> Finding:
    first = place.uses[0]
    portable = [_build_portable_path(use, source) for use in place.uses]
    files = list(dict.fromkeys(u.resource.text for u in place.uses))
    message = _choose_message(first)
    host = _HOST.match(first.resource.text)
    parts = [use.attribute.owner for use in place.uses]
    is_lost = message in {"host", "nowhere", "placeholder"} or (message == "installed" and not first.resource.exists)
    return rule.finding(
        message,
        at=place.location,
        severity=_get_severity(message, first, source),
        related={u.attribute.span: u for u in place.uses if u.attribute.span != place.location.span}.values(),
        edits=[]
        if message == "installed" or _describe_for_mujoco(portable, source)
        else _propose_edits(place, portable),
        consequences=describe_missing_mesh(parts) | describe_unread_visuals(parts) if is_lost else None,
        lost=name_lost_shapes(parts),
        file=first.resource.text,
        files=files,
        listed=join_names(files, 2),
        host="" if host is None else host[1],
        kind=_KINDS[first.resource.kind][len(files) > 1],
        exist="exist" if len(files) > 1 else "exists",
        lack="do not exist" if len(files) > 1 else "does not exist",
        amount=format_count(len(files), "file is", "files are"),
        repair=_describe_repair(message, place, portable, source),
    )


def _find_installed_path(use: ResourceUse) -> str | None:
    """Return the package path of a file in a folder where a release of ROS, or a workspace, has installed a package."""
    found = None if use.resource.path is None else find_installed_file(use.resource.path)
    return None if found is None else f"package://{found[0]}/{found[1]}"


def _get_severity(message: str, use: ResourceUse, source: Source) -> Severity | None:
    # For one release a robot may be expanded on purpose.
    if explain_kept_file(source) == KEPT_ASIDE or (message == "installed" and is_kept_output(source)):
        return Severity.INFO
    may_be_right = message in {"unread", "here-only"} and _is_place_of_project(use, source)
    return Severity.WARNING if message == "installed" or may_be_right else None


def _is_place_of_project(use: ResourceUse, source: Source) -> bool:
    """Whether scripts of the project, or files that make an image, name the same folder at the top of the file system, and users
    have no files in it: the project may be meant to be there."""
    path = use.resource.path
    if path is None or not path.is_absolute() or path.parts[1] in _OF_USERS:
        return False
    place = re.compile(rf"(?<![\w./~}}:]){re.escape('/' + path.parts[1])}(?![\w.-])")
    return any(place.search(text) for _, text in iter_project_files(source, SCRIPT_SUFFIXES, named=CONTAINER_FILE))


def _find_path_of_other(use: ResourceUse, source: Source) -> str | None:
    """Return the package path of a file in an installed package, or below the name of a dependency or a released package.

    None where the model's own package has that name: the file belongs there.
    """
    path, own = use.resource.path, source.package
    installed = _find_installed_path(use)
    if installed is not None or path is None:
        return None if own is not None and (installed or "").startswith(f"package://{own.name}/") else installed
    *parts, name = split_machine_path(path)
    declared = frozenset[str]() if own is None else own.dependencies
    released = {part for part in parts if _OF_SEVERAL_WORDS in part} & read_released_packages()
    # The last one, with a folder of its own between it and the file.
    named = [i for i, part in enumerate(parts[:-1]) if part in declared | released]
    if not named or (own is not None and parts[named[-1]] == own.name):
        return None
    folder = source.finder.find(parts[named[-1]])
    place = None if folder is None else folder.joinpath(*parts[named[-1] + 1 :], name)
    if place is not None and source.finder.can_open(place) and not os.path.isfile(place):
        return None  # the package is here, and lacks the file
    return f"package://{'/'.join((*parts[named[-1] :], name))}"


def _build_portable_path(use: ResourceUse, source: Source) -> str | None:
    """Return the package path of a file, or None for one that is in no package here; the path from the model if it is for MuJoCo.

    The path may be that of another machine: what follows the name of a package there, the model's own first, is then a file of
    that package here.
    For a model without a package, it is that of the package around the file, or else the path from the model's folder.
    """
    package, path = source.package, use.resource.path
    if path is None:
        return None
    if package is None:
        own = _find_by_ending(use, path, source)
        around = None if own is None else source.finder.find_package_of(own)
        if own is None or around is None or not around.name:
            return None if own is None else format_path_from_model(own, source)
        return f"package://{around.name}/{own.relative_to(around.path).as_posix()}"
    if use.resource.exists:
        try:
            return f"package://{package.name}/{path.resolve().relative_to(package.path.resolve()).as_posix()}"
        except ValueError:
            return None
    inside = find_in_package(path, source.package, source.finder) or _find_behind_slash(path, source)
    named = (package.name, inside) if inside is not None else find_in_named_package(path, source.finder)
    if named is None:
        return None
    folder = package.path if named[0] == package.name else source.finder.find(named[0])
    if folder is not None and use.resource.kind == "absolute" and takes_no_packages(source):
        return format_path_from_model(folder / named[1], source)
    return f"package://{named[0]}/{named[1]}"


def _find_outer_file(uses: Sequence[ResourceUse], source: Source) -> str:
    """Return the path from the model of a file around its package to which a path leads by ``..``; empty for another path."""
    path = uses[0].resource.path
    found = None if path is None or ".." not in path.parts else _find_by_ending(uses[0], path, source)
    return "" if found is None else format_path_from_model(found, source)


def _find_behind_slash(path: Path, source: Source) -> str | None:
    """Return the file of the model's package that a path names from there, with a slash before it (``/meshes/base.stl``)."""
    inside = path.as_posix().lstrip("/")
    place = None if source.package is None else source.package.path / inside
    return inside if place is not None and source.finder.can_open(place) and os.path.isfile(place) else None


def _find_by_ending(use: ResourceUse, path: Path, source: Source) -> Path | None:
    """Return the file that the end of a path, a folder and a name at least, names in the model's folder or in one around it."""
    *parents, name = split_machine_path(path)
    for folder in _list_folders_by_ending(tuple(parents), source.finder):
        place = folder / name
        if source.finder.can_open(place) and os.path.isfile(place):
            return place if not use.resource.exists or _is_same_file(place, path) else None
    return None


@lru_cache(maxsize=16)  # most files of a model are in a few folders
def _list_folders_by_ending(parents: tuple[str, ...], finder: PackageFinder) -> list[Path]:
    """Return the folders that the end of a path names in the model's folder or in one around it, the longest end first."""
    levels = finder.list_parent_folders()
    places = (around.joinpath(*parents[start:]) for start in range(1, len(parents)) for around in levels)
    return [place for place in places if finder.can_open(place) and os.path.isdir(place)]


def _is_same_file(first: Path, second: Path) -> bool:
    for path in (first, second):
        note_content(path, path.stat())  # whose inode decides
    return os.path.samefile(first, second)


def _describe_repair(message: str, place: _MachinePath, portable: Sequence[str | None], source: Source) -> str:
    """Say what to write, or to copy the files first."""
    likewise = ", and the others likewise"
    several = len({use.resource.text for use in place.uses}) > 1
    paths = [path for path in portable if path is not None]
    if len(paths) == len(portable) and message != "installed":
        owner = "the package has the file" if paths[0].startswith("package://") else "the file is there"
        mujoco = _describe_for_mujoco(portable, source)
        return f"write `{paths[0]}`{likewise if len(set(paths)) > 1 else ''}: {owner}{mujoco}"
    others = [path or _find_path_of_other(use, source) for use, path in zip(place.uses, portable, strict=True)]
    if None not in others:
        named = dict.fromkeys(
            path.split("/")[2] for path in others if path is not None and path.startswith("package://")
        )
        declare = "".join(describe_declaration(source.package, name, source.finder) for name in named)
        return f"write `{others[0]}`{likewise if several else ''}{declare}"
    # A path may name another package, which has some of the files.
    owners = {path.split("/")[2] for path in paths if path.startswith("package://")}
    future = [_find_future_path(use, source, owners) for use in place.uses]
    meant = [here or ahead for here, ahead in zip(others, future, strict=True)]
    if paths and None not in meant:
        lacking = [str(ahead) for ahead, here in zip(future, others, strict=True) if here is None]
        names = join_names(list(dict.fromkeys(path.rpartition("/")[2] for path in lacking)), 3)
        elsewhere = {str(path).split("/")[2] for path in others if path not in {None, *paths}}
        both = sorted(owners | elsewhere)
        declare = "".join(describe_declaration(source.package, name, source.finder) for name in both)
        has = f"{names} must be added" if elsewhere else f"the package has them, except {names}, which must be added"
        return f"write `{paths[0]}`, and the others likewise{declare}: {has}"
    if source.package is None:
        files = "the files" if several else "the file"
        name = "FILE" if several else PurePosixPath(place.uses[0].resource.text.replace("\\", "/")).name
        folder = f"copy {files} into a folder beside the model and write the path from there (`meshes/{name}`)"
        return f"{folder}; for ROS, into a package and write its package path"
    outer = _find_outer_file(place.uses, source)
    written = _format_future_path(future, place.uses, source)
    what = "files" if several and (outer or "likewise" not in written) else "file"
    if outer:
        what += f" ({'the first is ' if several else ''}`{outer}` from the model)"
    repair = f"copy the {what} into the model's package and write {written}"
    return f"{describe_namesakes(place.uses, source) or _describe_sibling(place.uses, source)}{repair}"


def _describe_sibling(uses: Sequence[ResourceUse], source: Source) -> str:
    """Say before a repair that one other package of the project has most of the files, in folders of the same names."""
    paths = list(dict.fromkeys(use.resource.path for use in uses if use.resource.path is not None))
    own = source.package
    if own is None or len(paths) < _LEAST_FILES:
        return ""
    packages = {name: f for name, f in source.finder.list_workspace_packages().items() if name != own.name}
    index = index_files(packages.values())
    having: dict[str, dict[Path, str]] = {}
    for path in paths:
        ending = split_machine_path(path)[-2:]
        for place in index.get(ending[-1].lower(), ()):
            around = source.finder.find_package_of(place) if list(place.parts[-2:]) == ending else None
            if around is not None and around.name in packages and source.finder.can_open(place):
                having.setdefault(around.name, {}).setdefault(path, place.relative_to(around.path).as_posix())
    having = {name: f for name, f in having.items() if len(f) >= _LEAST_FILES and 2 * len(f) > len(paths)}
    if len(having) != 1:
        return ""
    ((name, files),) = having.items()
    are = "all" if len(files) == len(paths) else f"{len(files)} of {len(paths)}"
    declare = describe_declaration(own, name, source.finder)
    first = next(iter(files.values()))
    write = f"write `package://{name}/{first}`, and the others likewise{declare}"
    return f"if those of {name} are meant, which has {are}, {write}; else "


def _describe_for_mujoco(portable: Sequence[str | None], source: Source) -> str:
    """Say what MuJoCo needs with paths from the model: before an absolute path it puts nothing."""
    files = [source.path.absolute().parent / path for path in portable if path is not None and "://" not in path]
    return describe_mujoco_path(files, source) if files else ""


def _find_future_path(use: ResourceUse, source: Source, owners: Collection[str]) -> str | None:
    """Return the package path of a file once it is in the model's package, or in one that has others of its files (``owners``):
    what the typed path has behind its name."""
    path, package = use.resource.path, source.package
    if path is None or package is None:
        return None
    parts = split_machine_path(path)
    names = [drop_branch(part) if drop_branch(part) == package.name else part for part in parts]
    before = [index for index, name in enumerate(names[:-1]) if name == package.name or name in owners]
    return f"package://{'/'.join(names[before[-1] :])}" if before else None


def _format_future_path(future: Sequence[str | None], uses: Sequence[ResourceUse], source: Source) -> str:
    """Return what to write for the first file once it is in the model's package."""
    package, path = source.package, uses[0].resource.path
    if package is None or path is None:
        return "its path in the package"
    several = len({use.resource.text for use in uses}) > 1
    if future[0] is not None and None not in future:
        return f"`{future[0]}`" + (", and the others likewise" if several else "")
    return f"`package://{package.name}/meshes/{'FILE' if several else path.name}`"


def _propose_edits(place: _MachinePath, portable: Sequence[str | None]) -> list[Edit]:
    """Return the edits that write a package path for each use; none where one of them has no such path."""
    edits: dict[Edit, None] = {}
    for use, path in zip(place.uses, portable, strict=True):
        if path is None:
            return []
        edits |= dict.fromkeys(build_replacement_edits([use.attribute], path))
    return list(edits)
