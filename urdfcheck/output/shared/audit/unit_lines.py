"""One line of JSON for each unit of an audit, the object of ``audit.schema.json``, and the counts over all lines."""

from __future__ import annotations

import heapq
import json
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field

from urdfcheck.core import Finding, ModelInfo, Severity, SkippedCheck
from urdfcheck.core.records import dataclass
from urdfcheck.output.shared.escaping import escape_for_json
from urdfcheck.output.shared.json_objects import build_finding_object, build_model_object, build_skip_object

SCHEMA = "urdfcheck-audit/1"
# Names kept of each list: the worst models, the models that could not be checked, the failures.
MOST_NAMED = 20


def build_unit_line(
    kind: str,
    name: str,
    path: str,
    *,
    info: ModelInfo | None = None,
    findings: Sequence[Finding] = (),
    skipped: Sequence[SkippedCheck] = (),
    failures: Sequence[str] = (),
    unused_macro_files: Sequence[str] = (),
) -> bytes:
    """Build the line of a unit, without a newline. ``kind``: model | launch | package, or run for what belongs to no unit.

    Only the line of the run has ``unused_macro_files``.
    """
    record = {
        "schema": SCHEMA,
        "unit": {"kind": kind, "id": name, "path": path},
        "model": None if info is None else build_model_object(info),
        "findings": [build_finding_object(finding) for finding in findings],
        "skipped": [build_skip_object(skip) for skip in skipped],
        "failures": list(failures),
        **({"unused_macro_files": list(unused_macro_files)} if kind == "run" else {}),
    }
    return escape_for_json(json.dumps(record, ensure_ascii=False, allow_nan=False)).encode()


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitRow:
    """A unit of an audit, as the summary and the index page show it."""

    kind: str
    """model | launch | package | run | other"""
    id: str
    path: str
    robot: str = ""
    status: str
    """checked | needs-arguments | failed | stopped"""
    links: int = 0
    joints: int = 0
    mass: float | None = None
    """In kg; None if unknown."""
    counts: tuple[int, int, int] = (0, 0, 0)
    """Findings that are errors, warnings and information."""
    codes: tuple[tuple[str, Severity, int], ...] = ()
    """Each rule that fired with its worst severity and its number of findings, the worst first."""
    suppressed: tuple[str, ...] = ()
    """Of each finding that does not count, who accepts it: source | configuration | baseline."""
    failures: tuple[str, ...] = ()
    """What failed in urdfcheck itself."""
    reason: str = ""
    """Why the model was not checked."""
    command: str = ""
    """What may check it."""
    accepted: bool = False
    """Whether it is accepted that the model was not checked."""
    is_set_aside: bool = False
    """Whether errors or warnings of the model are not listed."""
    unused_macro_files: tuple[str, ...] = ()
    """Files with macros that no checked model has read: of the run."""

    @property
    def is_unchecked(self) -> bool:
        """Whether it is a model of which nothing is known."""
        return self.kind == "model" and self.status != "checked"

    @property
    def worst(self) -> Severity | None:
        """The worst severity: of its findings, and of not being checked."""
        unchecked = [Severity.WARNING if self.accepted else Severity.ERROR] if self.is_unchecked else []
        found = (s for s, n in zip((Severity.ERROR, Severity.WARNING, Severity.INFO), self.counts, strict=True) if n)
        return max((*found, *unchecked), default=None)


def parse_unit_line(text: bytes) -> UnitRow:
    """Parse the line of a unit into its row."""
    record = json.loads(text)
    unit, model = record["unit"], record["model"] or {}
    not_checked = model.get("not_checked") or {}
    rules: dict[str, tuple[Severity, int]] = {}
    counts: Counter[Severity] = Counter()
    for finding in record["findings"]:
        if finding["suppressed"] is None:
            severity = Severity.parse(finding["severity"])
            worst, number = rules.get(finding["code"], (severity, 0))
            rules[finding["code"]] = max(worst, severity), number + 1
            counts[severity] += 1
    codes = sorted(((code, *fired) for code, fired in rules.items()), key=lambda rule: (-rule[1], -rule[2], rule[0]))
    default_status = "failed" if record["failures"] else "checked"
    return UnitRow(
        kind=unit["kind"],
        id=unit["id"],
        path=unit["path"],
        robot=model.get("robot", ""),
        status="stopped" if "URC906" in rules else model.get("status", default_status),
        links=model.get("links", 0),
        joints=model.get("joints", 0),
        mass=model.get("mass"),
        counts=(counts[Severity.ERROR], counts[Severity.WARNING], counts[Severity.INFO]),
        codes=tuple(codes),
        suppressed=tuple(finding["suppressed"]["kind"] for finding in record["findings"] if finding["suppressed"]),
        failures=tuple(record["failures"]),
        reason=not_checked.get("reason", ""),
        command=not_checked.get("command") or "",
        accepted=not_checked.get("accepted", False),
        is_set_aside=any(skip["code"] in SkippedCheck.PROBLEMS for skip in record["skipped"]),
        unused_macro_files=tuple(record.get("unused_macro_files", ())),
    )


@dataclass(slots=True)
class RuleCount:
    """Number of findings of a rule, number of units with one, and the worst severity."""

    findings: int = 0
    units: int = 0
    severity: Severity = Severity.INFO


@dataclass(slots=True, kw_only=True)
class AuditSummary:
    """All units of an audit in numbers; each list holds at most `MOST_NAMED` entries."""

    kinds: Counter[str] = field(default_factory=Counter)
    """Units by kind."""
    statuses: Counter[str] = field(default_factory=Counter)
    """Models by status."""
    counts: Counter[Severity] = field(default_factory=Counter)
    """Findings by severity."""
    suppressed: Counter[str] = field(default_factory=Counter)
    """Findings that do not count, by who accepts them."""
    rules: dict[str, RuleCount] = field(default_factory=dict)
    """The rules that fired, by code."""
    worst: list[UnitRow] = field(default_factory=list)
    """The units with the most errors and warnings, the worst first."""
    unchecked: list[UnitRow] = field(default_factory=list)
    """Models of which nothing is known."""
    worst_severity: Severity | None = None
    """The worst severity of all units, and of those that were not checked."""
    failures: list[str] = field(default_factory=list)
    """What failed in urdfcheck itself."""
    models_with_errors: int = 0
    unused_macro_files: tuple[str, ...] = ()
    """Files with macros that no checked model has read."""
    failure_count: int = 0
    """Number of failures of urdfcheck itself, those not listed included."""

    @classmethod
    def from_rows(cls, rows: Iterable[UnitRow]) -> AuditSummary:
        """Count the rows in one pass."""
        summary = cls()

        def iter_counted_rows() -> Iterator[UnitRow]:
            for row in rows:
                summary._add_row(row)
                if row.kind != "run":
                    yield row

        # nsmallest holds no more rows than it returns.
        worst = heapq.nsmallest(MOST_NAMED, iter_counted_rows(), key=lambda row: (*(-n for n in row.counts), row.id))
        summary.worst = [row for row in worst if any(row.counts[:2])]
        return summary

    @property
    def unit_count(self) -> int:
        """Number of models, launch files and packages."""
        return sum(self.kinds.values())

    def _add_row(self, row: UnitRow) -> None:
        if row.kind != "run":
            self.kinds[row.kind] += 1
        if row.kind == "model":
            self.statuses[row.status] += 1
            self.models_with_errors += bool(row.counts[0])
            if row.is_unchecked and len(self.unchecked) < MOST_NAMED:
                self.unchecked.append(row)
        if row.worst is not None:
            self.worst_severity = max(row.worst, self.worst_severity or row.worst)
        for severity, number in zip((Severity.ERROR, Severity.WARNING, Severity.INFO), row.counts, strict=True):
            self.counts[severity] += number
        self.suppressed.update(row.suppressed)
        for code, severity, number in row.codes:
            rule = self.rules.setdefault(code, RuleCount())
            rule.findings += number
            rule.units += 1
            rule.severity = max(rule.severity, severity)
        self.unused_macro_files += row.unused_macro_files
        self.failure_count += len(row.failures)
        self.failures += row.failures[: max(0, MOST_NAMED - len(self.failures))]

    def rank_rules(self) -> list[tuple[str, RuleCount]]:
        """Sort the rules that fired, the worst and then the most common first."""
        return sorted(self.rules.items(), key=lambda r: (-r[1].severity, -r[1].units, -r[1].findings, r[0]))
