"""PKG011 reports spellings of mesh and texture paths that some programs or systems cannot read."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import Path, PurePosixPath

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import find_nearest_name, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.build_files import read_build_type
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.similar_files import index_files, is_in_folder_of_another
from urdfcheck.source.resources import (
    ResourceUse,
    find_first_file,
    find_machine_path,
    format_path_from_model,
    get_path_in_package,
    is_misspelt,
    list_resource_uses,
    normalize_spelling,
)
from urdfcheck.source.text.engine_reactions import name_lost_shapes
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.uses_elsewhere import find_replacing_script

_SCHEMES = ("package", "model", "file")
# RViz fetches these by libcurl.
_REMOTE = frozenset({"http", "https", "ftp", "ftps"})
_IN_ROS1 = {"rviz": "loads it with the libcurl of Ubuntu 20.04 and older; 7.78 and newer refuse a blank"}
_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+.-]+)://")
# A blank between the name of a file and its ending.
_BEFORE_ENDING = re.compile(r"\s\.\w+\s*$")
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
        if problem is None or _is_only_missing(problem, use):
            continue
        if find_machine_path(use, source) is None:
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


def _is_only_missing(problem: _PathProblem, use: ResourceUse) -> bool:
    """Whether a blank before the ending of a path is a slip, and no file has it: there is nothing to rename (PKG002)."""
    resource = use.resource
    is_missing = resource.path is not None and resource.allowed and not resource.exists
    return problem.message == "blank" and is_missing and _BEFORE_ENDING.search(resource.text) is not None


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
    moved = _find_moved(problem, source)
    edits = [edit for use in problem.uses for edit in _propose_edits(use, source, moved)]
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
        repair=_describe_suggestion(problem, source, moved)
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


def _describe_suggestion(problem: _PathProblem, source: Source, moved: Mapping[str, str]) -> str:
    """Say what to write, and what is still missing then; ``moved`` has the places of files by the plain paths to them."""
    likewise = ", and the others likewise" if len({use.resource.text for use in problem.uses}) > 1 else ""
    found = (_classify_path_problem(use, source) for use in problem.uses)
    meant = {
        moved.get(one.suggestion, one.suggestion) for one in found if one is not None and one.suggestion is not None
    }
    missing = [p for p in meant if not _exists(p, source)]
    rest = (
        "" if not missing
        else "; that file is missing too" if not likewise
        else "; none of these files is there" if len(missing) == len(meant)
        else "; not all these files are there"
    )  # fmt: skip
    first = moved.get(problem.suggestion or "", problem.suggestion)
    where = ", where the file is" if first in moved.values() and first not in missing else ""
    return f"write `{first}`{where}{likewise}{rest}{_describe_script(problem, source)}"


def _describe_script(problem: _PathProblem, source: Source) -> str:
    """Say that a script replaces the beginning of paths with backslashes in the model, and finds none once they are edited."""
    before, slash, _ = problem.uses[0].resource.text.partition("\\")
    if problem.message != "backslash" or not before:
        return ""
    script = find_replacing_script(source, before + slash, names_model=True)
    return f"; {script.name} replaces `{before + slash}`: change it too" if script is not None else ""


def _find_moved(problem: _PathProblem, source: Source) -> dict[str, str]:
    """Return for plain paths that lead nowhere either those of the files that are meant, if all that are found are in one folder:
    each is the only file of its name in the package. What is not found belongs there, too."""
    found = (_classify_path_problem(use, source) for use in problem.uses)
    lost = {
        one.suggestion for one in found if one is not None and one.suggestion and not _exists(one.suggestion, source)
    }
    places = {plain: place for plain in lost if (place := _find_file_of_name(plain, source)) is not None}
    folders = {place.parent for place in places.values()}
    if len(folders) != 1 or len({PurePosixPath(plain).parent for plain in lost}) != 1:
        return {}
    folder = folders.pop()
    return {plain: _format_path(folder / PurePosixPath(plain).name, plain, source) for plain in lost}


def _find_package(plain: str, source: Source) -> tuple[str, Path] | None:
    """Return the package that a path names if it is found, or that of the model, and its folder."""
    name = source.finder.resolve_resource(plain, source.path.parent).package
    folder = source.finder.find(name) if name else None
    if name and folder is not None:
        return name, folder
    return None if source.package is None else (source.package.name, source.package.path)


def _find_file_of_name(plain: str, source: Source) -> Path | None:
    """Return the only file of a path's name in the package; not one that is in the folder of another part."""
    package = _find_package(plain, source)
    if package is None or not source.finder.can_open(package[1]):
        return None
    resource, wanted = source.finder.resolve_resource(plain, source.path.parent), PurePosixPath(plain).name
    same = [path for path in index_files([package[1]]).get(wanted.lower(), []) if path.name == wanted]
    expected = package[1] / get_path_in_package(plain, "") if resource.path is None else resource.path
    return same[0] if len(same) == 1 and not is_in_folder_of_another(expected, same[0]) else None


def _format_path(path: Path, plain: str, source: Source) -> str:
    """Return the path of a file in the form of another one: in its package, or from the model's file."""
    package = _find_package(plain, source) if _SCHEME.match(plain) else None
    if package is None:
        return format_path_from_model(path, source)
    return f"package://{package[0]}/{path.relative_to(package[1]).as_posix()}"


def _exists(path: str, source: Source) -> bool:
    return source.finder.resolve_resource(path, source.path.parent).exists


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


def _propose_edits(use: ResourceUse, source: Source, moved: Mapping[str, str]) -> tuple[Edit, ...]:
    problem = _classify_path_problem(use, source)  # paths with one problem have different corrections
    suggestion = None if problem is None else problem.suggestion
    return () if suggestion is None else build_replacement_edits([use.attribute], moved.get(suggestion, suggestion))
