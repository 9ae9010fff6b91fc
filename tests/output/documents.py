"""An HTML document read back strictly, to look at it the way a browser does."""

from __future__ import annotations

from dataclasses import dataclass, field
from html.parser import HTMLParser

VOID = {"meta", "br", "input", "hr", "img", "link", "wbr"}


@dataclass
class Document:
    """``tags`` with their attributes in order, ``text`` without markup, style and scripts, the content of ``<style>``, and that
    of each ``<script>``."""

    tags: list[tuple[str, dict[str, str]]] = field(default_factory=list)
    text: str = ""
    style: str = ""
    scripts: list[str] = field(default_factory=list)

    def all(self, tag: str) -> list[dict[str, str]]:
        return [attributes for name, attributes in self.tags if name == tag]

    @property
    def ids(self) -> list[str]:
        return [attributes["id"] for _, attributes in self.tags if "id" in attributes]

    def classes(self, *names: str) -> list[dict[str, str]]:
        """The elements that have all these classes."""
        return [a for _, a in self.tags if set(names) <= set(a.get("class", "").split())]


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.document = Document()
        self.open: list[str] = []
        # Joined at the end: to add each piece to the text so far takes the square of a report's length.
        self.text: list[str] = []
        self.style: list[str] = []
        self.scripts: list[list[str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), f"<{tag}> repeats an attribute"
        self.document.tags.append((tag, {name: value or "" for name, value in attrs}))
        if tag == "script":
            self.scripts.append([])
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag, f"</{tag}> closes something else, at {self.getpos()}"

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "style":
            self.style.append(data)
        elif self.open and self.open[-1] == "script":
            self.scripts[-1].append(data)
        else:
            self.text.append(data)

    def close(self) -> None:
        super().close()
        self.document.text, self.document.style = "".join(self.text), "".join(self.style)
        self.document.scripts = list(map("".join, self.scripts))


def read(html: str) -> Document:
    """:raises AssertionError: when tags are not properly nested, left open, or repeat an attribute."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    assert reader.open == [], f"left open: {reader.open}"
    return reader.document
