"""Tensors that were typed rather than computed."""

from __future__ import annotations

from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model.parts import Link


def describe_typed_tensor(link: Link) -> str | None:
    """Describe the tensor of a link where it looks typed and not computed (INR007); None for any other."""
    inertial = link.inertial
    if inertial is None or inertial.mass is None or inertial.inertia_components is None:
        return None
    return describe_placeholder(inertial.mass, inertial.inertia_components)
