"""Defects made in published robots, found and named: ``python benchmarks/accuracy/injected.py [--count 1500] [--quick]``.

The robots are those of the folders that ``URDFCHECK_CORPUS`` names. Prints Markdown tables; the README says what every number
means.
"""

from __future__ import annotations

import os

# Matrices of three rows: a pool of threads for each of them only takes the other processes' time.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from datetime import datetime, timezone
from functools import partial
from multiprocessing import get_context

from real.inertial_slips import KINDS as INERTIAL
from real.injection import Case, inject
from real.joint_slips import KINDS as OTHERS
from real.robots import RealRobot, list_robots
from real.tables import build_tables, describe_cases

import urdfcheck

KINDS = (*INERTIAL, *OTHERS)
# A quick run takes robots with at most so many links.
QUICK_LINKS = 20


def main() -> None:
    """Make defects, and print what was found."""
    parser = argparse.ArgumentParser(
        prog="python benchmarks/accuracy/injected.py", description=__doc__.partition(":")[0]
    )
    parser.add_argument("--seed", type=int, default=1, help="of the choice of robots, links and values")
    parser.add_argument("--count", type=int, default=1500, help="how many checks of broken robots, about")
    parser.add_argument(
        "--quick", action="store_true", help="a tenth of that, in robots that are quick to check: a minute"
    )
    parser.add_argument(
        "--kinds", default="", help="only kinds whose name contains one of these words, separated by commas"
    )
    parser.add_argument("--robots", default="", help="only robots whose name contains this")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--limit", type=float, default=900.0, help="begin no further robot after so many seconds")
    parser.add_argument("--list", action="store_true", help="list what was not found, not named or named wrongly")
    options = parser.parse_args()
    robots = [robot for robot in list_robots() if robot.expands and options.robots in robot.name]
    if options.quick:
        robots = [robot for robot in robots if robot.links <= QUICK_LINKS]
    if not robots:
        parser.error("URDFCHECK_CORPUS names no folder with a corpus.json that has such robots")
    words = [word for word in options.kinds.split(",") if word]
    kinds = [index for index, kind in enumerate(KINDS) if not words or any(word in kind.name for word in words)]
    cases, checked = run_injections(
        robots, kinds, seed=options.seed, count=options.count // (10 if options.quick else 1), jobs=options.jobs,
        limit=60.0 if options.quick else options.limit,
    )  # fmt: skip
    print(
        f"urdfcheck {urdfcheck.__version__}, {datetime.now(timezone.utc):%Y-%m-%d}, seed {options.seed}: {len(cases)} checks "
        f"of broken robots, made of {checked} of {len(robots)} robots.\n"
    )
    print(build_tables(cases, KINDS))
    if options.list:
        print("\n".join(describe_cases(cases)))


def run_injections(
    robots: Sequence[RealRobot], kinds: Sequence[int], *, seed: int, count: int, jobs: int, limit: float
) -> tuple[list[Case], int]:
    """Make defects in robots; the same ones whatever the number of ``jobs``, unless ``limit`` (s) ends it.

    :param kinds: places in `KINDS`.
    :param count: about how many checks of broken robots.
    :returns: the cases, in the order of the robots, and the number of robots that have any.
    """
    tasks = plan_tasks(robots, kinds, seed, count)
    end = time.monotonic() + limit
    one = partial(_inject_before, end, seed)
    if jobs == 1:
        found = [one(task) for task in tasks]
    else:
        with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
            found = list(pool.map(one, tasks))
    return [case for cases in found for case in cases], sum(bool(cases) for cases in found)


Task = tuple[int, RealRobot, tuple[int, ...], int]


def plan_tasks(robots: Sequence[RealRobot], kinds: Sequence[int], seed: int, count: int) -> list[Task]:
    """Plan what is done: for each robot its number, the kinds in the order in which they are tried, and how many of them.

    Each robot begins at another kind, so that every kind gets about as many cases as another.
    """
    import numpy as np

    rng = np.random.default_rng(seed)
    order = rng.permutation(len(robots))
    # Two checks of most cases, with meshes and without.
    each = max(1, round(count / 1.6 / len(robots)))
    robots_needed = max(1, min(len(robots), round(count / 1.6 / each)))
    mixed = list(rng.permutation(kinds))
    tasks = []
    for turn, index in enumerate(order[:robots_needed]):
        start = (turn * each) % len(mixed)
        tasks.append((int(index), robots[index], tuple(int(k) for k in (*mixed[start:], *mixed[:start])), each))
    return tasks


def _inject_before(end: float, seed: int, task: Task) -> list[Case]:
    number, robot, kinds, each = task
    if time.monotonic() > end:
        return []
    return inject(robot, [KINDS[kind] for kind in kinds], each, (seed, number))


if __name__ == "__main__":
    sys.exit(main())
