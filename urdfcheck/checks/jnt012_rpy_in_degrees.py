"""JNT012 reports origins whose angles are written in degrees."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_count
from urdfcheck.model import Model
from urdfcheck.source.text.grammar import iter_urdf_elements
from urdfcheck.source.text.tokens import Token, tokenize_attribute
from urdfcheck.source.text.values import parse_number, parse_numbers
from urdfcheck.source.text.xml import Attribute

# An angle this near (rad) to a quarter turn, or half of one, looks right in a viewer: 300 rad are 47.75 turns.
_LOOKS_RIGHT = math.radians(2)
_SQUARE, _DIAGONAL = math.pi / 2, math.pi / 4
# Angles in degrees are multiples of this: 150 is, and its 23.87 turns come out diagonal by chance; 95 is not.
_USUAL_DEGREES = 15
# Sums of angles stay below some turns: 95 is in degrees and not a multiple of 15° in radians with few digits.
_MOST_TURNS = 4
# Exporters keep angles within a turn, to which the next joint may add a little.
_LITTLE_MORE = 1.25


def check(model: Model, rule: Rule, *, step: float, near: float) -> Iterator[Finding]:
    origins = [
        e.attributes["rpy"] for e in iter_urdf_elements(model.robot) if e.tag == "origin" and "rpy" in e.attributes
    ]
    wrong = {
        a.span or a.location.subject: a for a in origins if any(_is_degrees(v, step, near) for v in _parse_angles(a))
    }
    if not wrong:
        return
    attributes = [a for a in origins if (a.span or a.location.subject) in wrong]
    worst = max((v for a in wrong.values() for v in _parse_angles(a)), key=abs)
    angles = [v for a in wrong.values() for v in _parse_angles(a) if _is_degrees(v, step, near)]
    where = format_count(len(attributes), "origin holds", "origins hold")
    if all(_is_tried(v) for v in angles):
        finding = rule.finding(
            "tried",
            at=attributes[0],
            related=list(wrong.values())[1:],
            where=where,
            worst=worst,
            turns=abs(worst) / math.tau,
            same=math.remainder(worst, math.tau),
            degrees=math.degrees(math.remainder(worst, math.tau)),
            looks="square" if _is_near_multiple(worst, _SQUARE) else "diagonal",
        )
        yield replace(finding, subjects=tuple(dict.fromkeys(a.location.subject for a in attributes)))
        return
    # An author who typed one angle of an origin in degrees typed all three in degrees.
    words = [
        word for a in wrong.values() for word in tokenize_attribute(a, model.source.files) if parse_number(word.text)
    ]
    # Other numbers may have been tried as radians until the part looked right: 95 rad are 43°, and a part may stand so.
    are_sure = any(v % _USUAL_DEGREES == 0 and not _is_tried(v) for v in angles)
    finding = rule.finding(
        "degrees",
        at=attributes[0],
        related=list(wrong.values())[1:],
        edits=[
            word.build_edit(_format_radians(word, in_xacro=model.source.may_hold_expressions))
            for word in words
            if are_sure
        ],
        where=where,
        likely=", probably typed in degrees" if are_sure else "",
        worst=worst,
        turns=abs(worst) / math.tau,
        radians=math.radians(worst),
        same=math.remainder(worst, math.tau),
    )
    yield replace(finding, subjects=tuple(dict.fromkeys(a.location.subject for a in attributes)))


def _parse_angles(attribute: Attribute) -> tuple[float, ...]:
    return parse_numbers(attribute.value, 3) or ()


def _is_degrees(angle: float, step: float, near: float) -> bool:
    """Whether an angle is more than a turn, and not a fraction of a turn that sums of angles in radians come to."""
    size = abs(angle)
    fraction = size <= _MOST_TURNS * math.tau and abs(size - round(size / step) * step) <= near
    # Nobody types degrees to four decimals; an exporter writes an angle of little more than a turn so.
    is_computed = size < _LITTLE_MORE * math.tau and round(size, 3) != size
    return math.tau < size <= 360 * _MOST_TURNS and not fraction and not is_computed


def _is_tried(angle: float) -> bool:
    """Whether an angle puts a part square or diagonal as radians, and askew as degrees."""
    if _is_near_multiple(angle, _SQUARE):
        return not _is_near_multiple(math.radians(angle), _SQUARE)
    return _is_near_multiple(angle, _DIAGONAL) and angle % _USUAL_DEGREES != 0


def _is_near_multiple(angle: float, part: float) -> bool:
    return abs(math.remainder(angle, part)) < _LOOKS_RIGHT


def _format_radians(word: Token, *, in_xacro: bool) -> str:
    return f"${{radians({word.text})}}" if in_xacro else repr(math.radians(float(word.text)))
