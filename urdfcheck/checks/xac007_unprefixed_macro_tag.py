"""XAC007 reports tags of xacro and calls of macros without the prefix."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.text.xml import Element, SourceFile
from urdfcheck.source.xacro.usage import find_unprefixed_tags

# Tags of one file that are listed, and mended in one go.
_MAX_EDITED = 500


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    own = select_own_trees(source)
    by_file: dict[str, list[Element]] = {}
    for element in find_unprefixed_tags(source.trees):
        if element.span is not None and element.span.file in own:
            by_file.setdefault(element.span.file, []).append(element)
    for name, found in by_file.items():
        tags = list(dict.fromkeys(e.tag for e in found))
        finding = rule.finding(
            "unprefixed" if source.is_xacro else "plain",
            at=found[0],
            related=found[1:_MAX_EDITED],
            edits=_propose_edits(found, own[name], source.files[name]) if source.is_xacro else [],
            severity=None if source.is_xacro else Severity.WARNING,
            tag=found[0].tag,
            tags=tags,
            listed=join_names([f"<{tag}>" for tag in tags]),
            times="" if len(found) == 1 else f" ({len(found)} times)",
        )
        yield replace(finding, subjects=tuple(dict.fromkeys(e.subject for e in found[:_MAX_EDITED])))


def _propose_edits(found: Sequence[Element], root: Element, file: SourceFile) -> list[Edit]:
    """The prefix before each of the names, in the end tags too; none where the prefix is not declared or an end tag is not
    found, for half of them would be worse than none."""
    edits: list[Edit] = []
    for element in found if len(found) <= _MAX_EDITED else ():
        places = _find_tag_offsets(element, file.text)
        if not places or "xmlns:xacro" not in root.attributes:
            return []
        tag = element.tag
        edits += [Edit(file.make_span(at, at + len(tag)), tag, f"xacro:{tag}") for at in places]
    return edits


def _find_tag_offsets(element: Element, text: str) -> list[int]:
    """Where an element's name stands, in its start tag and in its end tag; none where the end tag cannot be told."""
    assert element.span is not None
    start = element.span.start + 1
    if text.endswith("/>", 0, element.span.end):
        return [start]
    inside = [e for e in element.walk() if e.span is not None]
    last = max(e.span.end for e in inside if e.span is not None)
    end = re.compile(rf"</{re.escape(element.tag)}\s*>").search(text, last)
    if end is None or any(e.tag == element.tag for e in inside[1:]) or "<!--" in text[last : end.start()]:
        return []
    return [start, end.start() + 2]
