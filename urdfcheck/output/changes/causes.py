"""The lines behind the changes, each once however many models are made of them."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core.model_diff import ChangeCause, MechanismChange, ModelDiff
from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True)
class CausedChange:
    """A change, in words too."""

    model: ModelDiff
    change: MechanismChange
    text: str


@dataclass(frozen=True, slots=True)
class SharedCause:
    """A cause with all that it changes in all models."""

    cause: ChangeCause
    """Its lines; its indices are those of the first model that it changes."""
    changes: tuple[CausedChange, ...]


def merge_causes(models: Sequence[ModelDiff]) -> list[SharedCause]:
    """Return each cause of some models once, the one with the most changes first."""
    causes: dict[tuple[object, ...], ChangeCause] = {}
    changes: dict[tuple[object, ...], list[CausedChange]] = {}
    for model in models:
        found = model.mechanism
        for cause in () if found is None else found.causes:
            key = (cause.before, cause.after, cause.is_edited)
            causes.setdefault(key, cause)
            assert found is not None
            changes.setdefault(key, []).extend(
                CausedChange(model, found.changes[index], model.texts[index]) for index in cause.changes
            )
    merged = [SharedCause(cause, tuple(changes[key])) for key, cause in causes.items()]
    return sorted(merged, key=lambda shared: -len(shared.changes))


def strip_revision(file: str, version: str) -> str:
    """Return the name of a file in a checkout: a file of a revision is called ``REV:path``."""
    return file.removeprefix(f"{version}:")
