"""The language server beside another one, from ``benchmarks/language_servers``."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from truth_page.tables import REPOSITORY, render_table

sys.path.append(str(REPOSITORY / "benchmarks" / "language_servers"))

from shown_errors import LABELS, READ, ShownError, read_judged

ANSWERS = REPOSITORY / "benchmarks" / "language_servers" / "answers.json"

__all__ = ["READ", "read_judged"]

STEPS = {
    "open": "opened, to the error",
    "all": "opened, to the end of the check",
    "edit": "a key, to the error or its end",
}
Answers = Mapping[str, Any]


def read_answers() -> Answers:
    """Read what `benchmarks/language_servers` has written."""
    answers: Answers = json.loads(ANSWERS.read_text(encoding="utf-8"))
    return answers


def count_robots_with_error(answers: Answers, server: str, format_: str = "") -> int:
    """Count the published robots, or those of one format, in which a server shows an error."""
    return sum(bool(row[server]) for row in answers["published"] if format_ in ("", row["format"]))


def count_outcomes(answers: Answers, server: str, letter: str, operator: str = "") -> int:
    """Count the planted files of an operator, or all of them, that a server has found (f), located (l) or named (n)."""
    return sum(letter in row[server] for row in answers["planted"] if operator in ("", row["operator"]))


def render_published(answers: Answers, judged: Sequence[ShownError]) -> str:
    """Return what each server shows as an error in published robots, and what was said of those errors that were read."""
    formats = sorted({row["format"] for row in answers["published"]})
    rows = []
    for server, version in answers["servers"].items():
        labels = Counter(error.label for error in judged if error.server == server)
        shown = sum(sum(row[server].values()) for row in answers["published"])
        robots = [count_robots_with_error(answers, server, one) for one in ("", *formats)]
        rows.append((f"{server} {version}", *robots, shown, labels.total(), *(labels[label] for label in LABELS)))
    head = [
        f"{title}, of {len([row for row in answers['published'] if one in ('', row['format'])])}"
        for one, title in (("", "robots with an error"), *((one, f"as {one}") for one in formats))
    ]
    return render_table(("server", *head, "errors", "read", *LABELS.values()), rows)


def render_planted(answers: Answers) -> str:
    """Return how many planted files of each operator a server located, and of all how many it found and named."""
    servers = list(answers["servers"])
    counts = Counter(row["operator"] for row in answers["planted"])
    rows: list[tuple[object, ...]] = [
        (operator, counts[operator], *(count_outcomes(answers, server, "l", operator) for server in servers))
        for operator in sorted(counts)
    ]
    for letter, word in zip("fln", ("found", "located", "named"), strict=True):
        rows.append((f"all, {word}", counts.total(), *(count_outcomes(answers, server, letter) for server in servers)))
    return render_table(("operator", "files", *servers), rows)


def render_latency(answers: Answers) -> str:
    """Return the median times of both servers, and how many times as long the first takes."""
    own, other = answers["servers"]
    rows = []
    for row in answers["latency"]:
        times = [row[server][kind] for kind in ("wall", "processor") for server in (own, other)]
        ratio = _render_ratio(times[0] / times[1])
        name = f"{row['robot'].rpartition(':')[2]} ({row['links']} links)"
        rows.append(
            (name, STEPS[row["step"]], f"{times[0]:.2f} s", f"{times[1]:.3f} s", ratio, *map(_render_used, times[2:]))
        )
    head = ("robot", "step", own, other, "ratio", f"processor, {own}", f"processor, {other}")
    return render_table(head, rows, text_columns=2)


def _render_used(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 0.01 else "below 0.01 s"


def _render_ratio(ratio: float) -> str:
    return f"{ratio:,.0f} ×" if ratio >= 10 else f"{ratio:.2g} ×"
