"""One link with a large mesh as a whole process, with an empty cache, against the script: processor time and memory.

A smooth sphere has all of its corners on its convex hull, one with noise a few, a torus half of them, and the part with pins has
thousands on each rim. ``python large_meshes.py NAME FILE`` writes one: a process of its own, so that the one that measures stays
small, whose memory counts for those that it starts.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from process import CHECK, SCRIPT, took

if TYPE_CHECKING:
    import trimesh

MESH = '<geometry><mesh filename="mesh.stl"/></geometry>'
ROBOT = f"""<robot name="r"><link name="base"><inertial><mass value="4"/>
<inertia ixx="0.016" ixy="0" ixz="0" iyy="0.016" iyz="0" izz="0.016"/></inertial>
<visual>{MESH}</visual><collision>{MESH}</collision></link></robot>"""
# Of the sphere; the share of its file that a process may take.
TARGET, MOST_MEMORY = 8, 6


def make_sphere(noise: float = 0.0) -> trimesh.Trimesh:
    """A sphere of 1,310,720 equal triangles, each corner moved in or out."""
    import numpy as np
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=8, radius=0.1)
    ball.vertices *= 1.0 + noise * np.random.default_rng(0).standard_normal((len(ball.vertices), 1))
    return ball


def make_plate() -> trimesh.Trimesh:
    """A part of 288,012 triangles as CAD systems write them: long and thin, with many corners in each plane."""
    import trimesh

    parts = [trimesh.creation.box((0.3, 0.2, 0.02))]
    for x in (-0.1, 0.1):
        for y in (-0.06, 0.06):
            place = trimesh.transformations.translation_matrix((x, y, 0.05))
            parts.append(trimesh.creation.cylinder(0.02, 0.1, sections=18_000, transform=place))
    return trimesh.util.concatenate(parts)


def make_torus() -> trimesh.Trimesh:
    """A closed torus of 1.3 million triangles."""
    from meshes import torus

    return torus(1_300_000)


CASES: dict[str, Callable[[], trimesh.Trimesh]] = {
    "sphere": make_sphere,
    "sphere with noise": lambda: make_sphere(1e-3),
    "torus": make_torus,
    "plate with pins": make_plate,
}
SMALLEST = "plate with pins"


def compare(names: Iterable[str], repeats: int) -> None:
    """Print the table of these meshes; the two sides take turns."""
    print(f"{'mesh':20} {'triangles':>10} {'MB':>6} {'script':>8} {'urdfcheck':>10} {'less':>7}   memory / file")
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            robot, file = Path(folder, "r.urdf"), Path(folder, "mesh.stl")
            robot.write_text(ROBOT, encoding="utf-8")
            subprocess.run([sys.executable, __file__, name, str(file)], check=True)
            script, ours, peaks = [], [], []
            for _ in range(repeats):
                with tempfile.TemporaryDirectory() as cache:
                    script.append(took((*SCRIPT, str(robot))).processor)
                    turn = took((*CHECK, str(robot)), cache=cache)
                    ours.append(turn.processor)
                    peaks.append(turn.peak)
            theirs, mine, size = statistics.median(script), statistics.median(ours), file.stat().st_size
            memory = statistics.median(peaks) * 2**20 / size
            print(
                f"{name:20} {(size - 84) // 50:10,} {size / 1e6:6.1f} {theirs:6.2f} s {mine:8.2f} s {theirs / mine:6.1f}× "
                f"{memory:10.1f}",
                flush=True,
            )
    print(
        f"targets, for the sphere: >= {TARGET} × less processor time, memory at most {MOST_MEMORY} × its file",
        flush=True,
    )


if __name__ == "__main__":
    CASES[sys.argv[1]]().export(sys.argv[2])
