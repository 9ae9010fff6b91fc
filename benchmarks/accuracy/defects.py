"""One defect at a time in whole robots: is the odd one found, and is it the one that is named?"""

from __future__ import annotations

import copy
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from injections import Array, Body, Rng, rotation_of, rpy_of, tensor_of
from parts import SPLITS
from robots import Robot, robots, text, write_body
from scoring import LEAST_EFFECT, effect

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run

# The rules that a defect of a frame, of an inertial or of limits may be told by: one defect is one finding.
_FRAME = frozenset({"SYM001", "SYM002", "SYM004"})
_INERTIAL = frozenset({"SYM003", "SYM004", "INR010", *(f"INR00{n}" for n in range(2, 10))})
_LIMITS = frozenset({"SYM004"})
_ALL = _FRAME | _INERTIAL


@dataclass(frozen=True, eq=False)
class Target:
    """A joint and its child in a robot that is about to be broken; ``twin`` mirrors them."""

    root: ET.Element
    joint: ET.Element
    link: ET.Element
    twin: tuple[ET.Element, ET.Element] | None = None

    @property
    def names(self) -> tuple[str, str]:
        return self.joint.get("name", ""), self.link.get("name", "")


Break = Callable[[Target, Rng], bool]


def table(split: str, seed: int, *, quick: bool) -> str:
    """Recall and false names, for each kind of defect."""
    counts: Counter[tuple[str, str]] = Counter()
    examples: list[str] = []
    clean, clean_findings = 0, []
    for r, robot in enumerate(robots(split, seed, quick=quick)):
        clean += 1
        told = [f for f in _findings(robot, robot.root) if f.severity >= Severity.WARNING]
        clean_findings += [f"{robot.name}: {f.code} {f.location.subject}" for f in told]
        rng = np.random.default_rng((SPLITS.index(split), seed, 8, r))
        for defect, target, codes in _cases(robot, rng, 1 if quick else 2):
            name = defect.__name__
            if not defect(target, rng):
                counts[name, "no effect"] += 1
                continue
            found = _findings(robot, target.root)
            verdict = _verdict(found, target, codes)
            counts[name, "cases"] += 1
            counts[name, verdict] += 1
            others = [f for f in found if f.severity >= Severity.WARNING and not _involves(f, target)]
            counts[name, "others"] += bool(others)
            if others or verdict in {"info", "silent"}:
                texts = "; ".join(f"{f.code} {f.message_id} {f.severity} {f.location.subject}" for f in found)
                examples.append(f"* `{name}` of {target.names[0]} in {robot.name}: {texts or 'nothing'}")
    return _table(counts, examples, clean, clean_findings)


def _cases(robot: Robot, rng: Rng, times: int) -> Iterator[tuple[Break, Target, frozenset[str]]]:
    for group in robot.groups:
        for defect, codes in ODD.items():
            for name in rng.choice(group, min(times, len(group)), replace=False):
                yield defect, _target(robot, str(name), None), codes
    for defect, codes in MIRRORED.items():
        for i in rng.choice(len(robot.pairs), min(times, len(robot.pairs)), replace=False) if robot.pairs else ():
            one, other = robot.pairs[i] if rng.random() < 0.5 else robot.pairs[i][::-1]
            yield defect, _target(robot, one, other), codes


def _target(robot: Robot, joint: str, twin: str | None) -> Target:
    root = copy.deepcopy(robot.root)
    joints = {element.get("name"): element for element in root.findall("joint")}
    links = {element.get("name"): element for element in root.findall("link")}

    def both(name: str) -> tuple[ET.Element, ET.Element]:
        child = joints[name].find("child")
        assert child is not None
        return joints[name], links[child.get("link")]

    return Target(root, *both(joint), None if twin is None else both(twin))


def _findings(robot: Robot, root: ET.Element) -> list[Finding]:
    """What the rules about inertia and symmetry say."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / ".git").mkdir()
        for file, mesh in robot.meshes.items():
            mesh.export(folder / file)
        urdf = folder / "robot.urdf"
        ET.ElementTree(root).write(urdf)
        codes = frozenset(c for c in load_rules() if c.startswith(("INR", "SYM", "MSH")))
        found = run(Request(paths=(urdf,), root=folder, policy=Policy(codes=codes)), IN_THIS_PROCESS)
    return [f for f in found.findings if f.code in _ALL]


def _verdict(found: list[Finding], target: Target, codes: frozenset[str]) -> str:
    """``named``: a finding stands at the broken joint or link; ``pair``: one names it beside its twin; ``info``: either as an
    info only; or ``silent``."""
    about = [f for f in found if f.code in codes and _involves(f, target)]
    grave = [f for f in about if f.severity >= Severity.WARNING]
    if any(_at(f, target) and "pair" not in f.message_id for f in grave):
        return "named"
    return "pair" if grave else "info" if about else "silent"


def _at(finding: Finding, target: Target) -> bool:
    joint, link = target.names
    return any(f"joint[{joint}]" in s or f"link[{link}]" in s for s in finding.subjects)


def _involves(finding: Finding, target: Target) -> bool:
    words = (
        finding.message.replace(",", " ")
        .replace(";", " ")
        .replace(":", " ")
        .replace("(", " ")
        .replace(")", " ")
        .split()
    )
    return _at(finding, target) or any(name in words for name in target.names)


def _table(counts: Counter[tuple[str, str]], examples: list[str], clean: int, clean_findings: list[str]) -> str:
    lines = [
        "", "## Whole robots", "",
        "| defect | cases | no effect | named | named as one of a pair | as an info | silent | another is named |",
        "|---|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    columns = ("cases", "no effect", "named", "pair", "info", "silent", "others")
    for name in (f.__name__ for f in (*ODD, *MIRRORED)):
        lines.append(f"| `{name}` | {' | '.join(str(counts[name, column]) for column in columns)} |")
    totals = [sum(n for (_, c), n in counts.items() if c == column) for column in columns]
    lines.append(f"| all | {' | '.join(map(str, totals))} |")
    lines += ["", f"Findings in the {clean} sound robots: {len(clean_findings)}."]
    lines += [f"* {text}" for text in clean_findings]
    return "\n".join(
        [*lines, "", "<details><summary>An info, silent, or another is named</summary>", "", *examples, "</details>"]
    )


# -- reading and writing -------------------------------------------------------------------------------------------


def _numbers(element: ET.Element | None, name: str) -> Array:
    """Those of an attribute; zeros when it is not there."""
    found = None if element is None else element.get(name)
    return np.zeros(3) if found is None else np.array([float(word) for word in found.split()])


def _origin(joint: ET.Element) -> ET.Element:
    origin = joint.find("origin")
    return ET.SubElement(joint, "origin") if origin is None else origin


def _body(link: ET.Element) -> Body:
    mass, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
    assert mass is not None
    assert inertia is not None
    origin = link.find("inertial/origin")
    six = np.array([float(inertia.get(name, "0")) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")])
    turn = rotation_of(_numbers(origin, "rpy"))
    return Body(float(mass.get("value", "0")), _numbers(origin, "xyz"), turn @ tensor_of(six) @ turn.T)


def _replace(link: ET.Element, body: Body) -> bool:
    """Write a body in a link; False where that has no effect."""
    if effect(_body(link), DeclaredInertial(body.mass, body.com, body.inertia)) < LEAST_EFFECT:
        return False
    write_body(link, body)
    return True


def _direction(rng: Rng) -> Array:
    vector = rng.normal(size=3)
    unit: Array = vector / np.linalg.norm(vector)
    return unit


def _turned(target: Target, axis: Array, degrees: float) -> bool:
    origin = _origin(target.joint)
    x, y, z = axis
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
    angle = np.radians(degrees)
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    origin.set("rpy", text(rpy_of(rotation_of(_numbers(origin, "rpy")) @ turn)))
    return True


def _moved(target: Target, rng: Rng, low: float, high: float) -> bool:
    """By a share of the distance between joints of its kind, away from its axis."""
    axis = _numbers(target.joint.find("axis"), "xyz")
    origin = _origin(target.joint)
    place = _numbers(origin, "xyz")
    away = np.cross(rotation_of(_numbers(origin, "rpy")) @ axis, _direction(rng))
    distance = float(np.linalg.norm(place)) or 0.1
    origin.set("xyz", text(place + away / np.linalg.norm(away) * distance * rng.uniform(low, high)))
    return True


# -- defects of one of several like parts --------------------------------------------------------------------------


def zero_shifted(target: Target, rng: Rng) -> bool:
    """Turned by 3 to 170° about its own axis."""
    axis = _numbers(target.joint.find("axis"), "xyz")
    return _turned(target, axis / np.linalg.norm(axis), rng.uniform(3, 170) * rng.choice((-1, 1)))


def axis_tilted(target: Target, rng: Rng) -> bool:
    """Its axis tilted by 1 to 15°."""
    axis = _numbers(target.joint.find("axis"), "xyz")
    across = np.cross(axis, _direction(rng))
    return _turned(target, across / np.linalg.norm(across), rng.uniform(1, 15))


def misplaced(target: Target, rng: Rng) -> bool:
    """0.5 to 5 % of its distance from the middle beside its place."""
    return _moved(target, rng, 0.005, 0.05)


def mass_differs(target: Target, rng: Rng) -> bool:
    """10 to 100 % heavier or lighter, the tensor as it was."""
    body = _body(target.link)
    write_body(target.link, Body(body.mass * rng.uniform(1.1, 2) ** rng.choice((-1, 1)), body.com, body.inertia))
    return True


def com_differs(target: Target, rng: Rng) -> bool:
    """The COM off by 15 to 40 % of the radius of gyration."""
    body = _body(target.link)
    reach = np.sqrt(np.trace(body.inertia) / (2 * body.mass)) * rng.uniform(0.15, 0.4)
    write_body(target.link, Body(body.mass, body.com + reach * _direction(rng), body.inertia))
    return True


def tensor_differs(target: Target, rng: Rng) -> bool:
    """The tensor 1.2 to 3 times too large or too small."""
    body = _body(target.link)
    write_body(target.link, Body(body.mass, body.com, body.inertia * rng.uniform(1.2, 3) ** rng.choice((-1, 1))))
    return True


def tensor_unit(target: Target, rng: Rng) -> bool:
    """The tensor in g m², kg cm² or kg mm²."""
    body = _body(target.link)
    write_body(target.link, Body(body.mass, body.com, body.inertia * rng.choice((1e3, 1e4, 1e6))))
    return True


def placeholder(target: Target, rng: Rng) -> bool:
    """1, 2 or 5 times a power of ten on the diagonal."""
    body = _body(target.link)
    value = float(rng.choice((1, 2, 5))) * 10.0 ** rng.integers(-6, 1)
    return _replace(target.link, Body(body.mass, body.com, value * np.eye(3)))


def copied(target: Target, rng: Rng) -> bool:
    """The inertial of the robot's first link."""
    first = target.root.find("link[inertial]")
    return first is not None and _replace(target.link, _body(first))


def density(target: Target, rng: Rng) -> bool:
    """Mass and tensor 100 to 10,000 times too large."""
    body = _body(target.link)
    factor = 10.0 ** rng.uniform(2, 4)
    write_body(target.link, Body(body.mass * factor, body.com, body.inertia * factor))
    return True


# -- defects of one of two mirror images ---------------------------------------------------------------------------


def pair_mass(target: Target, rng: Rng) -> bool:
    """As `mass_differs`."""
    return mass_differs(target, rng)


def pair_com(target: Target, rng: Rng) -> bool:
    """As `com_differs`."""
    return com_differs(target, rng)


def com_copied(target: Target, rng: Rng) -> bool:
    """The twin's COM as it stands, the tensor mirrored."""
    body = _body(target.link)
    return _replace(target.link, Body(body.mass, _twin(target).com, body.inertia))


def tensor_copied(target: Target, rng: Rng) -> bool:
    """The twin's tensor as it stands, the COM mirrored."""
    body = _body(target.link)
    return _replace(target.link, Body(body.mass, body.com, _twin(target).inertia))


def inertial_copied(target: Target, rng: Rng) -> bool:
    """The twin's inertial as it stands."""
    return _replace(target.link, _twin(target))


def products_flipped(target: Target, rng: Rng) -> bool:
    """All products with the wrong sign."""
    body = _body(target.link)
    return _replace(target.link, Body(body.mass, body.com, 2 * np.diag(np.diag(body.inertia)) - body.inertia))


def limits_copied(target: Target, rng: Rng) -> bool:
    """The twin's limits as they stand, where the mirrored ones are others."""
    assert target.twin is not None
    mine, there = target.joint.find("limit"), target.twin[0].find("limit")
    if mine is None or there is None or mine.get("lower") == there.get("lower"):
        return False
    mine.attrib.update(lower=there.get("lower", ""), upper=there.get("upper", ""))
    return True


def effort_differs(target: Target, rng: Rng) -> bool:
    """Half or twice the effort."""
    limit = target.joint.find("limit")
    if limit is None:
        return False
    limit.set("effort", text([float(limit.get("effort", "0")) * rng.choice((0.5, 2))]))
    return True


def pair_misplaced(target: Target, rng: Rng) -> bool:
    """1 to 5 % of its distance from its parent beside its place."""
    return _moved(target, rng, 0.01, 0.05)


def pair_tilted(target: Target, rng: Rng) -> bool:
    """As `axis_tilted`."""
    return axis_tilted(target, rng)


def _twin(target: Target) -> Body:
    assert target.twin is not None
    return _body(target.twin[1])


ODD: dict[Break, frozenset[str]] = {
    zero_shifted: _FRAME,
    axis_tilted: _FRAME,
    misplaced: _FRAME,
    mass_differs: _INERTIAL,
    com_differs: _INERTIAL,
    tensor_differs: _INERTIAL,
    tensor_unit: _INERTIAL,
    placeholder: _INERTIAL,
    copied: _INERTIAL,
    density: _INERTIAL,
}
MIRRORED: dict[Break, frozenset[str]] = {
    pair_mass: _INERTIAL,
    pair_com: _INERTIAL,
    com_copied: _INERTIAL,
    tensor_copied: _INERTIAL,
    inertial_copied: _INERTIAL,
    products_flipped: _INERTIAL,
    limits_copied: _LIMITS,
    effort_differs: _LIMITS,
    pair_misplaced: _FRAME,
    pair_tilted: _FRAME,
}
