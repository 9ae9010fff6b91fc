"""SYM007 reports a link whose collision primitives differ from those of the links that are the same part."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.core.text import format_box_size, format_count, join_names, join_numbers
from urdfcheck.model import Model, Shape
from urdfcheck.model.likeness.collision_primitives import (
    OddPrimitives,
    compare_two,
    find_odd_primitives,
    list_equal_parts,
)
from urdfcheck.model.parts import locate_geometry


def check(model: Model, rule: Rule, *, differ: float) -> Iterator[Finding]:
    for group in list_equal_parts(model):
        odd = find_odd_primitives(model, group, differ=differ)
        if odd is not None:
            message = "place" if odd.is_misplaced else "size" if odd.is_certain else "outvoted"
            yield _build_finding(rule, message, odd)
        both = compare_two(model, group, differ=differ)
        if both is not None and both.is_certain:
            yield _build_finding(rule, "drawn", both)
        elif both is not None:
            yield _build_finding(rule, "pair", both, severity=Severity.INFO, confidence=Confidence.HEURISTIC)


def _build_finding(
    rule: Rule,
    message: str,
    odd: OddPrimitives,
    *,
    severity: Severity | None = None,
    confidence: Confidence | None = None,
) -> Finding:
    first = odd.siblings[0]
    at = (odd.own or odd.link.collisions)[0]
    there = (odd.expected or first.collisions)[0]
    return rule.finding(
        message,
        at=locate_geometry(at) if message != "place" or at.origin.element is None else at.origin.element,
        related=[locate_geometry(there), *(locate_geometry(link.collisions[0]) for link in odd.siblings[1:])],
        severity=severity,
        confidence=confidence,
        link=odd.link.name,
        sibling=first.name,
        siblings=join_names(link.name for link in odd.siblings),
        likes=format_count(len(odd.siblings), "equal part"),
        size=_describe_size((odd.own or odd.expected)[0]) if odd.own or odd.expected else "",
        own=_describe_shapes(odd.own, with_place=odd.is_misplaced),
        expected=_describe_shapes(odd.expected, with_place=odd.is_misplaced),
    )


def _describe_shapes(shapes: Sequence[Shape], *, with_place: bool) -> str:
    words = [_describe_shape(shape) + (_describe_place(shape) if with_place else "") for shape in shapes]
    return join_names(words) if words else "no more shapes"


def _describe_shape(shape: Shape) -> str:
    return f"a {shape.kind} of {_describe_size(shape)}"


def _describe_size(shape: Shape) -> str:
    size = shape.size or ()
    if shape.kind == "box":
        return format_box_size(size, digits=4)
    return ", ".join(f"{name} {value:.4g} m" for name, value in zip(("radius", "length"), size, strict=False))


def _describe_place(shape: Shape) -> str:
    xyz, rpy = (join_numbers(numbers or (0, 0, 0), separator=" ") for numbers in (shape.origin.xyz, shape.origin.rpy))
    return f' at xyz="{xyz}" rpy="{rpy}"'
