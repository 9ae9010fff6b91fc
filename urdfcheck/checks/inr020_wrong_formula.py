"""INR020 reports formulas of moments of inertia that do not belong to one box or cylinder."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule, Span
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.formulas.moments import WrongFormula, find_wrong_formula
from urdfcheck.facts.inertials.formulas.polynomials import parse_polynomial
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.source.text.xml import Attribute

MOMENTS = ("ixx", "iyy", "izz")
_EXPRESSION = re.compile(r"\s*\$\{([^{}]*)\}\s*")
_MESSAGES = {1: "one", 2: "two", 3: "all"}
# `1/12` may be typed as 0.083.
_REL_TOL = 0.01


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    by_text: dict[tuple[Span | None, ...], list[DeclaredTensor]] = {}
    for declared in model.tensors:
        attributes = _get_moments(declared)
        if attributes is not None:
            by_text.setdefault(tuple(attribute.span for attribute in attributes), []).append(declared)
    for same in by_text.values():
        attributes = _get_moments(same[0]) or ()
        wrong = _find_wrong_formula(attributes)
        if wrong is not None:
            yield _build_finding(rule, wrong, attributes, links=join_names(declared.link.name for declared in same))


def _get_moments(declared: DeclaredTensor) -> tuple[Attribute, ...] | None:
    """Return the attributes of the moments where each is typed as one expression."""
    attributes = tuple(declared.element.attributes[name] for name in MOMENTS if name in declared.element.attributes)
    is_computed = len(attributes) == len(MOMENTS) and all(_EXPRESSION.fullmatch(a.typed) and a.span for a in attributes)
    return attributes if is_computed else None


def _find_wrong_formula(attributes: tuple[Attribute, ...]) -> WrongFormula | None:
    polynomials = []
    for attribute in attributes:
        expression = _EXPRESSION.fullmatch(attribute.typed)
        polynomial = None if expression is None else parse_polynomial(" ".join(expression[1].split()))
        if polynomial is None:
            return None
        polynomials.append(polynomial)
    return find_wrong_formula(polynomials)


def _build_finding(rule: Rule, wrong: WrongFormula, attributes: tuple[Attribute, ...], *, links: str) -> Finding:
    suspects = [attributes[index] for index in wrong.indices]
    first, expected = suspects[-1], _write_formula(wrong)
    is_about_axis = wrong.solid == "cylinder" and len(wrong.expected) == 1
    edits = []
    if len(suspects) == 1 and first.span is not None:
        edits.append(Edit(first.span, first.typed, f"${{{expected}}}"))
    return rule.finding(
        _MESSAGES[len(suspects)],
        at=first,
        related=[attribute for attribute in attributes if attribute is not first],
        edits=edits,
        links=links,
        name=first.name,
        names=" and ".join(attribute.name for attribute in suspects),
        others=" and ".join(attribute.name for attribute in attributes if attribute not in suspects),
        typed=_shorten(first.typed),
        solid=wrong.solid,
        expected=expected,
        axis="about its own axis"
        if is_about_axis
        else "about an axis across it"
        if wrong.solid == "cylinder"
        else "of a box",
    )


def _write_formula(wrong: WrongFormula) -> str:
    """Write the expected formula as xacro has it: ``m*(3*r*r + h*h)/12``."""
    mass = "*".join(name for name, power in sorted(wrong.factor) for _ in range(power))
    least = min(wrong.expected.values())
    terms = [
        f"{'' if value == least else f'{value / least:g}*'}{name}*{name}" for name, value in wrong.expected.items()
    ]
    squares = terms[0] if len(terms) == 1 else f"({' + '.join(terms)})"
    factor = wrong.unit * least
    divisor = round(1.0 / factor)
    if mass and abs(factor * divisor - 1.0) < _REL_TOL:
        return f"{mass}*{squares}/{divisor}"
    return "*".join(filter(None, (f"{factor:.6g}", mass, squares)))


def _shorten(typed: str) -> str:
    return " ".join(typed.split())
