"""INR020 reports formulas of moments of inertia that do not belong to one box or cylinder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Span
from urdfcheck.facts.inertials.formulas.moments import AXES, WrongFormula, find_wrong_formula, write_formula
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.inertials.typed_tensors import MOMENTS, parse_formula
from urdfcheck.source.text.xml import Attribute

_MESSAGES = {1: "one", 2: "two", 3: "all"}
# The cosine of 1.4°: 1.57 for a right angle is along an axis.
_ALONG = 0.9997


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if findings := list(_check(model, rule)):
        from urdfcheck.model.inertials.habits.minor_findings import set_chosen_aside  # loads numpy

        yield from set_chosen_aside(model, rule, findings)


def _check(model: Model, rule: Rule) -> Iterator[Finding]:
    found: list[tuple[DeclaredTensor, Sequence[Attribute], WrongFormula]] = []
    axes: dict[Span | None, set[int | None]] = {}
    for declared in model.tensors:
        attributes = _get_moments(declared)
        wrong = None if attributes is None else _find_wrong_formula(attributes)
        if attributes is not None and wrong is not None and not (len(wrong.indices) == 3 and _is_no_cylinder(declared)):
            found.append((declared, attributes, wrong))
            axes.setdefault(attributes[0].span, set()).add(_find_drawn_axis(declared))
    for declared, moments, wrong in found:
        # Links of one macro may draw their cylinders about different axes: then the macro cannot be right for all of them.
        drawn = axes[moments[0].span]
        axis = next(iter(drawn)) if len(drawn) == 1 else None
        suspects = _choose_by_axis(wrong, axis)
        yield _build_finding(
            rule,
            replace(wrong, indices=suspects),
            moments,
            link=declared.link.name,
            drawn=f": the cylinder is drawn about {AXES[axis]}"
            if axis is not None and suspects != wrong.indices
            else "",
        )


def _choose_by_axis(wrong: WrongFormula, axis: int | None) -> tuple[int, ...]:
    """Return the moments of the wrong formula, which is only one where the cylinder is drawn about an axis that decides."""
    if wrong.solid != "cylinder" or axis is None or axis not in wrong.indices:
        return wrong.indices
    if len(wrong.indices) == 2:  # both are those about the cylinder's axis
        return tuple(index for index in wrong.indices if index != axis)
    return (axis,)  # all are those about an axis across it


def _find_drawn_axis(declared: DeclaredTensor) -> int | None:
    """Return the axis of the tensor (0, 1, 2) along which the link draws its cylinders; None where they do not agree on one."""
    frame = declared.inertial.origin.matrix
    shapes = [shape for shape in (*declared.link.visuals, *declared.link.collisions) if shape.kind == "cylinder"]
    found: set[int | None] = set()
    for shape in shapes:
        placed = shape.origin.matrix
        direction = None if frame is None or placed is None else abs(frame[:3, :3].T @ placed[:3, 2])
        found.add(None if direction is None or max(direction) < _ALONG else int(direction.argmax()))
    return next(iter(found)) if len(found) == 1 else None


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


def _build_finding(
    rule: Rule, wrong: WrongFormula, attributes: Sequence[Attribute], *, link: str, drawn: str
) -> Finding:
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
        drawn=drawn,
    )
