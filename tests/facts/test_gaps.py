"""Distances between points, against all pairs."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.facts.motion.gaps import is_within

clouds = st.tuples(st.integers(0, 2**32 - 1), st.integers(1, 200), st.floats(0.01, 3.0), st.floats(0.0, 5.0))


def make_cloud(seed: int, count: int, size: float, distance: float) -> np.ndarray:
    """Points in a box that is longer along one axis than along the others, at a distance."""
    random = np.random.default_rng(seed)
    return random.normal(size=(count, 3)) * size * random.uniform(0.01, 1.0, 3) + distance * random.normal(size=3)


@given(clouds, clouds, st.floats(1e-3, 10.0))
def test_the_nearest_of_all_pairs_decides(
    one: tuple[int, int, float, float], other: tuple[int, int, float, float], reach: float
) -> None:
    points, others = make_cloud(*one), make_cloud(*other)
    nearest = float(np.linalg.norm(points[:, None] - others, axis=2).min())
    assert is_within(points, others, reach) == is_within(others, points, reach) == (nearest < reach)
    for factor, expected in ((0.999, False), (1.001, True)):
        assert is_within(points, others, factor * nearest) == (expected and nearest > 0)


@pytest.mark.parametrize("counts", [(0, 3), (3, 0), (0, 0)])
def test_nothing_is_near_nothing(counts: tuple[int, int]) -> None:
    assert not is_within(np.zeros((counts[0], 3)), np.zeros((counts[1], 3)), 1.0)


def test_the_question_loads_no_scipy() -> None:
    asked = (
        "import numpy as np; from urdfcheck.facts.motion.gaps import is_within; is_within(np.eye(3), np.eye(3), 1.0)"
    )
    loaded = subprocess.check_output([sys.executable, "-c", f"{asked}; import sys; print('scipy' in sys.modules)"])
    assert loaded.split() == [b"False"]
