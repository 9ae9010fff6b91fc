"""One robot end to end as a whole process, with an empty cache, unchanged and with one changed number, against the script.

Robots: car-3, and of a corpus an SO-100, a UR20, a Panda and a TALOS, as plain URDF with all their meshes. For car-3 also the
folder as its author left it: xacro, launch file, package. Times are those of the processor, of all processes.
"""

from __future__ import annotations

import itertools
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from process import CHECK, EMPTY, HERE, PINOCCHIO, SCRIPT, SCRIPT_IMPORTS, took

CAR_3 = HERE.parents[1] / "fixtures" / "car-3"
# How the names that urdfs.py gives to these robots end.
FROM_CORPUS = {"SO-100": "so100", "UR20": "ur-ur-type-ur20", "Panda": "franka-ros-panda", "TALOS": "talos-reduced"}
# Their values are not the author's: a turn changes the first.
_MASS = re.compile(r'(<mass\s+value=")[^"]+(")')


@dataclass(kw_only=True)
class Times:
    """Processor seconds of each turn."""

    script: list[float] = field(default_factory=list)
    cold: list[float] = field(default_factory=list)
    same: list[float] = field(default_factory=list)
    changed: list[float] = field(default_factory=list)


def list_readable(corpus: Path | None) -> list[str]:
    """Return the options of the command with which it may read the meshes of the robots, which are not beside their files."""
    return [word for folder in (CAR_3, corpus) if folder is not None for word in ("--allow-read", str(folder))]


def compare(corpus: Path | None, repeats: int) -> None:
    """Print the table of one robot at a time."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "urdf")
        out.mkdir()
        robots = write_robots(out, corpus)
        starts = {"empty python": EMPTY, "import pinocchio": PINOCCHIO, "the script's imports": SCRIPT_IMPORTS}
        median = {
            name: statistics.median([took(command).processor for _ in range(repeats)])
            for name, command in starts.items()
        }
        for name, seconds in median.items():
            print(f"{name:24} {seconds * 1e3:6.0f} ms")
        imports, pinocchio = median["the script's imports"], median["import pinocchio"]
        print(
            f"{'one robot':24} {'script':>9} {'cold':>9} {'same':>9} {'changed':>9}   cold / script's imports   "
            "same, changed / import pinocchio"
        )
        options = list_readable(corpus)
        for name, robot in robots.items():
            _row(name, _measure(robot, repeats, urdf=robot, changed=robot, options=options), imports, pinocchio)
        whole = Path(folder, "car-3")
        shutil.copytree(CAR_3, whole)
        times = _measure(
            whole, repeats, urdf=out / "car-3.urdf", changed=whole / "urdf" / "car-3.urdf", options=options
        )
        _row("car-3, the whole folder", times, imports, pinocchio)
    print(
        "same: unchanged since the cold run; changed: one mass. targets: cold <= 1.00 × the script's imports, "
        "same <= 0.80 and changed <= 1.50 × import pinocchio",
        flush=True,
    )


def write_robots(out: Path, corpus: Path | None) -> dict[str, Path]:
    """Write the robots as plain URDF, and return their files by name."""
    writer = [sys.executable, str(HERE / "urdfs.py"), str(out), f"car-3={CAR_3 / 'urdf' / 'car-3.urdf'}"]
    subprocess.run([*writer, *(["--corpus", str(corpus)] if corpus else [])], check=True)
    found = {name: path for name, end in FROM_CORPUS.items() for path in out.glob(f"*{end}.urdf")}
    return {"car-3": out / "car-3.urdf", **found}


def _measure(checked: Path, repeats: int, *, urdf: Path, changed: Path, options: list[str]) -> Times:
    """Measure the script on ``urdf``, and urdfcheck on ``checked`` cold, unchanged and after a change of one mass in ``changed``;
    the four take turns."""
    times, text = Times(), changed.read_text(encoding="utf-8")
    command = (*CHECK, str(checked), *options)
    for turn in range(repeats):
        with tempfile.TemporaryDirectory() as cache:
            times.script.append(took((*SCRIPT, str(urdf))).processor)
            times.cold.append(took(command, cache=cache).processor)
            times.same.append(took(command, cache=cache).processor)
            value = next(value for value in itertools.count(turn + 1) if f'"0.{value}"' not in text)
            changed.write_text(_MASS.sub(rf"\g<1>0.{value}\g<2>", text, count=1), encoding="utf-8")
            times.changed.append(took(command, cache=cache).processor)
            changed.write_text(text, encoding="utf-8")
    return times


def _row(name: str, times: Times, imports: float, pinocchio: float) -> None:
    medians = [statistics.median(side) for side in (times.script, times.cold, times.same, times.changed)]
    shown = "".join(f" {seconds * 1e3:6.0f} ms" for seconds in medians)
    ratios = ((medians[1] / imports, 1.0), (medians[2] / pinocchio, 0.8), (medians[3] / pinocchio, 1.5))
    told = (f"{ratio:6.2f}{'  MISSED' if ratio > most else '        '}" for ratio, most in ratios)
    print(f"{name:24}{shown}   {'     '.join(told)}".rstrip(), flush=True)
