"""The comparison of two versions for a terminal: the verdict, the changes, the lines that caused them, the findings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding
from urdfcheck.core.model_diff import (
    COSMETIC,
    EFFECTS,
    IDENTICAL,
    ChangeCause,
    Diff,
    JointTorque,
    MechanismDiff,
    ModelDiff,
    SeamChange,
)
from urdfcheck.core.text import format_count, join_names
from urdfcheck.output.changes.change_groups import describe_group, group_changes
from urdfcheck.output.changes.summary import count_findings, describe_verdict, get_label
from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line
from urdfcheck.output.shared.wording import format_place

# How many changes, causes, lines of one side of a cause, notes, findings, and changes around the models are listed
# unless all are asked for.
MOST_CHANGES, MOST_CAUSES, MOST_LINES, MOST_NOTES, MOST_FINDINGS, MOST_SEAMS = 5, 2, 2, 1, 3, 3
# How many effects of each kind are listed, and links of which a shape could not be measured.
MOST_EFFECTS = {"collision": 2, "inertia": 1, "stability": 2}
MOST_UNREAD = 2
# How many parts with one change, or models that change alike, are named.
_MOST_NAMES = 3
# Columns of the names of the categories.
_COLUMN = 10


def render(diff: Diff, *, show_all: bool = False) -> str:
    """Render the lines of the report, each model with its verdict first."""
    lines: list[str] = []
    for alike in group_alike(diff.models):
        if len(diff.models) > 1 and alike[0].verdict == IDENTICAL and not show_all:
            continue
        lines += _iter_model_lines(alike, is_only=len(diff.models) == 1, show_all=show_all)
    if not diff.models and not diff.failures:
        lines.append(describe_verdict(diff))
    same = sum(model.verdict == IDENTICAL for model in diff.models)
    if len(diff.models) > 1 and same and not show_all:
        lines.append(f"{format_count(same, 'model is', 'models are')} identical")
    lines += _iter_seam_lines(diff, show_all=show_all)
    lines += _iter_finding_lines(diff, show_all=show_all)
    lines += [f"not compared: {failure}" for failure in diff.failures if not has_headline(diff, failure)]
    lines += [f"not compared: {note}" for note in diff.notes]
    return "".join(f"{escape_for_log(escape_one_line(line))}\n" for line in lines)


def has_headline(diff: Diff, failure: str) -> bool:
    """Whether a failure is the headline of a model, which is shown anyway."""
    return any(failure.endswith(model.headline) for model in diff.models)


def group_alike(models: Sequence[ModelDiff]) -> list[list[ModelDiff]]:
    """Group the models that change alike by the same lines, such as variants of one file, in the order of their first ones."""
    groups: dict[tuple[object, ...], list[ModelDiff]] = {}
    for model in models:
        causes = () if model.mechanism is None else model.mechanism.causes
        lines = tuple((cause.before, cause.after) for cause in causes)
        own = model.before if _is_matched_otherwise(model) else ""  # shown with what it was
        key = (model.verdict, model.headline, model.texts, model.effects, model.notes, model.idle_edits, lines, own)
        groups.setdefault(key, []).append(model)
    return list(groups.values())


def _is_matched_otherwise(model: ModelDiff) -> bool:
    """Whether two models with different paths are taken for versions of one."""
    return bool(model.before and model.after) and model.matched_by in {"name", "structure"}


def name_models(alike: Sequence[ModelDiff]) -> str:
    """Return the names of models, the first of many."""
    return join_names([model.after or model.before for model in alike], _MOST_NAMES)


def _iter_model_lines(alike: Sequence[ModelDiff], *, is_only: bool, show_all: bool) -> Iterator[str]:
    """Yield the lines about models that change alike; the causes are those of the first."""
    model = alike[0]
    yield model.headline if is_only else f"{name_models(alike)}: {model.headline}"
    if _is_matched_otherwise(model):
        yield f"  before: {model.before}, matched by {model.matched_by}"
    found = model.mechanism
    if found is None:
        return
    yield from _iter_change_lines(model, found, show_all=show_all)
    yield from _iter_cause_lines(found.causes, show_all=show_all)
    if model.idle_edits:
        yield f"  {'note':{_COLUMN}} {describe_idle_edits(model)}"
    shown = model.notes if show_all or model.verdict == COSMETIC else model.notes[:MOST_NOTES]
    for note in shown:
        yield f"  {'note':{_COLUMN}} {note}"
    if len(model.notes) > len(shown):
        yield f"  … {format_count(len(model.notes) - len(shown), 'more note')} (-v lists all)"


def _iter_change_lines(model: ModelDiff, found: MechanismDiff, *, show_all: bool) -> Iterator[str]:
    changes = list(zip(found.changes, model.texts, strict=True))
    groups = [[change] for change in changes] if show_all else group_changes(changes)
    most = len(groups) if show_all else MOST_CHANGES
    for group in groups[:most]:
        if len(group) == 1 and not show_all and group[0][1] in model.headline:
            continue
        yield f"  {get_label(group[0][0].category):{_COLUMN}} {describe_group(group, _MOST_NAMES)}"
    if len(groups) > most:
        yield f"  … {format_count(sum(map(len, groups[most:])), 'more change')} (-v lists all)"
    torques = found.torques if show_all else found.torques[:1]
    for torque in torques:
        yield f"  {'gravity':{_COLUMN}} {describe_torque(torque)}"
    for kind in EFFECTS:
        lines = [text for effect, text in zip(found.effects, model.effects, strict=True) if effect.kind == kind]
        for line in lines if show_all else lines[: MOST_EFFECTS[kind]]:
            yield f"  {kind:{_COLUMN}} {line}"
        if kind == "collision" and len(lines) > MOST_EFFECTS[kind] and not show_all:
            yield f"  … {format_count(len(lines) - MOST_EFFECTS[kind], 'more pair')} (-v lists all)"
    if unread := describe_unread(found):
        yield f"  {'collision':{_COLUMN}} {unread}"


def describe_unread(found: MechanismDiff) -> str:
    """Return of which links collisions could not be compared; empty where there are none."""
    if found.collisions is None or not found.collisions.unread:
        return ""
    names = join_names([f"link {name}" for name in found.collisions.unread], MOST_UNREAD)
    return f"not compared: {names}, of which a shape could not be measured"


def describe_idle_edits(model: ModelDiff) -> str:
    """Return how many edited lines the robot has nothing of, with the first of them."""
    file, line, _ = model.idle_edits[0]
    lines = format_count(len(model.idle_edits), "edited line makes", "edited lines make")
    return f"{lines} no part of this robot, first {file}:{line} (--all-args compares it with other arguments too)"


def describe_torque(torque: JointTorque) -> str:
    """Return what gravity asks of a joint in both versions."""
    text = f"joint {torque.joint} holds up to {torque.before:.3g} → {torque.after:.3g} {torque.unit}"
    text += f" (mostly because of link {torque.main_link})" if torque.main_link else ""
    if torque.effort is None:
        return text
    return f"{text}, {'more than' if torque.after > torque.effort else 'of'} its limit of {torque.effort:.3g}"


def _iter_cause_lines(causes: Sequence[ChangeCause], *, show_all: bool) -> Iterator[str]:
    shown = causes if show_all else sorted(causes, key=lambda cause: -len(cause.changes))[:MOST_CAUSES]
    for cause in shown:
        count = format_count(len(cause.changes), "change")
        yield f"  {count}, caused by" if cause.is_edited else f"  {count}, typed in a line that was not edited"
        # A line that was not edited is the same in both versions.
        sides = (("-", cause.before), ("+", cause.after)) if cause.is_edited else ((" ", cause.after or cause.before),)
        for sign, lines in sides:
            most = len(lines) if show_all else MOST_LINES
            more = f"  … {format_count(len(lines) - most, 'more line')}" if len(lines) > most else ""
            for number, (file, line, text) in enumerate(lines[:most], start=1):
                yield f"    {sign} {file}:{line}  {text}{more if number == most else ''}"
    if len(causes) > len(shown):
        yield f"  … {format_count(len(causes) - len(shown), 'more cause')} (-v lists all)"


def _iter_seam_lines(diff: Diff, *, show_all: bool) -> Iterator[str]:
    """Yield what differs in the files around the models."""
    shown = diff.seams if show_all else diff.seams[:MOST_SEAMS]
    for change in shown:
        yield f"{change.kind}: {describe_seam(change)}"
    if len(diff.seams) > len(shown):
        yield f"… {format_count(len(diff.seams) - len(shown), 'more change')} around the models (-v lists all)"


def describe_seam(change: SeamChange) -> str:
    """Return what differs in a file around a model, with its place."""
    span = change.after or change.before
    return change.text if span is None else f"{change.text} ({format_place(span)})"


def _iter_finding_lines(diff: Diff, *, show_all: bool) -> Iterator[str]:
    found = diff.findings
    if not (found.new or found.gone or found.unchecked):
        if found.unchanged:
            yield f"findings: {found.unchanged} unchanged"
        return
    yield count_findings(diff)
    for word, findings in (("new", found.new), ("gone", found.gone)):
        ordered = sorted(findings, key=lambda finding: -finding.severity)
        counts = Counter(map(_describe_finding, ordered))
        shown = counts if show_all else dict(list(counts.items())[:MOST_FINDINGS])
        for text, count in shown.items():
            yield f"  {word:4} {text}{f' ({count} times)' if count > 1 else ''}"
        if len(counts) > len(shown):
            yield f"  … {len(ordered) - sum(shown.values())} more {word} (-v lists all)"


def _describe_finding(finding: Finding) -> str:
    span = finding.location.span
    place = "" if span is None else f"{format_place(span)}: "
    return f"{place}{finding.severity} {finding.code} {finding.headline}"
