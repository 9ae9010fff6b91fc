"""Where the nodes of an expanded document were typed: each node of xacro's document carries its origin."""

from __future__ import annotations

import re
from dataclasses import field
from functools import lru_cache
from typing import Any
from xml.dom import minidom
from xml.parsers import expat

from urdfcheck.core import Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import Attribute, Definition, Element
from urdfcheck.source.text.xml_mistakes import NO_CHARACTER

# Characters that end a name when a document is read again.
_INVALID_NAME = re.compile(r"""[\s<>&"'=/]""")
_ELEMENT, _COMMENT = minidom.Node.ELEMENT_NODE, minidom.Node.COMMENT_NODE
_TEXTS = frozenset({minidom.Node.TEXT_NODE, minidom.Node.CDATA_SECTION_NODE})
_PLAIN = frozenset({bool, int, float, type(None)})
_MOST_SHOWN = 60


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

    def copy(self) -> Origin:
        """Return the origin of a copy of the node, so that each use of a macro's body has its own chain of calls."""
        return Origin(self.raw, self.via, self.reads.copy(), self.added.copy())


class InvalidOutputError(Exception):
    """The expanded document cannot be written as XML."""

    def __init__(self, message: str, location: Location) -> None:
        super().__init__(message)
        self.location = location


def get_origin(node: Any) -> Origin | None:
    """Return the origin of a node; None for a node that was not typed."""
    return getattr(node, "origin", None)


@dataclass(frozen=True, slots=True)
class OutputDefect:
    """Something that xacro writes without a word, and that is not what the author typed. ``kind``: that of the problem."""

    kind: str
    message: str
    location: Location
    data: dict[str, Any] = field(default_factory=dict)


def convert_document(document: minidom.Document, defects: list[OutputDefect]) -> Element:
    """Return the expanded document as located elements; what is lost in writing is added to ``defects``.

    :raises InvalidOutputError: if xacro cannot write the document as XML.
    """
    root = document.documentElement
    assert root is not None  # expat accepts no document without a root element
    for node in document.childNodes:
        _note_instruction(node, get_origin(root), defects)
    return _convert_node(root, None, defects)


def _convert_node(node: minidom.Element, parent: Element | None, defects: list[OutputDefect]) -> Element:
    origin = get_origin(node)
    via = (origin.via or ()) if origin is not None else ()
    element = Element(str(node.tagName), None if origin is None else origin.raw.span, parent, via=via)
    values = node.attributes.items()
    for name in (node.tagName, *[name for name, _ in values]):
        if not isinstance(name, str) or not _is_name(name):  # xacro:element and xacro:attribute take any value
            message = f"{name!r} is not a valid name of an element or attribute, so the output of xacro is not XML"
            raise InvalidOutputError(message, _locate(element, origin))
    for name, value in values:
        attribute = element.attributes[name] = _convert_attribute(name, value, owner=element, origin=origin)
        if not isinstance(value, str):
            defects.append(_find_lost_value(name, value, _locate(element, origin, attribute)))
        elif not value.isprintable() and (found := NO_CHARACTER.search(value)) is not None:
            message = _describe_character(found[0], f"the attribute {name}")
            raise InvalidOutputError(message, _locate(element, origin, attribute))
    texts: list[str] = []
    child: Any
    for child in node.childNodes:
        kind = child.nodeType
        if kind == _ELEMENT:
            element.children.append(_convert_node(child, element, defects))
        elif kind in _TEXTS:
            texts.append(child.data)
        elif kind == _COMMENT and "--" in child.data:  # it was evaluated (xacro:eval-comments)
            message = "a comment that xacro evaluates contains `--`, and xacro crashes when writing it"
            raise InvalidOutputError(message, _locate(element, origin))
        else:
            _note_instruction(child, origin, defects)
    element.text = "".join(texts)
    if (found := NO_CHARACTER.search(element.text)) is not None:
        message = _describe_character(found[0], "the text of an element")
        raise InvalidOutputError(message, _locate(element, origin))
    return element


def _locate(element: Element, origin: Origin | None, attribute: Attribute | None = None) -> Location:
    subject = "robot" if origin is None else origin.raw.subject
    if attribute is None:
        return Location(subject, element.span, element.via)
    return Location(f"{subject}@{attribute.name}", attribute.span or element.span, element.via)


@lru_cache(maxsize=4096)
def _is_name(name: str) -> bool:
    """Whether a text is a name of XML."""
    try:
        expat.ParserCreate("utf-8").Parse(f"<{name}/>".encode(), True)
    except (expat.ExpatError, UnicodeEncodeError):
        return False
    return not _INVALID_NAME.search(name)


def _find_lost_value(name: str, value: Any, at: Location) -> OutputDefect:
    """Return what xacro makes of the value of an ``<xacro:attribute>`` that is not a text: it leaves it as it was computed.

    :raises InvalidOutputError: if it crashes when it writes it.
    """
    kind = type(value).__name__
    if value:
        message = f"<xacro:attribute> gives {name} a value of the type {kind}, and xacro crashes when writing it"
        raise InvalidOutputError(message, at)
    message = f"<xacro:attribute> gives {name} an empty value"
    data = {"name": name, "value": repr(value) if type(value) in _PLAIN else f"of the type {kind}"}
    return OutputDefect("value-lost", message, at, data)


def _describe_character(character: str, where: str) -> str:
    return f"{where} contains the character U+{ord(character):04X}, which is not allowed in XML"


def _note_instruction(node: Any, origin: Origin | None, defects: list[OutputDefect]) -> None:
    if node.nodeType == node.PROCESSING_INSTRUCTION_NODE:
        span = None if origin is None else origin.raw.span
        subject = "robot" if origin is None else origin.raw.subject
        message = f"the processing instruction <?{node.target[:_MOST_SHOWN]} …?>"
        defects.append(OutputDefect("instruction-copied", message, Location(subject, span), {"target": node.target}))


def _convert_attribute(name: str, value: Any, *, owner: Element, origin: Origin | None) -> Attribute:
    value = value if isinstance(value, str) else ""  # minidom writes nothing for 0, None and the like
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
    return Attribute(name, value, owner, typed.span, typed.typed, is_literal, reads)
