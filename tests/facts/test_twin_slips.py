"""One mistake between the numbers of twins, whatever their frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.twin_slips import find_slip_between_twins, find_twin_slip
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

TENSOR = np.array(((0.012, 0.001, -0.002), (0.001, 0.009, 0.0015), (-0.002, 0.0015, 0.007)))
PART = DeclaredInertial(mass=1.7, com=np.array((0.03, -0.02, 0.11)), tensor=TENSOR, rotation=np.eye(3))
TURN = rpy_to_matrix((0.4, -1.1, 2.0))
# The same part in another frame.
TWIN = DeclaredInertial(mass=1.7, com=TURN @ PART.com, tensor=TENSOR, rotation=TURN)
SHIFT = PART.mass * (PART.com @ PART.com * np.eye(3) - np.outer(PART.com, PART.com))


@pytest.mark.parametrize(
    ("wrong", "expected"),
    [
        (replace(PART, tensor=TENSOR * 1e6), ("inertia_unit", "kg·mm²")),
        (replace(PART, tensor=TENSOR * 1e3), ("inertia_unit", "g·m²")),
        (replace(PART, mass=1700.0), ("mass_unit", "g")),
        (replace(PART, com=PART.com * 1e3), ("com_unit", "mm")),
        (replace(PART, mass=17.0, tensor=TENSOR * 10), ("decimal_point", "mass and tensor 0.1")),
        (replace(PART, tensor=TENSOR + SHIFT), ("about_origin", "")),
        (replace(PART, tensor=(TENSOR + SHIFT) * (2 * np.eye(3) - 1)), ("positive_notation", "")),
    ],
)
def test_the_mistake_is_named_in_the_twins_frame_too(wrong: DeclaredInertial, expected: tuple[str, str]) -> None:
    slip = find_twin_slip(wrong, TWIN)
    assert slip is not None
    assert (slip.id, slip.detail) == expected


@pytest.mark.parametrize(
    "other",
    [
        TWIN,
        replace(PART, com=PART.com + 0.05),  # another frame, or another COM: nothing tells
        replace(PART, mass=2.5, tensor=TENSOR * 2.5 / 1.7),  # another material
        replace(PART, tensor=TENSOR * 1.2),
        replace(PART, tensor=TENSOR * (2 * np.eye(3) - 1)),  # other signs, by which these moments hardly differ
        replace(PART, com=PART.com * (1.0, 10.0, 1.0)),  # one coordinate more or less explains many distances
        replace(PART, mass=17.0, tensor=TENSOR * 3.0),
    ],
)
def test_what_no_common_mistake_explains_is_not_named(other: DeclaredInertial) -> None:
    assert find_twin_slip(other, TWIN) is None
    assert find_slip_between_twins(other, TWIN) is None


def test_a_com_next_to_the_frame_shows_no_unit() -> None:
    near = replace(PART, com=np.array((1e-5, 0.0, 2e-5)))
    assert find_twin_slip(replace(near, com=near.com * 1e3), near) is None


def test_the_side_with_the_likelier_mistake_has_it() -> None:
    heavy = replace(PART, mass=1700.0)
    first, second = find_slip_between_twins(heavy, TWIN), find_slip_between_twins(TWIN, heavy)
    assert first is not None
    assert second is not None
    assert (first.is_first, first.is_either) == (True, False)
    assert (second.is_first, second.is_either) == (False, False)
    decimal = find_slip_between_twins(replace(PART, mass=17.0), TWIN)
    assert decimal is not None
    assert decimal.is_either


def test_one_coordinate_has_another_point_where_the_others_are_the_twins() -> None:
    slipped = replace(PART, com=PART.com * (1.0, 10.0, 1.0))
    mirrored = replace(PART, com=PART.com * (1.0, -1.0, 1.0))
    slip = find_twin_slip(slipped, mirrored)
    assert slip is not None
    assert (slip.id, slip.detail) == ("decimal_point", "com y 0.1")
    for first, second in ((slipped, mirrored), (mirrored, slipped)):
        found = find_slip_between_twins(first, second)
        assert found is not None
        assert found.is_either
        assert found.is_first == (first is slipped)


def test_a_coordinate_near_zero_is_not_that_of_the_other_with_another_point() -> None:
    near = replace(PART, com=np.array((0.001, 0.0001, -0.06)))
    assert find_twin_slip(replace(near, com=np.array((0.001, -0.034, -0.06))), near) is None
    slipped = replace(near, com=np.array((0.001, -0.034, -0.06)))
    found = find_twin_slip(slipped, replace(near, com=np.array((0.001, 0.0034, -0.06))))
    assert found is not None


def test_the_com_that_is_farther_away_has_the_mistake() -> None:
    lone = replace(PART, com=np.array((0.0, 0.0, -0.2)))
    found = find_slip_between_twins(replace(lone, com=lone.com * 1e3), lone)
    assert found is not None
    assert found.is_first
