"""The small Markdown of rule pages as HTML."""

from __future__ import annotations

import re

from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.rule_page import iter_inline_pieces

_FENCE = re.compile(r"^(?:```|~~~)")
_ITEM = re.compile(r"^(?:[-*+]|\d+[.)])\s+")


def render_markdown(text: str) -> str:
    """Render paragraphs, lists, code blocks, tables as typed, inline code and emphasis; a link becomes its text and address."""
    return "\n".join(_render_block(block) for block in _split_blocks(text))


def _split_blocks(text: str) -> list[list[str]]:
    blocks: list[list[str]] = [[]]
    fenced = False
    for line in text.strip("\n").split("\n"):
        if _FENCE.match(line):
            if not fenced:
                blocks.append([])
            fenced = not fenced
        elif not fenced and (not line.strip() or (_ITEM.match(line) and not _is_list(blocks[-1]))):
            blocks.append([])
        blocks[-1].append(line)
        if _FENCE.match(line) and not fenced:
            blocks.append([])
    stripped = (block if block and _FENCE.match(block[0]) else _drop_blank_lines(block) for block in blocks)
    return [block for block in stripped if block]


def _drop_blank_lines(block: list[str]) -> list[str]:
    return [line for line in block if line.strip()]


def _is_list(block: list[str]) -> bool:
    return any(_ITEM.match(line) for line in block)


def _render_block(block: list[str]) -> str:
    if _FENCE.match(block[0]):
        end = -1 if len(block) > 1 and _FENCE.match(block[-1]) else len(block)
        return f"<pre>{escape_html(chr(10).join(block[1:end]))}</pre>"
    if block[0].startswith("|"):
        return f"<pre>{escape_html(chr(10).join(block))}</pre>"
    if not _ITEM.match(block[0]):
        return f"<p>{render_inline(' '.join(line.strip() for line in block))}</p>"
    items: list[str] = []
    for line in block:
        if match := _ITEM.match(line):
            items.append(line[match.end() :])
        else:
            items[-1] += " " + line.strip()
    tag = "ol" if block[0][0].isdigit() else "ul"
    return f"<{tag}>" + "".join(f"<li>{render_inline(item)}</li>" for item in items) + f"</{tag}>"


def render_inline(paragraph: str) -> str:
    """Render the inline code and emphasis of a paragraph."""
    return "".join(
        escape_html(text) if kind == "text" else f"<{kind}>{escape_html(text)}</{kind}>"
        for kind, text in iter_inline_pieces(paragraph)
    )
