"""PKG007 reports packages that a package uses but does not declare as dependencies."""

from __future__ import annotations

import os
import re
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path, PurePosixPath

from urdfcheck.core import Edit, Finding, Rule, Severity, Span
from urdfcheck.core.text import compile_names, join_names
from urdfcheck.source.launch.around.passing_files import is_off_by_default
from urdfcheck.source.package.alternatives import select_alternatives
from urdfcheck.source.package.build_files import name_launch_command, read_generation
from urdfcheck.source.package.built_packages import is_out_of_build
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES, is_launch, is_model
from urdfcheck.source.package.finder import (
    Package,
    format_path,
    has_dependency_entry,
    is_kept_aside,
    is_unnamed_copy,
    load_package,
)
from urdfcheck.source.package.installed_folders import InstallRules, read_install_rules
from urdfcheck.source.package.package_folders import TEST_FOLDERS, read_manifest_name
from urdfcheck.source.package.references import (
    PackageMention,
    iter_package_files,
    iter_started_packages,
    list_mentioned_packages,
    mentions_package,
    read_package_contents,
)
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.package.similar_files import (
    find_empty_folder,
    find_similar_name,
    list_missing_submodules,
    propose_clone,
    select_similar_submodules,
)
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.ros.dependencies import COLLECTIONS, collect_dependencies, has_part
from urdfcheck.source.ros.setup_templates import is_left_out_by_template
from urdfcheck.source.text.remembered import text_fact
from urdfcheck.source.text.xml import COMMENT, Element, SourceFile, XmlError, parse_xml
from urdfcheck.system.files import read_regular, read_text_or_nothing

_EXAMPLE_FOLDERS = frozenset({"example", "examples"})
# Folders of what others have made, by their names in lower case.
_VENDORED_FOLDERS = frozenset(
    {"3rd_party", "3rdparty", "external", "third-party", "third_party", "thirdparty", "vendor"}
)
# PKG001 reports unknown packages that other files name.
_LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".py")
_ROS1_LAUNCH = re.compile(r"\$\(find\s|<node\b[^<>]*\stype\s*=")
# The program that a node of a launch file starts.
_PROGRAM = re.compile(r"""\b(?:type|exec)\s*=\s*["']([^"']+)["']""")
# Files of a robot: a package of this repository that has one of the same name is where a mention of no known package leads.
_ROBOT_SUFFIXES = (".urdf", ".xacro", ".sdf", *MESH_SUFFIXES)
# A dependency in a comment of package.xml.
_DEPEND = re.compile(r"<\w*depend\b[^<>]*>\s*([\w.-]+)\s*</\w*depend>")
# What a comment says of a package that is not declared on purpose.
_LEFT_OUT = re.compile(r"(?i)\bnot\b|\bfrom source\b|\bintentional|\bomit|\bleft out\b|\bon purpose\b")
# Messages about packages that cannot both declare each other.
_MUTUAL = frozenset({"circle", "mutual", "presumed-circle", "ring"})
# Messages about lines to add to package.xml.
_MISSING_LINES = frozenset({"undeclared", "several"})
# Messages about packages that are not found.
_UNKNOWN = frozenset({"unknown", "unknown-several"})
# The setup assistant writes MoveIt's address into each package of such a name.
_CONFIG_SUFFIX = "_moveit_config"
# What the names of packages that start a robot end with, where its model is in one that ends with the first.
_MODEL_SUFFIX = "_description"
_STARTER_SUFFIXES = ("_bringup", "_control", "_gazebo", "_moveit_config", "_simulation")
# Released packages without files: one of such a name that has a file is the author's.
_METAPACKAGES = frozenset(
    {
        *("desktop", "desktop_full", "perception", "robot", "ros_base", "ros_core", "simulators", "viz"),
        *("gazebo_ros_pkgs", "moveit", "navigation", "navigation2", "ros2_control", "ros2_controllers", "ros_control"),
        *("ros_controllers", "ros_gz", "universal_robot"),
    }
)
# What a package that has a build may still need.
_BUILT = "; if a build makes the file, declare {name}: `{line}`"
# The default of an argument in a launch file; in Python the package may be named so many lines below the word.
_DEFAULT = re.compile(r"\bdefault(?:_value)?\s*=")
_DEFAULT_LINES = 4
# What every installation of ROS has (its package ros_core), by the program that reads the launch files.
_IN_ROS_CORE = {
    "roslaunch": frozenset(
        {"rosbag", "rosmsg", "rosnode", "rosparam", "rosservice", "rostopic", "roswtf", "topic_tools"}
    ),
    "ros2_launch": frozenset({"rclcpp_components"}),
}
# Programs of ROS 1 that no distribution of ROS 2 has: what a launch file needs is another package (LCH003).
_ONLY_IN_ROS1 = frozenset({"rviz", "tf", "roslaunch"})
# A file that is part of the sources: others are made by the build.
_PLAIN_FILE = re.compile(r"^[^$*]*\.(?:urdf|xacro|launch|xml|yaml|dae|stl|rviz)$", re.IGNORECASE)
_VIEW_SUFFIX = ".rviz"
_SHAPE_FOLDERS = frozenset({"mesh", "meshes", "textures", "materials"})
# So many packages of the repository are read for one through which another uses this package.
_MOST_IN_CHAIN = 40
# So many places a repair names from which packages that are not found are obtained.
_MOST_PLACES = 3
# So many files of each package of the repository are compared.
_MOST_FILES = 20_000


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    root, file = package.root, package.file
    if root is None or file is None or root.tag != "package" or is_out_of_build(package.path, package.finder):
        return
    # A line that is commented out was left out on purpose, and with it what the package brings: MoveIt's setup assistant leaves
    # out gazebo_ros_control so that nothing installs Gazebo. Its ROS 2 templates have the same line for a package of ROS 1.
    commented = _list_commented_dependencies(file.text)
    if name_launch_command(root) == "roslaunch":
        commented |= collect_dependencies(package.finder, commented)
    declared = {package.name, *package.dependencies, *commented}
    undeclared: dict[str, list[PackageMention]] = {}
    for mention in read_package_contents(package).mentions:
        if mention.package not in declared and not mention.optional and not _is_aside(mention, package):
            undeclared.setdefault(mention.package, []).append(mention)
    undeclared = {name: uses for name, uses in undeclared.items() if not _is_explained(name, file.text)}
    missing = _select_missing(package, undeclared) if undeclared else {}
    places = {name: folder for name in missing if (folder := _find_package(package, name)) is not None}
    for name in [name for name, folder in places.items() if is_out_of_build(folder, package.finder)]:
        del missing[name]  # no build tool or rosdep would find it
    _drop_stray_uses(package, missing)
    named = set(missing)
    for name, line in _find_slips(package, root, missing).items():
        del missing[name]
        yield rule.finding(
            "misspelt",
            at=line,
            edits=_propose_name(line, file, name),
            name=name,
            names=[name],
            package=package.name,
            typed=line.text.strip(),
        )
    core = _IN_ROS_CORE[name_launch_command(root)]
    programs = _collect_started(package, declared | core) if missing else {}
    programs = {name: uses for name, uses in programs.items() if not _is_explained(name, file.text)}
    # The program of a package that a launch file starts is in no copy of its files, unless the package was renamed.
    own = {name for name, uses in programs.items() if name in missing and all(_is_of_own(use, package) for use in uses)}
    homes = {
        name: _find_home(package, name, uses) for name, uses in missing.items() if name not in programs.keys() - own
    }
    misnamed = {name: home for name, home in homes.items() if home is not None}
    for name, home in misnamed.items():
        yield _build_misnamed_finding(
            package, rule, root, name=name, uses=missing.pop(name), home=home, is_renamed=name in own
        )
    missing = _drop_uses_of_ros1(missing, root)
    for name in [n for n, uses in missing.items() if not (_find_package(package, n) or _are_in_launch_files(uses))]:
        del missing[name]  # a folder of that name is no package
    unknown = [name for name in missing if not _is_known(package, name)]
    for name in _select_left_out(package, unknown):
        unknown.remove(name)
        del missing[name]
    unfound = {name: missing.pop(name) for name in unknown}
    yield from _build_unknown_findings(package, rule, root, file, unfound)
    for name, (message, chain) in _find_circles(package, missing).items():
        found = {name: missing.pop(name)}
        yield _build_finding(package, rule, root, file, message=message, missing=found, chain=chain)
    for name in [name for name, uses in missing.items() if all(_leads_nowhere(use, package) for use in uses)]:
        yield _build_finding(package, rule, root, file, message="dangling", missing={name: missing.pop(name)})
    for name in [name for name in missing if _is_probably_above(package, name)]:
        yield _build_finding(package, rule, root, file, message="presumed-circle", missing={name: missing.pop(name)})
    chosen = select_alternatives(package, read_package_contents(package).mentions, missing)
    if chosen:
        yield _build_finding(
            package, rule, root, file, message="alternatives", missing={name: missing.pop(name) for name in chosen}
        )
    if missing and not _is_as_released(package, missing):
        without = named | (_ONLY_IN_ROS1 if name_launch_command(root) == "ros2_launch" else set())
        known = {name: uses for name, uses in programs.items() if name not in without and _is_known(package, name)}
        started = {name: uses for name, uses in known.items() if not _is_above(package, name)}
        missing |= _drop_uses_of_ros1(_select_missing(package, started), root)
        message = "undeclared" if len(missing) == 1 else "several"
        yield _build_finding(package, rule, root, file, message=message, missing=missing)


def _find_slips(package: Package, root: Element, missing: Iterable[str]) -> dict[str, Element]:
    """Return the packages of the repository that package.xml declares with a slip in the name, each with that line."""
    dependencies = (e for e in root.children if e.tag.endswith("depend"))
    unknown = {name: e for e in dependencies if (name := e.text.strip()) and not _is_known(package, name)}
    slips: dict[str, Element] = {}
    for name in missing:
        near = None if _find_package(package, name) is None else find_similar_name(name, unknown)
        if near is not None:
            slips[name] = unknown[near]
    return slips


def _propose_name(line: Element, file: SourceFile, name: str) -> list[Edit]:
    """Return the edit of the name in a dependency's line."""
    start = -1 if line.span is None else file.text.find(line.text.strip(), line.span.start)
    if start < 0:
        return []
    typed = line.text.strip()
    return [Edit(file.make_span(start, start + len(typed)), typed, name)]


def _list_workspace(package: Package) -> dict[str, Path]:
    return {} if package.finder is None else package.finder.list_workspace_packages()


def _is_as_released(package: Package, missing: Collection[str]) -> bool:
    """Whether a package is one that ROS has released, copied into a repository of packages that it has not, and what it lacks is
    released too: its authors leave that to its users.

    It has the address of its own repository; the author's own package may have the name of a released one by chance.
    """
    released, workspace = read_released_packages(), _list_workspace(package)
    has_address = package.root is not None and package.root.find_child("url") is not None
    if not has_address or package.name not in released or package.name.endswith(_CONFIG_SUFFIX):
        return False
    is_beside_others = any(name not in released for name in workspace)
    return is_beside_others and all(name in released and name not in workspace for name in missing)


def _is_vendored(package: Package) -> bool:
    """Whether a package is in a folder of the repository for what others have made: the line is missing at its author's too."""
    place = Path(os.path.realpath(package.path))
    folders = place.relative_to(find_project_folder(place)).parts[:-1]
    return not _VENDORED_FOLDERS.isdisjoint(folder.lower() for folder in folders)


def _list_commented_dependencies(manifest: str) -> set[str]:
    """Return the names in the ``<…depend>`` lines that comments of a package.xml hold."""
    return {name for comment in COMMENT.findall(manifest) for name in _DEPEND.findall(comment)}


def _is_explained(name: str, manifest: str) -> bool:
    """Whether a comment of a package.xml names a package and says that it is left out: rosdep may not know it.

    The parts of a collection whose line is in a comment are left out with it.
    """
    if has_part(_list_commented_dependencies(manifest) & COLLECTIONS.keys(), name):
        return True
    named = compile_names((name,))
    return any(named.search(comment) and _LEFT_OUT.search(comment) for comment in COMMENT.findall(manifest))


def _select_left_out(package: Package, names: Sequence[str]) -> list[str]:
    """Return those packages of the repository that the build leaves out: a run finds none of them."""
    finder = package.finder
    root = None if finder is None or not names else finder.find_repository()
    if finder is None or root is None:
        return []
    places = {name: folder for name, folder in finder.walk_repository(root) if name in names}
    return [name for name in names if name in places and is_out_of_build(places[name], finder)]


def _select_missing(
    package: Package, undeclared: Mapping[str, list[PackageMention]]
) -> dict[str, list[PackageMention]]:
    """Return the undeclared packages that no declared one brings and that must be declared."""
    covered = collect_dependencies(package.finder, package.dependencies)
    collections = package.dependencies | (covered & COLLECTIONS.keys())
    return {
        name: uses
        for name, uses in sorted(undeclared.items())
        if name not in covered and not has_part(collections, name) and _needs_declaration(name, uses, package)
    }


def _collect_started(package: Package, declared: Collection[str]) -> dict[str, list[PackageMention]]:
    """Return the packages of programs that launch files start: a list of what is missing has those that are known too.

    By themselves they are not reported: many packages of robots leave them to the user.
    """
    started: dict[str, list[PackageMention]] = {}
    install = read_install_rules(package)
    for mention in iter_started_packages(package):
        if mention.package in declared or _is_aside(mention, package):
            continue
        if not _is_stray(mention, package, install):
            started.setdefault(mention.package, []).append(mention)
    return started


def _is_above(package: Package, name: str) -> bool:
    """Whether another package needs this one, or is named as if it did."""
    return (
        package.name in collect_dependencies(package.finder, [name])
        or _uses_files_of(package, name)
        or _is_probably_above(package, name)
        or bool(_find_chain(package, name))
    )


def _build_finding(
    package: Package,
    rule: Rule,
    root: Element,
    file: SourceFile,
    *,
    message: str,
    missing: Mapping[str, Sequence[PackageMention]],
    chain: Sequence[str] = (),
    is_off: bool = False,
) -> Finding:
    """Report packages with one message. ``is_off``: launch files use them only with other arguments than their defaults."""
    runtime = "run_depend" if root.get("format", "1").strip() == "1" else "exec_depend"
    tags = {name: "test_depend" if _are_for_tests(uses, package) else runtime for name, uses in missing.items()}
    if (
        message in _MUTUAL
    ):  # the model needs what it names itself wherever it is loaded, a launch file where it is started
        missing = {name: sorted(uses, key=lambda use: _are_in_launch_files([use])) for name, uses in missing.items()}
    if message == "dangling":  # the file that is missing, before the folder of a default
        missing = {
            name: sorted(uses, key=lambda use: not _PLAIN_FILE.search(use.subpath)) for name, uses in missing.items()
        }
    names = list(missing)
    uses = [use for uses in missing.values() for use in uses]
    missing_modules = list_missing_submodules(package.finder) if package.finder and message in _UNKNOWN else {}
    is_released, is_for_tests = package.name in read_released_packages(), set(tags.values()) == {"test_depend"}
    is_note = message in _MUTUAL and (_are_defaults(uses) or _are_in_launch_files(uses) or is_for_tests)
    # Where ROS has released this package, its users do without what only its author has.
    is_spare = is_released or is_for_tests
    is_note |= message in _UNKNOWN and (is_spare or is_off)
    is_note |= message in _MISSING_LINES and (_is_vendored(package) or (is_released and is_for_tests))
    finding = rule.finding(
        message,
        at=root.find_child("name") or root,
        related=[use.location for uses in missing.values() for use in uses[:3]],
        severity=Severity.INFO if message in {"alternatives", "dangling"} or is_note else None,
        edits=()
        if message in {*_MUTUAL, *_UNKNOWN, "alternatives", "dangling"}
        else _propose_edits(root, file, tags=tags),
        name=names[0],
        names=names,
        listed=join_names(names),
        count=len(names),
        package=package.name,
        file=PurePosixPath(uses[0].subpath.replace("\\", "/")).name,
        path=uses[0].subpath.strip("/"),
        built=""
        if names[0] in _METAPACKAGES
        else _BUILT.format(line=f"<{tags[names[0]]}>{names[0]}</{tags[names[0]]}>", name=names[0]),
        condition=", switched off by default" * is_off,
        tag=tags[names[0]],
        chain=join_names(chain, 4),
        each="it is" if len(names) == 1 else "each is",
        where=", ".join(dict.fromkeys(use.location.span.file for use in missing[names[0]][:2] if use.location.span)),
        places=join_names((f"{name} in {_get_file(uses[0])}" for name, uses in missing.items()), 4),
        lines=" ".join(f"<{tag}>{name}</{tag}>" for name, tag in tags.items()),
        checked_out="what is checked out of the repository" if missing_modules else "the repository",
        distribution=_name_distribution(root, names),
        unfound=_describe_similar(missing, package, message)
        + (_describe_unfound(package, tags, missing_modules) if message in _UNKNOWN else ""),
        idle=_describe_idle_dependency(package, names[0], tags[names[0]]) if message == "circle" else "",
    )
    consequences = _name_launcher(finding.consequences, root)
    if message in _MISSING_LINES:
        consequences = _select_consequences(consequences, names, package)
    return replace(
        finding,
        subjects=tuple(f"package[{package.name}]/{tag}[{name}]" for name, tag in tags.items()),
        consequences=consequences,
    )


def _name_distribution(root: Element, names: Iterable[str]) -> str:
    """Name the distributions that have none of these packages, and those that have some of them."""
    generation = read_generation(root)
    others = sorted(read_released_packages() & {*names})
    if generation is None or not others:
        return "a ROS distribution"
    return f"a distribution of ROS {generation} (ROS {3 - generation} has {join_names(others, 3)})"


def _build_unknown_findings(
    package: Package, rule: Rule, root: Element, file: SourceFile, unfound: Mapping[str, list[PackageMention]]
) -> Iterator[Finding]:
    """Report the packages that are not found; those that launch files use only on request are a separate finding."""
    off = {name for name, uses in unfound.items() if all(_is_off(use, package) for use in uses)}
    for names in (unfound.keys() - off, off):
        missing = {name: uses for name, uses in unfound.items() if name in names}
        if missing:
            message = "unknown" if len(missing) == 1 else "unknown-several"
            is_off = names is off
            yield _build_finding(package, rule, root, file, message=message, missing=missing, is_off=is_off)


def _select_consequences(consequences: Mapping[str, str], names: Collection[str], package: Package) -> dict[str, str]:
    """Leave out what rosdep does if all packages are in the workspace, and what colcon does if none is: each has its own."""
    beside = _list_workspace(package).keys() & {*names}
    silent = {"colcon"} if not beside else {"rosdep"} if len(beside) == len(names) else set()
    return {name: sentence for name, sentence in consequences.items() if name not in silent}


def _describe_similar(missing: Mapping[str, Sequence[PackageMention]], package: Package, message: str) -> str:
    """Name the packages that are meant by those that are not found: the manifest in a folder of that name has another one, or a
    package of a similar name has one of the files."""
    if message not in _UNKNOWN or package.finder is None:
        return ""
    alike: list[str] = []
    last = "; else " if len(missing) == 1 else "; "
    for name, uses in missing.items():
        folder = package.finder.find(name)
        other = None if folder is None else read_manifest_name(folder)
        if folder is not None and other is not None:
            return f"write `{other}` for {name}: package.xml of {format_path(folder)} has this name{last}"
        files = {use.subpath.strip("/") for use in uses if "." in use.subpath and "$" not in use.subpath}
        near = package.finder.suggest_names(name, files) if files else []
        if len(near) == 1:
            alike.append(f"write `{near[0]}` for {name} if that is meant: it has the file")
    return f"{alike[0]}{last}" if len(alike) == 1 else ""


def _describe_unfound(package: Package, tags: Mapping[str, str], missing_modules: Mapping[str, str]) -> str:
    """Say what to do about packages that are not found; ``tags``: the kind of each that would be declared."""
    names = list(tags)
    lines = " ".join(f"`<{tags[name]}>{name}</{tags[name]}>`" for name in names)
    one = len(names) == 1
    places = {name: place for name in names if (place := _describe_place(name, package))}
    shared = {place: [name for name in places if places[name] == place] for place in places.values()}
    shown = list(islice(shared.items(), _MOST_PLACES))
    known = "".join(f"{place}; " if one else f"{join_names(there, 3)}: {place}; " for place, there in shown)
    if len(places) == len(names):
        return f"{known}declare {'it' if one else 'them'}: {lines}"
    submodules = select_similar_submodules(missing_modules, names)
    if submodules:
        here = f"declare {'it if it is' if one else 'those that are'} in a submodule that is not checked out"
        known += f"{here} ({join_names(submodules, 3)}) or elsewhere: {lines}; correct "
        return known + ("an old name" if one else "old names")
    if one:
        return f"correct the name if it is an old one; if it is built from source, declare it: {lines}"
    return f"{known}correct the names that are old ones; declare those that are built from source: {lines}"


def _describe_place(name: str, package: Package) -> str:
    """Say how a package that is not found is obtained, as far as the project shows."""
    finder = package.finder
    clone = "" if finder is None else propose_clone(name, finder)
    top = None if clone or finder is None else finder.find_repository()
    empty = None if finder is None or top is None else find_empty_folder(name, top, finder)
    if empty is None:
        return clone
    return (
        f"{format_path(empty)} is empty, as git leaves a repository in another that no .gitmodules names: add its files"
    )


def _name_launcher(consequences: Mapping[str, str], root: Element) -> dict[str, str]:
    """Give what the page says about roslaunch to the program that reads the launch files of a package with this manifest."""
    launcher = name_launch_command(root)
    return {launcher if name == "roslaunch" else name: sentence for name, sentence in consequences.items()}


def _get_file(use: PackageMention) -> str:
    return "" if use.location.span is None else use.location.span.file


def _is_known(package: Package, name: str) -> bool:
    """Whether a package exists: it is found, the ROS of this package has released it, or another package here depends on it."""
    if name in read_released_packages(read_generation(package.root)):
        return True
    if package.finder is None:
        return False
    if _find_package(package, name) is not None:
        return True
    folders = package.finder.list_workspace_packages().values()
    return any(has_dependency_entry(folder, name) for folder in folders if folder != package.path)


def _find_package(package: Package, name: str) -> Path | None:
    return None if package.finder is None else package.finder.find_by_manifest(name)


def _is_probably_above(package: Package, name: str) -> bool:
    """Whether a package that is not found is named like those that start the robot of this package, and so depend on it."""
    stem = package.name.removesuffix(_MODEL_SUFFIX)
    return (
        stem != package.name
        and name in {stem + suffix for suffix in _STARTER_SUFFIXES}
        and _find_package(package, name) is None
    )


def _drop_stray_uses(package: Package, missing: dict[str, list[PackageMention]]) -> None:
    """Leave out the packages that are not found and that only files name to which nothing leads."""
    install = read_install_rules(package)
    for name, uses in list(missing.items()):
        if _find_package(package, name) is None:
            missing[name] = [use for use in uses if not _is_stray(use, package, install)]
            if not missing[name]:
                del missing[name]


def _list_folders(use: PackageMention, package: Package) -> tuple[str, ...]:
    """Return the folders of the package, from the outermost, in which the file is that names another."""
    own = package.path.absolute()
    file = None if use.location.span is None else Path(os.path.abspath(use.location.span.file))
    return () if file is None or not file.is_relative_to(own) else file.relative_to(own).parts[:-1]


def _is_aside(use: PackageMention, package: Package) -> bool:
    """Whether the file that names a package is kept in a folder of what is no longer used, is an old copy or an example, or is a
    file that no program can read, or that MoveIt's setup assistant writes without declaring the package.

    An example may need more than the package does.
    """
    if not _EXAMPLE_FOLDERS.isdisjoint(folder.lower() for folder in _list_folders(use, package)):
        return True
    if use.location.span is None:
        return False
    file = Path(use.location.span.file)
    if is_left_out_by_template(use.package, file, package.path):
        return True
    if is_kept_aside(file, package) or _is_malformed(file):
        return True
    return package.finder is not None and is_unnamed_copy(file, package, package.finder.can_open)


def _is_malformed(file: Path) -> bool:
    """Whether a launch file or a model is not well-formed: nothing in it is checked (XML001), and no program loads it."""
    is_xml = is_model(file) or (is_launch(file) and file.suffix != ".py")
    return is_xml and not _is_well_formed(read_text_or_nothing(file))


@text_fact
def _is_well_formed(text: str) -> bool:
    try:
        parse_xml(SourceFile(Path(), "", text=text))
    except XmlError:
        return False
    return True


def _is_stray(use: PackageMention, package: Package, install: InstallRules | None) -> bool:
    """Whether nothing leads to the file that names a package: the build leaves it out, or it was left beside meshes."""
    folders = _list_folders(use, package)
    if not _SHAPE_FOLDERS.isdisjoint(folder.lower() for folder in folders):
        return True
    if install is None or use.location.span is None:
        return False
    file = Path(os.path.abspath(use.location.span.file))
    if folders:  # its folder may be installed under another name, too
        inside = PurePosixPath(*folders, file.name).as_posix()
        return not (install.installed.may_fill(folders[0]) or install.installed.may_install(inside))
    is_at_top = file.parent == package.path.absolute() and _are_in_launch_files([use])
    return is_at_top and not install.installed.may_install(file.name)


def _are_defaults(uses: Iterable[PackageMention]) -> bool:
    """Whether all mentions are in defaults of launch arguments, which the caller may replace."""
    return all(use.location.span is not None and _is_default(use.location.span) for use in uses)


def _is_off(use: PackageMention, package: Package) -> bool:
    """Whether the launch file that mentions a package does so where the defaults of its arguments switch it off."""
    place = use.location.span
    if place is None or package.finder is None or place.file.endswith(".py") or not _are_in_launch_files([use]):
        return False
    return is_off_by_default(place, package.finder)


def _are_in_launch_files(uses: Iterable[PackageMention]) -> bool:
    """Whether only launch files mention a package: they are started where both packages are, and the model does without."""
    return all(use.location.span is not None and use.location.span.file.endswith(_LAUNCH_SUFFIXES) for use in uses)


def _is_default(span: Span) -> bool:
    try:
        lines = read_regular(Path(span.file)).decode("utf-8", "replace").splitlines()
    except OSError:
        return False
    before = "\n".join(lines[max(span.line - _DEFAULT_LINES, 0) : span.line])
    return _DEFAULT.search(before) is not None


def _drop_uses_of_ros1(
    missing: Mapping[str, Sequence[PackageMention]], root: Element
) -> dict[str, list[PackageMention]]:
    """Leave out what only launch files of ROS 1 name in a package of ROS 2: nothing starts them, and ROS 2 may not have it."""
    if name_launch_command(root) != "ros2_launch":
        return {name: [*uses] for name, uses in missing.items()}
    kept = {name: [use for use in uses if not _is_in_launch_file_of_ros1(use)] for name, uses in missing.items()}
    return {name: uses for name, uses in kept.items() if uses}


def _build_misnamed_finding(
    package: Package,
    rule: Rule,
    root: Element,
    *,
    name: str,
    uses: Sequence[PackageMention],
    home: tuple[str, str],
    is_renamed: bool,
) -> Finding:
    """Report a name whose files are in another package. ``is_renamed``: the programs too, in this one."""
    runtime = "run_depend" if root.get("format", "1").strip() == "1" else "exec_depend"
    owner, path = home
    launcher = name_launch_command(root)
    is_left_over = launcher == "ros2_launch" and all(_is_in_launch_file_of_ros1(use) for use in uses)
    is_released = name in read_released_packages(read_generation(root))
    if is_left_over:
        repair = "delete the launch files that were left from ROS 1, or translate them if they are still needed"
    elif is_renamed:
        repair = f"write `{owner}` for {name}, if that is the package's old name: all that is named of it is here"
    elif is_released and all(use.subpath.endswith(_VIEW_SUFFIX) for use in uses):
        repair = (
            f"write `{owner}` for {name} if that file is meant; otherwise declare it: `<{runtime}>{name}</{runtime}>`"
        )
    elif is_released:
        repair = f"declare it: `<{runtime}>{name}</{runtime}>`; or write `{owner}` and the path `{path}` if that file is meant"
    else:
        repair = (
            f"write `{owner}` and the path `{path}` if {name} is an old name; if it is another package, declare it: "
        )
        repair += f"`<{runtime}>{name}</{runtime}>`"
    finding = rule.finding(
        "copied" if is_released else "misnamed",
        at=uses[0].location,
        related=[use.location for use in uses[1:3]],
        name=name,
        names=[name],
        package=package.name,
        file=PurePosixPath(path).name,
        home=owner,
        path=path,
        repair=repair,
        where=", ".join(dict.fromkeys(use.location.span.file for use in uses[:2] if use.location.span)),
    )
    refusal = {launcher: "refuses the launch file: it has no substitution `find`"}
    return replace(
        finding,
        subjects=(f"package[{package.name}]/{runtime}[{name}]",),
        consequences=refusal if is_left_over else _name_launcher(finding.consequences, root),
    )


def _is_in_launch_file_of_ros1(use: PackageMention) -> bool:
    """Whether an XML launch file is of ROS 1: it has ``$(find …)`` or a node's ``type``, which ROS 2 lacks."""
    span = use.location.span
    if span is None or span.file.endswith(".py") or not _are_in_launch_files([use]):
        return False
    try:
        text = read_regular(Path(span.file)).decode("utf-8", "replace")
    except OSError:
        return False
    return _ROS1_LAUNCH.search(text) is not None


def _is_of_own(use: PackageMention, package: Package) -> bool:
    """Whether a launch file in XML starts a program of another package that this one has, too."""
    span = use.location.span
    text = "" if span is None or span.file.endswith(".py") else read_text_or_nothing(Path(span.file))
    if span is None or not text:
        return False
    tag = text[text.rfind("<", 0, span.start) : text.find(">", span.end) + 1]
    program = _PROGRAM.search(tag)
    if program is None or "$" in program[1]:
        return False
    files = islice(iter_package_files(package, package.path), _MOST_FILES)
    if any(path.name == program[1] for path in files):
        return True
    build = package.path / "CMakeLists.txt"
    can_read = package.finder is not None and package.finder.can_open(build)
    built = re.compile(rf"\badd_executable\s*\(\s*{re.escape(program[1])}\s")
    return can_read and built.search(read_text_or_nothing(build)) is not None


def _find_home(package: Package, name: str, uses: Sequence[PackageMention]) -> tuple[str, str] | None:
    """Return the only package of the repository that has all robot files for which a package that is not found is named, and
    the path of the first in it; None if there is none, or a mention is of another file than these and views of them."""
    if package.finder is None:
        return None
    folder = package.finder.find(name)
    own = _find_in_package(package, name, uses, folder)
    if own is not None or folder is not None:
        return own
    files = dict.fromkeys(PurePosixPath(use.subpath).name for use in uses)
    wanted = [file for file in files if file.lower().endswith(_ROBOT_SUFFIXES) and "$" not in file]
    if not wanted or any(file not in wanted and not file.endswith(_VIEW_SUFFIX) for file in files):
        return None
    folders = {package.name: package.path, **package.finder.list_workspace_packages()}
    found: dict[str, dict[str, str]] = {}
    for owner, folder in folders.items():
        if not package.finder.can_open(folder):
            continue
        for path in islice(iter_package_files(package, folder), _MOST_FILES):
            if path.name in wanted:
                found.setdefault(owner, {}).setdefault(path.name, path.relative_to(folder).as_posix())
    complete = [(owner, paths[wanted[0]]) for owner, paths in found.items() if len(paths) == len(wanted)]
    return complete[0] if len(complete) == 1 else None


def _find_in_package(
    package: Package, name: str, uses: Sequence[PackageMention], folder: Path | None
) -> tuple[str, str] | None:
    """Return this package and the path in it of the first file for which a name is used that is not a package: all those files
    have the same paths in this package, or the name is that of one of its folders. None if they have not.

    Where only views are named, a released package probably has them itself, unless its name is a longer or shorter one of this.
    """
    inside = ""
    if folder is not None:
        # Without a manifest it is only a folder of that name, which a `package://` that lacks the package leads to by chance.
        if folder.absolute() != package.path.absolute() / name or (folder / "package.xml").is_file():
            return None
        inside = f"{name}/"
    files = [use for use in uses if not use.subpath.endswith(_VIEW_SUFFIX)]
    is_form = package.name.startswith(f"{name}_") or name.startswith(f"{package.name}_")
    if not files and (is_form or name not in read_released_packages()):
        files = [*uses]
    paths = [inside + use.subpath.strip("/") for use in files]
    if all(path.endswith(_LAUNCH_SUFFIXES) for path in paths):  # many packages have a launch file of that name
        return None
    if not paths or not all(path and "$" not in path and (package.path / path).is_file() for path in paths):
        return None
    return package.name, paths[0]


def _uses_files_of(package: Package, name: str) -> bool:
    """Whether a file of the package ``name`` uses this package."""
    folder = None if package.finder is None else package.finder.find(name)
    if folder is None or package.finder is None or not package.finder.can_open(folder / "package.xml"):
        return False
    other = load_package(folder)
    return other is not None and mentions_package(other, package.name)


def _find_circles(package: Package, missing: Iterable[str]) -> dict[str, tuple[str, Sequence[str]]]:
    """Return the packages that need this one, each with its message and those through which it does.

    Where this one's line is missing in them too, each line would be right alone, and together they are a cycle.
    """
    found: dict[str, tuple[str, Sequence[str]]] = {}
    for name in missing:
        if package.name in collect_dependencies(package.finder, [name]):
            found[name] = "circle", ()
        elif _uses_files_of(package, name):
            found[name] = "mutual", ()
        elif chain := _find_chain(package, name):
            found[name] = "ring", chain
    return found


def _find_chain(package: Package, name: str) -> list[str]:
    """Return the packages of the repository through which ``name`` depends on this package, or would with the lines that are
    proposed for them; empty if it does not."""
    finder, workspace = package.finder, _list_workspace(package)
    if finder is None or name not in workspace:
        return []
    read: dict[str, tuple[frozenset[str], set[str]]] = {}

    def read_names(one: str) -> tuple[frozenset[str], set[str]]:
        """Return what a package declares, and what its files use."""
        if one not in read and len(read) < _MOST_IN_CHAIN:
            folder = package.path if one == package.name else workspace[one]
            other = load_package(folder) if finder.can_open(folder / "package.xml") else None
            read[one] = (frozenset(), set()) if other is None else (other.dependencies, list_mentioned_packages(other))
        return read.get(one, (frozenset(), set()))

    def needs_line(one: str, other: str) -> bool:
        """Whether a line is proposed for a package that another one uses: none is where that one uses or needs it, too."""
        return one not in collect_dependencies(finder, [other]) and one not in read_names(other)[1]

    through: dict[str, list[str]] = {name: []}
    waiting = deque([name])
    while waiting:
        one = waiting.popleft()
        declared, used = read_names(one)
        for other in sorted(declared | used):
            if other not in workspace.keys() | {package.name} or other in through:
                continue
            if other in declared or needs_line(one, other):
                if other == package.name:
                    return through[one]
                through[other] = [*through[one], other]
                waiting.append(other)
    return []


def _describe_idle_dependency(package: Package, name: str, tag: str) -> str:
    """Return the first repair of a circle in which another package depends on this one, and no model or launch file of it."""
    folder = None if package.finder is None else package.finder.find(name)
    if folder is None or not has_dependency_entry(folder, package.name) or _uses_files_of(package, name):
        return ""
    return (
        f"delete the dependency on {package.name} from the package.xml of {name} if its code does not need it, as its models and "
        f"launch files do not, and declare `<{tag}>{name}</{tag}>`; otherwise "
    )


def _leads_nowhere(use: PackageMention, package: Package) -> bool:
    """Whether a mention is of a file that the package lacks: a line left from another robot's launch file.

    The package is found, or it is released and has no files. One for the other ROS than this package is not what is meant.
    """
    folder = _find_package(package, use.package)
    path = use.subpath.strip("/")
    if folder is None and use.package in _METAPACKAGES:
        return path not in {"", "package.xml"} and ".." not in path
    if folder is None or package.finder is None or not _PLAIN_FILE.search(path):
        return False
    if not package.finder.can_open(folder / "package.xml") or (folder / path).exists():
        return False
    other = load_package(folder)
    return other is None or name_launch_command(other.root) == name_launch_command(package.root)


def _are_for_tests(uses: Sequence[PackageMention], package: Package) -> bool:
    """Whether all files that name a package are in folders for tests."""
    own = package.path.absolute()
    files = [Path(os.path.abspath(use.location.span.file)) for use in uses if use.location.span is not None]
    return all(file.is_relative_to(own) and TEST_FOLDERS & set(file.relative_to(own).parts[:-1]) for file in files)


def _needs_declaration(name: str, uses: list[PackageMention], package: Package) -> bool:
    """Whether a package must be declared: it is found, or only launch files name it, which fail without it."""
    if package.finder is not None and package.finder.find(name) is not None:
        return True
    return _are_in_launch_files(uses)


def _propose_edits(root: Element, file: SourceFile, *, tags: Mapping[str, str]) -> list[Edit]:
    """Insert the missing lines, each after the last dependency of its kind, else of any kind, else after the last element.

    ``tags``: the kind of each.
    """
    texts: dict[int, str] = {}
    for name, tag in tags.items():
        dependencies = (
            root.find_children(tag)
            or root.find_children("depend")
            or [e for e in root.children if e.tag.endswith("depend")]
        )
        before = dependencies[-1] if dependencies else (root.children[-1] if root.children else None)
        if before is None or before.span is None:
            return []
        end = file.text.find(f"</{before.tag}>", before.span.end)
        if end < 0 or file.text[: before.span.end].endswith("/>"):
            return []
        end += len(f"</{before.tag}>")
        begin = file.text.rfind("\n", 0, before.span.start) + 1
        indent = file.text[begin : before.span.start]
        newline = "\r\n" if file.text[: before.span.start].endswith("\r\n" + indent) else "\n"
        line = f"{newline}{indent if not indent.strip() else ''}<{tag}>{name}</{tag}>"
        texts[end] = texts.get(end, "") + line
    return [Edit(file.make_span(end, end), "", text) for end, text in sorted(texts.items())]
