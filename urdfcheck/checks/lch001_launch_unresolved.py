"""LCH001 reports a `robot_description` that a launch file cannot load."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from urdfcheck.core import Confidence, Finding, Fix, Location, Rule, Severity
from urdfcheck.core.text import compile_names, format_name_hint
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.arguments.written_commands import find_starting_command
from urdfcheck.source.launch.around.meant_files import (
    Trial,
    can_be_included,
    describe_handing,
    describe_meant_file,
    is_semantic,
    makes_robot,
    may_be_declared,
    takes_arguments,
)
from urdfcheck.source.launch.around.passing_files import find_inheriting_files, find_passing_files
from urdfcheck.source.launch.built_files import find_maker, find_template, is_git_ignored, writes_file
from urdfcheck.source.launch.launch_file import (
    BrokenInclude,
    DescriptionSource,
    Launch,
    is_included_by_sibling,
    list_declared_arguments,
)
from urdfcheck.source.launch.python_launch_file import PythonLaunch
from urdfcheck.source.launch.substitutions import UnresolvedReason
from urdfcheck.source.model_file import find_placeholder
from urdfcheck.source.package.build_files import is_only_of_ros2
from urdfcheck.source.package.file_kinds import LAUNCH_SUFFIXES, MODEL_SUFFIXES, SRDF_SUFFIXES, is_launch
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.package.package_folders import is_rosbuild_package, read_package_texts
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.package.similar_files import (
    add_checkout,
    find_slashed_file,
    index_files,
    normalise_path,
    propose_checkout,
    propose_clone,
)
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.reach import FileReach
from urdfcheck.source.ros.dependencies import describe_declaration, find_dependent
from urdfcheck.source.ros.setup_templates import is_side_template
from urdfcheck.source.text.tokens import locate_text
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.system.files import read_text_or_nothing

# The characters of a command that a message shows.
_SHOWN = 80
_XACRO = ".xacro"
# So many xacro files are searched for one that includes another.
_MOST_INCLUDERS = 1_000
# So many arguments a repair shows of which a path is made.
_MOST_VALUES = 3
# What a launch file names, as a message calls it.
_SRDF = "SRDF"
# What means the same whatever the arguments are.
_OTHER = re.compile(r"\$\((?:find|find-pkg-share|dirname)\b[^()$]*\)")
_SUBSTITUTION = re.compile(r"\$\([^()]*\)")
_READ = re.compile(r"\$\((?:arg|var)\s+([^\s()]+)\s*\)")
_BEHIND_PACKAGE = re.compile(r"\)/([^\s$\"'(){}]+)$")


# What becomes of a finding on a launch file of ROS 1 in a package of ROS 2: another path does not make it start.
_LEFT_OVER: dict[str, Any] = {
    "severity": Severity.WARNING,
    "fix": Fix(
        "delete the launch file, or translate it if it is still needed: it is of ROS 1, and the package of ROS 2"
    ),
    "consequences": {"ros2_launch": "refuses the launch file, whatever it loads"},
}


# What becomes of a finding on a launch file of MoveIt's setup assistant that nothing names, whose partners were deleted.
_UNUSED_TEMPLATE: dict[str, Any] = {
    "severity": Severity.INFO,
    "fix": Fix(
        "delete the launch file, unless benchmarks or the warehouse are used: MoveIt's setup assistant has written it"
    ),
}


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    if launch.is_kept_aside:
        return
    is_template = _is_unused_template(launch)
    is_listing = launch.is_in_documents and launch.package is None  # to be read, or copied into a package
    for found in _check_launch(context, rule):
        finding = found if launch.dialect == "ros1" else _say_for_ros2(found)
        if is_listing:
            finding = replace(finding, severity=min(finding.severity, Severity.WARNING))
        is_error = finding.severity > Severity.INFO
        left = _LEFT_OVER if launch.is_left_from_ros1 else _UNUSED_TEMPLATE if is_template else {}
        yield replace(finding, **left) if is_error else finding


def _is_unused_template(launch: Launch) -> bool:
    """Whether MoveIt's setup assistant has written a launch file for benchmarks or the warehouse, and no text of its package has
    its name."""
    package = launch.package
    if package is None or not is_side_template(launch.path, package.path):
        return False
    own = compile_names((launch.path.name,))
    return not any(map(own.search, read_package_texts(package.path, launch.finder.can_open)))


def _say_for_ros2(finding: Finding) -> Finding:
    """Return a finding with what ROS 2 does: roslaunch starts only files of ROS 1."""
    effects = {("ros2_launch" if name == "roslaunch" else name): text for name, text in finding.consequences.items()}
    if finding.message_id == "syntax":  # whether there is a robot in it is unknown
        effects = {"ros2_launch": "refuses the launch file and starts nothing"}
    elif finding.message_id == "syntax-newer":
        effects = {"ros2_launch": "refuses the launch file on ROS 2 Humble and starts nothing"}
    elif finding.data.get("kind") == _SRDF:
        effects = {"ros2_launch": "stops or starts everything except MoveIt"}
    return replace(finding, consequences=effects)


def _check_launch(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    if launch.python is not None:
        yield from _check_python_launch(launch, launch.python, rule, is_explicit=context.is_explicit)
    for description in launch.descriptions:
        if description.unresolved is not None and not _is_in_template(launch, description.at):
            at = locate_text(description.at, description.file, launch.files)
            is_certain = _has_known_conditions(launch, description.at.owner)
            if not is_certain and _is_chosen_by_argument(description):
                continue
            for finding in _check_description(context, rule, description, obstacle=description.unresolved, at=at):
                yield finding if is_certain else replace(finding, severity=min(finding.severity, Severity.WARNING))
    for include in launch.broken_includes:
        other = _find_package_of_ros2(launch, include.unresolved)
        if _is_in_template(launch, include.at) or (other is not None and _is_for_ros1(launch)):
            continue
        for finding in _check_include(launch, include, rule):
            yield finding if other is None or launch.package is not None else replace(finding, **_LEFT_OVER)


def _is_in_template(launch: Launch, at: Attribute) -> bool:
    """Whether a place is in an included file that a generator fills in before it is launched."""
    file = None if at.span is None else launch.files.get(at.span.file)
    return (
        file is not None and at.span is not None and at.span.file != launch.name and bool(find_placeholder(file.text))
    )


def _find_package_of_ros2(launch: Launch, missing: UnresolvedReason) -> Package | None:
    """Return the package of ROS 2 to which a launch file of ROS 1 leads; None where it leads to another one."""
    if missing.kind != "file" or launch.dialect != "ros1":
        return None
    found = launch.finder.find_package_of(normalise_path(Path(missing.name).absolute()))
    return found if found is not None and is_only_of_ros2(found.root) else None


def _is_for_ros1(launch: Launch) -> bool:
    """Whether the package of a launch file is built by catkin: what it names is of ROS 1, and one of ROS 2 is a namesake."""
    return launch.package is not None and "catkin" in launch.package.dependencies


def _has_known_conditions(launch: Launch, element: Element) -> bool:
    """Whether no ``if`` or ``unless`` around an element is decided by the launch only."""
    root = _find_root(element)
    scopes = [scope for scope in (launch.scope, *launch.scopes.values()) if scope is not None and scope.root is root]
    return all(scope.resolver.has_known_conditions(element) for scope in scopes)


def _is_chosen_by_argument(description: DescriptionSource) -> bool:
    """Whether an argument names what is loaded: the condition around it may ask which value it has."""
    obstacle = description.unresolved
    if obstacle is None or (obstacle.kind == "package" and obstacle.name in description.file):
        return False
    return obstacle.kind in {"file", "package", "empty"} and "$(" in _OTHER.sub("", description.file)


def _check_include(launch: Launch, include: BrokenInclude, rule: Rule) -> Iterator[Finding]:
    """Report an include whose file or argument does not exist."""
    at, name = include.at, include.unresolved.name
    file = None if at.span is None else launch.files.get(at.span.file)
    if include.unresolved.kind == "file":
        including = [launch.path] if file is None else [launch.path, file.path]  # one that includes itself never ends
        is_ros2 = launch.dialect == "ros2"

        def is_right(path: Path) -> bool:
            is_possible = can_be_included(path, name, including, launch.finder)
            return is_possible and takes_arguments(path, include, launch.finder, is_ros2=is_ros2)

        beside = _describe_neighbours(name, launch.finder, is_right)
        replaced = _find_replaced_default(launch, at, at.value)
        value = _describe_deciding_values(launch, at, at.value)
        message = "default" if replaced else "backslash" if find_slashed_file(Path(name), launch.finder) else "file"
        yield rule.finding(f"include-{message}", at=at, path=name, value=value, **beside, **replaced)
    elif include.unresolved.kind == "circle":
        yield rule.finding("include-circle", at=at, path=name)
    else:
        names = [argument.get("name") for argument in list_declared_arguments(_find_root(at.owner))]
        # One without a default gets its value at launch.
        if not may_be_declared(name, names) and _find_giver(launch, at, name) is None:
            near = format_name_hint(name, names)
            yield rule.finding(
                "include-argument",
                at=at,
                file=at.value,
                argument=name,
                near=near,
                unless=_describe_command(launch, at, name),
                repair=_describe_argument_repair(include, near, launch.finder),
            )


def _find_replaced_default(launch: Launch, path: Attribute, typed: str) -> dict[str, Any]:
    """Return an argument of a launch file that decides a path and to which another one that includes it passes a value, with that
    file; else nothing.

    What the other one passes is judged where it is launched itself.

    :param typed: the path as it is typed, which may be a part of the attribute.
    """
    declared = {argument.get("name") for argument in launch.arguments if "default" in argument.attributes}
    for argument in _list_deciding_arguments(launch, path, typed):
        if argument in declared:
            callers = [*find_passing_files(launch, argument), *find_inheriting_files(launch, argument)]
            others = [caller for caller in callers if _may_include(caller, launch)]
            if others:
                return {"argument": argument, "caller": others[0].name, "severity": Severity.INFO}
    return {}


def _list_deciding_arguments(launch: Launch, path: Attribute, typed: str) -> list[str]:
    """Return the arguments of a launch file on which a path depends: it may be that of an included file, and their values may be
    parts of other arguments."""
    found = _trace_arguments(launch, path, typed)
    return [name for root, name in found if launch.scope is not None and root is launch.scope.root]


def _describe_deciding_values(launch: Launch, path: Attribute, typed: str) -> str:
    """Say where the words of a path are typed that are arguments, before a repair says to correct the path; empty without one."""
    found: dict[Attribute, str] = {}
    for (_, name), values in _trace_arguments(launch, path, typed).items():
        found |= {value: name for value in values if "/" not in value.value and "$(" not in value.value}
    parts = [
        f"{value.value!r} of argument {name} ({value.span.file}:{value.span.line})"
        for value, name in found.items()
        if value.span is not None and value.span.file in launch.files
    ]
    return f"the value {' or '.join(parts)}, or " if 0 < len(parts) <= _MOST_VALUES else ""


def _trace_arguments(launch: Launch, path: Attribute, typed: str) -> dict[tuple[Element, str], list[Attribute]]:
    """Return the arguments on which a path depends, by the files that have them, each with where its value is typed there or
    where the include passes it."""
    scopes = [(None, launch.scope), *launch.scopes.items()]
    places = {scope.root: (include, scope.resolver.values) for include, scope in scopes if scope is not None}
    own = [path.owner.get("name")] if path.owner.tag in {"arg", "let"} and path.owner.parent is not None else []
    root = _find_root(path.owner)
    pending = [(root, name) for name in (*own, *_READ.findall(typed))]
    seen: dict[tuple[Element, str], list[Attribute]] = {place: [] for place in pending}
    while pending:
        place = pending.pop()
        root, name = place
        include, values = places.get(root, (None, {}))
        if name in values:
            seen[place] = [values[name]]
            values_read = [(root, other) for other in _READ.findall(values[name].value)]
        elif include is not None:  # passed to the included file: typed there, or with all
            passing = [child.attributes for child in include.children if child.get("name") == name]
            seen[place] = [attributes["value"] for attributes in passing if "value" in attributes]
            texts = [attribute.value for attribute in seen[place]] or [f"$(arg {name})"]
            around = _find_root(include)
            values_read = [(around, other) for text in texts for other in _READ.findall(text)]
        else:
            values_read = []
        pending += [value for value in values_read if value not in seen]
        seen.update({value: [] for value in values_read if value not in seen})
    return seen


def _find_giver(launch: Launch, at: Attribute, argument: str) -> Path | None:
    """Return a file with which a launch file has an argument that it does not declare: one that includes it, or one with a
    command that starts it. Those that it includes do not get it."""
    if at.span is None or at.span.file != launch.name:
        return None
    including = (file for file in find_inheriting_files(launch, argument) if _may_include(file, launch))
    return next(including, None) or find_starting_command(launch.path, argument, launch.finder)


def _describe_command(launch: Launch, at: Attribute, argument: str) -> str:
    """Say that the command which starts a launch file may give an argument that it does not declare: it takes any."""
    is_own = at.span is not None and at.span.file == launch.name
    return f", unless its command line has {argument}:=…" if is_own else ""


def _may_include(caller: Path, launch: Launch) -> bool:
    """Whether another launch file that includes one of this name means this one: it is in its package, or names that."""
    own, package = launch.package, launch.finder.find_package_of(caller.absolute())
    if os.path.realpath(caller) == os.path.realpath(launch.path):
        return False
    if own is None or (package is not None and package.path == own.path):
        return True
    name = re.escape(own.name)
    named = re.compile(rf"\bfind(?:-pkg-share)?\s+{name}\s*\)|[\"']{name}[\"']")
    return named.search(read_text_or_nothing(caller)) is not None


def _describe_argument_repair(include: BrokenInclude, near: str, finder: PackageFinder) -> str:
    """Say how an include gets along whose line passes on an argument that is not declared: as the included file takes it."""
    name = include.unresolved.name
    deletion, is_taken = describe_handing(include.handed, include.file, finder)
    declaration = f'declare the argument{near}: `<arg name="{name}" default="…"/>`'
    if _is_read_elsewhere(include, name):
        return declaration if is_taken else f"{declaration}; and {deletion}"
    if not is_taken:
        return deletion
    return f"{declaration}; or {deletion}" if deletion else declaration


def _is_read_elsewhere(include: BrokenInclude, name: str) -> bool:
    """Whether the launch file with an include reads an argument also where it passes none on to an included file."""
    word = compile_names((name,))
    return any(
        word.search(piece)
        for element in _find_root(include.at.owner).walk()
        if element.parent is None or element.parent.tag != "include"
        for text in (element.text, *(attribute.value for attribute in element.attributes.values()))
        for piece in text.split("$(")[1:]
    )


def _check_description(
    context: LaunchContext, rule: Rule, description: DescriptionSource, *, obstacle: UnresolvedReason, at: Location
) -> Iterator[Finding]:
    """Report why a launch file cannot load its description."""
    launch = context.launch
    build_unknown = partial(_build_unknown_finding, rule, at, is_explicit=context.is_explicit)
    path = _find_launch_file(description, launch)
    empty = _find_empty_argument(launch, description, obstacle.name) if obstacle.kind == "package" else ""
    if empty:  # it is to be given, and is a part of the package's name
        yield build_unknown(f"argument {empty!r} is empty")
    elif obstacle.kind == "package":
        yield _check_package(launch, rule, description, obstacle.name, at, build_unknown)
    elif obstacle.kind == "argument":
        yield from _check_argument(launch, rule, description, obstacle.name, at, build_unknown)
    elif obstacle.kind == "empty":  # like an argument without a default
        if not is_included_by_sibling(path):
            yield build_unknown(f"argument {obstacle.name!r} is empty")
    elif obstacle.kind == "relative":
        yield _build_relative_finding(rule, launch, at, obstacle.name, path)
    elif _is_for_ros1(launch) and (other := _find_package_of_ros2(launch, obstacle)) is not None:
        yield build_unknown(f"package {other.name!r} is of ROS 2 here")
    elif obstacle.kind == "file" and _is_generated(obstacle.name, path):
        yield build_unknown(f"git ignores {obstacle.name}, so it is probably generated")
    elif obstacle.kind == "file" and (made := _describe_maker(obstacle.name, launch.finder)) is not None:
        yield build_unknown(made[0], repair=made[1])
    elif obstacle.kind == "file" and _is_written_here(obstacle.name, launch):
        yield build_unknown(f"the launch file writes {Path(obstacle.name).name} itself")
    elif obstacle.kind == "file":
        is_right = partial(makes_robot, finder=launch.finder)
        beside = _describe_neighbours(obstacle.name, launch.finder, is_right, is_expanded=description.uses_xacro)
        replaced = _find_replaced_default(launch, description.at, description.file)
        value = _describe_deciding_values(launch, description.at, description.file)
        is_slashed = find_slashed_file(Path(obstacle.name), launch.finder) is not None
        message = "file-default" if replaced else "backslash" if is_slashed else "file"
        yield rule.finding(message, at=at, path=obstacle.name, value=value, **beside, **replaced)
    elif obstacle.kind == "circle":
        yield rule.finding("circle", at=at, file=description.file)
    elif obstacle.kind == "written":
        yield build_unknown(f"{obstacle.name} is written on the robot's computer")
    else:
        typed = textwrap.shorten(description.file, _SHOWN, placeholder=" …")
        yield build_unknown(f"computed by `{typed}`")


def _find_empty_argument(launch: Launch, description: DescriptionSource, package: str) -> str:
    """Return the argument with an empty default without which the name of a package lacks its begin or its end; empty if it is
    whole."""
    if package.strip("_-") == package:
        return ""
    found = _trace_arguments(launch, description.at, description.file).items()
    return next((name for (_, name), values in found if any(not value.value for value in values)), "")


def _check_package(
    launch: Launch,
    rule: Rule,
    description: DescriptionSource,
    name: str,
    at: Location,
    build_unknown: Callable[..., Finding],
) -> Finding:
    """Report a package that is not found in what a launch file loads."""
    path = _find_launch_file(description, launch).absolute()
    package = launch.finder.find_package_of(path)
    checkout = propose_checkout(name, launch.finder)
    if _is_in_rosbuild_package(description.file, launch.finder):
        return build_unknown(f"rosbuild finds package {name!r} only in a folder of this name")
    clone = propose_clone(name, launch.finder)
    is_elsewhere = name in read_released_packages() or bool(clone)
    # Without a package.xml nothing can depend on it.
    if (package is None and is_elsewhere) or (
        package is not None and find_dependent(package, name, launch.finder) is not None
    ):
        return build_unknown(
            f"the submodule of package {name!r} is not checked out"
            if checkout
            else f"package {name!r} is not installed here",
            repair=checkout or clone or "install the package, or run urdfcheck on the model file",
        )
    names = _suggest_packages(launch, description, name, package)
    near = _format_suggestions(names)
    declaration = describe_declaration(package, name, launch.finder, shown="it")
    folder = _find_folder_without_manifest(name, path, launch.finder) if package is None else None
    severity = None
    if folder is not None:
        build = format_path(folder / "CMakeLists.txt")
        near, repair = (
            f" ({build} has this name, without a package.xml beside it)",
            f"add a package.xml of this name beside {build}",
        )
    elif checkout:
        near, repair = " (its submodule is not checked out)", f"{checkout}{declaration}"
    elif package is not None and is_elsewhere and not near:
        repair = f"{clone or 'install it'}{declaration}"
        if not _has_own_model(package):  # what is not declared is PKG007's
            return build_unknown(f"package {name!r} is not installed here", repair=repair)
        # The file may be another robot's, copied as a beginning.
        repair += ", if that robot is meant; else name the model of this package"
        severity = Severity.WARNING
    else:
        place = "" if _have_file(names, description.file, launch.finder) else " and the path"
        repair = f"correct the package name{place}{near}, or install it{declaration}"
        repair = add_checkout(repair, name, launch.finder)
    return rule.finding(
        "package",
        at=at,
        severity=severity,
        file=description.file,
        package=name,
        near=near,
        undeclared="" if package is None else " and package.xml does not depend on it",
        repair=repair,
    )


def _find_folder_without_manifest(name: str, path: Path, finder: PackageFinder) -> Path | None:
    """Return the folder around a file whose build gives it the name of a package: it is one as soon as it has a package.xml."""
    project = re.compile(rf"(?im)^[ \t]*project[ \t]*\([ \t]*{re.escape(name)}[ \t)]")
    top = find_project_folder(path)
    builds = (folder / "CMakeLists.txt" for folder in path.parents if folder == top or top in folder.parents)
    named = (file.parent for file in builds if finder.can_open(file) and project.search(read_text_or_nothing(file)))
    return next(named, None)


def _build_relative_finding(rule: Rule, launch: Launch, at: Location, typed: str, file: Path) -> Finding:
    """Report a path that is right for one who starts the launch file in its own folder."""
    place = normalise_path(file.absolute().parent / typed)
    package = launch.finder.find_package_of(file.absolute())
    is_inside = package is not None and package.path in place.parents
    find = "find" if launch.dialect == "ros1" else "find-pkg-share"
    return rule.finding(
        "relative",
        at=at,
        severity=Severity.WARNING,
        path=typed,
        folder=format_path(file.absolute().parent),
        better=f"$({find} {package.name})/{place.relative_to(package.path).as_posix()}"
        if package is not None and is_inside
        else f"$(dirname)/{typed}",
    )


def _check_argument(
    launch: Launch,
    rule: Rule,
    description: DescriptionSource,
    name: str,
    at: Location,
    build_unknown: Callable[[str], Finding],
) -> Iterator[Finding]:
    """Report an argument without a value in what a launch file loads."""
    names = [argument.get("name") for argument in list_declared_arguments(_find_root(description.at.owner))]
    if may_be_declared(name, names):  # one without a default gets its value at launch, or from another file
        if not is_included_by_sibling(_find_launch_file(description, launch)):
            yield build_unknown(f"argument {name!r} has no default")
        return
    giver = _find_giver(launch, description.at, name)
    if giver is not None:
        yield build_unknown(f"{giver.name} passes argument {name!r}")
    else:
        near = format_name_hint(name, names)
        unless = _describe_command(launch, description.at, name)
        # The whole path is to be said at launch: only the declaration is missing.
        is_asked = bool(unless) and not near and _READ.fullmatch(description.file) is not None
        yield rule.finding(
            "argument",
            at=at,
            severity=Severity.WARNING if is_asked else None,
            file=description.file,
            argument=name,
            near=near,
            unless=unless,
        )


def _has_own_model(package: Package) -> bool:
    """Whether a package has model files."""
    return any(name.endswith(MODEL_SUFFIXES) for name in index_files([package.path]))


def _is_generated(name: str, launch: Path) -> bool:
    """Whether git ignores a missing file."""
    return is_git_ignored(Path(name).absolute(), FileReach.from_paths([launch], []))


def _is_written_here(name: str, launch: Launch) -> bool:
    """Whether a command of a launch file, or of one that it includes, writes a missing model."""
    scopes = (launch.scope, *launch.scopes.values())
    return writes_file((scope.root for scope in scopes if scope is not None), Path(name).name)


def _describe_maker(name: str, finder: PackageFinder) -> tuple[str, str] | None:
    """Say what makes a missing model in its package, which may be one of rosbuild, with the repair; None without such a file."""
    path = normalise_path(Path(name).absolute())
    package = finder.find_package_of(path)
    around = (folder for folder in path.parents if finder.can_open(folder))
    folder = next(filter(is_rosbuild_package, around), None) if package is None else package.path
    maker = None if folder is None else find_maker(path, folder, FileReach.from_paths([folder], []))
    template = None if folder is None or maker is not None else find_template(path, folder)
    if template is not None and finder.can_open(template):
        return (
            f"the build makes {path.name} from {format_path(template)}",
            f"build the package, which makes {path.name}",
        )
    if maker is None:
        return None
    how = f"make {path.name} before the launch ({format_path(maker)})"
    return f"{maker.name} makes {path.name} with xacro", f"{how}; urdfcheck reads the xacro file that it is made from"


def _build_unknown_finding(
    rule: Rule, at: Location, reason: str, *, is_explicit: bool, repair: str = "run urdfcheck on the model file"
) -> Finding:
    """Report a description that is known only at launch; with the whole folder its models are checked as files."""
    message = "unknown" if is_explicit else "computed"
    return rule.finding(message, at=at, severity=Severity.INFO, reason=reason, repair=repair)


def _choose_trial(path: str, launch: Launch, *, is_model: bool) -> Trial:
    """Return what decides whether another file would do instead of one that a launch file in Python names."""
    if not is_model:
        return partial(can_be_included, wanted=path, including=[launch.path], finder=launch.finder)
    return partial(is_semantic if path.lower().endswith(SRDF_SUFFIXES) else makes_robot, finder=launch.finder)


def _check_python_launch(launch: Launch, python: PythonLaunch, rule: Rule, *, is_explicit: bool) -> Iterator[Finding]:
    finder = launch.finder
    problem = python.syntax_problem
    if problem is not None:
        is_newer = problem.kind == "newer"
        yield rule.finding(
            "syntax-newer" if is_newer else "syntax",
            at=problem.location,
            severity=Severity.INFO if is_newer else Severity.WARNING,
            error=problem.message,
        )
    lost = [
        *(("named", named) for named in python.missing_models),
        *(("include-file", named) for named in python.missing_includes),
    ]
    for message, named in lost:
        path = format_path(Path(named.path))
        made = _describe_maker(path, finder) if message == "named" else None
        if made is not None:
            yield _build_unknown_finding(rule, named.location, made[0], is_explicit=is_explicit, repair=made[1])
            continue
        is_slashed = find_slashed_file(Path(path), finder) is not None
        slashed = "backslash" if message == "named" else "include-backslash"
        yield rule.finding(
            slashed if is_slashed else message,
            at=named.location,
            severity=Severity.WARNING,
            confidence=Confidence.STRONG,
            path=path,
            value="",
            kind=_SRDF if path.lower().endswith(SRDF_SUFFIXES) else "model",
            **_describe_neighbours(
                path,
                finder,
                _choose_trial(path, launch, is_model=message == "named"),
                is_expanded=python.runs_xacro or message != "named",
            ),
        )
    for named in python.unknown_models:
        message = "depends" if named.depends_on else "unfound"
        reason = f"depends on `{named.depends_on}`" if named.depends_on else "was found in no package here"
        yield rule.finding(
            message if is_explicit else "computed",
            at=named.location,
            severity=Severity.INFO,
            path=named.path,
            variable=named.depends_on,
            reason=f"{'the folder of ' * bool(named.depends_on)}{named.path} {reason}",
        )
    if python.description_location is not None and not (
        python.models or python.missing_models or python.unknown_models
    ):
        reason = "no model that the file names was found"
        yield _build_unknown_finding(rule, python.description_location, reason, is_explicit=is_explicit)


def _find_launch_file(description: DescriptionSource, launch: Launch) -> Path:
    """Return the launch file, included or not, that contains a description."""
    span = description.at.span
    file = None if span is None else launch.files.get(span.file)
    return launch.path if file is None else file.path


def _find_root(element: Element) -> Element:
    while element.parent is not None:
        element = element.parent
    return element


def _is_in_rosbuild_package(text: str, finder: PackageFinder) -> bool:
    """Whether the file is in the package of rosbuild around the launch file, whose folder has another name here."""
    folder = next((level for level in finder.list_parent_folders() if is_rosbuild_package(level)), None)
    places = [] if folder is None else [folder / name for name in _list_files(text)]
    return any(finder.can_open(place) and place.is_file() for place in places)


def _suggest_packages(launch: Launch, description: DescriptionSource, name: str, own: Package | None) -> list[str]:
    """Return the packages with similar names that have the file, or else the launch file's own if it has it or a similar name."""
    alike, files = launch.finder.suggest_names(name), _list_files(description.file)
    if own is not None and any((own.path / file).is_file() for file in files):
        return [own.name]
    return launch.finder.suggest_names(name, files) or [
        other for other in alike if own is not None and other == own.name
    ]


def _list_files(text: str) -> list[str]:
    """Return the path that is typed behind the name of a package, without the name; nothing if it is computed."""
    inside = _BEHIND_PACKAGE.search(text)
    return [] if inside is None else [inside[1]]


def _have_file(names: Sequence[str], text: str, finder: PackageFinder) -> bool:
    """Whether one of these packages has the file that is typed behind another name; true where that is computed."""
    files = _list_files(text)
    if not names or not files:
        return True
    folders = [folder for name in names if (folder := finder.find(name)) is not None]
    places = [finder.find_source(folder / file) for folder in folders for file in files]
    return any(finder.can_open(place) and place.is_file() for place in places)


def _format_suggestions(names: list[str]) -> str:
    return f" (did you mean {' or '.join(map(repr, names))}?)" if names else ""


def _describe_neighbours(
    path: str, finder: PackageFinder, is_right: Trial, *, is_expanded: bool = True
) -> dict[str, Any]:
    """Return what a message says about the folder of a missing file, and what the repair takes from it.

    ``is_right``: whether another file would do; ``is_expanded``: whether xacro expands the file.
    """
    near = describe_meant_file(path, finder, is_right, is_expanded=is_expanded)
    return {
        "near": near,
        "meant": near if near.startswith(" (") else "",
        "version": _describe_version(Path(path), finder),
    }


def _describe_version(path: Path, finder: PackageFinder) -> str:
    """Say that another version of the package that lacks a file may have it, where it is not the launch file's own project, or
    that the package may have more elsewhere, where it has no file of the kind here."""
    place = normalise_path(path.absolute())
    foreign = finder.find_foreign_package(place)
    if foreign is not None:
        return f", get the version of {foreign.name} that has the file"
    package, own = finder.find_package_of(place), finder.find_package_of(finder.start.absolute() / "package.xml")
    if package is None or (own is not None and package.path == own.path):
        return ""
    suffixes = LAUNCH_SUFFIXES if is_launch(path) else MODEL_SUFFIXES
    has_any = any(name.endswith(suffixes) for name in index_files([package.path]))
    return "" if has_any else f", get all of {package.name} if the folder here is a placeholder or a part of it"
