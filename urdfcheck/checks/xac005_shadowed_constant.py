"""XAC005 reports mathematical constants that hide those of xacro or lack digits."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import cached_property
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.typed_numbers import find_near_miss
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute
from urdfcheck.source.uses_elsewhere import XacroMentions, collect_outside_mentions, has_unseen_includes
from urdfcheck.source.xacro.usage import collect_properties, collect_read_names

_PI = re.compile(r"(?:M_)?PI", re.IGNORECASE)
_FRACTION = re.compile(r"(?:^|_)(?:half|two|2)?_?PI(?:_|\d|$|half|over)|^(?:M_)?2PI$", re.IGNORECASE)
_DEGREE = re.compile(r"DEG(?:REES?)?_?(?:2|TO)_?RAD(?:IANS?)?|D2R", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class _MathConstant:
    """A constant that the name of a property promises."""

    words: str
    value: float
    expression: str
    """The expression of xacro for it."""


class _ReadableNames:
    """The names that something may read: an expression in the model, its package or folder, or a file that is not found."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.here = set().union(*(collect_read_names(tree) for tree in source.trees.values()))
        # After a failed expansion or an include that was not followed, the readers of a name are unknown.
        self.unknown = source.root is None or has_unseen_includes(source)

    @cached_property
    def mentions_elsewhere(self) -> XacroMentions:
        return collect_outside_mentions(self.source)

    def may_be_read(self, name: str) -> bool:
        known = self.unknown or name in self.here
        return known or not self.mentions_elsewhere.complete or name in self.mentions_elsewhere.names


def check(source: Source, rule: Rule, *, rel_tol: float, visible: float) -> Iterator[Finding]:
    if not source.is_xacro:
        return
    names = _ReadableNames(source)
    for name, definitions in collect_properties(select_own_trees(source)).items():
        for definition in definitions:
            value = definition.owner.attributes.get("value")
            typed = None if value is None else parse_number(value.value)
            constant = None if value is None or typed is None else _match_constant(name, value.value)
            if value is not None and typed is not None and constant is not None:
                off = abs(typed / constant.value - 1)
                yield from _check_constant(
                    source,
                    rule,
                    name=name,
                    value=value,
                    constant=constant,
                    off=off,
                    rel_tol=rel_tol,
                    visible=visible,
                    names=names,
                )


def _check_constant(
    source: Source,
    rule: Rule,
    *,
    name: str,
    value: Attribute,
    constant: _MathConstant,
    off: float,
    rel_tol: float,
    visible: float,
    names: _ReadableNames,
) -> Iterator[Finding]:
    """Report a constant that is ``off`` by this share, or that hides pi itself."""
    data: dict[str, Any] = {
        "name": name,
        "value": value.value,
        "constant": constant.words,
        "expression": constant.expression,
        "exact": constant.value,
        "relative": off,
        "digits": _count_significant_digits(value.value),
    }
    removed = build_removal_edits(value.owner, source.files)
    is_read = off > rel_tol and names.may_be_read(name)
    # A file that the model does not reach may read the name, and may define it itself.
    severity = None if is_read and name in names.here and off > visible else Severity.INFO
    if is_read and name != "pi":
        edits = [] if value.span is None else [Edit(value.span, value.typed, constant.expression)]
        yield rule.finding("rounded" if off < 0.01 else "wrong", at=value, edits=edits, severity=severity, **data)
    elif off > rel_tol:
        yield rule.finding("hides" if name == "pi" else "unread", at=value, edits=removed, severity=severity, **data)
    elif name == "pi":
        yield rule.finding("redefined", at=value, edits=removed, severity=Severity.INFO, **data)


def _match_constant(name: str, text: str) -> _MathConstant | None:
    """Return the constant that a name promises; the value decides which fraction a name such as ``PI_2`` means."""
    if _PI.fullmatch(name):
        return _MathConstant("π", math.pi, "${pi}")
    if _DEGREE.fullmatch(name):
        return _MathConstant("π/180", math.pi / 180, "${pi / 180}")
    near = find_near_miss(text) if _FRACTION.search(name) else None
    return None if near is None else _MathConstant(near.constant.replace("pi", "π"), near.exact, near.expression)


def _count_significant_digits(text: str) -> int:
    """Count the significant digits of a number as typed."""
    mantissa = text.lower().partition("e")[0]
    return len(re.sub(r"\D", "", mantissa).lstrip("0"))
