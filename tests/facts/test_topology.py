"""Grouping by hashing gives what grouping by comparing gives, whatever the hashes do."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from urdfcheck.facts.mesh import topology
from urdfcheck.facts.mesh.topology import (
    classify_edges,
    count_component_faces,
    find_repeated_faces,
    label_bodies,
    label_components,
    weld_exact,
)

pytestmark = pytest.mark.slow

# Few different numbers, so that corners and faces do coincide; -0 equals 0.
coordinates = st.sampled_from((0.0, -0.0, 1.0, -1.0, 0.5, 1e-30, 3.0))
corners = st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=3, max_size=60)
triangles = st.lists(st.lists(st.integers(0, 6), min_size=3, max_size=3, unique=True), min_size=1, max_size=40)


@pytest.fixture(params=["as it is", "every hash is equal", "no table is tried"])
def _hashes(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param == "every hash is equal":
        monkeypatch.setattr(topology, "_MIX", (np.uint64(0),) * 3)
    if request.param == "no table is tried":
        monkeypatch.setattr(topology, "_ROUNDS", 0)


@pytest.mark.usefixtures("_hashes")
class TestGrouping:
    @pytest.mark.parametrize("dtype", [np.float32, np.float64])
    def test_corners_are_merged_where_they_are_equal(self, dtype: type) -> None:
        @given(corners)
        def holds(points: list[tuple[float, float, float]]) -> None:
            points = points[: len(points) // 3 * 3]
            array = np.array(points, dtype=dtype)
            proper = [t for t in array.reshape(-1, 3, 3) + 0 if len({tuple(c) for c in t}) == 3]
            surface = weld_exact(array, None)
            assert surface.collapsed == len(points) // 3 - len(proper)
            assert len({tuple(v) for v in surface.vertices.tolist()}) == len(surface.vertices)
            np.testing.assert_array_equal(surface.vertices[surface.faces], np.array(proper).reshape(-1, 3, 3))

        holds()

    def test_edges_are_counted(self) -> None:
        @given(triangles)
        def holds(faces: list[list[int]]) -> None:
            edges = classify_edges(np.array(faces), 7)
            directed = [(f[i], f[(i + 1) % 3]) for f in faces for i in range(3)]
            count = Counter(frozenset(e) for e in directed)
            once = [e for e in directed if count[frozenset(e)] == 1]
            assert sorted(map(tuple, edges.open.tolist())) == sorted(once)
            assert {frozenset(e) for e in edges.non_manifold.tolist()} == {e for e, n in count.items() if n > 2}
            pairs = {e for e, n in count.items() if n == 2}
            flipped = {e for e in pairs if sum(d == tuple(sorted(e)) for d in directed) != 1}
            assert {frozenset(e) for e in edges.flipped.tolist()} == flipped
            assert edges.watertight == (set(count.values()) == {2})
            assert edges.winding_consistent == (not flipped)
            assert edges.closed == (Counter(directed) == Counter((b, a) for a, b in directed))
            is_manifold = edges.watertight and edges.winding_consistent
            assert edges.distinct_faces == (is_manifold and len({frozenset(f) for f in faces}) == len(faces))

        holds()

    def test_repeated_faces_are_found_either_way_round(self) -> None:
        @given(triangles)
        def holds(faces: list[list[int]]) -> None:
            sets = [frozenset(f) for f in faces]
            assert find_repeated_faces(np.array(faces)).tolist() == [s in sets[:i] for i, s in enumerate(sets)]

        holds()


def test_pieces_are_counted_by_their_faces() -> None:
    faces = np.array([(0, 1, 2), (2, 3, 4), (5, 6, 7), (8, 9, 10), (9, 10, 11), (10, 11, 12)])
    assert count_component_faces(faces, 13).tolist() == [3, 2, 1]


@given(st.lists(st.tuples(*[st.integers(0, 59)] * 3), min_size=1, max_size=40))
def test_pieces_are_those_of_the_graph_of_their_edges(faces: list[tuple[int, int, int]]) -> None:
    array = np.array(faces, dtype=np.int32)
    graph = coo_array((np.ones(2 * len(faces)), (array[:, :2].T.ravel(), array[:, 1:].T.ravel())), shape=(60, 60))
    labels = connected_components(graph, directed=False)[1][array[:, 0]]
    assert label_components(array, 60).tolist() == np.unique(labels, return_inverse=True)[1].tolist()
    assert count_component_faces(array, 60).tolist() == sorted(Counter(labels.tolist()).values(), reverse=True)


def test_bodies_that_touch_in_one_corner_are_two() -> None:
    one = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    both = np.concatenate((one, one + 3))
    assert label_components(both, 7).tolist() == [0] * 8
    assert label_bodies(both, 7).tolist() == [0] * 4 + [1] * 4


def test_bodies_that_touch_along_an_edge_are_two_and_two_sides_of_one_sheet_are_repeated() -> None:
    one, other = (
        np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]),
        np.array([(0, 1, 4), (0, 5, 1), (0, 4, 5), (1, 5, 4)]),
    )
    assert label_bodies(np.concatenate((one, other)), 6).tolist() == [0] * 4 + [1] * 4
    pillow = classify_edges(np.array([(0, 1, 2), (2, 1, 0)]), 3)
    assert pillow.closed
    assert not pillow.distinct_faces
    assert classify_edges(one, 4).distinct_faces


@pytest.mark.parametrize("more", [0, 1])
def test_a_surface_is_closed_whatever_its_corners_are_numbered(more: int) -> None:
    """The last corner has the greatest number for which a half edge has room, or one more."""
    last = 2**21 - 1 + more
    faces = np.array([(0, 1, 2), (0, last, 1), (1, last, 2), (2, last, 0)])
    edges = classify_edges(faces, last + 1)
    assert (edges.closed, edges.watertight, edges.winding_consistent) == (True, True, True)
    assert [len(kind) for kind in (edges.open, edges.non_manifold, edges.flipped)] == [0, 0, 0]
    assert not classify_edges(faces[1:], last + 1).closed
    assert not classify_edges(faces[[0, 1, 2, 0]], last + 1).closed
