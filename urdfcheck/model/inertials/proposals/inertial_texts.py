"""Links whose inertials are one text: an edit of it changes them all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePath

from urdfcheck.core import Span
from urdfcheck.model.fact import fact
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
    """Say which macro call makes the tensor of a link that a repair changes, where the same text makes other numbers for other
    links: written there, the numbers of one link would be wrong for the others. Empty elsewhere."""
    tensor = None if link.inertial is None else link.inertial.tensor_element
    if link.inertial is None or tensor is None or not tensor.location.via:
        return ""
    if not any(isinstance(place, Attribute) and place.owner is tensor for place in change.places):
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
    if not others:
        return ""
    shared = {span for other in others for span in other.location.via}
    call = next((span for span in reversed(tensor.location.via) if span not in shared), tensor.location.via[-1])
    return f" as the result of the call at {PurePath(call.file).name}:{call.line}"
