"""PKG005 reports paths that lead out of their package by ``..``."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import field
from pathlib import Path

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.resources import list_resource_uses
from urdfcheck.source.ros.dependencies import describe_declaration, needs
from urdfcheck.source.text.xml import Attribute
from urdfcheck.source.xacro.usage import iter_elements_by_tag

_FIND = re.compile(r"^\s*\$\(find\s+([^\s()]+)\s*\)/([^$]*)$")


@dataclass(frozen=True, slots=True, kw_only=True)
class _EscapingPath:
    """A path that leads out of its package to a file that exists."""

    attribute: Attribute
    text: str
    package: str
    """The package in which the path begins."""
    target: Path
    """The file, as an absolute path."""


@dataclass(slots=True)
class _EscapeTarget:
    """The target of several paths: another package, or a folder outside all packages."""

    package: str
    """Empty for a folder outside all packages."""
    folder: Path
    escapes: list[_EscapingPath] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    goals: dict[tuple[str, Path], _EscapeTarget] = {}
    for escape in (*_find_escaping_files(source), *_find_escaping_includes(source)):
        other = source.finder.find_package_of(escape.target)
        goal = _EscapeTarget("", escape.target.parent) if other is None else _EscapeTarget(other.name, other.path)
        goals.setdefault((escape.package, goal.folder), goal).escapes.append(escape)
    for goal in goals.values():
        yield _build_finding(goal, rule, source)


def _find_escaping_files(source: Source) -> Iterator[_EscapingPath]:
    home = source.package
    for use in list_resource_uses(source):
        resource = use.resource
        if resource.path is None or not resource.exists or ".." not in resource.text:
            continue
        folder = source.finder.find(resource.package) if resource.package else None if home is None else home.path
        name = resource.package or ("" if home is None else home.name)
        if folder is not None and resource.kind in {"package", "relative"} and not _is_below(resource.path, folder):
            target = _make_absolute(resource.path)
            yield _EscapingPath(attribute=use.attribute, text=resource.text, package=name, target=target)


def _find_escaping_includes(source: Source) -> Iterator[_EscapingPath]:
    home_package = source.package
    if home_package is None:
        return
    for element in iter_elements_by_tag(select_own_trees(source), "xacro:include"):
        filename = element.attributes.get("filename")
        if filename is None or filename.span is None or ".." not in filename.value:
            continue
        match = _FIND.match(filename.value)
        package, inside = match.groups() if match else (home_package.name, filename.value.strip())
        home = source.finder.find(package) if match else home_package.path
        start = home if match else source.files[filename.span.file].path.absolute().parent
        if home is None or start is None or "$" in inside:
            continue
        target = start / inside
        if not _is_below(target, home) and source.finder.can_open(target) and target.is_file():
            yield _EscapingPath(attribute=filename, text=filename.value, package=package, target=_make_absolute(target))


def _is_below(path: Path, folder: Path) -> bool:
    """Whether a path stays in a folder, by its text or with symbolic links resolved."""
    return any(
        f in p.parents for p, f in ((_make_absolute(path), _make_absolute(folder)), (path.resolve(), folder.resolve()))
    )


def _make_absolute(path: Path) -> Path:
    return Path(os.path.abspath(path))


def _build_finding(goal: _EscapeTarget, rule: Rule, source: Source) -> Finding:
    first, *others = goal.escapes
    files = list(dict.fromkeys(escape.text for escape in goal.escapes))
    span = first.attribute.span
    file = None if span is None else source.files.get(span.file)
    owner = source.package if file is None else source.finder.find_package_of(file.path.absolute())
    is_above = bool(goal.package) and owner is not None and needs(goal.package, owner, source.finder)
    edits = {e.attribute.span: edit for e in goal.escapes for edit in _propose_edits(e, goal) if not is_above}
    return rule.finding(
        "package" if goal.package else "nowhere",
        at=first.attribute,
        related=[e.attribute for e in others if e.attribute.span != first.attribute.span],
        edits=edits.values(),
        package=first.package,
        other=goal.package,
        folder=format_path(goal.folder),
        files=files,
        listed=join_names(files, 2),
        repair=_describe_repair(first, goal, owner, source.finder, is_above=is_above) if goal.package else "",
    )


def _describe_repair(
    escape: _EscapingPath, goal: _EscapeTarget, owner: Package | None, finder: PackageFinder, *, is_above: bool
) -> str:
    """Say to name the other package, or to move the files where that one needs the package of the file (``is_above``)."""
    if owner is not None and is_above:
        return f"move what the robot needs into {owner.name}: {goal.package} depends on it, so package.xml cannot declare that"
    return f"write `{_build_portable_path(escape, goal)}`{describe_declaration(owner, goal.package, finder)}"


def _build_portable_path(escape: _EscapingPath, goal: _EscapeTarget) -> str:
    if not goal.package:
        return ""
    inside = Path(os.path.relpath(escape.target, goal.folder)).as_posix()
    start = f"$(find {goal.package})" if escape.attribute.owner.tag == "xacro:include" else f"package://{goal.package}"
    return f"{start}/{inside}"


def _propose_edits(escape: _EscapingPath, goal: _EscapeTarget) -> Iterator[Edit]:
    attribute = escape.attribute
    typed = attribute.literal or attribute.owner.tag == "xacro:include"
    if goal.package and typed and attribute.span is not None:
        yield Edit(attribute.span, attribute.typed, _build_portable_path(escape, goal))
