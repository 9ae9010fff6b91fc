"""Rays against shapes: primitives and meshes give the same, and a sensor inside a shape sees out."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from urdfcheck.facts.arrays import Array
from urdfcheck.facts.motion.ray_casting import cross_primitive, make_scan_directions, measure_mesh_entries

AZIMUTHS = np.linspace(-np.pi, np.pi, 181)
ELEVATIONS = np.linspace(-1.5, 1.5, 31)
SHAPES = {
    "box": ((0.4, 0.2, 0.6), trimesh.creation.box((0.4, 0.2, 0.6))),
    "sphere": ((0.3,), trimesh.creation.icosphere(5, 0.3)),
    "cylinder": ((0.2, 0.5), trimesh.creation.cylinder(0.2, 0.5, sections=360)),
    "capsule": ((0.2, 0.5), trimesh.creation.capsule(0.5, 0.2, count=(90, 90))),
}


def measure_primitive_entries(kind: str, size: tuple[float, ...], origin: Array, directions: Array) -> Array:
    low, high = cross_primitive(kind, size, origin, directions)
    entries: Array = np.where((low > 0) & (low < high), low, np.inf)
    return entries


def cast_at_primitive(kind: str, size: tuple[float, ...], place: Array, turn: Array) -> Array:
    directions = make_scan_directions(AZIMUTHS, ELEVATIONS)
    entries = measure_primitive_entries(kind, size, -turn.T @ place, directions.reshape(-1, 3) @ turn)
    return entries.reshape(directions.shape[:2])


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("place", [(0.7, 0.1, -0.2), (-0.9, 0.0, 0.0), (0.0, 0.05, 1.0)])
def test_primitives_and_meshes_are_met_alike(kind: str, place: tuple[float, float, float]) -> None:
    size, mesh = SHAPES[kind]
    turn = trimesh.transformations.euler_matrix(0.3, -0.8, 1.1)[:3, :3]
    vertices = np.asarray(mesh.vertices) @ turn.T + place
    found = measure_mesh_entries(vertices, np.asarray(mesh.faces), AZIMUTHS, ELEVATIONS, 0.0)
    expected = cast_at_primitive(kind, size, np.array(place), turn)
    both = np.isfinite(found) & np.isfinite(expected)
    assert both.sum() > 40
    # Only rays along the rim differ: the mesh is inside the round shape.
    assert (np.isfinite(found) != np.isfinite(expected)).sum() <= 0.05 * both.sum()
    grazing = np.abs(found[both] - expected[both]) > 0.01
    assert grazing.mean() <= 0.05


@pytest.mark.parametrize("kind", SHAPES)
def test_a_sensor_inside_a_shape_sees_out(kind: str) -> None:
    size, mesh = SHAPES[kind]
    assert np.isinf(cast_at_primitive(kind, size, np.array((0.01, 0.02, 0.03)), np.eye(3))).all()
    vertices = np.asarray(mesh.vertices) + np.array((0.01, 0.02, 0.03))
    assert np.isinf(measure_mesh_entries(vertices, np.asarray(mesh.faces), AZIMUTHS, ELEVATIONS, 0.0)).all()


@pytest.mark.parametrize(
    ("kind", "size"),
    [("box", (0.4, 0.4, 1.0)), ("sphere", (0.2,)), ("cylinder", (0.2, 1.0)), ("capsule", (0.2, 0.6))],
)
def test_a_ray_leaves_a_shape_at_its_far_side(kind: str, size: tuple[float, ...]) -> None:
    low, high = cross_primitive(kind, size, np.array((0.05, 0.0, 0.0)), np.array([(1.0, 0, 0), (-1.0, 0, 0)]))
    assert low.tolist() == pytest.approx([-0.25, -0.15])
    assert high.tolist() == pytest.approx([0.15, 0.25])


def test_what_is_nearer_than_the_shortest_range_does_not_count() -> None:
    vertices = np.array([(0.5, -1, -1), (0.5, 1, -1), (0.5, 0, 2)], dtype=float)
    faces = np.array([(0, 2, 1)])
    ahead = measure_mesh_entries(vertices, faces, np.zeros(1), np.zeros(1), 0.0)
    assert ahead.tolist() == [[pytest.approx(0.5)]]
    assert np.isinf(measure_mesh_entries(vertices, faces, np.zeros(1), np.zeros(1), 0.6)).all()
    # From behind it is culled.
    assert np.isinf(measure_mesh_entries(vertices, faces[:, ::-1], np.zeros(1), np.zeros(1), 0.0)).all()


def test_a_box_whose_face_the_sensor_is_on_and_rays_along_its_sides() -> None:
    directions = np.array([(1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)])
    entries = measure_primitive_entries("box", (0.2, 0.2, 0.2), np.array((-0.5, 0.0, 0.0)), directions)
    assert entries[0] == pytest.approx(0.4)
    assert np.isinf(entries[1:]).all()
    upright = measure_primitive_entries("cylinder", (0.1, 0.4), np.array((0.0, 0.0, -1.0)), directions)
    assert upright[2] == pytest.approx(0.8)
    assert np.isinf(upright[:2]).all()
