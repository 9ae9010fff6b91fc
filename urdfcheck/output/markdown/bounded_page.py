"""A Markdown page of bounded size: what does not fit is counted, and reported at the end."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from urdfcheck.output.shared.escaping import escape_for_log
from urdfcheck.output.shared.wording import format_count

# Bytes reserved for the last line and the end of a fold.
RESERVE = 500
# Limit of a text in characters: the other reports have everything.
LONGEST_TEXT = 600


class BoundedPage:
    """Lines of a document of at most ``room`` bytes; what does not fit is counted, and reported at the end.

    A line that would be beyond :attr:`most_lines` does not fit either.
    """

    def __init__(self, room: int, lines: Iterable[str]) -> None:
        self.lines = list(lines)
        self.left = room - RESERVE - sum(map(_measure_size, self.lines))
        self.most_lines: float = math.inf
        self.missing: list[str] = []

    def add_lines(self, *lines: str) -> bool:
        """Add the lines if all of them fit, and return whether they did."""
        lines = tuple(map(escape_for_log, lines))
        size = sum(map(_measure_size, lines))
        if size > self.left or len(self.lines) + len(lines) > self.most_lines:
            return False
        self.left -= size
        self.lines += lines
        return True

    def add_group(
        self, noun: str, *, head: Sequence[str], blocks: Sequence[Sequence[str]], foot: Sequence[str]
    ) -> None:
        """Add as many blocks as fit between a head and a foot; ``noun``: the word for one block."""
        self.left -= sum(map(_measure_size, foot))
        self.most_lines -= len(foot)
        shown = 0
        if blocks and self.add_lines(*head, *blocks[0]):
            shown = 1
            while shown < len(blocks) and self.add_lines(*blocks[shown]):
                shown += 1
            self.lines += foot
        else:
            self.left += sum(map(_measure_size, foot))
        self.most_lines += len(foot)
        if shown < len(blocks):
            self.missing.append(format_count(len(blocks) - shown, noun))

    def build_text(self) -> str:
        """Join the lines, and report at the end what did not fit."""
        if self.missing:
            missing = ", ".join(self.missing)
            self.lines.append(f"*Left out to keep this short: {missing}. The other reports have all.*")
        return "\n".join(self.lines).rstrip("\n") + "\n"


def _measure_size(line: str) -> int:
    return len(line.encode(errors="replace")) + 1


def make_fold(summary: str) -> tuple[list[str], list[str]]:
    """Return the lines before and after what is folded."""
    return ["<details>", f"<summary>{summary}</summary>", ""], ["", "</details>", ""]


def truncate_text(text: str) -> str:
    """Cut a text at :data:`LONGEST_TEXT` characters."""
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}…"
