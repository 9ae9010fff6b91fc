"""Measure the start of the command against an empty Python and against ``import pinocchio``.

``python benchmarks/startup.py [repeats]`` prints medians of whole processes and their ratios. The budgets: ``--help`` under
1.8 and ``rule`` under 2.5 empty Pythons, ``--tier source`` of an unchanged robot with 30 links under one ``import pinocchio``.
"""

from __future__ import annotations

import compileall
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import urdfcheck

LINK = """<link name="link_{i}"><inertial><origin xyz="0 0 0.1"/><mass value="1.2"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.002"/></inertial>
<visual><geometry><cylinder radius="0.04" length="0.2"/></geometry></visual>
<collision><geometry><cylinder radius="0.04" length="0.2"/></geometry></collision></link>
"""
JOINT = """<joint name="joint_{i}" type="revolute"><origin xyz="0 0 0.2"/><parent link="link_{p}"/><child link="link_{i}"/>
<axis xyz="0 1 0"/><limit lower="-1.2" upper="1.3" effort="40" velocity="2"/></joint>
"""


def make_arm(links: int) -> str:
    """Return the URDF of a serial arm."""
    parts = [LINK.format(i=i) for i in range(links)] + [JOINT.format(i=i, p=i - 1) for i in range(1, links)]
    return '<robot name="arm">\n' + "".join(parts) + "</robot>\n"


def measure_seconds(command: list[str], repeats: int) -> float:
    """Return the median wall time of a process."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    # As pip does it for an installed package; an environment may forbid Python to write bytecode.
    compileall.compile_dir(Path(urdfcheck.__file__).parent, quiet=1)
    with tempfile.TemporaryDirectory() as folder:
        arm = Path(folder, "arm.urdf")
        arm.write_text(make_arm(30))
        python = [sys.executable]
        check = [*python, "-m", "urdfcheck"]
        rows = {
            "empty python": [*python, "-c", "pass"],
            "import pinocchio": [*python, "-c", "import pinocchio"],
            "urdfcheck --help": [*check, "--help"],
            "urdfcheck rule": [*check, "rule"],
            "--tier source, 30 links": [*check, "--tier", "source", str(arm)],
            "full, 30 links": [*check, str(arm)],
        }
        for command in rows.values():  # compile and warm the disk cache
            subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        measured = {name: measure_seconds(command, repeats) for name, command in rows.items()}
    print(f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}, median of {repeats}")
    for name, took in measured.items():
        empty, pinocchio = took / measured["empty python"], took / measured["import pinocchio"]
        print(f"{name:26} {took * 1e3:7.0f} ms  {empty:5.1f} × empty python  {pinocchio:5.2f} × import pinocchio")


if __name__ == "__main__":
    main()
