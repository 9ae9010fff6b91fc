"""What judges said about findings, by round and by rule, from ``benchmarks/accuracy/judged/judge*.tsv``."""

from __future__ import annotations

import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from truth_page.tables import REPOSITORY, render_share, render_table

sys.path.append(str(REPOSITORY / "benchmarks" / "accuracy"))

from judged import BAR, MOST_WRONG, ROUNDS, Label, read_round

from urdfcheck.rules import load_rules

# The fewest labels of a rule for which its share says anything.
FEWEST = 8
WRONG = ("F", "M")


@dataclass(frozen=True, slots=True, kw_only=True)
class Round:
    """A round of judging."""

    number: int
    day: str
    build: str
    labels: Sequence[Label]
    drawn: int
    """How many of the first labels were drawn at random; all of them, if the file does not say otherwise."""

    @property
    def drawn_labels(self) -> Sequence[Label]:
        """The labels that say what to expect on another robot: the others were picked."""
        return self.labels[: self.drawn]


def read_rounds() -> list[Round]:
    """Read all rounds of fresh robots, the first one first."""
    rounds = []
    for path in ROUNDS.glob("judge*.tsv"):
        text = path.read_text(encoding="utf-8")
        build = re.search(r"^# build (\w+), (\d{4}-\d\d-\d\d)", text, re.MULTILINE)
        if build is None:
            raise ValueError(f"{path.name} does not say which build was judged, and when")
        line = text[build.start() :].partition("\n")[0]
        drawn = re.search(r"(?:rows 1-|the first )(\d+)(?: rows)? drawn", line)
        labels = read_round(path)
        number = int(path.stem.removeprefix("judge"))
        rounds.append(
            Round(number=number, day=build[2], build=build[1], labels=labels,
                  drawn=int(drawn[1]) if drawn else len(labels))
        )  # fmt: skip
    return sorted(rounds, key=lambda one: one.number)


def read_first_build() -> list[Label]:
    """Read what the judges of round 15 said about the first build that was ever judged."""
    return read_round(ROUNDS / "first_build.tsv")


def count_useful(labels: Iterable[Label]) -> tuple[int, int]:
    """Return how many are true and useful, and how many could be decided."""
    counts = Counter(label.label for label in labels)
    return counts["TU"], counts.total() - counts["?"]


def count_wrong(labels: Sequence[Label]) -> tuple[int, int]:
    """Return how many are false or misleading, and how many were judged."""
    return sum(label.label in WRONG for label in labels), len(labels)


def list_of(labels: Iterable[Label], severity: str) -> list[Label]:
    """Return the labels of one severity."""
    return [label for label in labels if label.severity == severity]


def render_rounds(rounds: Sequence[Round]) -> str:
    """Return one table for each severity, and one of what is false or misleading."""
    head = (
        *("round", "date", "build", "judged", "useful", "pedantic", "false", "misleading", "open"),
        *("useful of the decided", "of those drawn"),
    )
    parts = []
    for severity, bar in BAR.items():
        rows = []
        for one in rounds:
            labels = list_of(one.labels, str(severity))
            counts = Counter(label.label for label in labels)
            drawn = list_of(one.drawn_labels, str(severity))
            share = render_share(*count_useful(drawn)) if one.drawn < len(one.labels) else ""
            kinds = [counts[key] for key in ("TU", "TP", "F", "M", "?")]
            rows.append(
                (one.number, one.day, one.build, len(labels), *kinds, render_share(*count_useful(labels)), share)
            )
        reached = _describe_reached(rounds, str(severity), bar)
        parts.append(
            f"### {str(severity).capitalize()}s\n\nThe bar is {100 * bar:.0f} % useful; it was reached in {reached}.\n\n"
            + render_table(head, rows, text_columns=3)
        )
    rows = [
        (
            one.number,
            render_share(*count_wrong(one.labels)),
            render_share(*count_wrong(one.drawn_labels)) if one.drawn < len(one.labels) else "",
        )
        for one in rounds
    ]
    title = f"### False or misleading, of all that was judged\n\nThe bar is {100 * MOST_WRONG:.1f} %.\n\n"
    return "\n\n".join([*parts, title + render_table(("round", "false or misleading", "of those drawn"), rows)])


def render_bars(rounds: Sequence[Round]) -> str:
    """Return a table of the project's own bars, what the newest round gave, and how many rounds reached each, by drawn labels."""
    newest = rounds[-1].drawn_labels
    rows = [
        (
            f"{severity}s that are useful",
            f"at least {100 * bar:.0f} %",
            render_share(*count_useful(list_of(newest, str(severity)))),
            _describe_reached(rounds, str(severity), bar),
        )
        for severity, bar in BAR.items()
    ]
    few = sum(wrong <= MOST_WRONG * judged for wrong, judged in (count_wrong(one.drawn_labels) for one in rounds))
    most = f"at most {100 * MOST_WRONG:.1f} %"
    rows.append(("false or misleading", most, render_share(*count_wrong(newest)), _describe_count(few, len(rounds))))
    return render_table(("judged findings", "bar", f"round {rounds[-1].number}", "reached in"), rows, text_columns=4)


def render_yardstick(newest: Round, first: Sequence[Label]) -> str:
    """Return a table of what the judges of one round say about its build and about the first one."""
    both = newest.drawn_labels, first
    rows = [
        (f"{severity}s that are useful", *(render_share(*count_useful(list_of(some, str(severity)))) for some in both))
        for severity in BAR
    ]
    rows.append(("false or misleading", *(render_share(*count_wrong(some)) for some in both)))
    rows.append(
        ("of all, harmful", *(render_share(sum(one.bad == "harm" for one in some), len(some)) for some in both))
    )
    return render_table(
        ("the same judges", f"build {newest.build}", "build 1a5b6dc5, 2026-11-22"), rows, text_columns=1
    )


def render_rules(rounds: Sequence[Round]) -> str:
    """Return a table of the rules with enough labels, those with the least useful share first."""
    by_code: dict[str, list[Label]] = defaultdict(list)
    for one in rounds:
        for label in one.labels:
            by_code[label.code].append(label)
    rows = []
    for code, labels in by_code.items():
        if len(labels) < FEWEST:
            continue
        counts = Counter(label.label for label in labels)
        useful, decided = count_useful(labels)
        last = max(one.number for one in rounds if any(label.code == code for label in one.labels))
        row = (
            _link_rule(code),
            len(labels),
            counts["TU"],
            counts["TP"],
            counts["F"],
            counts["M"],
            render_share(useful, decided),
            last,
        )
        rows.append((useful / decided if decided else 0.0, row))
    head = ("rule", "judged", "useful", "pedantic", "false", "misleading", "useful of the decided", "last in round")
    return render_table(head, [row for _, row in sorted(rows)])


def _link_rule(code: str) -> str:
    rule = load_rules().get(code)
    return code if rule is None else f"[{code}](../rules/{code}-{rule.name}.md)"


def _describe_reached(rounds: Sequence[Round], severity: str, bar: float) -> str:
    reached = 0
    for one in rounds:
        useful, decided = count_useful(list_of(one.drawn_labels, severity))
        reached += decided > 0 and useful >= bar * decided
    return _describe_count(reached, len(rounds))


def _describe_count(reached: int, rounds: int) -> str:
    return f"{reached or 'none'} of {rounds} rounds"
