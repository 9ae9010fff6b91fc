"""Is what urdfcheck says of real robots true? ``python benchmarks/accuracy/corpus.py [--seed 1] [--count 120] [--unlabelled]``.

Needs ``URDFCHECK_CORPUS``, a folder of robots with a ``corpus.json``. All warnings and errors of the rules about inertia and
symmetry are listed, some of them drawn at random, and what ``labels.tsv`` says of these is counted. A label was given by hand:
``true``, ``false`` or ``can't tell``, with the reason. It holds for the finding that was read; one that says something else
(another message or cause) has none.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import urdfcheck
from urdfcheck.core import NEWLINE, Finding, Run, Severity
from urdfcheck.rules import load_rules

LABELS = Path(__file__).parent / "labels.tsv"
FAMILIES = ("INR", "SYM")
VERDICTS = ("true", "false", "can't tell")
# Lines before and after the one that a finding stands at: the rest of the inertial.
AROUND = 2
COLUMNS = ("drawn", *VERDICTS, "no label")

# Entry of the corpus, code, message (and cause, where one is named), subject.
Key = tuple[str, str, str, str]


@dataclass(frozen=True, slots=True)
class Claim:
    """A finding of one robot; ``lines`` are the source text round the place where it stands."""

    robot: str
    finding: Finding
    lines: tuple[str, ...]

    @property
    def key(self) -> Key:
        f = self.finding
        return self.robot, f.code, _kind(f), f.location.subject


@dataclass(frozen=True, slots=True)
class Label:
    """What a person found."""

    verdict: str
    reason: str


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python benchmarks/accuracy/corpus.py", description=__doc__.splitlines()[0].partition("?")[0] + "?"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--count", type=int, default=120, help="how many findings are drawn")
    parser.add_argument("--unlabelled", action="store_true", help="print what was drawn and has no label in full")
    options = parser.parse_args()
    folder = os.environ.get("URDFCHECK_CORPUS")
    if not folder or not (Path(folder) / "corpus.json").is_file():
        parser.error("URDFCHECK_CORPUS names no folder with a corpus.json")
    found = list(claims(Path(folder)))
    distinct = _distinct(found)
    drawn = draw(distinct, options.seed, options.count)
    labels = _labels()
    print(
        f"urdfcheck {urdfcheck.__version__}: {len(found)} findings at warning or above, {len(distinct)} of them distinct; "
        f"{len(drawn)} drawn with seed {options.seed}.\n\n{_table(drawn, labels)}"
    )
    for claim in drawn:
        label = labels.get(claim.key)
        if label is not None and label.verdict != "true":
            print(f"\n* {label.verdict}: {', '.join(claim.key)}: {label.reason}")
    missing = [c for c in drawn if c.key not in labels]
    if missing:
        print(f"\nWithout a label: {len(missing)}" + ("." if options.unlabelled else " (--unlabelled prints them)."))
    if options.unlabelled:
        print("\n".join(map(_described, missing)))


def claims(corpus: Path) -> Iterator[Claim]:
    """All findings of the rules about inertia and symmetry, at warning or above, in the order of the corpus."""
    rules = load_rules()
    judged = {code for code in rules if code.startswith(FAMILIES)}
    codes = judged.union(*(rules[code].hidden_by for code in judged))
    for entry in json.loads((corpus / "corpus.json").read_text(encoding="utf-8")):
        outcome = urdfcheck.check(
            corpus / entry["entry"],
            select=codes,
            arguments=entry["xacro_args"],
            package_paths=[corpus / root for root in entry["package_roots"]],
            isolated=True,
        )
        for finding in outcome.findings:
            if finding.code in judged and finding.severity >= Severity.WARNING:
                yield Claim(entry["id"], finding, _lines(outcome, finding))


def draw(distinct: Iterable[Claim], seed: int, count: int) -> list[Claim]:
    """``count`` claims at random, by turns from each robot's kinds of claims: a robot with many alike does not dominate."""
    rng = random.Random(seed)
    kinds: dict[tuple[str, str, str], list[Claim]] = {}
    for claim in distinct:
        kinds.setdefault(claim.key[:3], []).append(claim)
    piles = list(kinds.values())
    for pile in piles:
        rng.shuffle(pile)
    drawn: list[Claim] = []
    for turn in zip_longest(*piles):
        left = [claim for claim in turn if claim is not None]
        rng.shuffle(left)
        drawn += left
    return drawn[:count]


def _distinct(found: Iterable[Claim]) -> list[Claim]:
    """Robots of one family share parts: what is said of the same lines about the same link counts once, for the first robot."""
    first: dict[tuple[object, ...], Claim] = {}
    for claim in found:
        first.setdefault((claim.key[1:], claim.lines), claim)
    return list(first.values())


def _lines(outcome: Run, finding: Finding) -> tuple[str, ...]:
    span = finding.location.span
    if span is None:
        return ()
    return tuple(NEWLINE.split(outcome.sources[span.file])[max(0, span.line - 1 - AROUND) : span.line + AROUND])


def _kind(finding: Finding) -> str:
    return finding.message_id if finding.cause is None else f"{finding.message_id}: {finding.cause.id}"


def _labels() -> dict[Key, Label]:
    """By key.

    :raises ValueError: for a verdict that is none.
    """
    with LABELS.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))
    if wrong := {row["verdict"] for row in rows} - set(VERDICTS):
        raise ValueError(f"{LABELS.name}: no verdict: {', '.join(sorted(wrong))}")
    return {
        (row["robot"], row["code"], row["claim"], row["subject"]): Label(row["verdict"], row["reason"]) for row in rows
    }


def _table(drawn: Iterable[Claim], labels: Mapping[Key, Label]) -> str:
    """For each confidence and each rule."""
    counts: dict[str, Counter[str]] = {}
    for claim in drawn:
        column = labels[claim.key].verdict if claim.key in labels else "no label"
        for row in (str(claim.finding.confidence), claim.finding.code, "all"):
            counts.setdefault(row, Counter()).update(("drawn", column))
    lines = [f"| kind | {' | '.join(COLUMNS)} | precision |", "|---|" + "---|" * (len(COLUMNS) + 1)]
    groups = [row for row in ("proof", "strong", "heuristic") if row in counts]
    for row in (*groups, *sorted(row for row in counts if row.startswith(FAMILIES)), "all"):
        numbers = counts.get(row, Counter())
        decided = numbers["true"] + numbers["false"]
        precision = f"{100 * numbers['true'] / decided:.1f} %" if decided else "–"
        lines.append(f"| {row} | {' | '.join(str(numbers[column]) for column in COLUMNS)} | {precision} |")
    return "\n".join(lines)


def _described(claim: Claim) -> str:
    f = claim.finding
    place = "" if f.location.span is None else f"{f.location.span.file}:{f.location.span.line}"
    lines = ["", "\t".join(claim.key), f"  {place} ({f.severity}, {f.confidence})", f"  {f.message}"]
    lines += [f"  cause: {f.cause.text}"] if f.cause else []
    lines += [f"  fix: {f.fix.title}"] if f.fix else []
    return "\n".join(lines)


if __name__ == "__main__":
    main()
