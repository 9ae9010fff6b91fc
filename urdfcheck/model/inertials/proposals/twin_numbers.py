"""The numbers of the link on the other side, where mass and COM are the same and one number of the tensor is all that differs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import build_inertia_tensor, list_inertia_components
from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal, is_possible_tensor
from urdfcheck.model.likeness.declared_inertials import estimate_from_twin, read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor, Link
from urdfcheck.model.repairs.number_text import write_numbers
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Two exports of one part agree in the mass and, relative to the largest moment, in each number to this share, and in the COM to
# this share of the radius of gyration.
_SAME, _SAME_PLACE = 0.01, 0.02
# What products of rotation matrices leave of a zero, and the factor up to which a motor or a screw explains a moment.
_ROUNDING, _SIMILAR = 1e-6, 2.0


def propose_twin_number(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose the one number in which an impossible tensor differs from the mirror image of its twin's; None where there is no
    such twin."""
    own, twin = read_declared_inertial(declared.link), find_agreeing_twin(model, declared.link)
    if own is None or twin is None:
        return None
    name, image = twin
    wanted = list_inertia_components(own.rotation.T @ image.inertia @ own.rotation)
    largest = max(abs(wanted[i]) for i in (0, 3, 5))
    off = [i for i, value in enumerate(wanted) if abs(value - declared.components[i]) > _SAME * largest]
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
    try:
        pairs = [pair for pair in mirror_pairs(model) if link.name in {pair.one, pair.other}]
    except FactUnavailableError:
        return None
    for pair in pairs:
        image = None if own is None else estimate_from_twin(model, link, [pair])
        if own is None or image is None or abs(image.mass - own.mass) > _SAME * own.mass:
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
