"""urdfcheck's language server beside another one: ``python benchmarks/language_servers --environments FOLDER PARTS``.

The robots are those of the folders that ``URDFCHECK_CORPUS`` names. The README says what every number means.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Any

from latency import MODELS, measure
from planted_defects import ask_about_planted
from published_robots import ask_about_published, count_by_robot
from repositories import list_complete_robots
from servers import OTHER, OWN, list_versions
from shown_errors import draw_errors, write_judged

ANSWERS = Path(__file__).with_name("answers.json")
PARTS = ("published", "planted", "latency")


def main() -> None:
    """Ask, and write what the page shows."""
    parser = argparse.ArgumentParser(prog="python benchmarks/language_servers", description=__doc__.partition(":")[0])
    parser.add_argument("parts", nargs="*", default=PARTS, help=f"some of {', '.join(PARTS)}; all if none is named")
    parser.add_argument("--environments", required=True, type=Path, help="the folder that servers.py has filled")
    parser.add_argument("--simcheck", type=Path, help="the Python of an environment with simcheck, which plants")
    parser.add_argument(
        "--robots", default="", help="only published robots whose name contains this; nothing is written"
    )
    parser.add_argument("--turns", type=int, default=3, help="how often each model is opened for the times")
    options = parser.parse_args()
    if set(options.parts) - set(PARTS):
        parser.error(f"parts are {', '.join(PARTS)}")
    if "planted" in options.parts and options.simcheck is None:
        parser.error("planted needs --simcheck PYTHON")
    robots = [robot for robot in list_complete_robots() if options.robots in robot.name]
    if not robots:
        parser.error("no robot: does URDFCHECK_CORPUS name a folder with a corpus.json?")
    made: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder:
        if "published" in options.parts:
            errors = ask_about_published(options.environments, robots)
            made["published"] = count_by_robot(robots, errors)
            drawn = [
                one for name in (OWN, OTHER) for one in draw_errors([error for error in errors if error.server == name])
            ]
            if not options.robots:
                print(f"{write_judged(drawn)} of {len(drawn)} drawn errors have no label yet")
        if "planted" in options.parts:
            made["planted"] = ask_about_planted(options.environments, options.simcheck, Path(folder) / "planted")
        if "latency" in options.parts:
            timed = [robot for robot in robots if robot.name in MODELS]
            made["latency"] = measure(options.environments, timed, options.turns, Path(folder) / "copies")
    if not options.robots:
        write_answers(made)


def write_answers(made: Mapping[str, Any]) -> None:
    """Replace the parts that were made: one line for each row, so that a change of one is a change of one line."""
    known = json.loads(ANSWERS.read_text(encoding="utf-8")) if ANSWERS.exists() else {}
    answers = {**known, **made, "date": date.today().isoformat(), "servers": list_versions()}
    parts = []
    for key, value in sorted(answers.items()):
        rows = ",\n".join(map(json.dumps, value)) if isinstance(value, list) else ""
        parts.append(f"{json.dumps(key)}: " + (f"[\n{rows}\n]" if rows else json.dumps(value)))
    ANSWERS.write_text("{\n" + ",\n".join(parts) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
