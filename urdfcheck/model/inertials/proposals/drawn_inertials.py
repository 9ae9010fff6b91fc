"""The numbers of an ``<inertial>`` by what the link draws, at its mass and uniform density."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Span
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.materials import DENSEST, DENSEST_PART, LIGHTEST
from urdfcheck.facts.inertials.mistakes.wrong_formulas import is_rounding_of
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.proposals.com_places import has_com_apart
from urdfcheck.model.inertials.proposals.inertial_texts import describe_own_call, links_by_inertial_text, list_numbers
from urdfcheck.model.inertials.proposals.like_links import has_com_of_twin
from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal
from urdfcheck.model.parts import DeclaredTensor, Link
from urdfcheck.model.repairs.inertial_edits import InertialRepair, build_inertial_repair, have_one_text
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import (
    DRAWN_PART,
    OPEN_HULL,
    explain_collision_stand_in,
    has_loose_hull,
    measure_link_geometry,
    measure_role_geometry,
)
from urdfcheck.source.uses_elsewhere import find_other_includers

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import VisualGeometry

# What a mesh leaves of a product that is zero, relative to the largest moment.
_MESH_NOISE = 1e-3
# Significant digits of numbers that a uniform density gives.
_GUESSED_DIGITS = 4
# A collision shape of this share of the length of what is drawn stands for the part (chosen).
_MOST_OF_PART = 0.5
# Halves of a unit in the last typed place.
_LAST_PLACE = 2.0
# Why the collision shapes replace a visual mesh.
_WHY_NOT_DRAWN = {
    "open": "; the visual mesh is open",
    "unread": "; the visual mesh could not be read",
    "wrong size": "; the visual mesh has a wrong size",
}


def describe_drawn_inertial(model: Model, link: Link, *, with_com: bool = False) -> str:
    """Describe the inertia of what the link draws, at its mass and uniform density. It is advice: the density is not known.

    For an open mesh, the tensor is that of its convex hull or of the collision shape, and the COM is left out. Empty when that
    is not known, or written already, or when the hull is not that of the part. ``with_com``: a COM that was typed is replaced,
    which neither a hull nor a collision shape in place of an open mesh can do.
    """
    change, drawn = _compute_from_geometry(model, link, with_com=with_com), measure_link_geometry(model, link)
    if change is None or drawn is None or not change.text or has_loose_hull(model, link):
        return ""
    if (drawn.primitive is None and _is_air(link, drawn)) or _is_too_dense(link, drawn):
        return ""
    if with_com and (not drawn.closed or _is_replaced_by_collision(model, link)):
        return ""
    body, why = DRAWN_PART if drawn.closed else OPEN_HULL, ""
    if drawn.closed and (reason := explain_collision_stand_in(model, link)) is not None:
        body = "the collision shape"
        why = _WHY_NOT_DRAWN.get(reason, "")
    return f"{change.text}{describe_own_call(model, link, change)} ({body} at this mass and uniform density{why})"


def format_comparison(drawn: str) -> str:
    """Return the end of an advice for which no mistake is known: what `describe_drawn_inertial` says is evidence there, not a
    repair. Empty where it says nothing."""
    return drawn and f"; for comparison: {drawn}"


def describe_possible_inertial(model: Model, link: Link) -> str:
    """Describe the inertia of what the link draws, in place of one that no body has: with the COM where that was typed apart from
    the drawn part's, if it is known. A collision shape may be that of a piece of the part, whose COM is elsewhere."""
    is_drawn = explain_collision_stand_in(model, link) is None
    is_wrong = is_drawn and has_com_apart(model, link) and not has_com_of_twin(model, link)
    with_com = describe_drawn_inertial(model, link, with_com=True) if is_wrong else ""
    return with_com or describe_drawn_inertial(model, link)


def propose_drawn_inertial(model: Model, link: Link, message: str = "") -> InertialProposal:
    """Propose the inertia of what the link draws, in place of one that no body has: as a comparison where it may not be that of
    the part, or where both sides have one COM that is not the drawn part's, or where primitives are drawn in another place than
    the COM that was typed: they may mark where the link is, not where its mass is. Nothing where one text gives links the same
    numbers, and the parts that they draw have others, as the two sides of a robot; nor of a body that several links share, of
    which no share is known."""
    if _shares_body(model, link):
        return InertialProposal(message=message)
    drawn = describe_possible_inertial(model, link)
    if drawn and _makes_other_parts(model, link):
        return InertialProposal(message=message)
    is_elsewhere = has_com_apart(model, link) and (has_com_of_twin(model, link) or _draws_mark(link))
    if drawn and not is_elsewhere and draws_part(model, link):
        return InertialProposal(message=message, remedy=f"write {drawn}, or ")
    return InertialProposal(message=message, comparison=format_comparison(drawn))


def _makes_other_parts(model: Model, link: Link) -> bool:
    """Whether the text that gives a link its numbers gives them to one that draws something else, too."""
    own = _compute_from_geometry(model, link)
    return link.inertial is not None and any(
        list_numbers(other) == list_numbers(link)
        and own is not None
        and other.inertial is not None
        and have_one_text(own.places, link.inertial, other.inertial)
        and _format_drawn_inertial(model, other) != own.text
        for other in links_by_inertial_text(model)[link.inertial.element.span]
    )


def _shares_body(model: Model, link: Link) -> bool:
    """Whether another link at the same place, which turns beside it and draws nothing, has the same mass about the same COM: the
    body was divided among the links of a joint with several axes, and so may be its tensor."""
    own = link.inertial
    if own is None or own.mass is None or not own.origin.xyz or not any(own.origin.xyz):
        return False
    near = {
        name
        for one in model.joints
        if not any(one.origin.xyz or (1.0,))
        for name in (one.parent, one.child)
        if link.name in (one.parent, one.child)
    }
    others = [other for name in near - {link.name} if (other := model.link_by_name.get(name)) is not None]
    return any(
        not (*other.visuals, *other.collisions)
        and other.inertial is not None
        and (other.inertial.mass, other.inertial.origin.xyz) == (own.mass, own.origin.xyz)
        for other in others
    )


def _draws_mark(link: Link) -> bool:
    """Whether a link with a COM that was typed draws primitives only."""
    xyz = None if link.inertial is None else link.inertial.origin.xyz
    return xyz is not None and any(xyz) and all(shape.kind != "mesh" for shape in link.visuals)


def draws_part(model: Model, link: Link) -> bool:
    """Whether what is measured of a link is a closed solid that it shows: not a hull, nor a collision shape in its place. Where
    nothing else is drawn, a collision shape about another COM than the typed one may be that of a piece."""
    drawn = measure_link_geometry(model, link)
    if drawn is None or not drawn.closed or _is_replaced_by_collision(model, link):
        return False
    return explain_collision_stand_in(model, link) is None or not has_com_apart(model, link)


def lacks_only_com(model: Model, link: Link) -> bool:
    """Whether a tensor is that of what the link draws at its mass, and the COM was left at zero, where that part's is not."""
    change = _compute_from_geometry(model, link, with_com=True)
    xyz = None if link.inertial is None else link.inertial.origin.xyz
    return change is not None and xyz is not None and not any(xyz) and _list_changed(change) == ["xyz"]


def propose_from_geometry(model: Model, link: Link) -> InertialRepair | None:
    """Propose the inertia of what the link draws, at its declared mass and uniform density, in place of a placeholder.

    None when that is not known, or there is no mass. Without edits where a macro wrote the same text for links that draw or
    weigh something else, or may do so in other models, where a hull or a collision shape replaces an open mesh, and where no
    ordinary material makes the shape weigh this much: then the drawing, or the mass, is a placeholder too.
    """
    change = _compute_from_geometry(model, link)
    if change is None or link.inertial is None:
        return None
    drawn = measure_link_geometry(model, link)
    is_exact = drawn is not None and drawn.closed and not _is_replaced_by_collision(model, link)
    is_ordinary = is_exact and _has_ordinary_density(link, drawn)
    text = link.inertial.element.span
    is_same = _has_same_geometry(model, text) and not (text and find_other_includers(model.source, text.file))
    return change if is_ordinary and is_same else replace(change, edits=())


def compute_drawn_tensor(model: Model, declared: DeclaredTensor) -> Mat3 | None:
    """Compute the tensor (3, 3) of what the link draws, at its mass and in the axes of its inertial."""
    inertial, drawn = declared.inertial, measure_link_geometry(model, declared.link)
    matrix = inertial.origin.matrix
    if drawn is None or matrix is None or inertial.mass is None or not inertial.mass > 0:
        return None
    rotation = matrix[:3, :3]
    tensor: Mat3 = rotation.T @ compute_solid_inertia(drawn.solid, inertial.mass) @ rotation
    return tensor


def is_drawn_otherwise(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a link draws a solid whose tensor is more than a unit in the last place from the typed digits: more digits are not
    what is missing."""
    return _is_drawn_and_rounded(model, declared) is False


def is_drawn_and_rounded(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a link draws a solid whose tensor is that of the typed digits, to a unit in the last place."""
    return _is_drawn_and_rounded(model, declared) is True


def _is_drawn_and_rounded(model: Model, declared: DeclaredTensor) -> bool | None:
    """Whether the typed digits are those of the tensor of a solid that a link draws; None where it draws none."""
    geometry, drawn = measure_link_geometry(model, declared.link), compute_drawn_tensor(model, declared)
    if geometry is None or not geometry.closed or drawn is None:
        return None
    return is_rounding_of(declared.tensor, drawn, slack=_LAST_PLACE)


def _list_changed(change: InertialRepair) -> list[str]:
    return [word.partition("=")[0] for word in change.text.split('" ')]


def _is_replaced_by_collision(model: Model, link: Link) -> bool:
    """Whether the collision shapes replace a visual mesh."""
    return explain_collision_stand_in(model, link) in _WHY_NOT_DRAWN


def is_collision_of_detail(model: Model, link: Link) -> bool:
    """Whether the collision shapes that replace an open mesh are far smaller: those of the motor alone of a leg, for example."""
    if explain_collision_stand_in(model, link) != "open":
        return False
    roles = [measure_role_geometry(model, link, role) for role in ("collision", "visual")]
    colliding, visible = (0.0 if drawn is None else measure_extent(drawn.points) for drawn in roles)
    return colliding < _MOST_OF_PART * visible


def _is_air(link: Link, drawn: VisualGeometry) -> bool:
    """Whether no material is so light: then a mesh is drawn many times too large, and its tensor and COM are as wrong."""
    mass = None if link.inertial is None else link.inertial.mass
    return mass is not None and mass < LIGHTEST * drawn.solid.volume


def _is_too_dense(link: Link, drawn: VisualGeometry) -> bool:
    """Whether no material is so heavy: then what is drawn is a small piece of the part, or a mark in its place."""
    mass = None if link.inertial is None else link.inertial.mass
    return mass is not None and drawn.closed and mass > DENSEST * drawn.solid.volume


def _has_ordinary_density(link: Link, drawn: VisualGeometry | None) -> bool:
    mass = None if link.inertial is None else link.inertial.mass
    if mass is None or drawn is None or not drawn.solid.volume > 0.0:
        return False
    return LIGHTEST <= mass / drawn.solid.volume <= DENSEST_PART


@fact
def _has_same_geometry(model: Model, text: Span | None) -> bool:
    """Whether all links whose inertials are one text get the same numbers from what they draw."""
    return len({_format_drawn_inertial(model, link) for link in links_by_inertial_text(model)[text]}) == 1


def _format_drawn_inertial(model: Model, link: Link) -> str | None:
    change = _compute_from_geometry(model, link)
    return None if change is None else change.text


def _compute_from_geometry(model: Model, link: Link, *, with_com: bool = False) -> InertialRepair | None:
    inertial, drawn = link.inertial, measure_link_geometry(model, link)
    if inertial is None or drawn is None or inertial.mass is None or not inertial.mass > 0:
        return None
    if is_collision_of_detail(model, link):
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
    products = tensor - np.diag(np.diag(tensor))  # a moment of a thin rod is small and no noise
    tensor = np.diag(np.diag(tensor)) + _drop_noise(products, float(np.abs(tensor).max()))
    return build_inertial_repair(
        inertial, DeclaredInertial(mass=inertial.mass, com=com, tensor=tensor, rotation=rotation), _GUESSED_DIGITS
    )


def _drop_noise(numbers: Array, size: float) -> Array:
    kept: Array = np.where(np.abs(numbers) > _MESH_NOISE * size, numbers, 0.0)
    return kept
