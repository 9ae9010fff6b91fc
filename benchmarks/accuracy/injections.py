"""True numbers of a part, and every mistake that is injected into them.

Nothing here uses the code of the diagnosis: mass properties are trimesh's, and each mistake is written down as it is made.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np
from numpy.typing import NDArray
from parts import Part
from trimesh import Trimesh

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial

Array = NDArray[np.float64]
Rng = np.random.Generator

# Densities (kg/m³) and how often they are drawn: the default of CAD systems, plastics, aluminium, steel, brass.
_MATERIALS = (
    (0.25, (1000.0, 1000.0)),
    (0.3, (900.0, 1500.0)),
    (0.2, (2700.0, 2700.0)),
    (0.15, (7850.0, 7850.0)),
    (0.1, (8500.0, 8500.0)),
)
_DIGITS = (6, 7, 8, 6, 7, 8, 5)
# Below this share of the largest, a number of a symmetric part is the noise of the computation, and written as zero.
_NOISE = 1e-9
POUND, INCH = 0.45359237, 0.0254


# -- what is true --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Body:
    """``mass`` (kg), ``com`` (3,) in m, ``inertia`` (3, 3) in kg m² about the COM, all in the link's axes."""

    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class Truth:
    """A part's true numbers ``whole``; those of its ``pieces``, each about its own COM."""

    whole: Body
    pieces: tuple[Body, ...]


def truth(part: Part, rng: Rng, *, lumped: bool) -> Truth:
    """Of uniform density; or ``lumped``: with 5 to 60 % of the mass in one to three small balls at random places inside."""
    density = _density(rng)
    bodies = [uniform(piece, density) for piece in part.pieces]
    groups: list[list[Body]] = [[body] for body in bodies]
    if lumped:
        mass = sum(body.mass for body in bodies)
        share = rng.uniform(0.05, 0.6)
        # The lumps replace as much of the uniform mass as they bring.
        groups = [[Body(b.mass * (1 - share), b.com, b.inertia * (1 - share))] for b in bodies]
        size = float(np.ptp(part.mesh.bounds, axis=0).max())
        for weight in rng.dirichlet(np.ones(rng.integers(1, 4))):
            i = int(rng.choice(len(bodies), p=[b.mass / mass for b in bodies]))
            radius = size * rng.uniform(0, 0.01)
            lump = weight * share * mass
            groups[i].append(Body(lump, point_inside(part.pieces[i], rng), 0.4 * lump * radius**2 * np.eye(3)))
    pieces = tuple(combined(group) for group in groups)
    return Truth(combined(pieces), pieces)


def uniform(mesh: Trimesh, density: float) -> Body:
    """A closed mesh filled evenly (kg/m³)."""
    found = mesh.mass_properties
    return Body(density * found.volume, np.array(found.center_mass), density * np.array(found.inertia))


def combined(bodies: Sequence[Body]) -> Body:
    """Several bodies as one (parallel-axis theorem)."""
    mass = sum(b.mass for b in bodies)
    com = sum((b.mass * b.com for b in bodies), np.zeros(3)) / mass
    inertia = sum((b.inertia + b.mass * steiner(b.com - com) for b in bodies), np.zeros((3, 3)))
    return Body(mass, com, inertia)


def steiner(offset: Array) -> Array:
    """(3, 3) in m²: what a unit mass at this offset adds to an inertia tensor."""
    result: Array = float(offset @ offset) * np.eye(3) - np.outer(offset, offset)
    return result


def point_inside(mesh: Trimesh, rng: Rng) -> Array:
    """A random place (3,) inside a closed mesh: on a random line along an axis, between where it enters and leaves."""
    corners = mesh.triangles
    for _ in range(1000):
        axis = int(rng.integers(3))
        across = [(axis + 1) % 3, (axis + 2) % 3]
        low, high = mesh.bounds
        through = rng.uniform(low[across], high[across])
        a, b, c = (corners[:, i, across] - through for i in range(3))
        areas = np.stack([p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b))], axis=1)
        hit = (areas > 0).all(axis=1) | (areas < 0).all(axis=1)
        weights = areas[hit] / areas[hit].sum(axis=1, keepdims=True)
        crossings = np.sort((weights * corners[hit][:, :, axis]).sum(axis=1))
        if len(crossings) < 2 or len(crossings) % 2:
            continue
        inside = crossings.reshape(-1, 2)
        lengths = np.diff(inside, axis=1)[:, 0]
        enter, leave = inside[rng.choice(len(inside), p=lengths / lengths.sum())]
        place = np.empty(3)
        place[axis], place[across] = rng.uniform(enter, leave), through
        return place
    raise ValueError("no line goes through the mesh")


def _density(rng: Rng) -> float:
    low, high = _MATERIALS[rng.choice(len(_MATERIALS), p=[p for p, _ in _MATERIALS])][1]
    return float(rng.uniform(low, high))


# -- as a file has it ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Numbers:
    """The ten numbers of an ``<inertial>`` and its rpy: ``six`` in URDF's order ``ixx ixy ixz iyy iyz izz``.

    ``scale``: by how much the mesh is drawn too large.
    """

    mass: float
    com: Array
    six: Array
    rpy: Array
    scale: float = 1.0


def written(body: Body, *, principal: bool) -> Numbers:
    """In the link's axes; or along the ``principal`` axes, which rpy gives."""
    if not principal:
        return Numbers(body.mass, body.com, six_of(body.inertia), np.zeros(3))
    moments, axes = np.linalg.eigh(body.inertia)
    axes = axes * np.sign(np.linalg.det(axes))
    return Numbers(body.mass, body.com, six_of(np.diag(moments)), rpy_of(axes))


def declared(numbers: Numbers, digits: int) -> DeclaredInertial:
    """As the diagnosis gets them from a file that has so many significant digits."""
    return DeclaredInertial(
        mass=float(f"{numbers.mass:.{digits}g}"),
        com=_rounded(numbers.com, digits),
        tensor=tensor_of(_rounded(numbers.six, digits)),
        rotation=rotation_of(_rounded(numbers.rpy, digits)),
    )


def digits(rng: Rng) -> int:
    """Of the numbers of a file."""
    return int(rng.choice(_DIGITS))


def six_of(tensor: Array) -> Array:
    """URDF's six numbers of a (3, 3) tensor."""
    return tensor[np.triu_indices(3)]


def tensor_of(six: Array) -> Array:
    """The (3, 3) tensor of URDF's six numbers."""
    xx, xy, xz, yy, yz, zz = six
    return np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))


def rotation_of(rpy: Array) -> Array:
    """(3, 3) of URDF's fixed-axis roll, pitch and yaw: Rz(yaw) Ry(pitch) Rx(roll)."""
    roll, pitch, yaw = (_about(axis, angle) for axis, angle in enumerate(rpy))
    return yaw @ pitch @ roll


def rpy_of(rotation: Array) -> Array:
    """Roll, pitch and yaw of a (3, 3) rotation away from a pitch of ±90°, and a valid choice there."""
    pitch = np.arcsin(np.clip(-rotation[2, 0], -1, 1))
    if abs(rotation[2, 0]) > 1 - 1e-12:
        return np.array((0.0, pitch, np.arctan2(-rotation[0, 1], rotation[1, 1])))
    return np.array((np.arctan2(rotation[2, 1], rotation[2, 2]), pitch, np.arctan2(rotation[1, 0], rotation[0, 0])))


def _about(axis: int, angle: float) -> Array:
    """A rotation about x, y or z."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[a, a] = turn[b, b] = np.cos(angle)
    turn[b, a], turn[a, b] = np.sin(angle), -np.sin(angle)
    return turn


def _rounded(values: Array, digits: int) -> Array:
    kept = np.where(np.abs(values) > _NOISE * np.abs(values).max(), values, 0.0)
    return np.array([float(f"{value:.{digits}g}") for value in kept])


# -- mistakes ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Case:
    """A part with its truth, before a mistake is made. ``principal``: how its file writes the tensor; ``other``: the truth of
    another part."""

    part: Part
    truth: Truth
    principal: bool
    other: Body

    @property
    def solid(self) -> Body:
        """The part filled evenly, of its true mass."""
        return _with_mass(combined([uniform(piece, 1.0) for piece in self.part.pieces]), self.truth.whole.mass)

    @property
    def clean(self) -> Numbers:
        return written(self.truth.whole, principal=self.principal)

    @property
    def full(self) -> Numbers:
        """In the link's axes, whatever the file."""
        return written(self.truth.whole, principal=False)

    @property
    def diagonal(self) -> Numbers:
        """Along the principal axes, whatever the file."""
        return written(self.truth.whole, principal=True)

    def of(self, body: Body) -> Numbers:
        """Another body as this file writes it."""
        return written(body, principal=self.principal)


Mistake = Callable[[Case, Rng], Numbers | None]

# What one kg m² is in other units, and powers of ten either way.
_TENSOR_UNITS = {
    "kg cm²": 1e4, "kg mm²": 1e6, "g m²": 1e3, "g cm²": 1e7, "g mm²": 1e9, "lb in²": 1 / (POUND * INCH**2),
    "lb ft²": 1 / (POUND * (12 * INCH) ** 2), "1e-3": 1e-3, "1e-6": 1e-6, "1e-9": 1e-9,
}  # fmt: skip
_LENGTH_UNITS = {"mm": 1e3, "cm": 1e2, "in": 1 / INCH}
_SYSTEMS = ((1e3, 1e3), (1e3, 1e2), (1 / POUND, 1 / INCH))


def inertia_unit(case: Case, rng: Rng) -> Numbers:
    """The tensor in another unit than kg m², mass and COM right."""
    factor = list(_TENSOR_UNITS.values())[rng.integers(len(_TENSOR_UNITS))]
    return replace(case.clean, six=case.clean.six * factor)


def mass_unit(case: Case, rng: Rng) -> Numbers:
    """The mass in grams or pounds, the tensor right."""
    return replace(case.clean, mass=case.clean.mass * rng.choice((1e3, 1 / POUND)))


def mass_and_inertia_unit(case: Case, rng: Rng) -> Numbers:
    """Mass and tensor in g and mm, g and cm, or lb and in; the COM in metres."""
    mass, length = _SYSTEMS[rng.integers(3)]
    clean = case.clean
    return replace(clean, mass=clean.mass * mass, six=clean.six * mass * length**2)


def all_units(case: Case, rng: Rng) -> Numbers:
    """Mass, tensor and COM in g and mm, g and cm, or lb and in."""
    mass, length = _SYSTEMS[rng.integers(3)]
    clean = case.clean
    return replace(clean, mass=clean.mass * mass, six=clean.six * mass * length**2, com=clean.com * length)


def com_unit(case: Case, rng: Rng) -> Numbers:
    """The COM in mm, cm or inches."""
    return replace(case.clean, com=case.clean.com * list(_LENGTH_UNITS.values())[rng.integers(3)])


def mesh_scale(case: Case, rng: Rng) -> Numbers:
    """The mesh drawn 1000 times too large or too small."""
    return replace(case.clean, scale=float(rng.choice((1e3, 1e-3))))


def about_origin(case: Case, rng: Rng) -> Numbers:
    """The tensor about the link's origin instead of the COM."""
    whole = case.truth.whole
    return replace(case.full, six=six_of(whole.inertia + whole.mass * steiner(whole.com)))


def positive_notation(case: Case, rng: Rng) -> Numbers:
    """About the link's origin, the products with the CAD system's sign."""
    return replace(about_origin(case, rng), six=about_origin(case, rng).six * (1, -1, -1, 1, -1, 1))


def steiner_twice(case: Case, rng: Rng) -> Numbers:
    """A tensor that was about the COM already, moved there from the link's origin once more."""
    whole = case.truth.whole
    return replace(case.full, six=six_of(whole.inertia - whole.mass * steiner(whole.com)))


def steiner_missing(case: Case, rng: Rng) -> Numbers | None:
    """The tensors of several bodies, each about its own COM, added up as they are."""
    if len(case.truth.pieces) < 2:
        return None
    return replace(case.full, six=six_of(sum((p.inertia for p in case.truth.pieces), np.zeros((3, 3)))))


def one_piece(case: Case, rng: Rng) -> Numbers | None:
    """All numbers of one of several bodies."""
    pieces = case.truth.pieces
    return None if len(pieces) < 2 else case.of(pieces[rng.integers(len(pieces))])


def products_sign(case: Case, rng: Rng) -> Numbers:
    """All three products of inertia with the CAD system's sign."""
    return replace(case.full, six=case.full.six * (1, -1, -1, 1, -1, 1))


def axes_permuted(case: Case, rng: Rng) -> Numbers:
    """The tensor's axes renamed, the COM right."""
    order = list(permutations(range(3)))[1 + rng.integers(5)]
    return replace(case.full, six=six_of(case.truth.whole.inertia[np.ix_(order, order)]))


def slots_swapped(case: Case, rng: Rng) -> Numbers:
    """Two of the six numbers in each other's place."""
    order = np.arange(6)
    one, other = rng.choice(6, 2, replace=False)
    order[[one, other]] = other, one
    return replace(case.full, six=case.full.six[order])


def quarter_turn(case: Case, rng: Rng) -> Numbers:
    """COM and tensor of the part turned by 90° about an axis of the link, as when y is up elsewhere."""
    turn = _about(int(rng.integers(3)), float(rng.choice((-1, 1))) * np.pi / 2)
    whole = case.truth.whole
    return case.of(Body(whole.mass, turn @ whole.com, turn @ whole.inertia @ turn.T))


def com_missing(case: Case, rng: Rng) -> Numbers:
    """The COM left at the link's origin."""
    return replace(case.clean, com=np.zeros(3))


def unmirrored(case: Case, rng: Rng) -> Numbers:
    """COM and tensor of the mirrored part."""
    mirror = np.eye(3)
    axis = rng.integers(3)
    mirror[axis, axis] = -1
    whole = case.truth.whole
    return case.of(Body(whole.mass, mirror @ whole.com, mirror @ whole.inertia @ mirror))


def rpy_missing(case: Case, rng: Rng) -> Numbers:
    """Principal moments without the rotation to their axes."""
    return replace(case.diagonal, rpy=np.zeros(3))


def rpy_twice(case: Case, rng: Rng) -> Numbers:
    """A tensor in the link's axes already, and the rotation to the principal axes as well."""
    return replace(case.diagonal, six=case.full.six)


def diagonal_first(case: Case, rng: Rng) -> Numbers:
    """The six numbers as ``xx yy zz xy xz yz`` in URDF's slots."""
    return replace(case.clean, six=case.clean.six[[0, 3, 5, 1, 2, 4]])


def row_major(case: Case, rng: Rng) -> Numbers:
    """The first six numbers of the matrix, row by row, in URDF's slots."""
    return replace(case.clean, six=case.clean.six[[0, 1, 2, 1, 3, 4]])


def negative_diagonal(case: Case, rng: Rng) -> Numbers:
    """One moment with a minus."""
    return replace(case.clean, six=case.clean.six * _at(6, rng.choice((0, 3, 5)), -1.0))


def one_sign(case: Case, rng: Rng) -> Numbers | None:
    """One coordinate of the COM or one product with the wrong sign."""
    return _one(case.full, rng, -1.0, (1, 2, 3, 5, 6, 8))


def decimal_point(case: Case, rng: Rng) -> Numbers | None:
    """One of the ten numbers ten times too large or too small."""
    return _one(case.clean, rng, float(rng.choice((0.1, 10.0))), range(10))


def decimal_point_of_all(case: Case, rng: Rng) -> Numbers:
    """The whole COM or the whole tensor ten or a hundred times too large or too small, or the mass ten times."""
    which, factor = int(rng.integers(3)), float(rng.choice((0.01, 0.1, 10.0, 100.0)))
    clean = case.clean
    if which == 0:
        return replace(clean, com=clean.com * factor)
    if which == 1:
        return replace(clean, six=clean.six * factor)
    return replace(clean, mass=clean.mass * (10.0 if factor > 1 else 0.1))


def six_equal(case: Case, rng: Rng) -> Numbers:
    """One number six times: a placeholder that was typed for the products as well."""
    value = float(rng.choice((1, 2, 5))) * 10.0 ** rng.integers(-6, 1)
    return Numbers(case.truth.whole.mass, case.truth.whole.com, np.full(6, value), np.zeros(3))


def slots_shifted(case: Case, rng: Rng) -> Numbers:
    """The six numbers one slot too late or too early."""
    return replace(case.clean, six=np.roll(case.clean.six, rng.choice((-1, 1))))


def rounded(case: Case, rng: Rng) -> Numbers | None:
    """The tensor with so few decimals that its largest number has one digit; where a moment is off by a third then."""
    decimals = -int(np.floor(np.log10(np.abs(case.full.six).max())))
    six = case.full.six.round(decimals)
    moments = case.full.six[[0, 3, 5]]
    return replace(case.full, six=six) if (np.abs(six[[0, 3, 5]] - moments) > 0.34 * moments).any() else None


def shell(case: Case, rng: Rng) -> Numbers:
    """COM and tensor of the surface, as a thin shell of the same mass."""
    surfaces = [_shell(piece) for piece in case.part.pieces]
    return case.of(_with_mass(combined(surfaces), case.truth.whole.mass))


def bounding_box(case: Case, rng: Rng) -> Numbers:
    """The formula of a solid box on the part's extent; the COM right, or the box's centre."""
    low, high = case.part.mesh.bounds
    a, b, c = (high - low) ** 2
    mass = case.truth.whole.mass
    com = case.truth.whole.com if rng.random() < 0.5 else (low + high) / 2
    return Numbers(mass, com, six_of(np.diag((b + c, a + c, a + b)) * mass / 12), np.zeros(3))


def convex_hull(case: Case, rng: Rng) -> Numbers:
    """COM and tensor of each mesh's filled convex hull."""
    hulls = combined([uniform(piece.convex_hull, 1.0) for piece in case.part.pieces])
    return case.of(_with_mass(hulls, case.truth.whole.mass))


def other_mass(case: Case, rng: Rng) -> Numbers:
    """The tensor of a part of the same shape that weighs 1.5 to 20 times more or less."""
    factor = np.exp(rng.uniform(np.log(1.5), np.log(20)) * rng.choice((-1, 1)))
    return replace(case.clean, six=case.clean.six * factor)


def density(case: Case, rng: Rng) -> Numbers:
    """Mass and tensor of a material that no part is made of: below 10 or above 40,000 kg/m³."""
    low, high = ((0.05, 10), (4e4, 1e7))[rng.integers(2)]
    volume = sum(piece.volume for piece in case.part.pieces)
    factor = np.exp(rng.uniform(np.log(low), np.log(high))) * volume / case.truth.whole.mass
    return replace(case.clean, mass=case.clean.mass * factor, six=case.clean.six * factor)


def placeholder(case: Case, rng: Rng) -> Numbers:
    """1, 2 or 5 times a power of ten on the diagonal; the COM right, or left at the origin."""
    value = float(rng.choice((1, 2, 5))) * 10.0 ** rng.integers(-6, 1)
    com = case.truth.whole.com * rng.integers(2)
    return Numbers(case.truth.whole.mass, com, value * np.array((1.0, 0, 0, 1, 0, 1)), np.zeros(3))


def copied(case: Case, rng: Rng) -> Numbers:
    """All numbers of another part."""
    return case.of(case.other)


def com_moved(case: Case, rng: Rng) -> Numbers:
    """The COM off by 0.2 to 0.8 of the radius of gyration, the tensor right."""
    whole = case.truth.whole
    gyration = np.sqrt(np.trace(whole.inertia) / (2 * whole.mass))
    away = rng.normal(size=3)
    return case.of(replace(whole, com=whole.com + away / np.linalg.norm(away) * gyration * rng.uniform(0.2, 0.8)))


def tensor_stretched(case: Case, rng: Rng) -> Numbers:
    """The tensor of the part stretched along three random directions by up to 2.7 times, the COM right."""
    whole = case.truth.whole
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    logs = rng.normal(size=3)
    stretch = axes * np.exp(logs / np.linalg.norm(logs) * rng.uniform(0.3, 1.0)) @ axes.T
    second = stretch @ (np.trace(whole.inertia) / 2 * np.eye(3) - whole.inertia) @ stretch
    return case.of(replace(whole, inertia=np.trace(second) * np.eye(3) - second))


def mass_changed(case: Case, rng: Rng) -> Numbers:
    """Mass and tensor of a material 1.5 to 5 times as dense or as light."""
    factor = np.exp(rng.uniform(np.log(1.5), np.log(5)) * rng.choice((-1, 1)))
    return replace(case.clean, mass=case.clean.mass * factor, six=case.clean.six * factor)


def _shell(mesh: Trimesh) -> Body:
    """A thin shell of 1 kg/m². The second moments of a triangle are those of 1/12 of its mass in each corner and 3/4 in its
    centroid."""
    areas, corners = mesh.area_faces, mesh.triangles
    mass = float(areas.sum())
    places = np.concatenate((corners.reshape(-1, 3), corners.mean(axis=1)))
    weights = np.concatenate((np.repeat(areas / 12, 3), areas * 0.75))
    com = weights @ places / mass
    offset = places - com
    second = (offset * weights[:, None]).T @ offset
    return Body(mass, com, np.trace(second) * np.eye(3) - second)


def _with_mass(body: Body, mass: float) -> Body:
    return Body(mass, body.com, body.inertia * mass / body.mass)


def _at(length: int, index: int, value: float) -> Array:
    factors = np.ones(length)
    factors[index] = value
    return factors


def _one(numbers: Numbers, rng: Rng, factor: float, among: Sequence[int]) -> Numbers | None:
    """One of mass, COM and the six (in this order) times a factor, of those ``among`` them that are not zero."""
    ten = np.array((numbers.mass, *numbers.com, *numbers.six))
    largest = np.repeat((ten[0], np.abs(ten[1:4]).max(), np.abs(ten[4:]).max()), (1, 3, 6))
    candidates = [i for i in among if abs(ten[i]) > _NOISE * largest[i]]
    if not candidates:
        return None
    ten[rng.choice(candidates)] *= factor
    return replace(numbers, mass=float(ten[0]), com=ten[1:4], six=ten[4:])


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of mistake.

    ``names``: the causes that say what it is. ``hidden``: one link need not show it where the part is not uniform (see the
    README). ``lossy``: it loses numbers, so that undoing it takes them from the mesh. ``instead``: it takes another body for
    the solid that is drawn, and has no effect where that is much the same one. ``elsewhere``: other rules look for it
    first, by density, by round numbers and by equal ones. Without ``names`` it is none of the common mistakes, and every
    cause that is named is a wrong one.
    """

    make: Mistake
    names: frozenset[str]
    hidden: bool = False
    lossy: bool = False
    instead: bool = False
    elsewhere: bool = False

    @property
    def common(self) -> bool:
        """Whether the diagnosis is expected to name it."""
        return bool(self.names) and not self.elsewhere

    @property
    def name(self) -> str:
        return self.make.__name__


def _kind(make: Mistake, *names: str, **flags: bool) -> Kind:
    return Kind(make, frozenset(names or (make.__name__,)), **flags)


# The one place where mistakes meet the names that urdfcheck has for them (`HYPOTHESES` of `urdfcheck.facts.inertials.mistakes`).
KINDS = (
    _kind(inertia_unit, "inertia_unit", "units"),  # one of several units that fit is none that is certain
    _kind(mass_unit),
    _kind(mass_and_inertia_unit, "units"),
    _kind(all_units, "units"),
    _kind(com_unit),
    _kind(mesh_scale),
    _kind(about_origin, hidden=True),
    _kind(steiner_twice),
    _kind(steiner_missing, lossy=True),
    _kind(one_piece, lossy=True),
    _kind(products_sign, hidden=True),
    _kind(axes_permuted, "axes_permuted", "slots_swapped", hidden=True),
    _kind(slots_swapped, hidden=True),
    _kind(quarter_turn, hidden=True),
    _kind(com_missing, lossy=True),
    _kind(unmirrored, hidden=True),
    _kind(rpy_missing, hidden=True, lossy=True),
    _kind(rpy_twice, hidden=True),
    _kind(diagonal_first),
    _kind(row_major, lossy=True),
    _kind(negative_diagonal, "one_sign"),
    _kind(one_sign, hidden=True),
    _kind(decimal_point),
    _kind(shell, lossy=True, instead=True),
    _kind(bounding_box, lossy=True, instead=True),
    _kind(convex_hull, lossy=True, instead=True),
    _kind(other_mass, hidden=True, lossy=True),
    _kind(density, elsewhere=True),
    _kind(placeholder, elsewhere=True),
    _kind(copied, elsewhere=True),
    Kind(com_moved, frozenset()),
    Kind(tensor_stretched, frozenset()),
    Kind(mass_changed, frozenset()),
    # Where the products hardly matter, that the tensor is about the origin is all that is certain.
    _kind(positive_notation, "positive_notation", "about_origin", hidden=True),
    _kind(slots_shifted, hidden=True),
    _kind(decimal_point_of_all, "decimal_point", "com_unit", hidden=True),  # a hundredth of a metre is a centimetre
    _kind(rounded, hidden=True, lossy=True),
    _kind(six_equal, "products_filled", elsewhere=True),
)
