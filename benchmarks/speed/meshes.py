"""Mesh facts against trimesh, in one process: load, watertightness, winding and mass properties of the same bytes.

``python meshes.py [--quick]`` prints a table. Both sides get the bytes in memory and start from nothing for each of their
turns, which alternate; garbage is collected before each. The least of the times counts: what else runs on the machine
only adds. Imports do not count here. Where the answers differ, the row says so.
"""

from __future__ import annotations

import argparse
import gc
import io
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from urdfcheck.facts.mesh.measure import measure_mesh

# Name, file type, triangles, written how, times faster as the target (0: none is set).
CASES = (
    ("STL binary, 1M", "stl", 1_000_000, "whole", 5),
    ("STL binary, 100k", "stl", 100_000, "whole", 5),
    ("STL binary, 100k, with holes", "stl", 100_000, "holes", 5),
    ("STL ASCII, 100k", "stl", 100_000, "ascii", 3),
    ("OBJ, 100k", "obj", 100_000, "whole", 3),
    ("DAE, 100k", "dae", 100_000, "whole", 2),
    ("PLY, 100k", "ply", 100_000, "whole", 0),
    ("GLB, 100k", "glb", 100_000, "whole", 0),
    ("OFF, 100k", "off", 100_000, "whole", 0),
)


@dataclass(frozen=True, slots=True)
class Answer:
    """What both sides are asked for. ``volume`` and ``com`` are compared where the mesh is closed."""

    watertight: bool
    consistent: bool
    volume: float
    com: Any
    inertia: Any


def ours(data: bytes, file_type: str) -> Answer:
    facts = measure_mesh(data, file_type)
    return Answer(facts.watertight, facts.winding_consistent, facts.volume, facts.com, facts.covariance)


def theirs(data: bytes, file_type: str) -> Answer:
    mesh = trimesh.load(io.BytesIO(data), file_type=file_type, force="mesh")
    properties = mesh.mass_properties
    return Answer(
        mesh.is_watertight, mesh.is_winding_consistent, properties.volume, properties.center_mass, properties.inertia
    )


def torus(triangles: int, holes: int = 0) -> trimesh.Trimesh:
    """A closed torus of about so many triangles whose tube waves, its corners float32 as files have them; with a row of
    square holes in it."""
    steps = round((triangles / 2) ** 0.5)
    i, j = np.meshgrid(np.arange(steps), np.arange(steps), indexing="ij")
    around, across = 2 * np.pi * i / steps, 2 * np.pi * j / steps
    radius = 0.3 + (0.1 + 0.005 * np.sin(7 * around)) * np.cos(across)
    points = np.stack((radius * np.cos(around), radius * np.sin(around), 0.1 * np.sin(across)), axis=-1)

    def corner(di: int, dj: int) -> Any:
        return (i + di) % steps * steps + (j + dj) % steps

    quads = np.stack((corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)), axis=-1)
    if holes:
        every = steps // holes
        quads = quads[~((i % every < every // 3) & (j < every // 3))]
    quads = quads.reshape(-1, 4)
    faces = np.concatenate((quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]))
    vertices = points.reshape(-1, 3).astype(np.float32).astype(np.float64)
    return trimesh.Trimesh(vertices, faces, process=False)


def file_of(file_type: str, triangles: int, how: str) -> bytes:
    mesh = torus(triangles, holes=20 if how == "holes" else 0)
    made = mesh.export(file_type="stl_ascii" if how == "ascii" else file_type)
    return made.encode() if isinstance(made, str) else made


def least(turns: list[Callable[[], Answer]], repeats: int) -> list[float]:
    """The least time of each, in turn."""
    times = [float("inf")] * len(turns)
    for _ in range(repeats):
        for index, turn in enumerate(turns):
            gc.collect()
            began = time.perf_counter()
            turn()
            times[index] = min(times[index], time.perf_counter() - began)
    return times


def differences(a: Answer, b: Answer) -> Iterator[str]:
    if a.watertight != b.watertight:
        yield "watertight"
    if a.consistent != b.consistent:
        yield "winding"
    # Without a closed surface the integrals depend on where the origin is taken.
    if a.watertight and not np.isclose(a.volume, b.volume, rtol=1e-6):
        yield "volume"
    if a.watertight and not np.allclose(a.com, b.com, atol=1e-6):
        yield "COM"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="no mesh of a million triangles, and two turns each")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    small = torus(200).export(file_type="stl")
    ours(small, "stl"), theirs(small, "stl")  # what loads at the first use
    print(f"{'mesh':30} {'MB':>6} {'trimesh':>10} {'urdfcheck':>10} {'faster':>7}  target")
    for name, file_type, triangles, how, target in CASES:
        if options.quick and triangles > 100_000:
            continue
        data = file_of(file_type, triangles, how)
        a, b = ours(data, file_type), theirs(data, file_type)
        repeats = 2 if options.quick else 5 if triangles > 100_000 else 9
        mine, their = least([lambda: ours(data, file_type), lambda: theirs(data, file_type)], repeats)  # noqa: B023
        ratio = their / mine
        wanted = f">= {target}{'' if ratio >= target else '  MISSED'}" if target else "-"
        differ = ", ".join(differences(a, b))
        print(
            f"{name:30} {len(data) / 1e6:6.1f} {their * 1e3:7.0f} ms {mine * 1e3:7.0f} ms {ratio:6.1f}×  {wanted}"
            + (f"  other answer: {differ}" if differ else ""),
            flush=True,
        )


if __name__ == "__main__":
    main()
