"""Statics and dynamics against closed forms and against sums of our own over the links."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.motion import dynamics
from urdfcheck.facts.motion.kinematics import build_origin_transform, compute_joint_motions

pinocchio = pytest.importorskip("pinocchio")
G = 9.81


@dataclass(frozen=True)
class Part:
    """A link and the joint that moves it: parent is the index of another part, -1 for the root."""

    parent: int
    kind: str
    axis: tuple[float, float, float]
    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float] = (0, 0, 0)
    mass: float = 1.0
    com: tuple[float, float, float] = (0, 0, 0)
    inertia: tuple[float, float, float] = (0.01, 0.01, 0.01)


def words(numbers: tuple[float, ...]) -> str:
    return " ".join(map(repr, numbers))


def built(parts: list[Part], yaw: float = 0.0) -> object:
    """The parts in Pinocchio; the whole robot turned about z by ``yaw``."""
    text = '<robot name="r"><link name="root"/><link name="base"/>'
    text += (
        f'<joint name="turn" type="fixed"><parent link="root"/><child link="base"/><origin rpy="0 0 {yaw!r}"/></joint>'
    )
    for i, part in enumerate(parts):
        xx, yy, zz = part.inertia
        text += (
            f'<link name="l{i}"><inertial><origin xyz="{words(part.com)}"/><mass value="{part.mass!r}"/>'
            f'<inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{i}" type="{part.kind}"><parent link="{f"l{part.parent}" if part.parent >= 0 else "base"}"/>'
            f'<child link="l{i}"/><origin xyz="{words(part.xyz)}" rpy="{words(part.rpy)}"/><axis xyz="{words(part.axis)}"/>'
            '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
        )
    return pinocchio.buildModelFromXML(text + "</robot>")


def at(model: object, count: int, values: object) -> tuple[dynamics.JointCoordinates, np.ndarray]:
    places = dynamics.locate_joint_coordinates(model, [f"j{i}" for i in range(count)])
    return places, dynamics.build_configurations(places, np.atleast_2d(np.asarray(values, dtype=float)))


def torques(parts: list[Part], values: object, yaw: float = 0.0) -> np.ndarray:
    model = built(parts, yaw)
    places, q = at(model, len(parts), values)
    return dynamics.compute_gravity_torques(model, model.createData(), q)[:, places.velocity]


def summed(parts: list[Part], values: list[float]) -> np.ndarray:
    """The moment of every weight about every joint before it, summed one by one."""
    frames: list[np.ndarray] = []
    for part, value in zip(parts, values, strict=True):
        before = np.eye(4) if part.parent < 0 else frames[part.parent]
        axis = np.array(part.axis) / np.linalg.norm(part.axis)
        move = compute_joint_motions(axis, [value], rotates=part.kind != "prismatic")[0]
        frames.append(before @ build_origin_transform(part.xyz, part.rpy) @ move)
    found = np.zeros(len(parts))
    for i, part in enumerate(parts):
        weight = np.array((0, 0, -G * part.mass))
        place = frames[i] @ (*part.com, 1)
        j = i
        while j >= 0:
            axis = frames[j][:3, :3] @ parts[j].axis / np.linalg.norm(parts[j].axis)
            moment = weight if parts[j].kind == "prismatic" else np.cross(place[:3] - frames[j][:3, 3], weight)
            found[j] -= axis @ moment
            j = parts[j].parent
    return found


unit = st.floats(-1, 1)
vector = st.tuples(unit, unit, unit)
axis = vector.filter(lambda v: math.hypot(*v) > 0.1)


@st.composite
def robots(draw: st.DrawFn) -> list[Part]:
    kinds = st.sampled_from(["revolute", "continuous", "prismatic"])
    return [
        Part(draw(st.integers(-1, i - 1)), draw(kinds), *(draw(s) for s in (axis, vector, vector)), com=draw(vector))
        for i in range(draw(st.integers(1, 5)))
    ]


@pytest.mark.slow
@settings(max_examples=40)
@given(robots(), st.lists(st.floats(-3, 3), min_size=5, max_size=5), st.floats(-3, 3), st.floats(0.1, 10))
def test_gravity_torques_are_the_moments_of_the_weights(
    parts: list[Part], values: list[float], yaw: float, factor: float
) -> None:
    values = values[: len(parts)]
    expected = summed(parts, values)
    assert_allclose(torques(parts, values)[0], expected, atol=1e-9)
    # Turned about the vertical, the robot holds the same; of heavier material, it holds more in proportion.
    assert_allclose(torques(parts, values, yaw)[0], expected, atol=1e-9)
    heavier = [Part(**{**part.__dict__, "mass": factor * part.mass}) for part in parts]
    assert_allclose(torques(heavier, values)[0], factor * expected, atol=1e-8)


PENDULUM = Part(-1, "continuous", (0, 1, 0), (0, 0, 1), mass=2.0, com=(0, 0, -0.5), inertia=(0.1, 0.3, 0.2))


@pytest.mark.parametrize("angle", [0.0, 0.5, math.pi / 2, -2.0])
def test_a_pendulum(angle: float) -> None:
    model = built([PENDULUM])
    _, q = at(model, 1, [angle])
    assert q.tolist() == [[math.cos(angle), math.sin(angle)]]
    assert_allclose(torques([PENDULUM], [angle]), [[2.0 * G * 0.5 * math.sin(angle)]], atol=1e-12)
    data = model.createData()
    assert_allclose(dynamics.compute_mass_matrices(model, data, q), [[[0.3 + 2.0 * 0.25]]])
    assert_allclose(
        dynamics.compute_effective_inertias(dynamics.compute_inverse_mass_matrices(model, data, q)), [[0.8]]
    )


@settings(max_examples=20)
@given(robots(), st.lists(st.floats(-3, 3), min_size=5, max_size=5))
def test_inverse_mass_matrices_are_the_inverses(parts: list[Part], values: list[float]) -> None:
    model = built(parts)
    _, q = at(model, len(parts), values[: len(parts)])
    data = model.createData()
    product = (
        dynamics.compute_mass_matrices(model, data, q)[0] @ dynamics.compute_inverse_mass_matrices(model, data, q)[0]
    )
    assert_allclose(product, np.eye(model.nv), atol=1e-6)


@pytest.mark.slow
@given(st.lists(st.floats(1e-3, 1e3), min_size=3, max_size=3))
def test_conditioning_does_not_depend_on_the_units_of_the_joints(factors: list[float]) -> None:
    parts = [Part(i - 1, "revolute", (0, 1, 0), (0, 0, 0.5), com=(0, 0, 0.2)) for i in range(3)]
    model = built(parts)
    _, q = at(model, 3, [[0, 0, 0], [0.3, 1, 2], [0, -1, 0.4]])
    matrices = dynamics.compute_mass_matrices(model, model.createData(), q)
    other = matrices * np.outer(factors, factors)
    assert dynamics.measure_conditioning(other).number == pytest.approx(
        dynamics.measure_conditioning(matrices).number, rel=1e-6
    )


def test_the_median_configuration_counts() -> None:
    def pair(s: float) -> list[list[float]]:
        return [[1.0, s], [s, 1.0]]

    found = dynamics.measure_conditioning(np.array([pair(0.999999), pair(0.5), pair(0.0), pair(-0.6), pair(0.1)]))
    assert (found.number, found.index) == (pytest.approx(3.0), 1)
    assert_allclose(np.abs(found.direction), np.sqrt(0.5))


def test_a_singular_matrix_is_infinitely_ill_conditioned() -> None:
    assert dynamics.measure_conditioning(np.array([[[1.0, 2.0], [2.0, 1.0]]])).number == math.inf


def two_on_one_axis(own: float) -> list[Part]:
    """A body of the moment ``own`` between two joints on one axis, that carry 1 kg m²."""
    light = Part(-1, "revolute", (0, 0, 1), (0, 0, 0), mass=1e-3, inertia=(own, own, own))
    return [light, Part(0, "revolute", (0, 0, 1), (0, 0, 0), inertia=(1.0, 1.0, 1.0))]


@pytest.mark.parametrize("own", [1e-6, 1e-3])
def test_a_light_body_between_two_joints_on_one_axis(own: float) -> None:
    model = built(two_on_one_axis(own))
    _, q = at(model, 2, [0.4, 1.0])
    matrices = dynamics.compute_mass_matrices(model, model.createData(), q)
    s = 1 / math.sqrt(1 + own)
    assert dynamics.measure_conditioning(matrices).number == pytest.approx((1 + s) / (1 - s), rel=1e-4)
    added = dynamics.compute_added_matrices(model, q, {"j0": dynamics.ADDED_INERTIA_SHARE})
    assert dynamics.measure_conditioning(matrices + added).number < 4.1 / dynamics.ADDED_INERTIA_SHARE
    # More inertia of the load, which both joints move, tells them no better apart.
    added = dynamics.compute_added_matrices(model, q, {"j1": dynamics.ADDED_INERTIA_SHARE})
    assert dynamics.measure_conditioning(matrices + added).number > (1 + s) / (1 - s)
    assert dynamics.compute_own_inertia(model, "j0", q[0]) == pytest.approx(own, rel=1e-9)


def test_more_inertia_in_one_place_does_not_mend_a_long_chain() -> None:
    parts = [Part(i - 1, "revolute", (0, 0, 1), (0.1, 0, 0), com=(0.05, 0, 0)) for i in range(16)]
    model = built(parts)
    _, q = at(model, 16, np.random.default_rng(0).uniform(-1, 1, (8, 16)))
    matrices = dynamics.compute_mass_matrices(model, model.createData(), q)
    before = dynamics.measure_conditioning(matrices).number
    assert before > 1e3
    for i in range(16):
        more = dynamics.ADDED_INERTIA_SHARE * float(matrices[0, i, i])
        added = dynamics.compute_added_matrices(model, q, {f"j{i}": more})
        assert dynamics.measure_conditioning(matrices + added).number * 3 > before


def test_what_a_mass_matrix_gains_is_that_of_the_changed_bodies() -> None:
    """A turning body gains inertia about every axis, a sliding one mass at its COM: as if the file said so."""

    def build(more: float) -> object:
        arm = Part(-1, "revolute", (0, 0, 1), (0.1, 0, 0), mass=1.0, inertia=(1.0 + more, 1.0 + more, 1.0 + more))
        slide = Part(0, "prismatic", (1, 0, 0), (0.2, 0.1, 0), mass=1.0 + more, com=(0.3, 0, 0))
        return built([arm, slide, Part(1, "revolute", (0, 1, 0), (0, 0, 0.1))])

    model, changed = build(0.0), build(0.25)
    _, q = at(model, 3, [0.4, 0.2, 1.0])
    before, after = (dynamics.compute_mass_matrices(one, one.createData(), q) for one in (model, changed))
    added = dynamics.compute_added_matrices(model, q, {"j0": 0.25, "j1": 0.25})
    assert added == pytest.approx(after - before, abs=1e-12)


def test_explicit_damping_is_stable_up_to_two_over_the_rate() -> None:
    """Euler steps of a chain: the velocity dies away just below the step, and grows just above it."""
    parts = [Part(i - 1, "revolute", (0, 1, 0), (0, 0, 0.3), com=(0, 0, 0.1)) for i in range(3)]
    model = built(parts)
    _, q = at(model, 3, [0.1, 0.7, -0.4])
    inverse = dynamics.compute_inverse_mass_matrices(model, model.createData(), q)[0]
    damping = np.array((0.2, 0.0, 0.5))
    rate = dynamics.compute_damping_rate(inverse, damping)
    assert rate >= (damping * np.diag(inverse)).max()
    for step, dies in ((1.98 / rate, True), (2.02 / rate, False)):
        once = np.eye(3) - step * inverse @ np.diag(damping)
        fastest = np.linalg.eigvals(once)
        assert (np.abs(fastest).max() <= 1 + 1e-12) == dies


def climbed(
    parts: list[Part], ranges: list[tuple[float, float]], start: list[float], place: int = 0
) -> dynamics.JointLoad:
    count = len(parts)
    model = built(parts)
    data = model.createData()
    places = dynamics.locate_joint_coordinates(model, [f"j{i}" for i in range(count)])

    def torque(values: np.ndarray) -> np.ndarray:
        q = dynamics.build_configurations(places, values)
        return dynamics.compute_gravity_torques(model, data, q)[:, places.velocity[place]]

    return dynamics.find_largest_load(
        torque, np.array(start), ranges=ranges, coupling=np.eye(count), joints=range(count)
    )


ARM = [
    Part(-1, "revolute", (0, 1, 0), (0, 0, 0), mass=3.0, com=(0, 0, 0.2)),
    Part(0, "revolute", (0, 1, 0), (0, 0, 0.4)),
]


def test_an_arm_holds_most_where_it_is_stretched_out() -> None:
    arm = [ARM[0], Part(**{**ARM[1].__dict__, "mass": 2.0, "com": (0, 0, 0.3)})]
    found = climbed(arm, [(-3, 3), (-3, 3)], [0.3, -1.0])
    assert found.torque == pytest.approx(G * (3.0 * 0.2 + 2.0 * 0.7), rel=1e-4)
    assert abs(math.sin(found.values[0])) == pytest.approx(1, abs=1e-2)
    assert found.values[1] == pytest.approx(0, abs=2e-2)


def test_limits_bound_the_worst_pose() -> None:
    found = climbed([ARM[0]], [(-0.5, 0.25)], [0.1])
    assert found.values.tolist() == [-0.5]
    assert found.torque == pytest.approx(G * 3.0 * 0.2 * math.sin(0.5), rel=1e-9)


def test_a_slide_carries_most_where_it_is_all_the_way_out() -> None:
    parts = [
        Part(-1, "revolute", (0, 1, 0), (0, 0, 0), com=(0.1, 0, 0)),
        Part(0, "prismatic", (1, 0, 0), (0.2, 0, 0), mass=2.0),
    ]
    found = climbed(parts, [(-0.1, 0.1), (0.0, 0.3)], [0.1, 0.1])
    assert found.values.tolist() == [pytest.approx(0, abs=1e-6), 0.3]
    assert found.torque == pytest.approx(G * (0.1 + 2.0 * 0.5))
