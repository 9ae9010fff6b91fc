"""The end of the text report: what was skipped, what is worst, and the verdict in one line."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from rich.text import Text

from urdfcheck.core import Applicability, ModelInfo, Run, Severity, SkippedCheck
from urdfcheck.core.headlines import cut_line
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line
from urdfcheck.output.shared.verdict.not_checked import GLYPH, describe_not_checked, is_accepted
from urdfcheck.output.shared.verdict.verdict import describe_checked_units
from urdfcheck.output.shared.wording import (
    GLYPHS,
    SEVERITY_ORDER,
    describe_found_arguments,
    describe_suppressed,
    format_count,
    get_base_name,
    sort_worst_first,
)
from urdfcheck.output.text.full_finding import FIX_OPTIONS, is_on_request
from urdfcheck.output.text.lines import STYLES, format_finding_title, format_separator, wrap_text

MAX_CODES = 8
# A report with more findings repeats its errors and warnings at the end.
RECAP_THRESHOLD = 8
# Columns that a title keeps before a long place.
_LEAST_TITLE = 40


def iter_found_arguments(run: Run, width: int) -> Iterator[Text]:
    """Yield for each file the arguments that launch files pass and the user did not give; its variants have them all."""
    told = {(info.path, found): None for info in run.models if (found := describe_found_arguments(info))}
    for path, found in told:
        yield from wrap_text(Text(escape_one_line(f"{path}: {found}"), "dim"), width)


def iter_skipped(run: Run, width: int, *, is_full: bool) -> Iterator[Text]:
    """Yield the skipped checks by reason, with their models unless the reason applies to all.

    ``is_full``: also those that no reader misses, see `_is_missed`.
    """
    reported = {finding.code for finding in run.active_findings}
    reasons: dict[str, tuple[set[str], set[str]]] = {}
    # Of a model of which nothing is known no single check is named.
    unchecked = {info.id for info in run.unchecked_models}
    for skip in run.skipped:
        if skip.model in unchecked or not (is_full or _is_missed(run, skip, reported)):
            continue
        codes, models = reasons.setdefault(skip.reason, (set(), set()))
        codes.add(skip.code)
        models.add(skip.model)
    for reason, (codes, models) in sorted(reasons.items()):
        # What was not checked at all is told by its name; it is none of the models.
        checked = len(run.models) - len(unchecked)
        applies_to_all = "" in models or (len(models) >= checked and codes.isdisjoint(SkippedCheck.NO_RULES))
        where = "" if applies_to_all else f" ({join_names(sorted(models), 3)})"
        yield from wrap_text(Text(escape_invisible(_describe_skip(codes, reason, where)), "dim"), width)


def _describe_skip(codes: Collection[str], reason: str, where: str) -> str:
    """Say what was not checked, or not listed, and why. ``where``: the models in brackets after a blank, or nothing."""
    if codes == {"ALL"}:
        return f"not checked{where}: {reason.removeprefix('is not checked: ')}"
    if codes == {SkippedCheck.WARNINGS}:
        return f"warnings not listed{where}: {reason}"
    if codes == {SkippedCheck.DEFAULTS}:
        return f"not listed as errors and warnings{where}: {reason}"
    if codes == {SkippedCheck.FINDINGS}:
        return f"errors and warnings not listed{where}: {reason}"
    return f"skipped {join_names(sorted(codes), MAX_CODES)}: {reason}{where}"


def _is_missed(run: Run, skip: SkippedCheck, reported: Collection[str]) -> bool:
    """Whether a reader who asked for nothing special misses a check: not if it takes more than was to be computed, or a
    simulator, nor if the reason is a finding of the report."""
    if skip.code in run.requested or skip.is_partial:
        return True
    if skip.reason.startswith(SkippedCheck.TIER_REASON):
        return False
    wants_simulator = skip.code in run.rules and "simulator" in run.rules[skip.code].needs
    return not (wants_simulator or any(code in skip.reason for code in reported))


def iter_recap(run: Run, width: int) -> Iterator[Text]:
    """Repeat the errors and warnings of a long report, a line each, at the end where the reader is."""
    serious = [f for f in run.active_findings if f.severity > Severity.INFO]
    if not serious or len(run.active_findings) <= RECAP_THRESHOLD:
        return
    yield format_separator(Text("errors and warnings"), width)
    is_one_file = len({f.location.file for f in serious}) == 1
    for finding in reversed(sort_worst_first(serious)):
        span = finding.location.span
        title = format_finding_title(finding)
        place = "" if span is None else f"  {escape_one_line(span.file)}:{span.line}:{span.col}"
        if title.cell_len + len(place) > width and span is not None:
            # One file needs no name; of several the title is cut for it.
            name = escape_one_line(get_base_name(span.file))
            place = f"  line {span.line}" if is_one_file else f"  {name}:{span.line}"
            cut = cut_line(title.plain, max(width - len(place), _LEAST_TITLE))
            if cut != title.plain:
                title.right_crop(len(title) - len(cut) + 1)
                title.append("…", "bold")
        yield Text.assemble(title, (place, "dim"))
    yield Text()


def format_glyph(models: Sequence[ModelInfo]) -> Text:
    """Format the sign of models that were not checked."""
    return Text(f"{GLYPH} ", "bold yellow" if all(map(is_accepted, models)) else "bold red")


def format_summary(run: Run, *, is_full: bool = False) -> Text:
    """Format the last line: what was not checked, the findings by severity, and how much was checked in which time.

    ``is_full``: whether all that is known was printed; else the line says what prints the notes.
    """
    if not run.units and not run.failures:
        return Text("nothing to check: no model, launch file or package was found there", "bold")
    unchecked = describe_not_checked(run)
    took = [f"{run.seconds:.1f} s"] if run.seconds else []  # a reproducible report has no duration
    end = "".join(f" · {part}" for part in (describe_checked_units(run), *took)) + describe_suppressed(
        run.suppressed_counts
    )
    if not set(run.rules) - {"URC900"} and not (run.active_findings or run.failures or unchecked):
        # It reports crashes, whatever is selected.
        return Text(f"nothing was looked for: no rule is selected (urdfcheck config says by what){end}", "bold")
    counts = {severity: run.count_findings(severity) for severity in SEVERITY_ORDER}
    text = Text()
    if run.failures:
        text.append(f"{GLYPH} not finished: {format_count(len(run.failures), 'failure')} · ", "bold red")
    if unchecked:
        text.append_text(format_glyph(run.unchecked_models)).append(f"{unchecked} · ", "bold")
    notes, how = _describe_notes(run), "" if is_full else "-v"
    if not counts[Severity.ERROR] and not counts[Severity.WARNING]:
        if run.failures or unchecked:
            text.append("nothing else found" if not notes else "no other errors or warnings")
        else:
            text.append("✔ no errors, no warnings", "bold green")
        text.append(f" ({notes}{how and f': {how}'})" if notes else "", "dim")
        return text.append(end, "dim")
    for severity in (Severity.ERROR, Severity.WARNING):
        if counts[severity]:
            text.append(f"{GLYPHS[severity]} {format_count(counts[severity], str(severity))}", STYLES[severity])
            text.append(" · ", "dim")
    text.append(f"{notes}{how and f' ({how})'} · " if notes else "", "dim")
    return text.append(end.removeprefix(" · "), "dim")


def _describe_notes(run: Run) -> str:
    """Return ``12 notes``, those on request included; ``12+ notes`` where more were not looked for; empty without any."""
    count = run.count_findings(Severity.INFO) + run.more_notes
    if run.postponed:
        return f"{count}+ notes" if count else "notes"
    return format_count(count, "note") if count else ""


def describe_fixable(run: Run) -> str:
    """Say how many findings each option can repair; empty if none can be."""
    fixable = [
        f for f in run.active_findings if f.fix is not None and f.fix.edits and f.fix.applicability in FIX_OPTIONS
    ]
    notes = sum(is_on_request(run, finding) for finding in fixable)
    kinds = [f.fix.applicability for f in fixable if f.fix is not None and not is_on_request(run, f)]
    safe, unsafe = kinds.count(Applicability.SAFE), kinds.count(Applicability.UNSAFE)
    if not kinds:
        return f"{notes} fixable with -v --fix" if notes else ""
    more = f", {notes} more with -v" if notes else ""
    if safe and unsafe:
        return f"{safe} fixable with --fix, {unsafe} more with --unsafe-fixes{more}"
    return f"{safe or unsafe} fixable with {FIX_OPTIONS[kinds[0]]}{more}"
