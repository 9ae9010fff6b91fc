"""Untrusted text made inert: every output shows it, and no terminal, browser or CI system acts on it.

A name, a path or a message of a file may hold escape sequences that a terminal obeys, characters that change or hide what is
shown (direction controls, invisible characters), and commands that a CI system runs from its log: a line that begins
with ``::`` (GitHub), and ``##[…]``, ``##vso[…]``, ``##teamcity[…]`` anywhere in a line (GitHub, Azure, TeamCity; the
sections of GitLab and Travis need control characters). Each output passes what it writes through its function here, last.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable

# Unicode categories: controls, format characters, surrogates, private use, line and paragraph separators.
_ACTING = frozenset({"Cc", "Cf", "Cs", "Co", "Zl", "Zp"})
# Letters and marks without a shape: fillers of Hangul and Khmer, the grapheme joiner, and code points reserved for more.
_INVISIBLE = re.compile(
    "[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2065\u3164\uffa0\ufff0-\ufff8\U000e0000-\U000e0fff]"
)
_UNUSUAL = re.compile(r"[^\n\t -~]")
# A match ends at the character to escape. A runner strips the blanks of a line before it looks for commands.
_COMMAND = re.compile(r"^[^\S\n]*:(?=:)|#(?=#\w*\[)", re.MULTILINE)
# What Markdown and the sites that render it interpret inside a line: markup, entities, links, pictures, mentions, emoji,
# formulas, references to issues and commits. A word with any of it is shown as code, where none of it is interpreted.
_MARKUP = r"[][*`{|}\\]|<[\w/!?]|[#@~$^:&!]\S|%\w|(?<![^\W_])_|_(?![^\W_])|\bwww\.|\bG[HL]-\d|(?<![\w.])[\da-f]{7,40}(?![\w.])"
# First words that begin a heading, a list, a quotation, a rule or a quick action of GitLab.
_BLOCK = re.compile(r"[#+=-]+$|[>/]|\d+[.)]$")
_CODED = re.compile(r"`([^`]+)`")
_WORD = re.compile(r"\S+")
# Punctuation before and after a word, kept out of its code span.
_OPENING, _CLOSING = "(\"'«", ")\"'»,.;:?!"


def escape_invisible(text: str) -> str:
    """Escape control and invisible characters, like ``\\x1b``; line breaks and tabs stay."""
    return text if text.isascii() and text.isprintable() else _escape_characters(text, _to_backslash_escape)


def escape_one_line(text: str) -> str:
    """Escape a name or a path like :func:`escape_invisible`, and its line breaks and tabs too."""
    return escape_invisible(text).replace("\n", "\\n").replace("\t", "\\t")


def find_ci_command(line: str, start: int = 0) -> int | None:
    """Return the index, from ``start`` on, of a character that must be escaped so that a line of a CI log is not a command."""
    match = _COMMAND.search(line, start)
    return None if match is None else match.end() - 1


def escape_for_log(text: str) -> str:
    """Escape text for a terminal and a CI log."""
    return _escape_ci_commands(escape_invisible(text), _to_backslash_escape)


def escape_for_json(text: str) -> str:
    """Escape a JSON document: what is escaped here occurs only inside its strings."""
    return _escape_ci_commands(_escape_characters(text, _to_json_escape), _to_json_escape)


def escape_for_html(text: str) -> str:
    """Escape an HTML document whose values are escaped already."""
    return _escape_ci_commands(_escape_characters(text, _to_backslash_escape), _to_character_reference)


def escape_for_xml(text: str) -> str:
    """Escape an XML document whose values are escaped already; a parser reads the same values as before."""
    return _escape_ci_commands(_escape_characters(text, _to_character_reference), _to_character_reference)


def escape_for_markdown(text: str) -> str:
    """Escape a line or a table cell of a Markdown document: text in backticks, and every word that could be markup, as code.

    The document itself goes through :func:`escape_for_log`, because it may be printed."""
    pieces = _CODED.split(escape_one_line(text))
    pieces[1::2] = map(format_code_span, pieces[1::2])
    pieces[::2] = (_WORD.sub(_wrap_markup_word, piece) for piece in pieces[::2])
    line = "".join(pieces).lstrip()
    first, blank, rest = line.partition(" ")
    return f"{format_code_span(first)}{blank}{rest}" if _BLOCK.match(first) else line


def format_code_span(text: str) -> str:
    """Format a name or a path as code in Markdown; characters that would end the code or the table cell are escaped."""
    shown = escape_one_line(text).replace("`", _to_backslash_escape("`")).replace("|", _to_backslash_escape("|"))
    # An empty code span is not code, and one blank is stripped from each end.
    return f"`{shown}`" if shown and shown == shown.strip() else f"` {shown} `"


def _wrap_markup_word(match: re.Match[str]) -> str:
    word = match[0]
    if not re.search(_MARKUP, word, re.IGNORECASE):  # compiled when it is needed, which takes 2 ms
        return word
    inner = word.lstrip(_OPENING)
    core = inner.rstrip(_CLOSING)
    return f"{word[: -len(inner)]}{format_code_span(core)}{inner[len(core) :]}" if core else format_code_span(word)


def _escape_characters(text: str, escape: Callable[[str], str]) -> str:
    return _UNUSUAL.sub(lambda match: match[0] if _is_harmless(match[0]) else escape(match[0]), text)


def _escape_ci_commands(text: str, escape: Callable[[str], str]) -> str:
    return _COMMAND.sub(lambda match: match[0][:-1] + escape(match[0][-1]), text)


def _is_harmless(character: str) -> bool:
    return unicodedata.category(character) not in _ACTING and not _INVISIBLE.match(character)


def _to_backslash_escape(character: str) -> str:
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _to_json_escape(character: str) -> str:
    units = character.encode("utf-16-be", "surrogatepass").hex()
    return "".join(f"\\u{units[i : i + 4]}" for i in range(0, len(units), 4))


def _to_character_reference(character: str) -> str:
    return f"&#{ord(character)};"
