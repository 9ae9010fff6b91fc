"""Robots to try urdfcheck with: sound ones, and for each a page with the defects that are planted into its copy."""

from __future__ import annotations

import re
import shutil
from functools import cache
from pathlib import Path

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass

ANSWERS = "PLANTED.md"
"""The page in a copy that says what was planted."""

_TITLE = re.compile(r"^# (?P<name>\w+): (?P<title>.+)$", re.MULTILINE)
_DEFECT = re.compile(
    r"^## (?P<code>[A-Z]{3}\d{3}) (?P<subject>\S+): (?P<title>.+?)$"
    r"(?:(?!^## ).)*?^```diff file=(?P<file>\S+)\n(?P<diff>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantedDefect:
    """A defect of a demo robot, as an edit of the sound one."""

    code: str
    """The rule that reports it."""
    subject: str
    """The link, joint, controller or file that it is about, as the finding names it."""
    title: str
    file: str
    """Relative to the robot's folder."""
    sound: str
    """The lines that are replaced, with those around them that the page shows."""
    planted: str
    """The same lines with the defect."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoRobot:
    """A sound robot and its planted defects."""

    name: str
    title: str
    folder: Path
    """The sound robot: a ROS package."""
    page: Path
    defects: tuple[PlantedDefect, ...]


@cache
def load_demo_robots() -> dict[str, DemoRobot]:
    """Return the demo robots by name."""
    return {page.stem: read_demo_robot(page) for page in sorted(_find_demos_folder().glob("[a-z]*.md"))}


def read_demo_robot(page: Path) -> DemoRobot:
    """Read the page of a robot, whose folder is beside it.

    :raises UrdfcheckError: when a heading of the page lacks its edit.
    """
    text = page.read_text(encoding="utf-8")
    title = _TITLE.match(text)
    defects = tuple(
        PlantedDefect(
            code=found["code"],
            subject=found["subject"],
            title=found["title"],
            file=found["file"],
            sound=split_diff(found["diff"])[0],
            planted=split_diff(found["diff"])[1],
        )
        for found in _DEFECT.finditer(text)
    )
    if title is None or title["name"] != page.stem or len(defects) != len(re.findall("^## ", text, re.MULTILINE)):
        raise UrdfcheckError(f"{page}: begin with '# {page.stem}: …', and give each heading its edit")
    return DemoRobot(name=page.stem, title=title["title"], folder=page.with_suffix(""), page=page, defects=defects)


def copy_demo_robot(robot: DemoRobot, folder: Path, *, is_sound: bool = False) -> None:
    """Copy a robot into a new or empty folder, with its defects and the page about them unless it is to be sound.

    :raises UrdfcheckError: when the edit of a defect does not fit the robot.
    """
    shutil.copytree(robot.folder, folder, dirs_exist_ok=True, copy_function=shutil.copyfile)
    if is_sound:
        return
    for defect in robot.defects:
        plant_defect(defect, folder)
    shutil.copyfile(robot.page, folder / ANSWERS)


def split_diff(diff: str) -> tuple[str, str]:
    """Return the lines before and after an edit that is written as a diff without a header."""
    before, after = ("".join(f"{line[1:]}\n" for line in diff.splitlines() if line[:1] in (" ", mark)) for mark in "-+")
    return before, after


def plant_defect(defect: PlantedDefect, folder: Path) -> None:
    """Plant a defect into a copy of its robot.

    :raises UrdfcheckError: when the sound lines are not there exactly once.
    """
    file = folder / defect.file
    text = file.read_bytes().decode()
    if text.count(defect.sound) != 1:
        raise UrdfcheckError(f"{file}: the lines of {defect.code} {defect.subject} are not there exactly once")
    file.write_bytes(text.replace(defect.sound, defect.planted).encode())


def _find_demos_folder() -> Path:
    """Return the folder of the robots: in the installed package, or in the source tree beside it."""
    package = Path(__file__).parent.parent
    installed = package / "_demos"
    return installed if installed.is_dir() else package.parent / "fixtures" / "demos"
