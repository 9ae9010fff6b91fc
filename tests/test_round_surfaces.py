"""Cylinders are found in meshes, with the lines that they are round about."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from urdfcheck.facts.likeness.round_surfaces import RoundStrips, find_round_strips, join_strips

X, Z = np.eye(3)[0], np.eye(3)[2]


def make_cylinder(radius: float, *, sections: int = 24, at: tuple[float, float, float] = (0, 0, 0)) -> RoundStrips:
    mesh = trimesh.creation.cylinder(radius=radius, height=0.05, sections=sections)
    return find_round_strips(np.asarray(mesh.vertices) + at, np.asarray(mesh.faces))


@pytest.mark.parametrize("sections", [8, 12, 24, 100])
def test_cylinder_is_one_full_ring(sections: int) -> None:
    (ring,) = make_cylinder(0.03, sections=sections).list_rings_about(np.zeros(3), Z)
    # The facets touch the circle at their middles.
    assert ring.radius == pytest.approx(0.03 * np.cos(np.pi / sections), rel=1e-3)
    assert ring.coverage == 1.0


def test_ring_is_about_its_own_line_only() -> None:
    strips = make_cylinder(0.03, at=(0.01, 0.0, 0.2))
    assert not strips.list_rings_about(np.zeros(3), Z)
    assert not strips.list_rings_about(np.array((0.01, 0.0, 0.2)), X)
    assert strips.list_rings_about(np.array((0.01, 0.0, 0.0)), Z)


def test_parallel_line_is_found_where_it_is() -> None:
    strips = make_cylinder(0.03, at=(0.01, -0.02, 0.2))
    (line,) = strips.list_parallel_lines(np.zeros(3), Z, 0.05)
    assert line.point == pytest.approx((0.01, -0.02, 0.0), abs=1e-5)
    assert not strips.list_parallel_lines(np.zeros(3), Z, 0.02)


def test_lines_through_a_point_have_their_directions() -> None:
    pose = trimesh.transformations.rotation_matrix(0.3, X)
    strips = join_strips([make_cylinder(0.03).place(pose), make_cylinder(0.01, at=(0.1, 0, 0))])
    (line,) = strips.list_lines_through(np.zeros(3))
    assert abs(line.direction @ pose[:3, 2]) == pytest.approx(1.0, abs=1e-6)
    assert [ring.radius for ring in line.rings] == [pytest.approx(0.03, rel=0.01)]


@pytest.mark.parametrize("mesh", [trimesh.creation.box((0.1, 0.2, 0.3)), trimesh.creation.icosphere(2, radius=0.05)])
def test_boxes_and_spheres_have_no_bearing(mesh: trimesh.Trimesh) -> None:
    strips = find_round_strips(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    assert not strips.list_rings_about(np.zeros(3), Z)
    assert not strips.list_parallel_lines(np.zeros(3), Z, 0.05)


def test_mesh_without_shared_edges_has_no_strips() -> None:
    strips = find_round_strips(np.eye(3), np.array([[0, 1, 2]]))
    assert len(strips.radii) == 0
    assert strips.list_lines_through(np.zeros(3)) == ()
