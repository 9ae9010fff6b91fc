"""The source line of a finding with its span underlined."""

from __future__ import annotations

from collections.abc import Iterator

from rich.cells import cell_len
from rich.text import Text

from urdfcheck.core import Run, Span
from urdfcheck.output.shared.code_frames import MOST_LINES, extract_code_frame
from urdfcheck.output.shared.escaping import escape_invisible


def iter_code_frame(
    run: Run, span: Span, *, style: str, width: int, context: int = 1, label: str = "", most_lines: int = MOST_LINES
) -> Iterator[Text]:
    """Yield the lines of a span, ``most_lines`` of them, and ``context`` lines around it.

    ``label`` stands behind the marks where there is room.
    """
    lines = extract_code_frame(run.sources.get(span.file, ""), span, context, most_lines)
    if not lines:
        return
    digits = len(str(lines[-1].number))
    room = max(width - digits - 5, 20)
    for line in lines:
        text = escape_invisible(line.text.replace("\t", " "))
        start, end = (len(escape_invisible(line.text[:k].replace("\t", " "))) for k in line.marked or (0, 0))
        shown, cut = crop_to_window(text, start, end, room=room)
        yield Text.assemble((f"  {line.number:>{digits}} │ ", "dim"), shown)
        if line.marked is not None:
            first = max(start - cut, 0)
            marks = " " * first + "^" * max(min(end - cut, cell_len(shown)) - first, 1)
            told = Text.assemble((f"  {' ' * digits} │ ", "dim"), (marks, style))
            if label and told.cell_len + 1 + cell_len(label) <= width:
                told.append(f" {label}", style)
                label = ""  # once
            yield told


def crop_to_window(text: str, start: int, end: int, *, room: int) -> tuple[str, int]:
    """Cut a line to ``room`` columns around its marked part; return it and the number of columns cut from its left.

    A marked part that is longer keeps its end, the name of a file, if it is one word, and else the attributes that fit.
    """
    is_word = " " not in text[start:end].strip()
    cut = 0 if end <= room - 1 else max(0, min(start - room // 3, len(text) - room))
    if cut + room <= end < len(text) or cut + room < end:
        whole = max(cut, min(end + 1, len(text)) - room)  # with an ellipsis on each side
        cut = whole if whole < start or is_word else cut
    shown = text[cut : cut + room]
    if cut:
        shown = "…" + shown[1:]
    if cut + room < len(text):
        before, blank, _ = shown.rpartition(" ")
        is_cut = end > cut + room - 1  # of the marked part, whose numbers are not cut
        shown = f"{before}{blank}…" if is_cut and not is_word and len(before) > room // 2 else shown[:-1] + "…"
    return shown, cut
