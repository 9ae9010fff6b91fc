"""The page of a rule: its address, its sections, and its inline Markdown in pieces."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Literal

from urdfcheck import version

# The sections that reports quote, in this order.
SHOWN_SECTIONS = ("What it checks", "Why it matters", "How to fix", "When to ignore")

InlineKind = Literal["text", "code", "strong", "em"]

_LINK = re.compile(r"\[([^\]]+)\]\(([^)\s]+)\)")
_INLINE = re.compile(r"(`+)(.+?)\1|\*\*(.+?)\*\*|(?<![\w*])\*([^*\s](?:[^*]*[^*\s])?)\*(?![\w*])", re.DOTALL)


def find_rule_address(code: str) -> str:
    """Return where the page of a rule is published; empty as long as no site is."""
    return f"{version.SITE}rules/{code}/" if version.SITE else ""


def split_sections(page: str) -> dict[str, str]:
    """Return the ``##`` sections of a rule page by title."""
    parts = re.split(r"^## +(.+?)\s*$", page, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def iter_inline_pieces(paragraph: str) -> Iterator[tuple[InlineKind, str]]:
    """Split a paragraph at its inline code and emphasis; a link becomes its text and address."""
    text = _LINK.sub(r"\1 (\2)", paragraph)
    end = 0
    for match in _INLINE.finditer(text):
        yield "text", text[end : match.start()]
        _, code, strong, emphasis = match.groups()
        if code is not None:
            yield "code", code.strip()
        elif strong is not None:
            yield "strong", strong
        else:
            yield "em", emphasis
        end = match.end()
    yield "text", text[end:]
