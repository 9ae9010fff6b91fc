"""How often the cause that urdfcheck names is the right one: ``python benchmarks/accuracy [--split scored] [--quick]``.

Prints Markdown tables; the README says what every number means.
"""

from __future__ import annotations

import os

# Matrices of three rows: a pool of threads for each of them only takes the other processes' time.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import platform
from collections.abc import Sequence
from datetime import datetime, timezone
from functools import partial
from importlib.metadata import version
from multiprocessing import get_context

import cost
import defects
import formulas
import habits
import tables
from parts import FAMILIES, SPLITS
from scoring import Excluded, Outcome, outcomes

import urdfcheck

PARTS = ("parts", "formulas", "cost", "fixtures", "habits")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python benchmarks/accuracy", description=__doc__.splitlines()[0])
    parser.add_argument("--split", choices=SPLITS, default="scored", help="tune on one, score on the other")
    parser.add_argument("--seed", type=int, default=1, help="of the parts and of all that is done to them")
    parser.add_argument("--parts", type=int, default=13 * len(FAMILIES), help="how many")
    parser.add_argument("--quick", action="store_true", help="two parts of each family, fewer robots")
    parser.add_argument("--only", default=",".join(PARTS), help=f"some of {','.join(PARTS)}")
    parser.add_argument("--jobs", type=int, choices=(1, 2), default=2, help="processes")
    options = parser.parse_args()
    only = options.only.split(",")
    if unknown := set(only) - set(PARTS):
        parser.error(f"--only: no part {', '.join(sorted(unknown))}")
    number = 2 * len(FAMILIES) if options.quick else options.parts
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "trimesh", "manifold3d"))
    print(
        f"urdfcheck {urdfcheck.__version__}, {datetime.now(timezone.utc):%Y-%m-%d}, split `{options.split}`, "
        f"seed {options.seed}, {number} parts, Python {platform.python_version()}, {libraries}",
        flush=True,
    )
    if "parts" in only:
        print(tables.parts(_cases(options.split, options.seed, number, options.jobs)), flush=True)
    if "formulas" in only:
        print(formulas.build_table(options.split, options.seed, 2 * number), flush=True)
    if "cost" in only:
        print(cost.table(options.split, options.seed, min(number, 72)), flush=True)
    if "fixtures" in only:
        print(defects.table(options.split, options.seed, quick=options.quick), flush=True)
    if "habits" in only:
        print(habits.table(options.split, options.seed, quick=options.quick), flush=True)


def _cases(split: str, seed: int, number: int, jobs: int) -> Sequence[Outcome | Excluded]:
    one = partial(outcomes, split, seed)
    if jobs == 1:
        return [case for index in range(number) for case in one(index)]
    with get_context("spawn").Pool(jobs) as pool:
        return [case for cases in pool.imap(one, range(number), chunksize=4) for case in cases]


if __name__ == "__main__":
    main()
