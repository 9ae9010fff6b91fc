"""Moments of zero: rounded, never filled in, or those of a point beside an axis."""

from __future__ import annotations

import numpy as np

from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term, list_half_units
from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor
from urdfcheck.model.robot import Model

# A tensor is that of a point to within this share of its largest moment: four typed digits.
_OF_POINT = 1e-3
# Programs that round a moment (kg m²) keep more than two decimals.
_FEW_DECIMALS = 5e-3
# A COM on an axis makes a tensor of a line, as a thin rod has.
_COORDINATES = 2
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


def has_bare_zeros(declared: DeclaredTensor) -> bool:
    """Whether two moments were typed as 0 without decimals, beside one that no program rounds so: 1e-6 is one of few decimals."""
    texts = [declared.texts[place] for place in _DIAGONAL]
    return texts.count("0") == len(texts) - 1 and float(np.abs(declared.tensor.diagonal()).max()) >= _FEW_DECIMALS


def is_point_about_origin(declared: DeclaredTensor) -> bool:
    """Whether a tensor is the parallel-axis term of the link's mass at its COM, of two coordinates or three: that of a point,
    about the link's origin, of which nothing is left about the COM."""
    inertial, matrix = declared.inertial, declared.inertial.origin.matrix
    if (
        matrix is None
        or inertial.mass is None
        or not inertial.mass > 0.0
        or np.count_nonzero(matrix[:3, 3]) < _COORDINATES
    ):
        return False
    rotation = matrix[:3, :3]
    term = compute_parallel_axis_term(inertial.mass, rotation.T @ matrix[:3, 3])
    return bool(np.abs(declared.tensor - term).max() <= _OF_POINT * np.abs(term).max())


def _list_zero_moments(declared: DeclaredTensor) -> list[int]:
    """List which of ixx, iyy and izz, as 0, 1 and 2, are zero."""
    return [i for i, moment in enumerate(declared.tensor.diagonal().tolist()) if moment == 0.0]


def describe_zero_moments(declared: DeclaredTensor) -> str:
    """Say which moments are zero where these are more than a rod has; empty otherwise."""
    zeros = _list_zero_moments(declared)
    names = join_names(TENSOR_NAMES[_DIAGONAL[i]] for i in zeros)
    return f"; {names} are 0, as if never filled in" if len(zeros) > 1 else ""
