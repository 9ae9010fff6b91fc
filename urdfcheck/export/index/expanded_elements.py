"""The expanded robot as plain values, to compare it with what an edit makes of it."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.export.index.robot_names import classify_name, classify_text, collect_part_names
from urdfcheck.export.index.source_index import ExpandedElement
from urdfcheck.source.text.xml import Element


def iter_expanded_elements(robot: Element) -> Iterator[ExpandedElement]:
    """Yield all elements of a robot in document order."""
    names = collect_part_names(robot)
    waiting = [(robot, 0)]
    while waiting:
        element, depth = waiting.pop()
        waiting += [(child, depth + 1) for child in reversed(element.children)]
        yield ExpandedElement(
            subject=element.subject,
            depth=depth,
            tag=element.tag,
            attributes=tuple(
                (attribute.name, attribute.value, classify_name(element, attribute, names)[0])
                for attribute in element.attributes.values()
            ),
            text=element.text.strip(),
            text_kind=classify_text(element, names),
        )
