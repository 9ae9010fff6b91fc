"""Long answers in pages of a few thousand tokens."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output.agent import MOST_CHARACTERS


def select_page(text: str, number: int) -> str:
    """Return a page of a text, by its number from 1, and how to ask for the next.

    :raises UrdfcheckError: where there is no such page.
    """
    pages = list(_iter_pages(text))
    if not 1 <= number <= len(pages):
        raise UrdfcheckError(f"there is no page {number}: the answer has {len(pages)}")
    page = pages[number - 1]
    return page if number == len(pages) else f"{page}\n… page {number} of {len(pages)}: page={number + 1} has the next"


def _iter_pages(text: str) -> Iterator[str]:
    """Yield pieces of about so many characters, broken at the ends of lines where there are any."""
    start = 0
    while len(text) - start > MOST_CHARACTERS:
        end = text.rfind("\n", start, start + MOST_CHARACTERS)
        end = start + MOST_CHARACTERS if end <= start else end
        yield text[start:end]
        start = end + text.startswith("\n", end)
    yield text[start:]
