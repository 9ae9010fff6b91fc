"""Why a declared inertia is not that of the drawn part: every common mistake is undone, and what is left is compared.

A part of uniform density has its mesh's COM and second moments; one with a motor or a battery inside differs from them, but
not without limit. Each hypothesis turns the declared numbers into those that would stand there without one mistake, and its
score is the logarithm of how often such a mistake is made, times how likely the mended numbers are for a part of this shape.
A cause is named only when its score beats every other explanation, "no mistake" among them, by a margin.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_mass_covariance, compute_solid_inertia

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools, Indices


# The ids of the mistakes that can be named.
HYPOTHESES = (
    "inertia_unit",
    "mass_unit",
    "com_unit",
    "units",
    "mesh_scale",
    "about_origin",
    "steiner_twice",
    "steiner_missing",
    "one_piece",
    "products_sign",
    "axes_permuted",
    "slots_swapped",
    "quarter_turn",
    "com_missing",
    "unmirrored",
    "rpy_missing",
    "rpy_twice",
    "diagonal_first",
    "row_major",
    "one_sign",
    "decimal_point",
    "shell",
    "bounding_box",
    "convex_hull",
    "other_mass",
)


@dataclass(frozen=True, slots=True, eq=False)
class DeclaredInertial:
    """An ``<inertial>``: ``mass`` (kg), ``com`` (3,) in m in the link's frame, inertia ``tensor`` (3, 3) in kg m² about the COM
    in the axes of the inertial frame, which ``rotation`` (3, 3) turns into the link's."""

    mass: float
    com: Array
    tensor: Array
    rotation: Array = field(default_factory=lambda: np.eye(3))

    @property
    def inertia(self) -> Array:
        """(3, 3) in kg m² about the COM in the link's axes."""
        turned: Array = self.rotation @ self.tensor @ self.rotation.T
        return turned


@dataclass(frozen=True, slots=True, eq=False)
class VisualGeometry:
    """What a link draws, in its frame (m).

    ``solid``: filled with uniform density, exact when ``closed``, else with the convex hull for what is open. ``points`` (K, 3)
    have its convex hull. The same as a filled ``hull``, as a thin ``shell`` (``volume`` is its area) and as the bounding
    ``box``, None where there is none; ``pieces``: the solids of its shapes.
    """

    solid: Solid
    closed: bool
    points: Array
    hull: Solid | None = None
    shell: Solid | None = None
    box: Solid | None = None
    pieces: tuple[Solid, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """``sound``: the numbers need no explanation. ``cause``: the id of the one mistake that explains them, None when none is
    certain, and ``detail`` its parameter, such as a unit. ``mended``: the numbers with the mistake undone.

    ``shape`` and ``place``: how far the inertia and the COM are from those of the reference, see `measure_inertial_mismatch`; ``mended_shape`` and
    ``mended_place`` the same afterwards; ``least``: the smallest ratio of a second moment to the reference's. ``margin`` (nats):
    by how much the best explanation beats every other. ``unique``: of all single mistakes only this one leaves numbers that
    agree with the reference to within what digits and tessellation leave. ``ruled_out``: the ids of the mistakes that were
    undone and do not explain the numbers, likeliest first. ``possible``: whether a mass inside the drawn geometry can have the
    declared numbers. ``by``: the reference that decides, ``mesh`` or ``twin``; ``decided``: whether it is this part rather
    than its twin that is wrong.
    """

    sound: bool
    cause: str | None
    detail: str
    mended: DeclaredInertial | None
    tensor_mismatch: float
    com_mismatch: float
    mended_tensor_mismatch: float
    mended_com_mismatch: float
    min_moment_ratio: float
    margin: float
    unique: bool
    ruled_out: tuple[str, ...]
    possible: bool
    by: str
    decided: bool


# A cause is named when it beats every other explanation by so many nats (e⁵ = 150 : 1).
MARGIN = 5.0
# Numbers that agree with exact geometry to within tessellation and five digits.
EXACT = 0.06

# How real parts differ from their uniform solid: weight, spread of the log-Euclidean mismatch of the second moments (6
# degrees of freedom) and of the COM (3) in radii of gyration. CAD parts of one material; parts with 5 to 60 % of their mass in
# lumps; and anything (1 in 50). These, the priors of the mistakes and the thresholds below were chosen on the parts that
# benchmarks/accuracy keeps for tuning, and are judged on others.
_CLOSED = (
    (0.25, 0.003, 0.003),
    (0.15, 0.02, 0.015),
    (0.20, 0.15, 0.12),
    (0.24, 0.35, 0.30),
    (0.14, 0.70, 0.55),
    (0.02, 1.6, 1.3),
)
# Against the convex hull of an open mesh nothing is exact.
_OPEN = ((0.25, 0.10, 0.08), (0.30, 0.30, 0.25), (0.25, 0.45, 0.40), (0.16, 0.80, 0.60), (0.04, 1.6, 1.3))
# A tensor that was computed from the geometry: typed digits, tessellation.
_COMPUTED = ((0.7, 0.003), (0.3, 0.03))
# How equal parts differ: typed digits, another revision, anything.
_TWIN = ((0.70, 0.002, 0.002), (0.20, 0.05, 0.05), (0.10, 1.2, 1.0))

# Beyond this a part would need most of its mass in one place: COM a radius of gyration away, or second moments five times less.
FAR = 1.6
# A COM or a tensor this near the reference's is that of a part of uniform density: then the other has to agree as well.
UNIFORM = 0.01
# Undoing a mistake has to leave a part that is no farther from its uniform solid than lumps of 60 % make it.
NEAR = 1.5
# A mistake that changes less, a seventh of the mass or the second moments, is not worth a word.
EFFECT = 0.15
# Equal parts differ by less: 2 % in a moment.
TWIN_LIKE = 0.02
# One of two parts is wrong when its numbers are so many nats less likely for its mesh.
SIDE_MARGIN = 5.0
# What typed digits and simplified meshes leave: a tenth of a bound.
SLACK = 0.1
# Ratios of second moments below this are that of a flat part.
_FLAT = 1e-4
# One in twenty links has something heavy that is not drawn.
_NOT_DRAWN = 3.0
# Logarithm of the width of what a degree of freedom taken from the reference might have been.
_TYPICAL = 0.3
# A coordinate that is less than a third of a radius of gyration from zero says nothing about the number that it was.
_NEAR_ZERO = 0.3
# Two of six numbers are equal to the last digit, which chance does in one part of thousands.
_COINCIDENCE = 8.0
# A mass that was changed afterwards was so much another (standard deviation of its logarithm).
_REVISION = 1.2
_LOG_SQRT_2PI = 0.5 * math.log(2.0 * math.pi)
# Numbers of SI units above this, and sizes and masses below its inverse, are no robot's.
_LARGEST = 1e30
_DIRECTIONS = 96
# Of a part of many pieces, nobody takes one for the whole.
_PIECES = 6

# Mistakes of one number: which one it is must be certain.
_PRECISE = frozenset({"decimal_point", "one_sign", "slots_swapped", "one_piece"})
# What a convex hull in place of an open mesh can show: powers of ten, places far outside, another order of the numbers.
_COARSE = frozenset(
    {"inertia_unit", "mass_unit", "com_unit", "units", "mesh_scale", "com_missing", "diagonal_first", "row_major"}
)

# Mistakes that only scale a COM.
_SCALED = frozenset({"com_unit", "decimal_point"})
# Mistakes that lost the part's own numbers, or are not in them, so that undoing them does not lead to those of its twin.
_LOSSY = frozenset(
    {
        *("shell", "bounding_box", "convex_hull", "one_piece", "steiner_missing"),
        *("row_major", "com_missing", "rpy_missing", "mesh_scale"),
    }
)

# Metres, kilograms and kg m² of what files are written in instead.
_INCH, _POUND = 0.0254, 0.45359237
_LENGTH = {"mm": 1e-3, "cm": 1e-2, "in": _INCH}
_MASS = {"g": 1e-3, "lb": _POUND, "mg": 1e-6, "t": 1e3}
_INERTIA = {
    "kg·cm²": 1e-4,
    "kg·mm²": 1e-6,
    "g·m²": 1e-3,
    "g·cm²": 1e-7,
    "g·mm²": 1e-9,
    "lb·in²": _POUND * _INCH**2,
    "lb·ft²": _POUND * (12 * _INCH) ** 2,
    "t·mm²": 1e-3,
}
_COHERENT = {
    "g and g·mm²": (1e-3, 1e-9, 1e-3, "mm"),
    "g and g·cm²": (1e-3, 1e-7, 1e-2, "cm"),
    "lb and lb·in²": (_POUND, _POUND * _INCH**2, _INCH, "in"),
    "g and kg·mm²": (1e-3, 1e-6, 1e-3, "mm"),
}
# URDF's order, and where an entry stands in the matrix.
_COMPONENT_NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_COMPONENT_INDICES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
_SLOT = {(i, j): n for n, (i, j) in enumerate(_COMPONENT_INDICES)} | {
    (j, i): n for n, (i, j) in enumerate(_COMPONENT_INDICES)
}


@dataclass(frozen=True, eq=False)
class _Reference:
    """What numbers are compared with: ``com`` (3,), ``covariance`` (3, 3), and the ``size``, a volume (m³) or, of a twin, a mass.

    ``points`` (K, 3): nothing of the part is outside their convex hull; None where that is not known.
    """

    com: Array
    covariance: Array
    size: float
    mixture: Sequence[tuple[float, float, float]]
    points: Array | None = None
    twin: DeclaredInertial | None = None

    @cached_property
    def whitening(self) -> Array:
        return _compute_whitening(self.covariance)


@dataclass(frozen=True, slots=True)
class _Mistake:
    """One mistake: its id and parameter, the logarithm of how often it is made, the factor by which the part is larger than it
    is drawn, how many degrees of freedom of the tensor and the COM are taken from the reference to undo it, and the ``body``
    whose numbers were taken for the part's."""

    id: str
    detail: str
    prior: float
    factor: float = 1.0
    fitted: tuple[int, int] = (0, 0)
    source_body: Solid | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _LinearMistakes:
    """Mistakes that multiply: ``mass`` (N,), ``com`` (N, 3) and ``six`` (N, 6, 6) turn what is typed into what was meant."""

    kinds: tuple[_Mistake, ...]
    mass: Array
    com: Array
    six: Array


@dataclass(frozen=True, slots=True, eq=False)
class _InertialBatch:
    """Inertials as arrays: ``mass`` (N,), ``com`` (N, 3), ``tensor`` (N, 3, 3) and ``rotation`` (N, 3, 3)."""

    mass: Array
    com: Array
    tensor: Array
    rotation: Array

    @classmethod
    def from_inertials(cls, declared: Sequence[DeclaredInertial]) -> _InertialBatch:
        return cls(
            np.array([d.mass for d in declared], dtype=float),
            np.array([d.com for d in declared], dtype=float).reshape(-1, 3),
            np.array([d.tensor for d in declared], dtype=float).reshape(-1, 3, 3),
            np.array([d.rotation for d in declared], dtype=float).reshape(-1, 3, 3),
        )

    def __getitem__(self, i: int) -> DeclaredInertial:
        return DeclaredInertial(float(self.mass[i]), self.com[i], self.tensor[i], self.rotation[i])

    def take_rows(self, order: NDArray[np.intp]) -> _InertialBatch:
        return _InertialBatch(self.mass[order], self.com[order], self.tensor[order], self.rotation[order])

    def concatenate_with(self, other: _InertialBatch) -> _InertialBatch:
        return _InertialBatch(
            np.concatenate((self.mass, other.mass)),
            np.concatenate((self.com, other.com)),
            np.concatenate((self.tensor, other.tensor)),
            np.concatenate((self.rotation, other.rotation)),
        )

    @property
    def inertia(self) -> Array:
        """(N, 3, 3) about the COM in the link's axes."""
        turned: Array = self.rotation @ self.tensor @ self.rotation.transpose(0, 2, 1)
        return turned

    def find_equal_rows(self, i: int) -> Bools:
        """(N,): which are the same as one of them to within 1 %: of the mass, of the greatest entry of the tensor, and of the
        COM's distance from the origin or the radius of gyration."""
        inertia = self.inertia
        radius = math.sqrt(abs(float(np.trace(inertia[i])) / (2.0 * self.mass[i])))
        reach = max(float(np.abs(self.com[i]).max()), radius)
        alike: Bools = (
            (np.abs(self.mass - self.mass[i]) <= 0.01 * self.mass[i])
            & (np.abs(inertia - inertia[i]).max(axis=(1, 2)) <= 0.01 * np.abs(inertia[i]).max())
            & (np.abs(self.com - self.com[i]).max(axis=1) <= 0.01 * reach)
        )
        return alike


@dataclass(frozen=True, slots=True, eq=False)
class _Ranking:
    """Every explanation, the best first: what it is, its score, the numbers without it, how far they are from the reference, and
    whether the drawn geometry can hold them."""

    kinds: tuple[_Mistake, ...]
    scores: Array
    tensor_mismatches: Array
    com_mismatches: Array
    numbers: _InertialBatch
    possible: Bools

    @property
    def no_mistake_index(self) -> int:
        return next(i for i, kind in enumerate(self.kinds) if kind.id == "none")


def diagnose_inertial(
    declared: DeclaredInertial,
    geometry: VisualGeometry | None,
    twin: DeclaredInertial | None = None,
    *,
    trusted: bool = False,
) -> Diagnosis | None:
    """What is wrong with an inertial, judged by what the link draws and by its ``twin``: the numbers that a mirrored or equal
    part says it should have, in this link's frame. ``trusted``: several such parts agree, so that it is not the twin that is
    wrong.

    None when there is nothing to compare: no geometry with a volume, and no twin that is a possible body; or numbers beyond all
    measure.
    """
    if not _is_computable(declared):
        return None
    twin = twin if twin is not None and _is_body(twin) else None
    geometry = geometry if geometry is not None and _has_size(geometry.solid.com, geometry.solid.covariance) else None
    if twin is None:
        return None if geometry is None else _diagnose_against(declared, _build_geometry_reference(geometry), geometry)
    against_twin = replace(_diagnose_against(declared, _build_twin_reference(twin), geometry), by="twin")
    if geometry is None:
        return replace(against_twin, decided=trusted)
    if against_twin.sound or against_twin.cause is None:
        own = _diagnose_against(declared, _build_geometry_reference(geometry), geometry)
        if against_twin.sound or own.cause in _LOSSY:
            return own
        # What else explains the numbers by themselves has to lead to the twin's: if not, the two just differ.
        if (
            own.mended is not None
            and max(measure_inertial_mismatch(own.mended, *_get_com_and_covariance(twin))) < EXACT
        ):
            return own
    better = against_twin.cause is not None and _is_better_fit(twin, declared, geometry)
    # Several parts may be wrong alike, and the one that has its own geometry's numbers right.
    return replace(against_twin, decided=better or (trusted and not _is_better_fit(declared, twin, geometry)))


def measure_inertial_mismatch(declared: DeclaredInertial, com: Array, covariance: Array) -> tuple[float, float]:
    """How far an inertial is from a reference: the log-Euclidean distance of the second moments, ``|log W C W|`` with ``W``
    the inverse root of the reference's ``covariance`` (3, 3), and the distance of the COMs in its radii of gyration,
    ``|W (c - com)|``.

    Infinite for a tensor that no body has.
    """
    white = _compute_whitening(covariance)
    ratios = np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)
    place = float(np.linalg.norm(white @ (declared.com - com)))
    if not _is_possible_spread(ratios):
        return math.inf, place
    return float(np.linalg.norm(np.log(np.maximum(ratios, _FLAT)))), place


def _compute_whitening(covariance: Array) -> Array:
    """(3, 3) that turns a covariance into the identity, no direction shorter than 2 % of the longest."""
    variances, axes = np.linalg.eigh(covariance)
    floored = np.maximum(variances, 4e-4 * variances[-1])
    white: Array = (axes / np.sqrt(floored)) @ axes.T
    return white


def _is_possible_spread(ratios: NDArray[np.floating[Any]]) -> Bools:
    """Whether second moments (..., 3), ascending and relative to a reference's, are those of a mass: one that rounding makes a
    little negative is that of a flat part, -0.1 of the reference's is nobody's."""
    spread: Bools = ratios[..., 0] > -SLACK * np.maximum(1.0, ratios[..., 2])
    return spread


def _compute_min_moment_ratio(declared: DeclaredInertial, reference: _Reference) -> float:
    """The smallest ratio of a second moment about the COM to the reference's; negative for an impossible tensor."""
    white = reference.whitening
    return float(np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)[0])


def _is_body(numbers: DeclaredInertial) -> bool:
    """Whether a solid body can have such numbers, so that others can be compared with them."""
    if not _is_computable(numbers):
        return False
    covariance = compute_mass_covariance(numbers.inertia, numbers.mass)
    variances = np.linalg.eigvalsh(covariance)
    return bool(variances[0] > -1e-6 * variances[-1]) and _has_size(numbers.com, covariance)


def _is_computable(numbers: DeclaredInertial) -> bool:
    """Whether there is a mass, and nothing that is computed from the numbers overflows."""
    largest = np.abs(np.concatenate((numbers.com, numbers.tensor.ravel()))).max()  # NaN if there is one
    return bool(1.0 / _LARGEST <= numbers.mass <= _LARGEST and largest <= _LARGEST)


def _has_size(com: Array, covariance: Array) -> bool:
    """Whether other second moments can be told as multiples of these."""
    variance, reach = float(np.trace(covariance)), float(np.abs(com).max())
    return 1.0 / _LARGEST <= variance <= _LARGEST and reach <= _LARGEST


def _get_com_and_covariance(numbers: DeclaredInertial) -> tuple[Array, Array]:
    """COM and second moments."""
    return numbers.com, compute_mass_covariance(numbers.inertia, numbers.mass)


def _build_geometry_reference(geometry: VisualGeometry) -> _Reference:
    solid = geometry.solid
    mixture = _CLOSED if geometry.closed else _OPEN
    return _Reference(solid.com, solid.covariance, solid.volume, mixture, _select_outermost_points(geometry.points))


def _build_twin_reference(twin: DeclaredInertial) -> _Reference:
    return _Reference(twin.com, compute_mass_covariance(twin.inertia, twin.mass), twin.mass, _TWIN, twin=twin)


def _diagnose_against(declared: DeclaredInertial, reference: _Reference, geometry: VisualGeometry | None) -> Diagnosis:
    if (undisputed := _accept_close_match(declared, reference)) is not None:
        return undisputed
    ranking = _rank_explanations(declared, reference, geometry)
    none = ranking.no_mistake_index
    shape, place = float(ranking.tensor_mismatches[none]), float(ranking.com_mismatches[none])
    possible = bool(ranking.possible[none])
    best = ranking.kinds[0]
    same = ranking.numbers.find_equal_rows(0) & [kind.factor == best.factor for kind in ranking.kinds]
    rival = next(
        (
            i
            for i, equal in enumerate(same)
            if not equal and _get_mistake_family(ranking.kinds[i]) != _get_mistake_family(best)
        ),
        None,
    )
    leads = _compute_leads(ranking.scores)
    margin = math.inf if rival is None else float(leads[rival])
    # The mistake may be certain while its parameter is not: which axes were swapped, which of two units.
    close = [0, *np.flatnonzero((leads <= MARGIN) & ~same).tolist()]
    named = (
        not same[none]
        and margin > MARGIN
        and not (best.id in _PRECISE and len({_name_changed_number(ranking.kinds[i]) for i in close}) > 1)
        and _is_convincing(best, ranking, reference)
        and _measure_effect(declared, ranking.numbers[0], best.factor)
        > (TWIN_LIKE if reference.twin is not None else EFFECT)
    )
    certain = named and len(close) == 1
    agree = (ranking.tensor_mismatches < EXACT) & (ranking.com_mismatches < EXACT)
    others = any(ranking.kinds[i].fitted == (0, 0) for i in np.flatnonzero(agree & ~same).tolist())
    explaining = {
        "none",
        *(kind.id for kind in ranking.kinds if named and _get_mistake_family(kind) == _get_mistake_family(best)),
    }
    return Diagnosis(
        sound=not named and possible and _is_unremarkable(reference, shape, place),
        cause=(best.id if len({ranking.kinds[i].id for i in close}) == 1 else _get_mistake_family(best))
        if named
        else None,
        detail=" or ".join(dict.fromkeys(ranking.kinds[i].detail for i in close)) if named else "",
        mended=ranking.numbers[0] if certain else None,
        tensor_mismatch=shape,
        com_mismatch=place,
        mended_tensor_mismatch=float(ranking.tensor_mismatches[0]) if named else shape,
        mended_com_mismatch=float(ranking.com_mismatches[0]) if named else place,
        min_moment_ratio=_compute_min_moment_ratio(declared, reference),
        margin=margin,
        unique=bool(certain and agree[0] and not others),
        ruled_out=tuple(dict.fromkeys(kind.id for kind in ranking.kinds if kind.id not in explaining)),
        possible=possible,
        by="mesh",
        decided=True,
    )


def _accept_close_match(declared: DeclaredInertial, reference: _Reference) -> Diagnosis | None:
    """The verdict on numbers that fit the reference so well that no mistake need be looked for; most do."""
    shapes, places, sizes, possible = _measure_distances(
        reference, _InertialBatch.from_inertials([declared]), np.ones(1)
    )
    shape, place, size = float(shapes[0]), float(places[0]), float(sizes[0])
    near = _TWIN[0][1] * 3.0 if reference.twin is not None else _CLOSED[0][1] * 10.0
    usual = abs(size) < near if reference.twin is not None else abs(size - math.log(1500.0)) < math.log(10.0)
    if not (possible[0] and usual and max(shape, place) < near):
        return None
    return Diagnosis(
        sound=True,
        cause=None,
        detail="",
        mended=None,
        tensor_mismatch=shape,
        com_mismatch=place,
        mended_tensor_mismatch=shape,
        mended_com_mismatch=place,
        min_moment_ratio=1.0,
        margin=math.inf,
        unique=False,
        ruled_out=(),
        possible=True,
        by="mesh",
        decided=True,
    )


def _compute_leads(scores: Array) -> Array:
    """By how much (N,) the best score, the first, beats each; not at all where every score is that of the impossible."""
    return scores[0] - scores if math.isfinite(scores[0]) else np.zeros(len(scores))


def _get_mistake_family(kind: _Mistake) -> str:
    """Mistakes that are one and the same but for their parameter."""
    return "units" if kind.id == "inertia_unit" else kind.id


def _is_convincing(best: _Mistake, ranking: _Ranking, reference: _Reference) -> bool:
    """Whether the best explanation leaves numbers that a part of this shape has: being better than the others is not enough."""
    shape, place = float(ranking.tensor_mismatches[0]), float(ranking.com_mismatches[0])
    twin = reference.twin
    if twin is not None and not math.isclose(float(ranking.numbers.mass[0]), twin.mass, rel_tol=TWIN_LIKE):
        return False
    if best.id == "other_mass":  # any tensor fits a sphere of some mass, and a motor changes the size as a mass does
        moments = np.linalg.eigvalsh(ranking.numbers[0].tensor)
        return max(shape, place) < EXACT and bool(moments[-1] - moments[0] > 0.05 * moments[-1])
    if twin is not None:  # which is not a uniform solid, but what the numbers should be
        return max(shape, place) < EXACT
    if best.fitted == (0, 0):
        uniform = float(ranking.com_mismatches[ranking.no_mistake_index]) < UNIFORM and shape > 2 * EFFECT
        if uniform or (float(ranking.tensor_mismatches[ranking.no_mistake_index]) < UNIFORM and place > 2 * EFFECT):
            return False
    if reference.mixture is _OPEN and best.id not in _COARSE:
        return False
    return max(shape, place) < (NEAR / 2 if best.id == "decimal_point" else NEAR)


def _measure_effect(declared: DeclaredInertial, mended: DeclaredInertial, factor: float) -> float:
    """How much a mistake changes: the logarithm of the mass, the second moments or the COM; infinite for an impossible tensor."""
    covariance = compute_mass_covariance(mended.inertia, mended.mass)
    if not np.isfinite(covariance).all() or not np.linalg.eigvalsh(covariance)[-1] > 0.0:
        return math.inf
    return max(
        *measure_inertial_mismatch(declared, mended.com, covariance),
        abs(math.log(declared.mass / mended.mass * factor)),
    )


def _name_changed_number(kind: _Mistake) -> str:
    """Which number a mistake of one number is about. The last word tells the power of ten, which a coordinate of the COM must
    tell as well: one that is next to zero after any of them need not have lost a decimal point."""
    powers = kind.id == "decimal_point" and not kind.detail.startswith("com")
    return kind.detail.rpartition(" ")[0] if powers else kind.detail


def _is_unremarkable(reference: _Reference, shape: float, place: float) -> bool:
    """Whether a part may well differ so much from its reference."""
    return shape < TWIN_LIKE and place < TWIN_LIKE if reference.twin is not None else shape < FAR and place < FAR


def _is_better_fit(one: DeclaredInertial, other: DeclaredInertial, geometry: VisualGeometry) -> bool:
    """Whether a part of this geometry has the numbers ``one`` much more likely than ``other``."""
    reference = _build_geometry_reference(geometry)
    shapes, places, sizes, possible = _measure_distances(
        reference, _InertialBatch.from_inertials([one, other]), np.ones(2)
    )
    scores = _compute_log_likelihood(
        reference, shapes, places, sizes, possible, np.zeros((2, 2)), np.zeros(2, dtype=bool)
    )
    return bool(scores[0] - scores[1] > SIDE_MARGIN)


def _rank_explanations(declared: DeclaredInertial, reference: _Reference, geometry: VisualGeometry | None) -> _Ranking:
    kinds, numbers = _list_candidates(declared, reference, geometry)
    factors = np.array([kind.factor for kind in kinds])
    shapes, places, sizes, possible = _measure_distances(reference, numbers, factors)
    for i, kind in enumerate(kinds):
        if kind.source_body is not None:
            shape, place = measure_inertial_mismatch(declared, kind.source_body.com, kind.source_body.covariance)
            # The COM may be that of the part all the same.
            shapes[i], places[i] = shape, min(place, float(places[0]))
    fitted = np.array([kind.fitted for kind in kinds])
    separate = np.array([kind.source_body is not None for kind in kinds])
    scores = _compute_log_likelihood(reference, shapes, places, sizes, possible, fitted, separate)
    scores += [kind.prior for kind in kinds]
    # A coordinate that is next to zero once it is divided by ten or a thousand would be there whatever it had been.
    shrunk = np.abs(numbers.com) < 0.5 * np.abs(declared.com)
    next_to = np.linalg.norm(np.where(shrunk, numbers.com, 0.0) @ reference.whitening, axis=1) < _NEAR_ZERO
    scaled = np.array([kind.id in _SCALED for kind in kinds])
    scores[shrunk.any(axis=1) & next_to & scaled] = -np.inf
    order = np.argsort(-scores, kind="stable")
    return _Ranking(
        tuple(kinds[i] for i in order),
        scores[order],
        shapes[order],
        places[order],
        numbers.take_rows(order),
        possible[order],
    )


def _compute_log_likelihood(
    reference: _Reference,
    shapes: Array,
    places: Array,
    sizes: Array,
    possible: Bools,
    fitted: Array | Indices,
    separate: Bools,
) -> Array:
    """Logarithm (N,) of how likely a part of this shape has such numbers.

    What was taken from the reference to undo a mistake proves nothing: it counts as typical (`_TYPICAL` per degree of freedom)
    whatever it is.
    """
    free_shape, free_place = 6 - fitted[:, 0], 3 - fitted[:, 1]
    taken = fitted[:, 0] + fitted[:, 1]
    with np.errstate(invalid="ignore", over="ignore"):
        terms = [
            (
                math.log(weight),
                -free_shape * (math.log(a) + _LOG_SQRT_2PI) - shapes**2 / (2 * a * a),
                -free_place * (math.log(b) + _LOG_SQRT_2PI) - places**2 / (2 * b * b),
            )
            for weight, a, b in reference.mixture
        ]
    together = np.logaddexp.reduce([a + b + c for a, b, c in terms], axis=0)
    # The tensor of another body says nothing about the COM beside it. It was computed, not weighed: it agrees with that body
    # to its digits and the tessellation, or it is none of it.
    computed = np.logaddexp.reduce(
        [math.log(w) - free_shape * (math.log(a) + _LOG_SQRT_2PI) - shapes**2 / (2 * a * a) for w, a in _COMPUTED],
        axis=0,
    )
    apart = computed + np.logaddexp.reduce([a + c for a, _, c in terms], axis=0)
    # What cannot be inside the drawn geometry is explained by the broadest component alone: something is not drawn.
    rare, widest_shape, widest_place = terms[-1]
    broad = rare + widest_shape + widest_place - _NOT_DRAWN
    scores = np.where(possible, np.where(separate, apart, together), broad) - _TYPICAL * taken
    if reference.twin is not None:
        spread = np.logaddexp(
            math.log(0.95) - np.log(1e-3) - sizes**2 / 2e-6, math.log(0.05) - np.log(3.0) - sizes**2 / 18.0
        )
        return np.where(np.isfinite(shapes), scores + spread, -np.inf)
    # Densities: log-normal about 1500 kg/m³ with heavy tails (Student's t with 8 degrees of freedom).
    z = (sizes - math.log(1500.0)) / 0.9
    return np.where(np.isfinite(shapes), scores - 4.5 * np.log1p(z * z / 8.0), -np.inf)


def _measure_distances(
    reference: _Reference, numbers: _InertialBatch, factor: Array
) -> tuple[Array, Array, Array, Bools]:
    """Mismatch (N,) of second moments and of the COM, logarithm (N,) of mass over size, and (N,) whether the drawn geometry can
    hold such a mass. ``factor`` (N,): how many times as large as the reference the part is."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        specific = numbers.inertia / numbers.mass[:, None, None]
        covariance = 0.5 * np.trace(specific, axis1=1, axis2=2)[:, None, None] * np.eye(3) - specific
        covariance = covariance / (factor**2)[:, None, None]
        place = numbers.com / factor[:, None]
        white = reference.whitening
        usable = np.isfinite(covariance).all(axis=(1, 2)) & (numbers.mass > 0)
        covariance[~usable] = np.eye(3)
        ratios = np.linalg.eigvalsh(white @ covariance @ white)
        usable &= _is_possible_spread(ratios)
        floored = np.maximum(ratios, _FLAT)
        shapes = np.where(usable, np.linalg.norm(np.log(floored), axis=1), np.inf)
        places = np.linalg.norm((place - reference.com) @ white, axis=1)
        sizes = np.log(numbers.mass / (reference.size * factor ** (0 if reference.twin is not None else 3)))
    possible = usable.copy()
    if reference.points is not None:
        variances, axes = np.linalg.eigh(covariance[usable])
        possible[usable] = _can_hold_mass(reference.points, place[usable], variances, axes)
    return shapes, places, sizes, possible


def _can_hold_mass(points: Array, place: Array, variances: Array, axes: Array) -> Bools:
    """Whether (N,) a mass within the convex hull of ``points`` (K, 3) can have the COM ``place`` (N, 3) and the ``variances``
    (N, 3) along ``axes`` (N, 3, 3): along each, ``(max - c)(c - min)`` is the most (Bhatia and Davis, *A better bound on the
    variance*, 2000)."""
    along = (points @ axes.transpose(1, 0, 2).reshape(3, -1)).reshape(len(points), -1, 3)  # one product of matrices
    com = np.einsum("nj,njd->nd", place, axes)
    high, low = along.max(axis=0) - com, along.min(axis=0) - com
    slack = SLACK * (high - low)
    bound = (1.0 + SLACK) * (high + slack) * (slack - low)
    inside: Bools = ((high > -slack) & (low < slack) & (variances <= bound)).all(axis=1)
    return inside


def _list_candidates(
    declared: DeclaredInertial, reference: _Reference, geometry: VisualGeometry | None
) -> tuple[list[_Mistake], _InertialBatch]:
    """Every mistake, and the numbers without it."""
    linear = _build_linear_mistakes()
    typed = np.array([declared.tensor[place] for place in _COMPONENT_INDICES])
    many = len(linear.kinds)
    multiplied = _InertialBatch(
        linear.mass * declared.mass,
        linear.com * declared.com,
        (linear.six @ typed)[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3),
        np.broadcast_to(declared.rotation, (many, 3, 3)),
    )
    special = list(_iter_special_mistakes(declared, reference, geometry))
    kinds = [*linear.kinds, *(kind for kind, _ in special)]
    return kinds, multiplied.concatenate_with(_InertialBatch.from_inertials([numbers for _, numbers in special]))


@cache
def _build_linear_mistakes() -> _LinearMistakes:
    rows: list[tuple[_Mistake, float, Array, Array]] = []
    one, same = np.ones(3), np.eye(6)

    def add_mistake(kind: _Mistake, mass: float = 1.0, com: Array = one, six: Array = same) -> None:
        rows.append((kind, mass, com, six))

    add_mistake(_Mistake("none", "", 0.0))
    for unit, factor in _INERTIA.items():
        add_mistake(
            _Mistake("inertia_unit", unit, -3.0 if "g" in unit and "lb" not in unit else -4.0), six=same * factor
        )
    for power in (3, 6, 9):
        add_mistake(_Mistake("inertia_unit", f"1e-{power} kg·m²", -5.0), six=same * 10.0**power)
    for unit, factor in _MASS.items():
        add_mistake(_Mistake("mass_unit", unit, -3.0 if unit == "g" else -4.0), mass=factor)
    for units, (mass, inertia, length, name) in _COHERENT.items():
        add_mistake(_Mistake("units", units, -3.5), mass=mass, six=same * inertia)
        add_mistake(_Mistake("units", f"{units}, {name}", -3.5), mass=mass, com=one * length, six=same * inertia)
    add_mistake(_Mistake("units", "g and g·m²", -4.0), mass=1e-3, six=same * 1e-3)
    add_mistake(_Mistake("units", "mg and mg·m²", -5.0), mass=1e-6, six=same * 1e-6)
    for unit, factor in _LENGTH.items():
        add_mistake(_Mistake("com_unit", "inches" if unit == "in" else unit, -3.0), com=one * factor)
        for other, squared in (("kg·mm²", 1e-6), ("kg·cm²", 1e-4), ("kg·in²", _INCH**2)):
            if unit in other:
                add_mistake(_Mistake("units", f"kg and {other}, {unit}", -3.5), com=one * factor, six=same * squared)
    for factor, text in (
        (1e3, "1000"),
        (1e-3, "0.001"),
        (1e2, "100"),
        (1e-2, "0.01"),
        (_INCH, "0.0254"),
        (1 / _INCH, "39.37"),
    ):
        add_mistake(_Mistake("mesh_scale", text, -3.5 if factor in {1e3, 1e-3} else -4.5, factor=factor))
    add_mistake(_Mistake("products_sign", "", -2.5), six=np.diag((1.0, -1.0, -1.0, 1.0, -1.0, 1.0)))
    for order in ((1, 0, 2), (2, 1, 0), (0, 2, 1), (1, 2, 0), (2, 0, 1)):
        slots = [_SLOT[order[i], order[j]] for i, j in _COMPONENT_INDICES]
        add_mistake(_Mistake("axes_permuted", " ".join("xyz"[i] for i in order), -3.5), six=same[slots])
    for i, j in combinations(range(6), 2):
        slots = list(range(6))
        slots[i], slots[j] = j, i
        add_mistake(
            _Mistake("slots_swapped", f"{_COMPONENT_NAMES[i]} and {_COMPONENT_NAMES[j]}", -5.0), six=same[slots]
        )
    add_mistake(_Mistake("diagonal_first", "", -3.0), six=same[[0, 3, 4, 1, 5, 2]])
    for i, name in enumerate(_COMPONENT_NAMES):
        sign = np.ones(6)
        sign[i] = -1.0
        add_mistake(_Mistake("one_sign", name, -4.5), six=np.diag(sign))
    for i, axis in enumerate("xyz"):
        sign = np.ones(3)
        sign[i] = -1.0
        add_mistake(_Mistake("one_sign", f"com {axis}", -4.5), com=sign)
    for power in (1, -1, 2, -2, 3, -3):
        factor, prior = 10.0**power, -4.5 - 0.5 * abs(power)
        add_mistake(_Mistake("decimal_point", f"mass {factor:g}", prior), mass=factor)
        for i, name in enumerate(_COMPONENT_NAMES):
            scale = np.ones(6)
            scale[i] = factor
            add_mistake(_Mistake("decimal_point", f"{name} {factor:g}", prior), six=np.diag(scale))
        for i, axis in enumerate("xyz"):
            scale = np.ones(3)
            scale[i] = factor
            add_mistake(_Mistake("decimal_point", f"com {axis} {factor:g}", prior), com=scale)
    return _LinearMistakes(
        tuple(kind for kind, *_ in rows),
        np.array([mass for _, mass, _, _ in rows]),
        np.array([com for _, _, com, _ in rows]),
        np.array([six for _, _, _, six in rows]),
    )


def _iter_special_mistakes(
    declared: DeclaredInertial, reference: _Reference, geometry: VisualGeometry | None
) -> Iterator[tuple[_Mistake, DeclaredInertial]]:
    """Mistakes that mix the numbers, or lose some."""
    mass, com, tensor, rotation = declared.mass, declared.com, declared.tensor, declared.rotation
    turned = bool(np.abs(rotation - np.eye(3)).max() > 1e-6)
    lever = rotation.T @ com
    shift = mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    yield _Mistake("about_origin", "", -2.5), replace(declared, tensor=tensor - shift)
    yield _Mistake("steiner_twice", "", -3.5), replace(declared, tensor=tensor + shift)
    for axis, quarter in _iter_quarter_turns():
        if turned:
            moved = replace(declared, com=quarter @ com, rotation=quarter @ rotation)
        else:
            moved = replace(declared, com=quarter @ com, tensor=quarter @ tensor @ quarter.T)
        yield _Mistake("quarter_turn", axis, -4.0), moved
    for i, axis in enumerate("xyz"):
        mirror = np.eye(3)
        mirror[i, i] = -1.0
        mirrored = DeclaredInertial(mass, mirror @ com, mirror @ tensor @ mirror, mirror @ rotation @ mirror)
        # A part with a mirror image is the one whose numbers were copied.
        yield _Mistake("unmirrored", axis, -3.0 if reference.twin is None else -2.0), mirrored
    if turned:
        yield _Mistake("rpy_twice", "", -3.5), replace(declared, rotation=np.eye(3))
    wanted = reference.twin
    if not np.abs(com).any():
        there = reference.com if wanted is None else wanted.com
        there = np.where(np.abs(there) > 1e-3 * np.abs(there).max(), there, 0.0)  # what a mesh leaves of a zero
        yield _Mistake("com_missing", "", -2.5, fitted=(0, 3)), replace(declared, com=there)
    diagonal = np.diag(np.diag(tensor))
    if not turned and np.abs(tensor - diagonal).max() < 1e-3 * np.abs(tensor).max():
        aligned = _align_principal_axes(np.diag(tensor), reference.covariance)
        yield _Mistake("rpy_missing", "", -3.0, fitted=(3, 0)), replace(declared, tensor=aligned)
    if tensor[0, 1] == tensor[1, 1]:
        # The third row is lost: the moment about z is about that of the reference.
        rest = float(mass * (reference.covariance[0, 0] + reference.covariance[1, 1]))
        (xx, xy, xz), yy, yz = tensor[0], tensor[1, 2], tensor[2, 2]
        for zz in rest * np.array((0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0)):
            rows = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
            yield (
                _Mistake("row_major", "", _COINCIDENCE if tensor[0, 1] else 0.0, fitted=(1, 0)),
                replace(declared, tensor=rows),
            )
    scale = _compute_tensor_scale(declared, reference)
    if scale is not None:
        prior = -3.5 - 0.5 * (math.log(scale) / _REVISION) ** 2 - math.log(_REVISION) - _LOG_SQRT_2PI
        kind = _Mistake("other_mass", f"{mass / scale:.3g} kg", prior, fitted=(1, 0))
        yield kind, replace(declared, tensor=tensor * scale)
    if geometry is None:
        return
    if len(geometry.pieces) > 1:
        yield (
            _Mistake("steiner_missing", "", -4.5),
            replace(declared, tensor=tensor + _compute_parallel_axis_term(geometry, mass, rotation)),
        )
    uniform = wanted or DeclaredInertial(mass, geometry.solid.com, compute_solid_inertia(geometry.solid, mass))
    others = [("shell", -3.0, geometry.shell), ("bounding_box", -3.0, geometry.box)]
    others += [("convex_hull", -3.5, geometry.hull)] if geometry.closed else []
    others += [("one_piece", -4.0, piece) for piece in geometry.pieces[:_PIECES]] if len(geometry.pieces) > 1 else []
    for id, prior, body in others:
        if body is not None and _is_different_shape(body, geometry.solid):
            yield _Mistake(id, "", prior, source_body=body), uniform


def _is_different_shape(body: Solid, solid: Solid) -> bool:
    """Whether to take the one body for the other makes a difference."""
    white = _Reference(solid.com, solid.covariance, 1.0, _CLOSED).whitening
    ratios = np.linalg.eigvalsh(white @ body.covariance @ white)
    return bool(ratios[0] <= 0.0 or np.linalg.norm(np.log(ratios)) > EFFECT)


def _iter_quarter_turns() -> Iterator[tuple[str, Array]]:
    for i, axis in enumerate("xyz"):
        j, k = (i + 1) % 3, (i + 2) % 3
        for sign in (1.0, -1.0):
            turn = np.zeros((3, 3))
            turn[i, i] = 1.0
            turn[k, j], turn[j, k] = sign, -sign
            yield f"{'+' if sign > 0 else '-'}90° about {axis}", turn


def _align_principal_axes(moments: Array, covariance: Array) -> Array:
    """The tensor (3, 3) with these principal moments along the principal axes of the reference, in the same order of size."""
    _, axes = np.linalg.eigh(covariance)
    ordered = np.sort(moments)[::-1]  # the least variance goes with the greatest moment
    turned: Array = (axes * ordered) @ axes.T
    return turned


def _compute_tensor_scale(declared: DeclaredInertial, reference: _Reference) -> float | None:
    """By what the tensor must be multiplied for the second moments to have the reference's size; None when they have none."""
    covariance = compute_mass_covariance(declared.inertia, declared.mass) if declared.mass > 0 else np.zeros((3, 3))
    white = reference.whitening
    ratios = np.linalg.eigvalsh(white @ covariance @ white)
    return float(np.exp(-np.log(ratios).mean())) if ratios[0] > 0 else None


def _compute_parallel_axis_term(geometry: VisualGeometry, mass: float, rotation: Array) -> Array:
    """What the parallel-axis theorem adds for the pieces of a part of uniform density, in the inertial frame's axes."""
    volumes = np.array([piece.volume for piece in geometry.pieces])
    levers = (np.array([piece.com for piece in geometry.pieces]) - geometry.solid.com) @ rotation
    second = (levers.T * (mass * volumes / volumes.sum())) @ levers
    added: Array = np.trace(second) * np.eye(3) - second
    return added


def _select_outermost_points(points: Array) -> Array:
    """The outermost of the points in evenly spread directions: their hull lies just inside."""
    if len(points) <= _DIRECTIONS:
        return points
    outermost: Array = points[np.unique((points @ _sample_sphere_directions().T).argmax(axis=0))]
    return outermost


@cache
def _sample_sphere_directions() -> Array:
    """Unit vectors spread evenly over the sphere (a Fibonacci spiral)."""
    n = np.arange(_DIRECTIONS) + 0.5
    z, angle = 1.0 - 2.0 * n / _DIRECTIONS, math.pi * (1.0 + math.sqrt(5.0)) * n
    across = np.sqrt(1.0 - z * z)
    return np.column_stack((across * np.cos(angle), across * np.sin(angle), z))
