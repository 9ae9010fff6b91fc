"""What the six numbers of an impossible inertia tensor say about their mistake, and the nearest tensor that a body can have.

Components are URDF's ``ixx ixy ixz iyy iyz izz`` in kg m².
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertia_tensor import (
    build_inertia_tensor,
    check_inertia_validity,
    compute_covariance_inertia,
    compute_mass_covariance,
    compute_triangle_excess,
    list_inertia_components,
)

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3, Vec3

NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_MOMENTS, _PRODUCTS = (0, 3, 5), (1, 2, 4)
# A number with so many digits stands twice because it was written twice.
_TELLING_DIGITS = 4
# A product is as large as a moment from this share of the largest on (chosen): a rod, whose moment rounds to zero, has less.
_OF_MOMENT = 0.25
# The other signs of the products must bring them so much nearer to the drawn part's.
_NEARER = 0.5
# The moments of a part with a motor inside, relative to each other, are within this factor of those of its drawing.
_ALIKE = 2.0
# A hull, and mass at the ends of a part or in its middle, change all three by less than this factor.
_SIZE = 5.0
# A smallest second moment by this part of the largest survives rounding to six digits.
THICKNESS = 1e-5


@dataclass(frozen=True, slots=True, kw_only=True)
class TensorSlip:
    """A mistake that the numbers show."""

    id: str
    """``products_filled`` | ``slot_repeated`` | ``slot_moved`` | ``products_sign`` | ``one_sign`` | ``decimal``."""
    detail: str
    """Which numbers, in words."""
    components: tuple[float, ...] | None
    """The numbers without the mistake; None where what was meant is not known."""
    residual: tuple[float, float] | None = None
    """How far the products are from the drawn part's of the same size, as typed and without the mistake, in parts of these; None
    where nothing is drawn."""


def find_filled_products(components: Sequence[float], texts: Sequence[str]) -> TensorSlip | None:
    """Find products of inertia that were filled in like the moments: one number three or six times, and a possible body without
    it."""
    values = {components[i] for i in _PRODUCTS}
    without = tuple(v if i in _MOMENTS else 0.0 for i, v in enumerate(components))
    if len(values) != 1 or not all(values) or not _is_possible(without):
        return None
    which = "all six numbers" if len(set(components)) == 1 else "all three products"
    return TensorSlip(id="products_filled", detail=f"{which} are {texts[1].strip()}", components=without)


def find_repeated_slot(texts: Sequence[str]) -> TensorSlip | None:
    """Find a product that repeats a moment digit for digit. A negative moment is wrong in another way, as that of a tensor which
    was turned from one side only."""
    words = [text.strip().lstrip("+-") for text in texts]
    for i in _PRODUCTS:
        digits = words[i].lower().partition("e")[0].replace(".", "").strip("0")
        for j in _MOMENTS:
            is_negative = texts[j].strip().startswith("-")
            if len(digits) >= _TELLING_DIGITS and words[i] == words[j] and not is_negative:
                return TensorSlip(id="slot_repeated", detail=f"{NAMES[i]} repeats {NAMES[j]}", components=None)
    return None


def find_moved_moment(components: Sequence[float]) -> TensorSlip | None:
    """Find the only product, if it is the number of the only moment of zero: they are neighbours in the order of the numbers, and
    in the other's place it makes a tensor that a body can have."""
    products = [i for i in _PRODUCTS if components[i]]
    zeros = [j for j in _MOMENTS if components[j] == 0.0]
    if len(products) != 1 or len(zeros) != 1 or abs(products[0] - zeros[0]) != 1:
        return None
    i, j = products[0], zeros[0]
    if components[i] < _OF_MOMENT * max(components):
        return None
    numbers = list(components)
    numbers[i], numbers[j] = 0.0, components[i]
    if not _is_possible(tuple(numbers)):
        return None
    detail = f"{NAMES[i]} has a number, and {NAMES[j]} beside it is 0"
    return TensorSlip(id="slot_moved", detail=detail, components=tuple(numbers))


def find_wrong_signs(components: Sequence[float], drawn: Mat3 | None) -> TensorSlip | None:
    """Find the signs of products with which the tensor is possible.

    ``drawn`` (3, 3): the tensor of the drawn part in the same axes, which decides whether all three signs are wrong or one; it
    must be nearer with these signs than with any others. Without it all three are taken, for which there is a reason.
    """
    typed = np.array([components[i] for i in _PRODUCTS])
    signs = [np.array(s) for s in product((1.0, -1.0), repeat=3)]
    if not typed.all() or not _is_possible(_replace_products(components, -typed)):
        return None  # with one product of zero the signs do not matter
    if drawn is None:
        return TensorSlip(
            id="products_sign", detail="all three products", components=_replace_products(components, -typed)
        )
    scale = sum(components[i] for i in _MOMENTS) / float(np.trace(drawn))  # another density is no question of signs
    expected = scale * np.array([list_inertia_components(drawn)[i] for i in _PRODUCTS])
    size = float(np.linalg.norm(expected))
    distances = [float(np.linalg.norm(typed * s - expected)) for s in signs]
    best = signs[int(np.argmin(distances))]
    wrong = np.flatnonzero(best < 0)
    if best.prod() > 0 or not min(distances) < _NEARER * distances[0]:
        return None
    return TensorSlip(
        id="products_sign" if len(wrong) == 3 else "one_sign",
        detail="all three products" if len(wrong) == 3 else NAMES[_PRODUCTS[int(wrong[0])]],
        components=_replace_products(components, typed * best),
        residual=(distances[0] / size, min(distances) / size),
    )


def find_slipped_moment(components: Sequence[float], drawn: Mat3) -> TensorSlip | None:
    """Find the one moment whose decimal point or exponent makes the tensor impossible.

    ``drawn`` (3, 3): the tensor of the drawn part, or of what replaces it, at the same mass and in the same axes: with the moment
    multiplied by a power of ten, all three must be within `_ALIKE` of it up to one factor, and that factor itself within `_SIZE`
    (another unit is not a slip of one number); no other moment may fit too.
    """
    slips = []
    for i in _MOMENTS:
        if float(f"{components[i]:.1e}") == components[i]:
            continue  # a number of one or two digits was guessed, not mistyped
        for power in (1, -1, 2, -2):
            moved = tuple(v * 10.0**power if i == j else v for j, v in enumerate(components))
            if min(moved[j] for j in _MOMENTS) <= 0.0 or not _is_possible(moved):
                continue
            ratios = [moved[j] / float(drawn[k, k]) for k, j in enumerate(_MOMENTS)]
            is_of_size = min(ratios) > 1.0 / _SIZE and max(ratios) < _SIZE
            if is_of_size and max(ratios) < _ALIKE * min(ratios):
                slips.append(TensorSlip(id="decimal", detail=f"{NAMES[i]} {10.0**power:g}", components=moved))
    return slips[0] if len(slips) == 1 else None


def find_nearest_tensor(
    components: Sequence[float], *, thickness: float = THICKNESS
) -> tuple[tuple[float, ...], float]:
    """Find the tensor of a body with the nearest second moments, and by how much its numbers differ at most, in parts of its
    largest.

    The second moments ``½ tr(I) 1 - I`` of a body are positive semidefinite: negative ones become (nearly) zero, which is the
    nearest such matrix in the Frobenius norm (Higham, *Computing a nearest symmetric positive semidefinite matrix*, 1988).

    :param thickness: what a negative second moment becomes, relative to the largest: it must survive rounding.
    """
    typed = build_inertia_tensor(components)
    second, axes = np.linalg.eigh(compute_mass_covariance(typed, 1.0))
    kept: Vec3 = np.maximum(second, thickness * float(np.abs(second).max()))
    covariance = (axes * kept) @ axes.T
    nearest = compute_covariance_inertia(covariance, 1.0)
    largest = float(np.abs(nearest).max())
    nearest[np.abs(nearest) < 1e-12 * largest] = 0.0
    return tuple(list_inertia_components(nearest)), float(np.abs(nearest - typed).max()) / largest


def _replace_products(components: Sequence[float], products: Vec3) -> tuple[float, ...]:
    replaced = dict(zip(_PRODUCTS, products.tolist(), strict=True))
    return tuple(replaced.get(i, v) for i, v in enumerate(components))


def _is_possible(components: Sequence[float]) -> bool:
    """Whether a solid body can have the numbers."""
    tensor = build_inertia_tensor(components)
    return check_inertia_validity(tensor).positive_definite and compute_triangle_excess(tensor) > 0.0
