"""The repair in words, as short as the lines below it allow."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rich.text import Text

from urdfcheck.core.text import COMPUTED_NUMBERS
from urdfcheck.output.shared.diffs import LineChange
from urdfcheck.output.text.lines import wrap_text

# What the words and the changed lines both give: ``write ixy="0" ixz="0"``.
_WRITTEN = re.compile(r"""\bwrite (?:`?[\w:.-]+="[^"]*"`?(?:,? and |, | )?)+(?<![ ,])""")
_VALUES = re.compile(r"""[\w:.-]+="[^"]*\"""")
_NUMBERS = re.compile(rf"\b{COMPUTED_NUMBERS}\b")
# Longer texts come from attacks; each end is looked at.
_LONGEST = 600
# Words that belong to the next.
_BINDING = re.compile(r"(?:^|\b(?:and|or|the|a|an|of|to|in|with|for|by|its|about))$")
# Tags and quotes, which are wrapped as one word, and the character that stands for their blanks meanwhile.
_WHOLE = re.compile(r"""<[^<>]*>|"[^"]*"|`[^`]*`""")
_BOUND = "\ue000"
_OPENING, _CLOSING = "([{<", ")]}>"


def refer_to_change(words: str, changes: Sequence[LineChange]) -> str:
    """Leave out of a repair what the changed lines below it show: ``if that is the mistake, apply the diff below``."""
    shown = "\n".join("".join(text for text, _ in change.new) for change in changes)

    def replace_values(found: re.Match[str]) -> str:
        return "apply the diff below" if all(value in shown for value in _VALUES.findall(found[0])) else found[0]

    return _NUMBERS.sub("the numbers below", _WRITTEN.sub(replace_values, words))


def wrap_words(words: str, width: int, lead: Text, most: int, ending: str = "") -> list[Text]:
    """Wrap a repair into at most ``most`` lines; a longer one ends with a clause, and never within a number, a tag or quotes.

    ``ending``: an option behind the words, however much of them is left; it has a line more where it is longer than a line.
    """
    if ending and len(ending) > width - len(lead):
        indent = " " * max(2, min(len(lead), width - len(ending)))
        return [*wrap_words(words, width, lead, most), Text.assemble(indent, (ending, "dim"))]
    tail = f" {ending.replace(' ', _BOUND)}" if ending else ""
    text = words[:_LONGEST]
    lines = _wrap_whole(Text.assemble(text, (tail, "dim")), width, lead)
    if len(lines) <= most and len(text) == len(words):
        return lines
    tail = f" …{tail}"
    cuts = _list_cuts(text[: most * width])
    fitting = [cut for cut in cuts if len(_wrap_whole(Text(text[: cut[0]] + tail), width, lead)) <= most]
    if fitting:
        longest = fitting[-1][0]
        # A clause is better than a longer piece, unless it is the least part of it.
        ends = [
            e
            for marks, part in ((";.", 0.3), (",:", 0.6), ("", 0))
            for e, m in reversed(fitting)
            if e >= part * longest and (not marks or m in marks)
        ]
        return _wrap_whole(Text.assemble(text[: ends[0]], (tail, "dim")), width, lead)
    kept = lines[:most]  # a word longer than the lines
    kept[-1].truncate(max(width - len(tail), 0))
    kept[-1].append(tail.replace(_BOUND, " "), "dim")
    return kept


def _wrap_whole(text: Text, width: int, lead: Text) -> list[Text]:
    """Wrap a text between words, but not within a tag or quotes that fit into half a line."""
    room = width - len(lead)

    def bind(found: re.Match[str]) -> str:
        return found[0].replace(" ", _BOUND) if len(found[0]) <= room // 2 else found[0]

    words = _WHOLE.sub(bind, text.plain).split(" ")
    bound = text.copy()
    bound.plain = " ".join(word if len(word) <= room else word.replace(_BOUND, " ") for word in words)
    lines = list(wrap_text(bound, width, lead))
    for line in lines:
        line.plain = line.plain.replace(_BOUND, " ")
    return lines


def _list_cuts(text: str) -> list[tuple[int, str]]:
    """Return the index of each blank outside brackets, tags and quotes, and the character before it."""
    cuts, depth, quote = [], 0, ""
    for i, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in '`"':
            quote = letter
        elif letter in _OPENING:
            depth += 1
        elif letter in _CLOSING:
            depth = max(depth - 1, 0)
        elif letter == " " and not depth and not _BINDING.search(text[:i][-10:]):
            cuts.append((i, text[i - 1]))
    return cuts
