"""Textbook formulas for the inertia of another solid than the one that is drawn.

A box, a cylinder and a sphere have formulas that are known exactly. Numbers that are those of another formula to their last
digit were computed with it: for another solid, with the diameter for the radius, with half the length, for a hollow body, or
about the wrong axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    compute_solid_inertia,
    list_half_units,
    list_inertia_components,
    make_box_solid,
    make_cylinder_solid,
    make_sphere_solid,
)

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, Primitive

# A computed number agrees to its last typed digit, or to this part of the largest where it has more.
_SAME = 3e-3
# With so few digits that half a unit is more than this part of the largest number, agreement shows nothing.
# Two digits are enough for two or three moments; one that stands for all three, a sphere's, has to be closer.
_TELLING, _TELLING_OF_ONE = 0.05, 0.02
# Half a unit of the last place, and what tessellation adds to it.
ROUNDING_SLACK = 1.02


def list_wrong_formulas(primitive: Primitive) -> Iterator[tuple[str, bool, Solid]]:
    """Yield what each formula is for, whether it is about other axes than the drawn part's, and its body about the origin, in the
    link's axes."""
    for name, body in _iter_bodies(primitive):
        for order in _list_orders(body):
            turned = body.covariance[np.ix_(order, order)]
            covariance = primitive.rotation @ turned @ primitive.rotation.T
            other_axes = order != (0, 1, 2)
            yield (
                f"{name}, along another axis" if other_axes else name,
                other_axes,
                Solid(body.volume, body.com, covariance),
            )
    if primitive.kind == "box":
        for name, body in _iter_misread_boxes(primitive.size):
            yield name, False, Solid(body.volume, body.com, primitive.rotation @ body.covariance @ primitive.rotation.T)


def _iter_bodies(primitive: Primitive) -> Iterator[tuple[str, Solid]]:
    if primitive.kind == "box":
        yield "a box of twice the edges", make_box_solid([2.0 * edge for edge in primitive.size])
        yield "a box of half the edges", make_box_solid([0.5 * edge for edge in primitive.size])
    elif primitive.kind == "sphere":
        (radius,) = primitive.size
        yield "a hollow sphere", _make_hollow_sphere(radius)
        yield "a sphere with the diameter for the radius", make_sphere_solid(2.0 * radius)
        yield "a sphere with the radius for the diameter", make_sphere_solid(0.5 * radius)
    else:
        radius, length = primitive.size
        yield "a sphere of this radius", make_sphere_solid(radius)
        yield "a hollow sphere of this radius", _make_hollow_sphere(radius)
        yield "a thin-walled tube", _make_tube(radius, length)
        yield "a cylinder with the diameter for the radius", make_cylinder_solid(2.0 * radius, length)
        yield "a cylinder with the radius for the diameter", make_cylinder_solid(0.5 * radius, length)
        yield "a cylinder of twice the length", make_cylinder_solid(radius, 2.0 * length)
        yield "a cylinder of half the length", make_cylinder_solid(radius, 0.5 * length)
        # Four and a quarter times the moments: without these, another mass fits as well.
        yield "a cylinder of twice the size", make_cylinder_solid(2.0 * radius, 2.0 * length)
        yield "a cylinder of half the size", make_cylinder_solid(0.5 * radius, 0.5 * length)
        if primitive.kind == "capsule":
            yield "a cylinder without the rounded ends", make_cylinder_solid(radius, length)


def _iter_misread_boxes(edges: Sequence[float]) -> Iterator[tuple[str, Solid]]:
    """Yield boxes one of whose moments is computed from the edges of another: ``izz`` from x and z."""
    volume = float(np.prod(edges))
    squares = np.square(edges)
    pairs = {"ixx": (1, 2), "iyy": (0, 2), "izz": (0, 1)}
    for wrong, other in permutations(pairs, 2):
        read = pairs | {wrong: pairs[other]}
        moments = np.array([squares[list(pair)].sum() for pair in read.values()]) / 12.0
        name = f"a box with {wrong} from {' and '.join('xyz'[edge] for edge in pairs[other])}"
        yield name, Solid(volume, np.zeros(3), np.diag(moments.sum() / 2.0 - moments))


def _make_hollow_sphere(radius: float) -> Solid:
    """Make a thin spherical shell: its second moments are those of points at ``radius``, r²/3 in each direction."""
    return Solid(1.0, np.zeros(3), np.eye(3) * radius**2 / 3.0)


def _make_tube(radius: float, length: float) -> Solid:
    """Make a thin-walled tube along z: r²/2 across, as of points on a circle."""
    return Solid(1.0, np.zeros(3), np.diag((radius**2 / 2.0, radius**2 / 2.0, length**2 / 12.0)))


def _list_orders(body: Solid) -> list[tuple[int, ...]]:
    """List the orders of the axes that give different tensors, the right one first."""
    variances = np.diag(body.covariance)
    seen: dict[tuple[float, ...], tuple[int, ...]] = {}
    for order in permutations(range(3)):
        seen.setdefault(tuple(variances[list(order)].tolist()), order)
    return list(seen.values())


def is_tensor_of(declared: DeclaredInertial, body: Solid) -> bool:
    """Whether the typed numbers are those of a ``body`` (in the link's axes) to their last digit, and have enough of them."""
    expected = declared.rotation.T @ compute_solid_inertia(body, declared.mass) @ declared.rotation
    typed, numbers = list_inertia_components(declared.tensor), np.array(list_inertia_components(expected))
    largest, off = float(np.abs(numbers).max()), np.abs(numbers - typed)
    if not (off <= _TELLING * largest).all():  # more than digits leave, whatever they are; most end here
        return False
    halves = np.array(list_half_units([repr(v) for v in typed]))
    has_one_moment = float(np.ptp(np.diag(body.covariance))) <= _SAME * float(body.covariance.max())
    telling = _TELLING_OF_ONE if has_one_moment else _TELLING
    if not halves.any() or not halves[int(np.argmax(np.abs(typed)))] <= telling * largest:
        return False
    halves[halves == 0.0] = halves[halves > 0.0].min()  # a zero was rounded like the finest of the others
    slack = np.maximum(_SAME * largest, np.minimum(ROUNDING_SLACK * halves, telling * largest))
    return bool((off <= slack).all())


def is_rounding_of(typed: Mat3, tensor: Mat3, slack: float = ROUNDING_SLACK) -> bool:
    """Whether the six numbers of a tensor (3, 3) are those of another one, each to its last typed digit, that is within ``slack``
    halves of a unit there. Then no mistake but rounding shows in them."""
    texts = [repr(value) for value in list_inertia_components(typed)]
    halves = np.array(list_half_units(texts))
    if not halves.any():
        return False
    halves[halves == 0.0] = halves[halves > 0.0].min()  # a zero was rounded like the finest of the others
    off = np.abs(np.subtract(list_inertia_components(typed), list_inertia_components(tensor)))
    return bool((off <= slack * halves).all())


def measure_decimal(tensor: Mat3) -> float | None:
    """Measure the last decimal place of six numbers, as a power of ten; None where all are zero."""
    texts = [repr(value).removesuffix(".0") for value in list_inertia_components(tensor)]
    halves = [half for half in list_half_units(texts) if half]
    return 2.0 * min(halves) if halves else None
