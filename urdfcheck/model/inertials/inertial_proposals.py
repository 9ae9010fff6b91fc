"""Which other numbers an ``<inertial>`` should have: its own without a mistake, or those of the drawn part."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from urdfcheck.core import Edit, Span
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import check_inertia_validity, compute_solid_inertia
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link
from urdfcheck.model.repairs.inertial_edits import NEGLIGIBLE_DIFFERENCE, InertialRepair, build_inertial_repair
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# A flat part's tensor that was typed with three digits may miss the triangle inequality by this share of its largest moment.
TRIANGLE_SLACK = 5e-3


@dataclass(frozen=True, slots=True, eq=False)
class InertialProposal:
    """The repair of an inertial that cannot be right; empty where nothing is known."""

    edits: tuple[Edit, ...] = ()
    message: str = ""
    """What a message says of it, from its semicolon on."""
    remedy: str = ""
    """How the advice begins."""


def propose_repair(model: Model, link: Link) -> InertialProposal:
    """Propose the single edit that makes an inertial possible and equal to that of the drawn part or of its twin.

    Without such an edit, the inertia of the drawn part.
    """
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,  # heavy, and needed for wrong inertials only
    )

    diagnosed = inertial_diagnoses(model).get(link.name)
    change = propose_undo(model, link)
    if diagnosed is not None and change is not None and diagnosed.diagnosis.mended is not None:
        diagnosis, possible = (
            diagnosed.diagnosis,
            check_inertia_validity(diagnosed.diagnosis.mended.tensor, TRIANGLE_SLACK),
        )
        if possible.positive_definite and possible.triangle_inequality:
            reference = (
                "the part that is drawn" if diagnosis.judged_by == "mesh" else f"its twin {', '.join(diagnosed.twins)}"
            )
            mistake = (diagnosis.cause or "").replace("_", " ")
            claim = f"undoing one mistake ({mistake}) makes it possible and brings it near to that of {reference}"
            if diagnosis.unique:
                claim = f"one edit ({mistake}) makes it that of {reference}, and no other single edit does"
            return InertialProposal(change.edits, f"; {claim}: {change.text}", f"write {change.text}; or ")
    drawn = propose_from_geometry(model, link)
    if drawn is None or not drawn.text:
        return InertialProposal()
    return InertialProposal(
        drawn.edits, "", f"write {drawn.text}, which is the drawn part's at this mass and uniform density; or "
    )


def propose_undo(model: Model, link: Link) -> InertialRepair | None:
    """Propose what undoes the mistake that was found in a link's inertial.

    None where no mistake is certain, or it is not in the inertial. Without edits where a macro wrote the same text for
    other links, in which this mistake was not found.
    """
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,  # heavy, and needed for wrong inertials only
    )

    diagnosed, inertial = inertial_diagnoses(model).get(link.name), link.inertial
    if diagnosed is None or inertial is None or diagnosed.diagnosis.mended is None:
        return None
    change = build_inertial_repair(inertial, diagnosed.diagnosis.mended)
    if not change.text:
        return None
    return change if _has_same_mistake(model, inertial.element.span) else replace(change, edits=())


def propose_from_geometry(model: Model, link: Link) -> InertialRepair | None:
    """Propose the COM and the inertia tensor of what the link draws, at its declared mass and uniform density.

    None when that is not known, or there is no mass. Without edits where a macro wrote the same text for links that draw or
    weigh something else.
    """
    change = _compute_from_geometry(model, link)
    if change is None or link.inertial is None:
        return None
    return change if _has_same_geometry(model, link.inertial.element.span) else replace(change, edits=())


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


def _identify_mistake(model: Model, link: Link) -> Hashable:
    from urdfcheck.model.inertials.inertia_diagnosis import (
        inertial_diagnoses,  # heavy, and needed for wrong inertials only
    )

    diagnosed = inertial_diagnoses(model).get(link.name)
    return None if diagnosed is None else (diagnosed.diagnosis.cause, diagnosed.diagnosis.detail)


def _format_drawn_inertial(model: Model, link: Link) -> str | None:
    change = _compute_from_geometry(model, link)
    return None if change is None else change.text


def _compute_from_geometry(model: Model, link: Link) -> InertialRepair | None:
    inertial, drawn = link.inertial, measure_link_geometry(model, link)
    if inertial is None or drawn is None or inertial.mass is None or not inertial.mass > 0:
        return None
    size = float(np.trace(drawn.solid.covariance))
    if not size > 0.0:  # a surface that is not a solid, or numbers too large to square
        return None
    matrix = inertial.origin.matrix
    rotation = np.eye(3) if matrix is None else matrix[:3, :3]  # the axes that the author chose are kept
    tensor = rotation.T @ compute_solid_inertia(drawn.solid, inertial.mass) @ rotation
    # What single precision leaves of a zero is not a number to write.
    com = np.where(np.abs(drawn.solid.com) > NEGLIGIBLE_DIFFERENCE * size**0.5, drawn.solid.com, 0.0)
    tensor = np.where(np.abs(tensor) > NEGLIGIBLE_DIFFERENCE * np.abs(tensor).max(), tensor, 0.0)
    return build_inertial_repair(
        inertial, DeclaredInertial(mass=inertial.mass, com=com, tensor=tensor, rotation=rotation)
    )
