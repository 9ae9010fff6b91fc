"""The report for a terminal and for a CI log: grouped by model and file, with code frames."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from itertools import groupby

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from urdfcheck.core import Finding, Fix, ModelInfo, Run, Severity, Span
from urdfcheck.output.frames import frame, visible

STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "bold yellow", Severity.INFO: "bold cyan"}
GLYPHS = {Severity.ERROR: "✖", Severity.WARNING: "▲", Severity.INFO: "i"}
WIDTH = 100
MAX_RELATED = 4
# From here on the errors and warnings are listed once more at the end.
FEW = 8


def render(run: Run, *, width: int = WIDTH, color: bool = False) -> str:
    """The report as text of this width in columns, with ANSI colours if wanted."""
    sink = io.StringIO()
    out = Console(
        file=sink,
        width=width,
        force_terminal=color,
        no_color=not color,
        color_system="standard" if color else None,
        highlight=False,
        legacy_windows=False,
    )
    infos = {info.id: info for info in run.models}
    for model, group in groupby(run.findings, key=lambda f: f.model):
        findings = list(group)
        _heading(out, infos.get(model), model)
        for finding in findings:
            _finding(out, run, finding)
    _skipped(out, run)
    _recap(out, run)
    for failure in run.failures:
        _line(out, Text.assemble(("urdfcheck failed: ", "bold red"), visible(failure)))
    _summary(out, run)
    # Grids are filled up with blanks; a CI log and a diff are better without.
    return "".join(f"{line.rstrip()}\n" for line in sink.getvalue().splitlines())


def _line(out: Console, text: Text | Table, indent: int = 0) -> None:
    shown = Padding(text, (0, 0, 0, indent), expand=False) if indent else text
    out.print(shown, soft_wrap=False, highlight=False, markup=False)


def _heading(out: Console, info: ModelInfo | None, model: str) -> None:
    title = Text(visible(model) or "this run", style="bold")
    if info is not None and info.status == "checked":
        facts = [f"robot {visible(info.robot)}", _plural(info.links, "link"), _plural(info.joints, "joint")]
        if info.mass is not None:
            facts.append(f"{info.mass:.4g} kg")
        title.append("  " + " · ".join(facts), style="dim")
    elif info is not None:
        title.append(f"  {info.status}", style="dim")
    out.rule(title, align="left", style="dim", characters="─")


def _finding(out: Console, run: Run, finding: Finding) -> None:
    span = finding.location.span
    place = Text("" if span is None else f"{visible(span.file)}:{span.line}:{span.col} ", style="bold")
    head = _title(finding)
    if finding.suppressed is not None:
        head.append(f" (suppressed: {visible(finding.suppressed)})", "dim")
    if place.cell_len + head.cell_len > out.width:  # a long path keeps its line, so that a click on it still works
        out.print(place, soft_wrap=True, highlight=False)
        place = Text("  ")
    out.print(place + head, soft_wrap=True, highlight=False)
    _line(out, Text(visible(finding.message)), 2)
    if len(finding.subjects) > 1:
        _labelled(out, "for", ", ".join(visible(s) for s in finding.subjects))
    if span is not None:
        _frame(out, run, span, STYLES[finding.severity])
    for call in reversed(finding.location.via):
        _labelled(out, "from", f"{visible(call.file)}:{call.line}:{call.col}  {_first_line(run, call)}")
    shown = [r for r in finding.related if r.span is not None]
    for related in shown[:MAX_RELATED]:
        assert related.span is not None
        _labelled(out, "see", f"{visible(related.span.file)}:{related.span.line}  {visible(related.subject)}")
    if len(shown) > MAX_RELATED:
        _labelled(out, "see", f"… and {len(shown) - MAX_RELATED} more places")
    if finding.cause is not None:
        _labelled(out, "why", visible(finding.cause.text))
    for consumers, effect in _by_effect(finding):
        _labelled(out, "then", f"{', '.join(consumers)}: {visible(effect)}")
    if finding.fix is not None:
        _repair(out, finding, finding.fix)
    out.print()


def _frame(out: Console, run: Run, span: Span, style: str) -> None:
    lines = frame(run.sources.get(span.file, ""), span)
    if not lines:
        return
    digits = len(str(lines[-1].number))
    room = max(out.width - digits - 5, 20)
    for line in lines:
        text = visible(line.text.replace("\t", " "))
        start, end = (len(visible(line.text[:k].replace("\t", " "))) for k in line.marked or (0, 0))
        shown, cut = _window(text, start, end, room)
        out.print(Text(f"  {line.number:>{digits}} │ ", "dim") + Text(shown), soft_wrap=True, highlight=False)
        if line.marked is not None:
            marks = " " * (start - cut) + "^" * max(min(end - cut, room) - (start - cut), 1)
            out.print(Text(f"  {' ' * digits} │ ", "dim") + Text(marks, style), soft_wrap=True, highlight=False)


def _window(text: str, start: int, end: int, room: int) -> tuple[str, int]:
    """A line cut to ``room`` columns around its marked part, and how many columns were cut from its left."""
    cut = 0 if end <= room - 1 else max(0, min(start - room // 3, len(text) - room))
    shown = text[cut : cut + room]
    if cut:
        shown = "…" + shown[1:]
    if cut + room < len(text):
        shown = shown[:-1] + "…"
    return shown, cut


def _repair(out: Console, finding: Finding, fix: Fix) -> None:
    _labelled(out, "fix", visible(fix.title))
    here = None if finding.location.span is None else finding.location.span.file
    for edit in fix.edits[:MAX_RELATED]:
        place = "" if edit.span.file == here else f"{visible(edit.span.file)}:"
        for sign, text, style in (("-", edit.expected, "red"), ("+", edit.replacement, "green")):
            for line in text.strip("\r\n").splitlines():
                shown = visible(" ".join(line.split()) if sign == "-" else line)
                _labelled(out, "", Text.assemble((f"{place}{edit.span.line} {sign} ", "dim"), (shown, style)))
    if len(fix.edits) > MAX_RELATED:
        _labelled(out, "", Text(f"… and {len(fix.edits) - MAX_RELATED} more edits", "dim"))


def _labelled(out: Console, label: str, text: str | Text) -> None:
    """``label: text`` with the text's further lines below its first."""
    grid = Table.grid(padding=0)
    grid.add_column(width=6, no_wrap=True)
    grid.add_column(overflow="fold")
    grid.add_row(Text(label, "dim"), text)
    _line(out, grid, 2)


def _by_effect(finding: Finding) -> list[tuple[list[str], str]]:
    """Consumers that do the same thing share a line."""
    effects: dict[str, list[str]] = {}
    for consumer, effect in finding.consequences.items():
        effects.setdefault(effect, []).append(consumer)
    return [(consumers, effect) for effect, consumers in effects.items()]


def _first_line(run: Run, span: Span) -> str:
    lines = frame(run.sources.get(span.file, ""), span, context=0)
    return visible(lines[0].text.strip()) if lines else ""


def _skipped(out: Console, run: Run) -> None:
    reasons: dict[str, set[str]] = {}
    for skip in run.skipped:
        reasons.setdefault(skip.reason, set()).add(skip.code)
    for reason, codes in sorted(reasons.items()):
        _line(out, Text(f"skipped {_some(sorted(codes))}: {visible(reason)}", "dim"))


def _some(words: Sequence[str], most: int = 8) -> str:
    return ", ".join(words[:most]) + (f" and {len(words) - most} more" if len(words) > most else "")


def _title(finding: Finding) -> Text:
    head = Text(f"{GLYPHS[finding.severity]} {finding.severity} ", STYLES[finding.severity])
    head.append(f"{finding.code} {finding.name}", "bold")
    return head


def _recap(out: Console, run: Run) -> None:
    """After a long report: its errors and warnings once more, a line each, where the reader's eye is."""
    serious = [f for f in run.findings if f.severity > Severity.INFO and f.suppressed is None]
    if not serious or len(run.findings) <= FEW:
        return
    out.rule("errors and warnings", align="left", style="dim", characters="─")
    for finding in sorted(serious, key=lambda f: -f.severity):
        span = finding.location.span
        place = "" if span is None else f" {visible(span.file)}:{span.line}:{span.col}"
        out.print(_title(finding) + Text(place, "dim"), soft_wrap=True, highlight=False)
    out.print()


def _summary(out: Console, run: Run) -> None:
    if not run.units and not run.failures:
        _line(out, Text("nothing to check: no model, launch file or package was found there", "bold"))
        return
    if not run.findings and not run.failures:
        _line(out, Text(f"✔ no findings in {_plural(len(run.models), 'model')}{_states(run.models)}", "bold green"))
        return
    counts = [(s, run.count(s)) for s in (Severity.ERROR, Severity.WARNING, Severity.INFO)]
    text = Text()
    for severity, count in counts:
        text.append(f"{GLYPHS[severity]} {_plural(count, str(severity))}", STYLES[severity] if count else "dim")
        text.append("  ")
    states = _states(run.models)
    text.append(f"in {_plural(len(run.models), 'model')}{states}, {run.seconds:.1f} s", "dim")
    _line(out, text)


def _states(models: Iterable[ModelInfo]) -> str:
    others = [m.status for m in models if m.status != "checked"]
    counted = [f"{others.count(s)} {s}" for s in sorted(set(others))]
    return f" ({', '.join(counted)})" if counted else ""


def _plural(count: int, word: str) -> str:
    return f"{count} {word}" + ("" if count == 1 or word == "info" else "s")
