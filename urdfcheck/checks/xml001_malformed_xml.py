"""XML001 reports text that is not XML, and XML that may not be read."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source, has_unbound_xacro
from urdfcheck.source.package.finder import Package, format_path, is_kept_aside
from urdfcheck.source.package.similar_files import index_files
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.reach import OUT_OF_REACH, is_in_home_of_another
from urdfcheck.source.resources import find_in_named_package
from urdfcheck.source.ros.srdf import find_broken_srdfs
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import SourceFile

_KINDS = (
    *("malformed", "encoding", "declared-encoding", "xacro-encoding", "utf-16", "instruction", "doctype", "prefix"),
    *("instruction-copied", "xacro-line-break", "address"),
    "unreadable",
)
# urdfdom reads another name than programs that follow the declaration.
_MISREAD = ("misdeclared", "undecoded")
_REPAIR_OF_COMPANION = "fix the XML here or just before it, and save the file as UTF-8"
_REPAIR_OF_ENCODING = "save the file as UTF-8"
_REPAIR_OF_EMPTY = "write its content, or delete the file"
_REPAIR_OF_SCRIPT = (
    "name it `.launch.py` if `ros2 launch` starts it; no program reads it as a launch file under this name"
)
_REPAIR_OF_UNREADABLE = "check the file name and its read permission"
_REPAIR_OF_UNREACHABLE = (
    "where the file is named, write its place in a package (`$(find PACKAGE)/…`); if the place is right and you trust it, "
    "allow its folder: --allow-read DIR"
)
# The addresses of prefixes, and how those begin that early releases of Gazebo gave their own elements.
_ADDRESSES = {"xacro": "http://www.ros.org/wiki/xacro", "drake": "http://drake.mit.edu"}
_GAZEBO_ADDRESS = "http://playerstage.sourceforge.net/gazebo/xmlschema/#"
_PREFIXES_OF_GAZEBO = frozenset({"sensor", "controller", "interface", "model", "body", "geom", "rendering", "physics"})
# How a file that was never XML begins, and the cause.
_CAUSES = (("version https://git-lfs", "git_lfs"), ("<!doctype html", "web_page"), ("<html", "web_page"))
# What a file is that was never XML, and the repair, by cause.
_OTHERS: Mapping[str | None, tuple[str, str]] = {
    "git_lfs": ("a Git LFS pointer", "run `git lfs pull`"),
    "web_page": ("a web page", "download the raw file, not the page that shows it"),
    "git_link": ("only the path of another file", "replace it by that file, or by a symbolic link to it"),
}
_LONGEST_PATH = 300  # characters (chosen)
# We reject this, and ROS may read it.
_OUR_CHOICE = "doctype"


def check(subject: Source | LaunchContext | Package, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Source):
        yield from _check_model(subject, rule)
    elif isinstance(subject, LaunchContext):
        launch = subject.launch
        # Nothing starts what is kept in a folder of files that are not used.
        is_aside = is_kept_aside(launch.path, launch.package)
        for finding in _check_companion_file(rule, "launch", problems=launch.problems, files=launch.files):
            yield replace(finding, severity=Severity.WARNING) if is_aside else finding
        # In a folder it is not meant for roslaunch; where it is named, nothing would be checked.
        for problem in launch.problems if subject.is_explicit else ():
            if problem.kind == "script":
                yield rule.finding("launch", at=problem.location, error="it is a script", repair=_REPAIR_OF_SCRIPT)
    else:
        files = {} if subject.file is None else {subject.file.name: subject.file}
        yield from _check_companion_file(rule, "manifest", problems=subject.problems, files=files)
        for problem, file in find_broken_srdfs(subject.path):
            files = {} if file is None else {file.name: file}
            yield from _check_companion_file(rule, "srdf", problems=[problem], files=files)


def _check_model(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems(*_KINDS):
        location = replace(problem.location, subject=problem.location.subject or "robot")
        file = _find_source_file(problem, source.files)
        if problem.kind == "prefix" and not source.is_xacro:
            is_of_xacro = has_unbound_xacro(source)
            severity = None if is_of_xacro else Severity.WARNING
            message = "xacro-prefix" if is_of_xacro else "prefix"
            repair = _describe_declaration(problem)
            yield rule.finding(message, at=location, severity=severity, error=problem.message, repair=repair)
        else:
            cause = _classify_cause(file)
            message = "other" if cause in _OTHERS else _choose_message(problem, file)
            is_forgiven = message == "malformed" and bool(problem.data.get("forgiven")) and source.root is not None
            if is_forgiven:
                message = "forgiven"
            # xacro puts entities in that are texts.
            is_harmless = message == _OUR_CHOICE and bool(problem.data.get("plain")) and source.is_xacro
            if is_harmless:
                message = "doctype-xacro"
            unread = _REPAIR_OF_UNREADABLE
            if problem.message == OUT_OF_REACH:
                finding = _report_place_here(source, problem, rule) or _report_other_home(source, problem, rule)
                if finding is not None:
                    yield finding
                    continue
                unread = _REPAIR_OF_UNREACHABLE
            repair = _describe_declaration(problem) if problem.kind == "prefix" else problem.data.get("repair", unread)
            what, repair = _OTHERS.get(cause, ("", repair))
            finding = rule.finding(
                message,
                at=location,
                cause=cause,
                # A path out of reach is shown as the launch file that names it has it.
                file=os.path.abspath(source.path) if problem.message == OUT_OF_REACH else source.name,
                error=problem.message,
                what=what,
                repair=repair,
            )
            if is_harmless:  # every program loads the file, and only we do not read it
                finding = replace(finding, severity=Severity.WARNING, blocks_check=True)
            yield replace(finding, severity=Severity.WARNING) if is_forgiven else finding
    for problem in source.find_problems(*_MISREAD):
        data = {**problem.data, "count": len(problem.data["places"])}
        first, *others = data.pop("places")
        listed = f"the value {problem.message!r}"
        listed += f" and {len(others)} more" if others else ""
        yield rule.finding(problem.kind, at=first, related=others[:9], severity=Severity.WARNING, listed=listed, **data)


def _report_place_here(source: Source, problem: Problem, rule: Rule) -> Finding | None:
    """Report a path out of reach that ends as that of a file in a package here, whose place a launch file should name."""
    named = find_in_named_package(source.path, source.finder)
    if named is None:
        return None
    package, inside = named
    is_ros1 = problem.location.file.endswith(".launch")
    repair = f"write `$(find {package})/{inside}`" if is_ros1 else f"name {inside} by its package {package}"
    file = os.path.abspath(source.path)
    return rule.finding("elsewhere", at=problem.location, file=file, package=package, inside=inside, repair=repair)


def _report_other_home(source: Source, problem: Problem, rule: Rule) -> Finding | None:
    """Report a path that a launch file has in the home of another user: no option of ours makes it right."""
    file = Path(os.path.abspath(source.path))
    if problem.location.file == source.name or not is_in_home_of_another(file):
        return None
    name, project = source.path.name, find_project_folder(Path(problem.location.file).absolute())
    files = index_files([project])
    found = [format_path(path) for wanted in (name, f"{name}.xacro") for path in files.get(wanted.lower(), [])]
    is_ros1 = problem.location.file.endswith(".launch")
    finding = rule.finding(
        "machine",
        at=problem.location,
        file=str(file),
        place="`$(find PACKAGE)/…`" if is_ros1 else "`$(find-pkg-share PACKAGE)/…`",
        meant=f"; {join_names(found, 2)} may be meant" if found else "",
    )
    return finding if is_ros1 else replace(finding, consequences={"ros2_launch": finding.consequences["roslaunch"]})


def _describe_declaration(problem: Problem) -> str:
    """Say how an undeclared prefix is declared, or that what has it may be left out."""
    prefix = str(problem.data["prefix"])
    if prefix in _ADDRESSES:
        return f'declare it in the root element: `xmlns:{prefix}="{_ADDRESSES[prefix]}"`'
    if prefix in _PREFIXES_OF_GAZEBO:
        return (
            "delete the elements with this prefix, which Gazebo has not read since 1.0 (2012), or declare it in the root "
            f'element: `xmlns:{prefix}="{_GAZEBO_ADDRESS}{prefix}"`'
        )
    return f'declare it in the root element (`xmlns:{prefix}="…"`), or delete what has it if no program needs that'


def _check_companion_file(
    rule: Rule, message: str, *, problems: Sequence[Problem], files: Mapping[str, SourceFile]
) -> Iterator[Finding]:
    """Report a launch file, package.xml or SRDF that cannot be read."""
    for problem in problems:
        if problem.kind not in _KINDS:
            continue
        file = _find_source_file(problem, files)
        at, cause = problem.location, _classify_cause(file)
        if _choose_message(problem, file) == "empty":
            severity = Severity.WARNING if message == "launch" else None
            yield rule.finding(message, at=at, severity=severity, error="it is empty", repair=_REPAIR_OF_EMPTY)
        elif problem.kind == _OUR_CHOICE and cause is None:
            yield rule.finding("unread", at=at, severity=Severity.WARNING, error=problem.message)
        elif message == "srdf" and problem.data.get("forgiven"):
            repair = problem.data["repair"]
            yield rule.finding("srdf-forgiven", at=at, severity=Severity.WARNING, error=problem.message, repair=repair)
        else:
            otherwise = _REPAIR_OF_ENCODING if problem.kind == "encoding" else _REPAIR_OF_COMPANION
            repair = _OTHERS[cause][1] if cause in _OTHERS else problem.data.get("repair", otherwise)
            yield rule.finding(message, at=at, cause=cause, error=problem.message, repair=repair)


def _find_source_file(problem: Problem, files: Mapping[str, SourceFile]) -> SourceFile | None:
    span = problem.location.span
    return None if span is None else files.get(span.file)


def _choose_message(problem: Problem, file: SourceFile | None) -> str:
    if problem.kind != "malformed" or file is None:
        return problem.kind
    return "empty" if not file.text.strip() else "binary" if "\0" in file.text else "malformed"


def _classify_cause(file: SourceFile | None) -> str | None:
    if file is None:
        return None
    text = file.text.lstrip("\ufeff \t\r\n")
    for beginning, cause in _CAUSES:
        if text[:80].lower().startswith(beginning):
            return cause
    if "\n<<<<<<< " in "\n" + file.text:
        return "merge_conflict"
    return "git_link" if _is_text_of_link(file) else None


def _is_text_of_link(file: SourceFile) -> bool:
    """Whether a file holds only the path of another one at or below its folder. Git writes a symbolic link so where links are
    turned off, as on many Windows machines, and a commit there keeps the text."""
    path = Path(file.text.strip())
    is_relative = len(file.text) < _LONGEST_PATH and not path.is_absolute() and ".." not in path.parts
    # pathlib raises for a name that is too long.
    return is_relative and path.name != "" and os.path.isfile(file.path.parent / path)
