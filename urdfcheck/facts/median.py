"""The median. That of numpy loads its module for masked arrays, which takes as long as a tenth of all of numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from urdfcheck.facts.arrays import Array


def compute_median(values: Array | Sequence[float]) -> float:
    """Compute the median of numbers in any shape; NaN if one of them is, and of none."""
    return float(compute_medians(np.reshape(values, (-1, 1)))[0])


def compute_medians(rows: Array | Sequence[Sequence[float]] | Sequence[Array]) -> Array:
    """Compute the medians of the columns of ``rows`` (n, m)."""
    ordered = np.sort(np.asarray(rows, dtype=float), axis=0)
    if not len(ordered):
        return np.full(ordered.shape[1:], np.nan)
    half, is_odd = divmod(len(ordered), 2)
    middle = ordered[half] if is_odd else (ordered[half - 1] + ordered[half]) / 2.0
    return np.where(np.isnan(ordered[-1]), np.nan, middle)  # NaN is the last
