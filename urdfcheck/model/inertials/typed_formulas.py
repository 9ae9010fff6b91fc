"""The formulas from which a xacro computes moments of inertia, as they are typed."""

from __future__ import annotations

import re

from urdfcheck.facts.inertials.formulas.polynomials import Polynomial, parse_polynomial
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
