"""Links whose inertials are one text: an edit of it changes them all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePath

from urdfcheck.core import Span
from urdfcheck.facts.inertials.formulas.polynomials import measure_degree
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.typed_formulas import parse_formula
from urdfcheck.model.parts import Link
from urdfcheck.model.repairs.inertial_edits import InertialRepair
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import Attribute


@fact
def links_by_inertial_text(model: Model) -> Mapping[Span | None, Sequence[Link]]:
    """Group the links whose inertials are one text, as a macro makes them."""
    links: dict[Span | None, list[Link]] = {}
    for link in model.links:
        if link.inertial is not None:
            links.setdefault(link.inertial.element.span, []).append(link)
    return links


def describe_own_call(model: Model, link: Link, change: InertialRepair) -> str:
    """Say that the numbers of a repair are no text for the place that it changes: which macro call makes the tensor of a link,
    where the same text makes other numbers for other links, or that a formula computes it. Empty elsewhere."""
    tensor = None if link.inertial is None else link.inertial.tensor_element
    places = [place for place in change.places if isinstance(place, Attribute) and place.owner is tensor]
    if link.inertial is None or tensor is None or not places:
        return ""
    own = (link.inertial.mass, link.inertial.inertia_components)
    others = [
        other
        for inertial in (one.inertial for one in model.links if one is not link)
        if inertial is not None
        and (other := inertial.tensor_element) is not None
        and other.span == tensor.span
        and (inertial.mass, inertial.inertia_components) != own
    ]
    if not others or not tensor.location.via:
        return " as the result of the formula" if any(map(_is_computed, places)) else ""
    shared = {span for other in others for span in other.location.via}
    call = next((span for span in reversed(tensor.location.via) if span not in shared), tensor.location.via[-1])
    return f" as the result of the call at {PurePath(call.file).name}:{call.line}"


def _is_computed(attribute: Attribute) -> bool:
    """Whether a value is computed from others, rather than the value of one name that is handed on."""
    formula = parse_formula(attribute)
    return formula is not None and measure_degree(formula) > 1
