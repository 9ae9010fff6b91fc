"""XAC006 reports xacro prefixes that are not bound to xacro's current namespace."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Applicability, Finding, Rule
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute

CURRENT = "http://www.ros.org/wiki/xacro"
# The wiki's own pages once declared the second one; every release of xacro accepts it.
_ACCEPTED = frozenset({CURRENT, "http://wiki.ros.org/xacro"})
_LEGACY = ("http://ros.org/wiki/xacro", "http://www.ros.org/wiki/xacro/#")
# An unknown address this much like the current one is a misspelling, not another namespace.
_MIN_SIMILARITY = 0.9


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    if not source.is_xacro:
        return
    typed: dict[str, list[Attribute]] = {}
    for tree in select_own_trees(source).values():
        for element in tree.walk():
            namespace = element.attributes.get("xmlns:xacro")
            if namespace is not None:
                typed.setdefault(namespace.value.strip(), []).append(namespace)
    for address, places in typed.items():
        message = _choose_message(address)
        if message is not None:
            finding = rule.finding(
                message,
                at=places[0],
                related=places[1:],
                edits=[edit for place in places for edit in build_replacement_edits([place], CURRENT)],
                applicability=Applicability.SAFE,
                namespace=address,
                files="" if len(places) == 1 else f" in {len(places)} files",
                current=CURRENT,
            )
            yield replace(finding, subjects=tuple(dict.fromkeys(place.location.subject for place in places)))


def _choose_message(namespace: str) -> str | None:
    if namespace in _ACCEPTED:
        return None
    if namespace.startswith(_LEGACY):
        return "legacy"
    return "misspelt" if difflib.SequenceMatcher(None, namespace, CURRENT).ratio() >= _MIN_SIMILARITY else None
