"""What differs in the files around the models: pairs, groups, controllers, dependencies and arguments, statement by statement."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.core.model_diff import SeamChange
from urdfcheck.core.seams import SeamFact

# Of each renamed part, by kind and old name: its new name.
Renames = Mapping[tuple[str, str], str]


def compare_seams(before: Sequence[SeamFact], after: Sequence[SeamFact], renames: Renames) -> Iterator[SeamChange]:
    """Yield what differs in the statements of one model, launch file or package.

    A statement that names a renamed part by its new name is the same. One that still names it by the old one is reported as that.
    """
    news = {(fact.kind, fact.file, fact.label): fact for fact in after}
    left = dict(news)
    for fact in {(fact.kind, fact.file, fact.label): fact for fact in before}.values():
        keys = [(fact.kind, fact.file, label) for label in (fact.build_label(renames), fact.label)]
        key = next((key for key in keys if key in left), None)
        if key is None:
            yield _make_change(fact, "removed", f"{fact.label} is gone", before=fact.span)
            continue
        other = left.pop(key)
        if other.value != fact.value:
            text = f"{other.label} changes: {fact.value or 'nothing'} → {other.value or 'nothing'}"
            yield _make_change(other, "changed", text, before=fact.span, after=other.span)
    for fact in left.values():
        yield _make_change(fact, "added", f"{fact.label} is new", after=fact.span)
    for fact in news.values():
        for kind, name in dict.fromkeys(fact.names):
            if (kind, name) in renames:
                text = f"{fact.label}: {kind} {name} is called {renames[kind, name]} now"
                yield _make_change(fact, "old-name", text, after=fact.span)


def _make_change(
    fact: SeamFact, name: str, text: str, *, before: Span | None = None, after: Span | None = None
) -> SeamChange:
    return SeamChange(kind=fact.kind, id=name, subject=fact.label, text=text, before=before, after=after)
