"""The common mistakes in an ``<inertial>``: how often each is made, and the numbers with it undone.

Each mistake is a small generator of hypotheses. Most mistakes only multiply what was typed, and undoing them is a matrix that
does not depend on the part (`MULTIPLYING_MISTAKES`); the others mix the numbers, or lose some (`OTHER_MISTAKES`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_mass_covariance, compute_solid_inertia
from urdfcheck.facts.inertials.inertial_fit import LOG_SQRT_2PI, InertialBatch, Reference, compute_whitening

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Mat3, Vec3

# Natural logarithm of how often a mistake is made, relative to no mistake: e⁻³ = 1 in 20, e⁻⁵ = 1 in 150. A name in brackets is
# a rarer or likelier form of the mistake, or one that stands for several values.
#
# No prior was fitted. They are steps of half a nat by plausibility, and the parts that benchmarks/accuracy keeps for tuning
# decided which to keep. "Confirmed" counts the findings in 104 published robots that a person read and found true
# (benchmarks/accuracy/labels.tsv, 2026-11-21). "Suspected" counts links that a prototype named among 2,291 links of 286
# published files, unread.
LOG_PRIORS = {
    "none": 0.0,
    # Suspected: 30 links with some wrong unit. CAD programs report g and mm; pounds and tonnes are rarer.
    "inertia_unit": -3.0,
    "inertia_unit (lb, t)": -4.0,
    "inertia_unit (a power of ten)": -5.0,  # not a unit in use
    "mass_unit": -3.0,  # g
    "mass_unit (lb, mg, t)": -4.0,
    "com_unit": -3.0,
    # Several numbers in the units of one program; half a nat less than one of them alone.
    "units": -3.5,
    "units (g and g·m²)": -4.0,  # the mass in g, and the inertia per that mass
    "units (mg and mg·m²)": -5.0,
    "mesh_scale": -3.5,  # millimetres
    "mesh_scale (cm, in)": -4.5,
    "about_origin": -2.5,  # CAD programs print the tensor about the origin beside that about the COM
    "steiner_twice": -3.5,  # less obvious: the theorem was known
    "steiner_missing": -4.5,  # confirmed: 15 links of 2 robots; needs several pieces
    "one_piece": -4.0,  # confirmed: 1
    "products_sign": -2.5,  # confirmed: 6 links of 4 robots; suspected: 54 links of 16 files
    "axes_permuted": -3.5,  # confirmed: 1; each of five orders
    "slots_swapped": -5.0,  # a slip of the hand; each of 15 pairs
    "quarter_turn": -4.0,  # each of six
    "com_missing": -2.5,  # confirmed: 5 links of 4 robots
    "unmirrored": -3.0,
    "unmirrored (has a twin)": -2.0,  # a part with a mirror image is the one whose numbers were copied
    "rpy_missing": -3.0,  # confirmed: 1
    "rpy_twice": -3.5,
    "diagonal_first": -3.0,  # the order of MuJoCo's fullinertia
    # Two of six numbers are equal to the last digit, which chance does in one part of thousands: evidence, not frequency.
    "row_major": 8.0,
    "row_major (of zeros)": 0.0,
    "one_sign": -4.5,  # a slip of the hand; each of nine numbers
    # A slip of the hand; each of ten numbers and six powers of ten, half a nat less per digit; or all of the COM's.
    "decimal_point": -4.5,
    "shell": -3.0,  # suspected: 24 links
    "bounding_box": -3.0,  # suspected: 25 links
    "convex_hull": -3.5,
    "other_mass": -3.5,  # confirmed: 10 links of 2 robots; spread over all masses, see `_REVISION`
}
# What each further power of ten of a lost decimal point costs.
_PER_DIGIT = 0.5
# A mass that was changed afterwards differs by this much (standard deviation of its logarithm).
_REVISION = 1.2

# The ids of the mistakes that can be named.
HYPOTHESES = tuple(name for name in LOG_PRIORS if "(" not in name and name != "none")

# A mistake that changes less, a seventh of the mass or the second moments, is not reported.
EFFECT = 0.15
# In a part of more pieces, nobody mistakes one for the whole.
_MOST_PIECES = 6

# kg, m and kg m² of what files are written in instead, with the name of the prior.
_INCH, _POUND = 0.0254, 0.45359237
_INERTIA_UNITS = (
    ("kg·cm²", 1e-4, "inertia_unit"),
    ("kg·mm²", 1e-6, "inertia_unit"),
    ("g·m²", 1e-3, "inertia_unit"),
    ("g·cm²", 1e-7, "inertia_unit"),
    ("g·mm²", 1e-9, "inertia_unit"),
    ("lb·in²", _POUND * _INCH**2, "inertia_unit (lb, t)"),
    ("lb·ft²", _POUND * (12 * _INCH) ** 2, "inertia_unit (lb, t)"),
    ("t·mm²", 1e-3, "inertia_unit (lb, t)"),
    *((f"1e-{power} kg·m²", 10.0**power, "inertia_unit (a power of ten)") for power in (3, 6, 9)),
)
_MASS_UNITS = (
    ("g", 1e-3, "mass_unit"),
    ("lb", _POUND, "mass_unit (lb, mg, t)"),
    ("mg", 1e-6, "mass_unit (lb, mg, t)"),
    ("t", 1e3, "mass_unit (lb, mg, t)"),
)
# Mass and inertia, and the length that a COM may be in as well.
_COHERENT_UNITS = (
    ("g and g·mm²", 1e-3, 1e-9, "mm", 1e-3),
    ("g and g·cm²", 1e-3, 1e-7, "cm", 1e-2),
    ("lb and lb·in²", _POUND, _POUND * _INCH**2, "in", _INCH),
    ("g and kg·mm²", 1e-3, 1e-6, "mm", 1e-3),
)
# Mass and inertia with the COM in metres.
_MASS_PREFIXES = (
    ("g and g·m²", 1e-3, "units (g and g·m²)"),
    ("mg and mg·m²", 1e-6, "units (mg and mg·m²)"),
)
# The COM, and the inertia that may be in the square of its unit.
_LENGTH_UNITS = (
    ("mm", "mm", 1e-3, "kg·mm²", 1e-6),
    ("cm", "cm", 1e-2, "kg·cm²", 1e-4),
    ("inches", "in", _INCH, "kg·in²", _INCH**2),
)
_MESH_SCALES = (
    ("1000", 1e3, "mesh_scale"),
    ("0.001", 1e-3, "mesh_scale"),
    ("100", 1e2, "mesh_scale (cm, in)"),
    ("0.01", 1e-2, "mesh_scale (cm, in)"),
    ("0.0254", _INCH, "mesh_scale (cm, in)"),
    ("39.37", 1 / _INCH, "mesh_scale (cm, in)"),
)
_DECIMAL_POWERS = (1, -1, 2, -2, 3, -3)
# Those by which the unit of the whole COM is wrong: cm and mm.
_LENGTH_POWERS = frozenset({-2, -3})

# URDF's order of the components, and their places in the matrix.
_COMPONENT_NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_COMPONENT_INDICES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
_COMPONENT_AT = {(i, j): n for n, (i, j) in enumerate(_COMPONENT_INDICES)} | {
    (j, i): n for n, (i, j) in enumerate(_COMPONENT_INDICES)
}
# The component at each of the nine places of the matrix, row by row.
_TO_MATRIX = (0, 1, 2, 1, 3, 4, 2, 4, 5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistake:
    """One mistake with its parameter."""

    id: str
    """One of `HYPOTHESES`, or ``none``."""
    detail: str = ""
    """The parameter, such as a unit."""
    log_prior: float
    factor: float = 1.0
    """How many times as large as drawn the part is."""
    borrowed: tuple[int, int] = (0, 0)
    """Degrees of freedom of the tensor and of the COM that are taken from the reference to undo the mistake."""
    source_body: Solid | None = None
    """The body whose numbers were taken for the part's."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Multiplier:
    """Turns what is typed into what was meant."""

    mass: float = 1.0
    com: Vec3 = field(default_factory=lambda: np.ones(3))
    components: Array = field(default_factory=lambda: np.eye(6))
    """(6, 6), for the components of the tensor in URDF's order."""


@dataclass(frozen=True, eq=False)
class Suspect:
    """An inertial, and what it is compared with."""

    declared: DeclaredInertial
    reference: Reference
    geometry: VisualGeometry | None

    @cached_property
    def has_turned_frame(self) -> bool:
        return bool(np.abs(self.declared.rotation - np.eye(3)).max() > 1e-6)

    @cached_property
    def parallel_axis_shift(self) -> Mat3:
        """What the parallel-axis theorem adds from the COM to the link's origin, in the inertial frame's axes."""
        mass, lever = self.declared.mass, self.declared.rotation.T @ self.declared.com
        shift: Mat3 = mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
        return shift


Multiplied = Iterator[tuple[Mistake, Multiplier]]
Corrected = Iterator[tuple[Mistake, DeclaredInertial]]


def list_explanations(suspect: Suspect) -> tuple[list[Mistake], InertialBatch]:
    """List every mistake, "none" first, and the numbers without it."""
    declared = suspect.declared
    multiplying, mass, com, components = _stack_multipliers()
    typed = np.array([declared.tensor[place] for place in _COMPONENT_INDICES])
    multiplied = InertialBatch(
        mass=mass * declared.mass,
        com=com * declared.com,
        tensor=(components @ typed)[:, _TO_MATRIX].reshape(-1, 3, 3),
        rotation=np.broadcast_to(declared.rotation, (len(multiplying), 3, 3)),
    )
    others = [corrected for undo in OTHER_MISTAKES for corrected in undo(suspect)]
    mistakes = [*multiplying, *(mistake for mistake, _ in others)]
    return mistakes, multiplied.concatenate_with(InertialBatch.from_inertials([numbers for _, numbers in others]))


@cache
def _stack_multipliers() -> tuple[tuple[Mistake, ...], Array, Array, Array]:
    """Return the multiplying mistakes, and what the mass (N,), the COM (N, 3) and the components (N, 6, 6) are multiplied by."""
    pairs = [pair for undo in MULTIPLYING_MISTAKES for pair in undo()]
    return (
        tuple(mistake for mistake, _ in pairs),
        np.array([multiplier.mass for _, multiplier in pairs]),
        np.array([multiplier.com for _, multiplier in pairs]),
        np.array([multiplier.components for _, multiplier in pairs]),
    )


def _make_mistake(prior: str, detail: str = "", *, penalty: float = 0.0) -> Mistake:
    """Make a mistake whose ``prior`` is a name of `LOG_PRIORS`, made less likely by ``penalty`` nats."""
    return Mistake(id=prior.partition(" (")[0], detail=detail, log_prior=LOG_PRIORS[prior] - penalty)


# -- mistakes that multiply ---------------------------------------------------------------------------------------------


def _undo_nothing() -> Multiplied:
    yield _make_mistake("none"), Multiplier()


def _undo_inertia_unit() -> Multiplied:
    for unit, factor, prior in _INERTIA_UNITS:
        yield _make_mistake(prior, unit), Multiplier(components=np.eye(6) * factor)


def _undo_mass_unit() -> Multiplied:
    for unit, factor, prior in _MASS_UNITS:
        yield _make_mistake(prior, unit), Multiplier(mass=factor)


def _undo_coherent_units() -> Multiplied:
    for units, mass, inertia, length_unit, length in _COHERENT_UNITS:
        components = np.eye(6) * inertia
        yield _make_mistake("units", units), Multiplier(mass=mass, components=components)
        with_com = Multiplier(mass=mass, com=np.ones(3) * length, components=components)
        yield _make_mistake("units", f"{units}, {length_unit}"), with_com
    for units, factor, prior in _MASS_PREFIXES:
        yield _make_mistake(prior, units), Multiplier(mass=factor, components=np.eye(6) * factor)


def _undo_length_unit() -> Multiplied:
    """The unit of the COM, alone and also in the inertia."""
    for name, unit, length, inertia_unit, squared in _LENGTH_UNITS:
        com = np.ones(3) * length
        yield _make_mistake("com_unit", name), Multiplier(com=com)
        with_inertia = Multiplier(com=com, components=np.eye(6) * squared)
        yield _make_mistake("units", f"kg and {inertia_unit}, {unit}"), with_inertia


def _undo_mesh_scale() -> Multiplied:
    for text, factor, prior in _MESH_SCALES:
        yield replace(_make_mistake(prior, text), factor=factor), Multiplier()


def _undo_products_sign() -> Multiplied:
    yield _make_mistake("products_sign"), Multiplier(components=np.diag((1.0, -1.0, -1.0, 1.0, -1.0, 1.0)))


def _undo_axes_permuted() -> Multiplied:
    for order in ((1, 0, 2), (2, 1, 0), (0, 2, 1), (1, 2, 0), (2, 0, 1)):
        source = [_COMPONENT_AT[order[i], order[j]] for i, j in _COMPONENT_INDICES]
        yield (
            _make_mistake("axes_permuted", " ".join("xyz"[i] for i in order)),
            Multiplier(components=np.eye(6)[source]),
        )


def _undo_slots_swapped() -> Multiplied:
    for i, j in combinations(range(6), 2):
        source = list(range(6))
        source[i], source[j] = j, i
        names = f"{_COMPONENT_NAMES[i]} and {_COMPONENT_NAMES[j]}"
        yield _make_mistake("slots_swapped", names), Multiplier(components=np.eye(6)[source])


def _undo_diagonal_first() -> Multiplied:
    yield _make_mistake("diagonal_first"), Multiplier(components=np.eye(6)[[0, 3, 4, 1, 5, 2]])


def _undo_one_sign() -> Multiplied:
    for name, multiplier in _iter_tensor_and_com_numbers(-1.0):
        yield _make_mistake("one_sign", name), multiplier


def _undo_decimal_point() -> Multiplied:
    for power in _DECIMAL_POWERS:
        factor, penalty = 10.0**power, _PER_DIGIT * abs(power)
        mass = _make_mistake("decimal_point", f"mass {factor:g}", penalty=penalty)
        yield mass, Multiplier(mass=factor)
        for name, multiplier in _iter_tensor_and_com_numbers(factor):
            yield _make_mistake("decimal_point", f"{name} {factor:g}", penalty=penalty), multiplier
        if power not in _LENGTH_POWERS:
            yield (
                _make_mistake("decimal_point", f"com {factor:g}", penalty=penalty),
                Multiplier(com=np.ones(3) * factor),
            )


def _iter_tensor_and_com_numbers(factor: float) -> Iterator[tuple[str, Multiplier]]:
    """Multiply one number of the tensor or the COM after the other."""
    for i, name in enumerate(_COMPONENT_NAMES):
        diagonal = np.ones(6)
        diagonal[i] = factor
        yield name, Multiplier(components=np.diag(diagonal))
    for i, axis in enumerate("xyz"):
        com = np.ones(3)
        com[i] = factor
        yield f"com {axis}", Multiplier(com=com)


# Mistakes that multiply, in the order in which equally likely ones are preferred.
MULTIPLYING_MISTAKES: tuple[Callable[[], Multiplied], ...] = (
    _undo_nothing,
    _undo_inertia_unit,
    _undo_mass_unit,
    _undo_coherent_units,
    _undo_length_unit,
    _undo_mesh_scale,
    _undo_products_sign,
    _undo_axes_permuted,
    _undo_slots_swapped,
    _undo_diagonal_first,
    _undo_one_sign,
    _undo_decimal_point,
)


# -- mistakes that mix the numbers, or lose some -------------------------------------------------------------------------


def _undo_about_origin(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    yield _make_mistake("about_origin"), replace(declared, tensor=declared.tensor - suspect.parallel_axis_shift)


def _undo_steiner_twice(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    yield _make_mistake("steiner_twice"), replace(declared, tensor=declared.tensor + suspect.parallel_axis_shift)


def _undo_quarter_turn(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    for name, turn in _iter_quarter_turns():
        turned = replace(declared, com=turn @ declared.com)
        if suspect.has_turned_frame:
            turned = replace(turned, rotation=turn @ declared.rotation)
        else:
            turned = replace(turned, tensor=turn @ declared.tensor @ turn.T)
        yield _make_mistake("quarter_turn", name), turned


def _iter_quarter_turns() -> Iterator[tuple[str, Mat3]]:
    for i, axis in enumerate("xyz"):
        j, k = (i + 1) % 3, (i + 2) % 3
        for sign in (1.0, -1.0):
            turn = np.zeros((3, 3))
            turn[i, i] = 1.0
            turn[k, j], turn[j, k] = sign, -sign
            yield f"{'+' if sign > 0 else '-'}90° about {axis}", turn


def _undo_unmirrored(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    prior = "unmirrored" if suspect.reference.twin is None else "unmirrored (has a twin)"
    for i, axis in enumerate("xyz"):
        mirror = np.eye(3)
        mirror[i, i] = -1.0
        mirrored = DeclaredInertial(
            mass=declared.mass,
            com=mirror @ declared.com,
            tensor=mirror @ declared.tensor @ mirror,
            rotation=mirror @ declared.rotation @ mirror,
        )
        yield _make_mistake(prior, axis), mirrored


def _undo_rpy_twice(suspect: Suspect) -> Corrected:
    if suspect.has_turned_frame:
        yield _make_mistake("rpy_twice"), replace(suspect.declared, rotation=np.eye(3))


def _undo_com_missing(suspect: Suspect) -> Corrected:
    """The COM is taken from the reference."""
    if np.abs(suspect.declared.com).any():
        return
    twin = suspect.reference.twin
    com = suspect.reference.com if twin is None else twin.com
    com = np.where(np.abs(com) > 1e-3 * np.abs(com).max(), com, 0.0)  # what a mesh leaves of a zero
    yield replace(_make_mistake("com_missing"), borrowed=(0, 3)), replace(suspect.declared, com=com)


def _undo_rpy_missing(suspect: Suspect) -> Corrected:
    """The three angles are taken from the reference."""
    tensor = suspect.declared.tensor
    diagonal = np.diag(np.diag(tensor))
    if not suspect.has_turned_frame and np.abs(tensor - diagonal).max() < 1e-3 * np.abs(tensor).max():
        aligned = _align_principal_axes(np.diag(tensor), suspect.reference.covariance)
        yield replace(_make_mistake("rpy_missing"), borrowed=(3, 0)), replace(suspect.declared, tensor=aligned)


def _align_principal_axes(moments: Vec3, covariance: Mat3) -> Mat3:
    """Return the tensor (3, 3) with these principal moments along the principal axes of the reference, in the same order of
    size."""
    _, axes = np.linalg.eigh(covariance)
    ordered = np.sort(moments)[::-1]  # the least variance goes with the greatest moment
    aligned: Mat3 = (axes * ordered) @ axes.T
    return aligned


def _undo_row_major(suspect: Suspect) -> Corrected:
    """The third row is lost: the moment about z is about that of the reference."""
    declared, covariance = suspect.declared, suspect.reference.covariance
    tensor = declared.tensor
    if tensor[0, 1] != tensor[1, 1]:
        return
    prior = "row_major" if tensor[0, 1] else "row_major (of zeros)"
    expected = float(declared.mass * (covariance[0, 0] + covariance[1, 1]))
    (xx, xy, xz), yy, yz = tensor[0], tensor[1, 2], tensor[2, 2]
    for zz in expected * np.array((0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0)):
        rows = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
        yield replace(_make_mistake(prior), borrowed=(1, 0)), replace(declared, tensor=rows)


def _undo_other_mass(suspect: Suspect) -> Corrected:
    """The size of the tensor is taken from the reference; a mass that is farther from the declared one is less likely."""
    declared = suspect.declared
    scale = _compute_tensor_scale(declared, suspect.reference)
    if scale is None:
        return
    log_prior = LOG_PRIORS["other_mass"] - 0.5 * (math.log(scale) / _REVISION) ** 2 - math.log(_REVISION) - LOG_SQRT_2PI
    detail = f"{declared.mass / scale:.3g} kg"
    mistake = Mistake(id="other_mass", detail=detail, log_prior=log_prior, borrowed=(1, 0))
    yield mistake, replace(declared, tensor=declared.tensor * scale)


def _compute_tensor_scale(declared: DeclaredInertial, reference: Reference) -> float | None:
    """Compute by what the tensor must be multiplied for the second moments to have the reference's size; None when they have
    none."""
    covariance = compute_mass_covariance(declared.inertia, declared.mass) if declared.mass > 0 else np.zeros((3, 3))
    white = reference.whitening
    ratios = np.linalg.eigvalsh(white @ covariance @ white)
    return float(np.exp(-np.log(ratios).mean())) if ratios[0] > 0 else None


def _undo_steiner_missing(suspect: Suspect) -> Corrected:
    geometry, declared = suspect.geometry, suspect.declared
    if geometry is not None and len(geometry.pieces) > 1:
        term = _compute_parallel_axis_term(geometry, declared.mass, declared.rotation)
        yield _make_mistake("steiner_missing"), replace(declared, tensor=declared.tensor + term)


def _compute_parallel_axis_term(geometry: VisualGeometry, mass: float, rotation: Mat3) -> Mat3:
    """Compute what the parallel-axis theorem adds for the pieces of a part of uniform density, in the inertial frame's axes."""
    volumes = np.array([piece.volume for piece in geometry.pieces])
    levers = (np.array([piece.com for piece in geometry.pieces]) - geometry.solid.com) @ rotation
    second = (levers.T * (mass * volumes / volumes.sum())) @ levers
    added: Mat3 = np.trace(second) * np.eye(3) - second
    return added


def _undo_other_body(suspect: Suspect) -> Corrected:
    """The numbers are those of another body: the part's own are those of its twin, or of its uniform solid."""
    geometry, mass = suspect.geometry, suspect.declared.mass
    if geometry is None:
        return
    solid = geometry.solid
    own = suspect.reference.twin or DeclaredInertial(mass, solid.com, compute_solid_inertia(solid, mass))
    for name, body in _iter_other_bodies(geometry):
        if _is_different_shape(body, solid):
            yield replace(_make_mistake(name), source_body=body), own


def _iter_other_bodies(geometry: VisualGeometry) -> Iterator[tuple[str, Solid]]:
    """Return the bodies that may be taken for the part."""
    if geometry.shell is not None:
        yield "shell", geometry.shell
    if geometry.box is not None:
        yield "bounding_box", geometry.box
    if geometry.closed and geometry.hull is not None:
        yield "convex_hull", geometry.hull
    if len(geometry.pieces) > 1:
        for piece in geometry.pieces[:_MOST_PIECES]:
            yield "one_piece", piece


def _is_different_shape(body: Solid, solid: Solid) -> bool:
    """Whether mistaking one body for the other has an effect."""
    white = compute_whitening(solid.covariance)
    ratios = np.linalg.eigvalsh(white @ body.covariance @ white)
    return bool(ratios[0] <= 0.0 or np.linalg.norm(np.log(ratios)) > EFFECT)


# Mistakes that mix the numbers or lose some, in the order in which equally likely ones are preferred.
OTHER_MISTAKES: tuple[Callable[[Suspect], Corrected], ...] = (
    _undo_about_origin,
    _undo_steiner_twice,
    _undo_quarter_turn,
    _undo_unmirrored,
    _undo_rpy_twice,
    _undo_com_missing,
    _undo_rpy_missing,
    _undo_row_major,
    _undo_other_mass,
    _undo_steiner_missing,
    _undo_other_body,
)
