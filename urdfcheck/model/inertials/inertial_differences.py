"""How one inertial differs from what it should be: in words, and at the narrowest text that holds it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Located
from urdfcheck.facts.inertials.diagnosis import Declared
from urdfcheck.facts.inertials.inertia_tensor import six_of
from urdfcheck.facts.likeness.mirror import Deviation, wrong_signs
from urdfcheck.model.parts import TENSOR, Inertial

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def differences(found: Declared, expected: Declared, apart: Deviation, note: float) -> Iterator[str]:
    """What differs by more than the share ``note``: the mass, the COM, the signs of products, or the principal moments."""
    if apart.mass > note:
        yield f"mass {found.mass:.4g} kg instead of {expected.mass:.4g} kg (× {found.mass / expected.mass:.4g})"
    if apart.place > note:
        distance = float(np.linalg.norm(found.com - expected.com))
        yield f"centre of mass {_mm(found.com)} instead of {_mm(expected.com)}, {distance * 1e3:.3g} mm away"
    if apart.spread > note:
        signs = [name for name in wrong_signs(found, expected, note) if name in TENSOR]
        for name, one, other in zip(TENSOR, six_of(found.inertia), six_of(expected.inertia), strict=True):
            if name in signs:
                yield f"{name} {one:.4g} instead of {other:.4g}"
        if not signs:
            moments = [", ".join(f"{m:.3g}" for m in np.linalg.eigvalsh(n.inertia)) for n in (found, expected)]
            equal = moments[0] == moments[1]
            yield "other principal axes" if equal else f"principal moments {moments[0]} instead of {moments[1]} kg·m²"


def place_of_difference(inertial: Inertial, apart: Deviation, note: float) -> Located:
    """The narrowest text that holds what differs."""
    places: tuple[tuple[Located | None, float], ...] = (
        (inertial.mass_attribute, apart.mass),
        (inertial.origin.attribute("xyz"), apart.place),
        (inertial.tensor_element, apart.spread),
    )
    wrong = [place for place, share in places if share > note]
    return wrong[0] if len(wrong) == 1 and wrong[0] is not None else inertial.element


def _mm(place: Array) -> str:
    return "(" + ", ".join(f"{1e3 * v + 0.0:.4g}" for v in place) + ") mm"
