"""Depths against boxes and spheres, rejections against coal alone, swept spheres against the points in them."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from urdfcheck.facts.motion.collision import Colliders, Separation, list_all_pairs
from urdfcheck.facts.motion.collision_geometry import (
    ROUNDING,
    CollisionGeometry,
    PlacedGeometry,
    detect_box_overlap,
    find_piercing_edges,
    is_convex,
)
from urdfcheck.facts.motion.kinematics import build_origin_transform, compute_joint_motions
from urdfcheck.facts.motion.swept_spheres import compute_least_distance, compute_swept_spheres
from urdfcheck.facts.sphere_directions import spread_directions_and_axes

pytest.importorskip("coal")

Array = NDArray[np.float64]
# Corners and outward triangles of the cube from -1/2 to 1/2.
CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)


def box(*size: float) -> CollisionGeometry:
    return CollisionGeometry(kind="box", size=size)


def mesh(*size: float, closed: bool = True) -> CollisionGeometry:
    """A box of triangles: convex, or a surface where it is not said to be closed."""
    return CollisionGeometry(kind="mesh", vertices=CORNERS * size, faces=FACES, closed=closed)


def at(*xyz: float, rpy: tuple[float, float, float] = (0, 0, 0)) -> Array:
    return build_origin_transform(xyz, rpy)


def separation(one: CollisionGeometry, other: CollisionGeometry, shift: Array, scale: float = 1.0) -> Separation | None:
    colliders = Colliders([PlacedGeometry(one, 0, np.eye(4)), PlacedGeometry(other, 1, np.eye(4))])
    return colliders.find_deepest_overlap(np.stack((np.eye(4), shift)), 0, 1)


def disc(sides: int) -> CollisionGeometry:
    """A disc of radius 0.05 m and 0.02 m thick, whose lids are fans about their middle."""
    angles, one = np.arange(sides) * 2 * math.pi / sides, np.arange(sides)
    rim = 0.05 * np.column_stack((np.cos(angles), np.sin(angles)))
    lids = [np.column_stack((np.vstack((rim, (0, 0))), np.full(sides + 1, z))) for z in (-0.01, 0.01)]
    two, top = (one + 1) % sides, sides + 1
    faces = [
        *((two, one, np.full(sides, sides)), (one + top, two + top, np.full(sides, sides + top))),
        *((one, two, two + top), (one, two + top, one + top)),
    ]
    return CollisionGeometry(
        kind="mesh", vertices=np.vstack(lids), faces=np.vstack([np.column_stack(f) for f in faces]), closed=True
    )


CUBES = {"box": box(0.1, 0.1, 0.1), "convex": mesh(0.1, 0.1, 0.1), "surface": mesh(0.1, 0.1, 0.1, closed=False)}
PAIRS = list(product(CUBES, repeat=2))


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
@pytest.mark.parametrize("depth", [0.001, 0.02])
def test_the_depth_of_two_cubes_is_what_they_overlap_by(kinds: tuple[str, str], depth: float) -> None:
    found = separation(CUBES[kinds[0]], CUBES[kinds[1]], at(0.01, 0.02, 0.1 - depth))
    assert found is not None
    # Without "surface" it is exact; a way out is searched to 2 %, along directions of which the axes are some.
    assert found.depth == pytest.approx(depth, rel=0.03 if "surface" in kinds else 1e-3)
    assert found.normal == pytest.approx((0, 0, 1), abs=1e-3)
    assert found.point[2] == pytest.approx(0.05, abs=0.02)


@pytest.mark.parametrize("sides", [254, 255, 300])
def test_a_disc_of_many_sides_collides(sides: int) -> None:
    found = separation(disc(sides), disc(sides), at(0.09, 0, 0))
    assert found is not None
    assert found.depth == pytest.approx(0.01, rel=0.03)
    assert separation(disc(sides), disc(sides), at(0.11, 0, 0)) is None


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_faces_in_one_plane_touch_and_do_not_overlap(kinds: tuple[str, str]) -> None:
    one, other = CUBES[kinds[0]], CUBES[kinds[1]]
    found = separation(one, other, at(0.01, 0.02, 0.1, rpy=(0, 0, 0.3)))
    assert found is None or found.depth == 0.0
    assert separation(one, other, at(0.01, 0.02, 0.1 + ROUNDING, rpy=(0, 0, 0.3))) is None


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_moving_by_the_depth_along_the_normal_frees(kinds: tuple[str, str]) -> None:
    shift = at(0.06, 0.03, 0.05, rpy=(0.4, -0.7, 1.1))
    found = separation(CUBES[kinds[0]], CUBES[kinds[1]], shift)
    assert found is not None
    assert 0.02 < found.depth < 0.08
    shift[:3, 3] += found.normal * found.depth * 1.001
    assert separation(CUBES[kinds[0]], CUBES[kinds[1]], shift) is None


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_size_does_not_decide(scale: float) -> None:
    for gap, expected in ((-0.001, True), (0.0, False)):
        cubes = [CollisionGeometry(kind="mesh", vertices=CORNERS * 0.1 * scale, faces=FACES) for _ in range(2)]
        found = separation(cubes[0], cubes[1], at(0, 0, (0.1 + gap) * scale))
        assert (found is not None and found.depth > 0.0) == expected


def test_what_else_a_robot_has_does_not_decide() -> None:
    """Two jaws of 4 mm meet in as many triangles beside a base of 4 m: coal's tolerances are absolute."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.002)
    jaw = CollisionGeometry(kind="mesh", vertices=np.array(ball.vertices), faces=np.array(ball.faces), closed=False)
    jaws = [PlacedGeometry(jaw, owner, np.eye(4)) for owner in (0, 1)]
    base = PlacedGeometry(mesh(4, 4, 4, closed=False), 2, np.eye(4))
    frames = np.stack((np.eye(4), at(2e-5, 0, 0), at(10, 0, 0)))
    alone, beside = (Colliders(placed).count_contacts(frames, 0, 1, 5000) for placed in (jaws, [*jaws, base]))
    assert 0 < alone < 5000
    assert beside == alone


def test_a_surface_in_a_surface_is_not_met_and_a_solid_in_a_solid_is() -> None:
    assert separation(mesh(1, 1, 1, closed=False), mesh(0.1, 0.1, 0.1, closed=False), at(0, 0, 0)) is None
    found = separation(mesh(1, 1, 1), mesh(0.1, 0.1, 0.1), at(0, 0, 0.3))
    assert found is not None
    assert found.depth == pytest.approx(0.25, rel=1e-3)


def test_a_peg_in_a_hole_comes_out_along_the_hole() -> None:
    """A U of three plates, 0.1 deep along y, holds a peg 1 mm thicker than the gap: no way but along y or z is short."""
    plates = [(0.02, 0.1, 0.2), (0.02, 0.1, 0.2), (0.14, 0.1, 0.02)]
    places = [(-0.06, 0, 0), (0.06, 0, 0), (0, 0, -0.11)]
    corners = np.concatenate([CORNERS * size + place for size, place in zip(plates, places, strict=True)])
    fork = CollisionGeometry(kind="mesh", vertices=corners, faces=np.concatenate([FACES + 8 * i for i in range(3)]))
    found = separation(fork, mesh(0.101, 0.3, 0.1, closed=False), at(0, 0, 0.1))
    assert found is not None
    assert found.depth == pytest.approx(0.05, rel=0.1)
    assert found.normal[2] == pytest.approx(1, abs=0.1)


SHAPES = (
    box(0.2, 0.1, 0.05),
    CollisionGeometry(kind="sphere", size=(0.08,)),
    CollisionGeometry(kind="cylinder", size=(0.05, 0.2)),
    CollisionGeometry(kind="capsule", size=(0.04, 0.15)),
    mesh(0.1, 0.2, 0.1),
    mesh(0.1, 0.2, 0.1, closed=False),
)


def test_what_spheres_and_boxes_reject_coal_rejects() -> None:
    """All pairs of shapes, two on each body, at random places: the same answers as coal asked for every pair of shapes."""
    rng = np.random.default_rng(1)
    placed = [
        PlacedGeometry(s, i // 2, at(*rng.normal(size=3) * 0.1, rpy=tuple(rng.normal(size=3))))
        for i, s in enumerate(SHAPES)
    ]
    frames = np.array(
        [[at(*rng.normal(size=3) * 0.1, rpy=tuple(rng.normal(size=3))) for _ in range(3)] for _ in range(60)]
    )
    colliders = Colliders(placed)
    pairs = list_all_pairs(3)
    found = colliders.detect_collisions(frames, pairs)
    expected = np.array([[brute_force(placed, frame, int(a), int(b)) for frame in frames] for a, b in pairs])
    assert (found == expected).all()
    assert 0.2 < expected.mean() < 0.8


def brute_force(placed: list[PlacedGeometry], frame: Array, one: int, other: int) -> bool:
    import coal

    def made(geometry: CollisionGeometry) -> object:
        if geometry.vertices is None or geometry.faces is None:
            return {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule}[
                geometry.kind
            ](*geometry.size)
        if geometry.closed:
            points = coal.StdVec_Vec3s()
            points.extend(list(geometry.vertices))
            return coal.Convex.convexHull(points, False, "")
        tree = coal.BVHModelOBBRSS()
        tree.beginModel(len(geometry.faces), len(geometry.vertices))
        tree.addVertices(geometry.vertices)
        tree.addTriangles(geometry.faces)
        tree.endModel()
        return tree

    for a, b in product(placed, repeat=2):
        if (a.owner, b.owner) == (one, other):
            places = [frame[p.owner] @ p.pose for p in (a, b)]
            transforms = [coal.Transform3s(p[:3, :3], p[:3, 3]) for p in places]
            result = coal.CollisionResult()
            request = coal.CollisionRequest()
            if coal.collide(made(a.geometry), transforms[0], made(b.geometry), transforms[1], request, result):
                return True
    return False


@pytest.mark.parametrize("large", [box(1, 1, 1), mesh(1, 1, 1)])
def test_a_small_shape_deep_in_a_large_one_meets_it(large: CollisionGeometry) -> None:
    """Axes in line: coal 3.0.3 misses some of these cubes unless it is asked for contacts."""
    colliders = Colliders([PlacedGeometry(large, 0, np.eye(4)), PlacedGeometry(box(0.02, 0.02, 0.02), 1, np.eye(4))])
    places = list(product(np.linspace(-0.4, 0.4, 17), repeat=3))
    frames = np.tile(np.eye(4), (len(places), 2, 1, 1))
    frames[:, 1, :3, 3] = places
    assert colliders.detect_collisions(frames, list_all_pairs(2)).all()


@pytest.mark.parametrize("flat", [(1, 1, 0), (1, 0, 0), (0, 0, 0)])
def test_a_sheet_has_no_inside(flat: tuple[int, int, int]) -> None:
    found = separation(mesh(*flat), CollisionGeometry(kind="sphere", size=(0.1,)), at(0, 0, 0.05))
    assert found is not None
    assert found.depth <= 0.1
    assert np.isfinite([*found.normal, *found.point]).all()


def test_boxes_that_overlap_are_never_rejected() -> None:
    rng = np.random.default_rng(2)
    turns = np.array([[at(0, 0, 0, rpy=tuple(rng.normal(size=3)))[:3, :3] for _ in range(2)] for _ in range(300)])
    half = rng.uniform(0.1, 1, size=(300, 2, 3))
    apart = rng.normal(size=(300, 3))
    inside = rng.uniform(-1, 1, size=(300, 400, 3))
    points = apart[:, None] + (inside * half[:, None, 1]) @ np.swapaxes(turns[:, 1], 1, 2)
    shared = (np.abs(points @ turns[:, 0]) <= half[:, None, 0]).all(axis=2).any(axis=1)
    found = detect_box_overlap(
        turn_a=turns[:, 0], half_a=half[:, 0], turn_b=turns[:, 1], half_b=half[:, 1], centre_offsets=apart
    )
    assert found[shared].all()
    assert 0.1 < shared.mean() < found.mean() < 0.9


def test_a_cube_is_convex_either_way_round_and_a_dented_one_is_not() -> None:
    dented = CORNERS.copy()
    dented[7] *= 0.6
    assert is_convex(CORNERS, FACES)
    assert is_convex(CORNERS, FACES[:, ::-1])
    assert not is_convex(dented, FACES)
    two = np.concatenate((CORNERS, CORNERS + 3))
    assert not is_convex(two, np.concatenate((FACES, FACES + 8)))


@pytest.mark.parametrize("rotates", [True, False])
@pytest.mark.parametrize("limits", [(-0.3, 0.9), (-2.0, 2.5), (0.4, 0.4), (-math.pi, math.pi)])
def test_a_swept_sphere_contains_the_sphere_wherever_the_joint_is(rotates: bool, limits: tuple[float, float]) -> None:
    rng = np.random.default_rng(3)
    axis = np.array((1.0, 2.0, -1.0)) / math.sqrt(6)
    centres, radii = rng.normal(size=(20, 3)), rng.uniform(0.1, 1, size=20)
    around, reach = compute_swept_spheres(centres, radii, axis, lower=limits[0], upper=limits[1], rotates=rotates)
    for moved in compute_joint_motions(axis, np.linspace(*limits, 30), rotates=rotates):
        there = centres @ moved[:3, :3].T + moved[:3, 3]
        assert (np.linalg.norm(there - around, axis=1) + radii <= reach + 1e-12).all()


def test_no_direction_is_more_than_23_degrees_from_one_of_those_tried() -> None:
    rng = np.random.default_rng(4)
    wanted = rng.normal(size=(2000, 3))
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    nearest = (wanted @ spread_directions_and_axes(40).T).max(axis=1)
    assert nearest.min() > math.cos(math.radians(23))


@pytest.mark.parametrize("rotates", [True, False])
@pytest.mark.parametrize("limits", [(-0.3, 0.9), (-2.0, 4.5), (0.4, 0.4), (-math.pi, math.pi), (3.0, 3.5)])
def test_no_place_of_a_joint_brings_points_nearer_than_the_least_distance(
    rotates: bool, limits: tuple[float, float]
) -> None:
    rng = np.random.default_rng(5)
    axis = np.array((1.0, 2.0, -1.0)) / math.sqrt(6)
    moving, staying = rng.normal(size=(2, 50, 3))
    found = compute_least_distance(moving, staying, axis, lower=limits[0], upper=limits[1], rotates=rotates)
    moved = compute_joint_motions(axis, np.linspace(*limits, 2000), rotates=rotates)
    there = np.einsum("qij,nj->qni", moved[:, :3, :3], moving) + moved[:, None, :3, 3]
    assert found == pytest.approx(np.linalg.norm(there - staying, axis=2).min(axis=0), abs=2e-3)


def test_triangles_that_pierce_each_other_still_do_after_any_shift_within_the_margin() -> None:
    rng = np.random.default_rng(6)
    one, other = rng.normal(size=(2, 400, 3, 3))
    shifts = rng.normal(size=(30, 400, 1, 3))
    shifts /= np.linalg.norm(shifts, axis=3, keepdims=True)
    held = find_piercing_edges(one, other, 0.1)
    crossing = find_piercing_edges(one, other, 0.0)
    assert 0 < held.sum() < crossing.sum() < 400
    assert all(find_piercing_edges(one + 0.1 * shift, other, 0.0)[held].all() for shift in shifts)


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
@pytest.mark.parametrize("height", [0.0, 1e-3])
def test_whether_shapes_overlap_is_told_without_the_depth(kinds: tuple[str, str], height: float) -> None:
    colliders = Colliders(
        [PlacedGeometry(CUBES[kinds[0]], 0, np.eye(4)), PlacedGeometry(CUBES[kinds[1]], 1, np.eye(4))]
    )
    frames = np.stack((np.eye(4), at(0.01, 0.02, 0.1 - height, rpy=(0, 0, 0.3))))
    measured, told = (colliders.find_deepest_overlap(frames, 0, 1, with_depth=m) for m in (True, False))
    assert (told is not None and told.depth > 0) == (measured is not None and measured.depth > 0) == (height > 0)


def test_pairs_each_in_its_own_configuration_are_those_of_all_configurations() -> None:
    rng = np.random.default_rng(7)
    colliders = Colliders([PlacedGeometry(shape, i, np.eye(4)) for i, shape in enumerate(SHAPES)])
    pairs = list_all_pairs(len(SHAPES))
    turned = [[at(*rng.normal(size=3) * 0.05, rpy=tuple(rng.normal(size=3))) for _ in SHAPES] for _ in pairs]
    frames = np.array(turned)
    found = colliders.detect_collisions_per_pair(frames, pairs)
    assert (found == np.diagonal(colliders.detect_collisions(frames, pairs))).all()
    assert 0 < found.sum() < len(pairs)
