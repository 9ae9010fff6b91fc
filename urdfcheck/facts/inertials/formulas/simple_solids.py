"""Simple solids of round size whose textbook formulas give three moments of inertia.

The same numbers are often those of several: of a hollow sphere and of a cube with its diameter as the edge, or of a cylinder with
another radius than the drawn one and of a box around it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import permutations

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import list_half_units

# Two moments are one, and a length is round, within this share, or what the typed digits leave where that is more; where that is
# more than the second, a length shows nothing. With all digits a length of three counts as round, else one of two (all chosen).
_EXACT, _COARSE = 1e-5, 2e-3
_MANY_DIGITS, _FEW_DIGITS = 3, 2


def name_simple_solids(mass: float, moments: Sequence[float]) -> frozenset[str]:
    """Name the solids of a ``mass`` (kg) and of round size that have these moments (kg m²): box, cylinder, sphere, cube."""
    slack = _measure_slack(moments)
    if not (mass > 0.0 and min(moments) > 0.0 and slack <= _COARSE):
        return frozenset()
    return frozenset(
        name for name, lengths in _iter_solids(mass, moments, slack) if all(_is_round(one, slack) for one in lengths)
    )


def _measure_slack(moments: Sequence[float]) -> float:
    """Return by how much of them lengths are uncertain that three moments were computed from."""
    halves = list_half_units([repr(value) for value in moments])
    # A length is the square root of a moment.
    return max(
        _EXACT, *(half / value / 2.0 if value > 0.0 else math.inf for half, value in zip(halves, moments, strict=True))
    )


def _iter_solids(mass: float, moments: Sequence[float], slack: float) -> Iterator[tuple[str, list[float]]]:
    """Yield the solids that have these moments, with their lengths in m."""
    squares = 6.0 * (np.sum(moments) - 2.0 * np.array(moments)) / mass
    if (squares > 0.0).all():
        yield "box", np.sqrt(squares).tolist()
    if max(moments) - min(moments) <= 4.0 * slack * max(moments):
        mean = float(np.mean(moments))
        yield "cube", [math.sqrt(6.0 * mean / mass)]
        yield "sphere", [math.sqrt(2.5 * mean / mass)]
    for along, one, other in permutations(moments):
        length = 12.0 * one / mass - 6.0 * along / mass
        if one <= other and other - one <= 4.0 * slack * other and length > 0.0:
            yield "cylinder", [math.sqrt(2.0 * along / mass), math.sqrt(length)]


def _is_round(length: float, slack: float) -> bool:
    digits = _MANY_DIGITS if slack <= _EXACT else _FEW_DIGITS
    return abs(length - float(f"{length:.{digits}g}")) <= slack * length
