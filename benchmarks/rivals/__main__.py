"""The defects of simcheck's own benchmark, found by urdfcheck and by simcheck: ``python benchmarks/rivals --simcheck PYTHON``.

The robots are those of the folders that ``URDFCHECK_CORPUS`` names. Prints Markdown tables; the README says what every number
means.
"""

from __future__ import annotations

import os

# One thread each: neither program waits for the other's threads.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import median
from xml.etree import ElementTree as ET

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))

from real.robots import RealRobot, list_robots

import urdfcheck
from urdfcheck.core import Run, Severity
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.request import RunOptions, make_request

SIDE = Path(__file__).with_name("simcheck_side.py")
# Simcheck's operators, and the rules of urdfcheck that name what each does or its direct effect.
NAMING = {
    "scale_mm": {"MSH008", "GEO001", "INR010", "INR005", "INR009"},
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
# Rule, message, cause and subject.
Key = tuple[str, str, str, str]


@dataclass(slots=True)
class Case:
    """One planted file."""

    robot: str
    operator: str
    what: str
    file: str
    parts: list[str]
    """Names of the links and joints whose text differs from that of the sound robot, and the children of these joints."""
    outcome: str = "missed"
    """Of urdfcheck: ``named``, ``found`` or ``missed``."""
    loud: bool = False
    """Whether one of the findings that count is a warning or an error."""
    seconds: float = 0.0
    lines: list[str] = field(default_factory=list)
    elsewhere: list[str] = field(default_factory=list)
    rival: str = ""
    """Of simcheck: ``found``, ``missed`` or why there is no answer; empty: not asked."""
    rival_seconds: float = 0.0


def main() -> None:
    """Plant, check with both, and print."""
    parser = argparse.ArgumentParser(prog="python benchmarks/rivals", description=__doc__.partition(":")[0])
    parser.add_argument("--simcheck", required=True, help="a Python in whose environment simcheck is installed")
    parser.add_argument("--count", type=int, default=20, help="how many robots, the smallest first")
    parser.add_argument("--limit", type=int, default=120, help="seconds that simcheck may take for one file")
    parser.add_argument("--alone", action="store_true", help="do not let simcheck check anything")
    parser.add_argument("--operators", default="", help="only these, separated by commas")
    parser.add_argument("--robots", default="", help="only robots whose name contains this")
    parser.add_argument("--list", action="store_true", help="list every case with what urdfcheck reports")
    parser.add_argument("--keep", type=Path, help="a file that gets the cases as JSON lines")
    options = parser.parse_args()
    robots = list_plain_robots(options.count)
    wanted = set(options.operators.split(",")) if options.operators else set(NAMING)
    cases: list[Case] = []
    with tempfile.TemporaryDirectory() as folder:
        for number, robot in enumerate(robots):
            if options.robots not in robot.name:
                continue
            found = run_robot(robot, Path(folder) / str(number), options, wanted)
            cases += found
            if options.keep:
                with options.keep.open("a", encoding="utf-8") as file:
                    file.writelines(json.dumps(asdict(case)) + "\n" for case in found)
            if options.list:
                print("\n".join(describe(case) for case in found), flush=True)
    if not cases:
        parser.error("no robot in which simcheck can plant: does URDFCHECK_CORPUS name a folder with a corpus.json?")
    print(build_table(cases))


def list_plain_robots(count: int) -> list[RealRobot]:
    """List the smallest robots that are one URDF file with at least one moving joint: simcheck plants in nothing else."""
    plain = [
        robot for robot in list_robots()
        if robot.expands and robot.entry.suffix.lower() == ".urdf" and _has_moving_joint(robot.entry) and robot.links > 2
    ]  # fmt: skip
    return sorted(plain, key=lambda robot: (robot.links, robot.name))[:count]


def run_robot(robot: RealRobot, folder: Path, options: argparse.Namespace, wanted: set[str]) -> list[Case]:
    """Plant every defect in a robot, and check each file with both programs, one after the other."""
    planted = subprocess.run(
        [options.simcheck, SIDE, "plant", robot.entry, folder], capture_output=True, text=True, check=False
    )
    if planted.returncode:
        print(f"{robot.name}: simcheck does not read it: {planted.stderr.strip().splitlines()[-1:]}")
        return []
    written = json.loads(planted.stdout.splitlines()[-1])
    clean = Path(written["clean"])
    cases = [
        Case(robot.name, operator, made["what"], made["file"], find_changed(clean, Path(made["file"])))
        for operator, made in written["planted"].items() if operator in wanted
    ]  # fmt: skip
    check_file(clean, robot)  # measures the meshes
    before = list_keys(check_file(clean, robot))
    for case in cases:
        start = time.process_time()
        report = check_file(Path(case.file), robot)
        case.seconds = time.process_time() - start
        judge(case, before, report)
    if not options.alone:
        expected = {operator: set(made["expect"]) for operator, made in written["planted"].items()}
        ask_rival(clean, cases, expected, options)
    return cases


def check_file(file: Path, robot: RealRobot) -> Run:
    """Check a file by default, but for its meshes: simcheck's copies have the paths of this machine."""
    folders = robot.package_roots or (robot.entry.parent.parent,)
    request, _ = make_request(RunOptions(paths=(file,), allow_read=folders, isolated=True, jobs=1))
    return run(request, IN_THIS_PROCESS)


def find_changed(clean: Path, planted: Path) -> list[str]:
    """Name the links and joints that differ, and the children of these joints."""
    old, new = ET.parse(clean).getroot(), ET.parse(planted).getroot()
    names: list[str] = []
    for before, after in zip(old, new, strict=True):
        if ET.tostring(before) == ET.tostring(after):
            continue
        names.append(after.get("name", ""))
        child = after.find("child")
        names += [child.get("link", "")] if child is not None else []
    return list(dict.fromkeys(names))


def list_keys(report: Run) -> dict[Key, tuple[Severity, str]]:
    """List what a run reports by rule, message, cause and subject, each with the highest severity and its message."""
    keys: dict[Key, tuple[Severity, str]] = {}
    for finding in report.active_findings:
        for place in finding.list_occurrences():
            cause = "" if place.cause is None else place.cause.id
            for subject in place.subjects or ("",):
                message = place.message_ids.get(subject, place.message_id)
                key = (place.code, message, cause, subject)
                if key not in keys or finding.severity > keys[key][0]:
                    keys[key] = finding.severity, place.message
    return keys


def judge(case: Case, before: dict[Key, tuple[Severity, str]], report: Run) -> None:
    """Say what urdfcheck reports that it did not report of the sound robot, or not as severely."""
    counted: set[str] = set()
    for key, (severity, message) in list_keys(report).items():
        code, message_id, cause, subject = key
        if key in before and before[key][0] >= severity:
            continue
        line = f"{severity} {code} {message_id} {cause} {subject}: {message}"
        if concerns(subject, message, case.parts):
            counted.add(code)
            case.loud |= severity >= Severity.WARNING
            case.lines.append(line)
        else:
            case.elsewhere.append(line)
    if counted:
        case.outcome = "named" if counted & NAMING[case.operator] else "found"


def concerns(subject: str, message: str, parts: Sequence[str]) -> bool:
    """Say whether a finding is about one of the parts: it is its subject, or named in quotes or backticks."""
    spelled = [(f"{part}]", f"`{part}`", f'"{part}"') for part in parts if part]
    at = subject.partition("[")[2]
    return any(at.startswith(end) or code in message or quoted in message for end, code, quoted in spelled)


def ask_rival(clean: Path, cases: Sequence[Case], expected: dict[str, set[str]], options: argparse.Namespace) -> None:
    """Let simcheck check the sound robot and every planted file, and count as its own benchmark does."""
    files = "".join(f"{file}\n" for file in (clean, *(case.file for case in cases)))
    process = subprocess.run(
        [options.simcheck, SIDE, "check", str(options.limit)], input=files, capture_output=True, text=True, check=False
    )
    answers = {}
    for line in process.stdout.splitlines():
        if line.startswith("{"):
            answer = json.loads(line)
            answers[answer["file"]] = answer
    sound = answers.get(str(clean), {"problem": "no answer"})
    for case in cases:
        answer = answers.get(case.file, {"problem": "no answer", "seconds": 0.0})
        case.rival_seconds = answer["seconds"]
        case.rival = sound["problem"] or answer["problem"]
        if not case.rival:
            new = {tuple(said) for said in answer["said"]} - {tuple(said) for said in sound["said"]}
            case.rival = "found" if any(check in expected[case.operator] for check, _ in new) else "missed"


def describe(case: Case) -> str:
    """Return a case as lines."""
    head = f"{case.robot}\t{case.operator}\t{case.outcome}\t{case.seconds:.2f} s\tsimcheck {case.rival or '–'}\t{case.what}"
    return "\n    ".join([head, *case.lines[:4], *(f"elsewhere: {line}" for line in case.elsewhere[:4])])


def build_table(cases: Sequence[Case]) -> str:
    """Count by operator; simcheck's share is of the files that it answered, beside that of urdfcheck on the same ones."""
    by_operator: dict[str, list[Case]] = defaultdict(list)
    for case in cases:
        by_operator[case.operator].append(case)
    lines = [
        f"urdfcheck {urdfcheck.__version__}, {len({case.robot for case in cases})} robots, {len(cases)} planted files.\n",
        "| operator | files | found | named | at warning | both finished | urdfcheck there | simcheck there |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for operator in (*(name for name in NAMING if name in by_operator), "all"):
        some = cases if operator == "all" else by_operator[operator]
        both = [case for case in some if case.rival in ("found", "missed")]
        lines.append(
            f"| {operator} | {len(some)} | {_count_found(some)} | {sum(c.outcome == 'named' for c in some)} | "
            f"{sum(c.loud for c in some)} | {len(both)} | {_count_found(both)} | {sum(c.rival == 'found' for c in both)} |"
        )
    asked = [case for case in cases if case.rival]
    lines.append(
        f"\nSeconds of processor time for one file, median: urdfcheck {median(case.seconds for case in cases):.2f}"
    )
    if asked:
        lines[-1] += f", simcheck {median(case.rival_seconds for case in asked):.2f}"
        slow = sum(case.rival == "timeout" for case in asked)
        lines[-1] += f"; {slow} files took simcheck longer than the limit" if slow else ""
    return "\n".join([*lines[:-1], f"{lines[-1]}."])


def _count_found(cases: Iterable[Case]) -> int:
    return sum(case.outcome != "missed" for case in cases)


def _has_moving_joint(file: Path) -> bool:
    try:
        root = ET.parse(file).getroot()
    except ET.ParseError:
        return False
    return any(joint.get("type") in ("revolute", "prismatic", "continuous") for joint in root.findall("joint"))


if __name__ == "__main__":
    main()
