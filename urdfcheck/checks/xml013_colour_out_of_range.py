"""XML013 reports colours with a component outside 0 to 1."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_repetition, join_numbers
from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.model.use.other_programs import is_only_for_bullet
from urdfcheck.source.text.grammar import iter_urdf_elements
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import Attribute

_SCALE = 255
# A smaller number may be a slip of one from 0 to 1 (`2`, `1 0` without its point): of 255 it would be black.
_LEAST = 16
# A decimal without its point.
_POINTLESS = re.compile(r"0[1-9]\d*")
# An alpha in per cent is opaque.
_PER_CENT = 100


def check(model: Model, rule: Rule, *, rounding: float) -> Iterator[Finding]:
    by_colour: dict[tuple[float, ...], list[Attribute]] = {}
    for element in iter_urdf_elements(model.robot):
        attribute = element.attributes.get("rgba") if element.tag == "color" else None
        rgba = parse_numbers(attribute.value, 4) if attribute is not None else None
        if attribute is not None and rgba is not None and not all(0 <= part <= 1 for part in rgba):
            by_colour.setdefault(rgba, []).append(attribute)
    severity = Severity.INFO if by_colour and is_only_for_bullet(model) else None
    for rgba, attributes in by_colour.items():
        yield _build_finding(rule, rgba, attributes, rounding=rounding, severity=severity)


def _build_finding(
    rule: Rule, rgba: tuple[float, ...], attributes: list[Attribute], *, rounding: float, severity: Severity | None
) -> Finding:
    """Report all places with the same numbers together."""
    better = _scale_to_unit_range(rgba) or _clip_rounding(rgba, rounding)
    places = {a.span: a for a in attributes if a.span is not None}
    text = "" if better is None else join_numbers(better, digits=4, separator=" ")
    material = attributes[0].owner.parent
    # urdfdom keeps a material of the robot, with the colour that it begins with.
    is_of_robot = material is not None and material.parent is not None and material.parent.tag == "robot"
    finding = rule.finding(
        "scaled" if _scale_to_unit_range(rgba) else "outside",
        at=attributes[0],
        severity=severity,
        related=[a for span, a in places.items() if span != attributes[0].span],
        edits=[edit for attribute in places.values() if text for edit in edit_numbers(attribute, text)],
        rgba=" ".join(attributes[0].value.split()),
        better=text or "each component between 0 and 1" + _guess_point(attributes[0].value),
        times=format_repetition(len(attributes)),
        consequences={"rviz": "replaces the colour by black"} if is_of_robot else None,
    )
    return replace(finding, subjects=tuple(a.location.subject for a in attributes))


def _guess_point(typed: str) -> str:
    """Return the number that one with a zero before its digit was meant to be: 0.5 for 05."""
    word = next(filter(_POINTLESS.fullmatch, typed.split()), None)
    return "" if word is None else f", perhaps {word[0]}.{word[1:]} for {word}"


def _scale_to_unit_range(rgba: tuple[float, ...]) -> tuple[float, ...] | None:
    """Scale whole numbers up to 255 to the range of 0 to 1, or return None; their alpha may be a fraction already."""
    colour, alpha = rgba[:3], rgba[3]
    whole = all(part == round(part) and 0 <= part <= _SCALE for part in colour)
    if not whole or max(colour) < _LEAST or not 0 <= alpha <= _SCALE or alpha == _PER_CENT:
        return None
    return (*(part / _SCALE for part in colour), alpha if alpha <= 1 else alpha / _SCALE)


def _clip_rounding(rgba: tuple[float, ...], rounding: float) -> tuple[float, ...] | None:
    """Return the colour without its rounding errors, or None if it has larger errors."""
    inside = tuple(min(max(part, 0.0), 1.0) for part in rgba)
    return inside if all(abs(a - b) <= rounding for a, b in zip(inside, rgba, strict=True)) else None
