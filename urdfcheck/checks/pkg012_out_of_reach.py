"""PKG012 reports files of a model that are outside the folders that may be read."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source, locate_expression
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.resources import (
    ResourceUse,
    find_in_package,
    find_machine_path,
    find_package_address,
    is_misspelt,
    list_resource_uses,
)
from urdfcheck.source.text.problems import Problem

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch

# How far above the working directory a folder is proposed.
MOST_LEVELS_UP = 3
_MOVE = "move what the robot needs into its package; if you trust the place, allow its folder: --allow-read {folder}"


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
            yield rule.finding(
                "mesh",
                at=uses[0],
                related={u.attribute.span: u for u in uses[1:]}.values(),
                amount=format_count(len(files), "file is", "files are"),
                files=files,
                listed=join_names(files, 3),
                folder=folder,
                repair=_describe_repair(uses, subject, folder),
            )


def _is_outside(use: ResourceUse, source: Source) -> bool:
    return not use.resource.allowed and not is_misspelt(use) and find_machine_path(use, source) is None


def _describe_repair(uses: Sequence[ResourceUse], source: Source, folder: str) -> str:
    """Say to allow the folder first where nothing shows which folder the robot's is: the files may well be its own."""
    is_marked = source.package is not None or source.finder.find_repository() is not None
    if is_marked or any(use.resource.kind != "relative" for use in uses):
        return _MOVE.format(folder=folder)
    reason = "without .git or package.xml only the model's folder is read"
    return f"if the folder is the robot's own, allow it: --allow-read {folder}; {reason}"


def _build_unread_finding(problem: Problem, subject: Source | Launch, rule: Rule) -> Finding:
    path = problem.data["path"]
    folder = _name_folder(Path(path))
    if not isinstance(subject, Source):
        repair = _describe_launch_repair(Path(path), subject, folder)
        return rule.finding("launch", at=problem.location, path=path, repair=repair)
    at = locate_expression(subject, problem, "load_yaml")  # xacro evaluates a property where it is first read
    others = [] if at is problem.location else [problem.location]
    related = [*others, *(r for r in problem.related if r.span != at.span)]
    remedy = f"--allow-read {shlex.quote(folder)}"
    inside = find_in_package(Path(path), subject.package, subject.finder)
    if (typed := find_package_address(path)) is not None:
        repair = f"write `{typed}`: xacro does not know package://"
    elif subject.package is None or inside is None:
        repair = _MOVE.format(folder=folder)
    else:
        repair = f"write `$(find {subject.package.name})/{inside}`: the package has the file"
    return rule.finding("read", at=at, related=related, path=path, repair=repair, remedy=remedy)


def _describe_launch_repair(path: Path, launch: Launch, folder: str) -> str:
    """Say to name the file by the package where it is the package's own, typed as a path of its author's machine."""
    inside = find_in_package(path, launch.package, launch.finder)
    if launch.package is None or inside is None or launch.python is not None:
        return _MOVE.format(folder=folder)
    find = "find-pkg-share" if launch.dialect == "ros2" else "find"
    return f"write `$({find} {launch.package.name})/{inside}`: the package has the file"


def _name_folder(path: Path | None) -> str:
    """Return the folder of a file as the command line takes it; ``DIR`` for one that is far off, or at the top of the disk."""
    if path is None or len(Path(os.path.abspath(path.parent)).parts) < 3:
        return "DIR"
    shown = format_path(path.parent)
    return "DIR" if os.path.isabs(shown) or Path(shown).parts.count("..") > MOST_LEVELS_UP else shown
