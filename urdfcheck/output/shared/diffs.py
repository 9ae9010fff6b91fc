"""Edits as changed lines: those of a unified diff that ``patch`` accepts, and single ones that fit into a column."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from itertools import groupby

from urdfcheck.core import NEWLINE, Edit
from urdfcheck.core.records import dataclass
from urdfcheck.output.shared.code_frames import split_lines

# Longer lines cannot be compared by eye: only their beginning and the attributes that change are shown.
LONGEST_LINE = 400
# In still longer ones, which no person typed, no attributes are looked for.
LONGEST_TYPED_LINE = 20_000

# The kind of a line (head | at | same | del | ins) and the line with its sign, without a newline.
DiffLine = tuple[str, str]

# A piece of a line, and whether it changes.
Piece = tuple[str, bool]

# A value may go on in the next line.
_ATTRIBUTE = re.compile(r"""(?<![\w:.-])[\w:.-]+\s*=\s*(?:"[^"]*(?:"|$)|'[^']*(?:'|$))""")
_TAG = re.compile(r"\s*<[\w:.-]+")
_TAG_END = re.compile(r"(?<!\s)\s*[/?]?>\s*$")


@dataclass(frozen=True, slots=True)
class LineChange:
    """A line of a file before and after edits, in pieces; without any where there was none, or none remains."""

    file: str
    line: int
    old: tuple[Piece, ...]
    new: tuple[Piece, ...]


def iter_diff_lines(sources: Mapping[str, str], edits: Iterable[Edit]) -> Iterator[DiffLine]:
    """Yield the lines of the diff; where the source is missing, has changed or has too long lines, what changes in each line."""
    ordered = sorted(edits, key=lambda e: (e.span.file, e.span.start, e.span.end))
    for file, group in groupby(ordered, key=lambda e: e.span.file):
        edits_here = list(group)
        text = sources.get(file)
        if text is None or any(_is_stale_or_too_long(text, edit, LONGEST_LINE) for edit in edits_here):
            for change in list_line_changes(sources, edits_here):
                old, new = fit_change(change, LONGEST_LINE)
                yield "head", f"{file}:{change.line}"
                yield from _iter_changed_lines([_join_pieces(old)] if old else [], [_join_pieces(new)] if new else [])
        else:
            yield "head", f"--- {file}"
            yield "head", f"+++ {file}"
            yield from _iter_hunks(text, edits_here)


def list_line_changes(sources: Mapping[str, str], edits: Iterable[Edit]) -> list[LineChange]:
    """Return what edits change, a change for each line of the source however many edits are in it.

    Where the source is missing or has changed, the change is that of the edit's text alone.
    """
    changes: list[LineChange] = []
    ordered = sorted(edits, key=lambda e: (e.span.file, e.span.start, e.span.end))
    for file, in_file in groupby(ordered, key=lambda e: e.span.file):
        text = sources.get(file, "")
        for group in _group_edits(list(in_file), apart=0):
            if not text or any(_is_stale_or_too_long(text, e, LONGEST_TYPED_LINE) for e in group):
                changes += (c for e in group for c in _compare_lines(e, [e.expected], [e.replacement]))
            elif group[0].span.line == max(e.span.end_line for e in group) and not any(map(_breaks_line, group)):
                changes.append(_compare_attributes(text, group))
            else:
                lines, last = split_lines(text), max(e.span.end_line for e in group)
                new = _apply_to_lines(text, group)
                changes += _compare_lines(group[0], lines[group[0].span.line - 1 : last], new)
    return changes


def fit_change(change: LineChange, width: int) -> tuple[tuple[Piece, ...], tuple[Piece, ...]]:
    """Return the pieces of a change without the indent of its line.

    Where one of the two lines takes more than ``width`` characters, of what does not change only the tag remains. What changes
    is never left out: the line may then be longer.
    """
    sides = [_join_pieces(side) for side in (change.old, change.new)]
    fits = all(len(side.strip()) <= width for side in sides)
    if fits:
        return _strip_pieces(change.old), _strip_pieces(change.new)
    return _strip_pieces(_shorten_pieces(change.old)), _strip_pieces(_shorten_pieces(change.new))


def _join_pieces(pieces: Iterable[Piece]) -> str:
    return "".join(text for text, _ in pieces)


def _strip_pieces(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    stripped = list(pieces)
    if stripped:
        stripped[0] = (stripped[0][0].lstrip(), stripped[0][1])
        stripped[-1] = (stripped[-1][0].rstrip(), stripped[-1][1])
    return tuple(piece for piece in stripped if piece[0])


def _shorten_pieces(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """Leave out of the pieces that do not change what is neither the tag nor its end."""
    last = len(pieces) - 1
    return tuple(
        piece if piece[1] else (_shorten_text(piece[0], is_first=not i, is_last=i == last), False)
        for i, piece in enumerate(pieces)
    )


def _shorten_text(text: str, *, is_first: bool, is_last: bool) -> str:
    tag = _TAG.match(text) if is_first else None
    end = _TAG_END.search(text) if is_last else None
    middle = text[tag.end() if tag else 0 : end.start() if end else len(text)]
    if not middle.strip():
        return text
    before, after = ("" if is_first and tag is None else " "), ("" if is_last and end is None else " ")
    return f"{tag[0] if tag else ''}{before}…{after}{end[0].strip() if end else ''}"


def _compare_attributes(text: str, edits: Sequence[Edit]) -> LineChange:
    """Return the change of one line: its pieces that change are whole attributes, or the text of an edit elsewhere."""
    span = edits[0].span
    line, start = split_lines(text)[span.line - 1], span.start - (span.col - 1)
    ranges: list[tuple[int, int, list[Edit]]] = []
    attributes = [(start + m.start(), start + m.end()) for m in _ATTRIBUTE.finditer(line)]
    for edit in edits:
        here = (edit.span.start, edit.span.end)
        first, last = next((a for a in attributes if a[0] <= here[0] and here[1] <= a[1]), here)
        if ranges and first < ranges[-1][1]:
            ranges[-1][2].append(edit)
        else:
            ranges.append((first, last, [edit]))
    old: list[Piece] = []
    new: list[Piece] = []
    end = start
    for first, last, inside in ranges:
        for side in (old, new):
            side.append((text[end:first], False))
        old.append((text[first:last], True))
        new.append((_apply_edits(text, first, inside) + text[inside[-1].span.end : last], True))
        end = last
    for side in (old, new):
        side.append((text[end : start + len(line)], False))
    return LineChange(span.file, span.line, tuple(old), tuple(new))


def _compare_lines(edit: Edit, old: Sequence[str], new: Sequence[str]) -> Iterator[LineChange]:
    """Yield the lines that differ, those that are removed and added in pairs."""
    old = [line for text in old for line in NEWLINE.split(text)]
    new = [line for text in new for line in NEWLINE.split(text)]
    for tag, i, j, k, m in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        for n in range(max(j - i, m - k)):
            before, after = ([(lines[n], True)] if n < len(lines) else [] for lines in (old[i:j], new[k:m]))
            if any(text.strip() for text, _ in (*before, *after)):
                yield LineChange(edit.span.file, edit.span.line + i + n, tuple(before), tuple(after))


def _breaks_line(edit: Edit) -> bool:
    return NEWLINE.search(edit.replacement) is not None


def _is_stale_or_too_long(text: str, edit: Edit, longest: int) -> bool:
    """Whether the text of an edit has changed in the meantime, or is in a line that is too long."""
    typed = text[edit.span.start : edit.span.end]
    touched = split_lines(text)[edit.span.line - 1 : edit.span.end_line]
    return typed != edit.expected or any(len(line) > longest for line in touched)


def _iter_changed_lines(old: Iterable[str], new: Iterable[str]) -> Iterator[DiffLine]:
    yield from (("del", f"-{line}") for line in old)
    yield from (("ins", f"+{line}") for line in new)


def _iter_hunks(text: str, edits: Sequence[Edit]) -> Iterator[DiffLine]:
    """Yield a hunk for each group of edits in neighbouring lines, with a line of context; ``edits`` are sorted, of one file."""
    lines = split_lines(text)
    shift = 0
    for group in _group_edits(edits, apart=2):
        first, last = group[0].span.line, max(e.span.end_line for e in group)
        before, after = lines[max(0, first - 2) : first - 1], lines[last : last + 1]
        old = [*before, *lines[first - 1 : last], *after]
        new = [*before, *_apply_to_lines(text, group), *after]
        top = first - len(before)
        yield "at", f"@@ -{top},{len(old)} +{top + shift},{len(new)} @@"
        for tag, i, j, k, m in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
            if tag == "equal":
                yield from (("same", f" {line}") for line in old[i:j])
            else:
                yield from _iter_changed_lines(old[i:j], new[k:m])
        shift += len(new) - len(old)


def _apply_to_lines(text: str, edits: Sequence[Edit]) -> list[str]:
    """Return the lines that the edits, of neighbouring lines, make of these."""
    span, last = edits[0].span, edits[-1].span
    rest = split_lines(text)[last.end_line - 1][last.end_col - 1 :]
    return NEWLINE.split(_apply_edits(text, span.start - (span.col - 1), edits) + rest)


def _group_edits(edits: Sequence[Edit], *, apart: int) -> list[list[Edit]]:
    """Group the edits that are in one line or at most so many lines ``apart``."""
    groups: list[list[Edit]] = []
    for edit in edits:
        if groups and edit.span.line <= max(e.span.end_line for e in groups[-1]) + apart:
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
