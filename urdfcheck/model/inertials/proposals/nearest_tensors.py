"""The nearest tensor that a body can have, where little is missing or the digits are too few."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from urdfcheck.facts.inertials.mistakes.tensor_slips import find_nearest_tensor
from urdfcheck.model.inertials.proposals.tensor_repairs import SMALL_EXCESS, InertialProposal, replace_tensor
from urdfcheck.model.parts import DeclaredTensor

# The nearest possible tensor is offered as an edit without a cause where it changes less than mass properties are known by.
_NEGLIGIBLE_CHANGE = 5e-3
# A moment that changes by more than this share of itself is another number (chosen).
_OTHER_NUMBER = 0.1


def _changes_moment(before: Sequence[float], after: Sequence[float]) -> bool:
    """Whether one of the moments of a tensor is another number afterwards."""
    return any(abs(after[i] - before[i]) > _OTHER_NUMBER * abs(before[i]) for i in (0, 3, 5))


def propose_nearest(declared: DeclaredTensor, cause: str | None, *, digits: int = 6) -> InertialProposal:
    """Propose the nearest tensor that a body can have, about the author's own COM, with so few digits that it is still one."""
    components, change = find_nearest_tensor(declared.components, thickness=10.0 ** (1 - min(digits, 6)))
    nearest = replace_tensor(declared.link, components, digits=min(digits, 6))
    if nearest is None or not nearest.text:
        return InertialProposal()
    edits = nearest.edits if change < (SMALL_EXCESS if cause else _NEGLIGIBLE_CHANGE) else ()
    if cause is None and _changes_moment(declared.components, components):
        edits = ()  # a small moment may have lost its decimal point
    words, off = replace(nearest, edits=edits).words, f"({100 * change:.2g} % off)"
    if not edits:
        return InertialProposal(comparison=f"; the nearest possible one is {words} {off}", cause=cause)
    return InertialProposal(edits, "", f"write {words}, the nearest possible tensor {off}, or better ", cause=cause)
