"""Links whose inertials are one text: an edit of it changes them all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model


@fact
def links_by_inertial_text(model: Model) -> Mapping[Span | None, Sequence[Link]]:
    """Group the links whose inertials are one text, as a macro makes them."""
    links: dict[Span | None, list[Link]] = {}
    for link in model.links:
        if link.inertial is not None:
            links.setdefault(link.inertial.element.span, []).append(link)
    return links
