"""Inertials of which a comment beside them says what they are for: their numbers were chosen, and are not a slip."""

from __future__ import annotations

from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.stated_reasons import has_reason_behind, has_stated_reason


def has_stated_purpose(model: Model, link: Link) -> bool:
    """Whether a comment in the ``<inertial>`` of a link, right before it, or behind the number of the mass where that was typed,
    says why its numbers are what they are."""
    if link.inertial is None:
        return False
    mass = link.inertial.mass_attribute
    return has_stated_reason(model, link.inertial.element) or (mass is not None and has_reason_behind(model, mass))
