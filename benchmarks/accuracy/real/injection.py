"""Defects made in one robot, checked with its meshes and without."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from injections import Body, Numbers, Rng, rotation_of, tensor_of
from scoring import LEAST_EFFECT, effect

from real.changes import Change, Part, ReadRobot, Texts, read_numbers, read_robot
from real.evidence import (
    find_inertial_evidence,
    find_joint_evidence,
    find_reversal_evidence,
    find_shape_evidence,
    find_size_evidence,
    find_zero_evidence,
    is_zero_of_hinge,
)
from real.kinds import Broken, Kind
from real.robots import RealRobot, check_robot
from real.verdicts import Key, Verdict, find_new, judge, list_keys
from urdfcheck.core import Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial

MESHES = (
    "*.stl",
    "*.STL",
    "*.dae",
    "*.DAE",
    "*.obj",
    "*.OBJ",
    "*.ply",
    "*.PLY",
    "*.glb",
    "*.gltf",
    "*.mtl",
    "*.png",
    "*.jpg",
)
# Whatever kind it is, so many links are tried.
_TRIES = 8


@dataclass(slots=True, kw_only=True)
class Case:
    """A defect and what became of it."""

    kind: str
    robot: str
    subject: str
    """The broken link or joint."""
    has_meshes: bool
    evidence: tuple[str, ...]
    """What shows it; empty: nothing that this benchmark knows of."""
    shows_cause: bool = True
    """Whether the file also shows which defect it is: a twin, a drawing that the sound numbers fit well, or the text itself. A
    bound (the robot's length, the hull, the densest material) does not: several defects exceed it alike."""
    verdict: Verdict = field(default_factory=Verdict)
    seconds: float = 0.0
    """Processor time of the check, and that of the sound robot."""
    sound_seconds: float = 0.0
    links: int = 0


@dataclass(frozen=True, eq=False)
class _Stage:
    """A robot as it is on the disk, with its meshes or without, and what is said of it when nothing is broken."""

    read: ReadRobot
    said: Mapping[Key, Severity]
    seconds: float
    has_meshes: bool


def inject(robot: RealRobot, kinds: Sequence[Kind], count: int, seed: tuple[int, int]) -> list[Case]:
    """Make ``count`` defects in a robot, of the first kinds that it can have."""
    cases: list[Case] = []
    with tempfile.TemporaryDirectory() as name:
        stages = _prepare(robot, Path(name))
        if not stages:
            return []
        made = 0
        for kind in kinds:
            rng = np.random.default_rng((*seed, *kind.name.encode()))
            found = _break(stages, kind, rng)
            cases += found
            made += bool(found)
            if made == count:
                break
    return cases


def _prepare(robot: RealRobot, folder: Path) -> list[_Stage]:
    stages = []
    for candidate, has_meshes in ((robot, True), (take_meshes_away(robot, folder), False)):
        read = None if candidate is None else read_robot(candidate)
        if read is None or len(read.model.links) < 2:
            continue
        check_robot(read.robot)  # measures the meshes
        start = time.process_time()
        run = check_robot(read.robot, read.apply([_blank(read)]))
        seconds = time.process_time() - start
        if run.failures or not run.models or run.models[0].status != "checked":
            return []
        stages.append(_Stage(read, list_keys(run), seconds, has_meshes))
    return stages


def _blank(read: ReadRobot) -> Change:
    """A blank at the end of the file, which changes nothing but the file."""
    file = next(iter(read.source.files.values()))
    end = len(file.text)
    return Change(file.make_span(end, end), "\n")


def take_meshes_away(robot: RealRobot, folder: Path) -> RealRobot | None:
    """Copy a robot without its meshes into an empty folder; None if it has no packages to copy."""
    roots = [root.resolve() for root in robot.package_roots] or [robot.entry.resolve().parent]
    outermost = [root for root in roots if not any(other in root.parents for other in roots)]
    moved: dict[Path, Path] = {}
    for number, root in enumerate(dict.fromkeys(outermost)):
        # What is looked up by the name of its folder keeps that name.
        target = folder / str(number) / root.name
        shutil.copytree(
            root, target, ignore=shutil.ignore_patterns(".git", *MESHES), symlinks=False, ignore_dangling_symlinks=True
        )
        moved[root] = target

    def move(path: Path) -> Path | None:
        path = path.resolve()
        return next(
            (target / path.relative_to(root) for root, target in moved.items() if path.is_relative_to(root)), None
        )

    entry, package_roots = move(robot.entry), [move(root) for root in robot.package_roots]
    if entry is None:
        return None
    return replace(robot, entry=entry, package_roots=tuple(root for root in package_roots if root is not None))


def _break(stages: Sequence[_Stage], kind: Kind, rng: Rng) -> list[Case]:
    """Make one defect of a kind; nothing if the robot cannot have it."""
    first = stages[0]
    parts = list(first.read.parts)
    order = [int(i) for i in rng.permutation(len(parts))]
    if kind.habit:
        return _break_all(stages, kind, order, rng)
    tried = 0
    for index in order:
        state = rng.bit_generator.state
        made = _make(kind, parts[index], rng)
        if made is None or not _is_sound(first, parts[index], kind):
            continue
        if kind.family == "inertial" and _is_mass_doubted(first):
            return []
        tried += 1
        if tried > _TRIES:
            break
        cases = []
        for stage in stages if kind.family in ("inertial", "joint") else stages[:1]:
            rng.bit_generator.state = state
            part = stage.read.parts[index]
            broken = _make(kind, part, rng)
            if broken is None:
                continue
            labels = set(part.subjects)
            for change in broken.changes:
                labels |= stage.read.list_subjects(change.span)
            evidence = _find_evidence(stage, kind, part, broken)
            cases.append(_check(stage, kind, broken.changes, broken.says, part.link.name, labels, evidence))
        if cases:
            return cases
    return []


def _break_all(stages: Sequence[_Stage], kind: Kind, order: Sequence[int], rng: Rng) -> list[Case]:
    """Make the same defect in all links that can have it: three at least, and most of those with numbers."""
    cases = []
    state = rng.bit_generator.state
    first = stages[0]
    for stage in stages if kind.family == "inertial" else stages[:1]:
        changes: dict[tuple[str, int], Change] = {}
        labels: set[str] = set()
        says, makeable, sound, evidence = "", 0, 0, set()
        for index in order:
            part = stage.read.parts[index]
            rng.bit_generator.state = state  # the same unit everywhere
            broken = _make(kind, part, rng)
            if broken is None:
                continue
            makeable += 1
            says = says or broken.says
            for change in broken.changes:
                changes[change.span.file, change.span.start] = change
                labels |= stage.read.list_subjects(change.span)
            if _is_sound(first, part, kind):
                sound += 1
                evidence |= _find_evidence(stage, kind, part, broken) - {"twin"}
        if makeable < 3 or 2 * makeable < sum(p.numbers is not None for p in stage.read.parts):
            continue
        if 3 * sound < 2 * makeable or _is_mass_doubted(first):
            continue  # a robot that is wrong already
        subject = f"{makeable} links"
        cases.append(_check(stage, kind, list(changes.values()), says, subject, labels, evidence))
    return cases


def _make(kind: Kind, part: Part, rng: Rng) -> Broken | None:
    if kind.family == "inertial" and part.numbers is None:
        return None
    made = kind.make(part, rng)
    if made is None:
        return None
    broken = made if isinstance(made, Broken) else Broken(made)
    if kind.family != "inertial":
        return broken
    assert part.numbers is not None
    return broken if _measure_effect(part, broken) >= LEAST_EFFECT else None


def _measure_effect(part: Part, broken: Broken) -> float:
    """How far the new numbers are from the old ones; infinite for what no body has."""
    old, new = part.numbers, _read_new(part, broken)
    assert old is not None
    tensor = rotation_of(old.rpy) @ tensor_of(old.six) @ rotation_of(old.rpy).T
    with np.errstate(all="ignore"):
        if np.linalg.eigvalsh(tensor)[0] <= 0:
            return 0.0
        return effect(
            Body(old.mass, old.com, tensor),
            DeclaredInertial(mass=new.mass, com=new.com, tensor=tensor_of(new.six), rotation=rotation_of(new.rpy)),
        )


def _read_new(part: Part, broken: Broken) -> Numbers:
    """The numbers of the inertial with the changes."""
    old, inertial = part.numbers, part.link.inertial
    assert old is not None
    assert inertial is not None
    assert inertial.tensor_element is not None
    texts = {(change.span.file, change.span.start): change.text for change in broken.changes}

    def value(element: object, name: str) -> list[float] | None:
        attribute = getattr(element, "attributes", {}).get(name)
        if attribute is None or attribute.span is None:
            return None
        text = texts.get((attribute.span.file, attribute.span.start))
        return None if text is None else [float(word) for word in text.split()]

    mass = value(inertial.element.find_child("mass"), "value")
    com = value(inertial.origin.element, "xyz")
    six = [value(inertial.tensor_element, name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")]
    return Numbers(
        old.mass if mass is None else mass[0],
        old.com if com is None else np.array(com),
        np.array([was if now is None else now[0] for was, now in zip(old.six, six, strict=True)]),
        old.rpy,
    )


_FAMILIES = {
    "inertial": ("INR", "SYM003", "SYM004"),
    "joint": ("JNT", "SYM", "KIN"),
    "limits": ("JNT", "SYM004", "DYN"),
}


def _is_sound(stage: _Stage, part: Part, kind: Kind) -> bool:
    """Whether nothing is said at warning or above, about what will be broken."""
    codes = _FAMILIES.get(kind.family, ("GEO", "MSH", "PKG", "KIN", "COL", "JNT009"))
    return not any(
        severity >= Severity.WARNING and key[0].startswith(codes) and key[3].startswith(tuple(part.subjects))
        for key, severity in stage.said.items()
    )


def _is_mass_doubted(stage: _Stage) -> bool:
    """Whether the mass of the whole robot is said to be impossible."""
    return any(key[0] == "INR015" and severity >= Severity.WARNING for key, severity in stage.said.items())


def _find_evidence(stage: _Stage, kind: Kind, part: Part, broken: Broken) -> set[str]:
    shared = set().union(*(stage.read.list_subjects(change.span) for change in broken.changes))
    if kind.family == "inertial":
        return find_inertial_evidence(part, _read_new(part, broken), with_meshes=stage.has_meshes, shared=shared)
    if kind.make.__name__ in ("effort_zero", "velocity_zero"):
        return find_zero_evidence(part, kind.make.__name__.removesuffix("_zero"), shared)
    if kind.make.__name__ == "axis_reversed":
        return find_reversal_evidence(part, shared)
    if kind.make.__name__ == "joint_rpy_degrees":
        # Less than a turn may be meant in radians.
        return {"text"} if max(abs(float(word)) for word in broken.changes[0].text.split()) > 2 * np.pi else set()
    if kind.family == "joint" and kind.make.__name__ != "axis_zero":
        change = broken.changes[0]
        new = np.array([float(word) for word in change.text.split()])
        assert part.joint is not None
        old = read_numbers(part.joint.element.find_child("origin"), "xyz")
        is_place = kind.make.__name__.startswith("joint_xyz")
        if kind.make.__name__ == "joint_rpy_off" and is_zero_of_hinge(part, new):
            return set()
        return find_joint_evidence(part, np.zeros(3) if old is None else old, new if is_place else np.zeros(3), shared)
    if kind.make.__name__ in ("limits_mirrored", "effort_tiny", "mimic_multiplier"):
        return find_joint_evidence(part, np.zeros(3), np.zeros(3), shared)
    if kind.make.__name__ == "limits_degrees":
        values = [abs(float(word)) for change in broken.changes for word in change.text.split()]
        # A range of many turns means "no limit", in either unit.
        return {"size"} if 4 * np.pi < max(values) < 4 * np.pi * 180 / np.pi else set()
    if kind.make.__name__ == "collision_shifted":
        start = broken.changes[0].span.start
        shapes = [
            s for s in part.link.collisions if (a := s.origin.get_attribute("xyz")) and a.span and a.span.start == start
        ]
        new = np.array([float(word) for word in broken.changes[0].text.split()])
        return find_shape_evidence(part, shapes[0], float(np.linalg.norm(new - (shapes[0].origin.xyz or (0, 0, 0)))))
    if kind.make.__name__ == "collision_size":
        return find_size_evidence(part, shared)
    if kind.make.__name__ in ("mesh_typo", "mesh_case", "mesh_scale"):
        # The file must be there to be missed.
        return (
            {"text"}
            if any(part.owner.model.meshes.get_facts(shape) is not None for shape in part.link.visuals)
            else set()
        )
    return {"text"}


def _check(
    stage: _Stage, kind: Kind, changes: list[Change], says: str, subject: str, labels: set[str], evidence: set[str]
) -> Case:
    texts: Texts = stage.read.apply(changes)
    start = time.process_time()
    run = check_robot(stage.read.robot, texts)
    seconds = time.process_time() - start
    if kind.habit:
        labels = labels | {f"robot[{stage.read.model.name}]"}
    verdict = judge(kind, says, labels, stage.read, texts, find_new(stage.said, run))
    return Case(
        kind=kind.name,
        robot=stage.read.robot.name,
        subject=subject,
        has_meshes=stage.has_meshes,
        evidence=tuple(sorted(evidence)),
        shows_cause=(kind.family != "inertial" and not kind.needs_twin)
        or kind.shows_itself
        or bool(evidence & {"twin", "near"}),
        verdict=verdict,
        seconds=seconds,
        sound_seconds=stage.seconds,
        links=len(stage.read.model.links),
    )
