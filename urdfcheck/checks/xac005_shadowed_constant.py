"""XAC005: constants of mathematics are xacro's own, or have all their digits."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.facts.likeness.typed_numbers import near_miss
from urdfcheck.source.load import Source
from urdfcheck.source.text.tokens import removal
from urdfcheck.source.text.values import number
from urdfcheck.source.text.xml import Attribute
from urdfcheck.source.xacro.usage import (
    Mentions,
    mentioned_elsewhere,
    names_read,
    own_trees,
    properties,
    reads_unseen_files,
)

_PI = re.compile(r"(?:M_)?PI", re.IGNORECASE)
_FRACTION = re.compile(r"(?:^|_)(?:half|two|2)?_?PI(?:_|\d|$|half|over)|^(?:M_)?2PI$", re.IGNORECASE)
_DEGREE = re.compile(r"DEG(?:REES?)?_?(?:2|TO)_?RAD(?:IANS?)?|D2R", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class _Constant:
    """What a property must mean: its name in words, its value, and what xacro writes for it."""

    words: str
    value: float
    expression: str


class _Read:
    """Which names something may read: an expression of any file of the model, its package or folder, or what is unseen."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.here = set().union(*(names_read(tree) for tree in source.trees.values()))
        # Where the expansion stopped, or did not follow an include to another package, nobody knows what reads a name.
        self.unknown = source.root is None or reads_unseen_files(source)

    @cached_property
    def elsewhere(self) -> Mentions:
        return mentioned_elsewhere(self.source)

    def maybe(self, name: str) -> bool:
        known = self.unknown or name in self.here
        return known or not self.elsewhere.complete or name in self.elsewhere.names


def check(source: Source, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    if not source.is_xacro:
        return
    read = _Read(source)
    for name, definitions in properties(own_trees(source)).items():
        for definition in definitions:
            value = definition.owner.attributes.get("value")
            typed = None if value is None else number(value.value)
            constant = None if value is None or typed is None else _constant(name, value.value)
            if value is not None and typed is not None and constant is not None:
                off = abs(typed / constant.value - 1)
                yield from _judge(name, value, constant, off, rel_tol, read, source, rule)


def _judge(
    name: str,
    value: Attribute,
    constant: _Constant,
    off: float,
    rel_tol: float,
    read: _Read,
    source: Source,
    rule: Rule,
) -> Iterator[Finding]:
    data: dict[str, Any] = {
        "name": name,
        "value": value.value,
        "constant": constant.words,
        "expression": constant.expression,
        "exact": constant.value,
        "relative": off,
        "digits": _digits(value.value),
    }
    removed = removal(value.owner, source.files)
    is_read = off > rel_tol and read.maybe(name)
    if is_read and name != "pi":
        edits = [] if value.span is None else [Edit(value.span, value.typed, constant.expression)]
        yield rule.finding("rounded" if off < 0.01 else "wrong", at=value, edits=edits, **data)
    elif off > rel_tol:
        severity = None if is_read else Severity.INFO
        yield rule.finding("hides" if name == "pi" else "unread", at=value, edits=removed, severity=severity, **data)
    elif name == "pi":
        yield rule.finding("redefined", at=value, edits=removed, severity=Severity.INFO, **data)


def _constant(name: str, text: str) -> _Constant | None:
    """The constant that a name promises; of names such as ``PI_2`` the value must say which fraction is meant."""
    if _PI.fullmatch(name):
        return _Constant("π", math.pi, "${pi}")
    if _DEGREE.fullmatch(name):
        return _Constant("π/180", math.pi / 180, "${pi / 180}")
    near = near_miss(text) if _FRACTION.search(name) else None
    return None if near is None else _Constant(near.constant.replace("pi", "π"), near.exact, near.expression)


def _digits(text: str) -> int:
    """The significant digits of a number as typed."""
    mantissa = text.lower().partition("e")[0]
    return len(re.sub(r"\D", "", mantissa).lstrip("0"))
