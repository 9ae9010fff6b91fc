"""The report for a terminal and for a CI log, by model; the worst stands last, where the reader is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum

from rich.text import Text

from urdfcheck.core import Finding, Run, Severity
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line, find_ci_command
from urdfcheck.output.shared.rule_statistics import count_by_rule, format_table
from urdfcheck.output.shared.verdict.effects import ToldEffects
from urdfcheck.output.shared.verdict.engine_answers import describe_answers
from urdfcheck.output.shared.verdict.not_checked import (
    ACCEPTING_KEY,
    ACCEPTING_OPTION,
    GLYPH,
    describe_unused_macros,
    group_unchecked,
    is_accepted,
)
from urdfcheck.output.shared.wording import format_concise, sort_worst_first
from urdfcheck.output.text.closing_lines import (
    describe_fixable,
    format_glyph,
    format_summary,
    iter_found_arguments,
    iter_recap,
    iter_skipped,
)
from urdfcheck.output.text.compact_finding import iter_brief_rules, iter_compact_finding
from urdfcheck.output.text.full_finding import iter_full_finding
from urdfcheck.output.text.lines import STYLES, format_model_heading, format_separator, wrap_text

WIDTH = 100
# Models that are named together.
MAX_MODELS = 3


class DetailLevel(Enum):
    """How much the report says."""

    FULL = "full"
    """Everything."""
    BRIEF = "brief"
    """Errors and warnings in a few lines each, and a line for each rule of the infos that fail nothing."""
    QUIET = "quiet"
    """Errors and warnings in a line each, failures and the summary."""


def render(
    run: Run, *, width: int = WIDTH, color: bool = False, detail: DetailLevel = DetailLevel.FULL, fail_on: str = "error"
) -> str:
    """Render the report as text of this width in columns, with ANSI colours if wanted.

    ``fail_on``: the lowest severity that fails the run, unless its model says otherwise; an info that fails it is reported
    like a warning."""
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
    if any(drop.curves for drop in run.drops) and detail is not DetailLevel.QUIET:
        yield from _iter_drop_tests(run, width)
    if detail is DetailLevel.QUIET:
        for finding in reversed(sort_worst_first(run.active_findings)):
            if _fails_run(run, finding, fail_on):
                yield Text(format_concise(run, finding))
    else:
        yield from _iter_models(run, width=width, is_full=detail is DetailLevel.FULL, fail_on=fail_on)
        notes = [*iter_found_arguments(run, width), *iter_skipped(run, width, is_full=detail is DetailLevel.FULL)]
        recap = [*iter_recap(run, width)]
        yield from notes
        if notes and (recap or run.unchecked_models):
            yield Text()  # before a heading
        yield from recap
        for sentence in describe_answers(run):
            yield from wrap_text(Text(escape_invisible(sentence), "dim"), width)
    yield from _iter_failures(run, width)
    yield from _iter_not_checked(run, width)
    fixable = describe_fixable(run)
    if fixable and detail is not DetailLevel.QUIET:
        yield from wrap_text(Text(fixable, "dim"), width)
    yield from wrap_text(format_summary(run, is_full=detail is DetailLevel.FULL), width)


def _iter_drop_tests(run: Run, width: int) -> Iterator[Text]:
    # Few runs drop a robot, and this is a tenth of what this module would import.
    from urdfcheck.output.shared.drop_test.lines import iter_drop_test_lines

    infos = {info.id: info for info in run.models}
    for drop in run.drops:
        yield format_separator(format_model_heading(infos.get(drop.model), drop.model, width), width)
        yield from (piece for line in iter_drop_test_lines(drop) for piece in wrap_text(line, width, Text("  ")))


def _iter_models(run: Run, *, width: int, is_full: bool, fail_on: str) -> Iterator[Text]:
    """Yield the findings by model; the model with the worst one stands last, and so does the worst of each."""
    infos = {info.id: info for info in run.models}
    by_model: dict[str, list[Finding]] = {}
    for finding in sort_worst_first(run.active_findings):
        by_model.setdefault(finding.model, []).append(finding)
    told: ToldEffects = set()
    sections = []
    for model, findings in by_model.items():
        shown = findings if is_full else [f for f in findings if _fails_run(run, f, fail_on)]
        iter_finding = iter_full_finding if is_full else iter_compact_finding
        # Made in this order, so that the worst of a rule tells what programs do.
        blocks = [list(iter_finding(run, finding, width, told)) for finding in shown]
        sections.append((model, [] if is_full else [f for f in findings if not _fails_run(run, f, fail_on)], blocks))
    for model, notes, blocks in reversed(sections):
        yield format_separator(format_model_heading(infos.get(model), model, width), width)
        yield from iter_brief_rules(notes, width)
        for block in reversed(blocks):
            yield from block


def _fails_run(run: Run, finding: Finding, fail_on: str) -> bool:
    """Whether a finding is an error or a warning, or an info that fails the run."""
    return finding.severity > Severity.INFO or run.fail_on.get(finding.model, fail_on) == str(Severity.INFO)


def _iter_failures(run: Run, width: int) -> Iterator[Text]:
    for failure in run.failures:
        yield from wrap_text(Text.assemble(("not checked: ", "bold red"), escape_invisible(failure)), width)


def _iter_not_checked(run: Run, width: int) -> Iterator[Text]:
    """Yield the models of which nothing is known, with the commands that may check them, and unused macro files."""
    models = run.unchecked_models
    if not models and not run.unused_macro_files:
        return
    yield format_separator(Text("not checked"), width)
    for group in group_unchecked(models):
        ids = [f"{info.id} (accepted)" if is_accepted(info) else info.id for info in group.models]
        names = Text(escape_one_line(join_names(ids, MAX_MODELS)), "bold")
        yield from wrap_text(names, width, format_glyph(group.models))
        yield from wrap_text(Text(escape_invisible(group.reason)), width, Text("  "))
        if group.command:  # on a line of its own, to be copied
            yield Text(f"  {escape_one_line(group.command)}")
    if not all(map(is_accepted, models)):
        yield from wrap_text(
            Text(f"to accept that: {ACCEPTING_OPTION}, or {ACCEPTING_KEY} in urdfcheck.toml", "dim"), width, Text("  ")
        )
    if run.unused_macro_files:
        shown = escape_one_line(join_names(run.unused_macro_files, MAX_MODELS))
        yield from wrap_text(Text(f"{describe_unused_macros(run)}: {shown}"), width, Text(f"{GLYPH} ", "bold yellow"))
    yield Text()


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
    if fixable := describe_fixable(run):
        yield from wrap_text(Text(fixable, "dim"), width)
    yield from wrap_text(format_summary(run), width)
