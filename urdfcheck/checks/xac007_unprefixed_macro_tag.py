"""XAC007 reports tags of xacro and calls of macros without the prefix."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import format_repetition, join_names
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.model_role import has_unprefixed_calls
from urdfcheck.source.text.xml import Element, SourceFile
from urdfcheck.source.xacro.usage import collect_uncalled_links, find_unprefixed_tags

# At most so many tags of one file are listed, and renamed by one fix.
_MAX_EDITED = 500

# What programs do with a robot whose links are all in macros that it does not call (KIN007).
WITHOUT_LINKS = {
    "urdfdom": "refuses the file: no link elements found",
    "bullet": "refuses the file: no links found",
    "mujoco": "creates an empty model",
    "drake": "creates an empty model",
}


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    own_trees = select_own_trees(source)
    left_over = _find_places_in_robot(source)
    # The links of a robot without links are in the macros that it does not call.
    explained = [f"KIN007 {source.root.subject}"] if source.root and has_unprefixed_calls(source, source.root) else []
    explained += _list_joints_to_uncalled_links(source)
    by_file: dict[str, list[Element]] = {}
    for element in find_unprefixed_tags(source.trees):
        span = element.span
        if span is not None and (span.file in own_trees or (span.file, span.start) in left_over):
            by_file.setdefault(span.file, []).append(element)
    for name, elements in by_file.items():
        tags = list(dict.fromkeys(e.tag for e in elements))
        finding = rule.finding(
            "unprefixed" if source.is_xacro else "plain",
            at=elements[0],
            related=elements[1:_MAX_EDITED],
            edits=_propose_edits(elements, source.trees[name], source.files[name]) if source.is_xacro else [],
            severity=None if source.is_xacro else Severity.WARNING,
            tag=elements[0].tag,
            tags=tags,
            listed=join_names(f"<{tag}>" for tag in tags),
            times=format_repetition(len(elements)),
            explains=explained,
            consequences=WITHOUT_LINKS if explained and source.root and not source.root.find_children("link") else {},
        )
        yield replace(finding, subjects=tuple(dict.fromkeys(e.subject for e in elements[:_MAX_EDITED])))


def _list_joints_to_uncalled_links(source: Source) -> list[str]:
    """Return the joints of which all missing links are those that the calls would make, as claims of what explains KIN002."""
    if source.root is None or not source.is_xacro:
        return []
    made = collect_uncalled_links(source.trees, source.root)
    links = {link.get("name") for link in source.root.find_children("link")}
    explained: list[str] = []
    for joint in source.root.find_children("joint") if made else ():
        ends = (joint.find_child(tag) for tag in ("parent", "child"))
        missing = {end.get("link") for end in ends if end is not None} - links
        if missing and missing <= made:
            explained.append(f"KIN002 {joint.subject}")
    return explained


def _find_places_in_robot(source: Source) -> set[tuple[str, int]]:
    """Return the files and offsets of the tags that are left in the robot: the file of another package is wrong there too."""
    if source.root is None or not source.is_xacro:
        return set()
    left = find_unprefixed_tags(source.trees, source.root)
    return {(element.span.file, element.span.start) for element in left if element.span is not None}


def _propose_edits(elements: Sequence[Element], root: Element, file: SourceFile) -> list[Edit]:
    """Return edits that add the prefix to all start and end tags.

    Nothing if the prefix is not declared or an end tag is not found: half of the edits would be worse than none.
    """
    edits: list[Edit] = []
    for element in elements if len(elements) <= _MAX_EDITED else ():
        places = _find_tag_offsets(element, file.text)
        if not places or "xmlns:xacro" not in root.attributes:
            return []
        tag = element.tag
        edits += [Edit(file.make_span(at, at + len(tag)), tag, f"xacro:{tag}") for at in places]
    return edits


def _find_tag_offsets(element: Element, text: str) -> list[int]:
    """Return the offsets of an element's name in its start tag and its end tag; nothing if the end tag is not certain."""
    if element.span is None:
        return []
    start = element.span.start + 1
    if text.endswith("/>", 0, element.span.end):
        return [start]
    inside = [(e.tag, e.span.end) for e in element.walk() if e.span is not None]
    last = max(end for _, end in inside)
    end = re.compile(rf"</{re.escape(element.tag)}\s*>").search(text, last)
    if end is None or any(tag == element.tag for tag, _ in inside[1:]) or "<!--" in text[last : end.start()]:
        return []
    return [start, end.start() + 2]
