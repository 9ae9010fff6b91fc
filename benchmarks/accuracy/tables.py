"""Outcomes as Markdown tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from injections import KINDS
from scoring import CLEAN, Excluded, Outcome

# Of the cases that may be named: the link of the twin that is wrong is another question.
ASKED = ("exact", "lumped", "twin")
# The confusions that the table lists, the most frequent first.
LISTED = 40


def parts(cases: Sequence[Outcome | Excluded]) -> str:
    """Everything that is said of generated parts."""
    asked = [c for c in cases if isinstance(c, Outcome)]
    left_out = [c for c in cases if isinstance(c, Excluded)]
    shown = {k.name for k in KINDS if k.common and not k.hidden}
    hidden = {k.name for k in KINDS if k.hidden}
    elsewhere = {k.name for k in KINDS if k.elsewhere}
    nameless = {k.name for k in KINDS if not k.names}
    sections = [
        _summary(asked, shown, hidden, nameless),
        _recall("Kinds that one link shows", sorted(shown), asked, left_out),
        _recall("Kinds that one link need not show", sorted(hidden), asked, left_out),
        _others(
            "Kinds that other rules name", "What the diagnosis by itself says about them", sorted(elsewhere), asked
        ),
        _others("Mistakes without a name", "Every cause that is named is wrong", sorted(nameless), asked),
        _confusions([c for c in asked if c.kind in shown | hidden | {CLEAN}]),
        _blamed([c for c in asked if c.mode == "blamed" and c.kind in shown | hidden | nameless]),
    ]
    return "\n".join(sections)


def _summary(asked: Sequence[Outcome], shown: set[str], hidden: set[str], nameless: set[str]) -> str:
    def of(mode: str, kinds: set[str]) -> list[Outcome]:
        return [c for c in asked if c.mode == mode and c.kind in kinds]

    judged = [c for c in asked if c.mode in ASKED and c.kind in shown | hidden | {CLEAN}]
    named = [c for c in judged if c.cause]
    rows = [
        ("recall, exact, all kinds", of("exact", shown | hidden), 0.99),
        ("recall, lumped, kinds that one link shows", of("lumped", shown), 0.85),
        ("recall, lumped, all kinds", of("lumped", shown | hidden), None),
        ("recall, lumped, with a twin, all kinds", of("twin", shown | hidden), 0.92),
    ]
    lines = ["", "## Summary", "", "| measure | cases | name | name or numbers | repaired | target |"]
    lines += ["|---|---|---|---|---|---|"]
    for name, cases, target in rows:
        lines.append(f"| {name} | {len(cases)} | {_three(cases, ' | ')} | {_against(_right(cases), target)} |")
    for mode in (None, *ASKED):
        some = [c for c in named if mode in (None, c.mode)]
        where = f"precision of a named cause, {mode or 'all'}"
        target_cell = _against(_right(some), 0.99 if mode is None else None)
        lines.append(f"| {where} | {len(some)} named | {_three(some, ' | ')} | {target_cell} |")
    all_named = [c for c in asked if c.mode in ASKED and c.cause and c.kind in shown | hidden | nameless | {CLEAN}]
    where = "precision, mistakes without a name included"
    lines.append(f"| {where} | {len(all_named)} named | {_three(all_named, ' | ')} |  |")
    lines += ["", "| clean parts | cases | a cause named | not sound | target |", "|---|---|---|---|---|"]
    for mode in ASKED:
        clean = of(mode, {CLEAN})
        wrong, unsound = _share(c.cause is not None for c in clean), _share(not c.sound for c in clean)
        limit = "" if mode != "lumped" else "<= 2.0 %" + ("" if unsound <= 0.02 else " MISSED")
        lines.append(f"| {mode} | {len(clean)} | {_percent(wrong)} | {_percent(unsound)} | {limit} |")
    return "\n".join(lines)


def _recall(title: str, kinds: Sequence[str], asked: Sequence[Outcome], left_out: Sequence[Excluded]) -> str:
    lines = [
        "", f"## {title}", "",
        "Name / name or numbers / repaired, of cases (and how many more were left out for having no effect).", "",
        "| mistake | exact | lumped | with twin |", "|---|---|---|---|",
    ]  # fmt: skip
    for kind in kinds:
        cells = []
        for mode in ASKED:
            cases = [c for c in asked if c.kind == kind and c.mode == mode]
            none = sum(c.possible for c in left_out if c.kind == kind and c.mode == mode)
            cells.append(f"{_three(cases, ' / ')} of {len(cases)} ({none})")
        lines.append(f"| `{kind}` | {' | '.join(cells)} |")
    return "\n".join(lines)


def _others(title: str, says: str, kinds: Sequence[str], asked: Sequence[Outcome]) -> str:
    lines = [
        "", f"## {title}", "",
        f"{says}: not sound / a cause named, of cases.", "",
        "| mistake | exact | lumped | with twin | named instead |", "|---|---|---|---|---|",
    ]  # fmt: skip
    for kind in kinds:
        cells = []
        for mode in ASKED:
            cases = [c for c in asked if c.kind == kind and c.mode == mode]
            unsound, named = _share(not c.sound for c in cases), _share(c.cause is not None for c in cases)
            cells.append(f"{_percent(unsound)} / {_percent(named)} of {len(cases)}")
        instead = Counter(c.cause for c in asked if c.kind == kind and c.mode in ASKED and c.cause)
        cells.append(", ".join(f"`{cause}` {n}" for cause, n in instead.most_common()))
        lines.append(f"| `{kind}` | {' | '.join(cells)} |")
    return "\n".join(lines)


def _confusions(asked: Sequence[Outcome]) -> str:
    lines = [
        "", "## Named instead", "",
        "Another cause, and undoing it does not give the true numbers.", "",
        "| mistake | named | exact | lumped | with twin |", "|---|---|---|---|---|",
    ]  # fmt: skip
    wrong = Counter((c.kind, c.cause, c.mode) for c in asked if c.mode in ASKED and c.cause and not c.right)
    pairs = Counter[tuple[str, str]]()
    for (mistake, cause, _), n in wrong.items():
        pairs[mistake, cause] += n
    for (mistake, cause), _ in pairs.most_common(LISTED):
        numbers = " | ".join(str(wrong[mistake, cause, mode]) for mode in ASKED)
        lines.append(f"| `{mistake}` | `{cause}` | {numbers} |")
    lines += ["", "Not named: nothing found (sound) / found, no cause certain.", ""]
    lines += ["| mistake | exact | lumped | with twin |", "|---|---|---|---|"]
    for kind in dict.fromkeys(c.kind for c in asked if c.kind != CLEAN):
        cells = []
        for mode in ASKED:
            cases = [c for c in asked if c.kind == kind and c.mode == mode and not c.cause]
            cells.append(f"{sum(c.sound for c in cases)} / {sum(not c.sound for c in cases)}")
        if any(cell != "0 / 0" for cell in cells):
            lines.append(f"| `{kind}` | {' | '.join(cells)} |")
    return "\n".join(lines)


def _blamed(asked: Sequence[Outcome]) -> str:
    """A true part beside a twin whose numbers are wrong."""
    accused = Counter(c.kind for c in asked if c.accused)
    of = Counter(c.kind for c in asked)
    kinds = ", ".join(f"`{kind}` {n} of {of[kind]}" for kind, n in accused.most_common())
    share = _share(c.accused for c in asked)
    return (
        "\n## A true part beside a wrong twin\n\n"
        f"Of {len(asked)} true lumped parts whose twin has a mistake, {sum(accused.values())} ({_percent(share)}) are "
        f"said to be the wrong one{': ' + kinds if kinds else ''}."
    )


def _three(cases: Sequence[Outcome], between: str) -> str:
    """By name, by name or numbers, and repaired."""
    shares = _share(c.strict for c in cases), _right(cases), _share(c.repaired for c in cases)
    return between.join(_percent(share) for share in shares)


def _right(cases: Sequence[Outcome]) -> float:
    return _share(c.right for c in cases)


def _share(values: Iterable[bool]) -> float:
    counted = list(values)
    return sum(counted) / len(counted) if counted else float("nan")


def _percent(share: float) -> str:
    return "–" if share != share else f"{100 * share:.1f} %"


def _against(share: float, target: float | None) -> str:
    if target is None:
        return ""
    return f">= {100 * target:.0f} %" + ("" if share >= target else " MISSED")
