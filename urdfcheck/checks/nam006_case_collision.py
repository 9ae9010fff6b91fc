"""NAM006 reports names that differ only in upper and lower case."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Joint, Link, Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_case_clashes("link", model.links, rule)
    yield from _check_case_clashes("joint", model.joints, rule)


def _check_case_clashes(kind: str, parts: tuple[Link, ...] | tuple[Joint, ...], rule: Rule) -> Iterator[Finding]:
    """One finding for each name that several parts of a kind spell differently. One spelling twice is a duplicate."""
    alike: dict[str, dict[str, Link | Joint]] = {}
    for part in parts:
        alike.setdefault(part.name.casefold(), {}).setdefault(part.name, part)
    for spellings in alike.values():
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
