"""The reports of all units put together to the outcome of a run."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from functools import cache
from pathlib import Path

from urdfcheck.core import Finding, Location, Rule, Run, SkippedCheck, Span
from urdfcheck.policy import baseline
from urdfcheck.policy.suppression import report_bad_comments
from urdfcheck.rules import has_check, load_check, load_rules
from urdfcheck.run.findings import finalize_run_findings
from urdfcheck.run.jobs import Request, Unit, UnitReport
from urdfcheck.run.shared_findings import count_more_notes, merge_unrequested
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.plan import Plan
from urdfcheck.system import libraries
from urdfcheck.system.files import read_regular
from urdfcheck.version import __version__

# Libraries whose versions a full report lists.
DISTRIBUTIONS = ("xacro", "numpy", "pin", "coal", "trimesh")
# Units that were checked, with their reports.
AuditedUnits = Sequence[tuple[Unit, UnitReport]]
# File and root folder of a baseline; None for the run's own.
BaselineHome = tuple[str, str] | None


def build_run(request: Request, plan: Plan, *, audited_units: AuditedUnits, seconds: float) -> Run:
    """Return the outcome of a run."""
    units = [unit for unit, _ in audited_units]
    reports = [report for _, report in audited_units]
    across_models, crashes = _run_cross_model_checks(request, audited_units)
    skipped = _collect_skips(plan, reports)
    models = tuple(report.info for report in reports if report.info is not None)
    complete_rules = _list_complete_rules(request, units)
    unit_names = _group_by_baseline(units)
    baselines = list(_read_baselines(request, unit_names))
    unused_macro_files = list_unused_macro_files(plan, audited_units)

    def review(findings: Sequence[Finding], needed: AbstractSet[Span]) -> Iterator[Finding]:
        """Report on comments, libraries, configurations and baselines, given all findings about models."""
        view = baseline.BaselineView(
            findings=findings, models=models, complete_rules=complete_rules, skipped=skipped, tier=request.policy.tier
        )
        yield from report_bad_comments(
            (unit.id, replace(usage, is_used=usage.is_used or usage.comment.span in needed))
            for unit, report in audited_units
            for usage in report.comments
        )
        yield from report_foreign_libraries()
        yield from map(report_misconfiguration, plan.config_errors)
        for known, names in baselines:
            yield from _report_outdated(known, view, names)

    findings, notes = finalize_run_findings(audited_units, request.policy, across_models=across_models, review=review)
    left_out = (*(finding for report in reports for finding in report.unrequested), *notes)
    unrequested = tuple(merge_unrequested(left_out, units))
    return Run(
        models=models,
        findings=findings,
        requested=request.policy.codes - request.policy.unrequested,
        unrequested=unrequested,
        more_notes=count_more_notes(findings, unrequested, units),
        postponed=_list_postponed(request, audited_units),
        skipped=skipped,
        rules=_select_rules(request, units, findings),
        versions=collect_versions(full=request.options.scene),
        sources=_collect_sources(plan, reports, [known for known, _ in baselines]),
        scenes=tuple(report.scene for report in reports if report.scene is not None),
        drops=tuple(report.drop for report in reports if report.drop is not None),
        seconds=seconds,
        failures=(*_collect_failures(plan, reports), *crashes),
        units=len(units),
        unit_ids=frozenset(unit.id for unit in units),
        complete_rules=complete_rules,
        baseline_unit_names=unit_names,
        tier=request.policy.tier,
        targets=request.policy.targets,
        targets_by_unit={
            unit.id: unit.policy.targets
            for unit in units
            if unit.policy is not None and unit.policy.targets != request.policy.targets
        },
        undeclared_arguments=_collect_undeclared_arguments(request, audited_units),
        has_unread_declarations=any(report.is_read_in_part for unit, report in audited_units if unit.kind == "model"),
        fail_on={unit.id: unit.fail_on for unit in units if unit.fail_on is not None},
        baselines=frozenset(format_path(known.path) for known, _ in baselines),
        unused_macro_files=unused_macro_files,
    )


def list_unused_macro_files(plan: Plan, audited_units: AuditedUnits) -> tuple[str, ...]:
    """Return the files with macros that no checked model has read."""
    if not plan.macro_files:
        return ()
    read = {os.path.realpath(unit.path) for unit, _ in audited_units}
    for _, report in audited_units:
        if report.info is not None and report.info.status == "checked":
            read.update(map(os.path.realpath, (*report.files, *report.srdf_files)))
    return tuple(sorted(format_path(path) for path in plan.macro_files if os.path.realpath(path) not in read))


def _collect_skips(plan: Plan, reports: Iterable[UnitReport]) -> tuple[SkippedCheck, ...]:
    """Return what could not be checked."""
    skipped = [skip for report in reports for skip in report.skipped]
    return (*skipped, *(SkippedCheck("ALL", path, reason) for path, reason in (*plan.unused, *plan.left_out)))


def _collect_failures(plan: Plan, reports: Iterable[UnitReport]) -> list[str]:
    """Return the paths that do not exist, and the failures of urdfcheck itself."""
    failures = [f"{path}: {reason}" for path, reason in plan.missing]
    return failures + [failure for report in reports for failure in report.failures]


def _collect_undeclared_arguments(request: Request, audited_units: AuditedUnits) -> dict[str, str]:
    """Return the arguments of the request that no model declares, none where that is unknown of a model."""
    reports = [report.undeclared for unit, report in audited_units if unit.kind == "model"]
    known = [undeclared for undeclared in reports if undeclared is not None]
    if not known or len(known) < len(reports):
        return {}
    return {
        name: next((similar for undeclared in known if (similar := undeclared[name])), "")
        for name in request.arguments
        if all(name in undeclared for undeclared in known)
    }


def _collect_sources(
    plan: Plan, reports: Iterable[UnitReport], baselines: Iterable[baseline.Baseline]
) -> dict[str, str]:
    """Return the text of the files that findings point into, by name."""
    sources: dict[str, str] = {}
    for report in reports:
        sources.update(report.sources)
    for error in plan.config_errors:
        sources.setdefault(*_read_named_file(error))
    sources.update({format_path(known.path): known.text for known in baselines})
    return sources


def _group_by_baseline(units: Iterable[Unit]) -> dict[BaselineHome, dict[str, str]]:
    """Return for each baseline the names that it has for the units, by their ids."""
    names: dict[BaselineHome, dict[str, str]] = {}
    for unit in units:
        names.setdefault(unit.baseline_home, {})[unit.id] = unit.baseline_name or unit.id
    return names


def _read_baselines(
    request: Request, unit_names: Mapping[BaselineHome, Mapping[str, str]]
) -> Iterator[tuple[baseline.Baseline, Mapping[str, str]]]:
    """Yield the baselines of a run that exist, each with its names for the units."""
    for home, names in unit_names.items():
        if home is None and request.baseline is not None:
            yield request.baseline, names
        elif home is not None and request.options.heed_comments:
            found = baseline.read_found_baseline(Path(home[0]), Path(home[1]))
            if found is not None:
                yield found, names


def _report_outdated(
    known: baseline.Baseline, view: baseline.BaselineView, names: Mapping[str, str]
) -> Iterator[Finding]:
    """Yield findings about stale entries of a baseline, under the ids of the run."""
    ids = {name: id_ for id_, name in names.items()}
    for finding in baseline.report_stale_entries(known, baseline.find_stale_entries(known, view.select_models(names))):
        yield replace(finding, model=ids.get(finding.model, finding.model))


def _run_cross_model_checks(request: Request, audited_units: AuditedUnits) -> tuple[list[Finding], list[str]]:
    """Run the checks that compare all models; return their findings, and which of them crashed."""
    outlines = [
        replace(report.outline, model=unit.id)
        for unit, report in audited_units
        if report.outline is not None and not unit.varied_arguments
    ]
    codes = _union_codes(request, (unit for unit, _ in audited_units))
    findings: list[Finding] = []
    crashes: list[str] = []
    for rule in load_rules().values():
        if "run" in rule.scopes and rule.code in codes and has_check(rule):
            options = {name: option.default for name, option in rule.options.items()}
            options.update(request.policy.options.get(rule.code, {}))
            try:
                findings += load_check(rule)(outlines, rule, **options)
            except Exception as error:
                crashes.append(f"{rule.code} crashed: {type(error).__name__}: {error}")
    return findings, crashes


def _union_codes(request: Request, units: Iterable[Unit]) -> frozenset[str]:
    """Return the rules that the run or any of its units selects."""
    return request.policy.codes.union(*(unit.policy.codes for unit in units if unit.policy is not None))


def _list_postponed(request: Request, audited_units: AuditedUnits) -> frozenset[str]:
    """Return the rules that run on a checked model where their notes are asked for."""
    checked = (unit for unit, report in audited_units if report.info is not None and report.info.status == "checked")
    return frozenset[str]().union(*((unit.policy or request.policy).postponed for unit in checked))


def _select_rules(request: Request, units: Iterable[Unit], findings: Iterable[Finding]) -> dict[str, Rule]:
    """Return the rules that may have findings: those selected, and those that say why a model could not be checked."""
    codes = _union_codes(request, units) | {"URC900"} | {f.code for f in findings if f.blocks_check}
    return {code: rule for code, rule in load_rules().items() if code in codes}


def _list_complete_rules(request: Request, units: Iterable[Unit]) -> dict[str, frozenset[str]]:
    """Return by unit id the rules of which this run cannot have missed a finding.

    A run over a part of the folder has not seen every launch file, package and model in it. A run for the targets of the
    command line says nothing of what its other targets would do.
    """
    root = Path(os.path.realpath(request.root))
    folders = [Path(os.path.realpath(path)) for path in request.paths if os.path.isdir(path)]
    is_partial = not any(folder == root or folder in root.parents for folder in folders)
    has_other_targets = request.config_resolver is not None and request.config_resolver.overrides.target is not None
    missed = _list_missed_codes(is_partial=is_partial, has_other_targets=has_other_targets)
    return {unit.id: (unit.policy or request.policy).codes - missed for unit in units}


@cache
def _list_missed_codes(*, is_partial: bool, has_other_targets: bool) -> frozenset[str]:
    """Return the rules of which a run over a part of the folder, or for other targets, may miss findings."""
    return frozenset(
        code
        for code, rule in load_rules().items()
        if (is_partial and {"launch", "package", "run"}.intersection(rule.scopes))
        or (has_other_targets and rule.depends_on_targets)
    )


def report_misconfiguration(text: str) -> Finding:
    """Return the finding URC901 about a configuration that could not be read; the text begins with file and line."""
    file, line, reason = re.match(r"(.*?):(?:(\d+):)? (.*)", text, re.DOTALL).groups()  # type: ignore[union-attr]
    number = int(line or 1)
    at = Location("configuration", Span(file, number, 1, number, 1, 0, 0))
    return load_rules()["URC901"].finding("wrong", at=at, reason=reason)


def _read_named_file(text: str) -> tuple[str, str]:
    """Return the file that such a text names, and its content, empty if it cannot be read."""
    name = text.partition(":")[0]
    try:
        return name, read_regular(Path(name)).decode("utf-8", "replace")
    except OSError:
        return name, ""


def report_foreign_libraries() -> list[Finding]:
    """Return the findings URC907: libraries that do not come from our own environment."""
    rule = load_rules()["URC907"]
    return [
        rule.finding("shadowed", at=Location(f"library[{library}]", None), library=library, path=path)
        for library, path in sorted(libraries.find_foreign_libraries().items())
    ]


def collect_versions(*, full: bool) -> dict[str, str]:
    """Return the versions of urdfcheck and Python; with ``full`` also of the libraries, which takes a while."""
    versions = {"urdfcheck": __version__, "python": ".".join(map(str, sys.version_info[:3]))}
    if not full:
        return versions
    from importlib.metadata import PackageNotFoundError, version  # slow to import

    for name in DISTRIBUTIONS:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return versions
