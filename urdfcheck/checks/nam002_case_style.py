"""NAM002 reports names that are spelled in another style than the others of the robot."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Link, Model
from urdfcheck.source.text.xml import Attribute

_CAMEL = re.compile(r"[a-z][A-Z]")
# Names whose spelling REP 105 and REP 199 fix, whatever the robot's style.
_STANDARD = frozenset({"world", "map", "odom", "base_footprint", "base_link", "base", "flange", "tool0"})


def check(model: Model, rule: Rule, *, least: int, share: float) -> Iterator[Finding]:
    odd: list[Attribute] = []
    styles: list[str] = []
    for parts in (model.links, model.joints):
        style, outliers = _find_style_outliers(parts, least, share)
        odd += outliers
        if outliers:
            styles.append(style)
    if odd:
        finding = rule.finding(
            "odd",
            at=odd[0],
            related=odd[1:10],
            names=join_names(dict.fromkeys(attribute.value for attribute in odd)),
            spelled=" and ".join(dict.fromkeys(styles)),
        )
        yield replace(finding, subjects=tuple(attribute.location.subject for attribute in odd))


def _find_style_outliers(parts: Sequence[Link | Joint], least: int, share: float) -> tuple[str, list[Attribute]]:
    """Return the style of almost all names of a kind, and the names of another style; a name that fits both counts as neither."""
    named = [p.element.attributes["name"] for p in parts if p.name and p.name not in _STANDARD]
    styled = [(attribute, style) for attribute in named if (style := _classify_case_style(attribute.value)) is not None]
    for style in ("lower case", "camelCase"):
        odd = [attribute for attribute, other in styled if other != style]
        usual = len(styled) - len(odd)
        if usual >= least and usual >= share * len(styled):
            return style, odd
    return "", []


def _classify_case_style(name: str) -> str | None:
    """Return the style of a name, or None for one lower-case word, which fits every style."""
    if _CAMEL.search(name):
        return "camelCase"
    if any(c.isupper() for c in name):
        return "capitals"
    return "lower case" if re.search(r"[^\W_]_[^\W_]", name) else None
