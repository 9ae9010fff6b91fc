"""Located XML: a file's text, and its elements and attributes with the exact span at which each was typed.

``xml.etree`` and lxml keep at most the line of an element. A fix needs the span of one attribute's value, so the
positions that expat reports for start tags are refined by reading the text of the tag.
"""

from __future__ import annotations

import re
from array import array
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from urdfcheck.core import NEWLINE, Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml_mistakes import ENTITIES, describe_mistake, forgive_hyphens
from urdfcheck.system.encodings import UnreadableEncodingError, decode_text, decode_xml, find_byte_beyond_utf_8
from urdfcheck.system.files import FileTooLargeError, read_regular

# In 366 XML files of published robots the maxima are 9 levels, 25 attributes of one element, 557 characters in an
# attribute, and 8,228 elements, attributes and comments.
MAX_DEPTH = 256
MAX_ATTRIBUTES = 1_000
MAX_VALUE = 1024**2
# Elements, attributes and comments; each takes up to 500 bytes of memory.
MAX_PARTS = 2_000_000

# Characters of which one byte in UTF-16 is a carriage return, which a reader of text changes to a line break. Those beyond two
# bytes have it in their first half.
_LOW_RETURN = "".join(chr(high << 8 | 0x0D) for high in range(1, 0xD8))
_HALF_RETURN = re.compile(f"[\u0d00-\u0dff\U00013400-\U000137ff]|[{_LOW_RETURN}]")
_VALUE = re.compile(r"""=\s*(?:"[^"]*"|'[^']*')""")
_BREAK = re.compile(r"\r\n|[\r\n\t]")
_TAG = re.compile(r"[^ \t\r\n/>]+")
_ATTRIBUTE = re.compile(r"""\s+([^\s=/>"']+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
# A comment; one that nothing closes ends with the text. Otherwise the end of each of many would be searched anew.
COMMENT = re.compile(r"<!--(.*?)(?:-->|\Z)", re.DOTALL)
_LATE_DECLARATION = re.compile(r"\A(\ufeff?\s+)(<\?xml\s[^>]*\?>)")
_SUBSTITUTION = re.compile(r"\$[({]")
_ENTITY = re.compile(r"&([^\s;<>&\"'#]+);")
# Declarations in a document type none of which uses another, and what may read other files in them.
_PLAIN_SUBSET = re.compile(r"<!DOCTYPE[^<>\[\]]*\[([^\[\]&%]*)\]\s*>")
_ELSEWHERE = re.compile(r"\b(?:SYSTEM|PUBLIC)\b")


class XmlError(Exception):
    """The text is not XML that may be read.

    ``reason``: malformed | encoding | declared-encoding | xacro-encoding | xacro-line-break | doctype | too-large | prefix |
    address. For malformed, ``data`` holds the ``repair`` and whether it is ``forgiven`` by lenient parsers; for doctype,
    whether the declaration is ``plain``, whose entities are texts; for too-large, ``what`` exceeds the limit (bytes | depth |
    attributes | value | parts), the ``limit`` and the number ``found``.
    """

    def __init__(self, reason: str, message: str, span: Span, data: Mapping[str, object] | None = None) -> None:
        super().__init__(message)
        self.reason = reason
        self.span = span
        self.data = data or {}


@dataclass(frozen=True, slots=True, eq=False)
class Definition:
    """A property, argument, macro parameter or yaml key that an expression reads, and where it is defined."""

    kind: str
    name: str
    span: Span | None
    reads: tuple[Definition, ...] = ()
    text: str = ""
    """What is typed at the place; empty where the place holds more than the value, as that of a default does."""
    value: str = ""
    """What that became; empty as long as nothing has read it, and for anything but a text, a number or a truth value."""

    @property
    def location(self) -> Location:
        return Location(f"{self.kind}[{self.name}]", self.span)


def flatten_definitions(reads: Iterable[Definition]) -> list[Definition]:
    """Return these definitions and every definition that they were computed from, nearest first, each place once."""
    places: dict[Span | None, Definition] = {}
    queue = dict.fromkeys(reads)
    while queue:
        further: dict[Definition, None] = {}
        for definition in queue:
            places.setdefault(definition.span, definition)
            further.update(dict.fromkeys(definition.reads))
        queue = further
    return list(places.values())


# Not kw_only, because a model has thousands of them: constructing one by keywords takes two to three times as long.
@dataclass(slots=True, eq=False)
class Attribute:
    """An attribute of the (expanded) model."""

    name: str
    value: str
    owner: Element
    span: Span | None
    """The value as typed, without quotes."""
    typed: str
    """The text at this span."""
    literal: bool
    """Whether this text is the value itself (line breaks apart, which XML reads as blanks), so that an edit edits the value."""
    reads: tuple[Definition, ...] = ()
    """The definitions that the value was computed from directly."""

    @property
    def location(self) -> Location:
        return Location(f"{self.owner.subject}@{self.name}", self.span, self.owner.via)

    def collect_definitions(self) -> tuple[Definition, ...]:
        """Return every definition that the value was computed from, nearest first, each once."""
        return tuple(d for d in flatten_definitions(self.reads) if d.span is not None)


# Not kw_only, for the same reason.
@dataclass(slots=True, eq=False)
class Element:
    """An element with its attributes, child elements and position."""

    tag: str
    span: Span | None
    """The start tag."""
    parent: Element | None = None
    attributes: dict[str, Attribute] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    text: str = ""
    via: tuple[Span, ...] = ()
    """The macro calls and includes that brought it in, outermost first."""
    _label_cache: tuple[int, dict[int, str]] | None = field(default=None, repr=False)
    facts: dict[Any, Any] | None = field(default=None, repr=False)
    """What `urdfcheck.source.text.remembered` keeps of a whole file or robot, at its root."""

    def get(self, name: str, default: str = "") -> str:
        """Return the value of an attribute, or ``default``."""
        attribute = self.attributes.get(name)
        return default if attribute is None else attribute.value

    def find_child(self, tag: str) -> Element | None:
        """Return the first child with this tag, which is the one that the reference parser reads."""
        for child in self.children:
            if child.tag == tag:
                return child
        return None

    def find_children(self, tag: str) -> list[Element]:
        """Return the children with this tag."""
        return [c for c in self.children if c.tag == tag]

    def walk(self) -> Iterator[Element]:
        """Yield the element and everything in it, in document order."""
        stack = [self]
        while stack:
            element = stack.pop()
            yield element
            if element.children:
                stack += element.children[::-1]

    @property
    def label(self) -> str:
        """The name of this element among its siblings, as subjects use it: ``link[wheel_1]``, ``inertial``, ``visual[2]``."""
        name = self.get("name") or (self.get("reference") if self.tag == "gazebo" else "")
        if name:
            return f"{self.tag}[{name}]"
        return self.tag if self.parent is None else self.parent._number_children()[id(self)]

    def _number_children(self) -> dict[int, str]:
        """Return the labels of the children by tag and number; computed once for all children, to stay linear in their number."""
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
        """Return the definitions that the element's own attributes were computed from."""
        definitions = [d for attribute in self.attributes.values() for d in attribute.collect_definitions()]
        return tuple({d.span: d for d in definitions}.values())


@dataclass(frozen=True, slots=True, eq=False)
class Comment:
    """A comment and its place."""

    text: str
    span: Span


class SourceFile:
    """The decoded text of one file.

    ``name`` is its name in findings, ``path`` its place, and ``encoding`` the codec of its bytes, ``declared`` the
    encoding that it states (empty without one). ``instruction`` is the first processing instruction (``<?…?>``) that comes
    after an element or a comment.
    """

    __slots__ = ("_starts", "comments", "declared", "encoding", "instruction", "name", "path", "text")

    def __init__(self, path: Path, name: str, text: str, encoding: str = "utf-8", declared: str = "") -> None:
        self.path = path
        self.name = name
        self.text = text
        self.encoding = encoding
        self.declared = declared
        self.comments: list[Comment] = []
        self.instruction: Span | None = None

    def __getattr__(self, name: str) -> Any:
        """Return the offsets of the lines when they are first asked for: of a file whose tree is known they never are."""
        if name != "_starts":
            raise AttributeError(name)
        self._starts = array("q", (0,))  # a list would take forty bytes for each line
        self._starts.extend(m.end() for m in NEWLINE.finditer(self.text))
        return self._starts

    @classmethod
    def read(cls, path: Path, name: str, *, declares: bool = True) -> SourceFile:
        """Read and decode a file. ``declares``: it is XML, which may declare its encoding; yaml cannot.

        :raises OSError: if it cannot be read.
        :raises XmlError: if it is too large, or its bytes are not text, or not the same text for all programs.
        """
        try:
            data = read_regular(path)
        except FileTooLargeError as error:
            start = cls(path, name, "").make_span(0, 0)
            raise _make_too_large_error("bytes", error.found, error.limit, message=error.message, span=start) from None
        try:
            decoded = decode_xml(data) if declares else decode_text(data)
        except UnreadableEncodingError as error:
            broken = cls(path, name, error.before + error.wrong)
            at = broken.make_span(len(error.before), len(broken.text))
            raise XmlError("declared-encoding" if error.wrong else "encoding", str(error), at) from None
        return cls(path, name, text=decoded.text, encoding=decoded.encoding, declared=decoded.declared)

    def ensure_utf_8(self, reader: str) -> None:
        """Refuse a file for a program that reads UTF-8 whatever the file declares.

        :raises XmlError: at the first byte that is not UTF-8, or that the program takes for a line break of its own.
        """
        found = find_byte_beyond_utf_8(self.text, self.encoding)
        if found is not None:
            message = f"{reader} reads every file as UTF-8, but byte 0x{found[1]:02x} is not"
            raise XmlError("xacro-encoding", message, self.make_span(found[0], min(found[0] + 1, len(self.text))))
        if self.encoding.startswith("utf-16-"):
            self._ensure_line_breaks(reader)

    def _ensure_line_breaks(self, reader: str) -> None:
        """Refuse UTF-16 in which a reader of UTF-8 text, which makes every byte 0x0D a line feed, changes a name or a value."""
        half = _HALF_RETURN.search(self.text)
        if half is not None:
            span, what = half.span(), f"half of {half[0]!r} as a line break"
        else:
            broken = next((value for value in _VALUE.finditer(self.text) if "\r\n" in value[0]), None)
            if broken is None:
                return
            start = broken.start() + broken[0].index("\r\n")
            span, what = (start, start + 2), "the carriage return and the line feed as two line breaks"
        message = f"{reader} reads every file as UTF-8, but this is UTF-16: it reads {what}"
        raise XmlError("xacro-line-break", message, self.make_span(*span))

    def locate_character(self, line: int, col: int) -> Span:
        """Return the span of the character at a line and column that a parser reports."""
        start = min(self._starts[min(line, len(self._starts)) - 1] + col - 1, len(self.text))
        return self.make_span(start, min(start + 1, len(self.text)))

    def make_span(self, start: int, end: int) -> Span:
        """Return the span between two offsets (code points)."""
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
        )  # not by keywords, which take twice as long: every attribute has a span


def _make_too_large_error(what: str, found: int, limit: int, *, message: str, span: Span) -> XmlError:
    return XmlError("too-large", message, span, data={"what": what, "limit": limit, "found": found})


def parse_xml(source: SourceFile) -> Element:
    """Parse a file's text into located elements, and note its comments in ``source.comments``.

    Namespaces are left as prefixes, as the reference parser of URDF (tinyxml2) does. A document type declaration is
    refused before anything in it is read: its entities could multiply without bound or name other files.

    :raises XmlError: with the span at which the parser stopped.
    """
    zero = source.text.find("\0")
    if zero >= 0:  # the first zero byte would make expat guess another encoding
        raise XmlError("malformed", "it contains a zero byte", source.make_span(zero, zero + 1))
    return _Parser(source).parse()


def parse_leniently(source: SourceFile) -> tuple[Element, XmlError | None]:
    """Parse as tinyxml2 does, the parser of urdfdom and MoveIt, which ends a comment at ``-->`` whatever hyphens are in it
    (``--!>``), and skips blanks before the declaration. Return the root element, and what strict parsers refuse.

    :raises XmlError: if the text is malformed otherwise.
    """
    try:
        return parse_xml(source), None
    except XmlError as error:
        if not error.data.get("forgiven"):
            raise
        refusal = error
    # Of the same length: all places stay.
    lenient = _LATE_DECLARATION.sub(lambda match: match[1] + " " * len(match[2]), forgive_hyphens(source.text))
    copy = SourceFile(source.path, source.name, lenient, encoding=source.encoding, declared=source.declared)
    tree = parse_xml(copy)
    source.comments[:] = copy.comments
    return tree, refusal


class _Parser:
    """Builds the located elements of one file from the events of expat."""

    __slots__ = (
        *("source", "text", "data", "is_ascii", "expat", "root", "open_elements", "open_texts"),
        "parts",
        "counted",
    )

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self.text = source.text
        self.data = source.text.encode("utf-8", "surrogatepass")
        # Only in ASCII text are byte offsets also offsets of code points.
        self.is_ascii = len(self.data) == len(self.text)
        self.root: Element | None = None
        self.open_elements: list[Element] = []
        # The pieces of text in each open element: appending each piece to a string would copy the string each time.
        self.open_texts: list[list[str]] = []
        self.parts = 0
        self.counted = (
            0,
            0,
        )  # bytes and code points so far: the parser only moves forward, so each byte is counted once
        self.expat = parser = expat.ParserCreate(encoding="utf-8")
        parser.buffer_text = True
        parser.StartElementHandler = self._start_element
        parser.EndElementHandler = self._end_element
        parser.CharacterDataHandler = self._add_text
        parser.CommentHandler = self._add_comment
        parser.ProcessingInstructionHandler = self._note_instruction
        parser.StartDoctypeDeclHandler = self._refuse_doctype

    def parse(self) -> Element:
        """Return the root element.

        :raises XmlError: if the text is malformed, exceeds a limit or declares a document type.
        """
        try:
            self.expat.Parse(self.data, True)
        except expat.ExpatError as error:
            raise self._make_malformed_error(error.code) from None
        assert self.root is not None, "expat accepts no document without a root element"
        return self.root

    def _make_malformed_error(self, code: int) -> XmlError:
        at = min(self._find_offset(max(self.expat.ErrorByteIndex, 0)), len(self.text))
        elements = self.open_elements or ([] if self.root is None else [self.root])
        opened = [(element.tag, element.span.line if element.span is not None else 0) for element in elements]
        mistake = describe_mistake(self.text, at, code, opened)
        span = self.source.make_span(mistake.start, mistake.end)
        return XmlError(
            "malformed", mistake.message, span, data={"repair": mistake.repair, "forgiven": mistake.forgiven}
        )

    def _start_element(self, tag: str, values: dict[str, str]) -> None:
        begin = self._find_offset(self.expat.CurrentByteIndex)
        self._count_parts(1 + len(values), begin)
        if len(values) > MAX_ATTRIBUTES:
            message = f"an element has {len(values):,} attributes, more than {MAX_ATTRIBUTES:,}"
            raise self._make_limit_error("attributes", len(values), MAX_ATTRIBUTES, message=message, begin=begin)
        end, typed = _read_tag(self.text, begin)
        if end - begin > MAX_VALUE:
            self._check_lengths(tag, values, begin)
        parent = self.open_elements[-1] if self.open_elements else None
        element = Element(tag, self.source.make_span(begin, end), parent)
        if values:
            self._add_attributes(element, values, typed)
        if parent is not None:
            parent.children.append(element)
        elif self.root is None:
            self.root = element
        self.open_elements.append(element)
        self.open_texts.append([])
        if len(self.open_elements) > MAX_DEPTH:
            message = f"elements are nested more than {MAX_DEPTH} deep"
            depth = len(self.open_elements)
            raise self._make_limit_error("depth", depth, MAX_DEPTH, message=message, begin=begin, end=end)

    def _add_attributes(
        self, element: Element, values: dict[str, str], typed: dict[str, tuple[tuple[int, int], str]]
    ) -> None:
        attributes, make_span = element.attributes, self.source.make_span
        for name, value in values.items():
            place, raw = typed.get(name, (None, value))
            is_plain = raw == value or _BREAK.sub(" ", raw) == value
            literal = is_plain and not ("$" in raw and _SUBSTITUTION.search(raw))
            attributes[name] = Attribute(name, value, element, place and make_span(*place), raw, literal)

    def _end_element(self, _tag: str) -> None:
        self.open_elements.pop().text = "".join(self.open_texts.pop())

    def _add_text(self, text: str) -> None:
        if self.open_texts:
            self.open_texts[-1].append(text)

    def _add_comment(self, text: str) -> None:
        begin = self._find_offset(self.expat.CurrentByteIndex)
        self._count_parts(1, begin)
        self.source.comments.append(Comment(text, self._make_span_to("-->", begin)))

    def _note_instruction(self, _target: str, _data: str) -> None:
        begin = self._find_offset(self.expat.CurrentByteIndex)
        self._count_parts(1, begin)
        if self.source.instruction is None and (self.root is not None or self.source.comments):
            self.source.instruction = self._make_span_to("?>", begin)

    def _refuse_doctype(self, name: str, system: str | None, public: str | None, has_subset: int) -> None:
        is_used = any(entity not in ENTITIES for entity in _ENTITY.findall(self.text))
        # A file that only an editor reads: expat does not open it, and no program needs it.
        if not (has_subset or is_used) and name.lower() != "html":
            return
        # The parser is already behind the declared name.
        begin = self.text.rfind("<!DOCTYPE", 0, self._find_offset(self.expat.CurrentByteIndex))
        span = self.source.make_span(begin, begin + 9)
        subset = _PLAIN_SUBSET.match(self.text, begin)
        is_plain = subset is not None and not (system or public) and not _ELSEWHERE.search(subset[1])
        data = {"plain": is_plain}
        raise XmlError("doctype", "a document type declaration is refused", span, data=data)

    def _find_offset(self, index: int) -> int:
        """Return the offset in code points of a byte."""
        if self.is_ascii:
            return index
        counted, offset = self.counted
        offset += len(self.data[counted:index].decode("utf-8", "replace"))
        self.counted = (index, offset)
        return offset

    def _make_span_to(self, ending: str, begin: int) -> Span:
        """Return the span up to and including an ending, or to the end of the text."""
        stop = self.text.find(ending, begin)
        return self.source.make_span(begin, stop + len(ending) if stop >= 0 else len(self.text))

    def _count_parts(self, added: int, begin: int) -> None:
        self.parts += added
        if self.parts > MAX_PARTS:
            message = f"the file has more than {MAX_PARTS:,} elements, attributes and comments"
            raise self._make_limit_error("parts", self.parts, MAX_PARTS, message=message, begin=begin)

    def _check_lengths(self, tag: str, values: dict[str, str], begin: int) -> None:
        longest = max(map(len, (tag, *values, *values.values())))
        if longest > MAX_VALUE:
            message = f"a name or a value has {longest:,} characters, more than {MAX_VALUE:,}"
            raise self._make_limit_error("value", longest, MAX_VALUE, message=message, begin=begin)

    def _make_limit_error(
        self, what: str, found: int, limit: int, *, message: str, begin: int, end: int | None = None
    ) -> XmlError:
        span = self.source.make_span(begin, begin + 1 if end is None else end)
        return _make_too_large_error(what, found, limit, message=message, span=span)


def _read_tag(text: str, begin: int) -> tuple[int, dict[str, tuple[tuple[int, int], str]]]:
    """Return the end of the start tag at ``begin`` and, per attribute, the offsets and text of its value."""
    values: dict[str, tuple[tuple[int, int], str]] = {}
    name = _TAG.match(text, begin + 1)
    at = begin + 1 if name is None else name.end()
    while match := _ATTRIBUTE.match(text, at):
        group = match.lastindex or 0  # in double quotes or in single quotes
        values[match[1]] = (match.span(group), match[group])
        at = match.end()
    end = text.find(">", at)
    return (end + 1 if end >= 0 else len(text)), values


_BREAKS = re.compile(r"(\r\n|[\r\n\t])")
_ENTITIES = re.compile(r"&(?:#x([0-9a-fA-F]+)|#([0-9]+)|(amp|lt|gt|quot|apos));")
_CHARACTERS = {"amp": "&", "lt": "<", "gt": ">", "quot": '"', "apos": "'"}


def restore_breaks(root: Element) -> None:
    """Give each value the tabs and line breaks that were typed in it.

    XML makes blanks of them, and xacro too; urdfdom and the engines (tinyxml2) read a plain URDF with them, so that the names
    ``a⇥b`` and ``a b`` are two (checked with urdfdom 6).
    """
    for element in root.walk():
        for attribute in element.attributes.values():
            if attribute.typed != attribute.value and _BREAKS.search(attribute.typed):
                parts = [_ENTITIES.sub(_decode_entity, part) for part in _BREAKS.split(attribute.typed)]
                if attribute.value == "".join(" " if i % 2 else part for i, part in enumerate(parts)):
                    attribute.value = "".join("\n" if i % 2 and part != "\t" else part for i, part in enumerate(parts))


def _decode_entity(entity: re.Match[str]) -> str:
    hexadecimal, decimal, name = entity.groups()
    return _CHARACTERS[name] if name else chr(int(hexadecimal, 16) if hexadecimal else int(decimal))


def find_unbound_prefix(root: Element) -> tuple[Element, str] | None:
    """Return the first element with a prefix (its own or an attribute's) that no ``xmlns:`` around declares, and the prefix."""
    bound: set[tuple[int, str]] = set()  # id of an element, and a prefix that is declared in or around it
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
    """Yield the elements around this one, innermost first."""
    while element.parent is not None:
        element = element.parent
        yield element


_QUOTED = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
)


def quote_attribute(value: str) -> str:
    """Return a value as the text of an XML attribute, with quotes (xml.sax.saxutils has this too, but loads an HTTP client)."""
    return f'"{value.translate(_QUOTED)}"'
