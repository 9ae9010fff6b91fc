"""Fitted primitives enclose their points and are those that the points were taken from."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.facts.mesh.primitive_fit import FittedPrimitive, fit_primitives
from urdfcheck.facts.motion.kinematics import build_origin_transform

POSE = build_origin_transform((0.3, -0.2, 1.0), (0.4, -0.9, 2.0))


def distance_outside(fit: FittedPrimitive, points: np.ndarray) -> float:
    """How far points are outside a primitive, in m."""
    local = (np.linalg.inv(fit.pose) @ np.c_[points, np.ones(len(points))].T).T[:, :3]
    if fit.kind == "box":
        return float((np.abs(local) - np.array(fit.size) / 2).max())
    if fit.kind == "sphere":
        return float(np.linalg.norm(local, axis=1).max() - fit.size[0])
    radius, length = fit.size
    if fit.kind == "cylinder":
        across = np.linalg.norm(local[:, :2], axis=1)
        return float(max(across.max() - radius, np.abs(local[:, 2]).max() - length / 2))
    ends = np.clip(local[:, 2], -length / 2, length / 2)
    return float(np.linalg.norm(local - np.c_[np.zeros((len(local), 2)), ends], axis=1).max() - radius)


def ring(radius: float, z: float, count: int = 96) -> np.ndarray:
    angles = np.arange(count) * 2 * math.pi / count
    return np.c_[radius * np.cos(angles), radius * np.sin(angles), np.full(count, z)]


def corners(size: tuple[float, float, float]) -> np.ndarray:
    return np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(size) / 2


BALL = np.concatenate([ring(math.cos(a), math.sin(a)) for a in np.linspace(-1.5, 1.5, 41)])
PILL = np.concatenate((0.1 * BALL[len(BALL) // 2 :] + (0, 0, 0.2), 0.1 * BALL[: len(BALL) // 2 + 1] - (0, 0, 0.2)))
SHAPES = {
    "box": (corners((0.1, 0.2, 0.7)), (0.1, 0.2, 0.7)),
    "cylinder": (np.concatenate((ring(0.2, -0.3), ring(0.2, 0.3))), (0.2, 0.6)),
    "sphere": (0.25 * BALL, (0.25,)),
    "capsule": (PILL, (0.1, 0.4)),
}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("pose", [np.eye(4), POSE], ids=["straight", "turned"])
def test_a_primitive_is_found_again(kind: str, pose: np.ndarray) -> None:
    points, size = SHAPES[kind]
    fits = fit_primitives(points @ pose[:3, :3].T + pose[:3, 3])
    best = fits[0]
    assert best.kind == kind
    assert sorted(best.size) == pytest.approx(sorted(size), rel=0.03)
    assert best.pose[:3, 3] == pytest.approx(pose[:3, 3], abs=0.01)
    assert [fit.volume for fit in fits] == sorted(fit.volume for fit in fits)


@given(st.lists(st.tuples(*3 * [st.floats(-1, 1, width=32)]), min_size=4, max_size=20))
def test_every_fit_encloses_its_points(rows: list[tuple[float, float, float]]) -> None:
    points = np.array(rows)
    if (np.ptp(points, axis=0) < 1e-3).any():
        return
    reach = float(np.linalg.norm(np.ptp(points, axis=0)))
    for fit in fit_primitives(points):
        # A centre next to zero is written as zero.
        assert distance_outside(fit, points) <= 4e-4 * reach, fit.kind


@pytest.mark.parametrize("points", [np.zeros((5, 3)), corners((1, 1, 0)), np.array([[0, 0, math.nan]] * 5)])
def test_what_has_no_volume_has_no_fit(points: np.ndarray) -> None:
    with pytest.raises(ValueError, match="no volume"):
        fit_primitives(points)


def test_an_axis_along_x_or_y_is_one_rotation() -> None:
    from urdfcheck.facts.motion.kinematics import matrix_to_rpy

    points = SHAPES["cylinder"][0]
    for order, angles in (((2, 0, 1), (0, math.pi / 2, 0)), ((1, 2, 0), (-math.pi / 2, 0, 0))):
        best = fit_primitives(points[:, order])[0]
        assert best.kind == "cylinder"
        assert matrix_to_rpy(best.pose[:3, :3]) == pytest.approx(angles)
