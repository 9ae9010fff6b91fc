"""What a link of the same mass and shape, or the one on the other side, shows of a tensor: that one number differs, or that
none was filled in."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import build_inertia_tensor, list_inertia_components
from urdfcheck.facts.likeness.mirror import measure_outline_mismatch
from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal, is_possible_tensor
from urdfcheck.model.likeness.declared_inertials import estimate_from_twin, read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.likeness.shape_comparison import ALIKE, get_outline, is_comparable
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor, Link
from urdfcheck.model.repairs.number_text import write_numbers
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from urdfcheck.facts.arrays import Array

# Where the moments are in ``ixx ixy ixz iyy iyz izz``.
_DIAGONAL = (0, 3, 5)
# Numbers that were typed alike.
_SAME = 1e-9
# Two exports of one part agree in the mass and, relative to the largest moment, in each number to this share, and in the COM to
# this share of the radius of gyration (chosen).
_SAME_EXPORT, _SAME_PLACE = 0.01, 0.02
# What products of rotation matrices leave of a zero, and the factor up to which a motor or a screw explains a moment (chosen).
_ROUNDING, _SIMILAR = 1e-6, 2.0


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


def propose_lost_moment(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose the moment of links that have all other numbers of a tensor with one moment of zero: it was copied, and the number
    lost; None where there is no such link, the links do not agree, or the numbers have no product by which to know them."""
    zeros = [i for i in _DIAGONAL if declared.components[i] == 0.0]
    if len(zeros) != 1 or not any(declared.components[i] for i in range(len(TENSOR_NAMES)) if i not in _DIAGONAL):
        return None
    (index,) = zeros
    others = [
        other
        for other in model.tensor_by_name.values()
        if _find_only_difference(declared.components, other.components) == index and is_possible_tensor(other.tensor)
    ]
    if len({other.components[index] for other in others}) != 1:
        return None
    names, text = join_names(other.link.name for other in others), f'{TENSOR_NAMES[index]}="{others[0].texts[index]}"'
    mass = declared.inertial.mass or 0.0
    is_same_mass = all(math.isclose(other.inertial.mass or 0.0, mass, rel_tol=_SAME) for other in others)
    have = "has" if len(others) == 1 else "have"
    return InertialProposal(
        message=f"; {names} {have} {text} and all other numbers alike",
        remedy=f"write {text} as in {names}{', or ' if is_same_mass else '; better, as the masses differ, '}",
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


def propose_twin_number(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose the one number in which an impossible tensor differs from the mirror image of its twin's; None where there is no
    such twin."""
    own, twin = read_declared_inertial(declared.link), find_agreeing_twin(model, declared.link)
    if own is None or twin is None:
        return None
    name, image = twin
    wanted = list_inertia_components(own.rotation.T @ image.inertia @ own.rotation)
    largest = max(abs(wanted[i]) for i in (0, 3, 5))
    off = [i for i, value in enumerate(wanted) if abs(value - declared.components[i]) > _SAME_EXPORT * largest]
    if len(off) != 1:
        return None
    index = off[0]
    mended = [wanted[i] if i == index else value for i, value in enumerate(declared.components)]
    if not is_possible_tensor(build_inertia_tensor(mended)):
        return None
    text = f'{TENSOR_NAMES[index]}="{_write_number(model, name, index, wanted[index])}"'
    return InertialProposal(
        message=f"; {name} on the other side has {text}, and apart from signs about the same other numbers",
        remedy=f"write {text}, the number of {name}, or ",
        is_located=True,
    )


def describe_zero_by_twin(model: Model, declared: DeclaredTensor, uniform: Array | None, *, drawn: str) -> str:
    """Describe the repair of a zero tensor where the link on the other side, of the same mass, has one: its numbers, or those of
    both where they are far from the ``uniform`` ones (3, 3) of what the link draws, in words ``drawn``. Empty where there is no
    such twin."""
    own, twin = read_declared_inertial(declared.link), find_agreeing_twin(model, declared.link)
    if own is None or twin is None or not is_possible_tensor(twin[1].tensor):
        return ""
    name, image = twin
    wanted = list_inertia_components(own.rotation.T @ image.inertia @ own.rotation)
    largest = max(map(abs, wanted))
    kept = [value if abs(value) > _ROUNDING * largest else 0.0 for value in wanted]
    text = " ".join(f'{axis}="{value:.6g}"' for axis, value in zip(TENSOR_NAMES, kept, strict=True) if value)
    moments = [] if uniform is None else [np.linalg.eigvalsh(one) for one in (image.tensor, uniform)]
    factor = float(np.exp(np.abs(np.log(moments[0] / moments[1])).max())) if moments and moments[0][0] > 0.0 else 1.0
    if factor < _SIMILAR:
        return f"write {text} as in {name} on the other side"
    return (
        f"compute the tensors of both sides again, as the known ones are up to {factor:.2g}-fold apart: {name}, of the same mass,"
        f" has {text}, and what {declared.link.name} draws {drawn}"
    )


def has_com_of_twin(model: Model, link: Link) -> bool:
    """Whether mass and COM of a link, which were filled in, are the mirror image of its twin's, which were typed apart: then the
    COM is meant."""
    own, twin = read_declared_inertial(link), find_agreeing_twin(model, link)
    if own is None or twin is None or link.inertial is None or not own.com.any():
        return False
    other = model.link_by_name[twin[0]].inertial
    typed = [None if one is None else one.origin.get_attribute("xyz") for one in (link.inertial, other)]
    return typed[0] is None or typed[1] is None or typed[0].span != typed[1].span


def find_agreeing_twin(model: Model, link: Link) -> tuple[str, DeclaredInertial] | None:
    """Find the link on the other side with the same mass and the mirrored COM, and its numbers in this link's frame; None where
    there is none."""
    own = read_declared_inertial(link)
    if own is None:
        return None
    try:
        pairs = [pair for pair in mirror_pairs(model) if link.name in {pair.one, pair.other}]
    except FactUnavailableError:
        return None
    for pair in pairs:
        image = estimate_from_twin(model, link, [pair])
        if image is None or abs(image.mass - own.mass) > _SAME_EXPORT * own.mass:
            continue
        size = float(np.sqrt(max(0.0, float(np.trace(image.tensor))) / (2.0 * image.mass)))
        if float(np.linalg.norm(image.com - own.com)) <= _SAME_PLACE * size:
            return (pair.other if pair.one == link.name else pair.one), image
    return None


def _write_number(model: Model, twin: str, index: int, value: float) -> str:
    """Write a number with the digits of the twin's, if it is that number apart from its sign."""
    known = model.tensor_by_name.get(twin)
    typed = "" if known is None else known.texts[index]
    if known is None or not np.isclose(abs(known.components[index]), abs(value), rtol=1e-9, atol=0.0):
        return write_numbers(typed, [value], digits=6)
    digits = typed.strip().lstrip("+-")
    return f"-{digits}" if value < 0.0 else digits
