"""Positions that follow one layout (a rectangle, a ring, a row, mirror images), and the one among them that breaks it.

Among the groups of matching joints in 63 published robots one has such a position, and that frame is only elsewhere on its
joint's axis. One position of the 32 different groups with a layout, moved by 1 % to 15 % of the distance to its neighbour, is
named in 87 % of 768 trials: a corner moved along a side that no other coordinate repeats is not. A wrong one is named three
times, in a rover whose wheels are 8 mm out of line as published.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Vec3


# Positions follow a layout to within this share of its size: 0.1 mm of a car of 0.2 m typed to 0.1 mm.
_EXACT = 5e-4
# A misplaced one is off by a thousandth of the size at least,
_LEAST = 1e-3
# and by less than a fifth of the distance to its neighbours: beyond that it may be intended.
_NEAR = 0.2
# Five in a row: of four, a raised middle finger is one.
_ROW = 5
# More positions are an array rather than a robot's limbs, and trying them takes long (the fifth power of their number).
_MAX_POSITIONS = 16
# If blaming another position also works, with the layout kept only to within this share of the deviation, neither is named.
_RIVAL = 0.25
# A layout along the axes gives its coordinates few values: two each at most.
_STRAIGHT = 6


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MisplacedPosition:
    """The one position of a group that breaks the layout of the others."""

    index: int
    """In the group."""
    expected: Vec3
    """Where the layout puts it (m)."""
    residual: float
    """How exactly the others follow the layout (m)."""
    partners: int
    """How many of the others determine where it belongs."""
    layout: str
    """In words."""


@dataclass(frozen=True, slots=True, eq=False)
class _PositionPrediction:
    """Where the image of ``partner`` lies, and by how much the others miss the images of each other (m)."""

    partner: int
    place: Array
    residual: float


def find_misplaced_position(positions: ArrayLike) -> MisplacedPosition | None:
    """Find the one of 4 to 16 positions (n, 3), in m, that is slightly off a layout that all others follow.

    A layout is defined by mirrors across the plane between two of the others, and by the shifts of a row: no axes are
    preferred. At least two of the others must determine, independently, where the odd one belongs. A rectangle with one corner
    moved along a side is also one of another length with the neighbouring corner left behind: then the one is named that gives
    the coordinates fewer absolute values. None if there is no odd one, or several are possible.
    """
    place = np.asarray(positions, dtype=float)
    if not 4 <= len(place) <= _MAX_POSITIONS or not np.isfinite(place).all():
        return None
    size = float(np.linalg.norm(place[:, None] - place[None], axis=2).max())
    candidates = [
        one
        for index in range(len(place))
        if (one := _locate_expected_position(index, place, _EXACT * size)) is not None
    ]
    if not candidates:
        return None
    values = [_count_coordinate_values(place, one, _EXACT * size) for one in candidates]
    simplest = [one for one, count in zip(candidates, values, strict=True) if count == min(values)]
    if len(simplest) > 1 or (len(candidates) > 1 and min(values) > _STRAIGHT):
        return None
    best = simplest[0]
    near = _RIVAL * float(np.linalg.norm(place[best.index] - best.expected))
    named = {one.index for one in candidates}
    rivals = [
        _locate_expected_position(index, place, near, slack=2.0) for index in range(len(place)) if index not in named
    ]
    least = _count_coordinate_values(place, best, near)
    has_rival = any(one is not None and _count_coordinate_values(place, one, near) <= least for one in rivals)
    return None if has_rival else best


def restore_position(index: int, positions: ArrayLike) -> MisplacedPosition | None:
    """Compute where one of 4 to 16 positions (n, 3), in m, belongs if all others are right.

    None if it follows their layout, or they have none.
    """
    place = np.asarray(positions, dtype=float)
    if not 4 <= len(place) <= _MAX_POSITIONS or not np.isfinite(place).all():
        return None
    size = float(np.linalg.norm(place[:, None] - place[None], axis=2).max())
    return _locate_expected_position(index, place, _EXACT * size)


def _count_coordinate_values(place: Array, moved: MisplacedPosition, apart: float) -> int:
    """Count the absolute values, farther apart than ``apart`` (m), of the coordinates with one position restored."""
    whole = place.copy()
    whole[moved.index] = moved.expected
    return sum(1 + int(np.count_nonzero(np.diff(np.sort(np.abs(axis))) > apart)) for axis in whole.T)


def _locate_expected_position(
    index: int, place: Array, exact: float, *, slack: float = 1.0
) -> MisplacedPosition | None:
    """Compute where a position belongs in the layout of the others, if these follow it to within ``exact`` (m). ``slack``: factor
    by which it may be off more, and less, than usual."""
    others = np.delete(place, index, axis=0)
    apart = np.linalg.norm(others[:, None] - others[None], axis=2)
    size = float(apart.max())
    near = slack * _NEAR * float((apart + np.diag(np.full(len(others), np.inf))).min())
    if near <= exact:  # several at one position
        return None
    row = bool(np.linalg.svd(others - others.mean(axis=0), compute_uv=False)[1] < exact)
    if row and len(place) < _ROW:
        return None
    predictions = [
        p for p in _iter_position_predictions(others, exact, row) if np.linalg.norm(p.place - place[index]) < near
    ]
    partners = len({p.partner for p in predictions})
    if partners < 2:
        return None
    expected = np.mean([p.place for p in predictions], axis=0)
    residual = max(max(p.residual, float(np.linalg.norm(p.place - expected))) for p in predictions)
    off = float(np.linalg.norm(place[index] - expected))
    if residual > exact or off < max(residual / _RIVAL, _LEAST / slack * size):
        return None
    return MisplacedPosition(
        index=index,
        expected=expected,
        residual=residual,
        partners=partners,
        layout=_describe_layout(np.insert(others, index, expected, axis=0), row),
    )


def _iter_position_predictions(others: Array, exact: float, row: bool) -> Iterator[_PositionPrediction]:
    """Predict the missing position from the mirrors and the shifts of a row that the others follow among themselves."""
    for one, other in combinations(range(len(others)), 2):
        across = others[other] - others[one]
        normal = across / np.linalg.norm(across)
        images = others - 2.0 * np.outer((others - (others[one] + others[other]) / 2) @ normal, normal)
        missed = np.linalg.norm(images[:, None] - others[None], axis=2).min(axis=1)
        alone = np.flatnonzero(missed > exact)
        if len(alone) == 1:
            yield _PositionPrediction(int(alone[0]), images[alone[0]], float(np.delete(missed, alone).max()))
    if row:
        for one, other in combinations(range(len(others)), 2):
            for shift in (others[other] - others[one], others[one] - others[other]):
                images = others + shift
                missed = np.linalg.norm(images[:, None] - others[None], axis=2).min(axis=1)
                if np.count_nonzero(missed <= exact) >= 2:
                    worst = float(missed[missed <= exact].max())
                    yield from (_PositionPrediction(int(k), images[k], worst) for k in np.flatnonzero(missed > exact))


def _describe_layout(place: Array, row: bool) -> str:
    """Describe the restored layout in words."""
    centred = place - place.mean(axis=0)
    reach = np.linalg.norm(centred, axis=1)
    size = 2 * float(reach.max())
    apart = np.sort(np.linalg.norm(place[:, None] - place[None], axis=2), axis=1)[:, 1:]
    ring = bool(np.ptp(reach) < 4 * _EXACT * size)
    if row:
        return f"a row with {_format_length(float(apart.min()))} between neighbours"
    if len(place) == 4 and ring:
        sides = apart[0][:2]
        return f"the corners of a rectangle of {_format_length(float(sides[1]))} by {_format_length(float(sides[0]))}"
    if ring and np.ptp(apart[:, 0]) < 4 * _EXACT * size and np.ptp(apart[:, 1]) < 4 * _EXACT * size:
        return f"a ring of {len(place)} with a radius of {_format_length(float(reach.mean()))}"
    return "positions that mirror or repeat each other"


def _format_length(metres: float) -> str:
    return f"{metres:.4g} m" if metres >= 1.0 else f"{metres * 1e3:.4g} mm"
