"""Slips that a tensor alone shows: products that were filled in, wrong signs, a decimal point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import build_inertia_tensor, compute_parallel_axis_term
from urdfcheck.facts.inertials.mistakes.tensor_slips import (
    TensorSlip,
    find_filled_products,
    find_moved_moment,
    find_slipped_moment,
    find_wrong_signs,
)
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor
from urdfcheck.model.inertials.proposals.inertial_texts import links_by_inertial_text
from urdfcheck.model.inertials.proposals.tensor_repairs import (
    SMALL_EXCESS,
    InertialProposal,
    is_possible_tensor,
    replace_tensor,
)
from urdfcheck.model.inertials.proposals.undone_mistakes import identify_mistake
from urdfcheck.model.parts import DeclaredTensor, Link
from urdfcheck.model.robot import Model

# In more links of one file, numbers that would fit with another decimal point have another cause in common.
_MOST_SLIPS = 2
# With the right signs the products are so near to the drawn part's, relative to these.
_NEAR_PRODUCTS = 0.5
# When the repair of a slip that the numbers show is right.
_SLIP_CONDITIONS = {
    "products_filled": "the products are placeholders",
    "slot_moved": "it was typed in the wrong place",
    "products_sign": "their signs are wrong",
    "one_sign": "its sign is wrong",
    "decimal": "its decimal point or exponent is wrong",
}


def propose_filled_products(declared: DeclaredTensor) -> InertialProposal | None:
    """Propose zero for products that were filled in; None where they were not."""
    slip = find_filled_products(declared.components, declared.texts)
    if slip is None:
        return None
    return _propose_slip(declared.link, slip, "{detail}: with products 0 the tensor is possible")


def propose_moved_moment(declared: DeclaredTensor) -> InertialProposal | None:
    """Propose the only product as the moment of zero beside it, never as an edit; None where that makes no possible tensor."""
    slip = find_moved_moment(declared.components)
    return None if slip is None else replace(_propose_slip(declared.link, slip, "{detail}"), edits=())


def propose_signs(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose other signs of products, as an edit only if the drawn part shows which; None where no signs help."""
    link, slip = declared.link, find_wrong_signs(declared.components, compute_drawn_tensor(model, declared))
    if slip is None:
        return None
    claim = "with the other sign of {detail} the tensor is possible"
    if slip.id == "products_sign" and _may_be_about_origin(model, declared, slip):
        return replace(_propose_slip(link, slip, claim), edits=(), cause=None)
    if slip.residual is None:
        proposal = _propose_slip(link, slip, claim)
        return replace(proposal, edits=(), remedy=f"compare the signs with those at the source: {proposal.remedy}")
    before, after = (f"{100 * share:.0f} %" for share in slip.residual)
    claim += f", and its products are {after} off the drawn part's instead of {before}"
    proposal = _propose_slip(link, slip, claim)
    is_lone = len(links_by_inertial_text(model)[declared.inertial.element.span]) == 1
    is_certain = slip.residual[1] < _NEAR_PRODUCTS and is_lone
    return proposal if is_certain else replace(proposal, edits=())


def propose_slipped_moment(model: Model, declared: DeclaredTensor) -> InertialProposal | None:
    """Propose another decimal point of one moment, never as an edit; None where none, or as many as no slip makes, seem to be
    wrong."""
    slip = _find_slipped_moment(model, declared)
    if slip is None or has_many_slips(model):
        return None
    claim = "with {detail} times what is written, the tensor is possible, and its moments are like the drawn part's"
    return replace(_propose_slip(declared.link, slip, claim), edits=())


def _find_slipped_moment(model: Model, declared: DeclaredTensor) -> TensorSlip | None:
    drawn = compute_drawn_tensor(model, declared)
    return (
        None if drawn is None or not drawn.diagonal().min() > 0.0 else find_slipped_moment(declared.components, drawn)
    )


@fact
def has_many_slips(model: Model) -> bool:
    """Whether a decimal point seems to have slipped in more than `_MOST_SLIPS` links with different numbers: not by a slip."""
    slipped = set()
    for declared in model.tensors:
        if is_possible_tensor(declared.tensor):
            continue
        is_decimal = identify_mistake(model, declared.link)[0] == "decimal_point"
        if is_decimal or _find_slipped_moment(model, declared) is not None:
            slipped.add(tuple(f"{value:.3g}" for value in sorted(declared.tensor.diagonal())))
    return len(slipped) > _MOST_SLIPS


def _may_be_about_origin(model: Model, declared: DeclaredTensor, slip: TensorSlip) -> bool:
    """Whether the tensor may also be one of positive notation: also about the link's origin, as CAD programs print it.

    Where the drawn part is known, it has to be nearer to that.
    """
    inertial = declared.inertial
    matrix = inertial.origin.matrix
    if inertial.mass is None or matrix is None or slip.components is None:
        return False
    flipped, lever = build_inertia_tensor(slip.components), matrix[:3, :3].T @ matrix[:3, 3]
    shift = compute_parallel_axis_term(inertial.mass, lever)
    if float(np.linalg.norm(shift)) < SMALL_EXCESS * float(np.linalg.norm(flipped)):
        return False
    if not is_possible_tensor(flipped - shift):
        return False
    drawn = compute_drawn_tensor(model, declared)
    return drawn is None or float(np.linalg.norm(flipped - shift - drawn)) < float(np.linalg.norm(flipped - drawn))


def _propose_slip(link: Link, slip: TensorSlip, claim: str) -> InertialProposal:
    change = None if slip.components is None else replace_tensor(link, slip.components)
    edits, words = ((), "") if change is None or not change.text else (change.edits, change.words)
    return InertialProposal(
        edits,
        f"; {claim.format(detail=slip.detail)}",
        f"write {words} if {_SLIP_CONDITIONS[slip.id]}; otherwise " if words else "",
        cause=slip.id,
        detail=slip.detail,
    )
