"""The audit of many models: each is finished on its own, kept as it comes, and never held in memory together.

What is in the folder: ``audit.jsonl`` and ``index.html``, whole and in the order of the plan whatever finished first, and
``journal``, by which the next run knows what it need not do again.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from urdfcheck import __version__
from urdfcheck import rules as catalogue
from urdfcheck.core import Severity, SkippedCheck
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.dataset.journal import TEMPORARY, Journal, aside, saying
from urdfcheck.output.html import index_page
from urdfcheck.output.shared.audit import unit_lines
from urdfcheck.run.audit import Report, Settings, Unit
from urdfcheck.run.pipeline import Request, auditing, is_nothing, planned
from urdfcheck.run.summary import foreign_libraries, versions
from urdfcheck.source.discover import Plan
from urdfcheck.source.package.finder import format_path

LINES, INDEX = "audit.jsonl", "index.html"
# Variables that decide about where packages are.
_ENVIRONMENT = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "HOME")

Stream = Callable[[Sequence[Unit], Settings], Generator[tuple[int, Report], None, None]]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an audit came to. ``checked`` and ``unchanged`` count the units that were checked now, and those that were not
    because nothing of them changed since. ``worst``: the worst severity of the units whose findings count from each severity on,
    None for those of which the command decides."""

    summary: unit_lines.AuditSummary
    checked: int
    unchanged: int
    worst: Mapping[str | None, Severity] = field(default_factory=dict)


def audit(
    request: Request,
    folder: Path,
    stream: Stream,
    *,
    restart: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> Outcome:
    """Check everything that the request's paths mean, and write the folder.

    ``stream`` does the work: the places of units and their reports, as they come. What the folder holds from an earlier audit
    is kept where nothing changed; ``restart`` forgets it. ``progress`` is called with how many units have been checked and
    how many are to be.

    :raises UrdfcheckError: when the folder is not an audit's, or of one with other settings, or cannot be written; when
        nothing is there to be checked but paths that are wrong; when the user interrupts.
    """
    found, units = planned(request)
    if not units and found.missing:
        path, reason = found.missing[0]
        raise UrdfcheckError(f"{path} {reason}")
    if not units:
        return Outcome(unit_lines.AuditSummary(), 0, 0)
    keys = [_key(unit) for unit in units]
    with (
        auditing(request, units, found.reach or request.reach) as settings,
        Journal(folder, _about(request, settings), frozenset(keys), restart=restart) as journal,
    ):
        todo = [index for index, key in enumerate(keys) if key not in journal]
        checked = 0
        try:
            with contextlib.closing(stream([units[i] for i in todo], settings)) as reports:
                for place, report in reports:
                    unit = units[todo[place]]
                    text = b"" if is_nothing(unit, report, found) else line_of(unit, report)
                    # What failed is tried again next time.
                    journal.add(keys[todo[place]], text, {} if report.failures else report.reads)
                    checked += 1
                    if progress is not None:
                        progress(checked, len(todo))
        except KeyboardInterrupt:
            if progress is not None:
                progress(len(todo), len(todo))
            finished = len(units) - len(todo) + checked
            raise UrdfcheckError(
                f"interrupted: {finished:,} of {len(units):,} models and files are finished and kept in {folder}; "
                "the same command goes on from there"
            ) from None
        last = _of_the_run(request, found)
        summary = write(folder, lambda: _ordered(journal, keys, last))
        worst = _worst(units, keys, journal, summary)
        journal.trim()
    return Outcome(summary, len(todo), len(units) - len(todo), worst)


def _worst(
    units: Sequence[Unit], keys: Sequence[str], journal: Journal, summary: unit_lines.AuditSummary
) -> dict[str | None, Severity]:
    if len({unit.fail_on for unit in units}) == 1:  # and what belongs to none of them
        worst = max((severity for severity, number in summary.counts.items() if number), default=None)
        return {} if worst is None else {units[0].fail_on: worst}
    found: dict[str | None, Severity] = {}
    for unit, key in zip(units, keys, strict=True):
        counts = unit_lines.parse_unit_line(text).counts if (text := journal.text(key)) else ()
        for severity, number in zip((Severity.ERROR, Severity.WARNING, Severity.INFO), counts, strict=False):
            if number:
                found[unit.fail_on] = max(severity, found.get(unit.fail_on, severity))
    return found


def line_of(unit: Unit, report: Report) -> bytes:
    """The unit's line in ``audit.jsonl``."""
    info = report.info
    if info is not None and "SOURCE_DATE_EPOCH" in os.environ:
        info = replace(info, seconds=0.0)
    path = format_path(Path(unit.path))
    return unit_lines.build_unit_line(
        unit.kind,
        unit.id,
        path,
        info=info,
        findings=report.findings,
        skipped=report.skipped,
        failures=report.failures,
    )


def write(folder: Path, texts: Callable[[], Iterable[bytes]]) -> unit_lines.AuditSummary:
    """Write the lines and the page about them, each whole or not at all; ``texts`` gives the lines as often as it is called."""
    with saying(folder):
        _replace(folder / LINES, (text + b"\n" for text in texts()))
        summary = unit_lines.AuditSummary.from_rows(map(unit_lines.parse_unit_line, texts()))
        rows = map(unit_lines.parse_unit_line, texts())
        page = index_page.iter_audit_page(summary, rows, rules=catalogue.load_rules(), version=__version__)
        _replace(folder / INDEX, (part.encode() for part in page))
    return summary


def _replace(path: Path, parts: Iterable[bytes]) -> None:
    temporary = path.with_name(f"{TEMPORARY}{path.name}")
    try:
        with aside(temporary) as out:
            out.writelines(parts)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _ordered(journal: Journal, keys: Sequence[str], last: bytes) -> Iterator[bytes]:
    for key in keys:
        if text := journal.text(key):
            yield text
    yield last


def _of_the_run(request: Request, found: Plan) -> bytes:
    """The line of what belongs to no unit: paths that are wrong, and what only a run as a whole could show."""
    findings = foreign_libraries() if "URC907" in request.codes else []
    skipped = [SkippedCheck("ALL", path, reason) for path, reason in found.unused]
    alone = "it compares the models of a run with each other: urdfcheck check does"
    skipped += [
        SkippedCheck(code, "", alone)
        for code, rule in catalogue.load_rules().items()
        if rule.scopes == ("run",) and code in request.codes and catalogue.has_check(rule)
    ]
    failures = [f"{path}: {reason}" for path, reason in found.missing]
    return unit_lines.build_unit_line("run", "", "", findings=findings, skipped=skipped, failures=failures)


def _about(request: Request, settings: Settings) -> dict[str, Any]:
    """All that the outcome for a unit depends on beside the unit and its files, by the name that a user has for it."""
    variables = {name: os.environ.get(name) for name in sorted({*_ENVIRONMENT, *settings.environment})}
    return {
        "versions": versions(full=True),
        "working directory": os.getcwd(),
        "configuration's folder": str(request.root),
        "dataset": list(settings.reach or ()),
        "rules": sorted(settings.codes),
        "severities": dict(settings.severities),
        "options of rules": {code: dict(values) for code, values in settings.options.items()},
        "--tier": settings.tier,
        "--package": dict(settings.packages),
        "--package-path": list(settings.package_paths),
        "--target": list(settings.targets),
        "suppress": [[*sorted(e.codes), e.subject, e.reason] for e in settings.suppress],
        "comments in the source": settings.comments,
        "--thorough": settings.samples,
        "--timeout, --memory": list(asdict(settings.limits).values()),
        "--env": list(settings.environment),
        # Values may be secrets.
        "environment": hashlib.sha256(json.dumps(variables).encode()).hexdigest(),
    }


def _key(unit: Unit) -> str:
    # `fail_on` changes nothing of what is found; what is known has keys that JSON has not.
    facts: Mapping[str, Any] = asdict(replace(unit, fail_on=None, known={})) | {"known": sorted(unit.known.items())}
    return hashlib.sha256(json.dumps(facts, sort_keys=True, default=_plain).encode()).hexdigest()[:32]


def _plain(value: Any) -> Any:
    """What JSON has no word for: the codes of a unit's own."""
    return sorted(value)
