"""Annotations on GitHub: workflow commands that a runner reads from the log.

Only this module begins commands: untrusted text is the value of a property or the message of a command, where ``%`` and line
breaks are escaped, and so are lines that look like commands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Run, Severity
from urdfcheck.core.merging import join_on_lines
from urdfcheck.output.shared.escaping import escape_for_log
from urdfcheck.output.shared.positions import to_utf16_region
from urdfcheck.output.shared.verdict.finding_details import iter_details
from urdfcheck.output.shared.verdict.verdict import describe_checked_units, summarize_verdict
from urdfcheck.output.shared.wording import (
    GLYPHS,
    SEVERITY_ORDER,
    find_finding_file,
    format_count,
    sort_worst_first,
)

COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}
# GitHub shows at most this many annotations of each kind from a step.
MOST_ANNOTATIONS = 10
LONGEST_MESSAGE = 4_000


def render(run: Run) -> str:
    """Render a command per line, the worst first, and a line with the verdict."""
    return "".join(f"{line}\n" for line in _iter_lines(run))


def _iter_lines(run: Run) -> Iterator[str]:
    findings = sort_worst_first(join_on_lines(run.active_findings, run.rules))
    shown: list[Finding] = []
    failures = run.failures[:MOST_ANNOTATIONS]
    hidden = len(run.failures) - len(failures)
    for failure in failures:
        yield format_workflow_command("error", [("title", "not checked")], failure)
    for severity in SEVERITY_ORDER:
        # Failures are errors too.
        room = MOST_ANNOTATIONS - len(failures) if severity == Severity.ERROR else MOST_ANNOTATIONS
        group = [finding for finding in findings if finding.severity == severity]
        shown += group[:room]
        hidden += len(group[room:])
    yield from (_format_annotation(run, finding) for finding in shown)
    if hidden:
        yield f"{hidden} more: see the job summary"
    _, sentence = summarize_verdict(run)
    counts = "  ".join(f"{GLYPHS[s]} {format_count(run.count_findings(s), str(s))}" for s in SEVERITY_ORDER)
    yield f"{sentence}: {counts}  in {describe_checked_units(run)}"


def _format_annotation(run: Run, finding: Finding) -> str:
    properties: list[tuple[str, object]] = []
    span = finding.location.span
    if span is not None:
        at = to_utf16_region(span, run.sources)
        properties = [("file", span.file), ("line", at.line), ("endLine", at.end_line)]
        # The runner drops columns of different lines, with a warning.
        properties += [("col", at.column), ("endColumn", at.end_column)] if at.line == at.end_line else []
    elif file := find_finding_file(run, finding):
        properties = [("file", file)]
    message = [finding.message, *(f"{label}: {text}" for label, text in iter_details(run, finding))]
    properties.append(("title", f"{finding.code} {finding.headline}"))
    return format_workflow_command(COMMANDS[finding.severity], properties, "\n".join(message))


def format_workflow_command(name: str, properties: Sequence[tuple[str, object]], message: str) -> str:
    """Format a workflow command. A runner shows its message unchanged, except for what acts in a terminal or a log."""
    assignments = ",".join(
        f"{key}={_escape_command_text(str(value)).replace(':', '%3A').replace(',', '%2C')}" for key, value in properties
    )
    cut = message if len(message) <= LONGEST_MESSAGE else f"{message[:LONGEST_MESSAGE]}…"
    return f"::{name} {assignments}::{_escape_command_text(cut)}"


def _escape_command_text(text: str) -> str:
    return escape_for_log(text).replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
