"""How much a report holds: names come from untrusted files and may be megabytes long, and findings may be millions."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core import Applicability, Finding, Severity

# Bytes of the findings of one model.
MAX_FINDINGS_SIZE = 32 * 1024**2
# Of one rule in one model. The noisiest of 110 robots has 14.
MAX_FINDINGS = 1_000
# Characters of a name or a message, and of the edits of a repair. Of a hundred real robots none has half of it.
MAX_TEXT_LENGTH, MAX_EDIT_LENGTH = 2_000, 100_000


def truncate_texts(finding: Finding) -> Finding:
    """Cut the middle out of texts longer than :data:`MAX_TEXT_LENGTH`; a fix that is too long is shown without its edits."""
    fix = finding.fix
    if fix is not None and sum(len(e.expected) + len(e.replacement) for e in fix.edits) > MAX_EDIT_LENGTH:
        fix = replace(fix, applicability=Applicability.DISPLAY, edits=())
    return replace(
        finding,
        message=_truncate(finding.message),
        location=replace(finding.location, subject=_truncate(finding.location.subject)),
        subjects=tuple(map(_truncate, finding.subjects)),
        related=tuple(replace(r, subject=_truncate(r.subject)) for r in finding.related),
        cause=None if finding.cause is None else replace(finding.cause, text=_truncate(finding.cause.text)),
        consequences=_truncate(finding.consequences),
        data=_truncate(finding.data),
        fix=None if fix is None else replace(fix, title=_truncate(fix.title)),
    )


def _truncate(value: Any) -> Any:
    """Truncate every text in a value of plain data."""
    if isinstance(value, str) and len(value) > MAX_TEXT_LENGTH:
        return f"{value[: MAX_TEXT_LENGTH // 2]}…{value[-MAX_TEXT_LENGTH // 2 :]}"
    if isinstance(value, dict):
        return {_truncate(key): _truncate(inner) for key, inner in value.items()}
    return type(value)(map(_truncate, value)) if type(value) in {list, tuple} else value


def measure_size(value: object) -> int:
    """Return the bytes that plain data takes on its way to another process."""
    return len(pickle.dumps(value, pickle.HIGHEST_PROTOCOL))


def limit_size(findings: Sequence[Finding], limit: int) -> tuple[list[Finding], int]:
    """Keep as many findings as take at most ``limit`` bytes together, the most severe first, and one in any case.

    Also return how many bytes those that are kept take. Their order stays.
    """
    whole = measure_size(findings)
    if whole <= limit:
        return list(findings), whole
    order = sorted(range(len(findings)), key=lambda place: -findings[place].severity)
    kept: set[int] = set()
    size = 0
    for place in order:
        more = measure_size(findings[place])
        if kept and size + more > limit:
            break
        kept.add(place)
        size += more
    return [finding for place, finding in enumerate(findings) if place in kept], size


def limit_number(findings: Iterable[Finding]) -> tuple[list[Finding], dict[tuple[str, Severity], int]]:
    """Keep the first :data:`MAX_FINDINGS` of each rule and severity: a thousand warnings hide no error.

    Also return how many are left out, by code and severity.
    """
    counts: Counter[tuple[str, Severity]] = Counter()
    listed: list[Finding] = []
    for finding in findings:
        kind = finding.code, finding.severity
        counts[kind] += 1
        if counts[kind] <= MAX_FINDINGS:
            listed.append(finding)
    return listed, {kind: count - MAX_FINDINGS for kind, count in sorted(counts.items()) if count > MAX_FINDINGS}
