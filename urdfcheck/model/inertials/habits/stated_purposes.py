"""Inertials of which a comment beside them, or the name of their number, says what they are for: they are chosen, and no slip."""

from __future__ import annotations

import math

from urdfcheck.core.text import split_name_words
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.stated_reasons import (
    has_disclaimer,
    has_reason_above_macro,
    has_reason_at_definition,
    has_reason_behind,
    has_stated_reason,
    is_called_dummy,
)

# Words that say that a number is chosen. That it is a dummy's does not, for it may still have to be replaced.
_CHOSEN_WORDS = frozenset({"negligible", "insignificant", "tiny", "epsilon", "eps"})
# A factor in the formula of a tensor that has one of the first words in its name, or one of the second beside "inertia": rotors
# that a simulation turns more slowly have more inertia, so that they store as much.
_SLOWED, _SCALING = frozenset({"slowdown"}), frozenset({"scale", "scaling", "factor", "multiplier"})
# A mass of that name is at most this share of the robot's (chosen).
_TINY_SHARE = 1e-3


def has_stated_purpose(model: Model, link: Link) -> bool:
    """Whether a comment says why the numbers of a link are what they are, or that they are not to be relied on, or the link is
    called negligible or a dummy.

    The comment is where the numbers were typed: in the ``<inertial>``, right before it or before the macro that makes it,
    behind the number of the mass, or above the properties that mass and tensor are computed from.
    """
    inertial = link.inertial
    if inertial is None:
        return False
    if is_called_negligible(model, link) or is_called_dummy(model, link.element):
        return True
    if has_stated_reason(model, inertial.element) or has_disclaimer(model, inertial.element):
        return True
    mass, tensor = inertial.mass_attribute, inertial.tensor_element
    if mass is not None and has_reason_behind(model, mass):
        return True
    typed = [inertial.element, *(() if tensor is None else (tensor,))]
    if any(has_reason_above_macro(model, element) for element in typed):
        return True
    definitions = [
        *(() if mass is None else mass.collect_definitions()),
        *(() if tensor is None else tensor.collect_definitions()),
    ]
    return any(has_reason_at_definition(model, definition) for definition in definitions)


def is_called_negligible(model: Model, link: Link) -> bool:
    """Whether the mass of a link is a property or argument whose name says that it is negligible, as it is beside the robot's."""
    inertial = link.inertial
    if inertial is None or inertial.mass is None or inertial.mass_attribute is None:
        return False
    names = [definition.name for definition in inertial.mass_attribute.collect_definitions()]
    if all(_CHOSEN_WORDS.isdisjoint(word.lower() for word in split_name_words(name)) for name in names):
        return False
    return inertial.mass <= _TINY_SHARE * math.fsum(max(declared.mass, 0.0) for declared in model.masses)


def has_scaled_tensor(link: Link) -> bool:
    """Whether the tensor of a link is computed with a factor other than 1 whose name says that it makes up for something in a
    simulation: ``rotor_velocity_slowdown_sim``, ``inertia_scaling``."""
    tensor = None if link.inertial is None else link.inertial.tensor_element
    definitions = () if tensor is None else tensor.collect_definitions()
    return any(_is_scaling(one.name) and one.value.strip() not in {"1", "1.0", "1."} for one in definitions)


def _is_scaling(name: str) -> bool:
    words = {word.lower() for word in split_name_words(name)}
    return not words.isdisjoint(_SLOWED) or ("inertia" in words and not words.isdisjoint(_SCALING))
