"""PKG012 reports files of a model that are outside the folders that may be read."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source, locate_expression
from urdfcheck.source.package.finder import Package, format_path
from urdfcheck.source.reach import is_in_home_of_another
from urdfcheck.source.resources import (
    ResourceUse,
    describe_namesakes,
    find_in_package,
    find_installed_file,
    find_machine_path,
    find_package_address,
    is_misspelt,
    list_resource_uses,
)
from urdfcheck.source.ros.dependencies import describe_declaration
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.uses_elsewhere import find_copying_build

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch

# How far above the working directory a folder is proposed.
MOST_LEVELS_UP = 3
_MOVE_ONLY = "move what the robot needs into its package"
_MOVE = _MOVE_ONLY + "; if you trust the place, allow its folder: --allow-read {folder}"
# A path in a package of a workspace: its name, and the file in it.
_OF_PACKAGE = re.compile(r"/src/(?:[^/]+/)*?([A-Za-z]\w+)/((?:launch|urdf|xacro|config|robots|models?|meshes)/.+)$")


def check(context: Source | LaunchContext, rule: Rule) -> Iterator[Finding]:
    subject = context.launch if isinstance(context, LaunchContext) else context
    for problem in subject.problems:
        if problem.kind == "out-of-reach":
            yield _build_unread_finding(problem, subject, rule)
    if isinstance(subject, Source):
        uses = [u for u in list_resource_uses(subject) if _is_outside(u, subject)]
        files = list(dict.fromkeys(u.resource.text for u in uses))
        if uses:
            folder = _name_folder(uses[0].resource.path)
            build = find_copying_build(subject)
            yield rule.finding(
                "mesh",
                at=uses[0],
                severity=None if build is None else Severity.WARNING,
                related={u.attribute.span: u for u in uses[1:]}.values(),
                amount=format_count(len(files), "file is", "files are"),
                files=files,
                listed=join_names(files, 3),
                folder=folder,
                repair=_describe_repair(uses, subject, folder) if build is None else _describe_copy(build),
            )


def _is_outside(use: ResourceUse, source: Source) -> bool:
    return not use.resource.allowed and not is_misspelt(use, source) and find_machine_path(use, source) is None


def _describe_repair(uses: Sequence[ResourceUse], source: Source, folder: str) -> str:
    """Say to allow the folder first where nothing shows which folder the robot's is: the files may well be its own."""
    is_marked = source.package is not None or source.finder.find_repository() is not None
    if is_marked or any(use.resource.kind != "relative" for use in uses):
        return f"{describe_namesakes(uses, source)}{_MOVE.format(folder=folder)}"
    reason = "without .git or package.xml only the model's folder is read"
    return f"if the folder is the robot's own, allow it: --allow-read {folder}; {reason}"


def _describe_copy(build: Path) -> str:
    return (
        f"{format_path(build)} copies the model: if the paths are those of the copy, check that one; else {_MOVE_ONLY}"
    )


def _build_unread_finding(problem: Problem, subject: Source | Launch, rule: Rule) -> Finding:
    place = _UnreadPlace(Path(os.path.abspath(problem.data["path"])), problem, subject)
    shown = place.path.as_posix() if place.is_typed else problem.data["path"]
    if not isinstance(subject, Source):
        return rule.finding("launch", at=problem.location, path=shown, repair=place.describe_repair())
    at = locate_expression(subject, problem, "load_yaml")  # xacro evaluates a property where it is first read
    others = [] if at is problem.location else [problem.location]
    related = [*others, *(r for r in problem.related if r.span != at.span)]
    remedy = "" if place.is_of_other_machine else f"--allow-read {shlex.quote(place.folder)}"
    address = find_package_address(problem.data["path"])
    repair = f"write `{address}`: xacro does not know package://" if address is not None else place.describe_repair()
    return rule.finding("read", at=at, related=related, path=shown, repair=repair, remedy=remedy)


@dataclass(frozen=True, slots=True, eq=False)
class _UnreadPlace:
    """A file that a model or a launch file names and that was not opened. Whether it exists is not known."""

    path: Path
    problem: Problem
    subject: Source | Launch

    @property
    def folder(self) -> str:
        return _name_folder(self.path)

    @property
    def is_typed(self) -> bool:
        """Whether the whole path is typed where the file is named."""
        spans = [place.span for place in (self.problem.location, *self.problem.related)]
        texts = (self.subject.files[s.file].text[s.start : s.end] for s in spans if s and s.file in self.subject.files)
        return any(self.path.as_posix() in text for text in texts)

    @property
    def is_of_other_machine(self) -> bool:
        """Whether the path is typed and leads into the home of another user: no folder here is meant."""
        return is_in_home_of_another(self.path) and self.is_typed

    def describe_repair(self) -> str:
        """Say to name the file by the package where it is the package's own, typed as a path of its author's machine."""
        package, finder = self.subject.package, self.subject.finder
        launch = None if isinstance(self.subject, Source) else self.subject
        if package is None or (launch is not None and launch.python is not None):
            return self._describe_move()
        find = "find-pkg-share" if launch is not None and launch.dialect == "ros2" else "find"
        inside = find_in_package(self.path, package, finder)
        if inside is not None:
            return f"write `$({find} {package.name})/{inside}`: the package has the file"
        installed = find_installed_file(self.path) if self.is_typed else None
        if installed is not None and installed[0] != package.name:
            return (
                f"write `$({find} {installed[0]})/{installed[1]}`{describe_declaration(package, installed[0], finder)}"
            )
        if not self.is_of_other_machine:
            return self._describe_move()
        inside = self._find_namesake(package)
        if inside is not None:
            own = f"$({find} {package.name})/{inside}"
            return f"if {inside} of the package is the file that is meant, write `{own}`; else {self._describe_move()}"
        owner = _OF_PACKAGE.search(self.path.as_posix())
        if owner is not None and owner[1] != package.name:
            named = f"$({find} {owner[1]})/{owner[2]}"
            declaration = describe_declaration(package, owner[1], finder, shown="it")
            return f"if {owner[1]} is a package, write `{named}`{declaration}; else {self._describe_move()}"
        return self._describe_move()

    def _describe_move(self) -> str:
        return _MOVE_ONLY if self.is_of_other_machine else _MOVE.format(folder=self.folder)

    def _find_namesake(self, package: Package) -> str | None:
        """Return the file of the package that the end of the path names, a folder and a name at least, or that is beside the
        file that names it."""
        parts, span = self.path.parts, self.problem.location.span
        places = [package.path.joinpath(*parts[start:]) for start in range(1, len(parts) - 1)]
        if span is not None:
            places.append(Path(os.path.abspath(span.file)).parent / self.path.name)
        own = package.path.absolute()
        for place in map(Path.absolute, places):
            if place.is_relative_to(own) and self.subject.finder.can_open(place) and os.path.isfile(place):
                return place.relative_to(own).as_posix()
        return None


def _name_folder(path: Path | None) -> str:
    """Return the folder of a file as the command line takes it; ``DIR`` for one that is far off, or at the top of the disk."""
    if path is None or len(Path(os.path.abspath(path.parent)).parts) < 3:
        return "DIR"
    shown = format_path(path.parent)
    return "DIR" if os.path.isabs(shown) or Path(shown).parts.count("..") > MOST_LEVELS_UP else shown
