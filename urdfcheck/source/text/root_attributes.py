"""The attributes of a file's root element, for a search that looks at many files and asks nothing else."""

from __future__ import annotations

from xml.parsers import expat

from urdfcheck.source.text.xml import MAX_ATTRIBUTES, MAX_DEPTH, MAX_PARTS, MAX_VALUE, SourceFile, parse_xml


class _NotPlainError(Exception):
    """A limit may be exceeded, or something is declared: `parse_xml` decides."""


def read_root_attributes(source: SourceFile) -> dict[str, str]:
    """Return the attributes of the root element of a text that `parse_xml` accepts, by name.

    All of the text is parsed, but no elements are built of it, which takes ten times as long.

    :raises XmlError: where `parse_xml` raises it.
    """
    try:
        return _Scan().read(source)
    except (_NotPlainError, expat.ExpatError):
        return {name: attribute.value for name, attribute in parse_xml(source).attributes.items()}


class _Scan:
    """Counts what `parse_xml` bounds."""

    __slots__ = ("depth", "parts", "root")

    def __init__(self) -> None:
        self.root: dict[str, str] | None = None
        self.depth = 0
        self.parts = 0

    def read(self, source: SourceFile) -> dict[str, str]:
        if len(source.text) > MAX_VALUE or "\0" in source.text:
            raise _NotPlainError
        parser = expat.ParserCreate(encoding="utf-8")
        parser.StartElementHandler = self._start_element
        parser.EndElementHandler = self._end_element
        parser.CommentHandler = parser.ProcessingInstructionHandler = self._count_part
        parser.StartDoctypeDeclHandler = self._refuse_doctype
        parser.Parse(source.text.encode("utf-8", "surrogatepass"), True)
        assert self.root is not None, "expat accepts no document without a root element"
        return self.root

    def _start_element(self, _tag: str, values: dict[str, str]) -> None:
        if self.root is None:
            self.root = values
        self.depth += 1
        self.parts += 1 + len(values)
        if self.depth > MAX_DEPTH or self.parts > MAX_PARTS or len(values) > MAX_ATTRIBUTES:
            raise _NotPlainError

    def _end_element(self, _tag: str) -> None:
        self.depth -= 1

    def _count_part(self, *_: object) -> None:
        self.parts += 1
        if self.parts > MAX_PARTS:
            raise _NotPlainError

    def _refuse_doctype(self, *_: object) -> None:
        raise _NotPlainError
