"""XML009: xacro that nothing has expanded."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.source.grammar import elements, is_unexpanded
from urdfcheck.source.load import Source
from urdfcheck.source.xml import Element

_SUBSTITUTION = re.compile(r"\$\{[^}]*\}?|\$\([^)]*\)?")


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    root = source.root
    if root is None or root.tag != "robot":
        return
    if source.is_xacro:
        for element in elements(root):
            for where, text in _left(element):
                yield rule.finding("left", at=where, text=text)
        return
    found = [place for element in root.walk() for place in _left(element)]
    if found:
        tags = sum(text.startswith("<") for _, text in found)
        yield rule.finding("not_expanded", at=found[0][0], text=found[0][1], elements=tags, values=len(found) - tags)


def _left(element: Element) -> Iterator[tuple[Location, str]]:
    """What is left of xacro in one element, with the text that shows it."""
    if element.tag.startswith("xacro:"):
        yield element.location, f"<{element.tag}>"
    for attribute in element.attributes.values():
        if is_unexpanded(attribute.value):
            yield attribute.location, _shown(attribute.value)
    if is_unexpanded(element.text):
        yield element.location, _shown(element.text)


def _shown(text: str) -> str:
    match = _SUBSTITUTION.search(text)
    shown = match.group(0) if match else text.strip()
    return shown if len(shown) <= 60 else shown[:57] + "..."
