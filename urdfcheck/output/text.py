"""The report for a terminal and for a CI log: grouped by model and file, with code frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import Enum
from itertools import groupby
from typing import TYPE_CHECKING, cast

from rich.text import Text

from urdfcheck.core import Applicability, Finding, Fix, ModelInfo, Run, Severity, Span
from urdfcheck.output.shared.code_frames import frame
from urdfcheck.output.shared.drops import lines as drop_lines
from urdfcheck.output.shared.inert import command, one_line, visible
from urdfcheck.output.shared.summary import counted, table
from urdfcheck.output.shared.wording import GLYPHS, NAMES, ORDER, by_effect, looked_at, plural

if TYPE_CHECKING:
    from rich.console import Console

STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "bold yellow", Severity.INFO: "bold cyan"}
# The options that apply a fix.
HOW = {Applicability.SAFE: "--fix", Applicability.UNSAFE: "--fix --unsafe-fixes"}
WIDTH = 100
NOTHING = Text()
MAX_RELATED = 4
# From here on the errors and warnings are listed once more at the end.
FEW = 8
# So many lines of its message an info has in brief.
BRIEF_LINES = 2


class Detail(Enum):
    """How much is told of infos that fail nothing: all; where, what and no more; nothing, and nothing that is no finding."""

    FULL = "full"
    BRIEF = "brief"
    QUIET = "quiet"


def render(
    run: Run, *, width: int = WIDTH, color: bool = False, detail: Detail = Detail.FULL, fail_on: str = "error"
) -> str:
    """The report as text of this width in columns, with ANSI colours if wanted. ``fail_on``: from which severity on a finding
    fails the run, where its model does not say otherwise; what fails is told in full whatever the ``detail``."""
    return _printed(_report(run, width, detail, fail_on), color)


def statistics(run: Run, *, width: int = WIDTH, color: bool = False) -> str:
    """A table of the rules that fired, by severity: the worst and then the most common first; and a report's closing lines."""
    return _printed(_statistics(run, width), color)


def _printed(lines: Iterable[Text], color: bool) -> str:
    page = Text("\n").join(map(_inert, lines))
    text = _colored(page) if color else page.plain
    # Lines are wrapped behind blanks; a CI log and a diff are better without.
    return "".join(f"{line.rstrip()}\n" for line in text.split("\n"))


def _inert(line: Text) -> Text:
    """A finished line that is one line and no command of a CI system; what it says was spelled out before it was measured."""
    plain = one_line(line.plain)
    if plain != line.plain:  # somebody forgot to spell it: its colours are the least of it
        line = Text(plain)
    at = command(line.plain)
    while at is not None:
        line = Text.assemble(line[:at], f"\\x{ord(line.plain[at]):02x}", line[at + 1 :])
        at = command(line.plain, at)
    return line


def _colored(page: Text) -> str:
    """The text with its styles as ANSI codes."""
    from rich.console import Console
    from rich.segment import Segments

    out = Console(force_terminal=True, no_color=False, color_system="standard", legacy_windows=False)
    with out.capture() as printed:
        out.print(Segments(page.render(out)), soft_wrap=True)  # the Text itself would be searched for long lines
    return printed.get()


def _report(run: Run, width: int, detail: Detail, fail_on: str) -> Iterator[Text]:
    infos = {info.id: info for info in run.models}
    full = [f for f in run.active if detail is Detail.FULL or _matters(run, f, fail_on)]
    chosen = {id(f) for f in full}
    brief = [] if detail is Detail.QUIET else [f for f in run.active if id(f) not in chosen]
    for drop in run.drops:
        yield _rule(_heading(infos.get(drop.model), drop.model, width), width)
        yield from (piece for line in drop_lines(drop) for piece in _wrapped(line, width, Text("  ")))
    # What matters stands first for each model, in the order of the run.
    shown = (f for f in run.active if id(f) in chosen or detail is not Detail.QUIET)
    for model, group in groupby(shown, key=lambda f: f.model):
        yield _rule(_heading(infos.get(model), model, width), width)
        rest = []
        for finding in group:
            if id(finding) in chosen:
                yield from _finding(run, finding, width)
            else:
                rest.append(finding)
        yield from _briefly(rest, width)
    if detail is not Detail.QUIET:
        yield from _skipped(run, width)
        yield from _recap(run, width)
    yield from _failures(run, width)
    if detail is not Detail.QUIET and (closing := "; ".join(filter(None, (_fixable(run), _hidden(brief))))):
        yield from _wrapped(Text(closing, "dim"), width)
    yield from _wrapped(_summary(run), width)


def _matters(run: Run, finding: Finding, fail_on: str) -> bool:
    return finding.severity > Severity.INFO or run.fail_on.get(finding.model, fail_on) == str(Severity.INFO)


def _failures(run: Run, width: int) -> Iterator[Text]:
    for failure in run.failures:
        yield from _wrapped(Text.assemble(("urdfcheck failed: ", "bold red"), visible(failure)), width)


def _statistics(run: Run, width: int) -> Iterator[Text]:
    counts = counted(run.active)
    rows = [
        (c.code, c.name, str(c.severity), f"{c.findings:,}", f"{len(c.models):,}", f"{c.fixable:,}") for c in counts
    ]
    if rows:
        head, *lines = table(("rule", "", "severity", "findings", "models", "fixable"), rows)
        yield Text(head, "dim")
        for line, count in zip(lines, counts, strict=True):
            text = Text(line)
            start = line.index(str(count.severity), line.index(count.name) + len(count.name))
            text.stylize(STYLES[count.severity], start, start + len(str(count.severity)))
            yield text
        yield Text()
    yield from _failures(run, width)
    if fixable := _fixable(run):
        yield from _wrapped(Text(fixable, "dim"), width)
    yield from _wrapped(_summary(run), width)


def _wrapped(text: Text, width: int, lead: Text = NOTHING) -> Iterator[Text]:
    """The text in lines of this width; the first begins with ``lead``, the others with as many blanks."""
    # The console is only asked when text is justified on both sides, and to load one takes longer than most reports.
    for line in text.wrap(cast("Console", None), max(width - len(lead), 1)):
        yield lead + line
        lead = Text(" " * len(lead))


def _labelled(label: str, text: str | Text, width: int) -> Iterator[Text]:
    """``label: text`` with the text's further lines below its first."""
    shown = Text(text) if isinstance(text, str) else text
    return _wrapped(shown, width, Text.assemble("  ", (label.ljust(6), "dim")))


def _rule(title: Text, width: int) -> Text:
    """A line across the page that begins with this title."""
    title.plain = title.plain.replace("\n", " ")
    title.expand_tabs(8)
    title.truncate(max(width - 2, 0), overflow="ellipsis")
    return Text.assemble(title, " ", ("─" * (width - title.cell_len - 1), "dim"))


def _heading(info: ModelInfo | None, model: str, width: int) -> Text:
    """The model, and of what is known of it as much as the line has room for."""
    title = Text(one_line(model) or "this run", style="bold")
    facts: list[str] = []
    if info is not None and info.status == "checked":
        facts = [f"robot {one_line(info.robot)}", plural(info.links, "link"), plural(info.joints, "joint")]
        if info.mass is not None:
            facts.append(f"{info.mass:.4g} kg")
    elif info is not None:
        facts = [info.status]
    lead = "  "
    for fact in facts:
        told = Text(lead + fact, style="dim")
        if title.cell_len + told.cell_len > width - 2:  # half a number is a wrong one
            break
        title.append_text(told)
        lead = " · "
    return title


def _head(finding: Finding, width: int) -> Iterator[Text]:
    """Where it is, and what it is called, for the eye to find."""
    span = finding.location.span
    place = Text("" if span is None else f"{one_line(span.file)}:{span.line}:{span.col} ", style="bold")
    head = _title(finding)
    if place.cell_len + head.cell_len > width:  # a long path keeps its line, so that a click on it still works
        yield place
        place = Text("  ")
    yield place + head


def _briefly(findings: Sequence[Finding], width: int) -> Iterator[Text]:
    """Where each is and what, with no more than a few lines of its message."""
    for finding in findings:
        for line in _head(finding, width):
            yield Text(line.plain, "cyan")
        lines = list(_wrapped(Text(visible(finding.message)), width, Text("  ")))
        if len(lines) > BRIEF_LINES:
            lines = lines[:BRIEF_LINES]
            lines[-1].truncate(width - 2)
            lines[-1].rstrip()
            lines[-1].append(" …", "dim")
        yield from lines
    if findings:
        yield Text()


def _finding(run: Run, finding: Finding, width: int) -> Iterator[Text]:
    yield from _head(finding, width)
    span = finding.location.span
    yield from _wrapped(Text(visible(finding.message)), width, Text("  "))
    if given := run.arguments_of(finding):
        shown_with = " ".join(f"{one_line(name)}:={one_line(value)}" for name, value in sorted(given.items()))
        yield from _labelled("with", shown_with, width)
    if len(finding.subjects) > 1:
        yield from _labelled("for", ", ".join(one_line(s) for s in finding.subjects), width)
    if span is not None:
        yield from _frame(run, span, STYLES[finding.severity], width)
    for call in reversed(finding.location.via):
        called = f"{one_line(call.file)}:{call.line}:{call.col}  {_first_line(run, call)}"
        yield from _labelled("from", called, width)
    shown = [r for r in finding.related if r.span is not None]
    for related in shown[:MAX_RELATED]:
        assert related.span is not None
        seen = f"{one_line(related.span.file)}:{related.span.line}  {one_line(related.subject)}"
        yield from _labelled("see", seen, width)
    if len(shown) > MAX_RELATED:
        yield from _labelled("see", _more(len(shown) - MAX_RELATED, "place"), width)
    if finding.why is not None:
        yield from _labelled("why", visible(finding.why), width)
    for effect, programs in by_effect(finding.consequences).items():
        named = ", ".join(NAMES.get(program, program) for program in programs)
        yield from _labelled("then", f"{named}: {visible(effect)}", width)
    if finding.fix is not None:
        yield from _repair(finding, finding.fix, width)
    yield Text()


def _frame(run: Run, span: Span, style: str, width: int) -> Iterator[Text]:
    lines = frame(run.sources.get(span.file, ""), span)
    if not lines:
        return
    digits = len(str(lines[-1].number))
    room = max(width - digits - 5, 20)
    for line in lines:
        text = visible(line.text.replace("\t", " "))
        start, end = (len(visible(line.text[:k].replace("\t", " "))) for k in line.marked or (0, 0))
        shown, cut = _window(text, start, end, room)
        yield Text.assemble((f"  {line.number:>{digits}} │ ", "dim"), shown)
        if line.marked is not None:
            marks = " " * (start - cut) + "^" * max(min(end - cut, room) - (start - cut), 1)
            yield Text.assemble((f"  {' ' * digits} │ ", "dim"), (marks, style))


def _window(text: str, start: int, end: int, room: int) -> tuple[str, int]:
    """A line cut to ``room`` columns around its marked part, and how many columns were cut from its left."""
    cut = 0 if end <= room - 1 else max(0, min(start - room // 3, len(text) - room))
    shown = text[cut : cut + room]
    if cut:
        shown = "…" + shown[1:]
    if cut + room < len(text):
        shown = shown[:-1] + "…"
    return shown, cut


def _repair(finding: Finding, fix: Fix, width: int) -> Iterator[Text]:
    how = HOW.get(fix.applicability) if fix.edits and finding.suppressed is None else None
    yield from _labelled("fix", Text.assemble(visible(fix.title), (f" [{how}]" if how else "", "dim")), width)
    here = None if finding.location.span is None else finding.location.span.file
    for edit in fix.edits[:MAX_RELATED]:
        place = "" if edit.span.file == here else f"{one_line(edit.span.file)}:"
        for sign, typed, style in (("-", edit.expected, "red"), ("+", edit.replacement, "green")):
            for line in typed.strip("\r\n").splitlines():
                shown = visible(" ".join(line.split()) if sign == "-" else line)
                text = Text.assemble((f"{place}{edit.span.line} {sign} ", "dim"), (shown, style))
                yield from _labelled("", text, width)
    if len(fix.edits) > MAX_RELATED:
        yield from _labelled("", Text(_more(len(fix.edits) - MAX_RELATED, "edit"), "dim"), width)


def _more(count: int, what: str) -> str:
    return f"… and {count} more {what}{'' if count == 1 else 's'}"


def _first_line(run: Run, span: Span) -> str:
    lines = frame(run.sources.get(span.file, ""), span, context=0)
    return visible(lines[0].text.strip()) if lines else ""


def _skipped(run: Run, width: int) -> Iterator[Text]:
    """By reason; with the models that it holds for, where it does not hold for all."""
    reasons: dict[str, tuple[set[str], set[str]]] = {}
    for skip in run.skipped:
        codes, models = reasons.setdefault(skip.reason, (set(), set()))
        codes.add(skip.code)
        models.add(skip.model)
    for reason, (codes, models) in sorted(reasons.items()):
        where = "" if "" in models or len(models) >= len(run.models) else f" ({_some(sorted(models), 3)})"
        yield from _wrapped(Text(f"skipped {_some(sorted(codes))}: {visible(reason + where)}", "dim"), width)


def _some(words: Sequence[str], most: int = 8) -> str:
    return ", ".join(words[:most]) + (f" and {len(words) - most} more" if len(words) > most else "")


def _title(finding: Finding) -> Text:
    head = Text(f"{GLYPHS[finding.severity]} {finding.severity} ", STYLES[finding.severity])
    head.append(f"{finding.code} {finding.name}", "bold")
    return head


def _recap(run: Run, width: int) -> Iterator[Text]:
    """After a long report: its errors and warnings once more, a line each, where the reader's eye is."""
    serious = [f for f in run.active if f.severity > Severity.INFO]
    if not serious or len(run.active) <= FEW:
        return
    yield _rule(Text("errors and warnings"), width)
    for finding in sorted(serious, key=lambda f: -f.severity):
        span = finding.location.span
        place = "" if span is None else f" {one_line(span.file)}:{span.line}:{span.col}"
        yield Text.assemble(_title(finding), (place, "dim"))
    yield Text()


def _summary(run: Run) -> Text:
    if not run.units and not run.failures:
        return Text("nothing to check: no model, launch file or package was found there", "bold")
    if not run.active and not run.failures and all(info.status != "failed" for info in run.models):
        where = f"in {looked_at(run)}{_states(run.models)}"
        if not set(run.rules) - {"URC900"}:  # that one tells of crashes, whatever is selected
            return Text(f"nothing was looked for {where}: no rule is selected (urdfcheck config says by what)", "bold")
        text = Text(f"✔ no findings {where}", "bold green")
        return text.append(_known(run), "dim")
    counts = [(s, run.count(s)) for s in ORDER]
    text = Text()
    for severity, count in counts:
        text.append(f"{GLYPHS[severity]} {plural(count, str(severity))}", STYLES[severity] if count else "dim")
        text.append("  ")
    states = _states(run.models)
    took = f", {run.seconds:.1f} s" if run.seconds else ""  # a reproducible report tells no time
    text.append(f"in {looked_at(run)}{states}{took}{_known(run)}", "dim")
    return text


def _fixable(run: Run) -> str:
    """How many findings can be repaired by which option; empty where none can."""
    fixes = [f.fix for f in run.active if f.fix is not None and f.fix.edits]
    kinds = [fix.applicability for fix in fixes if fix.applicability in HOW]
    safe, unsafe = kinds.count(Applicability.SAFE), kinds.count(Applicability.UNSAFE)
    if safe and unsafe:
        return f"{safe} fixable with --fix, {unsafe} more with --unsafe-fixes"
    return f"{safe or unsafe} fixable with {HOW[kinds[0]]}" if kinds else ""


def _hidden(brief: Sequence[Finding]) -> str:
    """How to see the rest of what is told in brief."""
    return f"{plural(len(brief), 'info')} in brief, in full with --verbose" if brief else ""


def _known(run: Run) -> str:
    """How many findings are not shown, and why."""
    where = {
        "source": "suppressed in the source",
        "configuration": "by the configuration",
        "baseline": "in the baseline",
    }
    counted = [f"{count} {where[kind]}" for kind, count in run.suppressed.items() if count]
    return f"; not shown: {', '.join(counted)}" if counted else ""


def _states(models: Iterable[ModelInfo]) -> str:
    others = [m.status for m in models if m.status != "checked"]
    counted = [f"{others.count(s)} {s}" for s in sorted(set(others))]
    return f" ({', '.join(counted)})" if counted else ""
