"""Located XML: a file's text, and its elements and attributes with the exact span at which each was typed.

``xml.etree`` and lxml keep at most the line of an element. A fix needs the span of one attribute's value, so the
positions that expat reports for start tags are refined by reading the tag's own text.
"""

from __future__ import annotations

import codecs
import re
from array import array
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from urdfcheck.core import NEWLINE, Location, Span
from urdfcheck.system.files import FileTooLargeError, read_regular

# Of 366 XML files of published robots none has more than 9 levels, 25 attributes of one element, 557 characters in one of
# them, or 8,228 elements, attributes and comments.
MAX_DEPTH = 256
MAX_ATTRIBUTES = 1_000
MAX_VALUE = 1024**2
# One of these takes up to 500 bytes of memory.
MAX_PARTS = 2_000_000

_DECLARED = re.compile(rb"""^\s*<\?xml[^>\x80-\xff]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
# Codecs of Python that are no character encoding of a file.
_NO_CHARSETS = frozenset({"idna", "punycode", "raw-unicode-escape", "undefined", "unicode-escape"})
_BREAK = re.compile(r"\r\n|[\r\n\t]")
_TAG = re.compile(r"[^ \t\r\n/>]+")
_ATTRIBUTE = re.compile(r"""\s+([^\s=/>"']+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_SUBSTITUTION = re.compile(r"\$[({]")


class XmlError(Exception):
    """The text is not XML that may be read. ``reason``: malformed | encoding | doctype | too-large; of the last, ``data``
    holds ``what`` there is too much of (bytes | depth | attributes | value | parts), the ``limit`` and what was ``found``.
    """

    def __init__(self, reason: str, message: str, span: Span, data: Mapping[str, object] | None = None) -> None:
        super().__init__(message)
        self.reason = reason
        self.span = span
        self.data = data or {}


@dataclass(frozen=True, slots=True, eq=False)
class Definition:
    """Where a value that went into an expression was defined: a property, argument, macro parameter or yaml key."""

    kind: str
    name: str
    span: Span | None
    reads: tuple[Definition, ...] = ()

    @property
    def location(self) -> Location:
        return Location(f"{self.kind}[{self.name}]", self.span)


def flatten_definitions(reads: Iterable[Definition]) -> list[Definition]:
    """These definitions and every definition that they were computed from, nearest first, each place once."""
    places: dict[Span | None, Definition] = {}
    queue = dict.fromkeys(reads)
    while queue:
        further: dict[Definition, None] = {}
        for definition in queue:
            places.setdefault(definition.span, definition)
            further.update(dict.fromkeys(definition.reads))
        queue = further
    return list(places.values())


@dataclass(slots=True, eq=False, kw_only=True)
class Attribute:
    """An attribute of the (expanded) model. ``span`` covers the value as typed, without quotes.

    ``typed`` is that text; ``literal`` says that it is the value itself (but for line breaks, which XML reads as blanks), so
    that an edit of the span edits the value.
    """

    name: str
    value: str
    owner: Element
    span: Span | None
    typed: str
    literal: bool
    reads: tuple[Definition, ...] = ()

    @property
    def location(self) -> Location:
        return Location(f"{self.owner.subject}@{self.name}", self.span, self.owner.via)

    def collect_definitions(self) -> tuple[Definition, ...]:
        """Every definition that the value was computed from, nearest first, each once."""
        return tuple(d for d in flatten_definitions(self.reads) if d.span is not None)


@dataclass(slots=True, eq=False, kw_only=True)
class Element:
    """An element with its attributes, child elements and position. ``span`` covers the start tag."""

    tag: str
    span: Span | None
    parent: Element | None = None
    attributes: dict[str, Attribute] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    text: str = ""
    via: tuple[Span, ...] = ()
    _label_cache: tuple[int, dict[int, str]] | None = field(default=None, repr=False)

    def get(self, name: str, default: str = "") -> str:
        """The value of an attribute, or ``default``."""
        attribute = self.attributes.get(name)
        return default if attribute is None else attribute.value

    def find_child(self, tag: str) -> Element | None:
        """The first child with this tag: the one that the reference parser takes."""
        for child in self.children:
            if child.tag == tag:
                return child
        return None

    def find_children(self, tag: str) -> list[Element]:
        """The children with this tag."""
        return [c for c in self.children if c.tag == tag]

    def walk(self) -> Iterator[Element]:
        """The element and everything in it, in document order."""
        stack = [self]
        while stack:
            element = stack.pop()
            yield element
            stack.extend(reversed(element.children))

    @property
    def label(self) -> str:
        """``link[wheel_1]``, ``inertial``, ``visual[2]``: how a subject names this element among its siblings."""
        name = self.get("name") or (self.get("reference") if self.tag == "gazebo" else "")
        if name:
            return f"{self.tag}[{name}]"
        return self.tag if self.parent is None else self.parent._number_children()[id(self)]

    def _number_children(self) -> dict[int, str]:
        """The labels of the children by their tag and number; computed once for all of them, not by each looking at all."""
        if self._label_cache is None or self._label_cache[0] != len(self.children):
            number: Counter[str] = Counter()
            labels: dict[int, str] = {}
            for child in self.children:
                number[child.tag] += 1
                labels[id(child)] = f"{child.tag}[{number[child.tag]}]"
            labels.update({id(child): child.tag for child in self.children if number[child.tag] == 1})
            self._label_cache = len(self.children), labels
        return self._label_cache[1]

    @property
    def subject(self) -> str:
        """The path from the root's child to this element; the root itself is named by its own label."""
        labels: list[str] = []
        element: Element | None = self
        while element is not None and element.parent is not None:
            labels.append(element.label)
            element = element.parent
        return "/".join(reversed(labels)) or self.label

    @property
    def location(self) -> Location:
        return Location(self.subject, self.span, self.via)

    def collect_definitions(self) -> tuple[Definition, ...]:
        """The definitions that went into the element's own attributes."""
        found = [d for attribute in self.attributes.values() for d in attribute.collect_definitions()]
        return tuple({d.span: d for d in found}.values())


@dataclass(frozen=True, slots=True, eq=False)
class Comment:
    """A comment and where it stands."""

    text: str
    span: Span


class SourceFile:
    """The decoded text of one file. ``name`` is how findings call it, ``path`` where it is, ``encoding`` what its bytes were
    decoded by. ``instruction``: the first processing instruction (``<?…?>``) that does not stand before everything else."""

    __slots__ = ("_starts", "comments", "encoding", "instruction", "name", "path", "text")

    def __init__(self, path: Path, name: str, text: str, encoding: str = "utf-8") -> None:
        self.path = path
        self.name = name
        self.text = text
        self.encoding = encoding
        self.comments: list[Comment] = []
        self.instruction: Span | None = None
        self._starts = array("q", (0,))  # a list would take forty bytes for each line
        self._starts.extend(m.end() for m in NEWLINE.finditer(text))

    @classmethod
    def read(cls, path: Path, name: str) -> SourceFile:
        """Read and decode a file by its byte order mark or its XML declaration, else UTF-8.

        :raises OSError: when it cannot be read.
        :raises XmlError: when it is too large, or its bytes are not text in the declared encoding.
        """
        try:
            data = read_regular(path)
        except FileTooLargeError as error:
            raise _make_too_large_error(
                "bytes", error.limit, error.found, error.message, cls(path, name, "").make_span(0, 0)
            ) from None
        encoding = _detect_encoding(data)
        declared = _DECLARED.match(data[:400]) if encoding is None else None
        if declared is not None:
            encoding = declared.group(1).decode("ascii")
            if not _can_decode(encoding, declared.group(0)):
                at = cls(path, name, declared.group(0).decode("ascii")).make_span(*declared.span(1))
                raise XmlError("encoding", f"the text is not in the encoding {encoding!r} that it declares", at)
        encoding = encoding or "utf-8"
        try:
            return cls(path, name, data.decode(encoding), encoding)
        except UnicodeDecodeError as error:
            # error.object is what was left when the codec had taken off the byte order mark.
            read, wrong = error.object[: error.start], error.object[error.start]
            broken = cls(path, name, read.decode(encoding, "replace"))
            at = broken.make_span(len(broken.text), len(broken.text))
            raise XmlError("encoding", f"byte 0x{wrong:02x} is not valid {encoding}", at) from None

    def locate_character(self, line: int, col: int) -> Span:
        """The character at a line and column, as a parser names it."""
        start = min(self._starts[min(line, len(self._starts)) - 1] + col - 1, len(self.text))
        return self.make_span(start, min(start + 1, len(self.text)))

    def make_span(self, start: int, end: int) -> Span:
        """The span between two offsets (code points)."""
        line = bisect_right(self._starts, start)
        within = line == len(self._starts) or end < self._starts[line]
        end_line = line if within else bisect_right(self._starts, end)
        return Span(
            self.name,
            line,
            start - self._starts[line - 1] + 1,
            end_line,
            end - self._starts[end_line - 1] + 1,
            start,
            end,
        )


def _make_too_large_error(what: str, limit: int, found: int, message: str, span: Span) -> XmlError:
    return XmlError("too-large", message, span, {"what": what, "limit": limit, "found": found})


def _detect_encoding(data: bytes) -> str | None:
    """The encoding that the first bytes give away: a byte order mark, or the zero bytes of UTF-16."""
    for mark, name in (
        (codecs.BOM_UTF8, "utf-8-sig"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
        (b"<\0", "utf-16-le"),
        (b"\0<", "utf-16-be"),
    ):
        if data.startswith(mark):
            return name
    return None


def _can_decode(encoding: str, declaration: bytes) -> bool:
    """Whether an encoding exists and reads its own declaration (UTF-16 reads something else in bytes of ASCII)."""
    try:
        known = codecs.lookup(encoding).name not in _NO_CHARSETS
        return known and declaration.decode(encoding, "replace") == declaration.decode("ascii", "replace")
    except (LookupError, UnicodeError):
        return False


def parse_xml(source: SourceFile) -> Element:
    """Parse a file's text into located elements and note its comments in ``source.comments``.

    Namespaces are left as prefixes, as the reference parser of URDF (tinyxml2) does. A document type declaration is
    refused before anything in it is read: entities could multiply without bound or name other files.

    :raises XmlError: with the span at which the parser stopped.
    """
    text = source.text
    zero = text.find("\0")
    if zero >= 0:  # the first of them would make expat guess another encoding
        raise XmlError("malformed", "a zero byte: this is no text", source.make_span(zero, zero + 1))
    data = text.encode("utf-8", "surrogatepass")
    # Byte offsets are code point offsets only in ASCII text.
    ascii_only = len(data) == len(text)
    parser = expat.ParserCreate(encoding="utf-8")
    parser.buffer_text = True
    root: Element | None = None
    stack: list[Element] = []
    texts: list[list[str]] = []  # of each element on the stack: added up one by one they would be copied each time
    parts = 0
    counted = (0, 0)  # bytes, code points: the parser only moves forward, so nothing is counted twice

    def to_text_offset(index: int) -> int:
        nonlocal counted
        if ascii_only:
            return index
        counted = (index, counted[1] + len(data[counted[0] : index].decode("utf-8", "replace")))
        return counted[1]

    def count_parts(added: int, begin: int) -> None:
        nonlocal parts
        parts += added
        if parts > MAX_PARTS:
            message = f"the file has more than {MAX_PARTS:,} elements, attributes and comments"
            raise _make_too_large_error("parts", MAX_PARTS, parts, message, source.make_span(begin, begin + 1))

    def start(tag: str, values: dict[str, str]) -> None:
        nonlocal root
        begin = to_text_offset(parser.CurrentByteIndex)
        count_parts(1 + len(values), begin)
        if len(values) > MAX_ATTRIBUTES:
            message = f"an element has {len(values):,} attributes, more than {MAX_ATTRIBUTES:,}"
            raise _make_too_large_error(
                "attributes", MAX_ATTRIBUTES, len(values), message, source.make_span(begin, begin + 1)
            )
        end, typed = _read_tag(text, begin)
        element = Element(tag=tag, span=source.make_span(begin, end), parent=stack[-1] if stack else None)
        if end - begin > MAX_VALUE:
            longest = max(map(len, (tag, *values, *values.values())))
            if longest > MAX_VALUE:
                message = f"a name or a value has {longest:,} characters, more than {MAX_VALUE:,}"
                raise _make_too_large_error("value", MAX_VALUE, longest, message, source.make_span(begin, begin + 1))
        for name, value in values.items():
            span, raw = typed.get(name, (None, value))
            at = None if span is None else source.make_span(*span)
            plain = raw == value or _BREAK.sub(" ", raw) == value
            literal = plain and not ("$" in raw and _SUBSTITUTION.search(raw))
            element.attributes[name] = Attribute(
                name=name, value=value, owner=element, span=at, typed=raw, literal=literal
            )
        if stack:
            stack[-1].children.append(element)
        elif root is None:
            root = element
        stack.append(element)
        texts.append([])
        if len(stack) > MAX_DEPTH:
            message = f"elements are nested more than {MAX_DEPTH} deep"
            raise _make_too_large_error("depth", MAX_DEPTH, len(stack), message, source.make_span(begin, end))

    def finish(_tag: str) -> None:
        stack.pop().text = "".join(texts.pop())

    def characters(data: str) -> None:
        if texts:
            texts[-1].append(data)

    def comment(data: str) -> None:
        begin = to_text_offset(parser.CurrentByteIndex)
        count_parts(1, begin)
        stop = text.find("-->", begin)
        source.comments.append(Comment(data, source.make_span(begin, stop + 3 if stop >= 0 else len(text))))

    def instruction(_target: str, _data: str) -> None:
        begin = to_text_offset(parser.CurrentByteIndex)
        count_parts(1, begin)
        if source.instruction is None and (root is not None or source.comments):
            stop = text.find("?>", begin)
            source.instruction = source.make_span(begin, stop + 2 if stop >= 0 else len(text))

    def doctype(*_: object) -> None:
        # The parser stands behind the name by now.
        begin = text.rfind("<!DOCTYPE", 0, to_text_offset(parser.CurrentByteIndex))
        raise XmlError("doctype", "a document type declaration is refused", source.make_span(begin, begin + 9))

    parser.StartElementHandler = start
    parser.EndElementHandler = finish
    parser.CharacterDataHandler = characters
    parser.CommentHandler = comment
    parser.ProcessingInstructionHandler = instruction
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        at = min(to_text_offset(max(parser.ErrorByteIndex, 0)), len(text))
        said = _describe_expat_error(error.code, stack, text)
        raise XmlError("malformed", said, source.make_span(at, min(at + 1, len(text)))) from None
    assert root is not None, "expat accepts no document without a root element"
    return root


def _describe_expat_error(code: int, stack: list[Element], text: str) -> str:
    """expat's words for an error, with the element that is still open where the error is about its end."""
    said: str = expat.ErrorString(code)
    if not text.strip():
        return "the file is empty"
    if not stack:
        return said
    line = stack[-1].span.line if stack[-1].span is not None else 0
    opened = f"<{stack[-1].tag}>, opened in line {line}"
    if said == expat.errors.XML_ERROR_TAG_MISMATCH:
        return f"{said}: {opened}, has not been closed"
    if said == expat.errors.XML_ERROR_NO_ELEMENTS:
        return f"the file ends before {opened}, is closed"
    return said


def _read_tag(text: str, begin: int) -> tuple[int, dict[str, tuple[tuple[int, int], str]]]:
    """The end of the start tag at ``begin`` and, per attribute, the offsets and text of its value."""
    found: dict[str, tuple[tuple[int, int], str]] = {}
    name = _TAG.match(text, begin + 1)
    at = begin + 1 if name is None else name.end()
    while match := _ATTRIBUTE.match(text, at):
        group = 2 if match.group(2) is not None else 3
        found[match.group(1)] = (match.span(group), match.group(group))
        at = match.end()
    end = text.find(">", at)
    return (end + 1 if end >= 0 else len(text)), found


def find_unbound_prefix(root: Element) -> tuple[Element, str] | None:
    """The first element whose prefix (or whose attribute's) no ``xmlns:`` around it declares, with the prefix."""
    bound: set[tuple[int, str]] = set()  # what was found to be declared in or around an element
    for element in root.walk():
        for name in (element.tag, *element.attributes):
            prefix, colon, _ = name.partition(":")
            if not colon or prefix in {"xml", "xmlns"} or f"xmlns:{prefix}" in element.attributes:
                continue
            if (id(element.parent), prefix) not in bound:
                if not any(f"xmlns:{prefix}" in around.attributes for around in _iter_ancestors(element)):
                    return element, prefix
                bound.add((id(element.parent), prefix))
    return None


def _iter_ancestors(element: Element) -> Iterator[Element]:
    """The elements that this one is in."""
    while element.parent is not None:
        element = element.parent
        yield element


_QUOTED = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
)


def quote_attribute(value: str) -> str:
    """A value as the text of an XML attribute, with its quotes (xml.sax.saxutils has this too, and loads an HTTP client)."""
    return f'"{value.translate(_QUOTED)}"'
