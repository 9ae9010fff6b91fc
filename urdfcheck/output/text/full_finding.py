"""A finding with everything that is known of it."""

from __future__ import annotations

from collections.abc import Iterator

from rich.text import Text

from urdfcheck.core import Applicability, Finding, Fix, Run, Severity
from urdfcheck.output.shared.diffs import list_line_changes
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line
from urdfcheck.output.shared.verdict.effects import ToldEffects, list_new_effects
from urdfcheck.output.shared.verdict.finding_details import describe_other_places
from urdfcheck.output.shared.wording import describe_models
from urdfcheck.output.text.change_lines import iter_change_lines
from urdfcheck.output.text.code_frame_lines import iter_code_frame
from urdfcheck.output.text.lines import (
    STYLES,
    format_finding_title,
    format_remainder,
    get_first_line,
    wrap_labelled,
    wrap_text,
)

# The options that apply a fix.
FIX_OPTIONS = {Applicability.SAFE: "--fix", Applicability.UNSAFE: "--fix --unsafe-fixes"}
MAX_RELATED = 4
# Columns before the text of a line with a label.
_INDENT = 8


def iter_full_finding(run: Run, finding: Finding, width: int, told: ToldEffects) -> Iterator[Text]:
    """Yield the lines of a finding: headline, place, message, code, callers, related places, cause, consequences, fix.

    ``told``: the consequences that the report told already; more is added.
    """
    yield from _iter_finding_head(finding, width)
    span = finding.location.span
    yield from wrap_text(Text(escape_invisible(finding.message)), width, Text("  "))
    if models := describe_models(run, finding):
        yield from wrap_labelled("in", escape_one_line(models), width)
    if arguments := run.find_variant_arguments(finding):
        shown_with = " ".join(
            f"{escape_one_line(name)}:={escape_one_line(value)}" for name, value in sorted(arguments.items())
        )
        yield from wrap_labelled("with", shown_with, width)
    if len(finding.subjects) > 1:
        yield from wrap_labelled("for", ", ".join(escape_one_line(s) for s in finding.subjects), width)
    if span is not None:
        yield from iter_code_frame(run, span, style=STYLES[finding.severity], width=width)
    for call in reversed(finding.location.via):
        caller = f"{escape_one_line(call.file)}:{call.line}:{call.col}  {get_first_line(run, call)}"
        yield from wrap_labelled("from", caller, width)
    for other in describe_other_places(finding):
        yield from wrap_labelled("also", escape_invisible(other), width)
    places = {own.location.span for own in finding.occurrences}
    related = [(place.subject, place.span) for place in finding.related if place.span and place.span not in places]
    for subject, place in related[:MAX_RELATED]:
        yield from wrap_labelled(
            "see", f"{escape_one_line(place.file)}:{place.line}  {escape_one_line(subject)}", width
        )
    if len(related) > MAX_RELATED:
        yield from wrap_labelled("see", format_remainder(len(related) - MAX_RELATED, "place"), width)
    if finding.cause_text is not None:
        yield from wrap_labelled("why", escape_invisible(finding.cause_text), width)
    for programs, effect in list_new_effects(run, finding, told, every=True):
        yield from wrap_labelled("then", f"{programs}: {escape_invisible(effect)}", width)
    if finding.fix is not None:
        yield from _iter_fix_lines(run, finding, finding.fix, width)
    yield Text()


def _iter_finding_head(finding: Finding, width: int) -> Iterator[Text]:
    """Yield the title of a finding, and its place with the name of the rule."""
    yield from wrap_text(format_finding_title(finding), width)
    span = finding.location.span
    place = Text("  ")
    if span is not None:
        place.append(f"{escape_one_line(span.file)}:{span.line}:{span.col}", "bold")
        if (
            place.cell_len + 2 + len(finding.name) > width
        ):  # a long path gets its own line, so that terminals still link it
            yield place
            place = Text("")
        place.append("  ")
    yield place.append(finding.name, "dim")


def is_on_request(run: Run, finding: Finding) -> bool:
    """Whether a finding is a note that a report lists, and a fix repairs, only where it is asked for."""
    rule = run.rules.get(finding.code)
    return finding.severity is Severity.INFO and rule is not None and finding.message_id in rule.on_request


def _iter_fix_lines(run: Run, finding: Finding, fix: Fix, width: int) -> Iterator[Text]:
    how = FIX_OPTIONS.get(fix.applicability) if fix.edits and finding.suppressed is None else None
    how = f"-v {how}" if how and is_on_request(run, finding) else how
    yield from wrap_labelled(
        "fix", Text.assemble(escape_invisible(fix.title), (f" [{how}]" if how else "", "dim")), width
    )
    changes = list_line_changes(run.sources, fix.edits)
    yield from iter_change_lines(finding, changes[:MAX_RELATED], indent=_INDENT, width=width)
    if len(changes) > MAX_RELATED:
        more = format_remainder(len(changes) - MAX_RELATED, "changed line")
        yield from wrap_labelled("", Text(more, "dim"), width)
