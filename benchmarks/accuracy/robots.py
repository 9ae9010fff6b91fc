"""Sound robots: cars with 4, 6 and 8 wheels, quadrupeds and two-armed torsos, made with a seed, and those of ``fixtures/``."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from injections import Array, Body, rpy_of, six_of, uniform
from parts import FAMILIES, SPLITS, Draw
from trimesh import Trimesh, creation

HERE = Path(__file__).parent
FIXTURES = HERE.parents[1] / "fixtures"
MIRROR = np.diag((1.0, -1.0, 1.0))
# Digits that the files are written with.
_DIGITS = 8
# What limbs are made of: nothing that is its own mirror image.
_LIMBS = ("arm_link", "casting", "finger", "gearbox", "l_bracket", "cam")


@dataclass(frozen=True, eq=False)
class Robot:
    """``root``: its URDF; ``meshes`` to be written beside it. ``groups``: joints that carry like parts in a regular layout;
    ``pairs``: joints of the left and the right side that mirror each other."""

    name: str
    root: ET.Element
    meshes: Mapping[str, Trimesh]
    groups: tuple[tuple[str, ...], ...] = ()
    pairs: tuple[tuple[str, str], ...] = ()


def robots(split: str, seed: int, *, quick: bool) -> Iterator[Robot]:
    """Those that are made, each in several sizes, and those of the fixtures."""
    times = 1 if quick else 4
    for i in range(times):
        draw = Draw(np.random.default_rng((SPLITS.index(split), seed, 7, i)), split)
        for wheels in (4, 6, 8):
            yield car(draw, wheels, f"car_{wheels}_{i}")
        yield quadruped(draw, f"quadruped_{i}")
        yield torso(draw, f"torso_{i}")
    yield from fixtures()


def car(draw: Draw, wheels: int, name: str) -> Robot:
    """Wheels in two rows; those on the right shifted, turned by 180° about z, or mirrored."""
    built = _Builder(name)
    radius = draw.between(0.02, 0.15)
    gap, half = radius * draw.between(2.2, 3.5), radius * draw.between(1.2, 3)
    wheel = _scaled(FAMILIES["wheel"](draw)[0], 2 * radius, _turn("x", -90))
    density, style = draw.between(900, 3000), draw.pick(("shifted", "turned", "mirrored"))
    rows = wheels // 2
    length = gap * rows
    base = creation.box((length, 1.6 * half, draw.between(0.3, 0.8) * radius))
    built.link("base", base, draw.between(300, 1500))
    joints = []
    for i in range(wheels):
        side = 1 if i < rows else -1
        place = np.array((gap * (i % rows - (rows - 1) / 2), side * half, 0.0))
        right = side < 0
        mesh = wheel if not (right and style == "mirrored") else _mirrored(wheel)
        link = f"wheel_{i + 1}"
        built.link(link, mesh, density, file=f"wheel_{side}" if style == "mirrored" else "wheel")
        turned = right and style == "turned"
        joints.append(
            built.joint(
                "base", link, "continuous", place, _turn("z", 180) if turned else np.eye(3), (0, -1 if turned else 1, 0)
            )
        )
    pairs = tuple(zip(joints[:rows], joints[rows:], strict=True)) if style == "mirrored" else ()
    return Robot(name, built.root, built.meshes, (tuple(joints),), pairs)


def quadruped(draw: Draw, name: str) -> Robot:
    """Four legs of three links; the right ones mirror the left ones, the rear ones are the front ones again."""
    built = _Builder(name)
    size = draw.between(0.1, 0.4)
    built.link("trunk", creation.box((2 * size, 0.6 * size, 0.4 * size)), draw.between(300, 900))
    limbs = [_limb(draw, size * draw.between(0.3, 1.0)) for _ in range(3)]
    lows, highs = [-draw.between(0.5, 1) for _ in range(3)], [draw.between(0.6, 1.6) for _ in range(3)]
    density = draw.between(900, 2700)
    places = (np.array((size, 0.3 * size, 0)), np.array((0, 0.3 * size, 0)), np.array((0, 0, -0.9 * size)))
    names = ("hip", "thigh", "calf")
    found: dict[str, list[str]] = {}
    for leg in ("FL", "FR", "RL", "RR"):
        parent, right = "trunk", leg[1] == "R"
        for i in range(3):
            place = places[i] * (-1 if leg[0] == "R" and i == 0 else 1, -1 if right else 1, 1)
            mesh = _mirrored(limbs[i]) if right else limbs[i]
            link = f"{leg}_{names[i]}"
            built.link(link, mesh, density, file=f"{names[i]}_{leg[1]}")
            # About x a mirror turns the sense of rotation over, about y it does not.
            low, high = (-highs[i], -lows[i]) if right and i == 0 else (lows[i], highs[i])
            axis = (1, 0, 0) if i == 0 else (0, 1, 0)
            found.setdefault(names[i], []).append(
                built.joint(parent, link, "revolute", place, np.eye(3), axis, (low, high))
            )
            parent = link
    hips, thighs, calves = found.values()
    pairs = [(four[k], four[k + 1]) for four in (hips, thighs, calves) for k in (0, 2)]
    return Robot(name, built.root, built.meshes, (tuple(hips),), tuple(pairs))


def torso(draw: Draw, name: str) -> Robot:
    """Two arms of four links, frames and parts of the right one mirrored."""
    built = _Builder(name)
    size = draw.between(0.1, 0.5)
    built.link("torso", creation.box((0.5 * size, 0.8 * size, size)), draw.between(300, 900))
    density, links = draw.between(900, 2700), ("shoulder", "upper_arm", "forearm", "hand")
    flipped = draw.chance()
    pairs = []
    parents = {"left": "torso", "right": "torso"}
    for i, part in enumerate(links):
        limb = _limb(draw, size * draw.between(0.3, 0.9))
        place = np.array(
            (0, 0.5 * size, 0.4 * size) if i == 0 else (draw.between(0, 0.1), draw.between(0, 0.1), -0.7 * size)
        )
        turn = _turn("x", draw.pick((0, 0, 30, 90))) @ _turn("z", draw.pick((0, 0, 45)))
        axis = np.array(draw.pick(((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))))
        low, high = -draw.between(0.5, 1.5), draw.between(1.6, 2.8)
        joints = []
        for side in ("left", "right"):
            link, mirror = f"{side}_{part}", np.eye(3) if side == "left" else MIRROR
            built.link(link, limb if side == "left" else _mirrored(limb), density)
            there, limits = mirror @ axis, (low, high)
            # A mirror image turns the other way about the mirrored axis: negated limits, or the axis turned over.
            if side == "right":
                there, limits = (-there, limits) if flipped else (there, (-high, -low))
            joints.append(
                built.joint(parents[side], link, "revolute", mirror @ place, mirror @ turn @ mirror, there, limits)
            )
            parents[side] = link
        pairs.append((joints[0], joints[1]))
    return Robot(name, built.root, built.meshes, (), tuple(pairs))


def fixtures() -> Iterator[Robot]:
    """car-3 with its wheels as they should be, and car-3-fixed, as plain URDF."""
    writer = HERE.parent / "speed" / "urdfs.py"
    sources = {"car-3": "car-3/urdf/car-3.urdf", "car-3-fixed": "car-3-fixed/urdf/car_3.urdf.xacro"}
    with tempfile.TemporaryDirectory() as folder:
        models = [f"{name}={FIXTURES / path}" for name, path in sources.items()]
        subprocess.run([sys.executable, str(writer), folder, *models], check=True)
        for name in sources:
            root = ET.parse(Path(folder) / f"{name}.urdf").getroot()
            wheels = [joint for joint in root.findall("joint") if joint.get("type") == "continuous"]
            for joint in wheels:
                origin = joint.find("origin")
                if name == "car-3" and origin is not None and origin.get("rpy") == "0 -0.75239 0":
                    origin.set("rpy", "0 0 0")
            yield Robot(name, root, {}, (tuple(joint.get("name", "") for joint in wheels),))


class _Builder:
    """Writes a URDF link by link."""

    def __init__(self, name: str) -> None:
        self.root = ET.Element("robot", name=name)
        self.meshes: dict[str, Trimesh] = {}

    def link(self, name: str, mesh: Trimesh, density: float, file: str = "") -> None:
        """A link of uniform density that draws a mesh, which is written to ``file``.stl or a file of the link's name."""
        self.meshes.setdefault(f"{file or name}.stl", mesh)
        link = ET.SubElement(self.root, "link", name=name)
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin")
        ET.SubElement(inertial, "mass")
        ET.SubElement(inertial, "inertia")
        write_body(link, uniform(mesh, density))
        visual = ET.SubElement(link, "visual")
        ET.SubElement(ET.SubElement(visual, "geometry"), "mesh", filename=f"{file or name}.stl")

    def joint(
        self,
        parent: str,
        child: str,
        kind: str,
        place: Array,
        turn: Array,
        axis: Sequence[float],
        limits: tuple[float, float] | None = None,
    ) -> str:
        """A joint, named after its child."""
        name = f"{child}_joint"
        joint = ET.SubElement(self.root, "joint", name=name, type=kind)
        ET.SubElement(joint, "origin", xyz=text(place), rpy=text(rpy_of(turn)))
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=child)
        ET.SubElement(joint, "axis", xyz=text(axis))
        if limits is not None:
            low, high = (f"{value:.4g}" for value in limits)
            ET.SubElement(joint, "limit", lower=low, upper=high, effort="20", velocity="6")
            ET.SubElement(joint, "dynamics", damping="0.1", friction="0.05")
        return name


def write_body(link: ET.Element, body: Body) -> None:
    """Write an inertial in the link's axes."""
    origin, mass, inertia = (link.find(f"inertial/{tag}") for tag in ("origin", "mass", "inertia"))
    assert origin is not None
    assert mass is not None
    assert inertia is not None
    origin.attrib.update(xyz=text(body.com), rpy="0 0 0")
    mass.set("value", text([body.mass]))
    values = text(six_of(body.inertia)).split()
    inertia.attrib.update(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), values, strict=True))


def text(values: Sequence[float] | Array) -> str:
    """Numbers of an attribute; the noise of a computation is written as zero."""
    numbers = np.asarray(values, dtype=float)
    kept = np.where(np.abs(numbers) > 1e-9 * np.abs(numbers).max(initial=0), numbers, 0.0)
    return " ".join(f"{value:.{_DIGITS}g}" for value in kept)


def _limb(draw: Draw, length: float) -> Trimesh:
    """A part that hangs from its joint and is not its own mirror image."""
    mesh = _scaled(FAMILIES[draw.pick(_LIMBS)](draw)[0], length, _turn("y", 90))
    top, centre = mesh.bounds[1], mesh.bounds.mean(axis=0)
    shift = np.array((-centre[0] + 0.1 * length, -centre[1] + 0.15 * length, -top[2] + 0.1 * length))
    return mesh.apply_translation(shift)


def _scaled(mesh: Trimesh, size: float, turn: Array) -> Trimesh:
    """Turned, its largest extent ``size``."""
    placement = np.eye(4)
    placement[:3, :3] = turn * size / float(np.ptp(mesh.bounds, axis=0).max())
    return mesh.apply_transform(placement)


def _mirrored(mesh: Trimesh) -> Trimesh:
    return Trimesh(mesh.vertices @ MIRROR, mesh.faces[:, ::-1], process=False)


def _turn(axis: str, degrees: float) -> Array:
    """(3, 3) rotation about x, y or z."""
    a, b = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.eye(3)
    turn[a, a] = turn[b, b] = c
    turn[b, a], turn[a, b] = s, -s
    return turn
