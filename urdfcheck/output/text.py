"""The report for a terminal and for a CI log: grouped by model and file, with code frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import Enum
from itertools import groupby
from typing import TYPE_CHECKING, cast

from rich.text import Text

from urdfcheck.core import Applicability, Finding, Fix, ModelInfo, Run, Severity, Span

if TYPE_CHECKING:
    from rich.console import Console

from urdfcheck.output.shared.code_frames import extract_code_frame, find_attribute_around
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line, find_ci_command
from urdfcheck.output.shared.rule_statistics import count_by_rule, format_table
from urdfcheck.output.shared.verdict.not_checked import (
    ACCEPTING_KEY,
    ACCEPTING_OPTION,
    GLYPH,
    describe_not_checked,
    describe_status,
    describe_unused_macros,
    group_unchecked,
    is_accepted,
)
from urdfcheck.output.shared.verdict.verdict import describe_checked_units
from urdfcheck.output.shared.wording import (
    GLYPHS,
    PROGRAM_NAMES,
    SEVERITY_ORDER,
    describe_found_arguments,
    describe_models,
    format_count,
    get_base_name,
    group_by_effect,
    join_first,
)

STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "bold yellow", Severity.INFO: "bold cyan"}
# The options that apply a fix.
FIX_OPTIONS = {Applicability.SAFE: "--fix", Applicability.UNSAFE: "--fix --unsafe-fixes"}
WIDTH = 100
EMPTY_TEXT = Text()
MAX_RELATED = 4
# Models that are named together.
MAX_MODELS = 3
MAX_CODES = 8
# A report with more findings repeats its errors and warnings at the end.
RECAP_THRESHOLD = 8
# Lines of the message of an info in brief.
BRIEF_LINES = 1


class DetailLevel(Enum):
    """How much the report says about infos that fail nothing."""

    FULL = "full"
    """Everything."""
    BRIEF = "brief"
    """Their place and the beginning of their message."""
    QUIET = "quiet"
    """Nothing, and of the rest only findings, failures and the summary."""


def render(
    run: Run, *, width: int = WIDTH, color: bool = False, detail: DetailLevel = DetailLevel.FULL, fail_on: str = "error"
) -> str:
    """Render the report as text of this width in columns, with ANSI colours if wanted.

    ``fail_on``: the lowest severity that fails the run, unless its model says otherwise; a finding that fails it is reported
    in full whatever the ``detail``."""
    return _join_page(_iter_report(run, width=width, detail=detail, fail_on=fail_on), color)


def render_statistics(run: Run, *, width: int = WIDTH, color: bool = False) -> str:
    """Render a table of the rules that fired, the worst and then the most common first, and the closing lines of a report."""
    return _join_page(_iter_statistics(run, width), color)


def _join_page(lines: Iterable[Text], color: bool) -> str:
    page = Text("\n").join(map(_escape_line, lines))
    text = _render_ansi(page) if color else page.plain
    # Lines are wrapped after blanks, which a CI log and a diff should not have.
    return "".join(f"{line.rstrip()}\n" for line in text.split("\n"))


def _escape_line(line: Text) -> Text:
    """Make a finished line one line that is not a command of a CI system; its text was escaped before it was measured."""
    plain = escape_one_line(line.plain)
    if plain != line.plain:  # the text was not escaped earlier: drop the colours, whose ranges no longer fit
        line = Text(plain)
    index = find_ci_command(line.plain)
    while index is not None:
        line = Text.assemble(line[:index], f"\\x{ord(line.plain[index]):02x}", line[index + 1 :])
        index = find_ci_command(line.plain, index)
    return line


def _render_ansi(page: Text) -> str:
    """Render the styles of the text as ANSI codes."""
    from rich.console import Console
    from rich.segment import Segments

    out = Console(force_terminal=True, no_color=False, color_system="standard", legacy_windows=False)
    with out.capture() as printed:
        out.print(Segments(page.render(out)), soft_wrap=True)  # a Text would be searched for long lines
    return printed.get()


def _iter_report(run: Run, *, width: int, detail: DetailLevel, fail_on: str) -> Iterator[Text]:
    infos = {info.id: info for info in run.models}
    full = {id(f) for f in run.active_findings if detail is DetailLevel.FULL or _needs_full_detail(run, f, fail_on)}
    brief = [] if detail is DetailLevel.QUIET else [f for f in run.active_findings if id(f) not in full]
    if run.drops:
        # Few runs drop a robot, and this is a tenth of what this module would import.
        from urdfcheck.output.shared.drop_test_lines import iter_drop_test_lines
    for drop in run.drops:
        yield _format_separator(_format_model_heading(infos.get(drop.model), drop.model, width), width)
        yield from (piece for line in iter_drop_test_lines(drop) for piece in _wrap_text(line, width, Text("  ")))
    # For each model the findings in full come first, in the order of the run.
    shown = (f for f in run.active_findings if id(f) in full or detail is not DetailLevel.QUIET)
    for model, group in groupby(shown, key=lambda f: f.model):
        yield _format_separator(_format_model_heading(infos.get(model), model, width), width)
        rest = []
        for finding in group:
            if id(finding) in full:
                yield from _iter_finding(run, finding, width)
            else:
                rest.append(finding)
        yield from _iter_brief_findings(rest, width)
    if detail is not DetailLevel.QUIET:
        yield from _iter_found_arguments(run, width)
        yield from _iter_skipped(run, width)
        yield from _iter_recap(run, width)
    yield from _iter_failures(run, width)
    yield from _iter_not_checked(run, width)
    closing = "; ".join(filter(None, (_describe_fixable(run), _describe_hidden(brief))))
    if closing and detail is not DetailLevel.QUIET:
        yield from _wrap_text(Text(closing, "dim"), width)
    yield from _wrap_text(_format_summary(run), width)


def _needs_full_detail(run: Run, finding: Finding, fail_on: str) -> bool:
    return finding.severity > Severity.INFO or run.fail_on.get(finding.model, fail_on) == str(Severity.INFO)


def _iter_failures(run: Run, width: int) -> Iterator[Text]:
    for failure in run.failures:
        yield from _wrap_text(Text.assemble(("not checked: ", "bold red"), escape_invisible(failure)), width)


def _iter_not_checked(run: Run, width: int) -> Iterator[Text]:
    """Yield the models of which nothing is known, with the commands that may check them, and unused macro files."""
    models = run.unchecked_models
    if not models and not run.unused_macro_files:
        return
    yield _format_separator(Text("not checked"), width)
    for group in group_unchecked(models):
        ids = [f"{info.id} (accepted)" if is_accepted(info) else info.id for info in group.models]
        names = Text(escape_one_line(join_first(ids, MAX_MODELS)), "bold")
        yield from _wrap_text(names, width, _format_glyph(group.models))
        yield from _wrap_text(Text(escape_invisible(group.reason)), width, Text("  "))
        if group.command:  # on a line of its own, to be copied
            yield Text(f"  {escape_one_line(group.command)}")
    if not all(map(is_accepted, models)):
        yield from _wrap_text(
            Text(f"to accept that: {ACCEPTING_OPTION}, or {ACCEPTING_KEY} in urdfcheck.toml", "dim"), width, Text("  ")
        )
    if run.unused_macro_files:
        shown = escape_one_line(join_first(run.unused_macro_files, MAX_MODELS))
        yield from _wrap_text(Text(f"{describe_unused_macros(run)}: {shown}"), width, Text(f"{GLYPH} ", "bold yellow"))
    yield Text()


def _format_glyph(models: Sequence[ModelInfo]) -> Text:
    return Text(f"{GLYPH} ", "bold yellow" if all(map(is_accepted, models)) else "bold red")


def _iter_statistics(run: Run, width: int) -> Iterator[Text]:
    counts = count_by_rule(run.active_findings)
    rows = [
        (c.code, c.name, str(c.severity), f"{c.findings:,}", f"{len(c.models):,}", f"{c.fixable:,}") for c in counts
    ]
    if rows:
        head, *lines = format_table(("rule", "", "severity", "findings", "models", "fixable"), rows)
        yield Text(head, "dim")
        for line, count in zip(lines, counts, strict=True):
            text = Text(line)
            start = line.index(str(count.severity), line.index(count.name) + len(count.name))
            text.stylize(STYLES[count.severity], start, start + len(str(count.severity)))
            yield text
        yield Text()
    yield from _iter_failures(run, width)
    yield from _iter_not_checked(run, width)
    if fixable := _describe_fixable(run):
        yield from _wrap_text(Text(fixable, "dim"), width)
    yield from _wrap_text(_format_summary(run), width)


def _wrap_text(text: Text, width: int, lead: Text = EMPTY_TEXT) -> Iterator[Text]:
    """Wrap the text into lines of this width; the first begins with ``lead``, the others with as many blanks."""
    # Only justified text needs a console, and loading one is slower than rendering most reports.
    for line in text.wrap(cast("Console", None), max(width - len(lead), 1)):
        yield lead + line
        lead = Text(" " * len(lead))


def _wrap_labelled(label: str, text: str | Text, width: int) -> Iterator[Text]:
    """Wrap ``label: text``, with the further lines of the text below its first."""
    shown = Text(text) if isinstance(text, str) else text
    return _wrap_text(shown, width, Text.assemble("  ", (label.ljust(6), "dim")))


def _format_separator(title: Text, width: int) -> Text:
    """Format a line across the page that begins with this title."""
    title.plain = title.plain.replace("\n", " ")
    title.expand_tabs(8)
    title.truncate(max(width - 2, 0), overflow="ellipsis")
    return Text.assemble(title, " ", ("─" * (width - title.cell_len - 1), "dim"))


def _format_model_heading(info: ModelInfo | None, model: str, width: int) -> Text:
    """Format the name of the model, and as many facts about it as fit into the line."""
    title = Text(escape_one_line(model) or "this run", style="bold")
    facts: list[str] = []
    if info is not None and info.status == "checked":
        facts = [
            f"robot {escape_one_line(info.robot)}",
            format_count(info.links, "link"),
            format_count(info.joints, "joint"),
        ]
        if info.mass is not None:
            facts.append(f"{info.mass:.4g} kg")
    elif info is not None:
        facts = [describe_status(info)]
    lead = "  "
    for fact in facts:
        addition = Text(lead + fact, style="dim")
        if title.cell_len + addition.cell_len > width - 2:  # a truncated number would be wrong
            break
        title.append_text(addition)
        lead = " · "
    return title


def _iter_finding_head(finding: Finding, width: int) -> Iterator[Text]:
    """Yield the title of a finding, and its place with the name of the rule."""
    yield from _wrap_text(_format_finding_title(finding), width)
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


def _iter_brief_findings(findings: Sequence[Finding], width: int) -> Iterator[Text]:
    """Yield the title, the place and a line of the message of each finding."""
    for finding in findings:
        for line in _iter_finding_head(finding, width):
            yield Text(line.plain, "cyan")
        lines = list(_wrap_text(Text(escape_invisible(finding.message)), width, Text("  ")))
        if len(lines) > BRIEF_LINES:
            lines = lines[:BRIEF_LINES]
            lines[-1].truncate(width - 2)
            lines[-1].rstrip()
            lines[-1].append(" …", "dim")
        yield from lines
    if findings:
        yield Text()


def _iter_finding(run: Run, finding: Finding, width: int) -> Iterator[Text]:
    yield from _iter_finding_head(finding, width)
    span = finding.location.span
    yield from _wrap_text(Text(escape_invisible(finding.message)), width, Text("  "))
    if models := describe_models(run, finding):
        yield from _wrap_labelled("in", escape_one_line(models), width)
    if arguments := run.find_variant_arguments(finding):
        shown_with = " ".join(
            f"{escape_one_line(name)}:={escape_one_line(value)}" for name, value in sorted(arguments.items())
        )
        yield from _wrap_labelled("with", shown_with, width)
    if len(finding.subjects) > 1:
        yield from _wrap_labelled("for", ", ".join(escape_one_line(s) for s in finding.subjects), width)
    if span is not None:
        yield from _iter_code_frame(run, span, style=STYLES[finding.severity], width=width)
    for call in reversed(finding.location.via):
        caller = f"{escape_one_line(call.file)}:{call.line}:{call.col}  {_get_first_line(run, call)}"
        yield from _wrap_labelled("from", caller, width)
    related = [(place.subject, place.span) for place in finding.related if place.span is not None]
    for subject, place in related[:MAX_RELATED]:
        yield from _wrap_labelled(
            "see", f"{escape_one_line(place.file)}:{place.line}  {escape_one_line(subject)}", width
        )
    if len(related) > MAX_RELATED:
        yield from _wrap_labelled("see", _format_remainder(len(related) - MAX_RELATED, "place"), width)
    if finding.cause_text is not None:
        yield from _wrap_labelled("why", escape_invisible(finding.cause_text), width)
    for effect, programs in group_by_effect(finding.consequences).items():
        names = ", ".join(PROGRAM_NAMES.get(program, program) for program in programs)
        yield from _wrap_labelled("then", f"{names}: {escape_invisible(effect)}", width)
    if finding.fix is not None:
        yield from _iter_fix_lines(run, finding, finding.fix, width)
    yield Text()


def _iter_code_frame(run: Run, span: Span, *, style: str, width: int) -> Iterator[Text]:
    lines = extract_code_frame(run.sources.get(span.file, ""), span)
    if not lines:
        return
    digits = len(str(lines[-1].number))
    room = max(width - digits - 5, 20)
    for line in lines:
        text = escape_invisible(line.text.replace("\t", " "))
        start, end = (len(escape_invisible(line.text[:k].replace("\t", " "))) for k in line.marked or (0, 0))
        shown, cut = _crop_to_window(text, start, end, room=room)
        yield Text.assemble((f"  {line.number:>{digits}} │ ", "dim"), shown)
        if line.marked is not None:
            marks = " " * (start - cut) + "^" * max(min(end - cut, room) - (start - cut), 1)
            yield Text.assemble((f"  {' ' * digits} │ ", "dim"), (marks, style))


def _crop_to_window(text: str, start: int, end: int, *, room: int) -> tuple[str, int]:
    """Cut a line to ``room`` columns around its marked part; return it and the number of columns cut from its left."""
    cut = 0 if end <= room - 1 else max(0, min(start - room // 3, len(text) - room))
    shown = text[cut : cut + room]
    if cut:
        shown = "…" + shown[1:]
    if cut + room < len(text):
        shown = shown[:-1] + "…"
    return shown, cut


def _iter_fix_lines(run: Run, finding: Finding, fix: Fix, width: int) -> Iterator[Text]:
    how = FIX_OPTIONS.get(fix.applicability) if fix.edits and finding.suppressed is None else None
    yield from _wrap_labelled(
        "fix", Text.assemble(escape_invisible(fix.title), (f" [{how}]" if how else "", "dim")), width
    )
    here = None if finding.location.span is None else finding.location.span.file
    for edit in fix.edits[:MAX_RELATED]:
        place = "" if edit.span.file == here else f"{escape_one_line(edit.span.file)}:"
        before, after = find_attribute_around(run.sources.get(edit.span.file, ""), edit.span)
        for sign, typed, style in (("-", edit.expected, "red"), ("+", edit.replacement, "green")):
            for line in typed.strip("\r\n").splitlines():
                shown = escape_invisible(" ".join(line.split()) if sign == "-" else line)
                text = Text.assemble(
                    (f"{place}{edit.span.line} {sign} {before}", "dim"), (shown, style), (after, "dim")
                )
                yield from _wrap_labelled("", text, width)
    if len(fix.edits) > MAX_RELATED:
        yield from _wrap_labelled("", Text(_format_remainder(len(fix.edits) - MAX_RELATED, "edit"), "dim"), width)


def _format_remainder(count: int, noun: str) -> str:
    return f"… and {count} more {noun}{'' if count == 1 else 's'}"


def _get_first_line(run: Run, span: Span) -> str:
    lines = extract_code_frame(run.sources.get(span.file, ""), span, context=0)
    return escape_invisible(lines[0].text.strip()) if lines else ""


def _iter_found_arguments(run: Run, width: int) -> Iterator[Text]:
    """Yield for each file the arguments that launch files pass and nobody gave; its variants have them all."""
    told = {(info.path, found): None for info in run.models if (found := describe_found_arguments(info))}
    for path, found in told:
        yield from _wrap_text(Text(escape_one_line(f"{path}: {found}"), "dim"), width)


def _iter_skipped(run: Run, width: int) -> Iterator[Text]:
    """Yield the skipped checks by reason, with their models unless the reason applies to all."""
    reasons: dict[str, tuple[set[str], set[str]]] = {}
    # Of a model of which nothing is known no single check is named.
    unchecked = {info.id for info in run.unchecked_models}
    for skip in run.skipped:
        if skip.model in unchecked:
            continue
        codes, models = reasons.setdefault(skip.reason, (set(), set()))
        codes.add(skip.code)
        models.add(skip.model)
    for reason, (codes, models) in sorted(reasons.items()):
        # What was not checked at all is told by its name; it is none of the models.
        checked = len(run.models) - len(unchecked)
        applies_to_all = "" in models or (len(models) >= checked and "ALL" not in codes)
        where = "" if applies_to_all else f" ({join_first(sorted(models), 3)})"
        line = f"skipped {join_first(sorted(codes), MAX_CODES)}: {escape_invisible(reason + where)}"
        yield from _wrap_text(Text(line, "dim"), width)


def _format_finding_title(finding: Finding) -> Text:
    head = Text(f"{GLYPHS[finding.severity]} {finding.severity} ", STYLES[finding.severity])
    return head.append(f"{finding.code} {escape_invisible(finding.headline)}", "bold")


def _iter_recap(run: Run, width: int) -> Iterator[Text]:
    """Repeat the errors and warnings of a long report, a line each, at the end where the reader is."""
    serious = [f for f in run.active_findings if f.severity > Severity.INFO]
    if not serious or len(run.active_findings) <= RECAP_THRESHOLD:
        return
    yield _format_separator(Text("errors and warnings"), width)
    for finding in sorted(serious, key=lambda f: -f.severity):
        span = finding.location.span
        title = _format_finding_title(finding)
        place = "" if span is None else f"  {escape_one_line(span.file)}:{span.line}:{span.col}"
        if title.cell_len + len(place) > width and span is not None:
            place = f"  {escape_one_line(get_base_name(span.file))}:{span.line}"
        yield Text.assemble(title, (place, "dim"))
    yield Text()


def _format_summary(run: Run) -> Text:
    if not run.units and not run.failures:
        return Text("nothing to check: no model, launch file or package was found there", "bold")
    unchecked = describe_not_checked(run)
    if not run.active_findings and not run.failures and not unchecked:
        where = f"in {describe_checked_units(run)}"
        if not set(run.rules) - {"URC900"}:  # it reports crashes, whatever is selected
            return Text(f"nothing was looked for {where}: no rule is selected (urdfcheck config says by what)", "bold")
        text = Text(f"✔ no findings {where}", "bold green")
        return text.append(_describe_suppressed(run), "dim")
    counts = [(s, run.count_findings(s)) for s in SEVERITY_ORDER]
    text = Text()
    if run.failures:
        text.append(f"{GLYPH} not finished: {format_count(len(run.failures), 'failure')}  ", "bold red")
    if unchecked:
        text.append_text(_format_glyph(run.unchecked_models)).append(f"{unchecked}  ", "bold")
    for severity, count in counts:
        text.append(f"{GLYPHS[severity]} {format_count(count, str(severity))}", STYLES[severity] if count else "dim")
        text.append("  ")
    took = f", {run.seconds:.1f} s" if run.seconds else ""  # a reproducible report has no duration
    text.append(f"in {describe_checked_units(run)}{took}{_describe_suppressed(run)}", "dim")
    return text


def _describe_fixable(run: Run) -> str:
    """Say how many findings each option can repair; empty if none can be."""
    fixes = [f.fix for f in run.active_findings if f.fix is not None and f.fix.edits]
    kinds = [fix.applicability for fix in fixes if fix.applicability in FIX_OPTIONS]
    safe, unsafe = kinds.count(Applicability.SAFE), kinds.count(Applicability.UNSAFE)
    if safe and unsafe:
        return f"{safe} fixable with --fix, {unsafe} more with --unsafe-fixes"
    return f"{safe or unsafe} fixable with {FIX_OPTIONS[kinds[0]]}" if kinds else ""


def _describe_hidden(brief: Sequence[Finding]) -> str:
    """Say how to see the infos in brief in full."""
    return f"{format_count(len(brief), 'info')} in brief, in full with --verbose" if brief else ""


def _describe_suppressed(run: Run) -> str:
    """Say how many findings are not shown, and why."""
    where = {
        "source": "suppressed in the source",
        "configuration": "by the configuration",
        "baseline": "in the baseline",
    }
    counted = [f"{count} {where[kind]}" for kind, count in run.suppressed_counts.items() if count]
    return f"; not shown: {', '.join(counted)}" if counted else ""
