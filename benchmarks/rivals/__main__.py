"""The defects of simcheck's own benchmark, found by urdfcheck and by others: ``python benchmarks/rivals --programs FOLDER``.

The robots are those of the folders that ``URDFCHECK_CORPUS`` names. The README says what every number means.
"""

from __future__ import annotations

import os

# One thread each: neither program waits for the other's threads.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from statistics import median

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))

from judging import Said, find_new, is_located, list_said_by_urdfcheck
from planting import list_plain_robots, plant
from programs import PROGRAMS
from real.robots import RealRobot
from results import build_results, format_results
from sample import SOUND, Answer, Task, ask_all, draw_sample, read_answers

import urdfcheck
from urdfcheck.core import Run
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.request import RunOptions, make_request

RESULTS = Path(__file__).with_name("answers.json")
# Simcheck's operators, and the rules of urdfcheck that name what each does or its direct effect.
RULES = {
    "scale_mm": {"MSH008", "GEO006", "GEO001", "INR010", "INR005", "INR009"},
    "scale_small": {"MSH008", "GEO001", "INR010", "INR005", "INR009", "INR018"},
    "flip_axis": {"JNT021", "SYM004", "SYM005", "SYM008", "COL005"},
    "zero_axis": {"JNT001"},
    "swap_limits": {"JNT005"},
    "degrees": {"JNT006"},
    "zero_inertia": {"INR004", "INR003"},
    "triangle": {"INR003"},
    "negative_inertia": {"INR004"},
    "mass_grams": {"INR009", "INR010", "INR011", "INR015"},
    "zero_mass": {"INR002"},
    "no_inertial": {"INR001", "INR002"},
    "no_collision": {"GEO002"},
    "collision_offset": {"GEO003", "GEO005"},
    "com_outside": {"INR006", "INR005", "INR009"},
    "missing_mesh": {"PKG002", "PKG004"},
    "joint_into_parent": {"JNT021", "JNT018", "SYM002", "SYM004", "COL001", "COL002", "COL006"},
}


@dataclass(slots=True)
class Case:
    """One planted file."""

    task: Task
    outcome: str = "missed"
    """Of urdfcheck: ``named``, ``found`` or ``missed``."""
    loud: bool = False
    """Whether one of the findings that count is a warning or an error."""
    seconds: float = 0.0
    lines: list[str] = field(default_factory=list)
    elsewhere: list[str] = field(default_factory=list)


def main() -> None:
    """Plant, check, and print."""
    parser = argparse.ArgumentParser(prog="python benchmarks/rivals", description=__doc__.partition(":")[0])
    parser.add_argument(
        "--programs", required=True, type=Path, help="the folder that programs.py has filled; simcheck plants"
    )
    parser.add_argument("--count", type=int, default=20, help="how many robots, the smallest first")
    parser.add_argument("--robots", default="", help="only robots whose name contains this")
    parser.add_argument("--operators", default="", help="only these, separated by commas")
    parser.add_argument("--list", action="store_true", help="list every case with what urdfcheck reports")
    parser.add_argument("--sample", type=int, default=0, help="ask all programs, about a sample of so many rounds")
    parser.add_argument("--seed", type=int, default=1, help="of the sample")
    parser.add_argument("--limit", type=int, default=240, help="seconds that another program may take for one file")
    parser.add_argument("--keep", type=Path, help="the file of the sample's answers, which a second run continues")
    options = parser.parse_args()
    if options.sample and options.keep is None:
        parser.error("--sample needs --keep FILE")
    robots = {robot.name: robot for robot in list_plain_robots(options.count) if options.robots in robot.name}
    wanted = set(options.operators.split(",")) if options.operators else set(RULES)
    with tempfile.TemporaryDirectory() as folder:
        tasks = [
            task
            for number, robot in enumerate(robots.values())
            for task in plant(robot, Path(folder) / str(number), options.programs / "simcheck" / "bin" / "python")
            if task.operator in {*wanted, SOUND}
        ]
        if not tasks:
            parser.error(
                "no robot in which simcheck can plant: does URDFCHECK_CORPUS name a folder with a corpus.json?"
            )
        if options.sample:
            compare_sample(tasks, robots, options)
            return
        cases = check_all(tasks, robots)
    if options.list:
        print("\n".join(describe(case) for case in cases))
    print(build_table(cases))


def check_all(tasks: Sequence[Task], robots: dict[str, RealRobot]) -> list[Case]:
    """Check every file with urdfcheck, which has measured the meshes before."""
    before: dict[str, list[Said]] = {}
    cases = []
    for task in tasks:
        robot = robots[task.robot]
        if task.operator == SOUND:
            check_file(task.file, robot)  # measures the meshes
            before[task.robot] = list_said_by_urdfcheck(check_file(task.file, robot))
            continue
        start = time.process_time()
        report = check_file(task.file, robot)
        case = Case(task, seconds=time.process_time() - start)
        judge(case, before[task.robot], list_said_by_urdfcheck(report))
        cases.append(case)
    return cases


def compare_sample(tasks: Sequence[Task], robots: dict[str, RealRobot], options: argparse.Namespace) -> None:
    """Ask all programs about a sample, and write the results. Nothing is kept between two files: each mesh is read again."""

    def ask_urdfcheck(task: Task) -> Answer:
        start = time.process_time()
        report = check_file(task.file, robots[task.robot], cache=False)
        return Answer(said=list_said_by_urdfcheck(report), seconds=time.process_time() - start)

    drawn = draw_sample([task for task in tasks if task.operator != SOUND], options.sample, options.seed)
    used = {task.robot for task in drawn}
    asked = [*(task for task in tasks if task.operator == SOUND and task.robot in used), *drawn]
    ask_urdfcheck(asked[0])  # loads the modules
    ask_all(asked, ask_urdfcheck, PROGRAMS, environments=options.programs, limit=options.limit, keep=options.keep)
    results = build_results(asked, read_answers(options.keep), date.today())
    RESULTS.write_text(format_results(results), encoding="utf-8")
    print(f"{RESULTS}: {len(results['programs'])} programs, {len(results['files'])} files")


def check_file(file: str, robot: RealRobot, *, cache: bool = True) -> Run:
    """Check a file by default, except that its meshes may be read: simcheck's copies have the paths of this machine."""
    folders = robot.package_roots or (robot.entry.parent.parent,)
    request, _ = make_request(RunOptions(paths=(file,), allow_read=folders, isolated=True, cache=cache, jobs=1))
    return run(request, IN_THIS_PROCESS)


def judge(case: Case, before: Sequence[Said], after: Sequence[Said]) -> None:
    """Say what urdfcheck reports that it did not report of the sound robot, or not as severely."""
    counted: set[str] = set()
    for said in find_new(before, after):
        line = f"{said.severity} {said.same}: {said.message}"
        if is_located(said, case.task.change, case.task.operator):
            counted.add(said.check)
            case.loud |= said.severity != "info"
            case.lines.append(line)
        else:
            case.elsewhere.append(line)
    if counted:
        case.outcome = "named" if counted & RULES[case.task.operator] else "found"


def describe(case: Case) -> str:
    """Return a case as lines."""
    task = case.task
    head = f"{task.robot}\t{task.operator}\t{case.outcome}\t{case.seconds:.2f} s\t{task.what}"
    return "\n    ".join([head, *case.lines[:4], *(f"elsewhere: {line}" for line in case.elsewhere[:4])])


def build_table(cases: Sequence[Case]) -> str:
    """Count by operator."""
    by_operator: dict[str, list[Case]] = defaultdict(list)
    for case in cases:
        by_operator[case.task.operator].append(case)
    lines = [
        f"urdfcheck {urdfcheck.__version__}, {len({case.task.robot for case in cases})} robots, {len(cases)} planted files.\n",
        "| operator | files | found | named | at warning |",
        "|---|---:|---:|---:|---:|",
    ]
    for operator in (*(name for name in RULES if name in by_operator), "all"):
        some = cases if operator == "all" else by_operator[operator]
        named, loud = sum(c.outcome == "named" for c in some), sum(c.loud for c in some)
        lines.append(f"| {operator} | {len(some)} | {_count_found(some)} | {named} | {loud} |")
    seconds = median(case.seconds for case in cases)
    return "\n".join([*lines, f"\nSeconds of processor time for one file, median: {seconds:.2f}."])


def _count_found(cases: Iterable[Case]) -> int:
    return sum(case.outcome != "missed" for case in cases)


if __name__ == "__main__":
    main()
