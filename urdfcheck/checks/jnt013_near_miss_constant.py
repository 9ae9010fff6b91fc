"""JNT013: a fraction of π has all its digits, and one spelling in a file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import listed
from urdfcheck.facts.likeness.typed_numbers import NearMiss, constant_of, near_miss
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import Word, words_of
from urdfcheck.source.text.values import number


@dataclass(slots=True)
class _Spellings:
    """How a file writes a constant, whatever its sign: the words of each short spelling, by its size (rad), and those with
    all digits, however they are spelled."""

    short: dict[float, list[Word]] = field(default_factory=dict)
    exact: list[Word] = field(default_factory=list)


def check(model: Model, rule: Rule, *, negligible: float, harmful: float) -> Iterator[Finding]:
    found: dict[tuple[str, str], _Spellings] = {}
    for word, value in _angles(model):
        miss = near_miss(word.text)
        constant = constant_of(value) if miss is None else miss.constant.lstrip("-")
        if constant is None or (miss is not None and abs(miss.difference) < negligible):
            continue
        spellings = found.setdefault((word.span.file, constant), _Spellings())
        (spellings.exact if miss is None else spellings.short.setdefault(abs(value), [])).append(word)
    every = [_finding(model, rule, constant, spelt, harmful) for (_, constant), spelt in found.items() if spelt.short]
    mild = [finding for finding in every if finding.severity is Severity.INFO]
    yield from (finding for finding in every if finding.severity is not Severity.INFO)
    yield from mild if len(mild) < 2 else [_together(rule, mild)]


def _together(rule: Rule, findings: list[Finding]) -> Finding:
    """Several constants, or files, of a robot: they were typed by one hand, or one exporter."""
    counts: dict[str, int] = {}
    for finding in findings:
        spelling = "`{spelled}` for {constant} (off by {lever})".format_map(finding.data)
        counts[spelling] = counts.get(spelling, 0) + finding.data["count"]
    finding = rule.finding(
        "several",
        at=findings[0].location,
        related=[place for f in findings for place in (f.location, *f.related)][1:],
        edits=[edit for f in findings if f.fix is not None for edit in f.fix.edits],
        spellings=listed(counts),
        count=sum(counts.values()),
        correct=listed(dict.fromkeys(f.data["correct"].lstrip("-").replace("{-", "{") for f in findings)),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(subject for f in findings for subject in f.subjects)))


def _finding(model: Model, rule: Rule, constant: str, spellings: _Spellings, harmful: float) -> Finding:
    groups = sorted(spellings.short.values(), key=lambda group: -_off(group[0]))
    words = sorted((word for group in groups for word in group), key=lambda word: (-_off(word), not _places(word)))
    coarsest, off = groups[0], _off(groups[0][0])
    ways = [f"`{_size(group[0])}` ({_where(group)}, off by {_lever(_off(group[0]))})" for group in groups]
    if spellings.exact:
        ways.append(f"`{_size(spellings.exact[0])}` ({_where(spellings.exact)}, exact)")
    finding = rule.finding(
        "rounded" if len(ways) == 1 else "mixed",
        at=words[0],
        related=[*words[1:], *spellings.exact[:1]],
        edits=[word.replaced(_correct(word, in_xacro=model.source.is_xacro)) for word in words],
        severity=Severity.WARNING if any(_off(word) > harmful and _places(word) for word in words) else None,
        spelled=_size(coarsest[0]),
        times=_times(coarsest),
        count=len(words),
        constant=_symbol(constant),
        difference=off,
        lever=_lever(off),
        number=len(ways),
        ways=", ".join(ways),
        correct=_correct(words[0], in_xacro=model.source.is_xacro),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(word.location.subject for word in words)))


def _angles(model: Model) -> list[tuple[Word, float]]:
    """The words of every origin's rpy with the angles (rad) that they stand for, each place in the text once however
    many elements were made from it."""
    found: dict[tuple[str, int], tuple[Word, float]] = {}
    for element in model.robot.walk():
        attribute = element.attributes.get("rpy") if element.tag == "origin" else None
        if attribute is None:
            continue
        words, values = words_of(attribute, model.source.files), attribute.value.split()
        if len(words) == len(values):  # else an expression made several numbers
            for word, text in zip(words, values, strict=True):
                value = number(text)
                if value is not None:
                    found.setdefault((word.span.file, word.span.start), (word, value))
    return list(found.values())


def _places(word: Word) -> bool:
    """Whether the angle places a link, not only a picture of it."""
    parent = word.attribute.owner.parent
    return parent is not None and parent.tag == "joint"


def _off(word: Word) -> float:
    return abs(_miss(word).difference)


def _correct(word: Word, *, in_xacro: bool) -> str:
    return _miss(word).expression if in_xacro else repr(_miss(word).exact)


def _miss(word: Word) -> NearMiss:
    miss = near_miss(word.text)
    assert miss is not None, "the word was found by it"
    return miss


def _size(word: Word) -> str:
    return word.text.lstrip("+-")


def _symbol(constant: str) -> str:
    return constant.replace("*pi", "π").replace("pi", "π")


def _times(words: list[Word]) -> str:
    return "once" if len(words) == 1 else f"{len(words)} times"


def _where(words: list[Word]) -> str:
    """``joint wheel_4`` for the only word in ``joint[wheel_4]/origin@rpy``, else how many there are."""
    subject = words[0].location.subject.split("/")[0]
    return subject.replace("[", " ").rstrip("]") if len(words) == 1 else _times(words)


def _lever(radians: float) -> str:
    """How far a point one metre away is displaced."""
    return f"{radians * 1e6:.2g} µm/m" if radians < 1e-4 else f"{radians * 1e3:.2g} mm/m"
