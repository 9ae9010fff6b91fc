"""The report for a terminal and for a CI log: grouped by model and file, with code frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, cast

from rich.text import Text

from urdfcheck.core import Applicability, Finding, Fix, ModelInfo, Run, Severity, Span
from urdfcheck.output.drops import lines as drop_lines
from urdfcheck.output.frames import frame
from urdfcheck.output.inert import command, one_line, visible

if TYPE_CHECKING:
    from rich.console import Console

STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "bold yellow", Severity.INFO: "bold cyan"}
GLYPHS = {Severity.ERROR: "✖", Severity.WARNING: "▲", Severity.INFO: "i"}
# The options that apply a fix.
HOW = {Applicability.SAFE: "--fix", Applicability.UNSAFE: "--fix --unsafe-fixes"}
WIDTH = 100
NOTHING = Text()
MAX_RELATED = 4
# From here on the errors and warnings are listed once more at the end.
FEW = 8


def render(run: Run, *, width: int = WIDTH, color: bool = False) -> str:
    """The report as text of this width in columns, with ANSI colours if wanted."""
    page = Text("\n").join(map(_inert, _report(run, width)))
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


def _report(run: Run, width: int) -> Iterator[Text]:
    infos = {info.id: info for info in run.models}
    for drop in run.drops:
        yield _rule(_heading(infos.get(drop.model), drop.model), width)
        yield from (piece for line in drop_lines(drop) for piece in _wrapped(line, width, Text("  ")))
    for model, group in groupby(run.active, key=lambda f: f.model):
        yield _rule(_heading(infos.get(model), model), width)
        for finding in group:
            yield from _finding(run, finding, width)
    yield from _skipped(run, width)
    yield from _recap(run, width)
    for failure in run.failures:
        yield from _wrapped(Text.assemble(("urdfcheck failed: ", "bold red"), visible(failure)), width)
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


def _heading(info: ModelInfo | None, model: str) -> Text:
    title = Text(one_line(model) or "this run", style="bold")
    if info is not None and info.status == "checked":
        facts = [f"robot {one_line(info.robot)}", _plural(info.links, "link"), _plural(info.joints, "joint")]
        if info.mass is not None:
            facts.append(f"{info.mass:.4g} kg")
        title.append("  " + " · ".join(facts), style="dim")
    elif info is not None:
        title.append(f"  {info.status}", style="dim")
    return title


def _finding(run: Run, finding: Finding, width: int) -> Iterator[Text]:
    span = finding.location.span
    place = Text("" if span is None else f"{one_line(span.file)}:{span.line}:{span.col} ", style="bold")
    head = _title(finding)
    if place.cell_len + head.cell_len > width:  # a long path keeps its line, so that a click on it still works
        yield place
        place = Text("  ")
    yield place + head
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
    for consumers, effect in _by_effect(finding):
        yield from _labelled("then", f"{', '.join(consumers)}: {visible(effect)}", width)
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


def _by_effect(finding: Finding) -> list[tuple[list[str], str]]:
    """Consumers that do the same thing share a line."""
    effects: dict[str, list[str]] = {}
    for consumer, effect in finding.consequences.items():
        effects.setdefault(effect, []).append(consumer)
    return [(consumers, effect) for effect, consumers in effects.items()]


def _first_line(run: Run, span: Span) -> str:
    lines = frame(run.sources.get(span.file, ""), span, context=0)
    return visible(lines[0].text.strip()) if lines else ""


def _skipped(run: Run, width: int) -> Iterator[Text]:
    reasons: dict[str, set[str]] = {}
    for skip in run.skipped:
        reasons.setdefault(skip.reason, set()).add(skip.code)
    for reason, codes in sorted(reasons.items()):
        yield from _wrapped(Text(f"skipped {_some(sorted(codes))}: {visible(reason)}", "dim"), width)


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
        where = f"in {_plural(len(run.models), 'model')}{_states(run.models)}"
        if not set(run.rules) - {"URC900"}:  # that one tells of crashes, whatever is selected
            return Text(f"nothing was looked for {where}: no rule is selected (urdfcheck config says by what)", "bold")
        text = Text(f"✔ no findings {where}", "bold green")
        return text.append(_known(run), "dim")
    counts = [(s, run.count(s)) for s in (Severity.ERROR, Severity.WARNING, Severity.INFO)]
    text = Text()
    for severity, count in counts:
        text.append(f"{GLYPHS[severity]} {_plural(count, str(severity))}", STYLES[severity] if count else "dim")
        text.append("  ")
    states = _states(run.models)
    took = f", {run.seconds:.1f} s" if run.seconds else ""  # a reproducible report tells no time
    text.append(f"in {_plural(len(run.models), 'model')}{states}{took}{_known(run)}", "dim")
    return text


def _fixable(run: Run) -> str:
    """How many findings can be repaired by which option; empty where none can."""
    fixes = [f.fix for f in run.active if f.fix is not None and f.fix.edits]
    kinds = [fix.applicability for fix in fixes if fix.applicability in HOW]
    safe, unsafe = kinds.count(Applicability.SAFE), kinds.count(Applicability.UNSAFE)
    if safe and unsafe:
        return f"{safe} fixable with --fix, {unsafe} more with --unsafe-fixes"
    return f"{safe or unsafe} fixable with {HOW[kinds[0]]}" if kinds else ""


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


def _plural(count: int, word: str) -> str:
    return f"{count} {word}" + ("" if count == 1 or word == "info" else "s")
