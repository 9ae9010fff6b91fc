"""Where the nodes of an expanded document were typed: each node of xacro's document carries its origin."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any
from xml.dom import UserDataHandler, minidom

from urdfcheck.core import Location, Span
from urdfcheck.source.text.xml import Attribute, Definition, Element

_USER_DATA_KEY = "urdfcheck"
# Characters that end a name when a document is read again.
_INVALID_NAME = re.compile(r"""[\s<>&"'=/]""")


@dataclass(slots=True, eq=False)
class Origin:
    """Where a node of the document was typed."""

    raw: Element
    """The element as typed."""
    via: tuple[Span, ...] | None = None
    """The macro calls and includes around it, outermost first; set when the node is evaluated."""
    reads: dict[str, tuple[Definition, ...]] = field(default_factory=dict)
    """The definitions that each attribute was computed from."""
    added: dict[str, Attribute] = field(default_factory=dict)
    """Attributes that ``<xacro:attribute>`` or a namespace import added."""


class InvalidOutputError(Exception):
    """The expanded document cannot be written as XML."""

    def __init__(self, message: str, location: Location) -> None:
        super().__init__(message)
        self.location = location


class _OriginCopier(UserDataHandler):
    """Copies an origin to a clone, so that each use of a macro's body keeps its own chain of calls."""

    def handle(self, operation: int, key: str, data: Origin, _src: Any, dst: Any) -> None:
        # Cloning a node below one that an include brought in counts as an import from the other document.
        if operation in (self.NODE_CLONED, self.NODE_IMPORTED):
            clone = Origin(data.raw, data.via, reads=dict(data.reads), added=dict(data.added))
            dst.setUserData(key, clone, self)


_ORIGIN_COPIER = _OriginCopier()


def attach_origins(node: minidom.Element, raw: Element) -> None:
    """Give each node of a freshly parsed document the located element of the same place."""
    stack = [(node, raw)]
    while stack:
        node, raw = stack.pop()
        node.setUserData(_USER_DATA_KEY, Origin(raw), _ORIGIN_COPIER)
        children = [c for c in node.childNodes if c.nodeType == c.ELEMENT_NODE]
        stack.extend(zip(children, raw.children, strict=True))


def get_origin(node: Any) -> Origin | None:
    """Return the origin of a node; None for a node that was not typed."""
    return None if node is None else node.getUserData(_USER_DATA_KEY)


def convert_node(node: minidom.Element, parent: Element | None) -> Element:
    """Return the expanded document as located elements.

    :raises InvalidOutputError: if a tag or attribute has a name that is not XML.
    """
    origin = get_origin(node)
    via = (origin.via or ()) if origin is not None else ()
    element = Element(node.tagName, None if origin is None else origin.raw.span, parent, via=via)
    for name in (node.tagName, *node.attributes.keys()):
        if _INVALID_NAME.search(name) or not name:  # xacro:element and xacro:attribute take any text as a name
            place = Location("robot" if parent is None else parent.subject, element.span, via)
            message = f"{name!r} is no name of an element or attribute: what xacro writes is no XML"
            raise InvalidOutputError(message, place)
    for name, value in node.attributes.items():
        element.attributes[name] = _convert_attribute(name, value, owner=element, origin=origin)
    for child in node.childNodes:
        if child.nodeType == child.ELEMENT_NODE:
            element.children.append(convert_node(child, element))
        elif child.nodeType in (child.TEXT_NODE, child.CDATA_SECTION_NODE):
            element.text += child.data
    return element


def _convert_attribute(name: str, value: str, *, owner: Element, origin: Origin | None) -> Attribute:
    typed: Attribute | None = None
    reads: tuple[Definition, ...] = ()
    if origin is not None:
        raw = origin.raw.attributes
        typed = raw.get(name) or (raw.get("xacro:targetNamespace") if name == "xmlns" else None)
        reads = origin.reads.get(name, ())
        if name in origin.added:
            typed, reads = origin.added[name], origin.added[name].reads
    if typed is None:
        return Attribute(name=name, value=value, owner=owner, span=None, typed="", literal=False, reads=reads)
    is_literal = typed.literal and typed.value == value
    return Attribute(
        name=name, value=value, owner=owner, span=typed.span, typed=typed.typed, literal=is_literal, reads=reads
    )
