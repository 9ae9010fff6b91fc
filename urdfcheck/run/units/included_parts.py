"""Files that other files include: when they are audited as separate models, and what is reported about the others."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Severity
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Unit, UnitReport
from urdfcheck.source.model_file import names_file
from urdfcheck.source.model_role import MODEL
from urdfcheck.source.package.file_kinds import is_srdf
from urdfcheck.source.package.finder import format_path, load_package


def list_next_units(units: Sequence[Unit], reports: Mapping[int, UnitReport]) -> list[int]:
    """Return the units to audit now: all but the spare ones, and after those the spare ones of which no model is made."""
    missing = [index for index in range(len(units)) if index not in reports]
    first = [index for index in missing if not units[index].is_spare]
    if first or not missing:
        return first
    spared = find_read_spares(units, reports)
    return [index for index in missing if index not in spared]


def find_read_spares(units: Sequence[Unit], reports: Mapping[int, UnitReport]) -> frozenset[int]:
    """Return the spare units that need no audit: the links and joints of their files are in a model that was audited."""
    used = _collect_robot_files((units[index], report) for index, report in reports.items())
    return frozenset(
        index
        for index, unit in enumerate(units)
        if unit.is_spare and index not in reports and format_path(Path(unit.path)) in used
    )


def leave_out_blamed_parts(audited_units: Sequence[tuple[Unit, UnitReport]]) -> list[tuple[Unit, UnitReport]]:
    """Leave out the parts that cannot be expanded where a model that includes them already says so: one defect, one model."""
    blamed = [_list_blamed_files(report) for _, report in audited_units]
    return [
        (unit, report)
        for place, (unit, report) in enumerate(audited_units)
        if not (
            unit.is_part
            and not unit.is_explicit
            and blamed[place]
            and any(
                blamed[place] <= files
                for other, files in enumerate(blamed)
                if audited_units[other][0].path != unit.path
            )
        )
    ]


def _list_blamed_files(report: UnitReport) -> frozenset[str]:
    """Return the files at which the report says why its model could not be checked."""
    spans = (finding.location.span for finding in report.findings if finding.blocks_check)
    return frozenset(span.file for span in spans if span is not None)


def _collect_robot_files(audited_units: Iterable[tuple[Unit, UnitReport]]) -> set[str]:
    """Return the names of all files of which links or joints of models were made."""
    return {name for _, report in audited_units if report.role == MODEL for name in report.robot_files}


def assign_parts(
    audited_units: Sequence[tuple[Unit, UnitReport]],
) -> tuple[list[tuple[Unit, UnitReport]], list[tuple[str, str]]]:
    """Return the models, and the files that are none and belong to no model that was audited, each with the reason.

    A part that could be a model but for a slip is a model that was not checked, unless a model of its package failed, which may
    include it. A library that is part of something is left out: there is nothing in it to check.
    """
    used = _collect_robot_files(audited_units)
    models = [report for _, report in audited_units if report.role == MODEL]
    read = {name for report in models for name in (*report.expanded_files, *report.srdf_files)}
    # What a model that could not be expanded is made of is unknown, and so is told with that model.
    failed = [report for report in models if report.info is not None and report.info.status != "checked"]
    used.update(name for report in failed for name in report.expanded_files)
    # It may have stopped before it came to a part of its package, and fails the run already.
    excusing = {
        _find_home(Path(unit.path))
        for unit, r in audited_units
        if r.role == MODEL and r.info is not None and r.info.unchecked_severity == Severity.ERROR
    }
    kept: list[tuple[Unit, UnitReport]] = []
    reasons: dict[str, str] = {}
    for unit, report in audited_units:
        role, name = report.role, format_path(Path(unit.path))
        if role == MODEL:
            kept.append((unit, report))
        elif role.kind == "library" and unit.is_explicit and name not in read:
            includes = "that was checked reads it" if unit.is_part else "of its package or repository includes it"
            reasons[name] = f"{role.reason}, and no model {includes}"
        elif role.kind == "part" and name not in (used if role.is_doubtful else read) and not is_srdf(Path(unit.path)):
            if role.must_be_checked and _find_home(Path(unit.path)) not in excusing:
                kept.append((unit, replace(report, role=MODEL, findings=_blame_user(unit, report, failed))))
            else:
                reasons[name] = f"is not checked: no model that was checked is made of this part, and {role.reason}"
    return kept, sorted(reasons.items())


def _blame_user(part: Unit, report: UnitReport, failed: Sequence[UnitReport]) -> tuple[Finding, ...]:
    """Return the findings of a part that was not checked; a failed model that names its file is why no model includes it."""
    home = _find_home(Path(part.path))
    package = load_package(home)
    own, inside = "" if package is None else package.name, Path(os.path.relpath(part.path, home)).as_posix()
    users = (f.info.path for f in failed if f.info and any(names_file(t, inside, own) for t in f.sources.values()))
    user = next(users, None)
    if user is None:
        return report.findings
    return tuple(
        _blame(finding, user)
        if finding.code == "XML002" and finding.message_id in {"part", "part-of-variant"}
        else finding
        for finding in report.findings
    )


def _blame(finding: Finding, user: str) -> Finding:
    told = load_rules()["XML002"].finding("part-of-failed", at=finding.location, user=user)
    return replace(
        finding,
        message_id=told.message_id,
        headline=told.headline,
        message=told.message,
        data=told.data,
        fix=told.fix,
    )


def _find_home(path: Path) -> Path:
    """Return the folder of a file's package, else the file's own."""
    folders = path.absolute().parents
    return next((folder for folder in folders if os.path.isfile(folder / "package.xml")), folders[0])
