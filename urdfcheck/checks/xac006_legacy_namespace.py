"""XAC006: the xacro prefix is bound to xacro's own namespace."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from urdfcheck.core import Applicability, Edit, Finding, Rule
from urdfcheck.source.load import Source
from urdfcheck.source.usage import own_trees
from urdfcheck.source.xml import Attribute

CURRENT = "http://www.ros.org/wiki/xacro"
# What the wiki's own pages declared at some time; every release of xacro takes it.
_ACCEPTED = frozenset({CURRENT, "http://wiki.ros.org/xacro"})
_LEGACY = ("http://ros.org/wiki/xacro", "http://www.ros.org/wiki/xacro/#")
# Closer than this to the current one, an unknown address is a slip of the finger and not a name of one's own.
_ALIKE = 0.9


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    if not source.is_xacro:
        return
    for tree in own_trees(source).values():
        for element in tree.walk():
            namespace = element.attributes.get("xmlns:xacro")
            message = None if namespace is None else _message(namespace.value.strip())
            if namespace is not None and message is not None:
                yield rule.finding(
                    message,
                    at=namespace,
                    edits=_edits(namespace),
                    applicability=Applicability.SAFE,
                    namespace=namespace.value,
                    current=CURRENT,
                )


def _message(namespace: str) -> str | None:
    if namespace in _ACCEPTED:
        return None
    if namespace.startswith(_LEGACY):
        return "legacy"
    return "misspelt" if difflib.SequenceMatcher(None, namespace, CURRENT).ratio() >= _ALIKE else None


def _edits(namespace: Attribute) -> list[Edit]:
    return [] if namespace.span is None else [Edit(namespace.span, namespace.typed, CURRENT)]
