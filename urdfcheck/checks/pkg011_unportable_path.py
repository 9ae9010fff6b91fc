"""PKG011 reports spellings of mesh and texture paths that some programs or systems cannot read."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import field

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import find_nearest_name, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.build_files import read_build_type
from urdfcheck.source.package.finder import Package
from urdfcheck.source.resources import (
    ResourceUse,
    find_first_file,
    find_machine_path,
    is_misspelt,
    list_resource_uses,
    normalize_spelling,
)
from urdfcheck.source.text.engine_reactions import name_lost_shapes
from urdfcheck.source.text.tokens import build_replacement_edits

_SCHEMES = ("package", "model", "file")
# RViz fetches these by libcurl.
_REMOTE = frozenset({"http", "https", "ftp", "ftps"})
_IN_ROS1 = {"rviz": "loads it with the libcurl of Ubuntu 20.04 and older; 7.78 and newer refuse a blank"}
_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+.-]+)://")
_ONE_SLASH = re.compile(rf"^(?:{'|'.join(_SCHEMES)}):/?[^/]")


@dataclass(frozen=True, slots=True, eq=False)
class _PathProblem:
    """A mistake in the spelling of a path, and the paths that have it."""

    message: str
    """blank | backslash | letters | remote | scheme | slashes"""
    part: str
    """The text that all paths with one cause share."""
    suggestion: str | None
    """The correct path, None if it is unknown."""
    uses: list[ResourceUse] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    problems: dict[tuple[str, str], _PathProblem] = {}
    for use in list_resource_uses(source):
        problem = _classify_path_problem(use, source)
        if problem is not None and find_machine_path(use, source) is None:
            problems.setdefault((problem.message, problem.part), problem).uses.append(use)
    for problem in problems.values():
        yield _build_finding(problem, source, rule)


def _classify_path_problem(use: ResourceUse, source: Source) -> _PathProblem | None:
    text = use.resource.text
    scheme = _SCHEME.match(text.strip())
    if use.resource.kind == "other" and scheme is not None:
        name = scheme.group(1)
        if name.lower() in _REMOTE:
            return _PathProblem("remote", name, None)
        near = find_nearest_name(name, _SCHEMES)
        return _PathProblem("scheme", name, None if near is None else near + text.strip()[len(name) :])
    if _ONE_SLASH.match(text.strip().replace("\\", "/")):  # of package:\\car no slash is missing
        plain = normalize_spelling(text)
        # Behind file:// a path is absolute: what is meant is one from the model's file.
        relative = plain.removeprefix("file://")
        return _PathProblem("slashes", "", plain if relative == plain or relative.startswith("/") else relative)
    typed = _drop_package_folder(use, source)
    if "\\" in text:
        return _PathProblem("backslash", "", normalize_spelling(text))
    if re.search(r"\s", typed):
        meant = text.strip() if len(text.split()) == 1 else find_first_file(text, source)
        return _PathProblem("blank", _truncate_at_problem(typed, r"\s"), meant)
    if not typed.isascii():
        return _PathProblem("letters", _truncate_at_problem(typed, r"[^\x00-\x7f]"), None)
    return None


def _drop_package_folder(use: ResourceUse, source: Source) -> str:
    """Return a path without the package's folder where ``$(find …)`` gives it: that folder is this machine's."""
    path = use.resource.path
    if path is None or use.resource.kind not in {"absolute", "file"} or find_machine_path(use, source) is not None:
        return use.resource.text
    package = source.finder.find_package_of(path)
    return use.resource.text if package is None else path.relative_to(package.path).as_posix()


def _truncate_at_problem(text: str, wrong: str) -> str:
    """Return the path up to its first wrong part, a cause that all paths below one such folder share."""
    match = re.search(rf"^.*?{wrong}[^/]*", text, re.DOTALL)
    return text if match is None else match.group(0)


def _build_finding(problem: _PathProblem, source: Source, rule: Rule) -> Finding:
    at, *others = problem.uses
    severity = _get_severity(problem, source)
    files = list(dict.fromkeys(use.resource.text for use in problem.uses))
    lost = [use for use in problem.uses if is_misspelt(use, source)]
    exists = bool(lost) and all(
        source.finder.resolve_resource(normalize_spelling(u.resource.text), source.path.parent).exists for u in lost
    )
    edits = [edit for use in problem.uses for edit in _propose_edits(use, source)]
    return rule.finding(
        problem.message,
        at=at,
        related=[use for use in others if use.attribute.span != at.attribute.span],
        edits={edit.span: edit for edit in edits}.values(),
        severity=Severity.ERROR if lost else severity,
        consequences=_IN_ROS1 if problem.message == "blank" and severity is Severity.INFO and not lost else None,
        file=files[0],
        files=files,
        absent=name_lost_shapes(use.attribute.owner for use in problem.uses),
        part=problem.part,
        scheme=problem.part,
        letters="".join(sorted({c for c in problem.part if not c.isascii()})[:10]),
        repair=_describe_suggestion(problem, source)
        if problem.suggestion
        else "correct the path: no file has this name, and `_` is better than blanks in one"
        if lost and not exists
        else "rename the file or folder, with `_` instead of blanks, and its paths",
        hint=f" (did you mean {problem.suggestion!r}?)" if problem.suggestion and problem.message == "scheme" else "",
        paths=f"the path {files[0]!r} has" if len(files) == 1 else f"{len(files)} paths have",
        listed="" if len(files) == 1 else f" ({join_names(files, 2)})",
        more=f", and {join_names(files[1:], 2)}" if len(files) > 1 else "",
        lost="" if not exists else "; the file is there" if len(files) == 1 else "; the files are there",
    )


def _describe_suggestion(problem: _PathProblem, source: Source) -> str:
    """Say what to write, and what is still missing then."""
    likewise = ", and the others likewise" if len({use.resource.text for use in problem.uses}) > 1 else ""
    found = (_classify_path_problem(use, source) for use in problem.uses)
    meant = {one.suggestion for one in found if one is not None and one.suggestion is not None}
    missing = [p for p in meant if not source.finder.resolve_resource(p, source.path.parent).exists]
    rest = "" if not missing else "; that file is missing too" if not likewise else "; not all these files are there"
    return f"write `{problem.suggestion}`{likewise}{rest}"


def _get_severity(problem: _PathProblem, source: Source) -> Severity | None:
    """Return the severity of paths that are found or may be.

    Letters of a file that is found are a note about other machines; so are its blanks in a package of ROS 1, for its libcurl.
    """
    is_found = all(use.resource.exists for use in problem.uses)
    is_note = problem.message == "letters" or (problem.message == "blank" and _is_for_ros1(source.package))
    return Severity.INFO if is_note and is_found else None


def _is_for_ros1(package: Package | None) -> bool:
    """Whether a package is built by catkin alone."""
    if package is None or "catkin" not in package.dependencies:
        return False
    return not package.depends_on_ament and not read_build_type(package.root).startswith("ament_")


def _propose_edits(use: ResourceUse, source: Source) -> tuple[Edit, ...]:
    problem = _classify_path_problem(use, source)  # paths with one problem have different corrections
    suggestion = None if problem is None else problem.suggestion
    return () if suggestion is None else build_replacement_edits([use.attribute], suggestion)
