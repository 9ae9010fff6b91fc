"""How one inertial differs from what it should be: in words, and at the narrowest text that holds it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Located
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import list_inertia_components
from urdfcheck.facts.likeness.mirror import InertialDeviation, find_wrong_signs
from urdfcheck.model.parts import TENSOR_NAMES, Inertial

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Coordinates (m) below this are zero.
_ZERO = 1e-12


def describe_differences(
    actual: DeclaredInertial, expected: DeclaredInertial, deviation: InertialDeviation, threshold: float
) -> Iterator[str]:
    """Yield what differs by more than ``threshold``: the mass, the COM, the signs of products, or the principal moments."""
    if deviation.mass > threshold:
        yield f"mass {actual.mass:.4g} kg instead of {expected.mass:.4g} kg (× {actual.mass / expected.mass:.4g})"
    if deviation.com_offset > threshold:
        distance = float(np.linalg.norm(actual.com - expected.com))
        declared_com, expected_com = format_millimetres(actual.com), format_millimetres(expected.com)
        yield f"COM {declared_com} instead of {expected_com}, {distance * 1e3:.3g} mm off"
    if deviation.spread > threshold:
        signs = [name for name in find_wrong_signs(actual, expected, threshold) if name in TENSOR_NAMES]
        for name, one, other in zip(
            TENSOR_NAMES,
            list_inertia_components(actual.inertia),
            list_inertia_components(expected.inertia),
            strict=True,
        ):
            if name in signs:
                yield f"{name} {one:.4g} instead of {other:.4g}"
        # One tensor for two masses: its second moments per mass differ, and no number of it does.
        if not signs and not have_one_tensor(actual, expected, threshold):
            moments = [", ".join(f"{m:.3g}" for m in np.linalg.eigvalsh(n.inertia)) for n in (actual, expected)]
            equal = moments[0] == moments[1]
            yield "other principal axes" if equal else f"principal moments {moments[0]} instead of {moments[1]} kg·m²"


def have_one_tensor(actual: DeclaredInertial, expected: DeclaredInertial, threshold: float) -> bool:
    """Whether two inertials of different masses have the same tensor about the same axes."""
    if abs(actual.mass - expected.mass) <= threshold * expected.mass:
        return False
    off = np.abs(actual.inertia - expected.inertia).max()
    return bool(off <= threshold * np.abs(expected.inertia).max())


def locate_difference(inertial: Inertial, deviation: InertialDeviation, threshold: float) -> Located:
    """Return the narrowest text that holds what differs."""
    places: tuple[tuple[Located | None, float], ...] = (
        (inertial.mass_attribute, deviation.mass),
        (inertial.origin.get_attribute("xyz"), deviation.com_offset),
        (inertial.tensor_element, deviation.spread),
    )
    wrong = [place for place, share in places if share > threshold]
    return wrong[0] if len(wrong) == 1 and wrong[0] is not None else inertial.element


def format_millimetres(place: Array) -> str:
    """Format a ``place`` (3,) in m as millimetres with four digits; what rotations leave of a zero is one."""
    return "(" + ", ".join(f"{1e3 * v + 0.0 if abs(v) > _ZERO else 0.0:.4g}" for v in place) + ") mm"
