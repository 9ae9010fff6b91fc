"""Tables of findings: a row for each headline, with its places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from urdfcheck.core import Finding, Run, Severity
from urdfcheck.output.markdown.bounded_page import BoundedPage, make_fold
from urdfcheck.output.shared.escaping import escape_for_markdown, format_code_span
from urdfcheck.output.shared.wording import format_count, get_base_name, sort_worst_first

SIGNS = {Severity.ERROR: "❌", Severity.WARNING: "⚠️", Severity.INFO: "ℹ️"}
TABLE = ("| | what | where |", "| --- | --- | --- |")
# Places in a row.
MOST_PLACES = 3


def add_urgent_findings(page: BoundedPage, run: Run, *, most: int) -> None:
    """Add the errors and warnings, a row each, those beyond the first ``most`` folded."""
    urgent = [f for f in sort_worst_first(run.active_findings) if f.severity > Severity.INFO]
    rows = [[row] for row in _iter_finding_rows(run, urgent)]
    page.add_group("error or warning", head=TABLE, blocks=rows[:most], foot=[""])
    head, foot = make_fold(f"{len(rows) - most} more errors and warnings")
    page.add_group("error or warning", head=[*head, *TABLE], blocks=rows[most:], foot=foot)


def add_notes(page: BoundedPage, run: Run) -> None:
    """Add the notes, a row each, folded."""
    notes = [f for f in sort_worst_first(run.active_findings) if f.severity == Severity.INFO]
    head, foot = make_fold(f"{SIGNS[Severity.INFO]} {format_count(len(notes), 'note')}")
    blocks = [[row] for row in _iter_finding_rows(run, notes)]
    page.add_group("note", head=[*head, *TABLE], blocks=blocks, foot=foot)


def _iter_finding_rows(run: Run, findings: Sequence[Finding]) -> Iterator[str]:
    """Yield a row for each headline: what is wrong, and the places."""
    groups: dict[tuple[Severity, str, str], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.severity, finding.code, finding.headline), []).append(finding)
    names = Counter(map(get_base_name, run.sources))
    for (severity, code, headline), group in groups.items():
        times = f" ×{len(group)}" if len(group) > 1 else ""
        places = _list_places(group, names)
        shown = ", ".join(map(format_code_span, places[:MOST_PLACES]))
        more = f" and {len(places) - MOST_PLACES} more" if len(places) > MOST_PLACES else ""
        yield f"| {SIGNS[severity]} | {escape_for_markdown(headline)}{times} ({code}) | {shown}{more} |"


def _list_places(findings: Iterable[Finding], names: Mapping[str, int]) -> list[str]:
    """Return the places of findings: ``file:line``, without the folder where one file has this name; ``:line`` for the same
    file."""
    places: dict[str, None] = {}
    last = ""
    for finding in findings:
        here = finding.location.file
        if not here:
            places.setdefault(finding.location.subject)
        for span in (finding.location.span, *(place.span for place in finding.related)):
            if span is not None and span.file == here:
                name = get_base_name(here) if names.get(get_base_name(here)) == 1 else here
                places.setdefault(f"{'' if here == last else name}:{span.line}")
                last = here
    return list(places)
