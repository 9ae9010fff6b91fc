"""Defects of small mobile robots, found and named: ``python benchmarks/mobile``.

Five robots are made; ten published ones are taken from the folders that ``URDFCHECK_CORPUS`` names. Prints Markdown tables.
"""

from __future__ import annotations

import os

# Matrices of three rows: a pool of threads for each of them only takes the other processes' time.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))

from defects import DEFECTS
from made import MobileRobot, make_robots
from neutral import rename_wheels
from published import list_published
from real.robots import RealRobot, check_robot

import urdfcheck
from urdfcheck.core import Finding, Severity

Key = tuple[str, str | None, str, str]
Check = Callable[[MobileRobot], "list[Finding]"]


def main() -> None:
    """Plant the defects, and print what was found."""
    parser = argparse.ArgumentParser(prog="python benchmarks/mobile", description=__doc__.partition(":")[0])
    parser.add_argument("--made", action="store_true", help="only the robots that are made")
    parser.add_argument(
        "--neutral",
        action="store_true",
        help="only robots with two driven wheels, under names that say neither wheel nor side",
    )
    parser.add_argument("--list", action="store_true", help="list every case with the rules that reported it")
    options = parser.parse_args()
    results: dict[str, list[str]] = defaultdict(list)
    sound: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        for original, check in _iter_robots(Path(folder), made_only=options.made):
            robot = rename_wheels(original) if options.neutral else original
            if robot is None:
                continue
            before = check(robot)
            sound.append(f"{robot.name}: {', '.join(sorted({f.code for f in before})) or 'none'}")
            known = {_make_key(finding) for finding in before}
            for defect in DEFECTS:
                broken = defect.plant(robot)
                if broken is None:
                    continue
                new = [finding for finding in check(broken) if _make_key(finding) not in known]
                codes = {finding.code for finding in new}
                outcome = "named" if codes & defect.codes else "found" if codes else "missed"
                results[defect.name].append(outcome)
                if options.list:
                    print(f"{robot.name}\t{defect.name}\t{outcome}\t{', '.join(sorted(codes))}", flush=True)
    print(f"urdfcheck {urdfcheck.__version__}, {len(sound)} robots.\n")
    print("| defect | robots | found | named |\n|---|---:|---:|---:|")
    for name, outcomes in results.items():
        print(f"| {name} | {len(outcomes)} | {_count(outcomes, 'found', 'named')} | {_count(outcomes, 'named')} |")
    everything = [outcome for outcomes in results.values() for outcome in outcomes]
    print(f"| all | {len(everything)} | {_count(everything, 'found', 'named')} | {_count(everything, 'named')} |")
    print("\nErrors and warnings of the sound robots: " + "; ".join(sound) + ".")


def _iter_robots(folder: Path, *, made_only: bool) -> Iterator[tuple[MobileRobot, Check]]:
    for robot in make_robots():
        place = folder / robot.name
        yield robot, lambda broken, place=place: _check_made(broken, place)  # type: ignore[misc]
    for real, robot in () if made_only else list_published():
        yield robot, lambda broken, real=real: _check_published(broken, real)  # type: ignore[misc]


def _check_made(robot: MobileRobot, folder: Path) -> list[Finding]:
    entry = folder / "urdf/robot.urdf.xacro"
    text = ET.tostring(robot.root, encoding="unicode")
    text = text.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1)
    for path, content in {**robot.files, "urdf/robot.urdf.xacro": text}.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content.encode() if isinstance(content, str) else content)
    return _list_problems(RealRobot(name=robot.name, entry=entry), {})


def _check_published(robot: MobileRobot, real: RealRobot) -> list[Finding]:
    return _list_problems(real, {real.entry: ET.tostring(robot.root, encoding="unicode")})


def _list_problems(real: RealRobot, texts: dict[Path, str]) -> list[Finding]:
    run = check_robot(real, texts)
    return [finding for finding in run.active_findings if finding.severity >= Severity.WARNING]


def _make_key(finding: Finding) -> Key:
    return finding.code, finding.message_id, finding.headline, ",".join(finding.subjects)


def _count(outcomes: list[str], *wanted: str) -> int:
    return sum(outcome in wanted for outcome in outcomes)


if __name__ == "__main__":
    main()
