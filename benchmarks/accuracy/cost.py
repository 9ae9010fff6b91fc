"""What a diagnosis, and all rules about inertia and symmetry, cost per link, against reading the same meshes with trimesh."""

from __future__ import annotations

import io
import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import trimesh
from geometry import drawn
from injections import declared, truth, written
from parts import SPLITS, part
from robots import Robot, robots

from urdfcheck.core import Rule
from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.model import Model
from urdfcheck.rules import has_check, load_check, load_rules
from urdfcheck.run.findings_cache import FindingsCache, is_cacheable
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

LIMIT = 2e-3
_CODES = ("INR", "SYM", "JNT013", "JNT014", "JNT015", "JNT016", "DYN004")
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
            times.append(_least(partial(diagnose_inertial, given, geometry)))
    load = statistics.median(loads)
    lines = ["", "## Cost", "", f"`trimesh.load` and `mass_properties`: {1e3 * load:.2f} ms per part.", ""]
    lines += ["| one diagnosis | ms per link | of reading the mesh | target |", "|---|---|---|---|"]
    for name, times in (("exact", exact), ("lumped", lumped)):
        median = statistics.median(times)
        missed = "" if median < LIMIT else " MISSED"
        lines.append(f"| {name} | {1e3 * median:.2f} | {median / load:.2f} | < 2 ms{missed} |")
    return "\n".join([*lines, *_whole(split, seed)])


def _whole(split: str, seed: int) -> list[str]:
    """The rules on whole robots: medians over robots of the least of five turns, per link."""
    first: list[float] = []
    again: list[float] = []
    loads: list[float] = []
    wanted = [rule for rule in load_rules().values() if rule.code.startswith(_CODES) and has_check(rule)]
    for robot in robots(split, seed, quick=False):
        links = len(robot.root.findall("link"))
        stored = [mesh.export(file_type="stl") for mesh in robot.meshes.values()]
        loads.append(sum(_least(partial(_loaded, data)) for data in stored) / links)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file, mesh in robot.meshes.items():
                mesh.export(folder / file)
            times = [_turn(robot, folder, wanted) for _ in range(_TURNS)]
        first.append(min(cold for cold, _ in times) / links)
        again.append(min(warm for _, warm in times) / links)
    load = statistics.median(loads)
    lines = [
        "",
        f"All {len(wanted)} rules about inertia and symmetry, meshes measured; `trimesh.load` and `mass_properties`:",
    ]
    lines += [
        f"{1e3 * load:.2f} ms per link.",
        "",
        "| rules | ms per link | of reading the meshes | target |",
        "|---|---|---|---|",
    ]
    for name, times_of in (("first time", first), ("nothing has changed", again)):
        median = statistics.median(times_of)
        missed = "" if median < LIMIT else " MISSED"
        lines.append(f"| {name} | {1e3 * median:.2f} | {median / load:.2f} | < 2 ms{missed} |")
    return lines


def _turn(robot: Robot, folder: Path, rules: list[Rule]) -> tuple[float, float]:
    """Seconds for the rules to look at a robot that nothing is known of but its meshes, and to recall what they found."""
    path = folder / "robot.urdf"
    ET.ElementTree(robot.root).write(path)

    def model() -> Model:
        source = load_source(path, {}, PackageFinder(folder, {}, []))
        assert source.root is not None
        made = Model(source=source, robot=source.root, cache=ArrayCache(folder / "kept"))
        for facts in made.meshes.facts.values():
            _ = facts.hull, facts.components, facts.vertices
        return made

    def ask(about: Model) -> float:
        began = time.perf_counter()
        recall = FindingsCache(about)
        for rule in rules:
            options = {name: option.default for name, option in rule.options.items()}
            find = partial(load_check(rule), about, rule, **options)
            _ = recall.recall_findings(rule, options, find) if is_cacheable(rule) else list(find())
        recall.save()
        return time.perf_counter() - began

    cold, warm = ask(model()), ask(model())
    for kind in ("diagnosis", "findings"):  # the meshes stay known
        for file in (folder / "kept" / kind).rglob("*.npz"):
            file.unlink()
    return cold, warm


def _loaded(stored: bytes) -> object:
    return trimesh.load(io.BytesIO(stored), file_type="stl").mass_properties


def _least(call: Callable[[], object]) -> float:
    times = []
    for _ in range(_TURNS):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return min(times)
