"""INR020 reports formulas of moments of inertia that do not belong to one box or cylinder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.facts.inertials.formulas.moments import WrongFormula, find_wrong_formula, write_formula
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.inertials.typed_tensors import MOMENTS, parse_formula
from urdfcheck.source.text.xml import Attribute

_MESSAGES = {1: "one", 2: "two", 3: "all"}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for declared in model.tensors:
        attributes = _get_moments(declared)
        wrong = None if attributes is None else _find_wrong_formula(attributes)
        if attributes is not None and wrong is not None and not (len(wrong.indices) == 3 and _is_no_cylinder(declared)):
            yield _build_finding(rule, wrong, attributes, link=declared.link.name)


def _get_moments(declared: DeclaredTensor) -> tuple[Attribute, ...] | None:
    """Return the attributes of the three moments, if each has a place."""
    attributes = tuple(declared.element.attributes[name] for name in MOMENTS if name in declared.element.attributes)
    return attributes if len(attributes) == len(MOMENTS) and all(a.span is not None for a in attributes) else None


def _is_no_cylinder(declared: DeclaredTensor) -> bool:
    """Whether only boxes and spheres are drawn, whose moments are not those of the cylinder in the formula."""
    kinds = {shape.kind for shape in (*declared.link.visuals, *declared.link.collisions)}
    return bool(kinds) and kinds <= {"box", "sphere"}


def _find_wrong_formula(attributes: Sequence[Attribute]) -> WrongFormula | None:
    polynomials = [polynomial for attribute in attributes if (polynomial := parse_formula(attribute)) is not None]
    return find_wrong_formula(polynomials) if len(polynomials) == len(MOMENTS) else None


def _build_finding(rule: Rule, wrong: WrongFormula, attributes: Sequence[Attribute], *, link: str) -> Finding:
    suspects = [attributes[index] for index in wrong.indices]
    first, expected = suspects[-1], write_formula(wrong)
    edits = []
    if len(suspects) == 1 and first.span is not None:
        edits.append(Edit(first.span, first.typed, f"${{{expected}}}"))
    return rule.finding(
        _MESSAGES[len(suspects)],
        at=first,
        related=[attribute for attribute in attributes if attribute is not first],
        edits=edits,
        link=link,
        name=first.name,
        names=" and ".join(attribute.name for attribute in suspects),
        others=" and ".join(attribute.name for attribute in attributes if attribute not in suspects),
        typed=" ".join(first.typed.split()),
        solid=wrong.solid,
        expected=expected,
    )
