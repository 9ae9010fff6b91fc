"""Which tensor should replace one that no body can have, by what is known of the mistake."""

from __future__ import annotations

from urdfcheck.facts.inertials.inertia_tensor import measure_tensor_rounding
from urdfcheck.facts.inertials.mistakes.tensor_slips import find_nearest_tensor, find_repeated_slot
from urdfcheck.model.inertials.habits.tensor_units import find_tensor_unit
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.proposals.drawn_inertials import (
    is_drawn_and_rounded,
    is_drawn_otherwise,
    propose_drawn_inertial,
)
from urdfcheck.model.inertials.proposals.like_links import (
    propose_like_link,
    propose_lost_moment,
    propose_twin_number,
)
from urdfcheck.model.inertials.proposals.mistake_names import name_mistake
from urdfcheck.model.inertials.proposals.nearest_tensors import propose_nearest
from urdfcheck.model.inertials.proposals.slip_repairs import (
    has_many_slips,
    propose_filled_products,
    propose_moved_moment,
    propose_signs,
    propose_slipped_moment,
)
from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal, is_possible_tensor
from urdfcheck.model.inertials.proposals.tensor_sizes import (
    describe_spread_beyond_robot,
    has_drawn_moment,
    is_unlike_drawn,
    propose_other_size,
)
from urdfcheck.model.inertials.proposals.undone_mistakes import propose_undo
from urdfcheck.model.inertials.proposals.zero_moments import describe_zero_moments, has_bare_zeros, has_lost_moment
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model

# Where the nearest possible tensor changes more, nothing can be learned from the author's numbers.
_LARGEST_CHANGE = 0.1
# Where ixy, ixz and iyz are in the six numbers.
_PRODUCTS = (1, 2, 4)
# A tensor that was typed with too few digits gets so many more.
_MORE_DIGITS = 2
# Causes of INR009 that the pages of INR003 and INR004 have as well, with their ids there.
_SHARED_CAUSES = {
    "products_sign": "products_sign",
    "one_sign": "one_sign",
    "rounded": "digits",
    "decimal_point": "decimal",
}


def propose_repair(model: Model, link: Link) -> InertialProposal:
    """Propose the smallest change that makes an inertia tensor possible, by what is known of the mistake.

    In this order: products that were filled in; the one mistake that explains the numbers, by the drawn part or a twin; the only
    number in which a link of the same mass and shape, or the one on the other side, differs; a moment of zero in numbers that
    another link has, or beside the only product; other signs of the products; where
    little is missing, or the digits are too few, the nearest tensor that a body can have, about the author's own COM, unless the
    drawn part's is far from it, or the robot is shorter than such a body. Only then the inertia of the drawn part.
    """
    declared = model.tensor_by_name.get(link.name)
    if declared is None:
        return InertialProposal()
    filled = propose_filled_products(declared)
    if filled is not None:
        return filled
    undone = _propose_diagnosed_undo(model, link)
    if undone is not None and not (undone.cause == "decimal" and has_many_slips(model)):
        return undone
    like = (
        propose_like_link(model, declared)
        or propose_twin_number(model, declared)
        or propose_lost_moment(model, declared)
    )
    if like is not None:
        return like
    typed = measure_tensor_rounding(declared.texts)
    is_rounded = typed.explained_by_rounding and not has_lost_moment(model, declared) and not has_bare_zeros(declared)
    moved = propose_moved_moment(declared)
    if moved is not None:
        return moved
    slip = None if is_rounded else propose_signs(model, declared) or propose_slipped_moment(model, declared)
    if slip is not None:
        return slip
    repeated = find_repeated_slot(declared.texts)
    if repeated is not None:
        return InertialProposal(
            message=f"; {repeated.detail} digit for digit", cause=repeated.id, detail=repeated.detail
        )
    unit = find_tensor_unit(model)
    if unit is not None:
        # The unit does not make it possible: its proportions are wrong too.
        remedy = f"{unit.remedy}; that leaves this tensor impossible: "
        return InertialProposal(message=f"; {unit.evidence}", remedy=remedy)
    other_size = propose_other_size(model, declared)
    if other_size is not None:
        return other_size
    if far := describe_spread_beyond_robot(model, declared):
        return InertialProposal(message=far)
    change = find_nearest_tensor(declared.components)[1]
    is_near = (
        change < _LARGEST_CHANGE and not is_unlike_drawn(model, declared) and not has_drawn_moment(model, declared)
    )
    # A product of one digit rounds so many tensors that it shows no cause: it may be in the wrong place.
    has_products = any(declared.components[i] for i in _PRODUCTS)
    is_from_afar = not has_products and not is_drawn_otherwise(model, declared)
    if is_rounded and (is_near or is_from_afar or is_drawn_and_rounded(model, declared)):
        return propose_nearest(declared, "digits", digits=typed.typed_digits + _MORE_DIGITS)
    if is_near:
        return propose_nearest(declared, None)
    return propose_drawn_inertial(model, link, describe_zero_moments(declared))


def _propose_diagnosed_undo(model: Model, link: Link) -> InertialProposal | None:
    """Propose the single edit that makes an inertial possible and equal to that of the drawn part or of its twin; None where no
    mistake is certain."""
    diagnosed = inertial_diagnoses(model).get(link.name)
    change = propose_undo(model, link)
    if diagnosed is None or change is None:
        return None
    diagnosis, mended = diagnosed.diagnosis, diagnosed.diagnosis.mended
    if mended is None or not is_possible_tensor(mended.tensor):
        return None
    reference = "the drawn part" if diagnosis.judged_by == "mesh" else f"its twin {', '.join(diagnosed.twins)}"
    mistake = name_mistake(diagnosis.cause or "")
    claim = f"undoing one mistake ({mistake}) makes the tensor possible and close to that of {reference}"
    if diagnosis.unique:
        claim = f"one edit ({mistake}) makes the tensor that of {reference}, and no other single edit does"
    return InertialProposal(
        change.edits,
        f"; {claim}",
        f"write {change.words}, or ",
        cause=_SHARED_CAUSES.get(diagnosis.cause or ""),
        detail=diagnosis.detail,
    )
