"""Which other numbers an ``<inertial>`` should have: its own without a mistake, or those of the drawn part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Edit, Span
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.certainty import EXACT
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import (
    build_inertia_tensor,
    check_inertia_validity,
    compute_parallel_axis_term,
    compute_solid_inertia,
    list_half_units,
    measure_tensor_rounding,
)
from urdfcheck.facts.inertials.materials import DENSEST_PART, LIGHTEST
from urdfcheck.facts.inertials.mistakes.tensor_slips import (
    TensorSlip,
    find_filled_products,
    find_nearest_tensor,
    find_repeated_slot,
    find_slipped_moment,
    find_wrong_signs,
)
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.habits.tensor_units import find_tensor_unit
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor, Link
from urdfcheck.model.repairs.inertial_edits import InertialRepair, build_inertial_repair
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, has_loose_hull, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import VisualGeometry
    from urdfcheck.facts.inertials.diagnosis import Diagnosis
    from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial

# Causes after which the file does not show which number is right, or whose numbers come from the mesh.
_UNDECIDED_CAUSES = frozenset(
    {"other_mass", "one_piece", "shell", "bounding_box", "convex_hull", "com_missing", "mesh_scale"}
)
# Units: all links of a file have the same.
_UNIT_CAUSES = frozenset({"inertia_unit", "mass_unit", "com_unit", "units"})
# The undone mistake must leave no more than this part of the mismatch, and no more than lumps of a third of the mass make.
_REMAINING, LARGEST_SOUND_MISMATCH = 0.3, 0.75
# Another decimal point brings one number near the part's by chance: of 1,200 lumped parts of which one moment was multiplied by
# any factor from 1/2000 to 2000, 12 % fit one with a mismatch below 0.75, and 2.4 % below 0.3; of those with a slip 57 % do.
_LONE_NUMBER = 0.3
# A COM that is moved must get nearer to the drawn part's than this part of its distance, or of the part's size.
_FAR_COM = 0.1
# A COM is that of a shell within this part of its radius of gyration.
_SAME_COM = 0.05
# A tensor is about another point where the COM is half a radius of gyration away.
_APART = 0.5
# The nearest possible tensor is offered as an edit without a cause where it changes less than mass properties are known by.
_NEGLIGIBLE_CHANGE = 5e-3
# Where the nearest possible tensor changes more, nothing can be learned from the author's numbers.
_LARGEST_CHANGE = 0.1
# What a mesh leaves of a product that is zero, relative to the largest moment.
_MESH_NOISE = 1e-3
# Significant digits of numbers that a uniform density gives.
_GUESSED_DIGITS = 4

# A flat part's tensor that was typed with three digits may miss the triangle inequality by this share of its largest moment.
TRIANGLE_SLACK = 5e-3
# A tensor whose digits are too few gets the nearest possible one as an edit where it changes less than this part.
SMALL_EXCESS = 0.05
# A tensor that was typed with too few digits gets so many more.
_MORE_DIGITS = 2
# The moments of all mass at twice the drawn part's size exceed those of any part like it: no small change makes a tensor right
# that has more.
_OTHER_SIZE = 1.0
# In more links of one file, numbers that would fit with another decimal point have another cause in common.
_MOST_SLIPS = 2
# Where the moments are in ``ixx ixy ixz iyy iyz izz``.
_DIAGONAL = (0, 3, 5)
# With the right signs the products are so near to the drawn part's, relative to these.
_NEAR_PRODUCTS = 0.5

# Causes of INR009 that the pages of INR003 and INR004 have as well, with their ids there.
_SHARED_CAUSES = {
    "products_sign": "products_sign",
    "one_sign": "one_sign",
    "rounded": "digits",
    "decimal_point": "decimal",
}
# When the repair of a slip that the numbers show is right.
_SLIP_CONDITIONS = {
    "products_filled": "the products are placeholders",
    "products_sign": "their signs are wrong",
    "one_sign": "its sign is wrong",
    "decimal": "its decimal point or exponent is wrong",
}
# Mistakes whose names say too little in a headline; the others are named by their ids.
_MISTAKE_NAMES = {
    "about_origin": "tensor about the origin",
    "axes_permuted": "axes of the tensor",
    "com_missing": "COM left at zero",
    "com_unit": "unit of the COM",
    "diagonal_first": "order of the numbers",
    "inertia_unit": "unit of the tensor",
    "mass_unit": "unit of the mass",
    "one_piece": "one piece only",
    "one_sign": "one sign",
    "own_missing": "own tensors of the pieces left out",
    "positive_notation": "tensor about the origin, with products of the other sign",
    "products_sign": "signs of the products",
    "rounded": "rounding",
    "row_major": "order of the numbers",
    "rpy_missing": "rpy left out",
    "rpy_twice": "rpy applied twice",
    "slots_shifted": "shifted numbers",
    "slots_swapped": "swapped numbers",
    "steiner_missing": "parallel-axis theorem left out",
    "steiner_twice": "parallel-axis theorem applied twice",
    "unmirrored": "not mirrored",
    "wrong_formula": "formula of another solid",
}


@dataclass(frozen=True, slots=True, eq=False)
class InertialProposal:
    """The repair of an inertial that cannot be right; empty where nothing is known."""

    edits: tuple[Edit, ...] = ()
    message: str = ""
    """What a message says about it, starting with its semicolon."""
    remedy: str = ""
    """How the advice begins."""
    cause: str | None = None
    """The id of the cause on the pages of INR003 and INR004, where the numbers show one."""
    detail: str = ""
    """The parameter of the cause."""
    oversize: str = ""
    """How many times the drawn part's moments these are, if no part of the drawn size can have them; empty otherwise."""


def name_mistake(cause: str) -> str:
    """Return a cause of INR009 in two or three words."""
    return _MISTAKE_NAMES.get(cause, cause.replace("_", " "))


def describe_mistake(cause: str, detail: str) -> str:
    """Name a cause of INR009 in a few words, with its ``detail``."""
    name = name_mistake(cause)
    return f"{name}: {detail}{' times' if cause == 'decimal_point' else ''}" if detail else name


def propose_repair(model: Model, link: Link) -> InertialProposal:
    """Propose the smallest change that makes an inertia tensor possible, by what is known of the mistake.

    In this order: products that were filled in; the one mistake that explains the numbers, by the drawn part or a twin; other
    signs of the products; where little is missing, or the digits are too few, the nearest tensor that a body can have, about the
    author's own COM. Only then the inertia of the drawn part.
    """
    declared = model.tensor_by_name.get(link.name)
    if declared is None:
        return InertialProposal()
    filled = find_filled_products(declared.components, declared.texts)
    if filled is not None:
        return _propose_slip(link, filled, "{detail}: with products 0 the tensor is possible")
    undone = _propose_diagnosed_undo(model, link)
    if undone is not None and not (undone.cause == "decimal" and has_many_slips(model)):
        return undone
    typed = measure_tensor_rounding(declared.texts)
    is_rounded = typed.explained_by_rounding and not _has_lost_moment(model, declared)
    slip = None if is_rounded else _find_sign_slip(model, declared)
    if slip is not None:
        return _propose_signs(model, link, slip)
    slipped = None if is_rounded else _find_slipped_moment(model, declared)
    if slipped is not None and not has_many_slips(model):
        claim = "with {detail} times what is written, the tensor is possible, and its moments are like the drawn part's"
        return replace(_propose_slip(link, slipped, claim), edits=())
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
    excess = _measure_size_excess(model, declared)
    if excess > _OTHER_SIZE:
        drawn = describe_drawn_inertial(model, link)
        times, least = _format_factor(_compare_with_drawn(model, declared)), _format_factor(excess)
        claim = f"; for this mass the moments are {times} times the drawn part's, and at least {least} times what its size allows"
        return InertialProposal(message=claim, remedy=f"write {drawn}, or " if drawn else "", oversize=times)
    if is_rounded:
        return _propose_nearest(link, declared, "digits", digits=typed.typed_digits + _MORE_DIGITS)
    if find_nearest_tensor(declared.components)[1] < _LARGEST_CHANGE:
        return _propose_nearest(link, declared, None)
    drawn = describe_drawn_inertial(model, link)
    return InertialProposal(message=_describe_zero_moments(declared), remedy=f"write {drawn}, or " if drawn else "")


def _has_lost_moment(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a moment of zero was not rounded to it: the drawn part's is above a unit of the last place of the others."""
    zeros = _list_zero_moments(declared)
    drawn = _compute_drawn_tensor(model, declared) if zeros else None
    if drawn is None:
        return False
    place = 2.0 * max(list_half_units(declared.texts))
    return any(float(drawn[i, i]) > place for i in zeros)


def _list_zero_moments(declared: DeclaredTensor) -> list[int]:
    """List which of ixx, iyy and izz, as 0, 1 and 2, are zero."""
    return [i for i, moment in enumerate(declared.tensor.diagonal().tolist()) if moment == 0.0]


def _describe_zero_moments(declared: DeclaredTensor) -> str:
    """Say which moments are zero where these are more than a rod has; empty otherwise."""
    zeros = _list_zero_moments(declared)
    names = join_names(TENSOR_NAMES[_DIAGONAL[i]] for i in zeros)
    return f"; {names} are 0, as if never filled in" if len(zeros) > 1 else ""


def _measure_size_excess(model: Model, declared: DeclaredTensor) -> float:
    """Return how many times the moments exceed those of the link's mass at twice the drawn part's size from the COM; zero where
    nothing is drawn."""
    drawn, mass = measure_link_geometry(model, declared.link), declared.inertial.mass
    if drawn is None or mass is None or not mass > 0.0:
        return 0.0
    farthest = 2.0 * measure_extent(drawn.points)
    most = 2.0 * mass * farthest * farthest  # ∫ r² dm is half the sum of the moments
    return float(np.trace(declared.tensor)) / most if most > 0.0 else 0.0


def _compare_with_drawn(model: Model, declared: DeclaredTensor) -> float:
    """Return how many times the moments are those of what the link draws, at its mass; infinite where that has none."""
    drawn = _compute_drawn_tensor(model, declared)
    size = 0.0 if drawn is None else float(np.trace(drawn))
    return float(np.trace(declared.tensor)) / size if size > 0.0 else np.inf


def _format_factor(factor: float) -> str:
    rounded = float(f"{factor:.2g}")
    return f"{rounded:,.0f}" if 100.0 <= rounded < 1e6 else f"{rounded:g}"


def _propose_diagnosed_undo(model: Model, link: Link) -> InertialProposal | None:
    """Propose the single edit that makes an inertial possible and equal to that of the drawn part or of its twin; None where no
    mistake is certain."""
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,  # heavy, and needed for wrong inertials only
    )

    diagnosed = inertial_diagnoses(model).get(link.name)
    change = propose_undo(model, link)
    if diagnosed is None or change is None or diagnosed.diagnosis.mended is None:
        return None
    diagnosis = diagnosed.diagnosis
    possible = check_inertia_validity(diagnosed.diagnosis.mended.tensor, TRIANGLE_SLACK)
    if not (possible.positive_definite and possible.triangle_inequality):
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


def _find_sign_slip(model: Model, declared: DeclaredTensor) -> TensorSlip | None:
    return find_wrong_signs(declared.components, _compute_drawn_tensor(model, declared))


def _find_slipped_moment(model: Model, declared: DeclaredTensor) -> TensorSlip | None:
    drawn = _compute_drawn_tensor(model, declared)
    return (
        None if drawn is None or not drawn.diagonal().min() > 0.0 else find_slipped_moment(declared.components, drawn)
    )


@fact
def has_many_slips(model: Model) -> bool:
    """Whether a decimal point seems to have slipped in more than `_MOST_SLIPS` links with different numbers: not by a slip."""
    slipped = set()
    for declared in model.tensors:
        validity = check_inertia_validity(declared.tensor, TRIANGLE_SLACK)
        if validity.positive_definite and validity.triangle_inequality:
            continue
        is_decimal = _identify_mistake(model, declared.link)[0] == "decimal_point"
        if is_decimal or _find_slipped_moment(model, declared) is not None:
            slipped.add(tuple(f"{value:.3g}" for value in sorted(declared.tensor.diagonal())))
    return len(slipped) > _MOST_SLIPS


def _compute_drawn_tensor(model: Model, declared: DeclaredTensor) -> Mat3 | None:
    """Compute the tensor (3, 3) of what the link draws, at its mass and in the axes of its inertial."""
    inertial, drawn = declared.inertial, measure_link_geometry(model, declared.link)
    matrix = inertial.origin.matrix
    if drawn is None or matrix is None or inertial.mass is None or not inertial.mass > 0:
        return None
    rotation = matrix[:3, :3]
    tensor: Mat3 = rotation.T @ compute_solid_inertia(drawn.solid, inertial.mass) @ rotation
    return tensor


def _propose_signs(model: Model, link: Link, slip: TensorSlip) -> InertialProposal:
    """Propose other signs of products; as an edit only if the drawn part shows which."""
    claim = "with the other sign of {detail} the tensor is possible"
    if slip.id == "products_sign" and _may_be_about_origin(model, link, slip):
        return replace(_propose_slip(link, slip, claim), edits=(), cause=None)
    if slip.residual is None:
        proposal = _propose_slip(link, slip, claim)
        return replace(proposal, edits=(), remedy=f"compare the signs with the CAD program's: {proposal.remedy}")
    before, after = (f"{100 * share:.0f} %" for share in slip.residual)
    claim += f", and its products are {after} off the drawn part's instead of {before}"
    proposal = _propose_slip(link, slip, claim)
    text = None if link.inertial is None else link.inertial.element.span
    is_certain = slip.residual[1] < _NEAR_PRODUCTS and len(_links_by_inertial_text(model)[text]) == 1
    return proposal if is_certain else replace(proposal, edits=())


def _may_be_about_origin(model: Model, link: Link, slip: TensorSlip) -> bool:
    """Whether the tensor may also be one of positive notation: also about the link's origin, as CAD programs print it.

    Where the drawn part is known, it has to be nearer to that.
    """
    inertial = link.inertial
    matrix = None if inertial is None else inertial.origin.matrix
    if inertial is None or inertial.mass is None or matrix is None or slip.components is None:
        return False
    flipped, lever = build_inertia_tensor(slip.components), matrix[:3, :3].T @ matrix[:3, 3]
    shift = compute_parallel_axis_term(inertial.mass, lever)
    if float(np.linalg.norm(shift)) < SMALL_EXCESS * float(np.linalg.norm(flipped)):
        return False
    possible = check_inertia_validity(flipped - shift, TRIANGLE_SLACK)
    if not (possible.positive_definite and possible.triangle_inequality):
        return False
    drawn = _compute_drawn_tensor(model, model.tensor_by_name[link.name])
    return drawn is None or float(np.linalg.norm(flipped - shift - drawn)) < float(np.linalg.norm(flipped - drawn))


def _propose_slip(link: Link, slip: TensorSlip, claim: str) -> InertialProposal:
    change = None if slip.components is None else _replace_tensor(link, slip.components)
    edits, words = ((), "") if change is None or not change.text else (change.edits, change.words)
    return InertialProposal(
        edits,
        f"; {claim.format(detail=slip.detail)}",
        f"write {words} if {_SLIP_CONDITIONS[slip.id]}; otherwise " if words else "",
        cause=slip.id,
        detail=slip.detail,
    )


def _propose_nearest(link: Link, declared: DeclaredTensor, cause: str | None, *, digits: int = 6) -> InertialProposal:
    """Propose the nearest tensor that a body can have, about the author's own COM, with so few digits that it is still one."""
    components, change = find_nearest_tensor(declared.components, thickness=10.0 ** (1 - min(digits, 6)))
    nearest = _replace_tensor(link, components, digits=min(digits, 6))
    if nearest is None or not nearest.text:
        return InertialProposal()
    edits = nearest.edits if change < (SMALL_EXCESS if cause else _NEGLIGIBLE_CHANGE) else ()
    words = replace(nearest, edits=edits).words
    remedy = f"write {words}, the nearest possible tensor ({100 * change:.2g} % off), or better "
    return InertialProposal(edits, "", remedy, cause=cause)


def _replace_tensor(link: Link, components: Sequence[float], digits: int = 6) -> InertialRepair | None:
    """Build the change of the tensor alone."""
    inertial = link.inertial
    matrix = None if inertial is None else inertial.origin.matrix
    if inertial is None or inertial.mass is None or matrix is None:
        return None
    com, rotation = matrix[:3, 3], matrix[:3, :3]
    tensor = build_inertia_tensor(components)
    wanted = DeclaredInertial(mass=inertial.mass, com=com, tensor=tensor, rotation=rotation)
    return build_inertial_repair(inertial, wanted, digits)


def propose_undo(model: Model, link: Link) -> InertialRepair | None:
    """Propose what undoes the mistake that was found in a link's inertial.

    None where no mistake is certain, or it is not in the inertial. Without edits where the evidence is weak, and where a macro
    wrote the same text for other links, in which this mistake was not found.
    """
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,  # heavy, and needed for wrong inertials only
    )

    diagnosed, inertial = inertial_diagnoses(model).get(link.name), link.inertial
    if diagnosed is None or inertial is None or diagnosed.diagnosis.mended is None:
        return None
    if diagnosed.diagnosis.cause == "shell" and has_com_of_shell(model, link):
        return None  # the part may be hollow: then all of its numbers are right
    change = build_inertial_repair(inertial, diagnosed.diagnosis.mended)
    if not change.text or _leaves_com_off(model, link, diagnosed):
        return None
    is_certain = (
        not diagnosed.diagnosis.com_order  # two mistakes, and only the numbers of one of them are proven
        and is_evident(diagnosed.diagnosis)
        and _has_same_mistake(model, inertial.element.span)
        and not _contradicts_twins(model, diagnosed)
        and not _is_lone_unit(model, diagnosed)
        and not _is_of_either_side(model, link, diagnosed)
    )
    return change if is_certain else replace(change, edits=())


def has_com_of_shell(model: Model, link: Link) -> bool:
    """Whether the COM, which is not that of what the link draws as a solid, is that of its thin, hollow shell."""
    drawn, matrix = measure_link_geometry(model, link), None if link.inertial is None else link.inertial.origin.matrix
    if drawn is None or drawn.shell is None or matrix is None:
        return False
    size = float(np.sqrt(np.trace(drawn.shell.covariance)))
    far, near = (float(np.linalg.norm(matrix[:3, 3] - one.com)) for one in (drawn.solid, drawn.shell))
    return near < _SAME_COM * size < far


def _leaves_com_off(model: Model, link: Link, diagnosed: DiagnosedInertial) -> bool:
    """Whether a repair moves the COM to a place that is far from the drawn part's and not much nearer, or farther than before."""
    drawn, mended = measure_link_geometry(model, link), diagnosed.diagnosis.mended
    if drawn is None or mended is None or diagnosed.diagnosis.judged_by != "mesh":
        return False
    before, after = (float(np.linalg.norm(com - drawn.solid.com)) for com in (diagnosed.declared.com, mended.com))
    is_moved = float(np.linalg.norm(mended.com - diagnosed.declared.com)) > 0.0
    is_worse = drawn.closed and after > before
    return is_moved and (is_worse or after > _FAR_COM * max(before, measure_extent(drawn.points)))


def is_evident(diagnosis: Diagnosis) -> bool:
    """Whether the named mistake is so certain that undoing it is offered as an edit.

    It is where the numbers without it are those of the drawn part or the twin. Otherwise it must be the mistake that makes most
    of the mismatch, and leave a part that may well be; a decimal point of the tensor has to leave one that is nearly uniform.
    """
    if diagnosis.cause in _UNDECIDED_CAUSES:
        return False
    if diagnosis.unique or diagnosis.judged_by == "twin":
        return True
    before, after = diagnosis.tensor_mismatch, diagnosis.mended_tensor_mismatch
    if diagnosis.mended_com_mismatch != diagnosis.com_mismatch:
        before, after = max(before, diagnosis.com_mismatch), max(after, diagnosis.mended_com_mismatch)
    is_of_tensor = diagnosis.cause == "decimal_point" and not diagnosis.detail.startswith("com ")
    most = _LONE_NUMBER if is_of_tensor else LARGEST_SOUND_MISMATCH
    return after < most and after < _REMAINING * before


def describe_drawn_inertial(model: Model, link: Link, *, with_com: bool = False) -> str:
    """Describe the inertia of what the link draws, at its mass and uniform density. It is advice: the density is not known.

    For an open mesh, the tensor is that of its convex hull or of the collision shape, and the COM is left out. Empty when that
    is not known, or written already, or when the hull is not that of the part. ``with_com``: a COM that was typed is replaced,
    which neither a hull nor a collision shape in place of an open mesh can do.
    """
    change, drawn = _compute_from_geometry(model, link, with_com=with_com), measure_link_geometry(model, link)
    if change is None or drawn is None or not change.text or has_loose_hull(model, link):
        return ""
    if with_com and (not drawn.closed or _is_replaced_by_collision(model, link)):
        return ""
    body, why = "the drawn part" if drawn.closed else "the convex hull of the open mesh", ""
    if drawn.closed and (reason := explain_collision_stand_in(model, link)) is not None:
        body = "the collision shape"
        why = {"open": "; the visual mesh is open", "unread": "; the visual mesh could not be read"}.get(reason, "")
    return f"{change.text} ({body} at this mass and uniform density{why})"


def has_com_apart(model: Model, link: Link) -> bool:
    """Whether the COM is so far from that of what the link draws that the drawn part's tensor is about another point."""
    drawn, matrix = measure_link_geometry(model, link), None if link.inertial is None else link.inertial.origin.matrix
    if drawn is None or matrix is None:
        return False
    size = float(np.sqrt(np.trace(drawn.solid.covariance)))
    distance = float(np.linalg.norm(matrix[:3, 3] - drawn.solid.com))
    return distance > _APART * size


def lacks_only_com(model: Model, link: Link) -> bool:
    """Whether a tensor is that of what the link draws at its mass, and the COM was left at zero, where that part's is not."""
    change = _compute_from_geometry(model, link, with_com=True)
    xyz = None if link.inertial is None else link.inertial.origin.xyz
    return change is not None and xyz is not None and not any(xyz) and _list_changed(change) == ["xyz"]


def _list_changed(change: InertialRepair) -> list[str]:
    return [word.partition("=")[0] for word in change.text.split('" ')]


def _is_replaced_by_collision(model: Model, link: Link) -> bool:
    """Whether the collision shapes replace a visual mesh that is open or could not be read."""
    return explain_collision_stand_in(model, link) in {"open", "unread"}


def propose_from_geometry(model: Model, link: Link) -> InertialRepair | None:
    """Propose the inertia of what the link draws, at its declared mass and uniform density, in place of a placeholder.

    None when that is not known, or there is no mass. Without edits where a macro wrote the same text for links that draw or
    weigh something else, where a hull or a collision shape replaces an open mesh, and where no ordinary material makes the shape
    weigh this much: then the drawing, or the mass, is a placeholder too.
    """
    change = _compute_from_geometry(model, link)
    if change is None or link.inertial is None:
        return None
    drawn = measure_link_geometry(model, link)
    is_exact = drawn is not None and drawn.closed and not _is_replaced_by_collision(model, link)
    is_ordinary = is_exact and _has_ordinary_density(link, drawn)
    is_same = _has_same_geometry(model, link.inertial.element.span)
    return change if is_ordinary and is_same else replace(change, edits=())


def _has_ordinary_density(link: Link, drawn: VisualGeometry | None) -> bool:
    mass = None if link.inertial is None else link.inertial.mass
    if mass is None or drawn is None or not drawn.solid.volume > 0.0:
        return False
    return LIGHTEST <= mass / drawn.solid.volume <= DENSEST_PART


def _is_lone_unit(model: Model, diagnosed: DiagnosedInertial) -> bool:
    """Whether a unit was found in one link alone, and the numbers in that unit are not exactly the drawn part's: no program
    writes one link of a file in another unit."""
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,
    )  # heavy, and needed for wrong inertials only

    diagnosis = diagnosed.diagnosis
    is_exact = max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch) < EXACT
    if is_exact or diagnosed.is_habit or diagnosis.judged_by == "twin" or diagnosis.cause not in _UNIT_CAUSES:
        return False
    numbers = {(one.declared.mass, *one.declared.tensor.ravel()) for one in inertial_diagnoses(model).values()}
    with_unit = {
        (one.declared.mass, *one.declared.tensor.ravel())
        for one in inertial_diagnoses(model).values()
        if one.diagnosis.cause == diagnosis.cause
    }
    return len(numbers) > len(with_unit) == 1


def _is_of_either_side(model: Model, link: Link, diagnosed: DiagnosedInertial) -> bool:
    """Whether a decimal point may also have slipped in the twin: the numbers that the twin has are not sound for the drawing,
    so that it does not say which side is right."""
    from urdfcheck.facts.inertials.diagnosis import diagnose_inertial  # heavy, and needed for wrong inertials only

    diagnosis, drawn = diagnosed.diagnosis, measure_link_geometry(model, link)
    if diagnosis.judged_by != "twin" or diagnosis.cause != "decimal_point" or diagnosis.mended is None:
        return False
    of_twin = None if drawn is None else diagnose_inertial(diagnosis.mended, drawn)
    return of_twin is None or not of_twin.sound


def _contradicts_twins(model: Model, diagnosed: DiagnosedInertial) -> bool:
    """Whether undoing a mistake may make two parts differ that are drawn alike: the other does not have the mistake."""
    diagnosis = diagnosed.diagnosis
    if diagnosis.judged_by == "twin":
        return False
    return any(_identify_mistake(model, model.link_by_name[twin])[0] != diagnosis.cause for twin in diagnosed.twins)


@fact
def _has_same_mistake(model: Model, text: Span | None) -> bool:
    """Whether one mistake was found in all links whose inertials are one text."""
    return len({_identify_mistake(model, link) for link in _links_by_inertial_text(model)[text]}) == 1


@fact
def _has_same_geometry(model: Model, text: Span | None) -> bool:
    """Whether all links whose inertials are one text get the same numbers from what they draw."""
    return len({_format_drawn_inertial(model, link) for link in _links_by_inertial_text(model)[text]}) == 1


@fact
def _links_by_inertial_text(model: Model) -> Mapping[Span | None, Sequence[Link]]:
    """Group the links whose inertials are one text, as a macro makes them."""
    links: dict[Span | None, list[Link]] = {}
    for link in model.links:
        if link.inertial is not None:
            links.setdefault(link.inertial.element.span, []).append(link)
    return links


def _identify_mistake(model: Model, link: Link) -> tuple[str | None, str]:
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,  # heavy, and needed for wrong inertials only
    )

    diagnosed = inertial_diagnoses(model).get(link.name)
    return (None, "") if diagnosed is None else (diagnosed.diagnosis.cause, diagnosed.diagnosis.detail)


def has_mistake(model: Model, link: Link, cause: str) -> bool:
    """Whether this mistake (a cause of INR009) was found in the inertial of a link."""
    return _identify_mistake(model, link)[0] == cause


def _format_drawn_inertial(model: Model, link: Link) -> str | None:
    change = _compute_from_geometry(model, link)
    return None if change is None else change.text


def _compute_from_geometry(model: Model, link: Link, *, with_com: bool = False) -> InertialRepair | None:
    inertial, drawn = link.inertial, measure_link_geometry(model, link)
    if inertial is None or drawn is None or inertial.mass is None or not inertial.mass > 0:
        return None
    size = float(np.trace(drawn.solid.covariance))
    if not size > 0.0:  # a surface that is not a solid, or numbers too large to square
        return None
    matrix = inertial.origin.matrix
    rotation = np.eye(3) if matrix is None else matrix[:3, :3]  # the axes that the author chose are kept
    tensor = rotation.T @ compute_solid_inertia(drawn.solid, inertial.mass) @ rotation
    own = None if matrix is None else matrix[:3, 3]
    # A COM that was typed is not part of the placeholder. What a mesh leaves of a zero is not a number to write.
    is_exact = drawn.closed and not _is_replaced_by_collision(model, link)
    keeps_com = own is not None and (not is_exact or (own.any() and not with_com))
    com = own if own is not None and keeps_com else _drop_noise(drawn.solid.com, size**0.5)
    tensor = _drop_noise(tensor, float(np.abs(tensor).max()))
    return build_inertial_repair(
        inertial, DeclaredInertial(mass=inertial.mass, com=com, tensor=tensor, rotation=rotation), _GUESSED_DIGITS
    )


def _drop_noise(numbers: Array, size: float) -> Array:
    kept: Array = np.where(np.abs(numbers) > _MESH_NOISE * size, numbers, 0.0)
    return kept
