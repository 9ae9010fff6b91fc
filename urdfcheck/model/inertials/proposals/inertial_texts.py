"""Links whose inertials are one text: an edit of it changes them all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePath

import numpy as np

from urdfcheck.core import Span
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.typed_tensors import is_computed_from_lengths
from urdfcheck.model.parts import Link
from urdfcheck.model.repairs.inertial_edits import InertialRepair
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.handed_values import find_typed_value
from urdfcheck.source.text.xml import Attribute

# COMs (m) that meshes of one part show as the same.
_SAME_COM = 1e-4
# Files of numbers that xacro reads.
_DATA = frozenset({".yaml", ".yml"})


@fact
def links_by_inertial_text(model: Model) -> Mapping[Span | None, Sequence[Link]]:
    """Group the links whose inertials are one text, as a macro makes them."""
    links: dict[Span | None, list[Link]] = {}
    for link in model.links:
        if link.inertial is not None:
            links.setdefault(link.inertial.element.span, []).append(link)
    return links


def describe_own_call(model: Model, link: Link, change: InertialRepair) -> str:
    """Say what the numbers of a repair are, where they cannot stand at the place that it changes.

    They are the result of a macro call, where the same text makes other links that need other numbers, or that of a formula, or
    are typed in a file of numbers that the macro reads. Empty elsewhere."""
    inertial = link.inertial
    tensor = None if inertial is None else inertial.tensor_element
    if inertial is None or tensor is None:
        return ""
    attributes = [place for place in change.places if isinstance(place, Attribute)]
    places = [place for place in attributes if place.owner is tensor]
    moves_com = any(place.owner is inertial.origin.element and not _is_handed_on(place) for place in attributes)
    if not places and not moves_com:
        return ""
    # A literal <origin> beside the call of a macro is not made by that call.
    made = tensor if places else inertial.origin.element
    others = [
        text
        for one in model.links
        if one is not link and one.inertial is not None
        if (text := one.inertial.tensor_element if places else one.inertial.origin.element) is not None
        if made is not None and text.span == made.span
        if (places and list_numbers(one) != list_numbers(link)) or (moves_com and _is_drawn_elsewhere(model, one, link))
    ]
    if made is None or not others or not made.location.via:
        return " as the result of the formula" if any(map(is_computed_from_lengths, places)) else ""
    typed = [value.span for place in places if (value := find_typed_value(place)) is not None]
    if len(typed) == len(places) > 0 and {PurePath(span.file).suffix for span in typed} <= _DATA:
        first = min(typed, key=lambda span: (span.file, span.line))
        return f" in {PurePath(first.file).name}:{first.line}"
    shared = {span for other in others for span in other.location.via}
    call = next((span for span in reversed(made.location.via) if span not in shared), made.location.via[-1])
    return f" as the result of the call at {PurePath(call.file).name}:{call.line}"


def _is_handed_on(attribute: Attribute) -> bool:
    """Whether a value is typed elsewhere, as in a call: the repair names that text."""
    typed = find_typed_value(attribute)
    return typed is not None and typed.span != attribute.span


def list_numbers(link: Link) -> tuple[object, object]:
    """List the mass and the tensor of a link."""
    return (link.inertial and link.inertial.mass, link.inertial and link.inertial.inertia_components)


def _is_drawn_elsewhere(model: Model, link: Link, other: Link) -> bool:
    """Whether two links draw parts with different COMs in their frames."""
    parts = [measure_link_geometry(model, one) for one in (link, other)]
    first, second = parts
    return (
        first is not None and second is not None and not np.allclose(first.solid.com, second.solid.com, atol=_SAME_COM)
    )
