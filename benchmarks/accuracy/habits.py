"""One mistake in all links of a robot, in most of them, or in one alone: how often is it named?

``python benchmarks/accuracy --only habits``. An exporter writes a unit or a convention into all links alike; each robot here is a
chain of parts that differ, with part of the mass in lumps.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from injections import KINDS, Case, Kind, Numbers, declared, digits, truth
from parts import SPLITS, Part, part
from robots import text
from scoring import LEAST_EFFECT, agrees, effect

from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.robot import Model
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

# What programs do to all links of a file alike.
PROGRAM_KINDS = frozenset(
    {
        *(
            "inertia_unit",
            "mass_unit",
            "com_unit",
            "mass_and_inertia_unit",
            "all_units",
            "about_origin",
            "steiner_twice",
        ),
        *(
            "products_sign",
            "positive_notation",
            "axes_permuted",
            "quarter_turn",
            "com_missing",
            "rpy_twice",
        ),
        *("diagonal_first",),
    }
)
# Links of a robot, and how many of them have the mistake: all, two thirds, one, none.
LINKS = 9
SHARES = {"all": 9, "most": 6, "one": 1, "none": 0}
COLUMNS = ("with effect", "found", "named", "wrong cause", "true links named")


def table(split: str, seed: int, *, quick: bool) -> str:
    """Found, named and wrong causes, for each kind of mistake and each share of the links."""
    counts: dict[tuple[str, str], Counter[str]] = {}
    for r in range(1 if quick else 4):
        parts = [part(split, seed, 1000 + LINKS * r + i) for i in range(LINKS)]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for i, made in enumerate(parts):
                made.mesh.export(folder / f"{i}.stl")
            for k, kind in enumerate(KINDS):
                if kind.name in PROGRAM_KINDS:
                    for share, number in SHARES.items():
                        _count(counts, folder, parts, kind, share, number, (SPLITS.index(split), seed, 9, r, k))
    rows = [f"| kind | links | {' | '.join(COLUMNS)} |", "|---|---|" + "---|" * len(COLUMNS)]
    for (kind_name, share), count in counts.items():
        rows.append(f"| {kind_name} | {share} | " + " | ".join(str(count[column]) for column in COLUMNS) + " |")
    for share in SHARES:
        total: Counter[str] = Counter()
        for (_, one), count in counts.items():
            total.update(count if one == share else {})
        rows.append(f"| total | {share} | " + " | ".join(str(total[column]) for column in COLUMNS) + " |")
    return "\n### One mistake in a whole file\n\n" + "\n".join(rows)


def _count(
    counts: dict[tuple[str, str], Counter[str]],
    folder: Path,
    parts: Sequence[Part],
    kind: Kind,
    share: str,
    number: int,
    stream: tuple[int, ...],
) -> None:
    rng = np.random.default_rng(stream)
    fixed = int(rng.integers(1 << 30))  # the same unit in all links
    chosen = set(rng.choice(LINKS, number, replace=False).tolist())
    digit = digits(rng)
    truths = [truth(one, rng, lumped=True) for one in parts]
    principal = bool(rng.random() < 0.5)
    written: list[Numbers] = []
    for i, one in enumerate(parts):
        case = Case(one, truths[i], principal, truths[i].whole)
        numbers = kind.make(case, np.random.default_rng(fixed)) if i in chosen else case.clean
        written.append(case.clean if numbers is None else numbers)
    urdf = folder / "robot.urdf"
    _write(urdf, written, digit)
    source = load_source(urdf, {}, PackageFinder(urdf, {}, []))
    assert source.root is not None
    judged = inertial_diagnoses(Model(source=source, robot=source.root))
    count = counts.setdefault((kind.name, share), Counter())
    for i, true in enumerate(truths):
        found = judged.get(f"link_{i}")
        if found is None:
            continue
        diagnosis, given = found.diagnosis, declared(written[i], digit)
        if effect(true.whole, given) < LEAST_EFFECT:
            count["true links named"] += diagnosis.cause is not None
            continue
        right = diagnosis.cause in kind.names or (diagnosis.mended is not None and agrees(diagnosis.mended, true.whole))
        count["with effect"] += 1
        count["found"] += not diagnosis.sound
        count["named"] += right
        count["wrong cause"] += diagnosis.cause is not None and not right


def _write(urdf: Path, links: Sequence[Numbers], digit: int) -> None:
    root = ET.Element("robot", name="chain")
    for i, numbers in enumerate(links):
        link = ET.SubElement(root, "link", name=f"link_{i}")
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", xyz=text(numbers.com), rpy=text(numbers.rpy))
        ET.SubElement(inertial, "mass", value=f"{numbers.mass:.{digit}g}")
        six = text(numbers.six).split()
        ET.SubElement(inertial, "inertia", dict(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), six, strict=True)))
        geometry = ET.SubElement(ET.SubElement(link, "visual"), "geometry")
        ET.SubElement(geometry, "mesh", filename=f"{i}.stl")
        if i:
            joint = ET.SubElement(root, "joint", name=f"joint_{i}", type="revolute")
            ET.SubElement(joint, "parent", link=f"link_{i - 1}")
            ET.SubElement(joint, "child", link=f"link_{i}")
            ET.SubElement(joint, "limit", lower="-1", upper="1", effort="10", velocity="1")
    ET.ElementTree(root).write(urdf)
