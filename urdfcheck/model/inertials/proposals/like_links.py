"""The tensor of a link of the same mass and shape, where one number is all that differs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.mirror import measure_outline_mismatch
from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal, is_possible_tensor
from urdfcheck.model.likeness.shape_comparison import ALIKE, get_outline, is_comparable
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

# Numbers that were typed alike.
_SAME = 1e-9


def propose_like_link(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose the one number in which an impossible tensor differs from those of links that weigh and draw the same; None where
    there is no such link, or they do not agree."""
    like: dict[tuple[int, float], list[DeclaredTensor]] = {}
    for other in model.tensor_by_name.values():
        index = _find_only_difference(declared.components, other.components)
        if index is not None and is_possible_tensor(other.tensor) and _is_same_part(model, declared, other):
            like.setdefault((index, other.components[index]), []).append(other)
    if len(like) != 1:
        return None
    ((index, _), others), = like.items()  # fmt: skip
    names, text = join_names(other.link.name for other in others), f'{TENSOR_NAMES[index]}="{others[0].texts[index]}"'
    have = "has" if len(others) == 1 else "have"
    return InertialProposal(
        message=f"; {names}, of the same mass and shape, {have} {text} and all other numbers alike",
        remedy=f"write {text} as in {names}, or ",
        is_located=True,
    )


def _find_only_difference(one: Sequence[float], other: Sequence[float]) -> int | None:
    off = [i for i, (a, b) in enumerate(zip(one, other, strict=True)) if not math.isclose(a, b, rel_tol=_SAME)]
    return off[0] if len(off) == 1 else None


def _is_same_part(model: Model, one: DeclaredTensor, other: DeclaredTensor) -> bool:
    """Whether two links have one mass and one inertial frame, and draw one thing in one place."""
    if one.inertial.mass is None or other.inertial.mass is None:
        return False
    poses = one.inertial.origin.matrix, other.inertial.origin.matrix
    if not math.isclose(one.inertial.mass, other.inertial.mass, rel_tol=_SAME) or poses[0] is None or poses[1] is None:
        return False
    outlines = [get_outline(model, tensor.link.name) for tensor in (one, other)]
    if outlines[0] is None or outlines[1] is None or not is_comparable(model, one.link.name, other.link.name):
        return False
    mismatch = measure_outline_mismatch(outlines[0], outlines[1], linear=np.eye(3), shift=np.zeros(3))
    return bool(np.abs(poses[0] - poses[1]).max() < _SAME) and mismatch < ALIKE
