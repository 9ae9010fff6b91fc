"""One line of JSON for each unit of an audit: the object of ``audit.schema.json``, and what is counted over all of them."""

from __future__ import annotations

import heapq
import json
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from urdfcheck.core import Finding, ModelInfo, Severity, SkippedCheck
from urdfcheck.output.shared.inert import escape_for_json
from urdfcheck.output.shared.json_objects import build_finding_object, build_model_object, build_skip_object

SCHEMA = "urdfcheck-audit/1"
# So many of the worst models, and of those that something went wrong with, are named.
MOST_NAMED = 20


def build_unit_line(
    kind: str,
    name: str,
    path: str,
    info: ModelInfo | None,
    findings: Sequence[Finding],
    skipped: Sequence[SkippedCheck],
    failures: Sequence[str],
) -> bytes:
    """A unit's line, without a newline. ``kind``: model | launch | package, or run for what belongs to no unit."""
    found = {
        "schema": SCHEMA,
        "unit": {"kind": kind, "id": name, "path": path},
        "model": None if info is None else build_model_object(info),
        "findings": [build_finding_object(finding) for finding in findings],
        "skipped": [build_skip_object(skip) for skip in skipped],
        "failures": list(failures),
    }
    return escape_for_json(json.dumps(found, ensure_ascii=False, allow_nan=False)).encode()


@dataclass(frozen=True, slots=True)
class UnitRow:
    """What the summary tells of a unit. ``status``: checked | needs-arguments | failed | stopped; ``codes``: the rules that
    fired with the worst severity and the number of findings of each, the worst first."""

    kind: str
    id: str
    path: str
    robot: str
    status: str
    links: int
    joints: int
    mass: float | None
    counts: tuple[int, int, int]
    codes: tuple[tuple[str, Severity, int], ...]
    failures: tuple[str, ...]


def parse_unit_line(text: bytes) -> UnitRow:
    """A line's row."""
    found = json.loads(text)
    unit, model = found["unit"], found["model"] or {}
    rules: dict[str, tuple[Severity, int]] = {}
    counts: Counter[Severity] = Counter()
    for finding in found["findings"]:
        if finding["suppressed"] is None:
            severity = Severity.parse(finding["severity"])
            worst, number = rules.get(finding["code"], (severity, 0))
            rules[finding["code"]] = max(worst, severity), number + 1
            counts[severity] += 1
    codes = sorted(((code, *found) for code, found in rules.items()), key=lambda rule: (-rule[1], -rule[2], rule[0]))
    return UnitRow(
        unit["kind"],
        unit["id"],
        unit["path"],
        model.get("robot", ""),
        "stopped" if "URC906" in rules else model.get("status", "failed" if found["failures"] else "checked"),
        model.get("links", 0),
        model.get("joints", 0),
        model.get("mass"),
        (counts[Severity.ERROR], counts[Severity.WARNING], counts[Severity.INFO]),
        tuple(codes),
        tuple(found["failures"]),
    )


@dataclass(slots=True)
class RuleCount:
    """How often a rule fired, in how many units, and how bad it was at worst."""

    findings: int = 0
    units: int = 0
    severity: Severity = Severity.INFO


@dataclass(slots=True)
class AuditSummary:
    """All units of an audit in numbers; of names no more than `MOST_NAMED` of each list. ``erroneous`` counts the models with
    errors, ``failed`` the failures of urdfcheck itself."""

    kinds: Counter[str] = field(default_factory=Counter)
    statuses: Counter[str] = field(default_factory=Counter)
    counts: Counter[Severity] = field(default_factory=Counter)
    rules: dict[str, RuleCount] = field(default_factory=dict)
    worst: list[UnitRow] = field(default_factory=list)
    unchecked: list[tuple[str, str]] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    models_with_errors: int = 0
    failure_count: int = 0

    @classmethod
    def from_rows(cls, rows: Iterable[UnitRow]) -> AuditSummary:
        """Count the rows."""
        summary = cls()

        def iter_counted_rows() -> Iterator[UnitRow]:
            for found in rows:
                summary._add_row(found)
                if found.kind != "run":
                    yield found

        # nsmallest holds no more rows than it returns.
        worst = heapq.nsmallest(
            MOST_NAMED, iter_counted_rows(), key=lambda found: (*(-n for n in found.counts), found.id)
        )
        summary.worst = [found for found in worst if any(found.counts[:2])]
        return summary

    @property
    def unit_count(self) -> int:
        """How many models, launch files and packages there are."""
        return sum(self.kinds.values())

    def _add_row(self, row: UnitRow) -> None:
        if row.kind != "run":
            self.kinds[row.kind] += 1
        if row.kind == "model":
            self.statuses[row.status] += 1
            self.models_with_errors += bool(row.counts[0])
            if row.status != "checked" and len(self.unchecked) < MOST_NAMED:
                self.unchecked.append((row.id, row.status))
        for severity, number in zip((Severity.ERROR, Severity.WARNING, Severity.INFO), row.counts, strict=True):
            self.counts[severity] += number
        for code, severity, number in row.codes:
            rule = self.rules.setdefault(code, RuleCount())
            rule.findings += number
            rule.units += 1
            rule.severity = max(rule.severity, severity)
        self.failure_count += len(row.failures)
        self.failures += row.failures[: max(0, MOST_NAMED - len(self.failures))]

    def rank_rules(self) -> list[tuple[str, RuleCount]]:
        """The rules that fired, the worst and then the most common first."""
        return sorted(self.rules.items(), key=lambda r: (-r[1].severity, -r[1].units, -r[1].findings, r[0]))
