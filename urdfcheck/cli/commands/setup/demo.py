"""``urdfcheck demo [NAME]``: copy a robot with planted defects, check it, and write its report."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from urdfcheck.cli.demo_robots import ANSWERS, copy_demo_robot, load_demo_robots
from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK, say

REPORT = "report.html"
_DEFAULT = "arm"


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck demo``."""
    robots = load_demo_robots()
    p = CommandParser(
        prog="urdfcheck demo",
        description="Copy a robot with planted defects, check it, and write its report.",
        epilog="robots:\n" + "\n".join(f"  {robot.name:20}{robot.title}" for robot in robots.values()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument(
        "name",
        nargs="?",
        choices=tuple(robots),
        default=_DEFAULT,
        help=f"which robot: {', '.join(robots)} (default: {_DEFAULT})",
    )
    p.add_argument("-o", "--output", type=Path, metavar="DIR", help="a new or empty folder (default: demo-NAME)")
    p.add_argument("--sound", action="store_true", help="copy the robot without the defects")
    p.add_argument("--open", action="store_true", help="open the report in the browser")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.cli.commands import check
    from urdfcheck.fix.repair.copy_sources import ensure_empty_folder

    robot = load_demo_robots()[options.name]
    folder: Path = options.output or Path(f"demo-{robot.name}")
    ensure_empty_folder(folder)
    copy_demo_robot(robot, folder, is_sound=options.sound)
    report = folder / REPORT
    code = check.main([str(folder), "-o", f"html={report}", "--fail-on", "never"])
    if code != OK:
        return code
    sys.stdout.flush()
    say(f"\n{folder}: {robot.title} (a ROS package)")
    if not options.sound:
        say(f"{len(robot.defects)} defects are planted in it: {folder / ANSWERS} says which")
    say(f"{report} is the report, with the robot in 3D")
    if options.open:
        import webbrowser

        webbrowser.open(report.resolve().as_uri())
    return OK
