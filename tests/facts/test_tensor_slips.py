"""What the six numbers of an impossible inertia tensor show, and the nearest possible one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.inertials.inertia_tensor import (
    build_inertia_tensor,
    check_inertia_validity,
    compute_solid_inertia,
    compute_triangle_excess,
    list_inertia_components,
    make_box_solid,
    transform_solid,
)
from urdfcheck.facts.inertials.mistakes.tensor_slips import (
    find_filled_products,
    find_moved_moment,
    find_nearest_tensor,
    find_repeated_slot,
    find_wrong_signs,
)
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

pytestmark = pytest.mark.slow

PRODUCTS = (1, 2, 4)
size = st.floats(0.02, 1.0)
angle = st.floats(-1.5, 1.5)
number = st.floats(-1.0, 1.0)
thin, wide, skew = st.floats(0.005, 0.02), st.floats(0.3, 1.0), st.floats(0.4, 1.1)


def flip(components: Sequence[float], *places: int) -> list[float]:
    return [-v if i in places else v for i, v in enumerate(components)]


def is_possible(components: Sequence[float]) -> bool:
    validity = check_inertia_validity(build_inertia_tensor(components))
    return validity.positive_definite and validity.triangle_inequality


# -- the nearest tensor -------------------------------------------------------------------------------------------------


@given(st.tuples(*[number] * 6), st.floats(1e-9, 1e3))
def test_the_nearest_tensor_is_possible_also_with_six_digits(numbers: tuple[float, ...], unit: float) -> None:
    assume(max(map(abs, numbers)) > 1e-3)
    nearest, _ = find_nearest_tensor([v * unit for v in numbers])
    assert is_possible(nearest)
    assert is_possible([float(f"{v:.6g}") for v in nearest])


@given(size, size, size, angle, angle, angle)
def test_a_possible_tensor_is_its_own_nearest(a: float, b: float, c: float, r: float, p: float, y: float) -> None:
    turned = transform_solid(make_box_solid((a, b, c)), rpy_to_matrix((r, p, y)), (0, 0, 0))
    components = list_inertia_components(compute_solid_inertia(turned, 2.0))
    nearest, change = find_nearest_tensor(components)
    assert change < 1e-3
    assert_allclose(nearest, components, atol=1e-3 * max(components))


@given(st.tuples(*[st.floats(0.1, 1.0)] * 3), angle, angle, angle, st.floats(1e-6, 1e6))
def test_the_nearest_tensor_does_not_depend_on_axes_and_units(
    moments: tuple[float, ...], r: float, p: float, y: float, unit: float
) -> None:
    turn = np.array(rpy_to_matrix((r, p, y)))
    straight, change = find_nearest_tensor(list_inertia_components(np.diag(moments)))
    turned, changed = find_nearest_tensor(list_inertia_components(unit * turn @ np.diag(moments) @ turn.T))
    assert_allclose(
        build_inertia_tensor(turned), unit * turn @ build_inertia_tensor(straight) @ turn.T, atol=1e-9 * unit
    )
    assert (change < 1e-4) == (changed < 1e-4)


# -- signs --------------------------------------------------------------------------------------------------------------


# Most plates are not skew enough, or possible with the wrong sign too.
@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(thin, wide, wide, skew, skew, skew, st.floats(0.5, 2.0), st.sampled_from([PRODUCTS, (1,), (2,), (4,)]))
def test_the_drawn_part_tells_which_signs_are_wrong(
    a: float, b: float, c: float, r: float, p: float, y: float, density: float, wrong: tuple[int, ...]
) -> None:
    # A skew plate: with one sign wrong no body has its tensor.
    turned = transform_solid(make_box_solid((a, b, c)), rpy_to_matrix((r, p, y)), (0, 0, 0))
    right = compute_solid_inertia(turned, 1.0)
    components = list_inertia_components(right)
    products = [abs(components[i]) for i in PRODUCTS]
    assume(min(products) > 0.02 * max(components))
    typed = flip(components, *wrong)
    assume(not is_possible(typed))
    slip = find_wrong_signs(typed, density * right)
    assert slip is not None
    assert slip.id == ("products_sign" if len(wrong) == 3 else "one_sign")
    assert slip.components is not None
    assert_allclose(slip.components, components)


def test_without_a_drawn_part_all_three_signs_are_the_guess() -> None:
    typed = (0.0053694, 0.0014185, -0.00092094, 0.0032423, -0.00169178, 0.00501731)
    slip = find_wrong_signs(typed, None)
    assert slip is not None
    assert (slip.id, slip.residual) == ("products_sign", None)


def test_a_drawn_part_without_products_says_nothing_of_signs() -> None:
    typed = (0.0053694, 0.0014185, -0.00092094, 0.0032423, -0.00169178, 0.00501731)
    assert find_wrong_signs(typed, np.diag((0.0056, 0.0041, 0.0048))) is None


@pytest.mark.parametrize("typed", [(1, 0.9, 0, 1, 0, 1), (0.1, 0.09, 0.09, 0.1, 0.09, 0.5)])
def test_signs_that_leave_it_impossible_are_no_explanation(typed: tuple[float, ...]) -> None:
    assert compute_triangle_excess(build_inertia_tensor(typed)) < 0
    assert find_wrong_signs(typed, None) is None


# -- numbers that stand in several places -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("texts", "detail"),
    [
        (["1e-6"] * 6, "all six numbers are 1e-6"),
        (["2.4e-06", "1e-06", "1e-06", "2.4e-06", "1e-06", "7.5e-07"], "all three products are 1e-06"),
        (["0.1", "0.3", "0.3", "0.1", "0.3", "0.1"], "all three products are 0.3"),
        (["0.1", "0", "0", "0.1", "0", "0.9"], None),
        (["0.1", "0.3", "0.3", "0.1", "-0.3", "0.1"], None),
        (["0.1", "0.3", "0.3", "0.1", "0.3", "0.9"], None),  # the moments are impossible by themselves
    ],
)
def test_products_that_were_filled_in(texts: list[str], detail: str | None) -> None:
    slip = find_filled_products([float(text) for text in texts], texts)
    assert (None if slip is None else slip.detail) == detail
    if slip is not None and slip.components is not None:
        assert [slip.components[i] for i in PRODUCTS] == [0, 0, 0]


@pytest.mark.parametrize(
    ("texts", "detail"),
    [
        (["0.000637", "0.000484569", "0.000424", "0.000929", "5e-06", "0.000484569"], "ixy repeats izz"),
        (["4.8457e-4", "0.000424", "-4.8457e-4", "0.000929", "5e-06", "0.0004"], "ixz repeats ixx"),
        (["-0.1891", "-0.0", "-0.0", "0.0", "0.1891", "0.0"], None),
        (["0.01", "0.01", "0.003", "0.02", "0", "0.01"], None),  # a round number may stand twice
        (["0.1234", "0.01", "0.003", "0.1234", "0", "0.01"], None),  # two moments of a body of revolution
    ],
)
def test_a_product_that_repeats_a_moment(texts: list[str], detail: str | None) -> None:
    slip = find_repeated_slot(texts)
    assert (None if slip is None else slip.detail) == detail


@pytest.mark.parametrize(
    ("components", "wanted"),
    [
        ((0.001, 0, 0.0005, 0, 0, 0.001), (0.001, 0, 0, 0.0005, 0, 0.001)),
        ((0.001, 0, 0.0001, 0, 0, 0.001), None),  # a small product of a rod
        ((0.001, 0.0005, 0, 0.001, 0, 0), None),  # not beside it
        ((0.001, 0, -0.0005, 0, 0, 0.001), None),  # no moment
        ((0.001, 0, 0.0005, 0, 0.0002, 0.001), None),
        ((0.001, 0, 0.0005, 0, 0, 0.0001), None),  # impossible there too
    ],
)
def test_the_number_of_a_moment_of_zero_is_beside_it(
    components: tuple[float, ...], wanted: tuple[float, ...] | None
) -> None:
    slip = find_moved_moment(components)
    assert (None if slip is None else slip.components) == wanted
