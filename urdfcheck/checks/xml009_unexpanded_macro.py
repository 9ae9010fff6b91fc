"""XML009 reports xacro that remains unexpanded."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import format_count, truncate_text
from urdfcheck.source.load import Source, has_unbound_xacro
from urdfcheck.source.text.grammar import NUMERIC_ATTRIBUTES, is_unexpanded, iter_urdf_elements
from urdfcheck.source.text.xml import Element

_SUBSTITUTION = re.compile(r"\$\{[^}]*\}?|\$\([^)]*\)?")

# The reactions of Drake and Bullet to the file, by whether a number is missing in it.
CONSEQUENCES = {
    False: {"drake": "loads it", "bullet": "loads it"},
    True: {"drake": "refuses the file", "bullet": "replaces the number by 0, or refuses the file"},
}


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    root = source.root
    if root is None or root.tag != "robot":
        return
    if source.is_xacro:
        for element in iter_urdf_elements(root):
            for where, text, number in _find_unexpanded_xacro(element):
                yield rule.finding("left", at=where, consequences=CONSEQUENCES[number], text=text)
        return
    if has_unbound_xacro(source):
        return  # XML001: xacro cannot read it either
    left = [place for element in root.walk() for place in _find_unexpanded_xacro(element)]
    if left:
        tags = sum(text.startswith("<") for _, text, _ in left)
        counts = ((tags, "xacro element"), (len(left) - tags, "substitution"))
        yield rule.finding(
            "not_expanded",
            at=left[0][0],
            consequences=CONSEQUENCES[any(number for *_, number in left)],
            text=left[0][1],
            held=" and ".join(format_count(count, what) for count, what in counts if count),
        )


def _find_unexpanded_xacro(element: Element) -> Iterator[tuple[Location, str, bool]]:
    """Yield the places of xacro in one element, each with its text and whether a number should be there."""
    numbers = NUMERIC_ATTRIBUTES.get(element.tag, {})
    if element.tag.startswith("xacro:"):
        yield element.location, f"<{element.tag}>", False
    for attribute in element.attributes.values():
        if is_unexpanded(attribute.value):
            yield attribute.location, _shorten_expression(attribute.value), attribute.name in numbers
    if is_unexpanded(element.text):
        yield element.location, _shorten_expression(element.text), False


def _shorten_expression(text: str) -> str:
    match = _SUBSTITUTION.search(text)
    return truncate_text(match.group(0) if match else text.strip(), 60)
