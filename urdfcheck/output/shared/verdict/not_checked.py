"""What a run has not checked, in words that all formats share: models of which nothing is known, and macro files."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Sequence
from itertools import pairwise

from urdfcheck.core import Finding, ModelInfo, Run, SkippedCheck
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_argument_option, join_names
from urdfcheck.output.shared.wording import format_count

GLYPH = "⊘"
STATUS_WORDS = {"needs-arguments": "needs arguments"}
# A command names more models than this by their folder.
_MOST_PATHS = 3
# How models that were not checked are accepted: an option, or a key of urdfcheck.toml.
ACCEPTING_OPTION, ACCEPTING_KEY = "--unchecked warning", "unchecked = [PATTERNS]"


@dataclass(frozen=True, slots=True)
class UncheckedGroup:
    """Models that were not checked for the same reason."""

    models: tuple[ModelInfo, ...]
    reason: str
    command: str
    """The command that may check them; empty where a file must be repaired first."""


def is_accepted(info: ModelInfo) -> bool:
    """Whether it is accepted that this model was not checked."""
    return info.not_checked is not None and info.not_checked.accepted


def describe_status(info: ModelInfo) -> str:
    """Return ``not checked: needs arguments``; ``checked`` for a model that was."""
    if info.status == "checked":
        return "checked"
    words = STATUS_WORDS.get(info.status, "")
    return f"not checked{f': {words}' if words else ''}{' (accepted)' if is_accepted(info) else ''}"


def explain_unchecked(info: ModelInfo) -> str:
    """Return why a model was not checked."""
    return "the model could not be read" if info.not_checked is None else info.not_checked.reason


def build_command(info: ModelInfo) -> str:
    """Return the command that may check a model; empty where no option of it does."""
    if info.not_checked is None or not info.not_checked.remedy:
        return ""
    return _join_command([info], info.not_checked.remedy)


def group_unchecked(models: Iterable[ModelInfo]) -> list[UncheckedGroup]:
    """Group models that were not checked by the reason; several variants of a file mostly share it."""
    groups: dict[str, list[ModelInfo]] = {}
    for info in models:
        groups.setdefault(explain_unchecked(info), []).append(info)
    return [UncheckedGroup(tuple(alike), reason, _build_shared_command(alike)) for reason, alike in groups.items()]


def _build_shared_command(models: Sequence[ModelInfo]) -> str:
    """Return the command that may check models with one cause: the first alone where the others need another command."""
    first, remedy = models[0], "" if models[0].not_checked is None else models[0].not_checked.remedy
    alike = [m for m in models if m.args == first.args and m.not_checked is not None and m.not_checked.remedy == remedy]
    return _join_command(alike, remedy) if remedy else ""


def _join_command(models: Iterable[ModelInfo], remedy: str) -> str:
    """Return the command that checks models that have the same arguments, with further options."""
    models = tuple(models)
    paths = [shlex.quote(path) for path in _list_paths(models)]
    # The remedy may give an argument another value.
    others = {name: value for name, value in models[0].args.items() if name not in _list_arguments(remedy)}
    options = (format_argument_option(name, value) for name, value in sorted(others.items()))
    # The remedy holds places to fill in, which the shell must not get.
    return " ".join(("urdfcheck", *paths, *options, remedy))


def _list_paths(models: Sequence[ModelInfo]) -> list[str]:
    """Return what to name so that models are checked: their files, or the folder that holds many of them."""
    paths = list(dict.fromkeys(m.path for m in models))
    if len(paths) <= _MOST_PATHS or models[0].args or len({os.path.isabs(path) for path in paths}) > 1:
        return paths
    return [os.path.commonpath(paths) or "."]


def _list_arguments(remedy: str) -> set[str]:
    """Return the names of the arguments that the options of a remedy give."""
    words = shlex.split(remedy)
    return {value.partition(":=")[0] for option, value in pairwise(words) if option == "--arg"}


def describe_unused_macros(run: Run) -> str:
    """Return ``70 macro files are used by no checked model and were not checked``; empty if all are used."""
    count = len(run.unused_macro_files)
    if not count:
        return ""
    are, were = ("is", "was") if count == 1 else ("are", "were")
    # A model that was not checked may use them, and one that was checked with other arguments.
    return f"{format_count(count, 'macro file')} {are} used by no checked model and {were} not checked"


def list_launched_models(run: Run) -> dict[str, str]:
    """Return by the id of a launch file why the model that it loads was not checked."""
    return {skip.model: skip.reason for skip in run.skipped if skip.code == SkippedCheck.LAUNCHED_MODEL}


def describe_not_checked(run: Run) -> str:
    """Return all that was not checked, like ``2 of 4 models were not checked``; empty if everything was."""
    models, macros, others = len(run.unchecked_models), len(run.unused_macro_files), _count_other_paths(run)
    launched = len(list_launched_models(run))
    if macros and not models and not others and not launched:
        return describe_unused_macros(run)
    counts = ((launched, "launched model"), (macros, "macro file"), (others, "other path"))
    parts = [_count_unchecked_models(run)] if models else []
    parts += [format_count(count, word) for count, word in counts if count]
    if not parts:
        return ""
    were = "was" if models + launched + macros + others == 1 else "were"
    return f"{' and '.join(filter(None, (', '.join(parts[:-1]), parts[-1])))} {were} not checked"


def describe_unchecked_models(run: Run) -> str:
    """Return ``2 of 4 models were not checked``, for a run in which there are such models."""
    return f"{_count_unchecked_models(run)} {'was' if len(run.unchecked_models) == 1 else 'were'} not checked"


def _count_unchecked_models(run: Run) -> str:
    unchecked, accepted = len(run.unchecked_models), sum(map(is_accepted, run.unchecked_models))
    said = "" if not accepted else " (accepted)" if accepted == unchecked else f" ({accepted} accepted)"
    return f"{unchecked:,} of {format_count(len(run.models), 'model')}{said}"


def _count_other_paths(run: Run) -> int:
    """Count the other paths that belong to no model or are out of reach; the skipped checks say why."""
    known = run.unit_ids | set(run.unused_macro_files)
    return len({skip.model for skip in run.skipped if skip.code == "ALL"} - known)


def explain_block(run: Run, finding: Finding) -> str:
    """Say of a finding for which a model could not be checked what that means and what helps; empty for others."""
    if not finding.blocks_check:
        return ""
    names = list(finding.variants) or [finding.model]
    command = next((build_command(info) for info in run.models if info.id in names), "")
    what = f"nothing else is known about {join_names(names, 3)}"
    return f"{what}; check it with `{command}`" if command else what
