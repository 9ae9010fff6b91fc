"""Annotations on GitHub for what a change does to the robot: at the lines of the new version that caused it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from urdfcheck.core.model_diff import CATEGORIES, Diff, MechanismDiff, ModelDiff, SeamChange
from urdfcheck.core.records import dataclass
from urdfcheck.output.changes.causes import SharedCause, merge_causes, strip_revision
from urdfcheck.output.changes.summary import (
    OLD_NAME,
    count_findings,
    describe_verdict,
    get_harm,
    get_label,
    list_harm,
)
from urdfcheck.output.changes.text import has_headline
from urdfcheck.output.github import MOST_ANNOTATIONS, format_workflow_command
from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line

# Changes that no robot feels.
_LIGHT = frozenset({"visual", "extension"})
# The changes that can have an effect of a kind, by category, and those among them that cannot.
_CAUSING = {
    "collision": frozenset({"structure", "kinematic", "limits", "collision"}),
    "inertia": frozenset({"structure", "kinematic", "dynamic"}),
    "stability": frozenset({"structure", "kinematic", "dynamic", "collision", "visual"}),
}
_UNABLE = frozenset({"link-renamed", "joint-renamed", "effort", "velocity"})
# File and first and last line in the new version, as properties of a command.
_Place = tuple[tuple[str, object], ...]


@dataclass(frozen=True, slots=True)
class _Annotation:
    """What a command says; without a place it is of the whole run."""

    command: str
    place: _Place
    title: str
    message: str

    def format(self) -> str:
        return format_workflow_command(self.command, [*self.place, ("title", self.title)], self.message)


def render(diff: Diff) -> str:
    """Render a command for each harm, each cause and each change around the robots, the most important first, and a line with
    the verdict.

    New findings have no annotation here: those of `urdfcheck check` are at the same lines. Neither have harmless effects and
    changes without a line in the new version: the summary of the job has them.
    """
    return "".join(f"{line}\n" for line in _iter_lines(diff))


def _iter_lines(diff: Diff) -> Iterator[str]:
    failures = [text for text in diff.failures if not has_headline(diff, text)]
    unknown = [f"{model.after or model.before}: {model.headline}" for model in diff.models if model.problem]
    errors = [_Annotation("error", (), "not compared", text) for text in (*unknown, *failures)]
    causes = [_annotate_cause(cause, diff.after) for cause in sorted(merge_causes(diff.models), key=_rank_cause)]
    effects = [annotation for model in diff.models for annotation in _iter_effects(model, diff.after)]
    seams = [_annotate_seam(change, diff.after) for change in diff.seams if change.after is not None]
    # Models that change alike say the same.
    annotations = list(dict.fromkeys((*errors, *effects, *causes, *seams)))
    hidden = 0
    for command in ("error", "warning", "notice"):
        group = [annotation for annotation in annotations if annotation.command == command]
        yield from (annotation.format() for annotation in group[:MOST_ANNOTATIONS])
        hidden += len(group[MOST_ANNOTATIONS:])
    if hidden:
        yield f"{hidden} more: see the job summary"
    yield escape_for_log(escape_one_line("; ".join((describe_verdict(diff), *list_harm(diff), count_findings(diff)))))


# -- causes ------------------------------------------------------------------------------------------------------------


def _is_light(cause: SharedCause) -> bool:
    return all(caused.change.category in _LIGHT for caused in cause.changes)


def _rank_cause(cause: SharedCause) -> tuple[int, int]:
    """Return the place of the most important category that a cause changes, then how few changes it has."""
    ranks = (
        CATEGORIES.index(caused.change.category) for caused in cause.changes if caused.change.category in CATEGORIES
    )
    return min(ranks, default=0), -len(cause.changes)


def _annotate_cause(shared: SharedCause, version: str) -> _Annotation:
    """Return what a cause changes, at its first line in the new version; of the whole run where there is none."""
    kinds = dict.fromkeys(get_label(caused.change.category) for caused in shared.changes)
    texts = dict.fromkeys(caused.text for caused in shared.changes)
    gone = [] if shared.cause.after else [f"removed: {file}:{line}  {text}" for file, line, text in shared.cause.before]
    return _Annotation(
        "notice" if _is_light(shared) else "warning",
        _locate_lines(shared.cause.after, version),
        f"changes the robot: {', '.join(kinds)}",
        "\n".join((*texts, *gone)),
    )


def _locate_lines(lines: Iterable[tuple[str, int, str]], version: str) -> _Place:
    """Return the place of the first lines that follow one another; nothing without lines."""
    numbers = [(file, number) for file, number, _ in lines]
    if not numbers:
        return ()
    file, line = numbers[0]
    last = next(number for number in range(line, line + len(numbers)) if (file, number + 1) not in numbers)
    return ("file", strip_revision(file, version)), ("line", line), ("endLine", last)


# -- what follows, and what is around ----------------------------------------------------------------------------------


def _iter_effects(model: ModelDiff, version: str) -> Iterator[_Annotation]:
    """Yield what follows from the changes of a model: a warning for each harm, and notices about the rest."""
    found = model.mechanism
    if found is None:
        return
    texts: dict[tuple[str, str], list[str]] = {}
    for effect, text in zip(found.effects, model.effects, strict=True):
        texts.setdefault((effect.kind, get_harm(effect)), []).append(text)
    for (kind, harm), lines in texts.items():
        place = _locate_only_cause(found, kind, version)
        if harm or place:
            command, title = ("warning", harm) if harm else ("notice", f"what follows for the robot: {kind}")
            yield _Annotation(command, place, title, "\n".join(lines))


def _locate_only_cause(found: MechanismDiff, kind: str, version: str) -> _Place:
    """Return the place of the lines that caused all changes which can have an effect of a kind; nothing where several did."""
    able = {
        number
        for number, change in enumerate(found.changes)
        if change.category in _CAUSING[kind] and change.id not in _UNABLE
    }
    causes = [cause for cause in found.causes if able & set(cause.changes)]
    is_only = len(causes) == 1 and able <= set(causes[0].changes)
    return _locate_lines(causes[0].after, version) if is_only else ()


def _annotate_seam(change: SeamChange, version: str) -> _Annotation:
    """Return what a statement of the new version says differently, at its place."""
    span = change.after
    assert span is not None
    is_stale = change.id == OLD_NAME
    place = (("file", strip_revision(span.file, version)), ("line", span.line), ("endLine", span.end_line))
    title = "still uses the old name" if is_stale else f"changes around the robot: {change.kind}"
    return _Annotation("warning" if is_stale else "notice", place, title, change.text)
