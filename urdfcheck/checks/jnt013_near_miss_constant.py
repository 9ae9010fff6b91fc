"""JNT013 reports fractions of π that are typed with too few digits or in several spellings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.typed_numbers import NearMiss, find_constant, find_near_miss
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import Token, tokenize_attribute
from urdfcheck.source.text.values import parse_number


@dataclass(slots=True)
class _ConstantSpellings:
    """How a file writes a constant, whatever its sign: the words of each short spelling, by its size (rad), and those with
    all digits, however they are spelled."""

    rounded: dict[float, list[Token]] = field(default_factory=dict)
    exact: list[Token] = field(default_factory=list)


def check(model: Model, rule: Rule, *, negligible: float, harmful: float) -> Iterator[Finding]:
    found: dict[tuple[str, str], _ConstantSpellings] = {}
    for word, value in _collect_angles(model):
        miss = find_near_miss(word.text)
        constant = find_constant(value) if miss is None else miss.constant.lstrip("-")
        if constant is None or (miss is not None and abs(miss.difference) < negligible):
            continue
        spellings = found.setdefault((word.span.file, constant), _ConstantSpellings())
        (spellings.exact if miss is None else spellings.rounded.setdefault(abs(value), [])).append(word)
    every = [
        _build_finding(model, rule, constant, spelt, harmful) for (_, constant), spelt in found.items() if spelt.rounded
    ]
    mild = [finding for finding in every if finding.severity is Severity.INFO]
    yield from (finding for finding in every if finding.severity is not Severity.INFO)
    yield from mild if len(mild) < 2 else [_build_group_finding(rule, mild)]


def _build_group_finding(rule: Rule, findings: list[Finding]) -> Finding:
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
        spellings=join_names(counts),
        count=sum(counts.values()),
        correct=join_names(dict.fromkeys(f.data["correct"].lstrip("-").replace("{-", "{") for f in findings)),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(subject for f in findings for subject in f.subjects)))


def _build_finding(model: Model, rule: Rule, constant: str, spellings: _ConstantSpellings, harmful: float) -> Finding:
    groups = sorted(spellings.rounded.values(), key=lambda group: -_measure_error(group[0]))
    words = sorted(
        (word for group in groups for word in group),
        key=lambda word: (-_measure_error(word), not _is_joint_origin(word)),
    )
    coarsest, off = groups[0], _measure_error(groups[0][0])
    ways = [
        f"`{_strip_sign(group[0])}` ({_describe_place(group)}, off by {_format_displacement(_measure_error(group[0]))})"
        for group in groups
    ]
    if spellings.exact:
        ways.append(f"`{_strip_sign(spellings.exact[0])}` ({_describe_place(spellings.exact)}, exact)")
    finding = rule.finding(
        "rounded" if len(ways) == 1 else "mixed",
        at=words[0],
        related=[*words[1:], *spellings.exact[:1]],
        edits=[word.build_edit(_format_correction(word, in_xacro=model.source.is_xacro)) for word in words],
        severity=Severity.WARNING
        if any(_measure_error(word) > harmful and _is_joint_origin(word) for word in words)
        else None,
        spelled=_strip_sign(coarsest[0]),
        times=_format_count(coarsest),
        count=len(words),
        constant=_format_constant(constant),
        difference=off,
        lever=_format_displacement(off),
        number=len(ways),
        ways=", ".join(ways),
        correct=_format_correction(words[0], in_xacro=model.source.is_xacro),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(word.location.subject for word in words)))


def _collect_angles(model: Model) -> list[tuple[Token, float]]:
    """The words of every origin's rpy with the angles (rad) that they stand for, each place in the text once however
    many elements were made from it."""
    found: dict[tuple[str, int], tuple[Token, float]] = {}
    for element in model.robot.walk():
        attribute = element.attributes.get("rpy") if element.tag == "origin" else None
        if attribute is None:
            continue
        words, values = tokenize_attribute(attribute, model.source.files), attribute.value.split()
        if len(words) == len(values):  # else an expression made several numbers
            for word, text in zip(words, values, strict=True):
                value = parse_number(text)
                if value is not None:
                    found.setdefault((word.span.file, word.span.start), (word, value))
    return list(found.values())


def _is_joint_origin(word: Token) -> bool:
    """Whether the angle places a link, not only a picture of it."""
    parent = word.attribute.owner.parent
    return parent is not None and parent.tag == "joint"


def _measure_error(word: Token) -> float:
    return abs(_get_near_miss(word).difference)


def _format_correction(word: Token, *, in_xacro: bool) -> str:
    return _get_near_miss(word).expression if in_xacro else repr(_get_near_miss(word).exact)


def _get_near_miss(word: Token) -> NearMiss:
    miss = find_near_miss(word.text)
    assert miss is not None, "the word was found by it"
    return miss


def _strip_sign(word: Token) -> str:
    return word.text.lstrip("+-")


def _format_constant(constant: str) -> str:
    return constant.replace("*pi", "π").replace("pi", "π")


def _format_count(words: list[Token]) -> str:
    return "once" if len(words) == 1 else f"{len(words)} times"


def _describe_place(words: list[Token]) -> str:
    """``joint wheel_4`` for the only word in ``joint[wheel_4]/origin@rpy``, else how many there are."""
    subject = words[0].location.subject.split("/")[0]
    return subject.replace("[", " ").rstrip("]") if len(words) == 1 else _format_count(words)


def _format_displacement(radians: float) -> str:
    """How far a point one metre away is displaced."""
    return f"{radians * 1e6:.2g} µm/m" if radians < 1e-4 else f"{radians * 1e3:.2g} mm/m"
