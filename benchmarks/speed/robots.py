"""One robot end to end as a whole process, with an empty cache and unchanged, against the script.

Robots: car-3, and of a corpus a UR20, a Panda and a TALOS, as plain URDF with all their meshes. For car-3 also the folder as
its author left it: xacro, launch file, package.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from process import CHECK, EMPTY, HERE, PINOCCHIO, SCRIPT, SCRIPT_IMPORTS, took

CAR_3 = HERE.parents[1] / "fixtures" / "car-3"
# How the names that urdfs.py gives to these robots end.
FROM_CORPUS = {"UR20": "ur-ur-type-ur20", "Panda": "franka-ros-panda", "TALOS": "talos-reduced"}


def compare(corpus: Path | None, repeats: int) -> None:
    """Print the table of one robot at a time."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        robots = write_robots(out, corpus)
        starts = {"empty python": EMPTY, "import pinocchio": PINOCCHIO, "the script's imports": SCRIPT_IMPORTS}
        median = {name: _median([took(command).seconds for _ in range(repeats)]) for name, command in starts.items()}
        for name, seconds in median.items():
            print(f"{name:24} {seconds * 1e3:6.0f} ms")
        imports, pinocchio = median["the script's imports"], median["import pinocchio"]
        print(
            f"{'one robot':24} {'script':>9} {'cold':>9} {'same':>9}   cold / script's imports   same / import pinocchio"
        )
        for name, robot in robots.items():
            script, cold, warm = _robot(robot, repeats, robot)
            _row(name, script, cold, warm, imports, pinocchio)
        script, cold, warm = _robot(CAR_3, repeats, out / "car-3.urdf")
        _row("car-3, the whole folder", script, cold, warm, imports, pinocchio)
    print(
        "same: unchanged since the cold run. targets: cold <= 1.00 × the script's imports, same <= 0.80 × import pinocchio",
        flush=True,
    )


def write_robots(out: Path, corpus: Path | None) -> dict[str, Path]:
    """Write the robots as plain URDF, and return their files by name."""
    writer = [sys.executable, str(HERE / "urdfs.py"), str(out), f"car-3={CAR_3 / 'urdf' / 'car-3.urdf'}"]
    subprocess.run([*writer, *(["--corpus", str(corpus)] if corpus else [])], check=True)
    found = {name: path for name, end in FROM_CORPUS.items() for path in out.glob(f"*{end}.urdf")}
    return {"car-3": out / "car-3.urdf", **found}


def _robot(checked: Path, repeats: int, urdf: Path) -> tuple[float, float, float]:
    """Medians of the script on ``urdf``, and of urdfcheck on ``checked`` cold and unchanged; the three take turns."""
    script, cold, warm = [], [], []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as cache:
            script.append(took((*SCRIPT, str(urdf))).seconds)
            cold.append(took((*CHECK, str(checked)), cache=cache).seconds)
            warm.append(took((*CHECK, str(checked)), cache=cache).seconds)
    return _median(script), _median(cold), _median(warm)


def _row(name: str, script: float, cold: float, warm: float, imports: float, pinocchio: float) -> None:
    times = "".join(f" {seconds * 1e3:6.0f} ms" for seconds in (script, cold, warm))
    cold_ratio, warm_ratio = cold / imports, warm / pinocchio
    print(
        f"{name:24}{times}   {cold_ratio:6.2f}{'  MISSED' if cold_ratio > 1 else '        '}"
        f"            {warm_ratio:6.2f}{'  MISSED' if warm_ratio > 0.8 else ''}",
        flush=True,
    )


def _median(values: list[float]) -> float:
    return statistics.median(values)
