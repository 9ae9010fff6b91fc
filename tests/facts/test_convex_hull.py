"""Convex hulls of many points: what is left out is outside by no more than they say."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from urdfcheck.facts.arrays import Array
from urdfcheck.facts.mesh import convex_hull
from urdfcheck.facts.mesh.convex_hull import MOST_EXCESS, MeshHull, compute_convex_hull, compute_least_volume
from urdfcheck.facts.mesh.measure import measure_mesh
from urdfcheck.facts.mesh.moments import compute_mesh_moments
from urdfcheck.system import manifold_hull, qhull

ROUNDED = 1e-9


def measure_excess(points: Array, hull: MeshHull) -> float:
    """Measure by how much the hull must grow about the mean of the points to hold them all, in double precision."""
    centre = points.mean(axis=0)
    planes = ConvexHull(hull.vertices).equations
    slopes = planes[:, :3] / -(planes[:, :3] @ centre + planes[:, 3])[:, None]
    return (
        max(float(((block - centre) @ slopes.T).max()) for block in np.array_split(points, 1 + len(points) // 500))
        - 1.0
    )


def make_points(kind: str, count: int, random: np.random.Generator) -> Array:
    """Make about so many points (n, 3) as some meshes have them."""
    directions = random.standard_normal((count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    if kind == "sphere":
        return directions
    if kind == "noisy sphere":
        return directions * (1.0 + 0.01 * random.standard_normal((count, 1)))
    if kind == "torus":
        around, across = random.uniform(0.0, 2.0 * np.pi, (2, count))
        reach = 3.0 + np.cos(across)
        return np.column_stack((reach * np.cos(around), reach * np.sin(around), np.sin(across)))
    if kind == "far points":
        return random.standard_t(2.0, (count, 3))
    if kind == "lattice":  # many points in each plane and on each line
        edge = round(count ** (1 / 3))
        return np.stack(np.meshgrid(*[np.arange(edge, dtype=float)] * 3), axis=-1).reshape(-1, 3)
    plate = trimesh.creation.box((3.0, 2.0, 0.2)).vertices
    pin = (0.2, 0.2, 1.0) * trimesh.creation.cylinder(1.0, 1.0, sections=count // 8).vertices
    pins = [pin + np.array((*place, 0.5)) for place in plate[::2, :2]]
    return np.concatenate((plate, *pins))


@pytest.fixture
def few_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convex_hull, "MOST_EXACT", 100)


KINDS = ("sphere", "noisy sphere", "torus", "far points", "lattice", "pins on a plate")


@pytest.mark.usefixtures("few_are_many")
@pytest.mark.parametrize("kind", KINDS)
def test_no_point_is_farther_outside_than_the_hull_says(kind: str) -> None:
    points = make_points(kind, 4_000, np.random.default_rng(7))
    exact, hull = ConvexHull(points), compute_convex_hull(points)
    assert hull.excess == MOST_EXCESS
    assert measure_excess(points, hull) <= MOST_EXCESS + ROUNDED
    assert exact.volume / (1.0 + MOST_EXCESS) ** 3 <= hull.volume <= exact.volume * (1.0 + ROUNDED)
    # All of the corners are among the points, and its box is theirs.
    assert {*map(tuple, hull.vertices.tolist())} <= {*map(tuple, points.tolist())}
    np.testing.assert_array_equal(hull.vertices.min(axis=0), points.min(axis=0))
    np.testing.assert_array_equal(hull.vertices.max(axis=0), points.max(axis=0))
    # The faces close it and face outwards.
    assert compute_mesh_moments(hull.vertices, hull.faces).volume == pytest.approx(hull.volume)


@pytest.mark.usefixtures("few_are_many")
@settings(max_examples=10, deadline=None)
@given(
    kind=st.sampled_from(KINDS),
    seed=st.integers(0, 2**32 - 1),
    stretched=st.tuples(*[st.floats(-3.0, 1.0)] * 3),
    scale=st.sampled_from((1e-6, 1.0, 1e4)),
    distance=st.sampled_from((0.0, 5.0)),
)
def test_the_bound_holds_however_the_points_are_turned_stretched_and_placed(
    kind: str, seed: int, stretched: tuple[float, ...], scale: float, distance: float
) -> None:
    random = np.random.default_rng(seed)
    turn = np.linalg.qr(random.standard_normal((3, 3)))[0]
    points = scale * (make_points(kind, 2_000, random) * np.power(10.0, stretched) @ turn + distance)
    exact, hull = ConvexHull(points), compute_convex_hull(points)
    assert exact.volume / (1.0 + MOST_EXCESS) ** 3 <= hull.volume * (1.0 + 1e-6)
    assert hull.volume <= exact.volume * (1.0 + 1e-6)
    assert measure_excess(points, hull) <= MOST_EXCESS * 1.01


def test_a_smooth_mesh_of_many_corners_has_a_hull_of_few() -> None:
    hull = compute_convex_hull(make_points("sphere", convex_hull.MOST_EXACT + 1, np.random.default_rng(1)))
    assert len(hull.vertices) < 8_000
    assert hull.volume == pytest.approx(4.0 / 3.0 * np.pi, rel=3.0 * MOST_EXCESS)


def test_a_hull_of_few_points_is_exact() -> None:
    points = make_points("noisy sphere", 2_000, np.random.default_rng(1))
    exact, hull = ConvexHull(points), compute_convex_hull(points)
    assert hull.excess == 0.0
    assert hull.volume == exact.volume
    np.testing.assert_array_equal(hull.vertices, points[exact.vertices])


@pytest.mark.usefixtures("few_are_many")
@pytest.mark.parametrize("flat", [(1.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)])
def test_many_points_in_a_plane_have_their_box(flat: tuple[float, ...]) -> None:
    hull = compute_convex_hull(make_points("sphere", 1_000, np.random.default_rng(1)) * flat)
    assert (hull.volume, hull.excess, len(hull.vertices)) == (0.0, 0.0, 8)


@pytest.mark.usefixtures("few_are_many")
@pytest.mark.filterwarnings("ignore")
def test_points_that_are_not_finite_have_a_hull_without_volume() -> None:
    points = make_points("sphere", 1_000, np.random.default_rng(1))
    points[0] = np.inf
    assert compute_convex_hull(points).volume == 0.0


@pytest.mark.usefixtures("few_are_many")
def test_the_reach_of_a_mesh_is_exact_where_its_hull_is_not() -> None:
    sphere = trimesh.creation.icosphere(subdivisions=5)
    facts = measure_mesh(sphere.export(file_type="stl"), "stl")
    directions = make_points("sphere", 200, np.random.default_rng(1))
    assert facts.hull.excess == MOST_EXCESS
    np.testing.assert_allclose(facts.compute_reach(directions), (facts.vertices @ directions.T).max(axis=0), rtol=1e-12)
    assert ((facts.hull.vertices @ directions.T).max(axis=0) < facts.compute_reach(directions) - 1e-6).any()


@pytest.mark.parametrize("count", [1, 3, 4, 5, 20, 400])
def test_the_least_volume_is_not_above_that_of_the_hull(count: int) -> None:
    random = np.random.default_rng(count)
    for flatness in (1.0, 1e-3, 0.0):
        points = random.normal(size=(count, 3)) * (1.0, 1.0, flatness) + (5.0, 0.0, 1.0)
        least = compute_least_volume(points)
        assert 0.0 <= least <= compute_convex_hull(points).volume + 1e-12
    if count > 5:
        points = random.normal(size=(count, 3))
        assert compute_least_volume(points) > 0.02 * compute_convex_hull(points).volume


def test_the_least_volume_of_a_tetrahedron_is_its_volume() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert compute_least_volume(corners) == pytest.approx(1 / 6, rel=1e-5)
    corners[1] = np.inf
    assert not compute_least_volume(corners) > 0


# -- without scipy -----------------------------------------------------------------------------------------------------


@pytest.fixture
def no_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where urdfcheck-core is installed."""

    def fail() -> None:
        raise ModuleNotFoundError("No module named 'scipy'", name="scipy")

    monkeypatch.setattr(convex_hull, "load_qhull", fail)


@pytest.mark.usefixtures("no_scipy")
@pytest.mark.parametrize(
    "points",
    [
        make_points("noisy sphere", 2_000, np.random.default_rng(1)),
        np.random.default_rng(2).uniform(-1.0, 1.0, (5_000, 3)).round(1),  # many in one plane
        np.stack(np.meshgrid(*[np.arange(9) * 0.01 + 1e3] * 3), axis=-1).reshape(-1, 3),  # far from the origin
        np.random.default_rng(3).normal(size=(500, 3)) * (1.0, 1.0, 1e-4),
        trimesh.creation.cylinder(0.3, 0.05, sections=100).vertices.astype(np.float32).astype(float),
        np.eye(4)[:, :3] * 1e-3,
    ],
    ids=["noisy", "rounded", "far", "thin", "cylinder", "tetrahedron"],
)
def test_another_library_computes_the_same_hull(points: Array) -> None:
    exact, hull = ConvexHull(points), compute_convex_hull(points)
    assert type(convex_hull._load_hulls().ConvexHull(points)) is manifold_hull.ConvexHull
    assert hull.volume == pytest.approx(exact.volume, rel=1e-6)
    assert hull.area == pytest.approx(exact.area, rel=1e-6)
    assert measure_excess(points, hull) < 1e-6
    assert compute_mesh_moments(hull.vertices, hull.faces).volume == pytest.approx(hull.volume)  # faces outwards
    planes = manifold_hull.ConvexHull(points).equations
    assert (points @ planes[:, :3].T + planes[:, 3]).max() < 1e-6 * np.ptp(points)


@pytest.mark.usefixtures("no_scipy", "few_are_many")
def test_another_library_bounds_the_hull_of_many_points() -> None:
    points = make_points("sphere", 3_000, np.random.default_rng(1))
    hull = compute_convex_hull(points)
    assert hull.excess == MOST_EXCESS
    assert measure_excess(points, hull) <= MOST_EXCESS * 1.01


@pytest.mark.usefixtures("no_scipy")
@pytest.mark.parametrize("turned", [False, True])
def test_another_library_finds_points_in_a_plane_too(turned: bool) -> None:
    points = np.random.default_rng(1).normal(size=(200, 3)) * (1.0, 1.0, 0.0)
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0] if turned else np.eye(3)
    hull = compute_convex_hull(points @ turn)
    assert (hull.volume, len(hull.vertices)) == (0.0, 8)


def test_a_hull_that_leaves_a_part_out_is_computed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """As Manifold 3.5 does for one in 400 meshes."""
    import manifold3d

    points = make_points("sphere", 300, np.random.default_rng(1))
    real, calls = manifold3d.Manifold, []

    class Careless:
        @staticmethod
        def hull_points(given: Array) -> object:
            calls.append(given)
            return real.hull_points(given[: len(given) // 2] if len(calls) == 1 else given)

    monkeypatch.setattr(manifold3d, "Manifold", Careless)
    assert manifold_hull.ConvexHull(points).volume == pytest.approx(ConvexHull(points).volume)
    assert len(calls) == 2
    monkeypatch.setattr(Careless, "hull_points", lambda given: real.hull_points(given[: len(given) // 2]))
    with pytest.raises(ArithmeticError):
        manifold_hull.ConvexHull(points)


def test_qhull_is_used_where_there_is_scipy() -> None:
    assert convex_hull._load_hulls() is qhull.load_qhull()
