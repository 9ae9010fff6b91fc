"""Standing on a plane: contacts, support polygon, tip angle, falling, rocking."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from urdfcheck.facts.motion.contact import SLACK, compute_ground_support, compute_rocking_gaps, simulate_tipping

Array = NDArray[np.float64]
RANDOM = np.random.default_rng(4)
# A table of 0.4 m by 0.2 m, 0.5 m high: four feet and their numbers.
FEET = np.array([(x, y, 0.0) for x, y in product((-0.2, 0.2), (-0.1, 0.1))])
TABLE = np.concatenate((FEET, FEET + np.array((0, 0, 0.5))))
PARTS = np.arange(8)


def yaw(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array(((c, -s, 0), (s, c, 0), (0, 0, 1)))


@pytest.mark.parametrize(("x", "y", "margin"), [(0, 0, 0.1), (0.15, 0, 0.05), (0, -0.08, 0.02), (0.25, 0, -0.05)])
def test_the_margin_is_the_distance_to_the_nearest_edge(x: float, y: float, margin: float) -> None:
    found = compute_ground_support(TABLE, parts=PARTS, com=(x, y, 0.3))
    assert set(found.touching) == {0, 1, 2, 3}
    assert found.margin == pytest.approx(margin)
    assert found.height == pytest.approx(0.3)
    assert found.tip_angle == pytest.approx(math.atan2(margin, 0.3))


def test_outside_a_corner_the_corner_is_nearest() -> None:
    found = compute_ground_support(TABLE, parts=PARTS, com=(0.23, 0.14, 0.3))
    assert found.margin == pytest.approx(-0.05)
    assert found.nearest == pytest.approx((0.2, 0.1, 0.0))
    assert found.outwards == pytest.approx((0.6, 0.8, 0.0))


def test_on_an_edge_the_way_out_is_across_it() -> None:
    found = compute_ground_support(TABLE, parts=PARTS, com=(0.2, 0.0, 0.3))
    assert found.margin == 0.0
    assert found.outwards == pytest.approx((1.0, 0.0, 0.0))


@pytest.mark.slow
def test_moving_turning_and_scaling_the_body_change_nothing() -> None:
    for _ in range(20):
        com = RANDOM.uniform((-0.3, -0.2, 0.1), (0.3, 0.2, 0.4))
        plain, turn, shift, size = (
            compute_ground_support(TABLE, parts=PARTS, com=com),
            yaw(RANDOM.uniform(0, 6)),
            RANDOM.uniform(-3, 3, 3),
            7.0,
        )
        other = compute_ground_support(TABLE @ turn.T * size + shift, parts=PARTS, com=turn @ com * size + shift)
        assert other.margin == pytest.approx(plain.margin * size)
        assert other.nearest == pytest.approx(turn @ plain.nearest * size + shift)
        assert simulate_tipping(TABLE @ turn.T * size + shift, PARTS, turn @ com * size + shift).tilt == pytest.approx(
            simulate_tipping(TABLE, PARTS, com).tilt
        )


def test_a_foot_that_hangs_within_the_slack_touches() -> None:
    reach = math.hypot(0.2, 0.1)
    for part, touches in ((0.9, True), (1.1, False)):
        lifted = TABLE.copy()
        lifted[0, 2] = part * math.tan(SLACK) * reach
        assert (0 in compute_ground_support(lifted, parts=PARTS, com=(0, 0, 0.3)).touching) is touches


def test_a_rounded_foot_touches_at_its_lowest_point_only() -> None:
    """Or the flanks of a large wheel would widen the polygon."""
    angles = np.arange(64) * math.tau / 64
    rim = np.column_stack((np.sin(angles), np.zeros(64), 1 - np.cos(angles))) * 0.2
    found = compute_ground_support(
        np.concatenate((rim, rim + np.array((0, 0.3, 0)))), parts=np.repeat((0, 1), 64), com=(0, 0.15, 0.4)
    )
    assert np.ptp(found.polygon[:, 0]) == 0.0


def build_soles(rise: float) -> tuple[Array, Array]:
    """Two soles of 0.2 m on the lowest three points of their heels; the toes are ``rise`` higher."""
    heel = [(0, y, 0.0) for y in (0.0, 0.03, 0.06)]
    toe = [(0.2, y, rise) for y in (0.0, 0.06)]
    sole = np.array((*heel, *toe, (0.1, 0.03, 1.5)))
    return np.concatenate((sole, sole + np.array((0, 0.2, 0)))), np.repeat((0, 1), len(sole))


def test_an_uneven_sole_touches_with_what_an_invisible_tilt_brings_down() -> None:
    for part, length in ((0.0, 0.2), (0.8, 0.2), (1.2, 0.0)):
        rise = part * 1.5e-3  # of a body of 1.5 m
        points, parts = build_soles(rise)
        found = compute_ground_support(points, parts=parts, com=(0.1, 0.13, 0.8))
        assert np.ptp(found.polygon[:, 0]) == pytest.approx(length)
        assert (found.margin > 0) is (length > 0)


def test_the_flanks_of_a_wheel_are_no_sole_where_one_part_has_several() -> None:
    angles = np.arange(360) * math.tau / 360
    rim = np.column_stack((np.sin(angles), np.zeros(360), 1 - np.cos(angles))) * 0.1
    wheels = np.concatenate([rim + np.array((x, y, 0)) for x in (0.0, 0.5) for y in (0.0, 0.3)])
    found = compute_ground_support(wheels, parts=np.zeros(len(wheels), dtype=int), com=(0.25, 0.15, 0.1))
    assert np.ptp(found.polygon[:, 0]) == pytest.approx(0.5, abs=0.005)


def test_a_corner_that_is_there_twice_is_one() -> None:
    twice = np.concatenate((TABLE, TABLE + 1e-17))
    assert len(compute_ground_support(twice, parts=np.arange(16), com=(0, 0, 0.3)).polygon) == 4


def test_what_stands_rests_as_it_was_put() -> None:
    found = simulate_tipping(TABLE, PARTS, (0.1, 0.05, 0.4))
    assert (found.tilt, found.last_contact) == (0.0, None)


def test_a_table_falls_on_its_side() -> None:
    found = simulate_tipping(TABLE, PARTS, (0.25, 0, 0.2), limit=math.pi)
    assert found.tilt == pytest.approx(math.pi / 2)
    assert found.last_contact is not None
    assert (
        TABLE[found.last_contact] == pytest.approx((0.2, abs(TABLE[found.last_contact][1]), 0.5))
        or TABLE[found.last_contact][0] == 0.2
    )
    assert simulate_tipping(TABLE, PARTS, (0.25, 0, 0.2), limit=1.0).tilt == math.inf


def test_a_short_leg_is_reached_by_leaning() -> None:
    """Two feet on one side are 20 mm short: the table leans by atan(20/400)."""
    short = TABLE.copy()
    short[2:4, 2] = 0.02
    found = simulate_tipping(short, PARTS, (0.05, 0, 0.2))
    assert found.tilt == pytest.approx(math.atan2(0.02, 0.4))
    assert found.last_contact in {2, 3}


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("off", [0.003, -0.003])
def test_one_foot_off_the_plane_of_a_rectangle_rocks_by_as_much(place: int, off: float) -> None:
    feet = FEET.copy()
    feet[place, 2] += off
    gaps = compute_rocking_gaps(feet)
    assert gaps is not None
    assert gaps.max() == pytest.approx(0.003)


def test_a_leaning_plane_does_not_rock_and_a_line_has_none() -> None:
    gaps = compute_rocking_gaps(FEET + FEET[:, :1] * (0, 0, 0.1))
    assert gaps is not None
    assert gaps.max() == pytest.approx(0.0, abs=1e-12)
    assert compute_rocking_gaps([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]) is None
