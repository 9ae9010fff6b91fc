"""Links that draw one box, cylinder or sphere, with the textbook formula of another solid: how often that is named.

Nothing here uses the code of the diagnosis but the diagnosis itself: each formula is written down as a textbook has it.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from injections import Array, Numbers, declared, digits, rotation_of, six_of
from parts import SPLITS

from urdfcheck.facts.inertials.declared_and_drawn import VisualGeometry
from urdfcheck.facts.inertials.diagnosis import Diagnosis, diagnose_inertial
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

# Sizes in m, and densities in kg/m³.
_SIZES, _DENSITIES = (0.005, 0.5), (500.0, 8000.0)
# A formula that changes no moment by more than this has no effect.
_LEAST = 0.15

Formula = Callable[..., tuple[float, float, float]]


def _box(a: float, b: float, c: float) -> tuple[float, float, float]:
    return (b * b + c * c) / 12, (a * a + c * c) / 12, (a * a + b * b) / 12


def _cylinder(r: float, h: float) -> tuple[float, float, float]:
    across = (3 * r * r + h * h) / 12
    return across, across, r * r / 2


def _sphere(r: float) -> tuple[float, float, float]:
    return (2 / 5 * r * r,) * 3


# Of each shape: the right formula first, per kg.
FORMULAS: dict[str, dict[str, Formula]] = {
    "box": {
        "right": _box,
        "edges doubled": lambda a, b, c: _box(2 * a, 2 * b, 2 * c),
        "edges halved": lambda a, b, c: _box(a / 2, b / 2, c / 2),
    },
    "cylinder": {
        "right": _cylinder,
        "sphere": lambda r, _: _sphere(r),
        "hollow sphere": lambda r, _: (2 / 3 * r * r,) * 3,
        "tube": lambda r, h: (r * r / 2 + h * h / 12, r * r / 2 + h * h / 12, r * r),
        "diameter": lambda r, h: _cylinder(2 * r, h),
        "half the radius": lambda r, h: _cylinder(r / 2, h),
        "half the length": lambda r, h: _cylinder(r, h / 2),
        "twice the length": lambda r, h: _cylinder(r, 2 * h),
    },
    "sphere": {
        "right": _sphere,
        "hollow sphere": lambda r: (2 / 3 * r * r,) * 3,
        "diameter": lambda r: _sphere(2 * r),
        "half the radius": lambda r: _sphere(r / 2),
    },
}
# About as often as people leave a number alone: no formula at all.
_OTHERS = ("right", "stretched")


def build_table(split: str, seed: int, number: int) -> str:
    """Count what is named of so many parts."""
    named: Counter[str] = Counter()
    others: Counter[str] = Counter()
    asked: Counter[str] = Counter()
    for index in range(number):
        judged = judge_formula(split, seed, index)
        if judged is None:
            continue
        name, found = judged
        cause = None if found is None else found.cause
        asked[name] += 1
        named[name] += cause == "wrong_formula"
        others[name] += cause not in {None, "wrong_formula"}
    lines = ["", "## Formulas", "", "| formula | cases | named | another cause |", "|---|---|---|---|"]
    lines += [f"| {name} | {asked[name]} | {named[name]} | {others[name]} |" for name in sorted(asked)]
    return "\n".join(lines)


def judge_formula(split: str, seed: int, index: int) -> tuple[str, Diagnosis | None] | None:
    """Return the formula and what is found of the part of this number; None where the formula has no effect."""
    rng = np.random.default_rng((SPLITS.index(split), seed, index, 77))
    kind = ("box", "cylinder", "sphere")[index % 3]
    names = [*FORMULAS[kind], "stretched"]
    name = names[index // 3 % len(names)]
    size = np.exp(rng.uniform(*np.log(_SIZES), size={"box": 3, "cylinder": 2, "sphere": 1}[kind]))
    size = np.array([float(f"{value:.3g}") for value in size])
    right = np.array(FORMULAS[kind]["right"](*size))
    wrong = right * np.exp(rng.uniform(-1.0, 1.0, 3)) if name == "stretched" else np.array(FORMULAS[kind][name](*size))
    if name not in _OTHERS and np.abs(np.log(wrong / right)).max() < _LEAST:
        return None
    rpy = np.array([float(f"{value:.6g}") for value in rng.choice((0.0, np.pi / 2), 3)])
    turn = rotation_of(rpy)
    mass = float(f"{_volume(kind, size) * rng.uniform(*_DENSITIES):.3g}")
    tensor = turn @ np.diag(mass * wrong) @ turn.T
    given = declared(Numbers(mass, np.zeros(3), six_of(tensor), np.zeros(3)), min(digits(rng), int(rng.integers(3, 8))))
    return name, diagnose_inertial(given, _measure(kind, size, rpy))


def _volume(kind: str, size: Array) -> float:
    if kind == "box":
        return float(size.prod())
    return float(np.pi * size[0] ** 2 * size[1] if kind == "cylinder" else 4 / 3 * np.pi * size[0] ** 3)


def _measure(kind: str, size: Array, rpy: Array) -> VisualGeometry | None:
    words = {"box": "size", "cylinder": "radius length", "sphere": "radius"}[kind].split()
    values = [" ".join(map(repr, size.tolist()))] if kind == "box" else list(map(repr, size.tolist()))
    attributes = " ".join(f'{word}="{value}"' for word, value in zip(words, values, strict=True))
    origin = f'<origin xyz="0 0 0" rpy="{" ".join(map(repr, rpy.tolist()))}"/>'
    text = f'<robot name="r"><link name="x"><visual>{origin}<geometry><{kind} {attributes}/></geometry></visual></link></robot>'
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.urdf"
        path.write_text(text, encoding="utf-8")
        source = load_source(path, {}, PackageFinder(path, {}, []))
        assert source.root is not None
        model = Model(source=source, robot=source.root)
        return measure_link_geometry(model, model.link_by_name["x"])
