"""Makes the committed sample reports: ``python reports/make.py``; ``--check`` only says which are stale.

What differs from run to run or from machine to machine (times, versions of libraries) is set to fixed values, so that the
reports change only when urdfcheck or a fixture does.
"""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path

from urdfcheck import catalogue, output
from urdfcheck.core import Run
from urdfcheck.engine import Request, run

REPOSITORY = Path(__file__).resolve().parent.parent
SUFFIXES = {"text": ".txt", "json": ".json", "html": ".html"}
ROBOTS = ("car-3",)


def audited(robot: str) -> Run:
    """The audit of a fixture without what depends on the machine."""
    outcome = run(Request((Path("fixtures") / robot,), Path(), frozenset(catalogue.rules()), jobs=2, scene=True))
    return replace(
        outcome,
        models=tuple(replace(model, seconds=0.0) for model in outcome.models),
        seconds=0.0,
        versions={name: v if name == "urdfcheck" else "any" for name, v in outcome.versions.items()},
    )


def reports() -> dict[Path, str]:
    """The text of every sample report by its path."""
    os.chdir(REPOSITORY)
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        os.environ.pop(variable, None)
    made = {}
    for robot in ROBOTS:
        outcome = audited(robot)
        for output_format, suffix in SUFFIXES.items():
            made[REPOSITORY / "reports" / f"{robot}{suffix}"] = output.render(outcome, output_format)
    return made


def main() -> int:
    stale = [p for p, text in reports().items() if not p.is_file() or p.read_text(encoding="utf-8") != text]
    if "--check" in sys.argv:
        for path in stale:
            print(f"stale: {path.relative_to(REPOSITORY)} (make reports)")
        return 1 if stale else 0
    for path, text in reports().items():
        path.write_text(text, encoding="utf-8", newline="\n")
        print(path.relative_to(REPOSITORY))
    return 0


if __name__ == "__main__":
    sys.exit(main())
