"""One link with a large mesh as a whole process, with an empty cache, against the script: processor time and memory.

A smooth sphere has all of its corners on its convex hull, one with noise a few, a torus half of them, and the part with pins has
thousands on each rim.
"""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import trimesh
from meshes import torus
from process import CHECK, SCRIPT, took

MESH = '<geometry><mesh filename="mesh.stl"/></geometry>'
ROBOT = f"""<robot name="r"><link name="base"><inertial><mass value="4"/>
<inertia ixx="0.016" ixy="0" ixz="0" iyy="0.016" iyz="0" izz="0.016"/></inertial>
<visual>{MESH}</visual><collision>{MESH}</collision></link></robot>"""
# Of the sphere; the share of its file that a process may take.
TARGET, MOST_MEMORY = 8, 6


def sphere(noise: float = 0.0) -> trimesh.Trimesh:
    """A sphere of 1,310,720 equal triangles, each corner moved in or out."""
    ball = trimesh.creation.icosphere(subdivisions=8, radius=0.1)
    ball.vertices *= 1.0 + noise * np.random.default_rng(0).standard_normal((len(ball.vertices), 1))
    return ball


def pins_on_a_plate() -> trimesh.Trimesh:
    """A part of 288,012 triangles as CAD systems write them: long and thin, with many corners in each plane."""
    parts = [trimesh.creation.box((0.3, 0.2, 0.02))]
    for x in (-0.1, 0.1):
        for y in (-0.06, 0.06):
            place = trimesh.transformations.translation_matrix((x, y, 0.05))
            parts.append(trimesh.creation.cylinder(0.02, 0.1, sections=18_000, transform=place))
    return trimesh.util.concatenate(parts)


CASES: dict[str, Callable[[], trimesh.Trimesh]] = {
    "sphere": sphere,
    "sphere with noise": lambda: sphere(1e-3),
    "torus": lambda: torus(1_300_000),
    "plate with pins": pins_on_a_plate,
}
SMALLEST = "plate with pins"


def compare(names: Iterable[str], repeats: int) -> None:
    """Print the table of these meshes; the two sides take turns."""
    print(f"{'mesh':20} {'triangles':>10} {'MB':>6} {'script':>8} {'urdfcheck':>10} {'less':>7}   memory / file")
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            robot, file, mesh = Path(folder, "r.urdf"), Path(folder, "mesh.stl"), CASES[name]()
            robot.write_text(ROBOT, encoding="utf-8")
            mesh.export(file)
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
                f"{name:20} {len(mesh.faces):10,} {size / 1e6:6.1f} {theirs:6.2f} s {mine:8.2f} s {theirs / mine:6.1f}× "
                f"{memory:10.1f}",
                flush=True,
            )
    print(
        f"targets, for the sphere: >= {TARGET} × less processor time, memory at most {MOST_MEMORY} × its file",
        flush=True,
    )
