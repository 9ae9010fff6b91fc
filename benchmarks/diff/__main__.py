"""What ``urdfcheck diff`` says about commits of published robots: ``python benchmarks/diff COMMITS CLONES RESULTS``.

``COMMITS`` has a line for each commit: ``owner/name`` and the id, apart by a tab. ``CLONES`` holds a clone of each repository, as
``owner+name``. Texts, JSON documents and ``table.tsv`` are written to ``RESULTS``; a commit that is in the table is not run
again. Prints Markdown tables.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from statistics import median
from typing import Any, get_type_hints

from urdfcheck.core.model_diff import VERDICTS

# An ordinary report is not longer.
MOST_LINES = 10
SIDE = Path(__file__).with_name("one_commit.py")
# How a comparison ended: both versions read, one of them not, or the comparison itself failed.
READ, UNREAD, CRASHED, CUT_OFF = ENDINGS = ("read", "unread", "crashed", "cut off")


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What was said about one commit."""

    repository: str
    commit: str
    ending: str
    """One of `ENDINGS`."""
    verdict: str
    seconds: float
    processor_seconds: float
    """Of all processes of the comparison: other work on the machine does not count."""
    lines: int
    models: int
    """How many were compared."""
    unknown: int
    """How many of them gave no robot in a version."""
    longest: int
    """Most lines about one model."""


def main() -> None:
    """Compare every commit with its parent, and print what came of it."""
    parser = argparse.ArgumentParser(prog="python benchmarks/diff", description=__doc__.partition(":")[0])
    parser.add_argument("commits", type=Path, metavar="COMMITS")
    parser.add_argument("clones", type=Path, metavar="CLONES")
    parser.add_argument("results", type=Path, metavar="RESULTS")
    parser.add_argument(
        "--package-path", type=Path, action="append", default=[], help="folder of packages (repeatable)"
    )
    parser.add_argument(
        "--select", default="", metavar="CODES", help="only these rules: the verdicts do not depend on them"
    )
    parser.add_argument("--timeout", type=float, default=120.0, help="seconds for one commit (default: 120)")
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    table = options.results / "table.tsv"
    known = {(outcome.repository, outcome.commit): outcome for outcome in _read_table(table)}
    wanted = [tuple(line.split("\t")[:2]) for line in options.commits.read_text(encoding="utf-8").splitlines() if line]
    for repository, commit in wanted:
        if (repository, commit) in known:
            continue
        outcome = _compare_commit(options, repository, commit)
        known[repository, commit] = outcome
        _append_row(table, outcome)
        print(*asdict(outcome).values(), sep="\t", file=sys.stderr, flush=True)
    _print_summary([known[repository, commit] for repository, commit in wanted])


def _compare_commit(options: argparse.Namespace, repository: str, commit: str) -> Outcome:
    clone = options.clones / repository.replace("/", "+")
    start, used = time.perf_counter(), _measure_processor_time()
    found, errors = _run(options, clone, commit)
    seconds, used = time.perf_counter() - start, _measure_processor_time() - used
    name = f"{clone.name}@{commit[:10]}"
    (options.results / f"{name}.txt").write_text(found["text"] + errors, encoding="utf-8")
    (options.results / f"{name}.json").write_text(json.dumps(found["document"], indent=1), encoding="utf-8")
    models = found["document"]["models"]
    return Outcome(
        repository=repository,
        commit=commit,
        ending=found["ending"],
        verdict=found["document"]["verdict"],
        seconds=round(seconds, 2),
        processor_seconds=round(used, 2),
        lines=len(found["text"].splitlines()),
        models=len(models),
        unknown=sum(model["verdict"] == "unknown" for model in models),
        longest=max(map(len, _split_models(found["text"])), default=0),
    )


def _run(options: argparse.Namespace, clone: Path, commit: str) -> tuple[dict[str, Any], str]:
    """Return what `one_commit` printed, and its standard error; the cache is one of the benchmark's own."""
    folders = [str(folder.absolute()) for folder in options.package_path]
    command = [sys.executable, str(SIDE), commit[:10], options.select, *folders]
    environment = {**os.environ, "XDG_CACHE_HOME": str((options.results / "cache").absolute())}
    nothing = {"text": "", "document": {"verdict": "none", "models": []}}
    try:
        done = subprocess.run(
            command, cwd=clone, env=environment, capture_output=True, text=True, timeout=options.timeout, check=False
        )
    except subprocess.TimeoutExpired:
        return {**nothing, "ending": CUT_OFF}, f"more than {options.timeout:g} s\n"
    if done.returncode or "Traceback" in done.stderr:
        return {**nothing, "ending": CRASHED}, done.stderr
    found = json.loads(done.stdout)
    return {**found, "ending": UNREAD if found["failed"] else READ}, done.stderr


def _measure_processor_time() -> float:
    """Return the seconds that the processes which this one started, and which ended, have computed."""
    times = os.times()
    return times.children_user + times.children_system


def _split_models(text: str) -> Iterator[list[str]]:
    """Yield the lines about each model: its headline and the indented lines below it."""
    lines: list[str] = []
    for line in text.splitlines():
        if line.startswith("findings: "):
            break
        if lines and not line.startswith(" "):
            yield lines
            lines = []
        lines.append(line)
    if lines:
        yield lines


# -- the table ---------------------------------------------------------------------------------------------------------


def _read_table(path: Path) -> Iterator[Outcome]:
    if not path.exists():
        return
    kinds = get_type_hints(Outcome)
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            yield Outcome(**{name: kinds[name](value) for name, value in row.items()})


def _append_row(path: Path, outcome: Outcome) -> None:
    is_new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Outcome)], delimiter="\t")
        if is_new:
            writer.writeheader()
        writer.writerow(asdict(outcome))


def _print_summary(outcomes: list[Outcome]) -> None:
    verdicts = Counter(outcome.verdict for outcome in outcomes)
    print(f"{len(outcomes)} commits of {len({outcome.repository for outcome in outcomes})} repositories\n")
    print("| verdict | commits |\n|---|---:|")
    for verdict in (*VERDICTS, "none"):
        if verdicts[verdict]:
            print(f"| {verdict} | {verdicts[verdict]} |")
    seconds, lines = ([getattr(outcome, name) for outcome in outcomes] for name in ("processor_seconds", "lines"))
    per_model = [outcome.longest for outcome in outcomes if outcome.models]
    above = sum(count > MOST_LINES for count in lines)
    print("\n| measure | value |\n|---|---:|")
    for ending in ENDINGS:
        print(f"| {ending} | {sum(outcome.ending == ending for outcome in outcomes)} |")
    print(f"| processor seconds, median and most | {median(seconds):.1f}, {max(seconds):.1f} |")
    print(f"| lines, median and most | {median(lines):g}, {max(lines)} |")
    print(f"| reports of more than {MOST_LINES} lines | {above} ({above / len(lines) * 100:.0f} %) |")
    print(f"| lines about the model with most, median | {median(per_model or [0]):g} |")


if __name__ == "__main__":
    main()
