"""The packed form of a mesh: what comes out is what went in, to half a step of the grid, and small."""

from __future__ import annotations

import base64
import zlib

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.facts.mesh.codec import STEPS, needs_wide_indices, pack_mesh, unpack_mesh

pytestmark = pytest.mark.slow

NO_HOLES = np.zeros((0, 2, 3))


def area(vertices: np.ndarray, faces: np.ndarray) -> float:
    return float(trimesh.Trimesh(vertices, faces, process=False).area)


@given(st.integers(0, 2**32 - 1), st.integers(3, 60), st.floats(1e-6, 1e6))
def test_corners_triangles_and_holes_survive(seed, count, size):
    random = np.random.default_rng(seed)
    vertices = size * random.standard_normal((count, 3))
    faces = np.array([random.permutation(count)[:3] for _ in range(2 * count)])
    holes = vertices[faces[:4, :2]]
    packed = pack_mesh(vertices, faces, holes, max_faces=10**9)
    points, triangles, ends = unpack_mesh(packed)
    used = vertices[np.unique(faces)]
    low, steps = used.min(axis=0), STEPS / np.ptp(used, axis=0)
    # The same triangles, each with the same sense of rotation, in another order.
    assert turned((vertices[faces] - low) * steps) == turned((points[triangles] - low) * steps)
    assert (np.abs(ends - holes) * steps <= 0.51).all()


def turned(triangles: np.ndarray) -> list[list[list[float]]]:
    """Triangles on the grid, each beginning with its lowest corner, in order."""
    corners = np.rint(triangles).tolist()
    return sorted(min(t[i:] + t[:i] for i in range(3)) for t in corners)


def test_a_flat_mesh_has_no_extent_to_divide_by():
    vertices = np.array([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]])
    points, triangles, _ = unpack_mesh(pack_mesh(vertices, np.array([[0, 1, 2]]), NO_HOLES, max_faces=10))
    assert sorted(points.tolist()) == sorted(vertices.tolist())
    assert len(triangles) == 1


def test_more_triangles_at_one_point_than_may_be_drawn_are_none():
    assert pack_mesh(np.ones((3, 3)), np.array([[0, 1, 2]] * 5), NO_HOLES, max_faces=4).n_faces == 0


def test_more_corners_than_two_bytes_can_number():
    ball = trimesh.creation.icosphere(subdivisions=6)
    packed = pack_mesh(ball.vertices, ball.faces, NO_HOLES, max_faces=10**9)
    points, triangles, _ = unpack_mesh(packed)
    assert needs_wide_indices(packed.n_vertices)
    assert area(points, triangles) == pytest.approx(ball.area, rel=1e-4)


def test_too_many_triangles_become_fewer_and_keep_the_shape():
    ball = trimesh.creation.icosphere(subdivisions=5)
    packed = pack_mesh(ball.vertices, ball.faces, NO_HOLES, max_faces=4_000)
    points, triangles, _ = unpack_mesh(packed)
    assert 1_000 < packed.n_faces <= 4_000
    assert area(points, triangles) == pytest.approx(ball.area, rel=0.02)


def test_it_takes_few_bytes_per_triangle():
    part = trimesh.creation.annulus(0.02, 0.03, 0.01, sections=256)
    part = part.subdivide().subdivide()
    packed = pack_mesh(part.vertices, part.faces, NO_HOLES, max_faces=10**9)
    assert len(base64.b64encode(zlib.compress(packed.data, 9))) / packed.n_faces < 6.5
