"""The documents that xacro evaluates: minidom's nodes, with elements that are quick to copy and know their origin.

xacro works on its document in place: it copies the body of a macro at each call, and moves the result to where the call was.
minidom makes three objects for each attribute and looks each moved node up among its siblings, which takes most of the time of
plain xacro. Here the attributes of an element are a dictionary, and all nodes of a result move at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any
from xml.dom import NotFoundErr, minidom

from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.origins import Origin

_ELEMENT, _COMMENT = minidom.Node.ELEMENT_NODE, minidom.Node.COMMENT_NODE
_INSTRUCTION = minidom.Node.PROCESSING_INSTRUCTION_NODE
# Its content is never evaluated where it was typed: each call evaluates a copy.
_MACRO = "xacro:macro"
_CONDITIONS = frozenset({"xacro:if", "xacro:unless"})


class NodeAttribute:
    """What xacro and minidom's writer read of an attribute node."""

    __slots__ = ("name", "ownerElement", "value")

    def __init__(self, name: str, value: Any, owner: TracedElement) -> None:
        self.name = name
        self.value = value
        self.ownerElement = owner  # the name that minidom gives it


class NodeAttributes(Mapping[str, Any]):
    """The attributes of an element as minidom offers them: ``items()`` has their values, ``[name]`` a node."""

    __slots__ = ("_owner",)

    def __init__(self, owner: TracedElement) -> None:
        self._owner = owner

    def __getitem__(self, name: str) -> NodeAttribute:
        return NodeAttribute(name, self._owner.values[name], self._owner)

    def __iter__(self) -> Iterator[str]:
        return iter(self._owner.values)

    def __len__(self) -> int:
        return len(self._owner.values)

    def keys(self) -> Any:
        return self._owner.values.keys()

    def items(self) -> Any:
        return list(self._owner.values.items())


class TracedElement(minidom.Element):
    """An element with its attributes in a dictionary, and its origin (None where xacro made it itself).

    A value is what xacro makes it: ``<xacro:attribute>`` may also give a number or None.
    """

    def __init__(
        self, tag: str, values: dict[str, Any], document: minidom.Document | None, origin: Origin | None
    ) -> None:
        super().__init__(tag)
        self.values = values
        self.ownerDocument = document
        self.origin = origin

    def _get_attributes(self) -> NodeAttributes:  # under this name for the writer
        return NodeAttributes(self)

    attributes = property(_get_attributes)

    def hasAttribute(self, name: str) -> bool:  # noqa: N802
        return name in self.values

    def getAttribute(self, attname: str) -> Any:  # noqa: N802
        return self.values.get(attname, "")

    def getAttributeNode(self, attrname: str) -> Any:  # noqa: N802
        return self.attributes[attrname] if attrname in self.values else None

    def setAttribute(self, attname: str, value: Any) -> None:  # noqa: N802
        self.values[attname] = value

    def removeAttribute(self, name: str) -> None:  # noqa: N802
        if name not in self.values:
            raise NotFoundErr
        del self.values[name]

    def cloneNode(self, deep: bool) -> TracedElement:  # noqa: N802
        copy = _copy_tag(self, self.ownerDocument)
        if deep:
            _copy_content(self, copy)
        return copy


class _ConditionCopy(TracedElement):
    """The copy of a condition. What is in it is copied when it is asked for: many conditions are not met."""

    template: TracedElement | None = None

    def _get_child_nodes(self) -> Any:
        if self.template is not None:
            template, self.template = self.template, None
            _copy_content(template, self)
        return self._nodes

    def _set_child_nodes(self, nodes: Any) -> None:
        self._nodes = nodes

    childNodes = property(_get_child_nodes, _set_child_nodes)  # noqa: N815


def build_document(text: str, root: Element) -> minidom.Document:
    """Return the document of a text; its elements have those of the same place below ``root`` as their origins.

    :raises xml.parsers.expat.ExpatError: for what only a reader of namespaces refuses.
    """
    read = minidom.parseString(text)
    document = minidom.Document()
    nodes = [
        _adopt_element(node, root, document) if node.nodeType == node.ELEMENT_NODE else _copy_node(node, document)
        for node in read.childNodes
    ]
    _append_nodes(document, nodes)
    return document


def _adopt_element(node: minidom.Element, raw: Element, document: minidom.Document) -> TracedElement:
    """Return the element of a document of minidom's with all that is in it."""
    element = TracedElement(node.tagName, dict(node.attributes.items()), document, Origin(raw))
    typed = iter(raw.children)
    nodes = [
        _adopt_element(child, next(typed), document)
        if child.nodeType == child.ELEMENT_NODE
        else _copy_node(child, document)
        for child in node.childNodes
    ]
    _append_nodes(element, nodes)
    return element


def copy_document(document: minidom.Document) -> minidom.Document:
    """Return a copy of a document for one expansion, which changes it. What is in a macro is shared, as nothing changes that."""
    copy = minidom.Document()
    _append_nodes(copy, [_copy_node(node, copy) for node in document.childNodes])
    return copy


def _copy_node(node: Any, document: minidom.Document | None) -> Any:
    """Return a copy of a node with all that is in it, without parent and siblings."""
    copy: Any
    kind = node.nodeType
    if kind == _ELEMENT:
        copy = _copy_tag(node, document)
        if node.tagName == _MACRO:
            copy.childNodes = node.childNodes
        elif node.tagName in _CONDITIONS:
            copy.template = node
        else:
            _copy_content(node, copy)
        return copy
    if kind == _COMMENT:
        copy = minidom.Comment(node.data)
    elif kind == _INSTRUCTION:
        copy = minidom.ProcessingInstruction(node.target, node.data)
    else:
        copy = type(node)()  # a text, or one in <![CDATA[…]]>
        copy._data = node._data  # half of all nodes are such; `data` is a property of these
    copy.ownerDocument = document
    return copy


def _copy_tag(element: TracedElement, document: minidom.Document | None) -> TracedElement:
    origin = None if element.origin is None else element.origin.copy()
    make = _ConditionCopy if element.tagName in _CONDITIONS else TracedElement
    return make(element.nodeName, element.values.copy(), document, origin)


def _copy_content(element: TracedElement, copy: TracedElement) -> None:
    _append_nodes(copy, [_copy_node(child, copy.ownerDocument) for child in element.childNodes])


def _append_nodes(parent: Any, nodes: list[Any]) -> None:
    """Give a node without children its children, which have no parent and no siblings yet."""
    previous = None
    for node in nodes:
        node.parentNode = parent
        if previous is not None:
            node.previousSibling = previous
            previous.nextSibling = node
        previous = node
    parent.childNodes.extend(nodes)


def replace_node(node: Any, by: Any, content_only: bool = False) -> None:
    """Replace a node by others, or by what is in them, as xacro's function of this name does one node at a time."""
    moved: list[Any] = []
    for source in [] if by is None else by if isinstance(by, list) else [by]:
        if content_only:
            moved += source.childNodes
            source.childNodes.clear()
        else:
            if source.parentNode is not None:
                source.parentNode.removeChild(source)
            moved.append(source)
    parent = node.parentNode
    place = parent.childNodes.index(node)
    parent.childNodes[place : place + 1] = moved
    previous, following = node.previousSibling, node.nextSibling
    node.parentNode = node.previousSibling = node.nextSibling = None
    for neighbour in (*moved, following):
        if previous is not None:
            previous.nextSibling = neighbour
        if neighbour is not None:
            neighbour.previousSibling = previous
        previous = neighbour
    for child in moved:
        child.parentNode = parent
