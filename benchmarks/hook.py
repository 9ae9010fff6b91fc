"""Measure the pre-commit hook on one changed file whose meshes are cached.

``python benchmarks/hook.py [repeats]`` prints wall and processor time of whole processes and their ratios to an empty Python
(E) and to ``import pinocchio`` (P). It runs the installed command as pre-commit does, in a repository with the robot, and
changes the file before each turn, so that findings for the same text are never reused. The sides take turns. The budget:
0.3 s on an idle machine. ``URDFCHECK_CORPUS`` adds real robots.
"""

from __future__ import annotations

import compileall
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import urdfcheck

FIXTURES = Path(__file__).resolve().parent.parent / "fixtures"
# A robot's name, its folder, the file that is changed there, arguments. The corpus: an arm each with and without yaml files.
OWN = (
    ("car-3, URDF", "car-3", "urdf/car-3.urdf", ()),
    ("car-3, macros", "car-3", "robot_description/urdf/gazebo.urdf.xacro", ()),
    ("car-3, mesh", "car-3", "meshes/wheel_1.STL", ()),
)
CORPUS = (
    ("Panda, xacro", "frankaemika__franka_ros/franka_description", "robots/panda/panda.urdf.xacro", ()),
    (
        "UR20, xacro",
        "UniversalRobots__Universal_Robots_ROS2_Description/ur_description",
        "urdf/ur.urdf.xacro",
        ("--arg", "name:=ur", "--arg", "ur_type:=ur20"),
    ),
)


@dataclass(kw_only=True)
class Side:
    """A command that is measured."""

    command: Sequence[str]
    folder: Path
    """Working directory."""
    changed: Path | None = None
    """The file that is changed before each turn."""
    walls: list[float] = field(default_factory=list)
    """Wall seconds of each turn."""
    processors: list[float] = field(default_factory=list)
    """Processor seconds of each turn."""

    def run_turn(self, number: int, cache: str) -> None:
        """Change the file and run the command once."""
        if self.changed is not None and self.changed.suffix != ".STL":
            text = self.changed.read_text(encoding="utf-8").partition("<!-- turn")[0]
            self.changed.write_text(f"{text}<!-- turn {number} -->\n", encoding="utf-8")
        elif self.changed is not None:
            data = self.changed.read_bytes()
            self.changed.write_bytes(f"turn {number}".ljust(80).encode() + data[80:])  # the header of a binary STL
        environment = {**os.environ, "URDFCHECK_CACHE_DIR": cache}
        before = os.times()
        began = time.perf_counter()
        done = subprocess.run(self.command, cwd=self.folder, env=environment, capture_output=True, check=False)
        self.walls.append(time.perf_counter() - began)
        after = os.times()
        self.processors.append(sum(after[2:4]) - sum(before[2:4]))
        if done.returncode not in (0, 1):
            raise SystemExit(f"{' '.join(self.command)} ended with {done.returncode}:\n{done.stderr.decode()[-2000:]}")


def make_sides(folder: Path) -> Iterable[tuple[str, Side]]:
    """Yield what is compared, each robot in its own repository."""
    script = Path(sys.executable).with_name("urdfcheck")
    command = [str(script)] if script.exists() else [sys.executable, "-m", "urdfcheck"]
    yield "empty python", Side(command=[sys.executable, "-c", "pass"], folder=folder)
    yield "import pinocchio", Side(command=[sys.executable, "-c", "import pinocchio"], folder=folder)
    corpus = os.environ.get("URDFCHECK_CORPUS")
    robots = [(FIXTURES, robot) for robot in OWN] + [(Path(corpus), robot) for robot in CORPUS if corpus]
    for number, (root, (name, robot, changed, arguments)) in enumerate(robots):
        repository = folder / str(number)
        shutil.copytree(root / robot, repository / Path(robot).name)
        subprocess.run(["git", "init", "--quiet", repository], check=True)
        file = Path(Path(robot).name, changed)
        words = [*command, "--allow-empty", *arguments, str(file)]
        yield name, Side(command=words, folder=repository, changed=repository / file)


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    # As pip does it for an installed package; an environment may forbid Python to write bytecode.
    compileall.compile_dir(Path(urdfcheck.__file__).parent, quiet=1)
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as cache:
        compared = dict(make_sides(Path(folder)))
        for number in range(repeats + 1):
            for side in compared.values():
                side.run_turn(number, cache)
    print(f"median of {repeats} turns; least in brackets; E, P: times an empty Python, an import of pinocchio")
    empty, pinocchio = compared["empty python"], compared["import pinocchio"]
    for name, side in compared.items():
        columns = []
        for kind in ("walls", "processors"):
            times = getattr(side, kind)[1:]
            typical = statistics.median(times)
            ratios = [typical / statistics.median(getattr(other, kind)[1:]) for other in (empty, pinocchio)]
            columns.append(f"{typical * 1e3:6.0f} ms ({min(times) * 1e3:5.0f}) {ratios[0]:5.1f} E {ratios[1]:5.2f} P")
        print(f"{name:20} wall {columns[0]}   processor {columns[1]}")


if __name__ == "__main__":
    main()
