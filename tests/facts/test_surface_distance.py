"""Distances of surfaces: known ones, the same surface in other triangles, and the stated error."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from urdfcheck.facts.mesh.surface_distance import SurfaceDistance, measure_surface_distance


def measure(one: trimesh.Trimesh, other: trimesh.Trimesh) -> SurfaceDistance:
    found = measure_surface_distance(one.vertices, one.faces, other.vertices, other.faces)
    assert found is not None
    return found


def test_one_surface_in_other_triangles_is_the_same() -> None:
    box = trimesh.creation.box((1.0, 0.5, 0.2))
    found = measure(box, box.subdivide().subdivide())
    assert (found.gone, found.come) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert 0.0 < found.error < 0.02


def test_a_part_that_comes_is_as_far_as_it_stands_out() -> None:
    """A rod of 0.3 m on a plate: nothing of the plate is far from the other surface but what the rod covers."""
    plate = trimesh.creation.box((1.0, 1.0, 0.1))
    rod = trimesh.creation.box((0.05, 0.05, 0.4), transform=trimesh.transformations.translation_matrix((0, 0, 0.15)))
    found = measure(plate, trimesh.util.concatenate([plate, rod]))
    assert found.gone == pytest.approx(0.0, abs=1e-9)
    assert found.come == pytest.approx(0.3, abs=1e-9)


def test_spheres_are_apart_by_the_difference_of_their_radii() -> None:
    small, large = (trimesh.creation.icosphere(subdivisions=4, radius=radius) for radius in (1.0, 1.1))
    found = measure(small, large)
    # Facets cut the corners of a sphere, by less than 0.2 % here.
    assert (found.gone, found.come) == pytest.approx((0.1, 0.1), abs=3e-3)


def test_the_way_back_is_the_other_way_round() -> None:
    one, other = trimesh.creation.cylinder(0.1, 0.4), trimesh.creation.capsule(0.4, 0.1)
    there, back = measure(one, other), measure(other, one)
    assert (there.gone, there.come, there.error) == (back.come, back.gone, back.error)


def test_points_between_samples_are_within_the_stated_error() -> None:
    """What is missed of a dent that no sample meets is less than the error."""
    rng = np.random.default_rng(3)
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    dented = box.subdivide().subdivide().subdivide()
    vertices = dented.vertices.copy()
    vertices[rng.integers(len(vertices))] *= 0.9
    found = measure(box, trimesh.Trimesh(vertices, dented.faces, process=False))
    exact = trimesh.proximity.closest_point(box, vertices)[1].max()
    assert found.come == pytest.approx(exact, abs=1e-9)
    assert found.gone <= exact + found.error


def test_a_surface_without_triangles_is_not_measured() -> None:
    box = trimesh.creation.box()
    assert measure_surface_distance(box.vertices, box.faces[:0], box.vertices, box.faces) is None
