"""Annotations on GitHub: workflow commands that a runner reads from the log.

Only what is written here begins a command: a stranger's text is the value of a property or the message of one, where ``%`` and
the ends of lines are escaped, and lines of it that look like commands are spelled out besides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Run, Severity
from urdfcheck.output.shared.inert import for_log
from urdfcheck.output.shared.positions import utf16
from urdfcheck.output.shared.wording import GLYPHS, ORDER, details, looked_at, own_file, plural, verdict, worst_first

COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}
# GitHub shows no more of each kind from a step.
MOST = 10
LONGEST = 4_000


def render(run: Run) -> str:
    """A command a line, the worst first, and a line that says how it came out."""
    return "".join(f"{line}\n" for line in _lines(run))


def _lines(run: Run) -> Iterator[str]:
    found = worst_first(run.active)
    shown: list[Finding] = []
    hidden = max(0, len(run.failures) - MOST)
    for failure in run.failures[:MOST]:
        yield command("error", [("title", "urdfcheck failed")], failure)
    for severity in ORDER:
        room = MOST - min(len(run.failures), MOST) if severity == Severity.ERROR else MOST
        group = [finding for finding in found if finding.severity == severity]
        shown += group[:room]
        hidden += len(group[room:])
    yield from (_annotation(run, finding) for finding in shown)
    if hidden:
        yield f"{hidden} more: see the job summary"
    _, sentence = verdict(run)
    counts = "  ".join(f"{GLYPHS[s]} {plural(run.count(s), str(s))}" for s in ORDER)
    yield f"{sentence}: {counts}  in {looked_at(run)}"


def _annotation(run: Run, finding: Finding) -> str:
    properties: list[tuple[str, object]] = []
    span = finding.location.span
    if span is not None:
        at = utf16(span, run.sources)
        properties = [("file", span.file), ("line", at.line), ("endLine", at.end_line)]
        # The runner drops columns that belong to different lines, with a complaint.
        properties += [("col", at.column), ("endColumn", at.end_column)] if at.line == at.end_line else []
    elif file := own_file(run, finding):
        properties = [("file", file)]
    message = [finding.message, *(f"{label}: {text}" for label, text in details(run, finding))]
    properties.append(("title", f"{finding.code} {finding.name}"))
    return command(COMMANDS[finding.severity], properties, "\n".join(message))


def command(name: str, properties: Sequence[tuple[str, object]], message: str) -> str:
    """A workflow command. A runner makes of its message what was given, but for what acts in a terminal or a log."""
    told = ",".join(
        f"{key}={_escaped(str(value)).replace(':', '%3A').replace(',', '%2C')}" for key, value in properties
    )
    cut = message if len(message) <= LONGEST else f"{message[:LONGEST]}…"
    return f"::{name} {told}::{_escaped(cut)}"


def _escaped(text: str) -> str:
    return for_log(text).replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
