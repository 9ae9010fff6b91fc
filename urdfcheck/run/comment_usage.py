"""Whether the suppression comments in the files of a unit are needed, as far as this unit can tell."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from functools import cache

from urdfcheck.core import Span
from urdfcheck.policy.suppression import CommentUsage, assess_comment
from urdfcheck.run.jobs import Unit
from urdfcheck.source.load import Source
from urdfcheck.source.text.suppression_comments import IgnoreComment


def assess_comments(
    comments: Iterable[IgnoreComment],
    *,
    needed: AbstractSet[Span],
    texts: Mapping[str, str],
    unit: Unit,
    source: Source | None,
    checked_codes: Collection[str],
    skipped_codes: Collection[str],
) -> tuple[CommentUsage, ...]:
    """Assess each comment. ``needed``: those that suppress a finding; ``texts``: content of the files by name."""
    find_places = cache(lambda: _collect_places(source))  # walks through the model: only where a comment needs it
    return tuple(
        assess_comment(
            comment,
            texts[comment.span.file],
            is_used=comment.span in needed,
            checked_codes=checked_codes,
            skipped_codes=skipped_codes,
            doubt=_explain_doubt(comment, unit=unit, source=source, find_places=find_places),
        )
        for comment in comments
    )


def _explain_doubt(
    comment: IgnoreComment, *, unit: Unit, source: Source | None, find_places: Callable[[], Mapping[str, Sequence[int]]]
) -> str:
    """Return a reason to keep a comment that this unit does not need; empty without one."""
    if source is None or comment.span.file not in source.files:
        return ""
    if unit.is_explicit and comment.span.file != source.name:
        return "other models may use the file"
    # Rules of the XAC family read the text itself, whatever an expansion makes of it.
    if not source.is_xacro or any(selector.upper().startswith("XAC") for selector in comment.selectors):
        return ""
    starts = find_places().get(comment.span.file, [])
    first = bisect_left(starts, comment.start)
    return "" if first < len(starts) and starts[first] < comment.end else "these arguments do not reach it"


def _collect_places(source: Source | None) -> dict[str, list[int]]:
    """Return by file the offsets of the text that elements of the model were made from, ascending."""
    elements = () if source is None or source.root is None else source.root.walk()
    starts: dict[str, set[int]] = {}
    for span in (span for e in elements for span in (e.span, *e.via) if span is not None):
        starts.setdefault(span.file, set()).add(span.start)
    return {file: sorted(offsets) for file, offsets in starts.items()}
