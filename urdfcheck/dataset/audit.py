"""The audit of many models: the result of each is written as soon as it is finished, and memory does not grow with them.

The folder contains ``audit.jsonl`` and ``index.html``, written atomically and in the order of the plan whichever model
finished first, and ``journal``, from which the next run knows what it need not do again.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, field, replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Severity, SkippedCheck
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.dataset.journal import TEMPORARY, Journal, open_new_file, translate_os_errors
from urdfcheck.dataset.unit_facts import AuditedParts, add_unit_facts, get_unit_line
from urdfcheck.output.html import index_page
from urdfcheck.output.shared.audit import unit_lines
from urdfcheck.rules import has_check, load_rules
from urdfcheck.run.assemble_run import collect_versions, report_foreign_libraries
from urdfcheck.run.jobs import AuditSettings, Request, Unit, UnitReport
from urdfcheck.run.pipeline import audit_session, plan_units
from urdfcheck.run.shared_findings import merge_kinds
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.plan import Plan
from urdfcheck.version import __version__

LINES, INDEX = "audit.jsonl", "index.html"
# Environment variables that decide where packages are found.
_ENVIRONMENT = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "HOME")

Stream = Callable[[Sequence[Unit], AuditSettings], Generator[tuple[int, UnitReport], None, None]]


@dataclass(frozen=True, slots=True)
class AuditOutcome:
    """The outcome of an audit."""

    summary: unit_lines.AuditSummary
    checked: int
    """Number of units that were checked."""
    unchanged: int
    """Number of units that were not, because none of their files has changed."""
    worst: Mapping[str | None, Severity] = field(default_factory=dict)
    """``fail-on`` → worst severity of the units for which it is configured; None: the command decides."""


def audit_dataset(
    request: Request,
    folder: Path,
    stream: Stream,
    *,
    restart: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> AuditOutcome:
    """Check everything that the request's paths lead to, and write the folder.

    Results of an earlier audit in the folder are kept where no file has changed.

    :param stream: checks units; yields the index of each and its report as they finish.
    :param restart: whether to forget earlier results.
    :param progress: is called with the number of units that have been checked, and that are to be checked.
    :raises UrdfcheckError: if the folder holds something else or results under other settings, or cannot be written; if no
        path can be checked; if the user interrupts.
    """
    plan, units = plan_units(request)
    if not units and plan.missing:
        path, reason = plan.missing[0]
        raise UrdfcheckError(f"{path} {reason}")
    if not units:
        return AuditOutcome(summary=unit_lines.AuditSummary(), checked=0, unchanged=0)
    # Of a dataset each model counts, and rests on its own files.
    units = [replace(unit, is_of_given_whole=False) for unit in units]
    keys = [_compute_unit_key(unit) for unit in units]
    with (
        audit_session(request, units, plan) as settings,
        Journal(folder, _describe_settings(request, settings), frozenset(keys), restart=restart) as journal,
    ):
        todo = [index for index, key in enumerate(keys) if key not in journal]
        checked = 0
        try:
            with contextlib.closing(stream([units[i] for i in todo], settings)) as reports:
                for place, report in reports:
                    unit = units[todo[place]]
                    text = add_unit_facts(encode_unit_line(unit, report), report)
                    # A failure is not kept: it is tried again next time.
                    journal.add(keys[todo[place]], text, {} if report.failures else report.reads)
                    checked += 1
                    if progress is not None:
                        progress(checked, len(todo))
        except KeyboardInterrupt:
            if progress is not None:
                progress(len(todo), len(todo))
            finished = len(units) - len(todo) + checked
            raise UrdfcheckError(
                f"interrupted: results of {finished:,} of {len(units):,} models and files are kept in {folder}; "
                "run the same command again to continue"
            ) from None
        parts = AuditedParts(units, map(journal.read_text, keys), plan)
        plan = replace(plan, unused=(*plan.unused, *parts.unused))
        last = _encode_run_line(request, plan, parts.unused_macro_files)
        kept = [(unit, key) for unit, key in zip(units, keys, strict=True) if unit.id in parts.models]
        summary = write_results(folder, lambda: _iter_ordered_lines(journal, [key for _, key in kept], last))
        worst = _find_worst_severities(kept, journal=journal, summary=summary)
        journal.trim()
    return AuditOutcome(summary=summary, checked=len(todo), unchanged=len(units) - len(todo), worst=worst)


def _find_worst_severities(
    kept: Sequence[tuple[Unit, str]], *, journal: Journal, summary: unit_lines.AuditSummary
) -> dict[str | None, Severity]:
    """``kept``: the units that have a line, with their keys."""
    levels = {unit.fail_on for unit, _ in kept}
    if len(levels) <= 1:  # and what belongs to none of them
        worst = summary.worst_severity
        return {} if worst is None else {next(iter(levels), None): worst}
    found: dict[str | None, Severity] = {}
    for unit, key in kept:
        severity = unit_lines.parse_unit_line(get_unit_line(journal.read_text(key))).worst
        if severity is not None:
            found[unit.fail_on] = max(severity, found.get(unit.fail_on, severity))
    return found


def encode_unit_line(unit: Unit, report: UnitReport) -> bytes:
    """Encode the unit's line of ``audit.jsonl``."""
    info = report.info
    if info is not None and "SOURCE_DATE_EPOCH" in os.environ:
        info = replace(info, seconds=0.0)
    path = format_path(Path(unit.path))
    return unit_lines.build_unit_line(
        unit.kind,
        unit.id,
        path,
        info=info,
        findings=merge_kinds(report.findings),
        skipped=report.skipped,
        failures=report.failures,
    )


def write_results(folder: Path, texts: Callable[[], Iterable[bytes]]) -> unit_lines.AuditSummary:
    """Write the lines and the page about them, each atomically; ``texts`` yields the lines whenever it is called."""
    with translate_os_errors(folder):
        _replace_file(folder / LINES, (text + b"\n" for text in texts()))
        summary = unit_lines.AuditSummary.from_rows(map(unit_lines.parse_unit_line, texts()))
        page = index_page.iter_audit_page(
            summary,
            map(unit_lines.parse_unit_line, texts()),
            rules=load_rules(),
            version=__version__,
            unused_macro_files=summary.unused_macro_files,
        )
        _replace_file(folder / INDEX, (part.encode() for part in page))
    return summary


def _replace_file(path: Path, parts: Iterable[bytes]) -> None:
    temporary = path.with_name(f"{TEMPORARY}{path.name}")
    try:
        with open_new_file(temporary) as out:
            out.writelines(parts)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _iter_ordered_lines(journal: Journal, keys: Iterable[str], last: bytes) -> Iterator[bytes]:
    yield from (get_unit_line(journal.read_text(key)) for key in keys)
    yield last


def _encode_run_line(request: Request, found: Plan, unused_macro_files: Sequence[str]) -> bytes:
    """Encode the line of what belongs to no unit: wrong paths, and rules that only a whole run could check."""
    findings = report_foreign_libraries() if "URC907" in request.policy.codes else []
    skipped = [SkippedCheck("ALL", path, reason) for path, reason in found.unused]
    alone = "it compares the models of a run with each other: urdfcheck check does"
    skipped += [
        SkippedCheck(code, "", alone)
        for code, rule in load_rules().items()
        if rule.scopes == ("run",) and code in request.policy.codes and has_check(rule)
    ]
    failures = [f"{path}: {reason}" for path, reason in found.missing]
    return unit_lines.build_unit_line(
        "run", "", "", findings=findings, skipped=skipped, failures=failures, unused_macro_files=unused_macro_files
    )


def _describe_settings(request: Request, settings: AuditSettings) -> dict[str, Any]:
    """Return all that a unit's result depends on besides its files, by the names that users know."""
    variables = {name: os.environ.get(name) for name in sorted({*_ENVIRONMENT, *settings.options.environment})}
    return {
        "versions": collect_versions(full=True),
        "working directory": os.getcwd(),
        "configuration's folder": str(request.root),
        "dataset": list(settings.reach or ()),
        "rules": sorted(settings.policy.codes),
        "severities": dict(settings.policy.severities),
        "options of rules": {code: dict(values) for code, values in settings.policy.options.items()},
        "--tier": settings.policy.tier,
        "--unchecked": str(settings.policy.unchecked),
        "--package": {name: str(path) for name, path in settings.packages.by_name.items()},
        "--package-path": list(map(str, settings.packages.search_path)),
        "--target": list(settings.policy.targets),
        "suppress": [[*sorted(e.codes), e.subject, e.reason] for e in settings.policy.suppress],
        "comments in the source": settings.options.heed_comments,
        "--thorough": settings.options.samples,
        "--timeout, --memory": list(asdict(settings.options.limits).values()),
        "--env": list(settings.options.environment),
        # The values may be secrets.
        "environment": hashlib.sha256(json.dumps(variables).encode()).hexdigest(),
    }


def _compute_unit_key(unit: Unit) -> str:
    # `fail_on` changes nothing of what is found; what is known has keys that JSON has not.
    facts: Mapping[str, Any] = asdict(replace(unit, fail_on=None, baseline_entries={}, baseline_excesses={})) | {
        "known": sorted(unit.baseline_entries.items()),
        "how bad": sorted(unit.baseline_excesses.items()),
    }
    return hashlib.sha256(json.dumps(facts, sort_keys=True, default=_sort_for_json).encode()).hexdigest()[:32]


def _sort_for_json(value: Any) -> Any:
    """Return what JSON can hold of a set of codes or a folder."""
    return str(value) if isinstance(value, Path) else sorted(value)
