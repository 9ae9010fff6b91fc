"""The one place that breaks a layout: found where it is certain, never guessed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.likeness.layout import MisplacedPosition, find_misplaced_position
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

CORNERS = np.array([(0.07, 0.052, 0), (-0.07, 0.052, 0), (0.07, -0.052, 0), (-0.07, -0.052, 0)])
angle = st.floats(-math.pi, math.pi)
shift = st.floats(-1.0, 1.0)


def moved(places: np.ndarray, index: int, by: object) -> np.ndarray:
    changed = np.array(places, dtype=float)
    changed[index] += by
    return changed


def get_misplaced_position(places: np.ndarray) -> MisplacedPosition:
    one = find_misplaced_position(places)
    assert one is not None
    return one


def ring(count: int, radius: float = 0.3) -> np.ndarray:
    angles = 2 * math.pi * np.arange(count) / count
    return radius * np.column_stack((np.cos(angles), np.sin(angles), np.zeros(count)))


@pytest.mark.parametrize("index", range(4))
@pytest.mark.parametrize("by", [(0.002, 0, 0), (0, -0.002, 0), (0, 0, 0.002), (0.01, 0, 0), (0.003, 0.002, 0.001)])
def test_a_corner_that_is_off_is_named(index: int, by: tuple[float, float, float]) -> None:
    one = get_misplaced_position(moved(CORNERS, index, by))
    assert one.index == index
    assert_allclose(one.expected, CORNERS[index], atol=1e-5)
    assert one.layout == "the corners of a rectangle of 140 mm by 104 mm"
    assert one.partners == 2


@pytest.mark.parametrize("places", [CORNERS, ring(5), ring(6), ring(8), [(0.1 * i, 0, 0) for i in range(6)]])
def test_layouts_that_are_kept_have_no_odd_place(places: np.ndarray) -> None:
    assert find_misplaced_position(places) is None


@pytest.mark.parametrize("count", [5, 6, 8])
def test_on_a_ring_every_other_place_says_where_the_odd_one_belongs(count: int) -> None:
    one = get_misplaced_position(moved(ring(count), 2, (0.005, 0.002, 0)))
    assert (one.index, one.partners) == (2, count - 1)
    assert one.layout == f"a ring of {count} with a radius of 300 mm"


@pytest.mark.parametrize("index", range(5))
def test_in_a_row_the_neighbours_say_it(index: int) -> None:
    one = get_misplaced_position(moved(np.array([(0.1 * i, 0.3, 0) for i in range(5)]), index, (0.004, 0, 0.002)))
    assert one.index == index
    assert one.layout == "a row with 100 mm between neighbours"


@pytest.mark.slow
@settings(max_examples=60)
@given(
    st.permutations(range(4)), st.tuples(angle, angle, angle), st.tuples(shift, shift, shift), st.floats(0.01, 100.0)
)
def test_the_verdict_depends_on_neither_order_nor_pose_nor_size(
    order: list[int], rpy: tuple[float, float, float], move: tuple[float, float, float], scale: float
) -> None:
    turn = rpy_to_matrix(rpy)
    places = moved(CORNERS, 3, (0.003, 0.002, 0))[order]
    one = get_misplaced_position(scale * (places @ turn.T + move))
    assert order[one.index] == 3
    assert_allclose(one.expected, scale * (turn @ CORNERS[3] + move), atol=1e-5 * scale)


@pytest.mark.slow
@settings(max_examples=50)
@given(
    st.sampled_from((4, 5, 6, 8)),
    st.data(),
    st.tuples(angle, angle, angle),
    st.tuples(*[st.floats(-0.03, 0.03)] * 3),
)
def test_the_right_one_is_named_or_none(
    count: int, data: st.DataObject, rpy: tuple[float, float, float], by: tuple[float, float, float]
) -> None:
    index = data.draw(st.integers(0, count - 1))
    places = CORNERS if count == 4 else ring(count)
    one = find_misplaced_position(moved(places, index, by) @ rpy_to_matrix(rpy).T)
    assert one is None or one.index == index


def test_a_corner_drawn_out_along_a_side_is_named_only_where_other_coordinates_say_so() -> None:
    # Its neighbour left behind by a longer rectangle explains it as well, unless the sides are as far from the middle.
    assert get_misplaced_position(moved(CORNERS, 0, (0.004, 0, 0))).index == 0
    assert find_misplaced_position(moved(CORNERS + np.array((0.1, 0, 0)), 0, (0.004, 0, 0))) is None


@pytest.mark.parametrize(
    "places",
    [
        [(0.07, 0.05, 0), (0.07, -0.05, 0), (-0.07, 0.06, 0), (-0.07, -0.06, 0)],  # a trapezoid
        [(0, 0, 0), (0.022, 0, 0), (0.044, 0.004, 0), (0.066, 0, 0)],  # fingers, the middle one raised
        moved(moved(CORNERS, 0, (0.003, 0.002, 0)), 3, (0.002, -0.004, 0)),  # two are off
        moved(CORNERS, 0, (0.03, 0.02, 0)),  # too far for a slip
        moved(CORNERS, 0, (5e-5, 5e-5, 0)),  # typed to a tenth of a millimetre
        CORNERS * 0,  # all in one place
        CORNERS[:3],
        np.full((4, 3), np.nan),
    ],
)
def test_where_nothing_is_certain_nothing_is_said(places: object) -> None:
    assert find_misplaced_position(places) is None  # type: ignore[arg-type]
