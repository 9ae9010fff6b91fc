"""NAM006 reports names that differ only in upper and lower case."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Joint, Link, Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_case_clashes("link", model.links, rule)
    yield from _check_case_clashes("joint", model.joints, rule)


def _check_case_clashes(kind: str, parts: tuple[Link, ...] | tuple[Joint, ...], rule: Rule) -> Iterator[Finding]:
    """Report each name that parts of a kind spell differently; one spelling twice is a duplicate (KIN001)."""
    by_key: dict[str, dict[str, Link | Joint]] = {}
    for part in parts:
        by_key.setdefault(part.name.casefold(), {}).setdefault(part.name, part)
    for spellings in by_key.values():
        if len(spellings) > 1:
            first, second, *others = [part.element.attributes["name"] for part in spellings.values()]
            yield rule.finding(
                "alike",
                at=second,
                related=[first, *others],
                kind=kind,
                first=first.value,
                second=" and ".join(repr(attribute.value) for attribute in (second, *others)),
            )
