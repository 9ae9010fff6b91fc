"""What a diagnosis costs, against reading the same mesh with trimesh in the same run."""

from __future__ import annotations

import io
import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import trimesh
from geometry import drawn
from injections import declared, truth, written
from parts import SPLITS, part

from urdfcheck.facts.diagnosis import diagnose

LIMIT = 2e-3
_TURNS = 5


def table(split: str, seed: int, number: int) -> str:
    """Milliseconds per link, medians over parts of the least of five turns each."""
    loads: list[float] = []
    exact: list[float] = []
    lumped: list[float] = []
    for index in range(number):
        made = part(split, seed, index)
        rng = np.random.default_rng((SPLITS.index(split), seed, index))
        geometry = drawn(made)[1.0]
        stored = made.mesh.export(file_type="stl")
        loads.append(_least(partial(_loaded, stored)))
        for times, uneven in ((exact, False), (lumped, True)):
            given = declared(written(truth(made, rng, lumped=uneven).whole, principal=False), 7)
            times.append(_least(partial(diagnose, given, geometry)))
    load = statistics.median(loads)
    lines = ["", "## Cost", "", f"`trimesh.load` and `mass_properties`: {1e3 * load:.2f} ms per part.", ""]
    lines += ["| one diagnosis | ms per link | of reading the mesh | target |", "|---|---|---|---|"]
    for name, times in (("exact", exact), ("lumped", lumped)):
        median = statistics.median(times)
        missed = "" if median < LIMIT else " MISSED"
        lines.append(f"| {name} | {1e3 * median:.2f} | {median / load:.2f} | < 2 ms{missed} |")
    return "\n".join(lines)


def _loaded(stored: bytes) -> object:
    return trimesh.load(io.BytesIO(stored), file_type="stl").mass_properties


def _least(call: Callable[[], object]) -> float:
    times = []
    for _ in range(_TURNS):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return min(times)
