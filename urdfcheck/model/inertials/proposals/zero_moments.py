"""Moments of zero: rounded, never filled in, or those of a point beside an axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term, list_half_units
from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor
from urdfcheck.model.robot import Model
from urdfcheck.source.text.handed_values import list_zero_sources

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A tensor is that of a point to within this share of its largest moment: four typed digits.
_OF_POINT = 1e-3
# Programs that round a moment (kg m²) keep more than two decimals.
_FEW_DECIMALS = 5e-3
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
    """Whether two moments were typed as 0 and not rounded: without decimals, beside one that no program rounds so, for 1e-6 is
    one of few decimals; or in properties and arguments, which no program writes."""
    texts = [declared.texts[place] for place in _DIAGONAL]
    handed = [i for i in _list_zero_moments(declared) if declared.get_attribute(_DIAGONAL[i]).collect_definitions()]
    if len(handed) == len(texts) - 1:
        return True
    return texts.count("0") == len(texts) - 1 and float(np.abs(declared.tensor.diagonal()).max()) >= _FEW_DECIMALS


def is_point_about_origin(declared: DeclaredTensor) -> bool:
    """Whether a tensor is the parallel-axis term of the link's mass at its COM: that of a point, about the link's origin, of
    which nothing is left about the COM. The products may have either sign, and a coordinate of the COM another decimal point."""
    com = _get_com_in_axes(declared)
    if com is None or not com.any():
        return False
    term = compute_parallel_axis_term(declared.inertial.mass or 0.0, com)
    off = float(np.abs(np.abs(declared.tensor) - np.abs(term)).max())
    return off <= _OF_POINT * float(np.abs(term).max()) or describe_slipped_point(declared) != ""


def describe_slipped_point(declared: DeclaredTensor) -> str:
    """Say which coordinate of the COM is a power of ten times that of the point whose tensor about the link's origin the link
    has; empty where the tensor is not that of such a point, or the COM is that point."""
    com, mass = _get_com_in_axes(declared), declared.inertial.mass
    if com is None or mass is None:
        return ""
    moments, axes = np.linalg.eigh(declared.tensor)
    if not moments[2] > 0.0 or max(abs(moments[0]), moments[2] - moments[1]) > _OF_POINT * moments[2]:
        return ""
    distance = float(np.sqrt(moments[2] / mass))
    point, typed = distance * np.abs(axes[:, 0]), np.abs(com)
    off = np.flatnonzero(np.abs(point - typed) > _OF_POINT * distance)
    # The other coordinates have to show that the point is meant.
    if len(off) != 1 or not typed[off[0]] > 0.0 or np.count_nonzero(np.delete(typed, off)) == 0:
        return ""
    index = int(off[0])
    power = float(np.log10(point[index] / typed[index])) if point[index] > 0.0 else 0.0
    if not round(power) or abs(power - round(power)) > _OF_POINT:
        return ""
    wanted = float(np.copysign(10.0 ** round(power) * typed[index], com[index]))
    return f"{'xyz'[index]} = {wanted:.6g}, not {com[index]:.6g}"


def _get_com_in_axes(declared: DeclaredTensor) -> Array | None:
    """Return the COM (3,) in the axes of the tensor; None where it is not known, or there is no mass."""
    matrix, mass = declared.inertial.origin.matrix, declared.inertial.mass
    if matrix is None or mass is None or not mass > 0.0:
        return None
    com: Array = matrix[:3, :3].T @ matrix[:3, 3]
    return com


def _list_zero_moments(declared: DeclaredTensor) -> list[int]:
    """List which of ixx, iyy and izz, as 0, 1 and 2, are zero."""
    return [i for i, moment in enumerate(declared.tensor.diagonal().tolist()) if moment == 0.0]


def describe_zero_moments(declared: DeclaredTensor) -> str:
    """Say which moments are zero where these are more than a rod has; empty otherwise."""
    zeros = _list_zero_moments(declared)
    names = join_names(TENSOR_NAMES[_DIAGONAL[i]] for i in zeros)
    sources = join_names(list_zero_moment_sources(declared))
    return f"; {names} are 0, as if never filled in{f' ({sources})' if sources else ''}" if len(zeros) > 1 else ""


def list_zero_moment_sources(declared: DeclaredTensor) -> list[str]:
    """List the properties and arguments that are 0, and from which moments of zero are computed."""
    return list_zero_sources(declared.get_attribute(_DIAGONAL[i]) for i in _list_zero_moments(declared))
