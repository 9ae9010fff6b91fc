"""Text made inert for HTML: escaping, numbers with units, and the small Markdown that rule pages are written in."""

from __future__ import annotations

import html
import math
import re

from urdfcheck.output.shared.inert import escape_invisible

NO_VALUE = "—"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_FENCE = re.compile(r"^(?:```|~~~)")
_ITEM = re.compile(r"^(?:[-*+]|\d+[.)])\s+")
_LINK = re.compile(r"\[([^\]]+)\]\(([^)\s]+)\)")
_CODE = re.compile(r"`([^`\n]+)`")
_INLINE = re.compile(r"(`+)(.+?)\1|\*\*(.+?)\*\*|(?<![\w*])\*([^*\s](?:[^*]*[^*\s])?)\*(?![\w*])", re.DOTALL)


def escape_html(text: str) -> str:
    """``text`` safe between tags and in quoted attributes; control and direction-changing characters spelled out."""
    return html.escape(escape_invisible(text))


def render_prose(text: str) -> str:
    """A message of a rule: plain text but for what stands in backticks."""
    return _CODE.sub(r"<code>\1</code>", escape_html(text))


def get_base_name(path: str) -> str:
    return path.replace("\\", "/").rsplit("/", 1)[-1]


def shorten_message(text: str, most: int = 80) -> str:
    """How a message begins: whole words of its first line, without code marks."""
    line = " ".join(text.split("\n")[0].replace("`", "").split())
    if len(line) <= most:
        return line
    return line[: most + 1].rsplit(" ", 1)[0][:most].rstrip(" ,;:(") + "…"


def join_first(words: list[str], most: int) -> str:
    """The first ``most`` words, and how many more there are."""
    rest = len(words) - most
    return ", ".join(words[:most]) + (f" and {rest} more" if rest > 0 else "")


# -- numbers -----------------------------------------------------------------------------------------------------------


def format_number(value: float | None, digits: int = 4) -> str:
    """``digits`` significant digits with a true minus sign; powers of ten below 1e-4 and from 1e6 on."""
    if value is None:
        return NO_VALUE
    if not math.isfinite(value):
        return str(value).replace("-", "−")
    if value == 0:
        return "0"
    if 1e4 <= abs(value) < 1e6:
        return format_whole_number(value)
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    power = f"×10{str(int(exponent)).translate(_SUPERSCRIPT)}" if exponent else ""
    return mantissa.replace("-", "−") + power


def format_whole_number(value: float) -> str:
    """A whole number with thin spaces between thousands."""
    return f"{value:,.0f}".replace(",", "\u202f").replace("-", "−")


def format_millimetres(metres: float) -> str:
    """Three decimals of a millimetre; what rounds to nothing is a plain 0."""
    if not math.isfinite(metres):
        return str(metres)
    text = _format_fixed(metres * 1000, 3)
    return text if text.strip("0.") else "0"


def _format_fixed(value: float, decimals: int) -> str:
    """No minus sign on what rounds to zero."""
    text = f"{value:.{decimals}f}"
    return text.replace("-", "" if float(text) == 0 else "−")


def format_scaled(values: tuple[float, ...], digits: int = 4) -> tuple[list[str], str]:
    """Values that share one power of ten (a multiple of three), so that they can be compared down to a digit."""
    largest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    power = 0 if largest == 0 or 0.1 <= largest < 1e4 else 3 * math.floor(math.log10(largest) / 3)
    decimals = max(0, digits - 1 - math.floor(math.log10(largest * 10.0**-power))) if largest > 0 else 0
    mantissas = [_format_fixed(v * 10.0**-power, decimals) for v in values]
    return mantissas, f"×10{str(power).translate(_SUPERSCRIPT)}" if power else ""


# -- Markdown ----------------------------------------------------------------------------------------------------------


def split_sections(page: str) -> dict[str, str]:
    """The ``##`` sections of a rule page by title."""
    parts = re.split(r"^## +(.+?)\s*$", page, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def render_markdown(text: str) -> str:
    """Paragraphs, lists, code blocks, tables as typed, inline code, emphasis; a link becomes its text and address."""
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
    return [
        kept for block in blocks if (kept := block if block and _FENCE.match(block[0]) else _drop_blank_lines(block))
    ]


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


def render_inline(text: str) -> str:
    """One paragraph's text."""
    text = _LINK.sub(r"\1 (\2)", text)
    pieces, at = [], 0
    for match in _INLINE.finditer(text):
        pieces.append(escape_html(text[at : match.start()]))
        _, code, strong, emphasis = match.groups()
        if code is not None:
            pieces.append(f"<code>{escape_html(code.strip())}</code>")
        elif strong is not None:
            pieces.append(f"<strong>{escape_html(strong)}</strong>")
        else:
            pieces.append(f"<em>{escape_html(emphasis)}</em>")
        at = match.end()
    return "".join(pieces) + escape_html(text[at:])
