"""Parts that tests make of blocks, their true numbers, and each common mistake in these numbers.

A block is ``(size, place)``: its edges and its centre, in metres. Blocks of one part may touch and do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from urdfcheck.core import Edit
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    combine_solids,
    compute_principal_moments,
    compute_solid_inertia,
    make_box_solid,
    transform_solid,
)
from urdfcheck.facts.mesh.convex_hull import compute_convex_hull
from urdfcheck.facts.mesh.moments import compute_mesh_moments
from urdfcheck.facts.motion.kinematics import matrix_to_rpy

Array = NDArray[np.float64]
Block = tuple[Sequence[float], Sequence[float]]

# A casting without any symmetry: a beam, a fin on its left and a post on its top.
CASTING: tuple[Block, ...] = (
    ((0.20, 0.06, 0.04), (0.03, 0.02, 0.05)),
    ((0.05, 0.16, 0.03), (-0.045, 0.13, 0.055)),
    ((0.03, 0.04, 0.12), (0.11, 0.01, 0.13)),
)
PLASTIC = 1300.0
SLOTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FACES = np.array(
    [
        face
        for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        for face in ((a, b, c), (a, c, d))
    ]
)


def triangles(blocks: Sequence[Block]) -> tuple[Array, NDArray[np.intp]]:
    """Corners (V, 3) and outward faces (F, 3) of all blocks."""
    corners = np.concatenate([_CORNERS * size + place for size, place in blocks])
    faces = np.concatenate([_FACES + 8 * i for i in range(len(blocks))])
    return corners, faces


def pieces(blocks: Sequence[Block]) -> tuple[Solid, ...]:
    return tuple(transform_solid(make_box_solid(size), np.eye(3), place) for size, place in blocks)


def geometry(blocks: Sequence[Block], scale: float = 1.0) -> VisualGeometry:
    """What a link draws: the blocks, all ``scale`` times as large."""
    blocks = [(np.array(size) * scale, np.array(place) * scale) for size, place in blocks]
    corners, faces = triangles(blocks)
    hull = compute_convex_hull(corners)
    filled, surface = compute_mesh_moments(hull.vertices, hull.faces), compute_mesh_moments(corners, faces)
    low, high = corners.min(axis=0), corners.max(axis=0)
    return VisualGeometry(
        solid=combine_solids(pieces(blocks)),
        closed=True,
        points=corners,
        hull=Solid(filled.volume, filled.com, filled.covariance),
        shell=Solid(surface.area, surface.surface_centroid, surface.surface_covariance),
        box=transform_solid(make_box_solid(high - low), np.eye(3), (low + high) / 2),
        pieces=pieces(blocks),
    )


def opened(drawn: VisualGeometry) -> VisualGeometry:
    """The same drawn by an open mesh: only its convex hull is known."""
    assert drawn.hull is not None
    return replace(drawn, solid=drawn.hull, closed=False, pieces=(drawn.hull,))


def uniform(solid: Solid, mass: float | None = None) -> DeclaredInertial:
    """The numbers of a solid of plastic, or of another mass."""
    mass = PLASTIC * solid.volume if mass is None else mass
    return DeclaredInertial(mass, solid.com, compute_solid_inertia(solid, mass))


def principal(numbers: DeclaredInertial) -> DeclaredInertial:
    """The same body with its tensor along the principal axes, which rpy gives."""
    found, axes = compute_principal_moments(numbers.inertia)
    return replace(numbers, tensor=np.diag(found), rotation=axes)


def turned(numbers: DeclaredInertial, rotation: Array, shift: Array | float = 0.0) -> DeclaredInertial:
    """The body in another link frame: ``x -> rotation x + shift``."""
    return DeclaredInertial(numbers.mass, rotation @ numbers.com + shift, rotation @ numbers.tensor @ rotation.T)


def moved(blocks: VisualGeometry, rotation: Array, shift: Array | float = 0.0) -> VisualGeometry:
    """What is drawn in another link frame, without its bounding box, which is another there."""
    move = np.zeros(3) + shift

    def solid(one: Solid | None) -> Solid | None:
        return None if one is None else transform_solid(one, rotation, move)

    return VisualGeometry(
        solid=transform_solid(blocks.solid, rotation, move),
        closed=blocks.closed,
        points=blocks.points @ rotation.T + move,
        hull=solid(blocks.hull),
        shell=solid(blocks.shell),
        pieces=tuple(transform_solid(piece, rotation, move) for piece in blocks.pieces),
    )


def slots(numbers: DeclaredInertial) -> list[float]:
    """URDF's six."""
    return [float(numbers.tensor[i, j]) for i in range(3) for j in range(i, 3)]


def with_slots(numbers: DeclaredInertial, six: Sequence[float]) -> DeclaredInertial:
    xx, xy, xz, yy, yz, zz = six
    return replace(numbers, tensor=np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))


def steiner(mass: float, lever: Array) -> Array:
    """What the parallel-axis theorem adds."""
    return mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))


def quarter(axis: int) -> Array:
    """A rotation by 90° about x, y or z."""
    turn = np.zeros((3, 3))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn[axis, axis] = turn[b, a] = 1.0
    turn[a, b] = -1.0
    return turn


# -- mistakes: the true numbers, and what is drawn, to the numbers as they are written ---------------------------------

Mistake = Callable[[DeclaredInertial, VisualGeometry], DeclaredInertial]


def _slot(index: int, factor: float) -> Mistake:
    return lambda true, _: with_slots(true, [v * (factor if i == index else 1.0) for i, v in enumerate(slots(true))])


def _order(*order: int) -> Mistake:
    return lambda true, _: with_slots(true, [slots(true)[i] for i in order])


def _body(choose: Callable[[VisualGeometry], Solid | None]) -> Mistake:
    def make(true: DeclaredInertial, drawn: VisualGeometry) -> DeclaredInertial:
        solid = choose(drawn)
        assert solid is not None
        return uniform(solid, true.mass)

    return make


def _added(true: DeclaredInertial, drawn: VisualGeometry) -> DeclaredInertial:
    density = true.mass / drawn.solid.volume
    return replace(
        true, tensor=sum((compute_solid_inertia(p, density * p.volume) for p in drawn.pieces), np.zeros((3, 3)))
    )


def _mirrored(true: DeclaredInertial, _: VisualGeometry) -> DeclaredInertial:
    mirror = np.diag((1.0, -1.0, 1.0))
    return DeclaredInertial(true.mass, mirror @ true.com, mirror @ true.tensor @ mirror)


# (id, what its detail says, the mistake): those that this part can show
MISTAKES: tuple[tuple[str, str, Mistake], ...] = (
    ("inertia_unit", "kg·cm²", lambda t, _: replace(t, tensor=t.tensor * 1e4)),
    ("mass_unit", "lb", lambda t, _: replace(t, mass=t.mass / 0.45359237)),
    ("com_unit", "mm", lambda t, _: replace(t, com=t.com * 1e3)),
    ("units", "g and g·mm², mm", lambda t, _: DeclaredInertial(t.mass * 1e3, t.com * 1e3, t.tensor * 1e9)),
    ("mesh_scale", "0.001", lambda t, _: DeclaredInertial(t.mass / 1e9, t.com / 1e3, t.tensor / 1e15)),
    ("about_origin", "", lambda t, _: replace(t, tensor=t.tensor + steiner(t.mass, t.com))),
    (
        "positive_notation",
        "",
        lambda t, _: with_slots(
            t, np.array(slots(replace(t, tensor=t.tensor + steiner(t.mass, t.com)))) * (1, -1, -1, 1, -1, 1)
        ),
    ),
    ("steiner_twice", "", lambda t, _: replace(t, tensor=t.tensor - steiner(t.mass, t.com))),
    ("steiner_missing", "", _added),
    ("own_missing", "", lambda t, drawn: replace(t, tensor=t.tensor - _added(t, drawn).tensor)),
    ("one_piece", "", lambda t, drawn: uniform(drawn.pieces[0])),
    ("products_sign", "", lambda t, _: with_slots(t, np.array(slots(t)) * (1, -1, -1, 1, -1, 1))),
    ("axes_permuted", "z x y", lambda t, _: replace(t, tensor=t.tensor[np.ix_((2, 0, 1), (2, 0, 1))])),
    ("slots_swapped", "ixx and izz", _order(5, 1, 2, 3, 4, 0)),
    ("slots_shifted", "all six are one slot too late", _order(5, 0, 1, 2, 3, 4)),
    ("quarter_turn", "-90° about x", lambda t, _: turned(t, quarter(0))),
    ("com_missing", "", lambda t, _: replace(t, com=np.zeros(3))),
    ("unmirrored", "y", _mirrored),
    ("rpy_missing", "", lambda t, _: replace(principal(t), rotation=np.eye(3))),
    ("rpy_twice", "", lambda t, _: replace(principal(t), tensor=t.tensor)),
    ("diagonal_first", "", _order(0, 3, 5, 1, 2, 4)),
    ("row_major", "", _order(0, 1, 2, 1, 3, 4)),
    ("one_sign", "ixz", _slot(2, -1.0)),
    ("decimal_point", "izz 10", _slot(5, 0.1)),
    ("shell", "", _body(lambda drawn: drawn.shell)),
    ("bounding_box", "", _body(lambda drawn: drawn.box)),
    ("convex_hull", "", _body(lambda drawn: drawn.hull)),
    ("other_mass", "", lambda t, _: replace(t, tensor=t.tensor * 2.5)),
)


# -- as files -----------------------------------------------------------------------------------------------------------


def write_stl(path: Path, blocks: Sequence[Block]) -> None:
    """The blocks as a text STL."""
    corners, faces = triangles(blocks)
    lines = ["solid part"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners[face].tolist()]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid part", ""]), encoding="ascii")


def open_widely(path: Path) -> None:
    """Leave out half of the facets of a text STL's last block, a hole too large to be filled."""
    text = path.read_text(encoding="ascii")
    path.write_text("facet normal".join(text.split("facet normal")[:-6]) + "endsolid part\n", encoding="ascii")


def drawn_boxes(blocks: Sequence[Block]) -> str:
    """The blocks as a ``<visual>`` each."""
    shown = ""
    for size, place in blocks:
        xyz, edges = (" ".join(map(str, values)) for values in (place, size))
        shown += f'<visual><origin xyz="{xyz}"/><geometry><box size="{edges}"/></geometry></visual>'
    return shown


def edited(text: str, edits: Sequence[Edit]) -> str:
    """A source text after edits."""
    for edit in sorted(edits, key=lambda e: -e.span.start):
        assert text[edit.span.start : edit.span.end] == edit.expected
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    return text


def format_inertial(numbers: DeclaredInertial, digits: int = 8) -> str:
    """An ``<inertial>`` with so many significant digits."""

    def words(values: Sequence[float] | Array) -> str:
        return " ".join(f"{0.0 if abs(v) < 1e-30 else v:.{digits}g}" for v in values)

    noise = 1e-12 * np.abs(numbers.tensor).max()
    six = " ".join(
        f'{name}="{words([value if abs(value) > noise else 0.0])}"'
        for name, value in zip(SLOTS, slots(numbers), strict=True)
    )
    xyz = words(np.where(np.abs(numbers.com) > 1e-12, numbers.com, 0.0))
    rpy = words(np.array(matrix_to_rpy(numbers.rotation)) + 0.0)
    mass = words([numbers.mass])
    return f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/><inertia {six}/></inertial>'
