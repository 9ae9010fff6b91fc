"""PKG002 reports mesh files of a model that do not exist."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path, PurePosixPath

from urdfcheck.core import Edit, Finding, Location, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_choices, format_count, join_names
from urdfcheck.source.launch.built_files import describe_making_build, is_git_ignored
from urdfcheck.source.load import Source
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES
from urdfcheck.source.package.finder import Package, format_path
from urdfcheck.source.package.similar_files import (
    MOVED,
    FilesByName,
    describe_uninstalled_file,
    find_moved_files,
    find_similar_name,
    find_uninstalled_file,
    index_files,
    is_called_as_any,
    is_in_folder_of_another,
    is_of_variant,
    list_missing_submodules,
    normalise_path,
    propose_download,
    select_python_data,
    split_folder_words,
)
from urdfcheck.source.path_arguments import (
    find_missing_part,
    list_other_values,
    list_path_arguments,
    select_guilty,
)
from urdfcheck.source.reach import FileReach
from urdfcheck.source.resources import (
    ResourceUse,
    describe_missing_uses,
    describe_project_path,
    find_above,
    find_in_project,
    find_missing_path,
    find_search_root,
    format_path_from_model,
    get_path_in_package,
    is_misspelt,
    list_resource_uses,
    names_gazebo_model,
)
from urdfcheck.source.ros.dependencies import describe_declaration
from urdfcheck.source.ros.gazebo_paths import GazeboFolder, select_on_gazebo_path
from urdfcheck.source.ros.mujoco_paths import (
    describe_mujoco_path,
    find_for_mujoco,
    is_found_by_mujoco,
    takes_only_names,
)
from urdfcheck.source.text.engine_reactions import describe_missing_mesh, describe_unread_visuals, name_lost_shapes
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import flatten_definitions
from urdfcheck.source.uses_elsewhere import (
    explain_kept_file,
    find_fetching_script,
    find_filling_script,
    find_replacing_script,
    is_lost_to_others,
    iter_user_texts,
)

_REPAIRS = {
    "file": "correct the path, or add the file",
    "several": "correct the path, or add the files",
    "folder": "correct the path, or add the folder with its files",
}


# Formats of OpenSceneGraph, which of the robot programs UWSim alone reads.
_OSG_SUFFIXES = frozenset({".osg", ".osgb", ".osgt", ".ive"})
# What is to be filled in by hand: `ABSOLUTE_PATH_TO_MESHES`, `<mesh folder>`.
_PATH_PLACEHOLDER = re.compile(r"(?:[A-Z]+_)*(?:PATH|PLACEHOLDER)(?:_[A-Z]+)*|<[^<>]+>|\{[^{}]+\}|@\w+@|%\(\w+\)s")
# Those of the two kinds of shapes.
_DRAWN, _TOUCHED = frozenset({"vis", "visual", "visuals"}), frozenset({"col", "collision", "collisions"})


@dataclass(slots=True, eq=False)
class _MissingFiles:
    """The files that are missing for one reason: one file, or all files below a folder that does not exist."""

    path: Path
    """The first missing file."""
    folder: Path | None
    files: dict[Path, str] = field(default_factory=dict)
    """The paths, each with its text."""
    uses: list[ResourceUse] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    missing: list[tuple[ResourceUse, Path]] = []
    special: dict[Path, list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        path = (
            find_missing_path(use, source)
            if use.attribute.owner.tag == "mesh" and not is_misspelt(use, source)
            else None
        )
        if path is None:
            continue
        if path.exists():
            special.setdefault(normalise_path(path), []).append(use)
        else:
            missing.append((use, path))
    for place, found in special.items():
        what = "a folder" if place.is_dir() else "a pipe, a socket or a device"
        parts = [use.attribute.owner for use in found]
        yield rule.finding(
            "kind",
            at=found[0],
            related=found[1:],
            consequences=describe_missing_mesh(parts) | describe_unread_visuals(parts),
            lost=name_lost_shapes(parts),
            path=format_path(place),
            what=what,
        )
    found_by_one = {use for use, _ in missing if _is_for_mujoco(use, source)}
    if found_by_one:
        yield _build_mujoco_finding([use for use, _ in missing if use in found_by_one], rule, source)
    for uses, gazebo in _list_uses_on_gazebo_path((use for use, _ in missing), source):
        found_by_one.update(uses)
        yield _build_gazebo_finding(uses, gazebo, rule, source)
    missing = [(use, path) for use, path in missing if use not in found_by_one]
    if not missing:
        return
    index = index_files({find_search_root(use, source) for use, _ in missing})
    by_package: dict[str, list[tuple[ResourceUse, Path]]] = {}
    for use, path in missing:
        by_package.setdefault(use.resource.package or "", []).append((use, path))
    for name, absent in by_package.items():
        package = source.finder.find_package_of(normalise_path(absent[0][1])) if name else None
        data = select_python_data((path for _, path in absent), package, index, source.finder)
        inside = [(use, path) for use, path in absent if path in data]
        if inside:
            yield _build_python_finding(inside, name, rule)
        missing = [(use, path) for use, path in missing if path not in data]
    moved = find_moved_files({normalise_path(path) for _, path in missing}, index)
    for gap in _group_missing_files(missing):
        yield _build_finding(gap, index, rule, source, moved=moved)


def _is_for_mujoco(use: ResourceUse, source: Source) -> bool:
    """Whether a path is typed for MuJoCo, which finds it in the folder of its <compiler>: a path that begins with another folder
    than that, or with a package, is for other programs too."""
    strips = source.root is not None and takes_only_names(source.root)
    is_plain = use.resource.kind == "relative" and not (strips and "/" in use.resource.text)
    return is_plain and is_found_by_mujoco(use.resource.text, source)


def _build_mujoco_finding(uses: list[ResourceUse], rule: Rule, source: Source) -> Finding:
    """Report all files that only MuJoCo finds, by its own options."""
    files = {use.resource.text: find_for_mujoco(use.resource.text, source) for use in uses}
    first = next(iter(files.values()))
    folder = format_path_from_model(first.parent, source)
    own = format_path_from_model(first, source)
    return rule.finding(
        "mujoco-path",
        at=uses[0],
        related={use.attribute.span: use for use in uses if use.attribute.span != uses[0].attribute.span}.values(),
        severity=Severity.WARNING,
        consequences=describe_missing_uses(uses, source),
        lost=name_lost_shapes(use.attribute.owner for use in uses),
        files=list(files),
        amount=format_count(len(files), "mesh file"),
        listed=join_names(list(files), 4),
        folder=folder,
        repair=f"write `{own}`{'' if len(files) == 1 else ', and the others likewise'}"
        f"{describe_mujoco_path(files.values(), source)}",
    )


def _list_uses_on_gazebo_path(
    missing: Iterable[ResourceUse], source: Source
) -> Iterator[tuple[list[ResourceUse], GazeboFolder]]:
    """Yield the uses of each package that mean models of Gazebo in a folder to which a file of the project leads it.

    Gazebo tries each folder of its path; the package may have the name of such a model.
    """
    by_package: dict[str, dict[str, list[ResourceUse]]] = {}
    for use in filter(names_gazebo_model, missing):
        name = use.resource.package or ""
        path = f"{name}/{get_path_in_package(use.resource.text, name)}"
        by_package.setdefault(name, {}).setdefault(path, []).append(use)
    if source.package is None:
        return
    for named in by_package.values():
        found = select_on_gazebo_path(source.package.path, iter_user_texts(source), list(named))
        if found is not None:
            place, paths = found
            yield [use for path, uses in named.items() if path in paths for use in uses], place


def _build_gazebo_finding(uses: list[ResourceUse], place: GazeboFolder, rule: Rule, source: Source) -> Finding:
    """Report all files that only Gazebo finds, on the path that a file of the project sets."""
    files = list(dict.fromkeys(use.resource.text for use in uses))
    file = place.folder / get_path_in_package(files[0], "")
    package = source.finder.find_package_of(file) or source.package
    return rule.finding(
        "gazebo-path",
        at=uses[0],
        related={use.attribute.span: use for use in uses if use.attribute.span != uses[0].attribute.span}.values(),
        severity=Severity.WARNING
        if is_lost_to_others({use.attribute.owner for use in uses}, source)
        else Severity.INFO,
        lost=name_lost_shapes(use.attribute.owner for use in uses),
        folder=format_path(place.folder),
        setter=place.file.name,
        variable=place.variable,
        address="" if package is None else f"package://{package.name}/{file.relative_to(package.path).as_posix()}",
        files=files,
        amount=format_count(len(files), "mesh file"),
        listed=join_names(list(dict.fromkeys(PurePosixPath(text).name for text in files)), 4),
    )


def _build_python_finding(uses: list[tuple[ResourceUse, Path]], package: str, rule: Rule) -> Finding:
    """Report all files that are installed in the Python package of this name only."""
    (at, first), files = uses[0], {path: use.resource.text for use, path in uses}
    parts = [use.attribute.owner for use, _ in uses]
    return rule.finding(
        "python-data",
        at=at,
        related={use.attribute.span: use for use, _ in uses if use.attribute.span != at.attribute.span}.values(),
        severity=Severity.WARNING,
        consequences=describe_unread_visuals(parts),
        lost=name_lost_shapes(parts),
        package=package,
        path=format_path(first),
        files=list(files.values()),
        amount=format_count(len(files), "mesh file is", "mesh files are"),
        listed=join_names((path.name for path in files), 4),
    )


def _group_missing_files(missing: Iterable[tuple[ResourceUse, Path]]) -> list[_MissingFiles]:
    """Return one gap for each missing folder or file; files that one text names through a macro belong together."""
    by_cause: dict[Path, _MissingFiles] = {}
    by_span: dict[object, _MissingFiles] = {}
    gaps: list[_MissingFiles] = []
    for use, typed in missing:
        path = normalise_path(typed)
        folder = _find_missing_folder(path)
        cause, span = folder or path, use.attribute.span
        gap = by_cause.get(cause) or (by_span.get(span) if span is not None else None)
        if gap is None:
            gap = _MissingFiles(typed, folder)
            gaps.append(gap)
        by_cause[cause] = by_span[span] = gap
        gap.files.setdefault(path, use.resource.text)
        gap.uses.append(use)
    return gaps


def _find_missing_folder(path: Path) -> Path | None:
    """Return the outermost folder of a path that does not exist."""
    return next((folder for folder in reversed(path.parents) if not folder.is_dir()), None)


def _build_finding(
    gap: _MissingFiles, index: FilesByName, rule: Rule, source: Source, *, moved: Mapping[Path, Path]
) -> Finding:
    at, path = gap.uses[0], gap.path
    related = {use.attribute.span: use for use in gap.uses if use.attribute.span != at.attribute.span}
    package = source.finder.find_package_of(normalise_path(path)) if at.resource.package else None
    elsewhere = find_uninstalled_file(path, package, index)
    similar = moved.get(normalise_path(path))
    if similar is not None and _is_for_other_shapes(path, similar):
        similar = _find_other_format(path) or similar
    owners = [] if similar or elsewhere else _find_owner(gap, source)
    similar_files = [similar] if similar else [] if owners else _find_similar_files(normalise_path(path), index, source)
    near = [format_path(one) for one in ([elsewhere] if elsewhere else similar_files)] + owners
    argued, places = _explain_by_argument(gap, source)
    outside = {} if argued or elsewhere else _find_outside(gap, source)
    here = {} if argued or elsewhere or similar_files or owners or outside else _find_files_here(gap, source)
    own = format_path_from_model(next(iter(outside.values())), source) if outside else ""
    mujoco = describe_mujoco_path(outside.values(), source) if outside else ""
    lacking = _list_lacking(outside, gap) if outside else []
    add = f"; add {join_names(lacking, 3)} there too" if lacking else ""
    is_explained = bool(argued or outside or elsewhere or near or here)
    beside, repair_beside = ("", "") if is_explained else _describe_place_of_part(gap, source)
    # No program of the robot loads such a model, as in PKG001.
    other_program, program_repair = ("", "") if is_explained or beside else _explain_by_other_program(gap, source)
    kept = "" if is_explained or beside or other_program else explain_kept_file(source)
    made = "" if is_explained or beside else _describe_making(gap, package, source)
    download = "" if is_explained or beside or gap.folder is None else propose_download(gap.folder.name, source.finder)
    hint = argued or (
        _describe_place(outside, gap, source)
        if outside
        else describe_uninstalled_file(elsewhere)
        if elsewhere
        else _describe_other_package(package, here, source)
        if package is not None and here
        else f" (did you mean the package {join_names(owners)}, which has them?)"
        if owners
        else f" (did you mean {join_names(near, 2)}?)"
        if near
        else beside or other_program
    )
    message = "folder" if gap.folder is not None else "file" if len(gap.files) == 1 else "several"
    return rule.finding(
        message,
        at=at,
        related=[*related.values(), *places],
        severity=Severity.INFO if kept or made or other_program else Severity.WARNING if download else None,
        edits=[] if mujoco or lacking else _propose_edits(outside, source),
        consequences=describe_missing_uses(gap.uses, source),
        lost=name_lost_shapes(use.attribute.owner for use in gap.uses),
        repair=f"write `{own}`{'' if len(outside) == 1 else ', and the others likewise'}{add}{mujoco}"
        if own
        else describe_project_path(here.values(), source)
        if here
        else _describe_owner(gap, owners, source)
        or _describe_checkout(gap, source)
        or repair_beside
        or program_repair
        or made
        or download
        or _describe_version(gap, source)
        or _describe_placeholder(gap)
        or f"{_REPAIRS[message]}{_describe_ignored(gap)}",
        files=list(gap.files.values()),
        amount=format_count(len(gap.files), "mesh file"),
        path=format_path(path),
        name=path.name,
        listed=join_names((missing.name for missing in gap.files), 4),
        links=list(dict.fromkeys(_find_link_name(use) for use in gap.uses)),
        near=near,
        hint=f"{hint}; {kept}" if kept else hint,
        folder=format_path(gap.folder or path.parent),
    )


def _find_owner(gap: _MissingFiles, source: Source) -> list[str]:
    """Return the only other package that has all files of a missing folder at the same paths, by its name.

    One file of such a path may be another robot's, several are the robot's own.
    """
    named = [use.resource for use in gap.uses if use.resource.package]
    if gap.folder is None or len(named) < len(gap.uses) or len(gap.files) < MOVED:
        return []
    inside = {get_path_in_package(resource.text, resource.package or "") for resource in named}
    own = {resource.package for resource in named}
    owners = [
        name
        for name, folder in source.finder.list_packages().items()
        if name not in own
        and all(source.finder.can_open(f) and f.is_file() for f in (folder / path for path in inside))
    ]
    return owners if len(owners) == 1 else []


def _find_files_here(gap: _MissingFiles, source: Source) -> dict[str, Path]:
    """Return for each path the file that it means in the model's own project, where a package elsewhere has its name.

    Empty unless all are there, or the model is in that package itself.
    """
    found = {use.resource.text: find_in_project(use, source) for use in gap.uses if use.resource.package}
    here = {text: path for text, path in found.items() if path is not None}
    return here if source.package is None and len(here) == len(gap.files) else {}


def _describe_other_package(package: Package, here: Mapping[str, Path], source: Source) -> str:
    folders = dict.fromkeys(format_path_from_model(path.parent, source) for path in here.values())
    what = "the file" if len(here) == 1 else "the files"
    return f"; the package {package.name} that is found is another project, and this one has {what} in {join_names(folders, 2)}"


def _find_outside(gap: _MissingFiles, source: Source) -> dict[ResourceUse, Path]:
    """Return the files that relative paths name from a folder above the model's, where Bullet finds them.

    Empty unless all are there, or most of several: then the others are missing there too.
    """
    found = {use: find_above(use, source) for use in gap.uses if use.resource.kind == "relative"}
    there = {use: path for use, path in found.items() if path is not None}
    texts = {use.resource.text for use in there}
    are_most = len(texts) >= MOVED and 2 * len(texts) > len(gap.files)
    return there if len(there) == len(gap.uses) or are_most else {}


def _list_lacking(outside: Mapping[ResourceUse, Path], gap: _MissingFiles) -> list[str]:
    """List the names of the files that are not among those in a folder above the model's."""
    there = {use.resource.text for use in outside}
    return [path.name for path, text in gap.files.items() if text not in there]


def _describe_place(outside: Mapping[ResourceUse, Path], gap: _MissingFiles, source: Source) -> str:
    folders = dict.fromkeys(format_path_from_model(path.parent, source) for path in outside.values())
    count = len(set(outside.values()))
    what = f"{count} of them are" if _list_lacking(outside, gap) else "it is" if count == 1 else "they are"
    return f" (from the model's folder {what} in {join_names(folders, 2)})"


def _describe_place_of_part(gap: _MissingFiles, source: Source) -> tuple[str, str]:
    """Say that relative paths in an included file start at the model's folder, where they lead to a folder from the file's own.

    With the repair; both empty for all others.
    """
    folders: dict[Path, None] = {}
    parts: dict[str, None] = {}
    there: dict[Path, bool] = {}
    for use in gap.uses:
        span = use.attribute.span
        file = None if span is None else source.files.get(span.file)
        if file is None or use.resource.kind != "relative":
            return "", ""
        own = file.path.absolute().parent
        folder = normalise_path(own / use.resource.text).parent
        is_other = normalise_path(own) != normalise_path(source.path.absolute().parent)
        if not is_other or not source.finder.can_open(folder) or not folder.is_dir():
            return "", ""
        folders[folder] = parts[file.name] = None
        meant = normalise_path(own / use.resource.text)
        there[meant] = meant.is_file()
    subject, lead = ("the path starts", "it leads") if len(gap.files) == 1 else ("the paths start", "they lead")
    exist = "which exists" if len(folders) == 1 else "which exist"
    places = join_names(map(format_path, folders), 2)
    hint = f"; {subject} at the model's folder; from that of {join_names(parts, 2)} {lead} to {places}, {exist}"
    folder = next(iter(folders))
    package = source.finder.find_package_of(folder)
    if package is None:
        return hint, ""
    meant = next(iter(there))
    address = f"package://{package.name}/{Path(os.path.relpath(meant, package.path.absolute())).as_posix()}"
    likewise = "" if len(there) == 1 else ", and the others likewise"
    if all(there.values()):
        return hint, f"write `{address}`{likewise}: that means the same in every model"
    what = "the file" if len(there) == 1 else "the files that are missing there too"
    return hint, f"correct the path; or add {what} and write `{address}`{likewise}"


def _explain_by_other_program(gap: _MissingFiles, source: Source) -> tuple[str, str]:
    """Say what finds or fills in relative paths that lead nowhere from the model's folder, and the repair; both empty for
    others."""
    if any(use.resource.kind != "relative" for use in gap.uses):
        return "", ""
    if all(path.suffix.lower() in _OSG_SUFFIXES for path in gap.files):
        return (
            "; UWSim, which reads this format, looks in its data folders too",
            "nothing if only UWSim loads the model; otherwise write the paths of meshes in a format that others read",
        )
    word = _get_first_part(gap)
    script = find_filling_script(source, word) or find_replacing_script(source, f'filename="{word}/')
    if script is None:
        return "", ""
    return (
        f"; {script.name} writes something else in place of {word}",
        "nothing if only what the script writes is loaded",
    )


def _get_first_part(gap: _MissingFiles) -> str:
    """Return the first part of the paths: the missing folder's name, or that of the file."""
    return (gap.folder or gap.path).name


def _describe_placeholder(gap: _MissingFiles) -> str:
    """Say what is to be written in place of a placeholder that looks like one; empty for other paths."""
    word = _get_first_part(gap)
    are_relative = all(use.resource.kind == "relative" for use in gap.uses)
    if gap.folder is None or not are_relative or _PATH_PLACEHOLDER.fullmatch(word) is None:
        return ""
    return f"write the folder of the meshes in place of {word}"


def _propose_edits(outside: Mapping[ResourceUse, Path], source: Source) -> list[Edit]:
    """Return the edits of all paths, or none if one of them is not typed as it is."""
    edits: dict[Edit, None] = {}
    for use, path in outside.items():
        own = build_replacement_edits([use.attribute], format_path_from_model(path, source))
        if not own:
            return []
        edits |= dict.fromkeys(own)
    return list(edits)


def _explain_by_argument(gap: _MissingFiles, source: Source) -> tuple[str, list[Location]]:
    """Name the argument that leads to a missing folder or file where another value of it leads to one, and its place."""
    made_of = (definition.location for definition in flatten_definitions(gap.uses[0].attribute.reads))
    missing = find_missing_part(source, gap.path)
    guilty = select_guilty(list_path_arguments(source, made_of), missing)
    choices = list_other_values(source, guilty[0], missing) if len(guilty) == 1 else []
    if not choices:
        return "", []
    return f"; argument {guilty[0]} leads there{format_choices(choices)}", [guilty[0].location]


def _describe_owner(gap: _MissingFiles, owners: list[str], source: Source) -> str:
    """Say how the files of another package are named; empty if none has them."""
    if not owners:
        return ""
    use = gap.uses[0]
    inside = get_path_in_package(use.resource.text, use.resource.package or "")
    declaration = describe_declaration(_find_owner_of_text(use, source), owners[0], source.finder)
    return f"write `package://{owners[0]}/{inside}`, and the others likewise{declaration}"


def _find_owner_of_text(use: ResourceUse, source: Source) -> Package | None:
    """Return the package of the file in which a path is typed."""
    span = use.attribute.span
    file = None if span is None else source.files.get(span.file)
    return source.package if file is None else source.finder.find_package_of(file.path.absolute())


def _describe_checkout(gap: _MissingFiles, source: Source) -> str:
    """Say how a submodule of git is checked out in which all the files may be; empty if there is none."""
    levels = source.finder.list_parent_folders()
    places = {normalise_path(level / name): name for name in list_missing_submodules(source.finder) for level in levels}
    around = {places.get(next((f for f in path.parents if f in places), path)) for path in gap.files}
    submodule = around.pop() if len(around) == 1 else None
    return (
        "" if submodule is None else f"check out its submodule: `git submodule update --init {shlex.quote(submodule)}`"
    )


def _describe_version(gap: _MissingFiles, source: Source) -> str:
    """Say that another version of the package that lacks the files may have them; empty if it is the author's own."""
    named = {use.resource.package for use in gap.uses}
    package = (
        source.finder.find_foreign_package(normalise_path(gap.path.absolute()))
        if len(named) == 1 and all(named)
        else None
    )
    what, them = ("the file", "it") if len(gap.files) == 1 else ("the files", "them")
    return (
        "" if package is None else f"correct the path, add {what}, or get the version of {package.name} that has {them}"
    )


def _describe_making(gap: _MissingFiles, package: Package | None, source: Source) -> str:
    """Say what may make or fetch files that git leaves out: the build of their package, or a script that names their folder."""
    making = "" if package is None else describe_making_build(gap.files, package.path)
    if package is not None and making:
        return f"build {package.name} first: {making}"
    is_own = gap.folder is not None and not is_called_as_any(gap.folder.name) and _is_left_out(gap)
    script = find_fetching_script(source, gap.folder.name) if gap.folder is not None and is_own else None
    if script is None or gap.folder is None:
        return ""
    return f"run {format_path(script)}, which names {gap.folder.name} and may fetch or make it; else correct the path"


def _describe_ignored(gap: _MissingFiles) -> str:
    """Say that git leaves the files out, which a build makes, or the author has beside the repository."""
    them = "it" if len(gap.files) == 1 else "them"
    return f" (.gitignore leaves {them} out; a build or a script may make {them})" if _is_left_out(gap) else ""


def _is_left_out(gap: _MissingFiles) -> bool:
    folder = gap.folder.parent if gap.folder is not None else gap.path.parent
    reach = FileReach.from_paths([folder], [])
    return all(is_git_ignored(path, reach) for path in gap.files)


def _find_similar_files(path: Path, index: FilesByName, source: Source) -> list[Path]:
    """Return up to two files of the same name elsewhere in the package, or one with the same words in its name beside it.

    None is in the folder of another robot.
    """
    used = {use.resource.path.parent for use in list_resource_uses(source) if use.resource.exists and use.resource.path}
    named = [p for p in index.get(path.name.lower(), []) if p != path and not is_of_variant(path, p)]
    same = [p for p in named if normalise_path(p.parent) in used or not is_in_folder_of_another(path, p)]
    try:
        beside = os.listdir(path.parent)
    except OSError:
        beside = []
    meshes = [name for name in beside if name.lower().endswith(MESH_SUFFIXES)]
    # Where other meshes lie in the folder, it is the right one, and a file of this name in the folder of another robot is not.
    if meshes:
        same = [p for p in same if path.parent in p.parents or p.parent in path.parents]
    if same:
        return same[:2]
    close = find_similar_name(path.name, meshes)
    return [path.parent / close] if close else []


def _is_for_other_shapes(path: Path, other: Path) -> bool:
    """Whether one path is in a folder of visuals and the other in one of collisions, whose meshes are coarse."""
    kinds = [{word for part in place.parent.parts for word in split_folder_words(part)} for place in (path, other)]
    return any(one & _DRAWN and two & _TOUCHED and not (one & _TOUCHED) for one, two in (kinds, kinds[::-1]))


def _find_other_format(path: Path) -> Path | None:
    """Return the only mesh beside a missing one that has its name and another suffix."""
    try:
        beside = [path.parent / name for name in os.listdir(path.parent) if name.lower().endswith(MESH_SUFFIXES)]
    except OSError:
        return None
    found = [other for other in beside if other.stem == path.stem]
    return found[0] if len(found) == 1 else None


def _find_link_name(use: ResourceUse) -> str:
    element = use.attribute.owner
    while element.parent is not None and element.tag != "link":
        element = element.parent
    return element.get("name")
