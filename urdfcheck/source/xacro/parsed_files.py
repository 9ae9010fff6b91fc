"""The xacro files that were parsed last, by their content: of the files of a robot, an edit changes one.

A process that checks a robot after each edit parses the other files once. So is a file that several others include.
"""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from typing import TYPE_CHECKING
from xml.parsers import expat

from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, find_unbound_prefix, parse_xml

if TYPE_CHECKING:
    from xml.dom import minidom

# Characters of all texts that are kept; what is made of them takes up to fifty times their size.
_MOST_CHARACTERS = 1_000_000


@dataclass(slots=True, eq=False)
class ParsedFile:
    """A file of xacro. All expansions that read this content share it, and none changes it."""

    source: SourceFile
    """With the comments that parsing finds."""
    tree: Element
    """As typed."""
    _document: minidom.Document | None = None

    def copy_document(self) -> minidom.Document:
        """Return the document for one expansion, which changes it.

        :raises XmlError: for what only a reader of namespaces refuses.
        """
        from urdfcheck.source.xacro.document_nodes import (
            build_document,
            copy_document,
        )  # only an expansion needs minidom

        if self._document is None:
            try:
                self._document = build_document(self.source.text, self.tree)
            except expat.ExpatError as error:
                raise _make_namespace_error(self, error) from error
        return copy_document(self._document)


def _make_namespace_error(file: ParsedFile, error: expat.ExpatError) -> XmlError:
    """Return what a reader of namespaces refuses: expat takes a blank for what parts an address from a name."""
    for element in file.tree.walk():
        for name, attribute in element.attributes.items():
            if name.partition(":")[0] == "xmlns" and " " in attribute.value and attribute.span is not None:
                prefix = name.partition(":")[2]
                what = f"the prefix {prefix!r}" if prefix else "xmlns"
                message = f"the address of {what} contains a blank or a line break"
                repair = (
                    f"write the address in one line and without blanks, or delete `{name}` if nothing has the prefix"
                )
                return XmlError("address", message, attribute.span, data={"repair": repair})
    at = file.source.locate_character(error.lineno, error.offset + 1)
    repair = "correct the declaration of the prefix: each is declared with an address, and `xml` and `xmlns` are taken"
    return XmlError("malformed", expat.ErrorString(error.code), at, data={"repair": repair})


# All that a parsed file is made of: the path, its name in findings, the codec, the declared encoding and the text.
_Content = tuple[Path, str, str, str, str]
_kept: OrderedDict[_Content, ParsedFile] = OrderedDict()


def parse_shared(source: SourceFile) -> ParsedFile:
    """Parse a file of xacro, or return what was parsed of the same content.

    :raises XmlError: if it is not XML that may be read, or a prefix is not declared.
    """
    content = (source.path, source.name, source.encoding, source.declared, source.text)
    parsed = _kept.get(content)
    if parsed is not None:
        _kept.move_to_end(content)
        return parsed
    parsed = _kept[content] = _parse(source)
    too_many = sum(len(kept.source.text) for kept in _kept.values()) - _MOST_CHARACTERS
    while too_many > 0:
        _, oldest = _kept.popitem(last=False)
        too_many -= len(oldest.source.text)
    return parsed


def _parse(source: SourceFile) -> ParsedFile:
    tree = parse_xml(source)
    unbound = find_unbound_prefix(tree)
    if unbound is not None:
        element, prefix = unbound
        assert element.span is not None  # every element of a parsed file has one
        message = f"the prefix {prefix!r} is not declared (xmlns:{prefix}=…)"
        raise XmlError("prefix", message, element.span, data={"prefix": prefix})
    return ParsedFile(source, tree)
