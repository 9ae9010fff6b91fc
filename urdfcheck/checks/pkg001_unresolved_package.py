"""PKG001 reports packages that a model uses and that are not found."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath

from urdfcheck.core import Edit, Finding, Located, Location, Rule, Severity
from urdfcheck.core.text import format_argument_option, format_count, join_names
from urdfcheck.model.repairs.skipping_arguments import find_skipping_argument
from urdfcheck.source.load import Source, locate_expression
from urdfcheck.source.package.build_files import read_generation
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES
from urdfcheck.source.package.finder import Package, format_path
from urdfcheck.source.package.package_folders import is_rosbuild_package, read_package_texts
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.package.similar_files import (
    add_checkout,
    find_naming_text,
    index_files,
    is_in_folder_of_another,
    propose_checkout,
    propose_clone,
)
from urdfcheck.source.path_arguments import list_path_arguments
from urdfcheck.source.project_folders import find_project_folder, is_part_of_robot
from urdfcheck.source.resources import (
    ResourceUse,
    describe_missing_uses,
    describe_project_path,
    find_above,
    find_in_project,
    format_path_from_model,
    get_path_in_package,
    is_misspelt,
    is_released_elsewhere,
    list_resource_uses,
    names_gazebo_model,
)
from urdfcheck.source.ros.dependencies import find_dependent, find_dependent_in_project
from urdfcheck.source.ros.gazebo_paths import GazeboFolder, find_gazebo_folder
from urdfcheck.source.ros.mujoco_paths import describe_mujoco_path
from urdfcheck.source.ros.setup_templates import read_setup_package
from urdfcheck.source.ros.srdf import SETUP_FILE
from urdfcheck.source.text.engine_reactions import name_lost_shapes
from urdfcheck.source.text.tokens import locate_text
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import COMMENT, Element, flatten_definitions
from urdfcheck.source.uses_elsewhere import (
    KEPT_ASIDE,
    OF_TESTS,
    explain_kept_file,
    find_copying_image,
    find_deploying_script,
    find_filling_script,
    is_certainly_left_aside,
    is_lost_to_others,
    is_unused,
    iter_user_texts,
)
from urdfcheck.system.files import FileTooLargeError, read_regular, read_text_or_nothing, walk

# So many files are looked up in other packages to find the one that is meant.
_MAX_FILES = 50
# So many files of one package are its own: fewer of these names (`meshes/base_link.stl`) many packages have.
_LEAST_FILES = 3
# The messages about models that are right somewhere else.
_NOTES = frozenset({
    *("files-declared", "files-inside", "files-part", "files-recorded", "files-rosbuild", "files-aside", "rosbuild"),
    *("files-gazebo", "files-kept", "files-model", "files-path"),
    *("expansion-aside", "expansion-copied", "expansion-declared", "expansion-inside"),
    *("expansion-released", "expansion-rosbuild"),
})  # fmt: skip
# What a file is of which no program of the robot needs the meshes, by what says so.
_KINDS_OF_KEPT = {OF_TESTS: "a test", KEPT_ASIDE: "an old model"}
_ONLY_TO_BUILD = "; package.xml declares it only for the build: add `<exec_depend>{}</exec_depend>`"
_PATH_BEHIND = re.compile(r"(?:\$\(find\s+)?[^\s()\"'<>]*\s*\)/([^\s$\"'<>{}]*)")


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("package-not-found"):
        package = str(problem.data["package"])
        at = locate_expression(source, problem, package)  # xacro evaluates a property where it is first read
        read = [] if at is problem.location else [problem.location]
        related = [*read, *(one for one in problem.related if one.span != at.span)]
        yield _build_finding(source, rule, package, at=at, related=related)
    missing: dict[str, list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        if use.resource.package is not None and use.resource.path is None and not is_misspelt(use, source):
            missing.setdefault(use.resource.package, []).append(use)
    for package, uses in missing.items():
        at = locate_text(uses[0].attribute, package, source.files)
        others = {u.attribute.span: u for u in uses if u.attribute.span != uses[0].attribute.span}
        yield _build_finding(source, rule, package, at=at, related=others.values(), uses=uses)


def _build_finding(
    source: Source,
    rule: Rule,
    package: str,
    *,
    at: Location,
    related: Iterable[Located | Location],
    uses: Sequence[ResourceUse] = (),
) -> Finding:
    owner = _find_owner(source, at)
    here = _find_files_here(uses, source)
    dependent = None if here and owner is None else _find_dependent(source, package, owner)
    declared = dependent is not None
    here = {} if declared else here
    owners = _find_package_with_files(uses, source) if uses else _find_own_include(package, owner, at, source)
    files = list(dict.fromkeys(u.resource.text for u in uses))
    checkout = "" if here or not package else propose_checkout(package, source.finder)
    kind = "rosbuild" if _has_rosbuild_name(here, package) else "files" if uses else "expansion"
    near = (
        []
        if declared or here or checkout
        else owners or source.finder.suggest_names(package, _list_wanted_files(package, uses, at, source))
    )
    evidence = f", which has {'these files' if len(files) > 1 else 'this file'}" if owners and package else ""
    is_of_release = kind == "files" and not here and is_released_elsewhere(source, package)
    message = (
        "nameless"
        if not package
        else f"{kind}-declared"
        if declared
        else "files-recorded"
        if is_of_release and source.is_output_of_xacro
        else "files-rosbuild"
        if is_of_release and _find_rosbuild_package(source) is not None
        else "files-released"
        if is_of_release
        else "files-aside"
        if kind == "files" and not near and not here and is_certainly_left_aside(source)
        else kind
    )
    clone = _find_rosbuild_folder(source, package, at)
    released = _read_released(owner)
    known = _describe_knowledge(package, source, owner)
    is_elsewhere = bool(known)
    included = None if uses else _find_included_file(source, package, at)
    if message == "expansion":
        is_undeclared = is_elsewhere and not (near or checkout or included)
        message = _name_expansion(source, package, is_undeclared=is_undeclared)
    is_lost = message in {"files", "expansion"} and not near and not here and not checkout
    inside = _find_place_in_package(source, package, _list_wanted_files(package, uses, at, source)) if is_lost else ""
    script = find_deploying_script(source) if is_lost and uses else None
    script = find_copying_image(source) if message == "expansion-copied" else script
    kept = explain_kept_file(source) if message in {"files", "files-aside"} and is_lost else ""
    filling = find_filling_script(source, package) if is_lost and uses and package else None
    kept = kept if filling is None else f"{filling.name} writes something else in place of {package}"
    is_of_gazebo = is_lost and kind == "files" and all(map(names_gazebo_model, uses))
    on_path = _find_folder_on_path(source, package, files) if is_of_gazebo else None
    may_be_model = bool(package) and not checkout and (message == "files-aside" or (is_lost and message == "files"))
    gazebo_model = _find_gazebo_model(source, package, files) if may_be_model else None
    is_named_for_gazebo = all(map(names_gazebo_model, uses)) or source.package is None
    is_for_gazebo, is_used = gazebo_model is not None and is_named_for_gazebo, message == "files"
    is_of_gazebo = is_of_gazebo and not _find_own_files(source, files)
    if message == "expansion" and clone is not None and _is_named_by_checkout(source, clone):
        message = "expansion-rosbuild"
    elif inside:
        message = f"{message}-inside"
    elif script is not None and uses:
        message = "files-part"
    elif on_path is not None and message in {"files", "files-aside"}:
        message = "files-path"
    elif is_for_gazebo:
        message = "files-gazebo"
    elif is_of_gazebo and package and message in {"files", "files-aside"}:
        message = "files-model"
    elif kept:
        message = "files-kept"
    message = "textures" if message == "files" and _are_textures(uses) else message
    # The meshes of a declared package are missing only until it is installed.
    lost = message in {
        *("files", "files-inside", "files-part", "files-released", "files-aside", "files-kept", "nameless"),
    }
    # Without a package the model may be for programs that need none.
    is_outside = message == "nameless" and here and source.package is None
    # Its other programs lack what nothing else of the link stands for.
    is_model = message == "files-gazebo" and source.package is not None and is_used
    is_outside = is_outside or ((message == "files-path" or is_model) and _is_lost_to_others(uses, source))
    related = list(related)
    named_by, places = _explain_by_argument(source, package, uses, related)
    # A package may be meant by its name and lack the files all the same.
    lacking = "" if owners or here or not near else _describe_lack(near, package, uses, at, source)
    repair = checkout or _describe_absolute_path(package, uses, source)
    repair = repair or _describe_repair(package, here, near, source, owner, declared=declared, lacking=lacking)
    repair = _describe_path_of_part(here, package, at, source) or repair
    scaled = _describe_scaled_file(near, package, uses, source)
    repair = scaled + repair
    own = [] if declared or here or near or checkout else _find_own_files(source, files)
    in_gazebo = "" if gazebo_model is None else format_path(gazebo_model)
    if own and package and source.package is not None:
        likewise = ", and the others likewise" if len(own) > 1 else ""
        scale = _describe_other_scale(uses, source, source.package.path / own[0])
        repair = f"write `package://{source.package.name}/{own[0]}`{scale}{likewise}, if these files are meant; else {repair}"
    elif is_lost and uses and package:
        repair = _add_own_folder(repair, source, package, files)
    if clone is not None and kind == "expansion":
        repair = _describe_rosbuild_repair(source, package, clone)
    if package and not (
        checkout or here or near or message == "expansion-copied" or (declared and package in released)
    ):
        repair = add_checkout(repair, package, source.finder)
    file_here = included if is_lost and not (inside or clone) else None
    repair = _describe_included_file(file_here, package, owner, repair)
    is_unknown = not (near or checkout or included or package in released)
    has_namesake = message in {"expansion", "expansion-undeclared"} and is_unknown
    repair = _add_namesake(repair, owner, at, source) if has_namesake else repair
    if kind == "expansion" and clone is None:
        skipping = find_skipping_argument(source, at)
        repair += f", or `{format_argument_option(*skipping)}`, which skips this include" if skipping else ""
    repair = f"nothing if only what the script writes is loaded; else {repair}" if filling is not None else repair
    if message == "files-gazebo":
        repair = _describe_others(package, own, source)
    finding = rule.finding(
        message,
        at=at,
        related=[*related, *places],
        edits=[] if scaled else _propose_edits(uses, package, near),
        severity=_grade(message, is_outside=bool(is_outside), is_elsewhere=is_lost and not own and is_elsewhere),
        consequences=_describe_loss(uses, source, in_gazebo) if lost or message == "files-gazebo" else None,
        lost=name_lost_shapes(use.attribute.owner for use in uses),
        package=package,
        known=known,
        manifest="package.xml"
        if dependent is None or (source.package and dependent == source.package.name)
        else f"package.xml of {dependent}",
        repair=repair,
        remedy=f"--package {shlex.quote(package)}=FOLDER" if package and kind == "expansion" else "",
        files=files,
        amount=format_count(len(files), "file"),
        listed=join_names([get_path_in_package(f, package) or f for f in files], 3),
        looked=source.finder.describe_search_places(),
        places="; ".join(source.finder.describe_search_places()),
        near=near,
        folder=in_gazebo
        if gazebo_model is not None
        else format_path(on_path.folder)
        if on_path is not None
        else ""
        if clone is None
        else clone.name,
        setter="" if on_path is None else on_path.file.name,
        variable="" if on_path is None else on_path.variable,
        inside=inside,
        script="" if script is None else script.name,
        kept=kept,
        kind="a template" if filling is not None else _KINDS_OF_KEPT.get(kept, "an original"),
        hint=(
            f" (did you mean {join_names(near)}{evidence}?)"
            if near
            else " (its submodule is not checked out)"
            if checkout
            else ""
            if declared
            else f" (the project has the file as {format_path(file_here[0] / file_here[1])})"
            if file_here is not None
            else _describe_places(files, here, own, source)
        )
        + (f" (the Gazebo model {in_gazebo} has {'it' if len(files) == 1 else 'them'})" if in_gazebo else "")
        + named_by,
    )
    # The file is right, and the model is unknown all the same: the run says that it was not checked.
    is_blocked = kind == "expansion" and message in {*_NOTES, "expansion-undeclared"}
    return replace(finding, blocks_check=True) if is_blocked else finding


def _name_expansion(source: Source, package: str, *, is_undeclared: bool) -> str:
    """Return the message about a model that cannot expand without a package.

    ``is_undeclared``: whether it is known where the package is, so that the model's package only lacks the dependency.
    """
    if find_copying_image(source) is not None:
        return "expansion-copied"
    # No program loads a file that none names where the others name other models, as in XAC001.
    if is_unused(source) or explain_kept_file(source) == KEPT_ASIDE:
        return "expansion-aside"
    if is_released_elsewhere(source, package):
        return "expansion-released"
    return "expansion-undeclared" if is_undeclared and source.package is not None else "expansion"


def _read_released(owner: Package | None) -> frozenset[str]:
    """Return the packages that are released for the generation of ROS that a package is for; all where that is open."""
    return read_released_packages(None if owner is None else read_generation(owner.root))


def _describe_knowledge(package: str, source: Source, owner: Package | None) -> str:
    """Say what shows that a package exists, so that its name is right; empty where nothing does."""
    if package in _read_released(owner):
        return "ROS has released it"
    if not package:
        return ""
    if propose_clone(package, source.finder):
        return "the project says how to get it"
    generation = None if owner is None else read_generation(owner.root)
    if package in read_released_packages():
        return f"a package of this name is released, but not for ROS {generation}"
    naming = find_naming_text(package, source.finder)
    if naming is not None:
        return f"{naming.name} names it"
    if owner is None:
        return ""
    if package == read_setup_package(owner.path):
        return f"MoveIt's setup assistant was given its model, as {SETUP_FILE} says"
    family = f"{package.partition('_')[0]}_"
    siblings = (name for name in sorted(owner.dependencies) if package.startswith(family) and name.startswith(family))
    sibling = next((name for name in siblings if source.finder.find(name) is None), None)
    return "" if sibling is None else f"it depends on {sibling}, which is not here either"


def _describe_loss(uses: Sequence[ResourceUse], source: Source, gazebo_model: str) -> dict[str, str]:
    """Describe what programs do without the files; ``gazebo_model``: the folder in which Gazebo finds them, if it is there."""
    lost = describe_missing_uses(uses, source)
    if gazebo_model:
        around = str(PurePosixPath(gazebo_model).parent)
        lost["gazebo"] = f"loads the shapes if {around} is in its path (GAZEBO_MODEL_PATH), otherwise drops them"
    return lost


def _describe_others(package: str, own: Sequence[str], source: Source) -> str:
    """Say what programs other than Gazebo need; ``own``: the same files in the model's own package."""
    if not own or source.package is None:
        return f"other programs need a package {package}"
    likewise = ", and the others likewise" if len(own) > 1 else ""
    return f"for other programs, write `package://{source.package.name}/{own[0]}`{likewise}"


def _is_lost_to_others(uses: Iterable[ResourceUse], source: Source) -> bool:
    return is_lost_to_others({use.attribute.owner for use in uses}, source)


def _find_folder_on_path(source: Source, package: str, files: Sequence[str]) -> GazeboFolder | None:
    """Return the folder of the model's own package that has all files, and to which a file of the project leads Gazebo."""
    paths = [f"{package}/{get_path_in_package(file, package)}" for file in files]
    if source.package is None or not package:
        return None
    return find_gazebo_folder(source.package.path, iter_user_texts(source), paths)


def _find_gazebo_model(source: Source, package: str, files: Sequence[str]) -> Path | None:
    """Return the folder of a model of Gazebo in the project that has the name of a package and all files at their paths in it.

    Gazebo and iDynTree look for a package there: in the folders of GAZEBO_MODEL_PATH, which a file of the project may set.
    """
    wanted = [get_path_in_package(file, package) for file in files]
    project = find_project_folder(source.path.absolute())
    for here, names, found in walk(project):
        names[:] = [name for name in names if not name.startswith(".")]
        folder = Path(here)
        is_meant = folder.name == package and _has_all_files(folder, wanted, source)
        if is_meant and ("model.config" in found or _sets_model_path(project, source)):
            return folder
    return None


def _sets_model_path(project: Path, source: Source) -> bool:
    """Whether a file at the top of a project, such as its CMakeLists.txt or README, names GAZEBO_MODEL_PATH."""
    kinds = {".md", ".rst", ".sh", ".txt"}
    tops = (path for path in sorted(project.iterdir()) if path.suffix.lower() in kinds and source.finder.can_open(path))
    return any("GAZEBO_MODEL_PATH" in read_text_or_nothing(path) for path in tops)


def _are_textures(uses: Iterable[ResourceUse]) -> bool:
    return all(use.attribute.owner.tag == "texture" for use in uses)


def _grade(message: str, *, is_outside: bool, is_elsewhere: bool) -> Severity | None:
    """Return the severity of a message; None for that of the rule.

    ``is_elsewhere``: whether a released package, or one that the project says how to get, has the files, as far as is known: the
    model is right where that is installed.
    """
    if message in _NOTES and not is_outside:
        return Severity.INFO
    # Without a texture no program loses a shape.
    is_weaker = is_outside or message in {"expansion-undeclared", "files-released", "textures"}
    is_weaker |= message == "files" and is_elsewhere
    return Severity.WARNING if is_weaker else None


def _find_dependent(source: Source, package: str, owner: Package | None) -> str | None:
    """Return the package that depends on a missing one: that of the file that names it, the model's, or one below these.

    For a file that is in no package, any package of the project may.
    """
    if owner is None and source.package is None:
        return find_dependent_in_project(package, source.finder) if package else None
    found = (find_dependent(one, package, source.finder) for one in (owner, source.package) if one is not None)
    return next(filter(None, found), None)


def _explain_by_argument(
    source: Source, package: str, uses: Sequence[ResourceUse], related: Sequence[Located | Location]
) -> tuple[str, list[Location]]:
    """Name the argument whose value is the package, and its place."""
    read = (definition.location for use in uses for definition in flatten_definitions(use.attribute.reads))
    places = (place for place in related if isinstance(place, Location))
    arguments = list_path_arguments(source, read if uses else places)
    named = [argument for argument in arguments if package and argument.value == package]
    return (f", named by argument {named[0]}", [named[0].location]) if len(named) == 1 else ("", [])


def _find_package_with_files(uses: Sequence[ResourceUse], source: Source) -> list[str]:
    """Return the only known package that has all these files, or nothing.

    A path that names no package may name it behind too many slashes.
    """
    inside = list(dict.fromkeys(get_path_in_package(use.resource.text, use.resource.package or "") for use in uses))[
        :_MAX_FILES
    ]
    if not inside:
        return []
    if not uses[0].resource.package:
        names = {path.partition("/")[0] for path in inside}
        return sorted(names) if len(names) == 1 and all(map(source.finder.find, names)) else []
    owners = [name for name, folder in source.finder.list_packages().items() if _has_all_files(folder, inside, source)]
    is_own = source.package is not None and owners == [source.package.name]
    return owners if len(owners) == 1 and (is_own or len(inside) >= _LEAST_FILES) else []


def _find_own_include(package: str, owner: Package | None, at: Location, source: Source) -> list[str]:
    """Return the package of a xacro file if it has the file that is typed after another, unknown name: a former name of it.

    A file that includes one of its own name from elsewhere is a wrapper of that.
    """
    inside = _read_path_behind(at, source)
    if owner is None or not inside or package in read_released_packages() or at.span is None:
        return []
    place = source.finder.find_source(owner.path / inside)
    is_itself = os.path.abspath(place) == os.path.abspath(source.files[at.span.file].path)
    return [owner.name] if not is_itself and source.finder.can_open(place) and os.path.isfile(place) else []


def _has_all_files(folder: Path, files: list[str], source: Source) -> bool:
    # os.path, because pathlib raises if a name is too long.
    return all(source.finder.can_open(folder / name) and os.path.isfile(folder / name) for name in files)


def _list_wanted_files(package: str, uses: Sequence[ResourceUse], at: Location, source: Source) -> set[str]:
    """Return the paths in a package that the model names, as far as they are typed."""
    paths = {get_path_in_package(use.resource.text, package) for use in uses} or {_read_path_behind(at, source)}
    return set(filter(None, paths))


def _read_path_behind(at: Location, source: Source) -> str:
    """Return the path that is typed after ``$(find package)``; empty if it is computed, or none is."""
    file = None if at.span is None else source.files.get(at.span.file)
    match = None if at.span is None or file is None else _PATH_BEHIND.match(file.text, at.span.start)
    return "" if match is None else match[1]


def _find_files_here(uses: Sequence[ResourceUse], source: Source) -> dict[str, Path]:
    """Return for each text the file that it means where the folder around the model takes the place of the package.

    Empty unless all are there: with the name of the package as that of a folder, or without the name.
    """
    if source.package is not None:
        return {}
    found: dict[str, Path] = {}
    for use in uses:
        path = find_above(use, source) or find_in_project(use, source)
        if path is None:
            return _find_in_folder_beside(uses, source) or _find_in_one_folder(uses, source)
        found[use.resource.text] = path
    return found


def _find_in_folder_beside(uses: Iterable[ResourceUse], source: Source) -> dict[str, Path]:
    """Return for each text the file of its name in one folder beside the model that has them all, if they are several.

    None of two with one name is known to be that file.
    """
    names = {use.resource.text: PurePosixPath(use.resource.text).name for use in uses}
    around = source.path.absolute().parent
    if not _LEAST_FILES <= len(names) == len({*names.values()}) or not source.finder.can_open(around):
        return {}
    here, folders, _ = next(walk(around), ("", [], []))
    places = (Path(here, folder) for folder in sorted(folders) if not folder.startswith("."))
    place = next((place for place in places if _has_all_files(place, list(names.values()), source)), None)
    return {} if place is None else {text: place / name for text, name in names.items()}


def _find_in_one_folder(uses: Sequence[ResourceUse], source: Source) -> dict[str, Path]:
    """Return for each text the file of its name in the only folder of the repository that has them all, if they are several.

    A folder of another robot may have files of the same names. A package that ROS has released, or that one of the project
    depends on, is meant itself.
    """
    names = {use.resource.text: PurePosixPath(use.resource.text).name for use in uses}
    packages = {use.resource.package or "" for use in uses}
    if packages & read_released_packages() or any(find_dependent_in_project(p, source.finder) for p in packages if p):
        return {}
    project = source.finder.find_repository()
    if (
        project is None
        or not _LEAST_FILES <= len(names) == len({*names.values()})
        or not source.finder.can_open(project)
    ):
        return {}
    index = index_files([project])
    named = [{p.parent for p in index.get(name.lower(), []) if p.name == name} for name in names.values()]
    places = sorted(set.intersection(*named))
    typed = project / get_path_in_package(next(iter(names)), "")
    if len(places) != 1 or is_in_folder_of_another(typed, places[0] / typed.name):
        return {}
    return {text: places[0] / name for text, name in names.items()}


def _has_rosbuild_name(here: Mapping[str, Path], package: str) -> bool:
    """Whether all files are in a package of rosbuild, whose folder has another name here."""
    folders = {path.parents[get_path_in_package(text, package).count("/")] for text, path in here.items()}
    return bool(package) and len(folders) == 1 and all(map(is_rosbuild_package, folders))


def _find_rosbuild_folder(source: Source, package: str, at: Location) -> Path | None:
    """Return the folder around the model that is a package of rosbuild and has the file typed after ``$(find …)``."""
    inside = _read_path_behind(at, source)
    folders = [] if source.package is not None or not package or not inside else source.finder.list_parent_folders()
    own = (f for f in folders if is_rosbuild_package(f) and source.finder.can_open(f / inside))
    return next((f for f in own if os.path.isfile(f / inside)), None)


def _find_included_file(source: Source, package: str, at: Location) -> tuple[Path, str] | None:
    """Return the nearest folder around the model that has the file typed after ``$(find …)``, and the file's path in it.

    A folder that lacks another file of the package is not what is meant. A file that includes one of its own name from elsewhere
    is a wrapper of that.
    """
    inside = _read_path_behind(at, source)
    if not package or not inside or at.span is None:
        return None
    itself = os.path.abspath(source.files[at.span.file].path)
    named = re.compile(rf"\$\(find\s+{re.escape(package)}\s*\)/([^\s$\"'<>{{}}()]+)[\"']")
    wanted = [inside, *(path for file in source.files.values() for path in named.findall(COMMENT.sub("", file.text)))]
    for folder in source.finder.list_parent_folders():
        if _has_all_files(folder, wanted, source):
            return None if os.path.abspath(folder / inside) == itself else (folder, inside)
    return None


def _describe_included_file(found: tuple[Path, str] | None, package: str, owner: Package | None, repair: str) -> str:
    """Say before a repair how a file of the project is included, or how the folder that has it is found as the package."""
    if found is None:
        return repair
    folder, inside = found
    given = f"`--package {shlex.quote(package)}={shlex.quote(format_path(folder))}`"
    if owner is None:
        place = "the project" if format_path(folder) == "." else format_path(folder)
        named = f"add a package.xml with its name there ({given} checks it without one)"
        return f"if {place} is the package, {named}; else {repair}"
    path = Path(os.path.relpath(folder / inside, owner.path)).as_posix()
    return f"if that file is meant, write `$(find {owner.name})/{path}` ({given} checks it as it is); else {repair}"


def _add_namesake(repair: str, owner: Package | None, at: Location, source: Source) -> str:
    """Add to a repair that the package of a file has the only other file of the name that it includes."""
    name = PurePosixPath(_read_path_behind(at, source)).name
    if owner is None or not name or at.span is None:
        return repair
    itself = os.path.abspath(source.files[at.span.file].path)
    named = [path for path in index_files([owner.path]).get(name.lower(), []) if os.path.abspath(path) != itself]
    if len(named) != 1:
        return repair
    path = named[0].relative_to(owner.path).as_posix()
    return f"if {path} of {owner.name} is meant, write `$(find {owner.name})/{path}`; else {repair}"


def _is_named_by_checkout(source: Source, folder: Path) -> bool:
    """Whether a folder is the whole project, which anyone may check out under another name, and no file in it uses its name."""
    return folder == find_project_folder(source.path.absolute()) and not _uses_own_name(source, folder)


def _find_place_in_package(source: Source, package: str, wanted: Collection[str]) -> str:
    """Return which folder of a package the model's whole project is, for a model in no package; else empty.

    All paths in the package that it names begin with that folder, and go on with files of the project. A mesh may lie so in a
    copy; so the folder must be named in an include too, of a file of the project by another.
    """
    first = next(iter(wanted), "")
    if source.package is not None or not package or not first:
        return ""
    project = find_project_folder(source.path.absolute())
    for place in (str(parent) for parent in [*PurePosixPath(first).parents][-2::-1]):
        rests = [path.removeprefix(f"{place}/") for path in wanted if path.startswith(f"{place}/")]
        if len(rests) == len(wanted) and _has_all_files(project, rests, source):
            included = re.compile(
                rf"\$\(find\s+{re.escape(package)}\s*\)/{re.escape(place)}/([^\s$\"'<>{{}}]+\.xacro)[\"']"
            )
            named = (name for text in _read_models(project, source) for name in included.findall(text))
            return place if any(_has_all_files(project, [name], source) for name in named) else ""
    return ""


def _find_rosbuild_package(source: Source) -> Path | None:
    """Return the package of rosbuild that the model is in."""
    return next(filter(is_rosbuild_package, source.finder.list_parent_folders()), None)


def _describe_rosbuild_repair(source: Source, package: str, folder: Path) -> str:
    """Say how a package of rosbuild in a folder of another name is found: by that name, if files in it use it already."""
    own = "a package of rosbuild (manifest.xml) has the name of its folder"
    if _uses_own_name(source, folder):
        return f"write {folder.name} instead of {package}, the name that other files of the folder use: {own}"
    return f"rename the folder {folder.name} to {package}: {own}; or add a package.xml with this name"


def _uses_own_name(source: Source, folder: Path) -> bool:
    """Whether files in a folder name a package as the folder is called."""
    used = re.compile(rf"(?:\$\(find\s+|package://){re.escape(folder.name)}(?![\w-])")
    texts = read_package_texts(folder, source.finder.can_open)
    return any(map(used.search, texts)) or any(used.search(text) for text in _read_models(folder, source))


def _read_models(folder: Path, source: Source) -> Iterator[str]:
    """Read the models in a folder and below it."""
    for here, _, names in walk(folder):
        for path in (Path(here, name) for name in sorted(names) if name.endswith((".xacro", ".urdf", ".gazebo"))):
            try:
                if source.finder.can_open(path):
                    yield read_regular(path).decode("utf-8", "replace")
            except (OSError, FileTooLargeError):
                continue


def _find_owner(source: Source, at: Location) -> Package | None:
    """Return the package of the file in which a name is typed: its manifest must declare it, whatever model includes the file."""
    file = None if at.span is None else source.files.get(at.span.file)
    return source.package if file is None else source.finder.find_package_of(file.path.absolute())


def _describe_repair(
    package: str,
    here: Mapping[str, Path],
    near: Sequence[str],
    source: Source,
    owner: Package | None,
    *,
    declared: bool,
    lacking: str,
) -> str:
    """Say how the files are found.

    ``owner``: the package whose manifest must declare the other one; ``lacking``: what a package of a similar name lacks.
    """
    if here:
        return describe_project_path(here.values(), source)
    if not package:
        return "write `package://NAME/…`, with two slashes and the package name"
    if is_part_of_robot(package) and source.package is None:
        return f"the package's name is missing before {package}: write `package://NAME/{package}/…`, or a path from this file"
    if declared:
        run_time = _ONLY_TO_BUILD.format(package) if owner is not None and _is_declared_to_build(owner, package) else ""
        return f"install the package, or pass `--package {shlex.quote(package)}=FOLDER`{run_time}"
    elsewhere = f"pass `--package {shlex.quote(package)}=FOLDER`"
    if package in _read_released(owner) and not near:
        install = f"{'declare it in package.xml and ' if owner is not None else ''}install it"
        if _belongs_to_release(package, source):
            return f"{install}, or {elsewhere}"
        # An unreleased package may have the name too.
        return f"{install}, if the released {package} is meant; else add the package, or {elsewhere}"
    if near:
        declare = "declare it in package.xml or " if owner is not None else ""
        return f"correct the name{lacking}; if the package is only missing here, {declare}{elsewhere}"
    declare = " and declare it in package.xml" if owner is not None else ""
    return f"add the package{declare}, or correct its name; if it is in another folder, {elsewhere}"


def _belongs_to_release(package: str, source: Source) -> bool:
    """Whether the project shows that the released package is meant: it depends on that, or has a released one of its family."""
    family = f"{package.partition('_')[0]}_"
    relatives = {name for name in source.finder.list_workspace_packages() if name.startswith(family)}
    return bool(relatives & read_released_packages()) or find_dependent_in_project(package, source.finder) is not None


def _describe_path_of_part(here: Mapping[str, Path], package: str, at: Location, source: Source) -> str:
    """Say how files of the project are named in a file that the model includes: a path starts at the model, and other models may
    include the file too. Nothing for a path in the model's own file."""
    part = "" if at.span is None or at.span.file == source.name else at.span.file
    if not here or not package or not part:
        return ""
    files = list(here.values())
    own = f"write the path from the model, `{format_path_from_model(files[0], source)}`"
    reason = f"a model in another folder that includes {PurePosixPath(part).name} needs another path"
    mujoco = describe_mujoco_path(files, source)
    return f"ROS needs a package.xml with the name {package}; for programs without ROS, {own}: {reason}{mujoco}"


def _describe_absolute_path(package: str, uses: Iterable[ResourceUse], source: Source) -> str:
    """Say what to write before a path that xacro computes from the root (``package://${folder}/a.stl``); else nothing."""
    paths = [] if package else [Path("/", get_path_in_package(use.resource.text, "")) for use in uses]
    is_computed = not any(use.attribute.literal for use in uses)
    if not paths or not is_computed or not all(source.finder.can_open(p) and os.path.isfile(p) for p in paths):
        return ""
    return "write `file://` in place of `package://`: what xacro puts behind it is a path from the root"


def _describe_lack(near: Sequence[str], package: str, uses: Sequence[ResourceUse], at: Location, source: Source) -> str:
    """Say that the paths must be corrected too, where none of the packages that may be meant has all the files."""
    wanted = sorted(_list_wanted_files(package, uses, at, source))
    counts = {
        name: sum(_has_all_files(folder, [path], source) for path in wanted)
        for name in near
        if (folder := source.finder.find(name)) is not None
    }
    name = max(counts, key=lambda one: counts[one], default="")
    if not package or not name or counts[name] == len(wanted):
        return ""
    one = len(wanted) == 1
    has = (
        f"has {counts[name]} of {len(wanted)} files" if counts[name] else f"lacks {'the file' if one else 'the files'}"
    )
    return f" and the path{'' if one else 's'} ({name} {has})"


def _is_declared_to_build(owner: Package, package: str) -> bool:
    """Whether a manifest declares a package for the build only."""
    children = () if owner.root is None else owner.root.children
    tags = {e.tag for e in children if e.tag.endswith("depend") and e.text.strip() == package}
    return bool(tags) and tags <= {"build_depend", "buildtool_depend"}


def _describe_places(files: Sequence[str], here: Mapping[str, Path], own: Sequence[str], source: Source) -> str:
    """Say where the files are: in the project around the model (``here``), or in the model's own package (``own``)."""
    if here:
        folders = dict.fromkeys(format_path_from_model(path.parent, source) for path in here.values())
        place = "beside the model" if list(folders) == ["."] else f"in {join_names(folders, 2)}"
        return f" (the {'file is' if len(files) == 1 else 'files are'} {place})"
    if not own or source.package is None:
        return ""
    return f" ({source.package.name} has {'the file' if len(files) == 1 else 'the files'} as {join_names(own, 3)})"


def _find_own_files(source: Source, files: Sequence[str]) -> list[str]:
    """Return where the model's own package has a file of the same name as each of these, or the same place in a folder that is
    called as the package, or there a mesh of the same name in another format; nothing unless each is there once, and another."""
    if not files or source.package is None:
        return []
    index = index_files([source.package.path])
    found = []
    for file in map(PurePosixPath, files):
        named = [path for path in index.get(file.name.lower(), []) if path.name == file.name]
        placed = [path for path in named if path.as_posix().endswith(f"/{'/'.join(file.parts[1:])}")]
        alike = [p for ending in MESH_SUFFIXES for p in index.get(f"{file.stem}{ending}".lower(), [])]
        inside = f"/{'/'.join(file.parts[2:])}"
        placed = placed or [p for p in alike if p.with_suffix(file.suffix).as_posix().endswith(inside)]
        found.append(placed if len(placed) == 1 else named)
    if any(len(paths) != 1 for paths in found) or len({paths[0] for paths in found}) < len({*files}):
        return []
    return [paths[0].relative_to(source.package.path).as_posix() for paths in found]


def _describe_scaled_file(near: Sequence[str], package: str, uses: Sequence[ResourceUse], source: Source) -> str:
    """Say before the repair that the first file in the only package that may be meant goes with another scale; else nothing."""
    folder = source.finder.find(near[0]) if len(near) == 1 and uses and package else None
    inside = get_path_in_package(uses[0].resource.text, package) if uses else ""
    if folder is None or not _has_all_files(folder, [inside], source):
        return ""
    scale = _describe_other_scale(uses, source, folder / inside)
    return f"write `package://{near[0]}/{inside}`{scale}; or " if scale else ""


def _describe_other_scale(uses: Sequence[ResourceUse], source: Source, file: Path) -> str:
    """Say which scale goes with a file that takes the place of the first one, where the model has it with another scale.

    Empty if it has it with the same one, with several, or not at all.
    """
    others = [
        use.attribute.owner
        for use in list_resource_uses(source)
        if use.resource.exists and use.resource.path is not None and use.resource.path.samefile(file)
    ]
    scales = {_read_scale(other) for other in others}
    if len(scales) != 1 or not scales.isdisjoint({_read_scale(uses[0].attribute.owner)}):
        return ""
    span = others[0].span
    line = "" if span is None else f", as in line {span.line}"
    scale = others[0].get("scale")
    return f' with `scale="{scale}"`{line}' if scale else f" without the scale{line}"


def _read_scale(mesh: Element) -> tuple[float | None, ...]:
    return tuple(parse_number(word) for word in mesh.get("scale").split()) or (1.0, 1.0, 1.0)


def _add_own_folder(repair: str, source: Source, package: str, files: Sequence[str]) -> str:
    """Add to a repair that the model's own package has most of these files at the same paths: then its name is meant."""
    if source.package is None:
        return repair
    folder, paths = source.package.path, [get_path_in_package(file, package) for file in files[:_MAX_FILES]]
    count = sum(bool(path) and _has_all_files(folder, [path], source) for path in paths)
    if count < _LEAST_FILES or 2 * count <= len(paths):
        return repair
    name = source.package.name
    return f"write {name} instead, which has {count} of {len(paths)} files at these paths, if they are meant; else {repair}"


def _propose_edits(uses: Sequence[ResourceUse], package: str, near: Sequence[str]) -> list[Edit]:
    """Return edits of the package's name if it can only mean one other name."""
    if len(near) != 1 or not all(u.attribute.literal for u in uses):
        return []
    edits = {}
    for use in uses:
        span, typed = use.attribute.span, use.attribute.typed
        if span is not None:
            scheme = typed.partition("://")[0]
            old = f"{scheme}://{package}" if package else f"{scheme}:///{near[0]}"
            edits[span] = Edit(span, typed, typed.replace(old, f"{scheme}://{near[0]}", 1))
    return list(edits.values())
