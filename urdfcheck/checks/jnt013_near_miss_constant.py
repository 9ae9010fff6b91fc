"""JNT013: a fraction of π has all its digits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.facts.literals import EXACT, NearMiss, is_exact, near_miss
from urdfcheck.model import Model
from urdfcheck.source.words import Word, words_of


def check(model: Model, rule: Rule, *, negligible: float) -> Iterator[Finding]:
    words = _typed_angles(model)
    groups: dict[tuple[str, str], list[Word]] = {}
    for word in words:
        miss = near_miss(word.text)
        if miss is not None and abs(miss.difference) >= negligible:
            groups.setdefault((word.span.file, word.text.lstrip("+-")), []).append(word)
    for (file, spelled), group in groups.items():
        miss = near_miss(spelled)
        assert miss is not None, "the group was made by it"
        exact = _exact_sibling(miss, [w for w in words if w.span.file == file])
        finding = rule.finding(
            "rounded" if exact is None else "mixed",
            at=group[0],
            related=[*([] if exact is None else [exact]), *group[1:]],
            edits=[w.replaced(_written(w, in_xacro=model.source.is_xacro)) for w in group],
            spelled=spelled,
            times="once" if len(group) == 1 else f"{len(group)} times",
            constant=_symbol(miss.constant),
            difference=abs(miss.difference),
            lever=_length(abs(miss.difference)),
            correct=_written(group[0], in_xacro=model.source.is_xacro),
            sibling="" if exact is None else _part(exact),
            digits="" if exact is None else exact.text,
        )
        yield replace(finding, subjects=tuple(dict.fromkeys(w.location.subject for w in group)))


def _typed_angles(model: Model) -> list[Word]:
    """The words of every origin's rpy, each place in the text once however many elements were made from it."""
    found: dict[tuple[str, int], Word] = {}
    for element in model.robot.walk():
        if element.tag == "origin":
            for word in words_of(element.attributes.get("rpy"), model.source.files):
                found.setdefault((word.span.file, word.span.start), word)
    return list(found.values())


def _exact_sibling(miss: NearMiss, words: list[Word]) -> Word | None:
    for word in words:
        if is_exact(word.text) and abs(abs(float(word.text)) - abs(miss.exact)) <= EXACT:
            return word
    return None


def _written(word: Word, *, in_xacro: bool) -> str:
    miss = near_miss(word.text)
    assert miss is not None, "only near misses are rewritten"
    return miss.expression if in_xacro else repr(miss.exact)


def _symbol(constant: str) -> str:
    return constant.replace("*pi", "π").replace("pi", "π")


def _length(radians: float) -> str:
    """How far a point one metre away is displaced."""
    return f"{radians * 1e6:.2g} µm" if radians < 1e-4 else f"{radians * 1e3:.2g} mm"


def _part(word: Word) -> str:
    """``joint wheel_4`` for a word of ``joint[wheel_4]/origin@rpy``."""
    return word.location.subject.split("/")[0].replace("[", " ").rstrip("]")
