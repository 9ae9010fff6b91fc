"""Edits that change nothing of published robots: ``python benchmarks/accuracy/harmless.py [--count 60]``.

The robots are those of the folders that ``URDFCHECK_CORPUS`` names. After an edit nothing is reported at warning or above about a
link or joint of which no rule of that family reported anything before.
"""

from __future__ import annotations

import os

os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

# What the tests do to the project's own robots.
sys.path.append(str(Path(__file__).resolve().parents[2] / "tests"))

import numpy as np
from real.changes import read_robot
from real.harmless_edits import EDITS, RENAMED, build_plain_robot, write_robot
from real.robots import RealRobot, check_robot, list_robots

import urdfcheck
from urdfcheck.core import Run, Severity


@dataclass(frozen=True, slots=True)
class Trial:
    """An edit of a robot, and what is new after it."""

    robot: str
    edit: str
    is_made: bool
    """Whether it can be made in this robot."""
    new: tuple[str, ...] = ()


def main() -> None:
    """Make the edits, and print what is new after each."""
    parser = argparse.ArgumentParser(
        prog="python benchmarks/accuracy/harmless.py", description=__doc__.partition(":")[0]
    )
    parser.add_argument("--seed", type=int, default=1, help="of the choice of robots and of the edits")
    parser.add_argument("--count", type=int, default=60, help="how many robots")
    parser.add_argument(
        "--edits", default="", help="only edits whose name contains one of these words, separated by commas"
    )
    parser.add_argument("--robots", default="", help="only robots whose name contains this")
    parser.add_argument("--limit", type=float, default=600.0, help="begin no further robot after so many seconds")
    options = parser.parse_args()
    robots = [robot for robot in list_robots() if robot.expands and options.robots in robot.name]
    if not robots:
        parser.error("URDFCHECK_CORPUS names no folder with a corpus.json that has such robots")
    words = [word for word in options.edits.split(",") if word]
    edits = [name for name in EDITS if not words or any(word in name for word in words)]
    order = np.random.default_rng(options.seed).permutation(len(robots))[: options.count]
    end = time.monotonic() + options.limit
    trials: list[Trial] = []
    for index in order:
        if time.monotonic() < end:
            trials += try_edits(robots[index], edits, (options.seed, int(index)))
    print(
        f"urdfcheck {urdfcheck.__version__}, {datetime.now(timezone.utc):%Y-%m-%d}, seed {options.seed}: "
        f"{len({trial.robot for trial in trials})} of {len(robots)} robots.\n"
    )
    print(build_table(trials))


def try_edits(robot: RealRobot, edits: Iterable[str], seed: tuple[int, int]) -> list[Trial]:
    """Make each edit in the expanded text of a robot, beside its file, and compare what is reported with that before."""
    read = read_robot(robot)
    if read is None or read.source.root is None or not read.model.links:
        return []
    plain = build_plain_robot(read.source.root)
    # The text is given, nothing is written: the file need not exist.
    file = replace(robot, entry=robot.entry.with_name("as_edited.urdf"), arguments={})
    before = check_robot(file, {file.entry: write_robot(plain)})
    if before.failures or not before.models or before.models[0].status != "checked":
        return []
    said, trials = {(code[:3], element) for code, _, element in list_subjects(before)}, []
    # A file-wide finding may be at another of its places: then there are not more of them.
    known = Counter((code, message) for code, message, _ in list_subjects(before))
    for name in edits:
        edit, may_say = EDITS[name]
        rng = np.random.default_rng((*seed, *name.encode()))
        edited = edit(plain, rng)
        if edited is None:
            trials.append(Trial(robot.name, name, is_made=False))
            continue
        after = check_robot(file, {file.entry: write_robot(edited)})
        subjects = list_subjects(after)
        total = Counter((code, message) for code, message, _ in subjects)
        counts = Counter(
            (code, message)
            for code, message, element in subjects
            if (code[:3], element) not in said
            and total[code, message] > known[code, message]
            and not code.startswith(may_say)
        )
        new = [
            f"{code} {message} ({n}): {_describe(after, code, message)}"
            for (code, message), n in sorted(counts.items())
        ]
        new += [f"not checked any more: {after.failures or after.models}"] if _is_lost(after) else []
        trials.append(Trial(robot.name, name, is_made=True, new=tuple(new)))
    return trials


def list_subjects(run: Run) -> set[tuple[str, str, str]]:
    """List rule, message and element of what is reported at warning or above; a renamed element has its old name."""
    return {
        (f.code, place.message_ids.get(subject, place.message_id), subject.partition("]")[0].replace(RENAMED, ""))
        for f in run.active_findings
        if f.severity >= Severity.WARNING
        for place in f.list_occurrences()
        for subject in place.subjects
    }


def _is_lost(run: Run) -> bool:
    return bool(run.failures) or not run.models or run.models[0].status != "checked"


def _describe(run: Run, code: str, message: str) -> str:
    return "; ".join(f.headline for f in run.active_findings if (f.code, f.message_id) == (code, message))


def build_table(trials: Iterable[Trial]) -> str:
    """Build a table by edit, and list what is new."""
    trials = list(trials)
    lines = ["| edit | robots | not possible | something new | new findings |", "|---|---|---|---|---|"]
    for name in dict.fromkeys(trial.edit for trial in trials):
        mine = [trial for trial in trials if trial.edit == name]
        made = [trial for trial in mine if trial.is_made]
        some = [trial for trial in made if trial.new]
        lines.append(
            f"| {name} | {len(made)} | {len(mine) - len(made)} | {len(some)} | {sum(len(t.new) for t in some)} |"
        )
    lines.append("")
    lines += [f"* {trial.edit}: {trial.robot}: {text}" for trial in trials for text in trial.new]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
