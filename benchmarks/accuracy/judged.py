"""What became of findings that people judged: ``python benchmarks/accuracy/judged.py [--round truth] [--list]``.

Each round of judging is a file in ``judged/`` (its README says what the columns mean). The robots are those of the folders that
``URDFCHECK_CORPUS`` names. A label holds for the finding of the same rule at the same place; where the finding now says
something else, it needs a new label.
"""

from __future__ import annotations

import argparse
import csv
import io
import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from real.robots import RealRobot, check_robot, list_robots
from real.verdicts import list_texts

import urdfcheck
from urdfcheck.core import Finding, Run, Severity

ROUNDS = Path(__file__).parent / "judged"
COLUMNS = ("robot", "place", "code", "message", "severity", "label", "bad", "sure", "says", "reason")
# Columns that a round may lack.
OPTIONAL = {"says", "bad"}
LABELS = {"TU": "true and useful", "TP": "true, pedantic", "F": "false", "M": "misleading", "?": "can't tell"}
SURE = ("recomputed", "read", "judged")
BAD = ("harm", "slip")
NONE = "-"
# What a finding that was judged is now.
KEPT, CHANGED, GONE, UNKNOWN = "as judged", "says something else", "not reported", "robot not at hand"
# Least precision of what is reported (true and useful), and most that may be false or misleading.
BAR = {Severity.ERROR: 0.97, Severity.WARNING: 0.85, Severity.INFO: 0.80}
MOST_WRONG = 0.015


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """What a person says about a finding; the columns of a round."""

    robot: str
    """Id of the robot in its ``corpus.json``, or ``owner/repository``."""
    file: str | None
    """Relative to the folder of the repository."""
    line: int | None
    code: str
    message: str | None
    """Id of the message; None where it was not written down."""
    severity: str
    """That it had when it was judged."""
    label: str
    """A key of `LABELS`."""
    bad: str | None
    """Of a false or misleading finding, one of `BAD`; None where nobody said."""
    sure: str
    """One of `SURE`."""
    says: str | None
    """The words of headline, message, cause or repair that are wrong."""
    reason: str


@dataclass(frozen=True, slots=True)
class Model:
    """A model of a published repository: the file, relative to the repository, and the values of its xacro arguments."""

    repository: str
    commit: str
    entry: str
    arguments: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Outcome:
    """A label and what the finding is now: its state, and the finding unless it is gone."""

    label: Label
    state: str
    finding: Finding | None


def main() -> None:
    """Print what became of the findings, by severity and by rule."""
    parser = argparse.ArgumentParser(prog="python benchmarks/accuracy/judged.py", description=__doc__.partition(":")[0])
    parser.add_argument("--round", action="append", help="name of a round; by default all")
    parser.add_argument(
        "--list", action="store_true", help="list what is false, misleading, changed or no longer reported"
    )
    options = parser.parse_args()
    names = options.round or [path.stem for path in sorted(ROUNDS.glob("*.tsv"))]
    try:
        labels = [label for name in names for label in read_round(ROUNDS / f"{name}.tsv")]
    except (OSError, ValueError) as error:
        parser.error(str(error))
    robots = list_robots()
    for name in names:
        robots += find_models(read_models(ROUNDS / f"{name}.tsv"), robots)
    outcomes = find_outcomes(labels, robots)
    print(f"urdfcheck {urdfcheck.__version__}: {len(labels)} labels of {', '.join(names)}.")
    print(build_tables(outcomes))
    if options.list:
        print("\n".join(describe_outcomes(outcomes)))


def read_round(path: Path) -> list[Label]:
    """Read the labels of a round.

    :raises ValueError: if a line does not follow the format.
    :raises OSError: if the file cannot be read.
    """
    lines = [
        line for line in path.read_text(encoding="utf-8").splitlines() if line.strip() and not line.startswith("#")
    ]
    reader = csv.DictReader(io.StringIO("\n".join(lines)), delimiter="\t", quoting=csv.QUOTE_NONE)
    header = tuple(reader.fieldnames or ())
    if set(header) - set(COLUMNS) or set(COLUMNS) - set(header) - OPTIONAL:
        raise ValueError(f"{path.name}: the columns are {', '.join(header)}, not {', '.join(COLUMNS)}")
    return [_read_label(path.name, number, row) for number, row in enumerate(reader, 1)]


def read_models(path: Path) -> dict[str, Model]:
    """Read the models of a round that are in no corpus, by robot: ``# repo owner/repository commit SHA ENTRY [arg:=value …]``.

    :raises OSError: if the file cannot be read.
    """
    models = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        found = re.fullmatch(r"# repo (\S+) commit ([0-9a-f]+) (.+?)((?: \w+:=\S*)*)", line.strip())
        if found is not None:
            repository, commit, entry, words = found.groups()
            arguments = dict(word.split(":=", 1) for word in words.split())
            # A label names one of several models by its file, with or without folder or ending.
            for name in dict.fromkeys((Path(entry).name.partition(".")[0], Path(entry).name, entry)):
                models[f"{repository}:{name}"] = Model(repository, commit, entry, arguments)
    return models


def find_models(models: Mapping[str, Model], robots: Iterable[RealRobot]) -> list[RealRobot]:
    """Find models in the repositories at hand."""
    folders = {robot.name: robot.entry for robot in robots if robot.entry.is_dir()}
    return [
        RealRobot(
            name=name,
            entry=folders[model.repository] / model.entry,
            arguments=model.arguments,
            package_roots=(folders[model.repository],),
        )
        for name, model in models.items()
        if model.repository in folders
    ]


def _read_label(name: str, number: int, row: Mapping[str, str | None]) -> Label:
    cells = {column: (row.get(column) or NONE).strip() for column in COLUMNS}
    where = f"{name}, label {number}"
    if None in row.values() or None in row:
        raise ValueError(f"{where}: not as many cells as columns")
    if cells["label"] not in LABELS:
        raise ValueError(f"{where}: no label: {cells['label']}")
    if cells["sure"] not in SURE:
        raise ValueError(f"{where}: {cells['sure']} is none of {', '.join(SURE)}")
    if cells["bad"] not in (*BAD, NONE):
        raise ValueError(f"{where}: {cells['bad']} is none of {', '.join(BAD)}")
    if not re.fullmatch(r"[A-Z]{3}\d{3}", cells["code"]):
        raise ValueError(f"{where}: {cells['code']} is not the code of a rule")
    if cells["severity"] not in {str(severity) for severity in Severity}:
        raise ValueError(f"{where}: {cells['severity']} is not a severity")
    if cells["place"].startswith(("/", "~", "..")):
        raise ValueError(f"{where}: {cells['place']} is not relative to the repository")
    file, _, line = cells["place"].rpartition(":")
    if not line.isdigit():
        file, line = cells["place"], ""
    return Label(
        robot=cells["robot"],
        file=None if file == NONE else file,
        line=int(line) if line else None,
        code=cells["code"],
        message=None if cells["message"] == NONE else cells["message"],
        severity=cells["severity"],
        label=cells["label"],
        bad=None if cells["bad"] == NONE else cells["bad"],
        sure=cells["sure"],
        says=None if cells["says"] == NONE else cells["says"],
        reason=cells["reason"],
    )


def find_outcomes(labels: Iterable[Label], robots: Sequence[RealRobot]) -> list[Outcome]:
    """Find what the labelled findings are now. A robot without labels is not checked."""
    by_robot: dict[str, list[Label]] = {}
    for label in labels:
        by_robot.setdefault(label.robot, []).append(label)
    known = {robot.name: robot for robot in robots}
    outcomes = []
    for name, some in by_robot.items():
        robot = known.get(name)
        if robot is None:
            outcomes += [Outcome(label, UNKNOWN, None) for label in some]
        else:
            outcomes += match_labels(some, check_robot(robot))
    return outcomes


def match_labels(labels: Iterable[Label], run: Run) -> Iterator[Outcome]:
    """Yield what the labelled findings are in a run."""
    told = [(finding, place) for finding in run.active_findings for place in finding.list_occurrences()]
    for label in labels:
        here = [
            (finding, place) for finding, place in told if finding.code == label.code and _is_at(label, finding, place)
        ]
        same = [pair for pair in here if label.message in (None, pair[0].message_id, pair[1].message_id)]
        if not here:
            yield Outcome(label, GONE, None)
            continue
        finding, place = (same or here)[0]
        says = label.says is None or any(label.says in text for text in _list_texts(finding, place))
        yield Outcome(label, KEPT if same and says else CHANGED, finding)


def _is_at(label: Label, finding: Finding, place: Finding) -> bool:
    """Whether a finding, or its occurrence ``place``, is where the label says: its own place, or a call that leads there."""
    if label.file is None:
        return True
    spans = [place.location.span, *place.location.via, *(r.span for r in place.related)]
    if label.line is None:
        spans.append(finding.location.span)
    # A run names files from the working directory, a label from the repository.
    end = f"/{label.file}"
    return any(span is not None and f"/{span.file}".endswith(end) and label.line in (None, span.line) for span in spans)


def _list_texts(*findings: Finding) -> Iterator[str]:
    for finding in findings:
        yield from list_texts(finding)
        if finding.fix is not None:
            yield from (edit.replacement for edit in finding.fix.edits)


def build_tables(outcomes: Sequence[Outcome]) -> str:
    """Build the tables: precision by the severity that a finding has now, and by rule then and now."""
    states = Counter(outcome.state for outcome in outcomes)
    lines = ["", ", ".join(f"{state}: {states[state]}" for state in (KEPT, CHANGED, GONE, UNKNOWN)) + "."]
    lines += ["", "| reported now as | labelled | " + " | ".join(LABELS) + " | true and useful | false or misleading |"]
    lines += ["|---|---|" + "---|" * (len(LABELS) + 2)]
    kept = [outcome for outcome in outcomes if outcome.state == KEPT]
    for severity in reversed(Severity):
        some = [o for o in kept if o.finding is not None and o.finding.severity == severity]
        useful, wrong = _rate([o.label for o in some])
        bar = (
            "" if useful is None else f"{useful:.0%} ({'>=' if useful >= BAR[severity] else '< '} {BAR[severity]:.0%})"
        )
        most = "" if wrong is None else f"{wrong:.1%} ({'<=' if wrong <= MOST_WRONG else '> '} {MOST_WRONG:.1%})"
        counts = Counter(o.label.label for o in some)
        lines.append(f"| {severity} | {len(some)} | {' | '.join(str(counts[x]) for x in LABELS)} | {bar} | {most} |")
    lines += [
        "",
        "| rule | judged | useful then | kept | useful now | changed | gone: useful | gone: pedantic | gone: wrong |",
    ]
    lines += ["|---|---|---|---|---|---|---|---|---|"]
    at_hand = [outcome for outcome in outcomes if outcome.state != UNKNOWN]
    for code in sorted({outcome.label.code for outcome in at_hand}):
        some = [outcome for outcome in at_hand if outcome.label.code == code]
        now = [outcome.label for outcome in some if outcome.state == KEPT]
        gone = Counter(outcome.label.label for outcome in some if outcome.state == GONE)
        changed = sum(outcome.state == CHANGED for outcome in some)
        then, still = (_rate(labels)[0] for labels in ([outcome.label for outcome in some], now))
        shares = ["–" if share is None else f"{share:.0%}" for share in (then, still)]
        lines.append(
            f"| {code} | {len(some)} | {shares[0]} | {len(now)} | {shares[1]} | {changed} "
            f"| {gone['TU']} | {gone['TP']} | {gone['F'] + gone['M']} |"
        )
    return "\n".join(lines)


def _rate(labels: Sequence[Label]) -> tuple[float | None, float | None]:
    """Share that is true and useful, and share that is false or misleading, of what could be told."""
    counts = Counter(label.label for label in labels)
    told = sum(counts.values()) - counts["?"]
    return (counts["TU"] / told, (counts["F"] + counts["M"]) / told) if told else (None, None)


def describe_outcomes(outcomes: Iterable[Outcome]) -> Iterator[str]:
    """Yield a line for each finding that is still wrong, says something else, or was useful and is gone."""
    for outcome in outcomes:
        label = outcome.label
        wrong = label.label in ("F", "M") and outcome.state == KEPT
        lost = label.label == "TU" and outcome.state == GONE
        if wrong or lost or outcome.state == CHANGED:
            place = f"{label.file}:{label.line}" if label.line else label.file or ""
            yield f"* {label.label}, {outcome.state}: {label.robot} {place} {label.code} {label.message or ''}: {label.reason}"
            if outcome.finding is not None:
                yield f"    now ({outcome.finding.severity}): {outcome.finding.headline}"


if __name__ == "__main__":
    sys.exit(main())
