"""PKG013 reports packages with the same name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from urdfcheck.core import Finding, Location, Rule, Severity, Span
from urdfcheck.core.text import format_count, join_names
from urdfcheck.source.package.built_packages import are_in_one_workspace, are_of_series, select_rivals
from urdfcheck.source.package.finder import Package, format_path


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    root, finder = package.root, package.finder
    name = None if root is None else root.find_child("name")
    if name is None or finder is None or not package.name:
        return
    namesakes = finder.list_namesakes(package.name)
    rivals = select_rivals(package.path, namesakes)
    if not rivals or (package.is_fully_checked and _is_told_elsewhere(package.path, rivals, namesakes)):
        return
    outer = min((package.path, *rivals), key=lambda folder: len(folder.parts))
    nested = all(outer in folder.parents for folder in (package.path, *rivals) if folder != outer)
    message = "nested" if nested else _classify_copies((package.path, *rivals))
    yield rule.finding(
        message,
        at=name,
        severity=None if message in {"nested", "several"} else Severity.INFO,
        related=[_locate_manifest(folder) for folder in rivals],
        name=package.name,
        amount=format_count(len(rivals) + 1, "package"),
        folders=[format_path(folder) for folder in (package.path, *rivals)],
        # colcon knows both marks, catkin only its own.
        mark="CATKIN_IGNORE" if "catkin" in package.dependencies else "COLCON_IGNORE",
        listed=join_names((format_path(folder / "package.xml") for folder in sorted((package.path, *rivals))), 4),
    )


def _classify_copies(folders: Sequence[Path]) -> str:
    if are_of_series(folders):
        return "series"
    return "several" if are_in_one_workspace(folders) else "workspaces"


def _is_told_elsewhere(own: Path, rivals: list[Path], namesakes: list[Path]) -> bool:
    """Whether another of them reports the finding: in a folder that is checked as a whole, the first known one does."""
    return own not in namesakes or any(namesakes.index(rival) < namesakes.index(own) for rival in rivals)


def _locate_manifest(folder: Path) -> Location:
    return Location("package", Span(format_path(folder / "package.xml"), 1, 1, 1, 1, 0, 0))
