"""The reports of the units of a run, put together: what only all of them show, what is known already, one order."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck import __version__
from urdfcheck import rules as catalogue
from urdfcheck.core import Finding, Location, Run, SkippedCheck, Span
from urdfcheck.policy import baseline
from urdfcheck.policy.consumers import apply_severity_policy
from urdfcheck.policy.fix_safety import mark_unsafe_across_models
from urdfcheck.policy.suppression import mark_suppressed, report_bad_comments
from urdfcheck.run.audit import get_sort_key, merge_same_text, truncate_texts
from urdfcheck.run.variants import merge_variants
from urdfcheck.source.package.finder import format_path
from urdfcheck.system import libraries
from urdfcheck.system.files import read_regular

if TYPE_CHECKING:
    from urdfcheck.run.audit import Unit, UnitReport
    from urdfcheck.run.pipeline import Request
    from urdfcheck.source.discover import Plan

DISTRIBUTIONS = ("xacro", "numpy", "pin", "coal", "trimesh")


def build_run(request: Request, plan: Plan, audited_units: Sequence[tuple[Unit, UnitReport]], seconds: float) -> Run:
    """The outcome of a run. ``kept``: the units that were checked, and their reports."""
    skipped: list[SkippedCheck] = [s for _, r in audited_units for s in r.skipped]
    skipped += [SkippedCheck("ALL", path, reason) for path, reason in plan.unused]
    failures = [f"{path}: {reason}" for path, reason in plan.missing]
    failures += [f for _, r in audited_units for f in r.failures]
    across, crashes = _run_cross_model_checks(request, audited_units)
    across, used = _suppress_cross_model(request, audited_units, _apply_policies(request, audited_units, across))
    findings: list[Finding] = [*(f for _, r in audited_units for f in r.findings), *merge_same_text(across)]
    models = tuple(r.info for _, r in audited_units if r.info is not None)
    comments = [
        (u.id, replace(j, is_used=j.is_used or j.comment.span in used)) for u, r in audited_units for j in r.comments
    ]
    own = [*report_bad_comments(comments), *report_foreign_libraries()]
    sources: dict[str, str] = {}
    for _, report in audited_units:
        sources.update(report.sources)
    for text in plan.config_errors:
        own.append(report_misconfiguration(text))
        sources.setdefault(*_read_named_file(text))
    judged = _list_complete_rules(request, [unit for unit, _ in audited_units])
    homes: dict[tuple[str, str] | None, dict[str, str]] = {}
    for unit, _ in audited_units:
        homes.setdefault(unit.baseline_home, {})[unit.id] = unit.baseline_name or unit.id
    seen = baseline.BaselineView(findings, models, judged, skipped, request.tier)
    baselines: dict[str, str] = {}
    for known, names in _read_baselines(request, homes):
        own += _report_outdated(known, seen, names)
        baselines[format_path(known.path)] = known.text
    sources.update(baselines)
    findings += _apply_policies(request, audited_units, own)
    users: dict[str, set[str]] = {}
    for unit, report in audited_units:
        for name in report.files:
            users.setdefault(name, set()).add(unit.id)
    rules = catalogue.load_rules()
    selected = request.codes.union({"URC900"}, *(u.own_settings.get("codes", ()) for u, _ in audited_units))
    return Run(
        models=models,
        findings=tuple(
            sorted(
                merge_variants(mark_unsafe_across_models(findings, users), [u for u, _ in audited_units]),
                key=get_sort_key,
            )
        ),
        skipped=tuple(skipped),
        rules={code: rule for code, rule in rules.items() if code in selected},
        versions=collect_versions(full=request.scene),
        sources=sources,
        scenes=tuple(r.scene for _, r in audited_units if r.scene is not None),
        drops=tuple(r.drop for _, r in audited_units if r.drop is not None),
        seconds=seconds,
        failures=(*failures, *crashes),
        units=len(audited_units),
        unit_ids=frozenset(unit.id for unit, _ in audited_units),
        complete_rules=judged,
        baseline_unit_names=homes,
        tier=request.tier,
        targets=request.targets,
        fail_on={u.id: u.fail_on for u, _ in audited_units if u.fail_on is not None},
        baselines=frozenset(baselines),
    )


def _read_baselines(
    request: Request, homes: Mapping[tuple[str, str] | None, Mapping[str, str]]
) -> Iterator[tuple[baseline.Baseline, Mapping[str, str]]]:
    """The baselines of a run that exist, each with how it calls the units."""
    for home, names in homes.items():
        if home is None and request.baseline is not None:
            yield request.baseline, names
        elif home is not None and request.heed_comments and os.path.isfile(home[0]):
            yield baseline.read_baseline(Path(home[0]), Path(home[1])), names


def _report_outdated(
    known: baseline.Baseline, seen: baseline.BaselineView, names: Mapping[str, str]
) -> Iterator[Finding]:
    """What is stale in a baseline, under the ids of the run."""
    ids = {entry: name for name, entry in names.items()}
    for finding in baseline.report_stale_entries(known, baseline.find_stale_entries(known, seen.select_models(names))):
        yield replace(finding, model=ids.get(finding.model, finding.model))


def _run_cross_model_checks(
    request: Request, kept: Sequence[tuple[Unit, UnitReport]]
) -> tuple[list[Finding], list[str]]:
    """What the rules find that look at all models together, and which of them crashed."""
    outlines = [replace(r.outline, model=u.id) for u, r in kept if r.outline is not None and not u.varied_arguments]
    codes = request.codes.union(*(u.own_settings.get("codes", ()) for u, _ in kept))
    findings: list[Finding] = []
    crashes: list[str] = []
    for rule in catalogue.load_rules().values():
        if "run" in rule.scopes and rule.code in codes and catalogue.has_check(rule):
            options = {name: o.default for name, o in rule.options.items()}
            options.update(request.options.get(rule.code, {}))
            try:
                findings += catalogue.load_check(rule)(outlines, rule, **options)
            except Exception as error:
                crashes.append(f"{rule.code} crashed: {type(error).__name__}: {error}")
    return findings, crashes


def _apply_policies(
    request: Request, kept: Sequence[tuple[Unit, UnitReport]], findings: Iterable[Finding]
) -> list[Finding]:
    """The findings that the configuration of their model asks for, as bad as it says; of those of none, that of the run."""
    rules = catalogue.load_rules()
    settings = {unit.id: unit.own_settings for unit, _ in kept}
    held = []
    for finding in findings:
        own = settings.get(finding.model, {})
        if finding.code in own.get("codes", request.codes):
            targets = own.get("targets", request.targets)
            severities = own.get("severities", request.severities)
            held.append(truncate_texts(apply_severity_policy(finding, rules[finding.code], targets, severities)))
    return held


def _list_complete_rules(request: Request, units: Sequence[Unit]) -> dict[str, frozenset[str]]:
    """By the ids of units the rules whose findings this run could not have missed. A run over a part of the folder has not
    looked at every launch file and package that there is, nor at every other model."""
    root = Path(os.path.realpath(request.root))
    given = [Path(os.path.realpath(path)) for path in request.paths if path.is_dir()]
    missed: set[str] = set()
    if not any(folder == root or folder in root.parents for folder in given):
        missed |= {
            c for c, rule in catalogue.load_rules().items() if {"launch", "package", "run"}.intersection(rule.scopes)
        }
    if request.config_resolver is not None and request.config_resolver.overrides.target is not None:
        missed.add(
            "MSH011"
        )  # it says of the programs that will read the model what they cannot load, and nothing of others
    return {unit.id: frozenset(unit.own_settings.get("codes", request.codes)) - missed for unit in units}


def _suppress_cross_model(
    request: Request, kept: Sequence[tuple[Unit, UnitReport]], findings: Sequence[Finding]
) -> tuple[list[Finding], set[Span]]:
    """Findings about several models, those marked that somebody knows, and the comments that say so."""
    units = {unit.id: (unit, report) for unit, report in kept}
    marked: list[Finding] = []
    used: set[Span] = set()
    for model, group in groupby(sorted(findings, key=lambda f: f.model), key=lambda f: f.model):
        unit, report = units[model]
        comments = [judgement.comment for judgement in report.comments]
        entries = unit.own_settings.get("suppress", request.suppress)
        found, needed = mark_suppressed(list(group), comments, entries, unit.baseline_entries)
        marked += found
        used |= needed
    return marked, used


def report_misconfiguration(text: str) -> Finding:
    """The finding of URC901 about a configuration that could not be read; the text begins with the file and the line."""
    file, line, reason = re.match(r"(.*?):(?:(\d+):)? (.*)", text, re.DOTALL).groups()  # type: ignore[union-attr]
    number = int(line or 1)
    at = Location("configuration", Span(file, number, 1, number, 1, 0, 0))
    return catalogue.load_rules()["URC901"].finding("wrong", at=at, reason=reason)


def _read_named_file(text: str) -> tuple[str, str]:
    """The file that such a text is about, and what it holds, if it can be read at all."""
    name = text.partition(":")[0]
    try:
        return name, read_regular(Path(name)).decode("utf-8", "replace")
    except OSError:
        return name, ""


def report_foreign_libraries() -> list[Finding]:
    """The findings of URC907: libraries that are not taken from our own environment."""
    rule = catalogue.load_rules()["URC907"]
    return [
        rule.finding("shadowed", at=Location(f"library[{library}]", None), library=library, path=path)
        for library, path in sorted(libraries.find_foreign_libraries().items())
    ]


def collect_versions(*, full: bool) -> dict[str, str]:
    """Our own version and Python's; those of the libraries, which take a while to look up, only for a report that shows them."""
    found = {"urdfcheck": __version__, "python": ".".join(map(str, sys.version_info[:3]))}
    if not full:
        return found
    from importlib.metadata import PackageNotFoundError, version

    for name in DISTRIBUTIONS:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found
