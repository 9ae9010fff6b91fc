"""Tensors as they are typed: placeholders, and the formulas from which a xacro computes moments of inertia."""

from __future__ import annotations

import re

from urdfcheck.facts.inertials.formulas.polynomials import Polynomial, parse_polynomial
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model.parts import Link
from urdfcheck.source.text.xml import Attribute

MOMENTS = ("ixx", "iyy", "izz")
# A value that is one expression.
_EXPRESSION = re.compile(r"\s*\$\{([^{}]*)\}\s*")


def parse_formula(attribute: Attribute) -> Polynomial | None:
    """Return what an attribute is computed from as a polynomial; None where it is not typed as one expression that is one."""
    expression = _EXPRESSION.fullmatch(attribute.typed)
    return None if expression is None else parse_polynomial(" ".join(expression[1].split()))


def is_computed_from_lengths(attribute: Attribute) -> bool:
    """Whether a moment is typed as a formula with the square of a length, and not as a number or a name that is handed on."""
    formula = parse_formula(attribute)
    return formula is not None and any(power >= 2 for term in formula for _, power in term)


def describe_typed_tensor(link: Link) -> str | None:
    """Describe the tensor of a link where it looks typed and not computed (INR007); None for any other."""
    inertial = link.inertial
    if inertial is None or inertial.mass is None or inertial.inertia_components is None:
        return None
    return describe_placeholder(inertial.mass, inertial.inertia_components)
