"""CAD-like parts, made with a seed: closed meshes in metres, each in a link frame of its own.

A part of the split ``tuning`` and one of ``scored`` never agree: their random streams differ, and every length comes from
other intervals (see `Draw.between`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh import Trimesh
from trimesh import creation as make

Array = NDArray[np.float64]
T = TypeVar("T")

SPLITS = ("tuning", "scored")
# Longest edge of the bounding box (m): from a bush to a crane's boom.
SIZES = (0.008, 1.5)
# Intervals that every range of a length is cut into; the two splits take them by turns.
_CELLS = 16
_ROUND = 32


@dataclass(frozen=True, eq=False)
class Part:
    """``pieces``: closed meshes in the link's frame (m) that do not overlap; one, unless the part is an assembly."""

    name: str
    family: str
    pieces: tuple[Trimesh, ...]

    @property
    def mesh(self) -> Trimesh:
        """All pieces as one."""
        return trimesh.util.concatenate(list(self.pieces))


class Draw:
    """Random numbers of one part."""

    def __init__(self, rng: np.random.Generator, split: str) -> None:
        self._rng = rng
        self._offset = SPLITS.index(split)

    def between(self, low: float, high: float) -> float:
        """Evenly from the intervals of ``[low, high]`` that belong to the split: every other one of 16."""
        cell = 2 * int(self._rng.integers(_CELLS // 2)) + self._offset
        return low + (high - low) * (cell + float(self._rng.random())) / _CELLS

    def whole(self, low: int, high: int) -> int:
        """One of ``low … high``."""
        return int(self._rng.integers(low, high + 1))

    def chance(self, probability: float = 0.5) -> bool:
        return bool(self._rng.random() < probability)

    def pick(self, options: Sequence[T]) -> T:
        return options[self.whole(0, len(options) - 1)]

    def rotation(self) -> Array:
        """(3, 3), evenly from all rotations: of a random unit quaternion."""
        w, x, y, z = (q := self._rng.normal(size=4)) / np.linalg.norm(q)
        return np.array(
            (
                (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
            )
        )


def part(split: str, seed: int, index: int, families: Sequence[str] | None = None) -> Part:
    """The part of this number, of each family in turn (of all of them, unless ``families`` are named)."""
    rng = np.random.default_rng((SPLITS.index(split), seed, index))
    draw = Draw(rng, split)
    names = tuple(families or FAMILIES)
    family = names[index % len(names)]
    pieces = FAMILIES[family](draw)
    corners = np.concatenate([piece.bounds for piece in pieces])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = SIZES[0] * (SIZES[1] / SIZES[0]) ** draw.between(0, 1)
    placement = np.eye(4)
    placement[:3, :3] = draw.rotation() if draw.chance() else np.eye(3)
    # The frame is where the joint is: rarely at the centre, often near an end, sometimes off the part.
    away = draw.rotation()[0] * (high - low).max() * (0.03 if draw.chance(0.15) else draw.between(0.1, 0.8))
    placement[:3, 3] = placement[:3, :3] @ (away - (low + high) / 2)
    placement[:3] *= size / (high - low).max()
    for piece in pieces:
        piece.apply_transform(placement)
    return Part(f"{split}-{seed}-{index}-{family}", family, tuple(pieces))


# -- shapes that everything is made of -----------------------------------------------------------------------------


def _box(size: Sequence[float], at: Sequence[float] = (0, 0, 0)) -> Trimesh:
    mesh: Trimesh = make.box(size)
    return mesh.apply_translation(at)


def _cylinder(radius: float, length: float, at: Sequence[float] = (0.0, 0.0, 0.0), axis: str = "z") -> Trimesh:
    mesh: Trimesh = make.cylinder(radius, length, sections=_ROUND)
    if axis == "x":
        mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0)))
    elif axis == "y":
        mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    return mesh.apply_translation(at)


def _ball(radius: float, at: Sequence[float]) -> Trimesh:
    mesh: Trimesh = make.icosphere(subdivisions=2, radius=radius)
    return mesh.apply_translation(at)


def _prism(outline: Sequence[Sequence[float]], height: float) -> Trimesh:
    """A polygon in x and y, from z = 0 up."""
    from shapely.geometry import Polygon

    mesh: Trimesh = make.extrude_polygon(Polygon(outline), height)
    return mesh


def _turned(profile: Sequence[Sequence[float]]) -> Trimesh:
    """A closed profile of (radius, z), turned about z."""
    mesh: Trimesh = make.revolve(np.array([*profile, profile[0]]), sections=_ROUND)
    mesh.merge_vertices()
    mesh.fix_normals()
    return mesh


def _loft(below: Array, above: Array, height: float) -> Trimesh:
    """Between two outlines (N, 2) of as many corners, each visible from the origin; the lower one is at z = 0."""
    n = len(below)
    corners = np.concatenate(
        (
            np.column_stack((below, np.zeros(n))),
            np.column_stack((above, np.full(n, height))),
            ((0.0, 0.0, 0.0), (0.0, 0.0, height)),
        )
    )
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(j, i, 2 * n), (n + i, n + j, 2 * n + 1), (i, j, n + j), (i, n + j, n + i)]
    return Trimesh(corners, faces, process=False)


def _union(*meshes: Trimesh) -> Trimesh:
    mesh: Trimesh = trimesh.boolean.union(meshes, engine="manifold")
    return mesh


def _without(mesh: Trimesh, *tools: Trimesh) -> Trimesh:
    if not tools:
        return mesh
    rest: Trimesh = trimesh.boolean.difference((mesh, *tools), engine="manifold")
    return rest


def _circle(number: int, radius: float, start: float = 0.0) -> list[tuple[float, float]]:
    return [(radius * np.cos(a), radius * np.sin(a)) for a in start + 2 * np.pi * np.arange(number) / number]


# -- families ------------------------------------------------------------------------------------------------------


def l_bracket(draw: Draw) -> list[Trimesh]:
    """Two legs with holes, often a gusset."""
    a, b, w, t = 1.0, draw.between(0.4, 1.2), draw.between(0.25, 0.8), draw.between(0.05, 0.14)
    body = _union(_box((a, w, t), (a / 2, 0, t / 2)), _box((t, w, b), (t / 2, 0, b / 2)))
    if draw.chance():
        reach, thick = draw.between(0.2, 0.35), draw.between(0.04, 0.1)
        gusset = _prism(((t / 2, t / 2), (reach, t / 2), (t / 2, reach)), thick)
        gusset.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
        body = _union(body, gusset.apply_translation((0, draw.between(-0.3, 0.5) * w, 0)))
    tools = []
    for _ in range(draw.whole(1, 4)):
        at = (draw.between(0.45, 0.9) * a, draw.between(-0.3, 0.3) * w, 0.0)
        tools.append(_cylinder(draw.between(0.02, 0.1) * w, 1.0, at))
    for _ in range(draw.whole(0, 2)):
        at = (0.0, draw.between(-0.3, 0.3) * w, draw.between(0.6, 0.85) * b)
        tools.append(_cylinder(draw.between(0.03, 0.13) * w, 3 * t, at, "x"))
    return [_without(body, *tools)]


def u_bracket(draw: Draw) -> list[Trimesh]:
    """A servo bracket: two legs of different length, each with a bore."""
    a, w, t = 1.0, draw.between(0.3, 0.8), draw.between(0.05, 0.12)
    legs = draw.between(0.4, 1.1), draw.between(0.4, 1.1)
    sides = [_box((t, w, h), (x, 0, h / 2)) for x, h in zip((t / 2, a - t / 2), legs, strict=True)]
    bores = [
        _cylinder(draw.between(0.08, 0.3) * w, 3 * t, (x, 0, 0.7 * h), "x") for x, h in zip((0, a), legs, strict=True)
    ]
    holes = [
        _cylinder(0.05 * w, 1.0, (draw.between(0.25, 0.75), draw.between(-0.4, 0.4) * w, 0))
        for _ in range(draw.whole(0, 4))
    ]
    return [_without(_union(_box((a, w, t), (a / 2, 0, t / 2)), *sides), *bores, *holes)]


def housing(draw: Draw) -> list[Trimesh]:
    """A box open at the top, with ribs, a pillar and a hole for the cable."""
    a, b, h, t = 1.0, draw.between(0.4, 1.0), draw.between(0.25, 0.9), draw.between(0.015, 0.06)
    body = _without(_box((a, b, h)), _box((a - 2 * t, b - 2 * t, h), (0, 0, t)))
    for _ in range(draw.whole(0, 3)):
        body = _union(body, _box((t, b - t, draw.between(0.2, 0.7) * h), (draw.between(-0.4, 0.4), 0, -h / 4)))
    for _ in range(draw.whole(0, 3)):
        at = (draw.between(-0.38, 0.38) * a, draw.between(-0.38, 0.38) * b, -h / 4 + t / 2)
        body = _union(body, _cylinder(draw.between(0.03, 0.07), h / 2, at))
    return [_without(body, _cylinder(draw.between(0.05, 0.12), 3 * t, (a / 2, draw.between(-0.3, 0.3) * b, 0), "x"))]


def cup(draw: Draw) -> list[Trimesh]:
    """A round shell with a flange, and a lug on one side."""
    r, h, t = draw.between(0.2, 0.5), draw.between(0.3, 1.0), draw.between(0.015, 0.05)
    edge = r + draw.between(0.05, 0.2)
    body = _turned(((0, 0), (r, 0), (r, h - t), (edge, h - t), (edge, h), (r - t, h), (r - t, t), (0, t)))
    lug = _box((draw.between(0.1, 0.4), draw.between(0.05, 0.3), draw.between(0.1, 0.4)), (edge - 0.01, 0, h / 2))
    body = _union(body, _without(lug, _cylinder(r - t / 2, 3 * h)))
    holes = [_cylinder(draw.between(0.01, 0.03), h, (x, y, h)) for x, y in _circle(draw.whole(2, 6), (r + edge) / 2)]
    return [_largest(_without(body, *holes))]


def rod(draw: Draw) -> list[Trimesh]:
    """A linkage: two eyes of different size, a beam, sometimes with a pocket."""
    big, small, t = draw.between(0.1, 0.22), draw.between(0.05, 0.12), draw.between(0.04, 0.15)
    beam = _prism(((0, -0.8 * small), (1, -0.6 * small), (1, 0.6 * small), (0, 0.8 * small)), t)
    eyes = (
        _cylinder(big, draw.between(1.0, 2.2) * t, (0, 0, t / 2)),
        _cylinder(small, draw.between(1.0, 1.6) * t, (1, 0, t / 2 + draw.between(0, 0.3) * t)),
    )
    tools = [_cylinder(draw.between(0.4, 0.75) * r, 1.0, (x, 0, 0)) for r, x in ((big, 0.0), (small, 1.0))]
    if draw.chance():
        tools.append(_box((draw.between(0.2, 0.5), 0.6 * small, t), (0.55, 0, draw.between(0.6, 0.9) * t)))
    return [_without(_union(beam, *eyes), *tools)]


def wheel(draw: Draw) -> list[Trimesh]:
    """Rim, web and hub, holes in the web, a hub longer on one side, often a marker."""
    r, w = 0.5, draw.between(0.06, 0.4)
    rim, web, hub = draw.between(0.3, 0.42), draw.between(0.15, 0.5) * w, draw.between(0.08, 0.15)
    reach = draw.between(0.55, 1.0) * w
    body = _union(
        _turned(((rim, -w / 2), (r, -w / 2), (r, w / 2), (rim, w / 2))),
        _cylinder(rim + 0.01, web, (0, 0, draw.between(-0.2, 0.2) * w)),
        _cylinder(hub, reach, (0, 0, (reach - w / 2) / 2)),
    )
    if draw.chance(0.6):
        angle, out = draw.between(0, 2 * np.pi), draw.between(0.6, 0.9) * rim
        body = _union(body, _cylinder(draw.between(0.02, 0.05), w, (out * np.cos(angle), out * np.sin(angle), w / 4)))
    number = draw.whole(0, 6)
    middle, bore = (rim + hub) / 2, draw.between(0.1, 0.35) * (rim - hub)
    holes = [_cylinder(bore, 2 * w, (x, y, 0)) for x, y in _circle(number, middle, draw.between(0, 1))]
    return [_without(body, _cylinder(draw.between(0.2, 0.6) * hub, 3 * w), *holes)]


def flange(draw: Draw) -> list[Trimesh]:
    """A disk with bolt holes and a neck, one flat cut off."""
    r, t = 0.5, draw.between(0.04, 0.15)
    neck, h = draw.between(0.15, 0.35), draw.between(0.1, 0.7)
    body = _union(_cylinder(r, t), _cylinder(neck, h, (0, 0, h / 2)))
    tools = [_cylinder(draw.between(0.4, 0.85) * neck, 4.0)]
    tools += [_cylinder(draw.between(0.02, 0.05), 4 * t, (x, y, 0)) for x, y in _circle(draw.whole(3, 8), 0.42)]
    if draw.chance(0.7):
        tools.append(_box((1, 1, 4 * t), (0.5 + draw.between(0.3, 0.45), draw.between(-0.6, 0.6), 0)))
    return [_without(body, *tools)]


def motor(draw: Draw) -> list[Trimesh]:
    """Steps of different radius and a connector on the side."""
    steps, z = [], 0.0
    for _ in range(draw.whole(2, 4)):
        length = draw.between(0.1, 0.5)
        steps.append(_cylinder(draw.between(0.1, 0.32), length + 0.01, (0, 0, z + length / 2)))
        z += length
    steps.append(_cylinder(draw.between(0.03, 0.08), 0.3, (0, draw.between(0, 0.05), z + 0.1)))
    angle = draw.between(0, 2 * np.pi)
    plug = _box(
        (draw.between(0.1, 0.3), draw.between(0.1, 0.3), draw.between(0.08, 0.3)), (0.25, 0, draw.between(0, z))
    )
    plug.apply_transform(trimesh.transformations.rotation_matrix(angle, (0, 0, 1)))
    return [_largest(_union(*steps, plug))]


def casting(draw: Draw) -> list[Trimesh]:
    """Boxes, cylinders and balls grown into each other, with bores: nothing is symmetric."""
    body = _box((1.0, draw.between(0.2, 0.6), draw.between(0.15, 0.5)))
    for _ in range(draw.whole(2, 5)):
        at = (draw.between(-0.5, 0.5), draw.between(-0.3, 0.3), draw.between(-0.25, 0.25))
        kind = draw.pick(("box", "x", "y", "z", "ball"))
        if kind == "box":
            lump = _box([draw.between(0.15, 0.5) for _ in range(3)], at)
            angle = draw.between(0, np.pi)
            lump.apply_transform(trimesh.transformations.rotation_matrix(angle, draw.rotation()[0], at))
        elif kind == "ball":
            lump = _ball(draw.between(0.1, 0.25), at)
        else:
            lump = _cylinder(draw.between(0.06, 0.2), draw.between(0.3, 1.0), at, kind)
        # What does not touch the rest would be a second piece.
        grown = _union(body, lump)
        body = grown if grown.body_count == 1 else body
    bores = [
        _cylinder(draw.between(0.03, 0.1), 3.0, (draw.between(-0.4, 0.4), draw.between(-0.1, 0.1), 0), draw.pick("yz"))
        for _ in range(draw.whole(0, 3))
    ]
    return [_largest(_without(body, *bores))]


def gearbox(draw: Draw) -> list[Trimesh]:
    """A case about two shafts that are apart, with shaft ends on different sides."""
    d, h = draw.between(0.3, 0.6), draw.between(0.2, 0.6)
    r, q = draw.between(0.2, 0.4), draw.between(0.15, 0.3)
    body = _union(
        _cylinder(r, h),
        _cylinder(q, h * draw.between(0.5, 0.95), (d, 0, 0)),
        _box((d, 1.6 * q, 0.5 * h), (d / 2, draw.between(-0.1, 0.1), 0)),
        _cylinder(draw.between(0.05, 0.12), draw.between(0.3, 0.7), (0, 0, h / 2)),
        _cylinder(draw.between(0.04, 0.1), draw.between(0.3, 0.7), (d, 0, -h / 2)),
    )
    if draw.chance():
        body = _union(body, _box((draw.between(0.5, 1.0), draw.between(0.3, 0.6), 0.06), (0.2, -r, -h / 2 + 0.03)))
    return [body]


def plate(draw: Draw) -> list[Trimesh]:
    """A plate with cut corners, bosses and pockets."""
    b, t = draw.between(0.3, 0.9), draw.between(0.02, 0.1)
    cut = draw.between(0.1, 0.3)
    body = _prism(((0, 0), (1, 0), (1, b - cut), (1 - cut, b), (0, b)), t)
    for _ in range(draw.whole(1, 5)):
        at = (draw.between(0.15, 0.75), draw.between(0.15, 0.6) * b, t)
        body = _union(body, _cylinder(draw.between(0.03, 0.12) * b, draw.between(2, 6) * t, at))
    tools = [
        _box((draw.between(0.05, 0.3), draw.between(0.05, 0.3) * b, 9 * t), (draw.between(0.15, 0.8), b / 2, 0))
        for _ in range(draw.whole(0, 2))
    ]
    return [_largest(_without(body, *tools))]


def elbow(draw: Draw) -> list[Trimesh]:
    """A bent pipe with a flange on either end."""
    from shapely.geometry import Point

    bend, r = draw.between(0.35, 0.6), draw.between(0.08, 0.2)
    bore = draw.between(0.5, 0.85) * r
    angles = np.linspace(0, draw.between(0.6, 2.4), 18)
    path = np.column_stack((bend * np.cos(angles), bend * np.sin(angles), np.zeros(18)))
    pipe = make.sweep_polygon(Point(0, 0).buffer(r, quad_segs=6), path)
    hollow = make.sweep_polygon(Point(0, 0).buffer(bore, quad_segs=6), path)
    flanges = []
    for at, along in ((path[0], path[0] - path[1]), (path[-1], path[-1] - path[-2])):
        ring = _cylinder(r + draw.between(0.03, 0.15), draw.between(0.03, 0.1))
        ring.apply_transform(trimesh.geometry.align_vectors((0, 0, 1), along))
        hole = _cylinder(1.03 * bore, 0.4)
        hole.apply_transform(trimesh.geometry.align_vectors((0, 0, 1), along))
        flanges.append(_without(ring, hole).apply_translation(at))
    return [_largest(_union(_without(pipe, hollow), *flanges))]


def arm_link(draw: Draw) -> list[Trimesh]:
    """A robot's link: two joint barrels whose axes differ, offset from the beam between them."""
    r, q, offset = draw.between(0.1, 0.2), draw.between(0.07, 0.15), draw.between(-0.25, 0.25)
    beam = _box((1.0, draw.between(0.08, 0.2), draw.between(0.08, 0.25)), (0.5, 0, 0))
    body = _union(
        beam,
        _cylinder(r, draw.between(0.2, 0.6), (0, draw.between(0, 0.2), offset / 2), draw.pick("yz")),
        _cylinder(q, draw.between(0.25, 0.5), (1, 0, offset), draw.pick("yz")),
        _box((2 * q, 0.1, abs(offset) + 0.05), (1 - q / 2, 0, offset / 2)),
    )
    slot = [_box((0.5, 1.0, 0.04), (0.5, 0, 0))] if draw.chance() else []
    return [_largest(_without(body, *slot))]


def cam(draw: Draw) -> list[Trimesh]:
    """A lofted cam: every corner at another radius, another outline above."""
    n = draw.whole(7, 14)
    rays = np.array(_circle(n, 1.0))
    outline = rays * np.array([[draw.between(0.2, 0.6)] for _ in range(n)])
    return [_loft(outline, outline * draw.between(0.5, 1.2), draw.between(0.1, 0.9))]


def cover(draw: Draw) -> list[Trimesh]:
    """A draft-angled casting: two outlines of unlike shape, one above the other."""
    n = draw.whole(5, 9)
    rays = np.array(_circle(n, 1.0, draw.between(0, 1)))
    below, above = (rays * np.array([[draw.between(0.15, 0.7)] for _ in range(n)]) for _ in range(2))
    return [_loft(below, above, draw.between(0.2, 1.2))]


def assembly(draw: Draw) -> list[Trimesh]:
    """Two to four bodies on a base, touching or a gap apart, each a mesh of its own."""
    a, b, t = 1.0, draw.between(0.4, 0.9), draw.between(0.06, 0.25)
    pieces = [_box((a, b, t), (0, 0, -t / 2))]
    spots = [(-0.3, -0.2), (0.3, -0.15), (0.05, 0.25)][: draw.whole(1, 3)]
    for x, y in spots:
        h = draw.between(0.15, 0.9)
        at = (x + draw.between(-0.08, 0.08), y * b, h / 2 + draw.pick((0.0, 0.001, 0.02)))
        round_one = draw.chance()
        pieces.append(
            _cylinder(draw.between(0.07, 0.18) * b, h, at)
            if round_one
            else _box((draw.between(0.15, 0.3), draw.between(0.15, 0.3) * b, h), at)
        )
    return pieces


def drive(draw: Draw) -> list[Trimesh]:
    """Motor, gearbox and wheel in a row, and the bracket that they hang from: bodies of their own."""
    z, pieces = 0.0, []
    for low, high in ((0.25, 0.5), (0.1, 0.3), (0.05, 0.2)):
        length = draw.between(low, high)
        pieces.append(_cylinder(draw.between(0.12, 0.3), length, (0, 0, z + length / 2)))
        z += length + draw.pick((0.0, 0.01))
    width = draw.between(0.1, 0.5)
    pieces.append(_box((draw.between(0.04, 0.1), width, draw.between(0.4, 1.0)), (0.4, draw.between(0, 0.2), 0.4)))
    return pieces


def frame(draw: Draw) -> list[Trimesh]:
    """Profiles of a frame, cut to length: bodies of their own."""
    a, b, t = 1.0, draw.between(0.4, 1.0), draw.between(0.03, 0.1)
    bars = [
        _box((a, t, t), (a / 2, 0, 0)),
        _box((t, b, t), (draw.between(0.1, 0.9), (b + t) / 2, 0)),
        _box((draw.between(0.4, 0.9), t, t), (0.5, b + t, 0)),
        _box((t, t, h := draw.between(0.2, 1.2)), (draw.between(0.05, 0.95), 0, (h + t) / 2)),
    ]
    return bars[: draw.whole(2, 4)]


def stack(draw: Draw) -> list[Trimesh]:
    """Plates above each other on spacers, with a battery on one of them."""
    a, b, t = 1.0, draw.between(0.4, 1.0), draw.between(0.02, 0.06)
    gap = draw.between(0.1, 0.35)
    pieces = [_box((a, b, t)), _box((draw.between(0.5, 1.0), b * draw.between(0.5, 1.0), t), (0, 0, gap + t))]
    for x in (-0.2, 0.2):
        pieces.append(_cylinder(draw.between(0.02, 0.06), gap, (x, draw.between(-0.2, 0.2) * b, (gap + t) / 2)))
    battery = [draw.between(0.2, 0.5), draw.between(0.15, 0.3), draw.between(0.05, 0.3)]
    pieces.append(_box(battery, (draw.between(-0.2, 0.2), draw.between(-0.1, 0.1), gap + 1.5 * t + battery[2] / 2)))
    return pieces


def finger(draw: Draw) -> list[Trimesh]:
    """A gripper's finger: tapered, cranked, with teeth on one side."""
    t, root, tip = draw.between(0.08, 0.3), draw.between(0.15, 0.35), draw.between(0.05, 0.12)
    crank = draw.between(0.1, 0.35)
    outline = [(0, 0), (0.4, crank), (1.0, crank), (1.0, crank + tip)]
    teeth = draw.whole(2, 5)
    for x, y in pairwise(np.linspace(1.0, 0.5, teeth + 1)):
        outline += [((x + y) / 2, crank + tip + 0.04), (y, crank + tip)]
    outline += [(0.35, crank + tip + 0.05), (0, root)]
    bores = [_cylinder(draw.between(0.1, 0.2) * root, 1.0, (x, root / 2, 0)) for x in (0.1, 0.2)]
    return [_without(_prism(outline, t), bores[draw.whole(0, 1)])]


def _largest(mesh: Trimesh) -> Trimesh:
    """Without the crumbs that a cut may leave."""
    bodies = mesh.split(only_watertight=True)
    best: Trimesh = max(bodies, key=lambda body: body.area)
    return best


FAMILIES: dict[str, Callable[[Draw], list[Trimesh]]] = {
    f.__name__: f
    for f in (
        l_bracket, u_bracket, housing, cup, rod, wheel, flange, motor, casting, gearbox, plate, elbow, arm_link, cam, cover,
        finger, assembly, drive, frame, stack,
    )
}  # fmt: skip
# Those that need neither a boolean library nor a triangulation.
PLAIN = ("cam", "cover", "assembly", "drive", "frame", "stack")
