"""The robots in which simcheck plants, and what it plants."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))

from judging import find_change
from real.robots import RealRobot, list_robots
from sample import SOUND, Task

PLANTER = Path(__file__).with_name("plant_with_simcheck.py")


def list_plain_robots(count: int) -> list[RealRobot]:
    """List the smallest robots that are one URDF file with at least one moving joint: simcheck plants in nothing else."""
    plain = [
        robot for robot in list_robots()
        if robot.expands and robot.entry.suffix.lower() == ".urdf" and _has_moving_joint(robot.entry) and robot.links > 2
    ]  # fmt: skip
    return sorted(plain, key=lambda robot: (robot.links, robot.name))[:count]


def plant(robot: RealRobot, folder: Path, python: Path) -> list[Task]:
    """Let simcheck plant every defect in a robot; the first task is the sound robot."""
    done = subprocess.run([python, PLANTER, robot.entry, folder], capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"{robot.name}: simcheck does not read it: {done.stderr.strip().splitlines()[-1:]}")
        return []
    written = json.loads(done.stdout.splitlines()[-1])
    clean = written["clean"]
    planted = [
        Task(
            robot=robot.name,
            operator=operator,
            file=made["file"],
            what=made["what"],
            change=find_change(Path(clean), Path(made["file"])),
        )
        for operator, made in written["planted"].items()
    ]
    return [Task(robot=robot.name, operator=SOUND, file=clean), *planted]


def _has_moving_joint(file: Path) -> bool:
    try:
        root = ET.parse(file).getroot()
    except ET.ParseError:
        return False
    return any(joint.get("type") in ("revolute", "prismatic", "continuous") for joint in root.findall("joint"))
