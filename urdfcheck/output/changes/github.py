"""Annotations on GitHub for what a change does to the robot: at the lines of the new version that caused it."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core.model_diff import CATEGORIES, Diff
from urdfcheck.output.changes.causes import SharedCause, merge_causes, strip_revision
from urdfcheck.output.changes.summary import count_findings, describe_verdict, get_label
from urdfcheck.output.changes.text import has_headline
from urdfcheck.output.github import MOST_ANNOTATIONS, format_workflow_command
from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line

# Changes that no robot feels.
_LIGHT = frozenset({"visual", "extension"})


def render(diff: Diff) -> str:
    """Render a command per cause, the most important first, and a line with the verdict.

    New findings have no annotation here: those of `urdfcheck check` are at the same lines.
    """
    return "".join(f"{line}\n" for line in _iter_lines(diff))


def _iter_lines(diff: Diff) -> Iterator[str]:
    failures = [text for text in diff.failures if not has_headline(diff, text)]
    unknown = [f"{model.after or model.before}: {model.headline}" for model in diff.models if model.problem]
    errors = [*unknown, *failures]
    for text in errors[:MOST_ANNOTATIONS]:
        yield format_workflow_command("error", [("title", "not compared")], text)
    causes = sorted(merge_causes(diff.models), key=_rank_cause)
    heavy, light = ([cause for cause in causes if _is_light(cause) is wanted] for wanted in (False, True))
    for name, group in (("warning", heavy), ("notice", light)):
        for cause in group[:MOST_ANNOTATIONS]:
            yield _format_annotation(name, cause, diff.after)
    hidden = sum(max(0, len(group) - MOST_ANNOTATIONS) for group in (errors, heavy, light))
    if hidden:
        yield f"{hidden} more: see the job summary"
    yield escape_for_log(escape_one_line(f"{describe_verdict(diff)}; {count_findings(diff)}"))


def _is_light(cause: SharedCause) -> bool:
    return all(caused.change.category in _LIGHT for caused in cause.changes)


def _rank_cause(cause: SharedCause) -> tuple[int, int]:
    """Return the place of the most important category that a cause changes, then how few changes it has."""
    ranks = (
        CATEGORIES.index(caused.change.category) for caused in cause.changes if caused.change.category in CATEGORIES
    )
    return min(ranks, default=0), -len(cause.changes)


def _format_annotation(name: str, shared: SharedCause, version: str) -> str:
    """Format the annotation of a cause: at its first line in the new version, or of the whole run where there is none."""
    kinds = dict.fromkeys(get_label(caused.change.category) for caused in shared.changes)
    properties: list[tuple[str, object]] = []
    if shared.cause.after:
        file, line, _ = shared.cause.after[0]
        known = {number for other, number, _ in shared.cause.after if other == file}
        last = next(number for number in range(line, line + len(known)) if number + 1 not in known)
        properties = [("file", strip_revision(file, version)), ("line", line), ("endLine", last)]
    properties.append(("title", f"changes the robot: {', '.join(kinds)}"))
    texts = dict.fromkeys(caused.text for caused in shared.changes)
    gone = [] if shared.cause.after else [f"removed: {file}:{line}  {text}" for file, line, text in shared.cause.before]
    return format_workflow_command(name, properties, "\n".join((*texts, *gone)))
