"""JNT014: origins hold dimensions, not the residue of a CAD program's arithmetic."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.facts.literals import is_noise_angle, is_noise_length
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint, Link
from urdfcheck.source.values import number
from urdfcheck.source.words import Word, words_of
from urdfcheck.source.xml import Element


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    parts: list[tuple[str, Link | Joint]] = [("link", link) for link in model.links]
    parts += [("joint", joint) for joint in model.joints]
    for kind, part in parts:
        noise = [word for origin in _origins(part.element) for word in _noise(origin, model)]
        if noise:
            largest = max(noise, key=lambda word: abs(float(word.text)))
            angle = largest.attribute.name == "rpy"
            yield rule.finding(
                "noise",
                at=noise[0],
                related=noise[1:],
                edits=[word.replaced("0") for word in noise],
                kind=kind,
                name=part.name,
                numbers=", ".join(word.text for word in noise[:3]) + (" …" if len(noise) > 3 else ""),
                size=abs(float(largest.text)),
                unit="rad" if angle else "m",
            )


def _origins(element: Element) -> Iterator[Element]:
    """The origins of a link's or a joint's own parts."""
    return (e for e in element.walk() if e.tag == "origin" and e.parent is not None)


def _noise(origin: Element, model: Model) -> Iterator[Word]:
    for name, is_noise in (("xyz", is_noise_length), ("rpy", is_noise_angle)):
        for word in words_of(origin.attributes.get(name), model.source.files):
            value = number(word.text)
            if value is not None and is_noise(value):
                yield word
