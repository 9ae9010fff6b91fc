"""Variants of a xacro with arguments: smaller sets of arguments that may show a finding too."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core import Finding, Severity, SkippedCheck
from urdfcheck.core.text import join_names
from urdfcheck.run.jobs import Unit, UnitReport
from urdfcheck.run.shared_findings import get_defect_key
from urdfcheck.source.model_role import MODEL

# Sets of arguments of one file that are tried to find smaller ones that show a finding.
MAX_TRIED = 100


def propose_smaller_variants(units: Sequence[Unit], reports: Mapping[int, UnitReport]) -> list[Unit]:
    """Propose unchecked variants that may show a finding with fewer arguments.

    For each finding, halves of its smallest set of arguments are left out, then quarters and so on (Zeller and Hildebrandt,
    Simplifying and Isolating Failure-Inducing Input, 2002).
    """
    tried = {_get_identity(unit) for unit in units if unit.kind == "model"}
    more = Counter(unit.path for unit in units if unit.is_reduced)
    best: dict[tuple[Any, ...], tuple[Unit, Finding]] = {}
    for place, unit in enumerate(units):
        # A spare model that another one makes needless is not checked.
        for finding in reports[place].findings if unit.kind == "model" and place in reports else ():
            key = (unit.path, *get_defect_key(finding))
            if key not in best or len(unit.arguments) < len(best[key][0].arguments):
                best[key] = unit, finding
    wanted: list[Unit] = []
    candidates = [_reduce_failed_variants(units, reports)]
    candidates += [
        _halve_arguments(unit, tried) for unit, _ in sorted(best.values(), key=lambda found: -found[1].severity)
    ]
    for some in candidates:
        for less in some:
            if more[unit.path] < MAX_TRIED and _get_identity(less) not in tried:
                tried.add(_get_identity(less))
                more[unit.path] += 1
                wanted.append(less)
    return wanted


def propose_other_environments(units: Sequence[Unit], reports: Mapping[int, UnitReport]) -> list[Unit]:
    """Return unchecked variants of models that make other robots under other distributions of ROS."""
    tried = {_get_identity(unit) for unit in units if unit.kind == "model"}
    wanted: list[Unit] = []
    for place, unit in enumerate(units):
        for variables in reports[place].other_environments if place in reports and reports[place].role == MODEL else ():
            arguments = {**unit.arguments, **variables}
            named = unit.id.removesuffix(format_arguments(unit.arguments)) + format_arguments(arguments)
            other = replace(
                unit, arguments=arguments, id=named, launches=(), varied_arguments=(*unit.varied_arguments, *variables)
            )
            if _get_identity(other) not in tried:
                tried.add(_get_identity(other))
                wanted.append(other)
    return wanted


def leave_out_unknown_calls(audited_units: Sequence[tuple[Unit, UnitReport]]) -> list[tuple[Unit, UnitReport]]:
    """Leave out models that make no robot with what is known of their arguments, where others are made of their files.

    The launch file sets further arguments, to values that are only known at launch: with their defaults the model cannot be
    expanded, or has no link.
    """
    made = {unit.path for unit, report in audited_units if _makes_robot(report)}
    return [
        (unit, _reduce_to_skip(unit, report))
        if unit.unknown_arguments and report.info is not None and not _makes_robot(report) and unit.path in made
        else (unit, report)
        for unit, report in audited_units
    ]


def _makes_robot(report: UnitReport) -> bool:
    return report.info is not None and report.info.status == "checked" and report.info.links > 0


def _reduce_to_skip(unit: Unit, report: UnitReport) -> UnitReport:
    """Return the report on the launch files alone, with the reason why the model was not checked."""
    names = join_names(sorted(unit.unknown_arguments))
    is_expanded = report.info is not None and report.info.status == "checked"
    what = "has no link" if is_expanded else "cannot be expanded"
    reason = f"{what} with the default of {names}: the launch file sets it to a value that is only known at launch"
    findings = tuple(f for f in report.findings if not f.blocks_check and f.code != "KIN007")
    return replace(report, info=None, findings=findings, skipped=(SkippedCheck("ALL", unit.id, reason),))


def _reduce_failed_variants(units: Sequence[Unit], reports: Mapping[int, UnitReport]) -> list[Unit]:
    """Drop from variants that fail to expand the arguments that alone make another variant fail: they hide everything else."""
    failed: dict[tuple[Any, ...], list[Unit]] = {}
    for place, unit in enumerate(units):
        report = reports.get(place)
        if unit.varied_arguments and report is not None and report.info is not None and report.info.status == "failed":
            for finding in report.findings:
                if finding.severity == Severity.ERROR:
                    failed.setdefault((unit.path, *get_defect_key(finding)), []).append(unit)
    found = []
    for alike in failed.values():
        alike.sort(key=lambda unit: (len(unit.varied_arguments), unit.id))
        for unit in alike:
            parts = (other for other in alike if other.arguments.items() < unit.arguments.items())
            found += [_drop_arguments(unit, part.varied_arguments[-1:]) for part in parts][:1]
    return found


def _drop_arguments(unit: Unit, names: Collection[str]) -> Unit:
    """Return the variant with the defaults of these arguments."""
    arguments = {name: value for name, value in unit.arguments.items() if name not in names}
    varied = tuple(name for name in unit.varied_arguments if name not in names)
    named = unit.id.removesuffix(format_arguments(unit.arguments)) + format_arguments(arguments)
    return replace(unit, arguments=arguments, id=named, varied_arguments=varied, is_reduced=True)


def _halve_arguments(unit: Unit, tried: Collection[tuple[str, frozenset[tuple[str, str]]]]) -> list[Unit]:
    """Return the variants that leave out the largest groups of arguments that have not been tried."""
    size = len(unit.varied_arguments)
    while len(unit.varied_arguments) > 1 and size > 1:
        size = (size + 1) // 2
        found = [
            _drop_arguments(unit, unit.varied_arguments[start : start + size])
            for start in range(0, len(unit.varied_arguments), size)
        ]
        if any(_get_identity(less) not in tried for less in found):
            return found
    return []


def _get_identity(unit: Unit) -> tuple[str, frozenset[tuple[str, str]]]:
    return unit.path, frozenset(unit.arguments.items())


def format_arguments(arguments: Mapping[str, str]) -> str:
    """Return the arguments as they follow the path in the id of a model."""
    return "".join(f" {name}:={value}" for name, value in sorted(arguments.items()))
