"""The comparison of two versions for a terminal: the verdict, the changes, the lines that caused them, the findings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding
from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, ChangeCause, Diff, JointTorque, MechanismDiff, ModelDiff
from urdfcheck.core.text import format_count
from urdfcheck.output.changes.summary import count_findings, describe_verdict, get_label
from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line
from urdfcheck.output.shared.wording import format_place

# How many changes, causes, notes and findings are listed unless all are asked for.
MOST_CHANGES, MOST_CAUSES, MOST_OTHERS = 12, 4, 3
# Columns of the names of the categories.
_COLUMN = 10


def render(diff: Diff, *, show_all: bool = False) -> str:
    """Render the lines of the report, each model with its verdict first."""
    lines: list[str] = []
    for model in diff.models:
        if len(diff.models) > 1 and model.verdict == IDENTICAL and not show_all:
            continue
        lines += _iter_model_lines(model, is_only=len(diff.models) == 1, show_all=show_all)
    if not diff.models and not diff.failures:
        lines.append(describe_verdict(diff))
    same = sum(model.verdict == IDENTICAL for model in diff.models)
    if len(diff.models) > 1 and same and not show_all:
        lines.append(f"{format_count(same, 'model is', 'models are')} identical")
    lines += _iter_finding_lines(diff, show_all=show_all)
    lines += [f"not compared: {failure}" for failure in diff.failures if not has_headline(diff, failure)]
    lines += [f"not compared: {note}" for note in diff.notes]
    return "".join(f"{escape_for_log(escape_one_line(line))}\n" for line in lines)


def has_headline(diff: Diff, failure: str) -> bool:
    """Whether a failure is the headline of a model, which is shown anyway."""
    return any(failure.endswith(model.headline) for model in diff.models)


def _iter_model_lines(model: ModelDiff, *, is_only: bool, show_all: bool) -> Iterator[str]:
    name = model.after or model.before
    yield model.headline if is_only else f"{name}: {model.headline}"
    if model.before and model.after and model.matched_by in {"name", "structure"}:
        yield f"  before: {model.before}, matched by {model.matched_by}"
    found = model.mechanism
    if found is None:
        return
    yield from _iter_change_lines(model, found, show_all=show_all)
    yield from _iter_cause_lines(found.causes, show_all=show_all)
    shown = model.notes if show_all or model.verdict == COSMETIC else model.notes[:MOST_OTHERS]
    for note in shown:
        yield f"  {'note':{_COLUMN}} {note}"
    if len(model.notes) > len(shown):
        yield f"  … {format_count(len(model.notes) - len(shown), 'more note')} (-v lists all)"


def _iter_change_lines(model: ModelDiff, found: MechanismDiff, *, show_all: bool) -> Iterator[str]:
    most = len(model.texts) if show_all else MOST_CHANGES
    for change, text in list(zip(found.changes, model.texts, strict=True))[:most]:
        yield f"  {get_label(change.category):{_COLUMN}} {text}"
    if len(model.texts) > most:
        yield f"  … {format_count(len(model.texts) - most, 'more change')} (-v lists all)"
    torques = found.torques if show_all else found.torques[:2]
    for torque in torques:
        yield f"  {'gravity':{_COLUMN}} {describe_torque(torque)}"


def describe_torque(torque: JointTorque) -> str:
    """Return what gravity asks of a joint in both versions."""
    text = f"joint {torque.joint} holds up to {torque.before:.3g} → {torque.after:.3g} {torque.unit}"
    if torque.effort is None:
        return text
    return f"{text}, {'more than' if torque.after > torque.effort else 'of'} its limit of {torque.effort:.3g}"


def _iter_cause_lines(causes: Sequence[ChangeCause], *, show_all: bool) -> Iterator[str]:
    shown = causes if show_all else sorted(causes, key=lambda cause: -len(cause.changes))[:MOST_CAUSES]
    for cause in shown:
        count = format_count(len(cause.changes), "change")
        yield f"  {count}, caused by" if cause.is_edited else f"  {count}, typed in a line that was not edited"
        for sign, lines in (("-", cause.before), ("+", cause.after)):
            for file, line, text in lines:
                yield f"    {sign} {file}:{line}  {text}"
    if len(causes) > len(shown):
        yield f"  … {format_count(len(causes) - len(shown), 'more cause')} (-v lists all)"


def _iter_finding_lines(diff: Diff, *, show_all: bool) -> Iterator[str]:
    found = diff.findings
    if not (found.new or found.gone):
        if found.unchanged:
            yield f"findings: {found.unchanged} unchanged"
        return
    yield count_findings(diff)
    for word, findings in (("new", found.new), ("gone", found.gone)):
        ordered = sorted(findings, key=lambda finding: -finding.severity)
        shown = ordered if show_all else ordered[:MOST_OTHERS]
        for finding in shown:
            yield f"  {word:4} {_describe_finding(finding)}"
        if len(ordered) > len(shown):
            yield f"  … {len(ordered) - len(shown)} more {word} (-v lists all)"


def _describe_finding(finding: Finding) -> str:
    span = finding.location.span
    place = "" if span is None else f"{format_place(span)}: "
    return f"{place}{finding.severity} {finding.code} {finding.headline}"
