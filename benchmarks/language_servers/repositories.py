"""The published robots that are opened, each in the folder of its repository."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))

from real.robots import VARIABLE, RealRobot, list_robots


def list_complete_robots() -> list[RealRobot]:
    """List the robots of the corpora of which a robot can be made and whose meshes are all there."""
    complete = {
        entry["id"]
        for folder in _list_corpora()
        for entry in json.loads((folder / "corpus.json").read_text(encoding="utf-8"))
        if entry["expands"] and entry["meshes_missing"] == 0
    }
    return [robot for robot in list_robots() if robot.name in complete]


def find_repository(robot: RealRobot) -> Path:
    """Return the folder of a robot's repository: what one opens in an editor."""
    folder = next(folder for folder in _list_corpora() if robot.entry.is_relative_to(folder))
    return folder / robot.entry.relative_to(folder).parts[0]


def copy_repository(robot: RealRobot, place: Path) -> tuple[Path, Path]:
    """Copy a robot's repository; return the folder and the robot's file in it."""
    source = find_repository(robot)
    copy = place / source.name
    if not copy.exists():
        shutil.copytree(source, copy)
    return copy, copy / robot.entry.relative_to(source)


def _list_corpora() -> list[Path]:
    folders = [Path(name).absolute() for name in os.environ.get(VARIABLE, "").split(os.pathsep) if name]
    return [folder for folder in folders if (folder / "corpus.json").is_file()]
