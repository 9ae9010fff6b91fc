"""The median is numpy's."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from urdfcheck.facts.median import compute_median, compute_medians


@pytest.mark.parametrize("count", range(1, 9))
def test_it_is_that_of_numpy(count: int) -> None:
    random = np.random.default_rng(count)
    rows = random.normal(size=(count, 3)) * 10.0 ** random.integers(-300, 300, size=(count, 3))
    rows[0, 0] = np.inf
    assert compute_medians(rows).tolist() == np.median(rows, axis=0).tolist()
    assert compute_median(rows[:, 1]) == np.median(rows[:, 1])
    assert compute_median(rows.tolist()) == np.median(rows)
    rows[-1, 2] = np.nan
    assert np.array_equal(compute_medians(rows), np.median(rows, axis=0), equal_nan=True)


def test_of_none_it_is_not_a_number() -> None:
    assert np.isnan(compute_median([]))
    assert np.isnan(compute_medians(np.empty((0, 3)))).tolist() == [True] * 3


def test_it_loads_no_masked_arrays() -> None:
    script = (
        "import sys; from urdfcheck.facts.median import compute_median; compute_median([1, 2]); "
        "print('numpy.ma' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
