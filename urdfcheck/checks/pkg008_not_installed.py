"""PKG008 reports folders that models and launch files read but that a ROS 2 package does not install."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

from urdfcheck.core import Finding, Rule, Severity, Span
from urdfcheck.core.text import join_names
from urdfcheck.source.package.build_files import name_launch_command
from urdfcheck.source.package.built_packages import is_out_of_build
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.installed_files import InstalledFiles
from urdfcheck.source.package.installed_folders import read_install_rules
from urdfcheck.source.package.package_folders import list_subfolders
from urdfcheck.source.package.references import PackageMention, iter_package_files, iter_package_mentions
from urdfcheck.system.files import read_regular, read_text_or_nothing

# The launch files of ROS 1, and what makes one: ROS 2 has no such substitution.
_OLD_LAUNCH = ".launch"
_OLD_LOOKUP = re.compile(r"\$\(find\s+['\"]?$")
_MODEL_SUFFIXES = frozenset({".urdf", ".xacro", ".sdf", ".srdf", ".gazebo"})
# A program of setup.py that is in a Python package, and a node of a launch file that is this program.
_CONSOLE_SCRIPT = r"[\"']\s*([\w.-]+)\s*=\s*{}\."
_STARTED = r"\b(?:executable|exec)\s*=\s*[\"']{}[\"']"
# What installs a folder, or files of it, where programs are.
_INSTALLED_PROGRAMS = (
    r"install\s*\((?:DIRECTORY|PROGRAMS|FILES)[^()]*\s{}(?:/[^()]*)?\sDESTINATION\s+[\"']?(lib/[^\s()\"']*)"
)
# So many files of a folder are looked at for what it holds.
_MOST_FILES = 2_000


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    install = None if is_out_of_build(package.path, package.finder) else read_install_rules(package)
    if install is None:
        return
    missing = _collect_missing_folders(package, install.installed)
    if not missing:
        return
    folders = sorted(missing)
    first = next((m for m in missing[folders[0]] if _leads_to_file(m, package)), missing[folders[0]][0])
    is_read = any(_leads_to_file(mention, package) for mentions in missing.values() for mention in mentions)
    elsewhere = _describe_programs(package, folders)
    program = _find_started_program(package, missing)
    finding = rule.finding(
        f"{install.build_form}-several" if len(folders) > 1 else install.build_form,
        at=install.at,
        related=[mention.location for name in folders for mention in missing[name][:3]],
        edits=[] if elsewhere else install.build_edits(folders),
        severity=Severity.INFO if program else None,
        consequences=_describe_loss(package, folders) if is_read else _describe_absence(package),
        package=package.name,
        folder=folders[0],
        folders=folders,
        listed=join_names(folders),
        spaced=" ".join(folders),
        share=install.share,
        project=f" (its project is {install.other_project}, so share/${{PROJECT_NAME}} is another folder)"
        if install.other_project
        else "",
        elsewhere=elsewhere,
        repair=f"delete the path if no program reads it: the launch file starts what is in {folders[0]} as {program} already"
        if program
        else _describe_python_repair(package, folders, install.names),
        lookup="files are looked up by package name" if is_read else "a path leads that no file here has",
        lack="" if is_read else ", and the file is missing",
        correction=""
        if is_read
        else f"; add {first.subpath.lstrip('/')} too or correct the path, unless a program writes it",
        example=first.subpath.lstrip("/"),
    )
    yield replace(finding, subjects=tuple(f"package[{package.name}]/install[{name}]" for name in folders))


def _find_started_program(package: Package, missing: Mapping[str, Sequence[PackageMention]]) -> str:
    """Return the program of `console_scripts` in the only missing folder, if each launch file that names the folder starts it and
    no command; else empty."""
    if len(missing) != 1:
        return ""
    ((folder, mentions),) = missing.items()
    setup = read_text_or_nothing(package.path / "setup.py")
    programs = re.findall(_CONSOLE_SCRIPT.format(re.escape(folder)), setup)
    texts = [read_text_or_nothing(Path(m.location.span.file)) for m in mentions if m.location.span is not None]
    started = [p for p in programs if all(re.search(_STARTED.format(re.escape(p)), text) for text in texts)]
    return started[0] if started and texts and not any("ExecuteProcess" in text for text in texts) else ""


def _describe_programs(package: Package, folders: Iterable[str]) -> str:
    """Name the folders that CMake installs among the programs: those are started by name, and a copy in share starts nothing."""
    text = read_text_or_nothing(package.path / "CMakeLists.txt")
    placed = {
        folder: found[1]
        for folder in folders
        if (found := re.search(_INSTALLED_PROGRAMS.format(re.escape(folder)), text, re.IGNORECASE)) is not None
    }
    if not placed:
        return ""
    listed = join_names(f"{folder} is installed in {place}" for folder, place in placed.items())
    return f"; {listed}: if programs are meant, start them from there"


def _describe_python_repair(package: Package, folders: Iterable[str], names: Mapping[str, str]) -> str:
    """Return what to write in setup.py for folders of data, and how to start what is in a folder with a Python package.

    ``glob('X/*')`` would name folders in X too, with which ``data_files`` stops the build. ``names``: those that setup.py has.
    """
    modules = [name for name in folders if (package.path / name / "__init__.py").is_file()]
    data = [name for name in folders if name not in modules]
    repairs = []
    if data:
        folder = package.path / data[0]
        below = [inner for inner in list_subfolders(folder) if inner.name != "__pycache__"]
        # Python makes a folder in one with modules as soon as it runs them.
        is_deep = bool(below) or any(folder.glob("*.py"))
        call, imported = _name_glob(names)
        files = f"{call}('{data[0]}/*{'.*' if is_deep else ''}')"
        each = " a line for each folder" if len(data) > 1 else ""
        others = ", and a line for each of its subfolders that is read" if below else ""
        place = _write_share_folder(package.name, data[0], names)
        repairs.append(f"add to data_files{each}: `({place}, {files})`{imported}{others}")
    if modules:
        repairs.append(
            f"start what is in {join_names(modules)} by its name in console_scripts: a Python package is not in share"
        )
    return "; ".join(repairs)


def _name_glob(names: Mapping[str, str]) -> tuple[str, str]:
    """Return how setup.py calls glob, and the end of a repair for which it lacks the import."""
    for name, meant in names.items():
        if meant in {"glob", "glob.glob"}:
            return (name if meant == "glob.glob" else f"{name}.glob"), ""
    return "glob", " (it needs `from glob import glob`)"


def _write_share_folder(package: str, folder: str, names: Mapping[str, str]) -> str:
    """Write the place where a folder is installed, with what setup.py imports and assigns."""
    name = "package_name" if "package_name" in names else repr(package)
    if names.get("os") == "os":
        return f"os.path.join('share', {name}, {folder!r})"
    return f"'share/' + {name} + '/{folder}'" if "package_name" in names else f"'share/{package}/{folder}'"


def _collect_missing_folders(package: Package, installed: InstalledFiles) -> dict[str, list[PackageMention]]:
    """Return the folders that are not installed, with the mentions of them."""
    missing: dict[str, list[PackageMention]] = {}
    for mention in iter_package_mentions(package):
        folder = mention.folder
        if not folder or installed.may_fill(folder) or not (package.path / folder).is_dir():
            continue
        if _is_left_to_function(package.path / folder, installed):
            continue
        if not _is_left_over(mention, package, installed):
            missing.setdefault(folder, []).append(mention)
    return missing


def _is_left_to_function(folder: Path, installed: InstalledFiles) -> bool:
    """Whether a function of another package is called with the name of a folder in this one, which it may install."""
    names = (word for word in installed.function_words if word.isprintable() and "/" not in word)
    return any(word not in {"", ".", ".."} and (folder / word).is_dir() for word in names)


def _is_left_over(mention: PackageMention, package: Package, installed: InstalledFiles) -> bool:
    """Whether nothing reads the file of a mention after the build.

    That is a launch file of ROS 1, or a model of this package that is not installed and names a folder whose files are installed
    in another place.
    """
    span = mention.location.span
    if span is not None and _is_lookup_of_ros1(span):
        return True
    own, file = package.path.absolute(), None if span is None else Path(os.path.abspath(span.file))
    inside = file.relative_to(own) if file is not None and file.is_relative_to(own) else None
    if inside is None:
        return False
    if inside.suffix == _OLD_LAUNCH and len(inside.parts) > 1 and not installed.may_fill(inside.parts[0]):
        return True
    is_elsewhere = inside.suffix in _MODEL_SUFFIXES and any(True for _ in installed.find_places(mention.folder))
    return is_elsewhere and not installed.may_install(inside.as_posix())


def _is_lookup_of_ros1(span: Span) -> bool:
    """Whether the name of a package in a launch file is in ``$(find …)``, with which ROS 2 does not load the file."""
    if not span.file.endswith((_OLD_LAUNCH, f"{_OLD_LAUNCH}.xml")):
        return False
    try:
        text = read_regular(Path(span.file)).decode("utf-8-sig", "replace")
    except OSError:
        return False
    return _OLD_LOOKUP.search(text, 0, span.start) is not None


def _leads_to_file(mention: PackageMention, package: Package) -> bool:
    """Whether a path may be one of a file to read: it goes on where it is used, or such a file is in the source.

    Another is one that a program writes, like the map of a map saver, or is missing whatever is installed.
    """
    place = package.path / mention.subpath.strip("/")
    is_open = mention.subpath.endswith("/") or "$" in mention.subpath
    return is_open or place.exists()


def _describe_absence(package: Package) -> dict[str, str]:
    effect = "starts the program with a path into a folder that is not there: it can neither read nor write the file"
    return {name_launch_command(package.root): effect}


def _describe_loss(package: Package, folders: Iterable[str]) -> dict[str, str]:
    """Describe what programs do without the files in these folders."""
    files = (path for name in folders for path in iter_package_files(package, package.path / name))
    suffixes = {path.suffix.lower() for path in islice(files, _MOST_FILES)}
    lost: dict[str, str] = {}
    if not suffixes.isdisjoint(MESH_SUFFIXES):
        lost["rviz"] = f"drops the meshes, because `package://{package.name}` is the install folder, which lacks them"
    if ".xacro" in suffixes:
        lost["xacro"] = "stops if the file that it needs is not installed"
    return lost or {name_launch_command(package.root): "stops where the file is read, or starts the program without it"}
