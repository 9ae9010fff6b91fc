"""Which points are inside a triangulated surface."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from urdfcheck.facts.mesh import winding
from urdfcheck.facts.mesh.winding import are_inside, compute_winding_numbers, has_body_against

POINTS = np.array([[0.0, 0.0, 0.0], [0.9, 0.9, 0.9], [0.4, 0.4, 0.4], [0.51, 0.0, 0.0], [-3.0, 0.0, 0.0]])
BOX = trimesh.creation.box((1.0, 1.0, 1.0)).triangles


def test_a_closed_surface_winds_once_around_what_is_inside() -> None:
    assert compute_winding_numbers(BOX, POINTS) == pytest.approx([1, 0, 1, 0, 0], abs=1e-9)
    assert compute_winding_numbers(BOX[:, ::-1], POINTS) == pytest.approx([-1, 0, -1, 0, 0], abs=1e-9)
    assert len(compute_winding_numbers(BOX, POINTS[:0])) == 0


@pytest.mark.parametrize(
    "surface", [BOX, BOX[:, ::-1], np.delete(trimesh.creation.icosphere(3, 0.7).triangles, 7, axis=0)]
)
def test_neither_the_facing_nor_a_small_hole_matters(surface: np.ndarray) -> None:
    assert are_inside(surface, POINTS).tolist() == [True, False, True, surface is not BOX and len(surface) > 12, False]


def test_batches_of_points_are_joined_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = compute_winding_numbers(BOX, POINTS)
    monkeypatch.setattr(winding, "_MOST_PAIRS", 2 * len(BOX))
    assert compute_winding_numbers(BOX, POINTS) == pytest.approx(whole)


@pytest.mark.parametrize(
    ("extents", "place", "against"),
    [
        ((0.3, 0.3, 0.1), (0.4, 0.0, 0.0), True),  # a collar, of which some faces are inside the beam
        ((0.3, 0.1, 0.1), (0.3, 0.0, 0.0), False),
        ((0.3, 0.1, 0.1), (0.35, 0.0, 0.0), False),  # a hollow that reaches the surface
        ((0.3, 0.1, 0.1), (3.0, 0.0, 0.0), True),
    ],
)
def test_only_what_is_inside_is_a_hollow(
    extents: tuple[float, float, float], place: tuple[float, float, float], against: bool
) -> None:
    beam = trimesh.creation.box((1.0, 0.2, 0.2))
    other = trimesh.creation.box(extents, transform=trimesh.transformations.translation_matrix(place))
    other.invert()
    triangles = np.concatenate((beam.triangles, other.triangles))
    assert has_body_against(triangles, np.repeat((0, 1), 12), beam.volume) == against
    assert has_body_against(triangles[:, ::-1], np.repeat((0, 1), 12), -beam.volume) == against
