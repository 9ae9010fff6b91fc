"""JNT014 reports numbers in origins and axes that are only a CAD program's rounding noise."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from urdfcheck.core import Applicability, Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.typed_numbers import is_noise_angle, is_noise_length
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import Token, tokenize_attribute
from urdfcheck.source.text.values import parse_number, read_attribute_numbers
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    by_file: dict[str, dict[int, Token]] = {}
    for part in model.named_elements:
        for element in part.element.walk():
            for word in _find_noise_words(element, model):
                by_file.setdefault(word.span.file, {}).setdefault(word.span.start, word)
    for places in by_file.values():
        words = list(places.values())
        largest = max(words, key=lambda word: abs(float(word.text)))
        unit = "rad" if largest.attribute.name == "rpy" else "m" if largest.attribute.owner.tag == "origin" else "1"
        finding = rule.finding(
            "noise",
            at=words[0],
            related=words[1:],
            edits=[word.build_edit("0") for word in words],
            applicability=Applicability.SAFE,  # nothing can tell such a length or angle from zero
            count=f"{len(words)} numbers are" if len(words) > 1 else "one number is",
            parts=join_names(dict.fromkeys(_get_part_name(word) for word in words)),
            largest=largest.text,
            size=abs(float(largest.text)),
            unit=unit,
            bound=f"`{largest.text}`" + ("" if unit == "1" else f" {unit}"),
        )
        yield replace(finding, subjects=tuple(dict.fromkeys(word.location.subject for word in words)))


def _find_noise_words(element: Element, model: Model) -> Iterator[Token]:
    """Iterate over the words of an origin or an axis that mean zero."""
    kinds: list[tuple[str, Callable[[float], bool]]] = []
    if element.tag == "origin":
        kinds = [("xyz", is_noise_length), ("rpy", is_noise_angle)]
    elif element.tag == "axis" and math.hypot(*(read_attribute_numbers(element, "xyz", 3, default=()) or ())) > 0.5:
        kinds = [("xyz", is_noise_length)]  # relative to the axis, whose length is 1
    for name, is_noise in kinds:
        numbers = map(parse_number, element.get(name).split())
        if not any(number is not None and is_noise(number) for number in numbers):
            continue  # nearly all: to find the places of words takes longer
        for word in tokenize_attribute(element.attributes.get(name), model.source.files):
            value = parse_number(word.text)
            if value is not None and is_noise(value):
                yield word


def _get_part_name(word: Token) -> str:
    """Return ``wheel_4`` for a word of ``joint[wheel_4]/origin@rpy``."""
    return word.location.subject.split("/")[0].partition("[")[2].rstrip("]")
