"""Edits as the lines of a unified diff that ``patch`` accepts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from itertools import groupby

from urdfcheck.core import NEWLINE, Edit
from urdfcheck.output.shared.code_frames import split_lines

# Longer lines cannot be compared by eye: their edits show only the old and the new text.
LONGEST_LINE = 400

# The kind of a line (head | at | same | del | ins) and the line with its sign, without a newline.
DiffLine = tuple[str, str]


def iter_diff_lines(sources: Mapping[str, str], edits: Iterable[Edit]) -> Iterator[DiffLine]:
    """Yield the lines of the diff; only the place and the old and new text if the source is missing or has changed."""
    ordered = sorted(edits, key=lambda e: (e.span.file, e.span.start, e.span.end))
    for file, group in groupby(ordered, key=lambda e: e.span.file):
        edits_here = list(group)
        text = sources.get(file)
        if text is None or any(_is_stale_or_too_long(text, edit) for edit in edits_here):
            for edit in edits_here:
                yield "head", f"{file}:{edit.span.line}:{edit.span.col}"
                yield from _iter_changed_lines(NEWLINE.split(edit.expected), NEWLINE.split(edit.replacement))
        else:
            yield "head", f"--- {file}"
            yield "head", f"+++ {file}"
            yield from _iter_hunks(text, edits_here)


def _is_stale_or_too_long(text: str, edit: Edit) -> bool:
    """Whether the text of an edit has changed in the meantime, or is in a line that is too long."""
    typed = text[edit.span.start : edit.span.end]
    touched = split_lines(text)[edit.span.line - 1 : edit.span.end_line]
    return typed != edit.expected or any(len(line) > LONGEST_LINE for line in touched)


def _iter_changed_lines(old: Iterable[str], new: Iterable[str]) -> Iterator[DiffLine]:
    yield from (("del", f"-{line}") for line in old)
    yield from (("ins", f"+{line}") for line in new)


def _iter_hunks(text: str, edits: Sequence[Edit]) -> Iterator[DiffLine]:
    """Yield a hunk for each group of edits in neighbouring lines, with a line of context; ``edits`` are sorted, of one file."""
    lines = split_lines(text)
    shift = 0
    for group in _group_neighbouring_edits(edits):
        first, last = group[0].span.line, max(e.span.end_line for e in group)
        before, after = lines[max(0, first - 2) : first - 1], lines[last : last + 1]
        start = group[0].span.start - (group[0].span.col - 1)
        old = [*before, *lines[first - 1 : last], *after]
        new = NEWLINE.split(_apply_edits(text, start, group) + lines[last - 1][group[-1].span.end_col - 1 :])
        new = [*before, *new, *after]
        top = first - len(before)
        yield "at", f"@@ -{top},{len(old)} +{top + shift},{len(new)} @@"
        for tag, i, j, k, m in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
            if tag == "equal":
                yield from (("same", f" {line}") for line in old[i:j])
            else:
                yield from _iter_changed_lines(old[i:j], new[k:m])
        shift += len(new) - len(old)


def _group_neighbouring_edits(edits: Sequence[Edit]) -> list[list[Edit]]:
    groups: list[list[Edit]] = []
    for edit in edits:
        if groups and edit.span.line <= max(e.span.end_line for e in groups[-1]) + 2:
            groups[-1].append(edit)
        else:
            groups.append([edit])
    return groups


def _apply_edits(text: str, start: int, edits: Sequence[Edit]) -> str:
    pieces, end = [], start
    for edit in edits:
        pieces += [text[end : edit.span.start], edit.replacement]
        end = edit.span.end
    return "".join(pieces)
