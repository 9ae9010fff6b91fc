"""Mistakes that multiply what was typed: undoing them is a matrix that does not depend on the part."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import field, replace
from functools import cache
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.mistakes.mistake import COMPONENT_INDICES, COMPONENT_NAMES, Mistake, make_mistake

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Vec3

# What each further power of ten of a lost decimal point costs.
_PER_DIGIT = 0.5
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
    *((f"1e{power} kg·m²", 10.0**power, "inertia_unit (a power of ten)") for power in (3, 6, 9)),
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
# Those by which a whole tensor is not in another unit (`_INERTIA_UNITS`).
_TENSOR_POWERS = frozenset({1, -1, 2, -2})
# Those by which the unit of the whole COM is wrong: cm and mm.
_LENGTH_POWERS = frozenset({-2, -3})
_COMPONENT_AT = {(i, j): n for n, (i, j) in enumerate(COMPONENT_INDICES)} | {
    (j, i): n for n, (i, j) in enumerate(COMPONENT_INDICES)
}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Multiplier:
    """Turns what is typed into what was meant."""

    mass: float = 1.0
    com: Vec3 = field(default_factory=lambda: np.ones(3))
    components: Array = field(default_factory=lambda: np.eye(6))
    """(6, 6), for the components of the tensor in URDF's order."""


Multiplied = Iterator[tuple[Mistake, Multiplier]]


def _undo_nothing() -> Multiplied:
    yield make_mistake("none"), Multiplier()


def _undo_inertia_unit() -> Multiplied:
    for unit, factor, prior in _INERTIA_UNITS:
        yield make_mistake(prior, unit), Multiplier(components=np.eye(6) * factor)


def _undo_mass_unit() -> Multiplied:
    for unit, factor, prior in _MASS_UNITS:
        yield make_mistake(prior, unit), Multiplier(mass=factor)


def _undo_coherent_units() -> Multiplied:
    for units, mass, inertia, length_unit, length in _COHERENT_UNITS:
        components = np.eye(6) * inertia
        yield make_mistake("units", units), Multiplier(mass=mass, components=components)
        with_com = Multiplier(mass=mass, com=np.ones(3) * length, components=components)
        yield make_mistake("units", f"{units}, {length_unit}"), with_com
    for units, factor, prior in _MASS_PREFIXES:
        yield make_mistake(prior, units), Multiplier(mass=factor, components=np.eye(6) * factor)


def _undo_length_unit() -> Multiplied:
    """The unit of the COM, alone and also in the inertia."""
    for name, unit, length, inertia_unit, squared in _LENGTH_UNITS:
        com = np.ones(3) * length
        yield make_mistake("com_unit", name), Multiplier(com=com)
        with_inertia = Multiplier(com=com, components=np.eye(6) * squared)
        yield make_mistake("units", f"kg and {inertia_unit}, {unit}"), with_inertia


def _undo_mesh_scale() -> Multiplied:
    for text, factor, prior in _MESH_SCALES:
        yield replace(make_mistake(prior, text), factor=factor), Multiplier()


def _undo_products_sign() -> Multiplied:
    yield make_mistake("products_sign"), Multiplier(components=np.diag((1.0, -1.0, -1.0, 1.0, -1.0, 1.0)))


def _undo_axes_permuted() -> Multiplied:
    for order in ((1, 0, 2), (2, 1, 0), (0, 2, 1), (1, 2, 0), (2, 0, 1)):
        source = [_COMPONENT_AT[order[i], order[j]] for i, j in COMPONENT_INDICES]
        yield (
            make_mistake("axes_permuted", " ".join("xyz"[order.index(i)] for i in range(3))),
            Multiplier(components=np.eye(6)[source]),
        )


def _undo_slots_swapped() -> Multiplied:
    for i, j in combinations(range(6), 2):
        source = list(range(6))
        source[i], source[j] = j, i
        names = f"{COMPONENT_NAMES[i]} and {COMPONENT_NAMES[j]}"
        yield make_mistake("slots_swapped", names), Multiplier(components=np.eye(6)[source])


def _undo_slots_shifted() -> Multiplied:
    """All six numbers one slot too late or too early, and the one at the end at the other end."""
    for steps, name in ((-1, "late"), (1, "early")):
        yield (
            make_mistake("slots_shifted", f"all six are one slot too {name}"),
            Multiplier(components=np.roll(np.eye(6), steps, axis=0)),
        )


def _undo_diagonal_first() -> Multiplied:
    yield make_mistake("diagonal_first"), Multiplier(components=np.eye(6)[[0, 3, 4, 1, 5, 2]])


def _undo_one_sign() -> Multiplied:
    for name, multiplier in _iter_tensor_and_com_numbers(-1.0):
        yield make_mistake("one_sign", name), multiplier


def _undo_decimal_point() -> Multiplied:
    for power in _DECIMAL_POWERS:
        factor, penalty = 10.0**power, _PER_DIGIT * abs(power)
        mass = make_mistake("decimal_point", f"mass {factor:g}", penalty=penalty)
        yield mass, Multiplier(mass=factor)
        for name, multiplier in _iter_tensor_and_com_numbers(factor):
            yield make_mistake("decimal_point", f"{name} {factor:g}", penalty=penalty), multiplier
        if power in _TENSOR_POWERS:
            components = np.eye(6) * factor
            tensor = make_mistake("decimal_point", f"tensor {factor:g}", penalty=penalty)
            yield tensor, Multiplier(components=components)
        if abs(power) == 1:  # only its neighbours show that a part is ten times too heavy; more is another unit
            components = np.eye(6) * factor
            both = make_mistake("decimal_point", f"mass and tensor {factor:g}", penalty=penalty)
            yield both, Multiplier(mass=factor, components=components)
        if power not in _LENGTH_POWERS:
            yield (
                make_mistake("decimal_point", f"com {factor:g}", penalty=penalty),
                Multiplier(com=np.ones(3) * factor),
            )


def _iter_tensor_and_com_numbers(factor: float) -> Iterator[tuple[str, Multiplier]]:
    """Multiply one number of the tensor or the COM after the other."""
    for i, name in enumerate(COMPONENT_NAMES):
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
    _undo_slots_shifted,
    _undo_diagonal_first,
    _undo_one_sign,
    _undo_decimal_point,
)


@cache
def stack_multipliers() -> tuple[tuple[Mistake, ...], Array, Array, Array]:
    """Return the multiplying mistakes, and what the mass (N,), the COM (N, 3) and the components (N, 6, 6) are multiplied by."""
    pairs = [pair for undo in MULTIPLYING_MISTAKES for pair in undo()]
    return (
        tuple(mistake for mistake, _ in pairs),
        np.array([multiplier.mass for _, multiplier in pairs]),
        np.array([multiplier.com for _, multiplier in pairs]),
        np.array([multiplier.components for _, multiplier in pairs]),
    )
