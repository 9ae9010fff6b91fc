"""Moments of zero: rounded, or never filled in."""

from __future__ import annotations

from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import list_half_units
from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor
from urdfcheck.model.robot import Model

# Where the moments are in ``ixx ixy ixz iyy iyz izz``.
_DIAGONAL = (0, 3, 5)


def has_lost_moment(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a moment of zero was not rounded to it: the drawn part's is above a unit of the last place of the others."""
    zeros = _list_zero_moments(declared)
    drawn = compute_drawn_tensor(model, declared) if zeros else None
    if drawn is None:
        return False
    place = 2.0 * max(list_half_units(declared.texts))
    return any(float(drawn[i, i]) > place for i in zeros)


def _list_zero_moments(declared: DeclaredTensor) -> list[int]:
    """List which of ixx, iyy and izz, as 0, 1 and 2, are zero."""
    return [i for i, moment in enumerate(declared.tensor.diagonal().tolist()) if moment == 0.0]


def describe_zero_moments(declared: DeclaredTensor) -> str:
    """Say which moments are zero where these are more than a rod has; empty otherwise."""
    zeros = _list_zero_moments(declared)
    names = join_names(TENSOR_NAMES[_DIAGONAL[i]] for i in zeros)
    return f"; {names} are 0, as if never filled in" if len(zeros) > 1 else ""
