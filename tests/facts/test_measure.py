"""Mesh files to facts: agreement with closed forms and with trimesh, topology, and the reason for every broken file."""

from __future__ import annotations

import base64
import builtins
import io
import json
import logging
import pickle
import struct
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import collada
import numpy as np
import pytest
import trimesh
from conftest import CORPORA
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from real_robots import select_by_trait

from urdfcheck.facts.inertials.inertia_tensor import (
    combine_solids,
    compute_solid_inertia,
    make_box_solid,
    make_capsule_solid,
    make_cylinder_solid,
    make_sphere_solid,
    transform_solid,
)
from urdfcheck.facts.mesh import assimp, decode_limits
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.formats.obj_materials import parse_material_library
from urdfcheck.facts.mesh.measure import MeshFacts, compute_mesh_solid, measure_mesh, restore_mesh_facts
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

BOX = trimesh.creation.box((1.0, 2.0, 3.0))
HOLLOW = trimesh.creation.annulus(r_min=0.2, r_max=0.5, height=0.3)

TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def binary_stl(vertices: object, faces: object, header: bytes = b"", declared: int | None = None) -> bytes:
    corners = np.asarray(vertices, dtype="<f4")[np.asarray(faces)]
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + corner.tobytes() + b"\0\0" for corner in corners)
    return header.ljust(80, b"\0") + struct.pack("<I", len(corners) if declared is None else declared) + facets


def obj(vertices: object, faces: object) -> bytes:
    """Text with full digits: nothing is lost to float32."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=float).tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in np.asarray(faces).tolist()]
    return "\n".join(lines).encode()


def gltf(mesh: trimesh.Trimesh, uri: str | None = None) -> bytes:
    points, corners = mesh.vertices.astype("<f4").tobytes(), mesh.faces.astype("<u4").tobytes()
    embedded = "data:application/octet-stream;base64," + base64.b64encode(points + corners).decode()
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
        {"buffer": 0, "byteOffset": len(points), "byteLength": len(corners)},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(mesh.vertices), "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": mesh.faces.size, "type": "SCALAR"},
    ]
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"uri": uri or embedded, "byteLength": len(points) + len(corners)}],
            "bufferViews": views,
            "accessors": accessors,
        }
    ).encode()


def glb(document: bytes) -> bytes:
    """A glTF document in a binary file without a buffer of its own."""
    text = document + b" " * (-len(document) % 4)
    return b"glTF" + struct.pack("<4I", 2, 20 + len(text), len(text), 0x4E4F534A) + text


def ply(faces: object) -> bytes:
    """A tetrahedron's corners, and any faces."""
    lines = ["ply", "format ascii 1.0", "element vertex 4", *(f"property float {axis}" for axis in "xyz")]
    lines += [f"element face {len(np.asarray(faces))}", "property list uchar int vertex_indices", "end_header"]
    lines += [f"{x} {y} {z}" for x, y, z in TETRAHEDRON[0]]
    return "\n".join([*lines, *(f"3 {a} {b} {c}" for a, b, c in np.asarray(faces).tolist()), ""]).encode()


def dae(vertices: object, faces: object, asset: str = "", node: str = "", scene: bool = True) -> bytes:
    points = np.asarray(vertices, dtype=float)
    numbers = " ".join(map(repr, points.ravel().tolist()))
    index = " ".join(map(str, np.asarray(faces).ravel().tolist()))
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>{asset}</asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="{points.size}">{numbers}</float_array>
      <technique_common><accessor source="#a" count="{len(points)}" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="{len(np.asarray(faces))}">
      <input semantic="VERTEX" source="#v" offset="0"/><p>{index}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node>{node}<instance_geometry url="#g"/></node></visual_scene>
  </library_visual_scenes>
  {'<scene><instance_visual_scene url="#s"/></scene>' if scene else ""}
</COLLADA>""".encode()


def exported(mesh: trimesh.Trimesh, kind: str) -> bytes:
    if kind == "gltf":
        return gltf(mesh)
    data = mesh.export(file_type=kind)
    return data.encode() if isinstance(data, str) else data


def facts_of(mesh: trimesh.Trimesh) -> MeshFacts:
    return measure_mesh(obj(mesh.vertices, mesh.faces), "obj")


def reason(data: bytes, file_type: str) -> str:
    with pytest.raises(MeshError) as caught:
        measure_mesh(data, file_type)
    assert caught.value.message
    return caught.value.reason_id


# --- agreement -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj", "ply", "off", "glb", "gltf", "dae"])
@pytest.mark.parametrize(
    "mesh",
    [BOX, HOLLOW, trimesh.creation.icosphere(2, 0.3), trimesh.creation.capsule(0.4, 0.1)],
    ids=["box", "annulus", "sphere", "capsule"],
)
def test_every_format_agrees_with_trimesh(mesh: trimesh.Trimesh, kind: str) -> None:
    facts = measure_mesh(exported(mesh, kind), kind.partition("_")[0])
    assert facts.watertight is mesh.is_watertight is True
    assert facts.winding_consistent is mesh.is_winding_consistent is True
    assert facts.closed
    assert not facts.inside_out
    assert not facts.boundaries
    assert facts.n_triangles == len(mesh.faces)
    assert facts.n_vertices == len(mesh.vertices)
    # STL, PLY and glTF store float32.
    assert_allclose(facts.volume, mesh.volume, rtol=1e-5)
    assert_allclose(facts.area, mesh.area, rtol=1e-5)
    assert_allclose(facts.bounds, mesh.bounds, atol=1e-6)
    assert_allclose(facts.com, mesh.center_mass, atol=1e-6)
    solid = compute_mesh_solid(facts, (1, 1, 1), np.eye(3), (0, 0, 0))
    assert_allclose(
        compute_solid_inertia(solid, mesh.volume), mesh.moment_inertia, atol=1e-5 * mesh.moment_inertia.max()
    )


def test_a_box_has_the_moments_of_the_closed_form() -> None:
    facts, solid = facts_of(BOX), make_box_solid((1, 2, 3))
    assert_allclose(facts.volume, solid.volume, rtol=1e-14)
    assert_allclose(facts.covariance, solid.covariance, atol=1e-14)
    assert facts.area == pytest.approx(22.0)
    # Faces of 6, 3 and 2 m² on either side: mean square of x over the shell.
    assert facts.surface_covariance[0, 0] == pytest.approx((2 * 6 * 0.25 + (6 + 4) / 12) / 22)


def test_unequal_bodies_add_up_by_the_parallel_axis_theorem() -> None:
    cube = trimesh.creation.box((0.5, 0.5, 0.5))
    cube.apply_translation((3, -1, 2))
    facts = facts_of(trimesh.util.concatenate([BOX, cube]))
    whole = combine_solids(
        [make_box_solid((1, 2, 3)), transform_solid(make_box_solid((0.5, 0.5, 0.5)), np.eye(3), (3, -1, 2))]
    )
    assert facts.volume == pytest.approx(whole.volume)
    assert_allclose(facts.com, whole.com, atol=1e-14)
    assert_allclose(facts.covariance, whole.covariance, atol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mesh", "solid"),
    [
        (trimesh.creation.cylinder(0.3, 0.8, sections=512), make_cylinder_solid(0.3, 0.8)),
        (trimesh.creation.icosphere(5, 0.3), make_sphere_solid(0.3)),
        (trimesh.creation.capsule(0.8, 0.3, count=(256, 256)), make_capsule_solid(0.3, 0.8)),
    ],
    ids=["cylinder", "sphere", "capsule"],
)
def test_fine_tessellations_approach_the_closed_form(mesh: trimesh.Trimesh, solid: object) -> None:
    facts = facts_of(mesh)
    assert_allclose(facts.volume, solid.volume, rtol=2e-3)  # type: ignore[attr-defined]
    assert_allclose(facts.covariance, solid.covariance, atol=2e-3 * facts.covariance.max())  # type: ignore[attr-defined]


numbers = st.floats(-2, 2)
sizes = st.floats(0.05, 2)


@pytest.mark.slow
@settings(max_examples=40)
@given(
    scale=st.tuples(sizes, sizes, sizes),
    mirror=st.tuples(*[st.sampled_from((-1, 1))] * 3),
    rpy=st.tuples(numbers, numbers, numbers),
    move=st.tuples(numbers, numbers, numbers),
)
def test_scaled_turned_moved_and_mirrored_moments_are_those_of_the_transformed_mesh(
    scale: tuple[float, float, float],
    mirror: tuple[int, int, int],
    rpy: tuple[float, float, float],
    move: tuple[float, float, float],
) -> None:
    vertices, faces = np.add(TETRAHEDRON[0], (0.3, -0.2, 0.5)), np.array(TETRAHEDRON[1])
    factors = np.multiply(scale, mirror)
    solid = compute_mesh_solid(measure_mesh(obj(vertices, faces), "obj"), factors, rpy_to_matrix(rpy), move)
    turned = (vertices * factors) @ rpy_to_matrix(rpy).T + move
    direct = measure_mesh(obj(turned, faces[:, :: int(np.prod(mirror))]), "obj")
    assert solid.volume == pytest.approx(direct.volume, rel=1e-9)
    assert_allclose(solid.com, direct.com, atol=1e-9)
    assert_allclose(solid.covariance, direct.covariance, atol=1e-9)


def test_a_mesh_far_from_the_origin_keeps_its_digits() -> None:
    facts = measure_mesh(obj(BOX.vertices + 1e5, BOX.faces), "obj")
    assert_allclose(facts.covariance, make_box_solid((1, 2, 3)).covariance, atol=1e-9)
    assert_allclose(facts.com, np.full(3, 1e5), rtol=1e-12)


# --- topology --------------------------------------------------------------------------------------------------------


def test_a_missing_side_is_one_hole_with_its_rim() -> None:
    top = (BOX.triangles_center[:, 2] < 1.49).nonzero()[0]
    facts = measure_mesh(obj(BOX.vertices, BOX.faces[top]), "obj")
    assert not facts.watertight
    assert not facts.closed
    assert facts.winding_consistent
    assert facts.open_edges == 4
    (rim,) = facts.boundaries
    assert rim.closed
    assert len(rim.points) == 4
    assert rim.length == pytest.approx(6.0)
    assert_allclose(rim.centre, (0, 0, 1.5), atol=1e-12)


def test_holes_that_touch_in_a_corner_come_out_apart() -> None:
    sphere = trimesh.creation.icosahedron()
    vertex_faces = [face for face in sphere.vertex_faces[0] if face >= 0]
    first = vertex_faces[0]
    apart = next(f for f in vertex_faces if len(set(sphere.faces[f]) & set(sphere.faces[first])) == 1)
    kept = [face for index, face in enumerate(sphere.faces) if index not in (first, apart)]
    facts = measure_mesh(obj(sphere.vertices, kept), "obj")
    assert facts.open_edges == 6
    assert [(b.closed, len(b.points)) for b in facts.boundaries] == [(True, 3), (True, 3)]


def test_an_edge_of_three_faces_is_not_manifold_and_leaves_open_ends() -> None:
    vertices = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
    facts = measure_mesh(obj(vertices, [(0, 1, 2), (0, 1, 3), (0, 1, 4)]), "obj")
    assert facts.non_manifold_edges == 1
    assert facts.open_edges == 6
    assert sum(len(b.points) if b.closed else len(b.points) - 1 for b in facts.boundaries) == 6


def test_two_boxes_that_touch_along_an_edge_enclose_their_volume_without_being_manifold() -> None:
    beside = BOX.copy()
    beside.apply_translation((1, 2, 0))
    facts = facts_of(trimesh.util.concatenate([BOX, beside]))
    assert facts.non_manifold_edges == 1
    assert not facts.watertight
    assert facts.closed
    assert facts.volume == pytest.approx(12.0)


def test_inside_out() -> None:
    facts = measure_mesh(obj(BOX.vertices, BOX.faces[:, ::-1]), "obj")
    assert facts.watertight
    assert facts.winding_consistent
    assert facts.inside_out
    assert facts.volume == pytest.approx(-6.0)
    assert_allclose(facts.covariance, make_box_solid((1, 2, 3)).covariance, atol=1e-14)
    assert compute_mesh_solid(facts, (1, 1, 1), np.eye(3), (0, 0, 0)).volume == pytest.approx(6.0)


def test_one_turned_triangle_breaks_the_winding_only() -> None:
    faces = BOX.faces.copy()
    faces[3] = faces[3, ::-1]
    facts = measure_mesh(obj(BOX.vertices, faces), "obj")
    assert facts.watertight
    assert not facts.winding_consistent
    assert not facts.closed


def test_repeated_and_degenerate_triangles_are_counted_and_do_not_open_the_mesh() -> None:
    faces = [*BOX.faces.tolist(), BOX.faces[0].tolist(), BOX.faces[1, ::-1].tolist(), [2, 2, 5]]
    facts = measure_mesh(obj(BOX.vertices, faces), "obj")
    assert facts.watertight
    assert facts.n_triangles == 15
    assert len(facts.faces) == 12
    assert (facts.duplicate_faces, facts.degenerate_faces) == (2, 1)
    assert facts.volume == pytest.approx(6.0)


def test_a_triangle_on_one_line_counts_as_degenerate_and_keeps_its_edges() -> None:
    vertices = [*TETRAHEDRON[0], (0.5, 0, 0)]
    faces = [(0, 2, 1), (0, 4, 3), (4, 1, 3), (0, 1, 4), (0, 3, 2), (1, 2, 3)]
    facts = measure_mesh(obj(vertices, faces), "obj")
    assert facts.degenerate_faces == 1
    assert facts.watertight


@pytest.mark.parametrize(("noise", "closes"), [(5e-10, True), (3e-7, True), (1e-4, False)])
def test_float_noise_between_equal_corners_is_welded_and_a_gap_is_not(noise: float, closes: bool) -> None:
    corners = BOX.vertices[BOX.faces]
    shifted = corners + noise * np.where(np.arange(len(corners)) % 2, 1.0, -1.0)[:, None, None]
    facts = measure_mesh(obj(shifted.reshape(-1, 3), np.arange(36).reshape(-1, 3)), "obj")
    assert facts.watertight is closes
    assert (facts.weld_distance > 0) is closes
    if closes:
        assert 2 * noise < 4 * facts.weld_distance
        assert facts.n_vertices == 8


@pytest.mark.slow
@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.tuples(sizes, sizes, sizes))
def test_noise_below_the_tolerance_is_welded_wherever_it_falls(seed: int, size: tuple[float, float, float]) -> None:
    box = trimesh.creation.box(size)
    # Any two copies of a corner lie within 5e-6 of the diagonal.
    noise = np.random.default_rng(seed).uniform(-1.4e-6, 1.4e-6, (36, 3)) * np.linalg.norm(size)
    facts = measure_mesh(obj(box.vertices[box.faces].reshape(-1, 3) + noise, np.arange(36).reshape(-1, 3)), "obj")
    assert facts.watertight
    assert facts.n_vertices == 8


def test_noise_is_welded_where_a_hole_stays_open_too() -> None:
    """A crack that only float noise makes is no hole: of the box without its lid the lid's rim alone is open."""
    lidless = BOX.faces[(BOX.vertices[BOX.faces][:, :, 2] < 1.5).any(axis=1)]
    corners = BOX.vertices[lidless] + 1e-7 * np.arange(len(lidless))[:, None, None] % 4e-7
    facts = measure_mesh(obj(corners.reshape(-1, 3), np.arange(3 * len(lidless)).reshape(-1, 3)), "obj")
    assert (facts.open_edges, facts.n_vertices) == (4, 8)
    assert [b.closed for b in facts.boundaries] == [True]


def test_noise_inside_the_surface_is_welded_to_what_hangs_on_it() -> None:
    """A triangle that repeats another but for the last digits of one corner, which no open edge of the box has."""
    flap = [*BOX.vertices[BOX.faces[0]]]
    flap[0] = flap[0] + 1e-11
    facts = measure_mesh(obj([*BOX.vertices, *flap], [*BOX.faces.tolist(), (8, 9, 10)]), "obj")
    assert facts.watertight
    assert (facts.n_vertices, facts.duplicate_faces) == (8, 1)


# A tetrahedron, one of whose edges has a corner in its middle, which only one of its two faces uses.
SEAM = [*TETRAHEDRON[0], (0.5, 0, 0)], [(0, 2, 1), (0, 4, 3), (4, 1, 3), (0, 3, 2), (1, 2, 3)]
# A tetrahedron, on whose edge or in whose corner a face with two sides stands.
FLAG = [*TETRAHEDRON[0], (0.5, -1, -1)], [*TETRAHEDRON[1], (0, 1, 4), (1, 0, 4)]
WEB = [*TETRAHEDRON[0], (0, 0, 2)], [(0, 2, 1), (0, 1, 4), (0, 4, 2), (1, 2, 4), (0, 1, 3), (1, 0, 3)]


def turned(vertices: object, angles: tuple[float, float, float], scale: float) -> NDArray[np.float64]:
    points: NDArray[np.float64] = scale * (np.asarray(vertices, dtype=float) @ rpy_to_matrix(angles).T)
    return points


def test_where_a_face_ends_in_the_middle_of_an_edge_is_no_hole() -> None:
    facts = measure_mesh(obj(*SEAM), "obj")
    assert (facts.open_edges, len(facts.boundaries), facts.holes) == (3, 1, ())
    wide = measure_mesh(obj([*SEAM[0][:4], (0.5, 0, 1e-4)], SEAM[1]), "obj")
    assert len(wide.holes) == 1


@pytest.mark.parametrize("mesh", [FLAG, WEB])
def test_a_fin_with_two_sides_does_not_open_the_body_on_which_it_stands(mesh: Any) -> None:
    facts = measure_mesh(obj(*mesh), "obj")
    assert (facts.open_edges, facts.closed, facts.dropped_duplicates, facts.duplicate_faces) == (0, True, 0, 1)
    body = measure_mesh(obj(mesh[0], mesh[1][:4]), "obj")
    assert facts.volume == pytest.approx(body.volume)


def test_a_sheet_with_two_sides_that_stands_on_nothing_is_open() -> None:
    sheet = [(4, 5, 6), (5, 7, 6)]
    points = [*TETRAHEDRON[0], (5, 0, 0), (6, 0, 0), (5, 1, 0), (6, 1, 0)]
    facts = measure_mesh(obj(points, [*TETRAHEDRON[1], *sheet, *(face[::-1] for face in sheet)]), "obj")
    assert (facts.open_edges, facts.dropped_duplicates) == (4, 2)


def test_of_walls_with_two_sides_one_is_kept_where_a_floor_with_one_side_needs_it() -> None:
    walls = [(0, 1, 3), (0, 3, 2), (1, 2, 3)]
    facts = measure_mesh(obj(TETRAHEDRON[0], [(0, 2, 1), *walls[:2], *(face[::-1] for face in walls[:2])]), "obj")
    assert facts.dropped_duplicates == 2
    assert facts.open_edges == 3  # of the wall that is missing


HOLED = trimesh.creation.icosphere(subdivisions=3)
ONE_MISSING = HOLED.vertices, HOLED.faces[1:]
CAP_MISSING = HOLED.vertices, HOLED.faces[HOLED.triangles_center[:, 2] < 0.9]


@settings(max_examples=25, deadline=None)
@given(
    mesh=st.sampled_from([SEAM, FLAG, WEB, ONE_MISSING, CAP_MISSING]),
    angles=st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    scale=st.sampled_from([1e-3, 0.0254, 1.0, 1000.0]),
)
def test_holes_do_not_depend_on_how_the_mesh_is_turned_nor_on_its_size(
    mesh: Any, angles: tuple[float, float, float], scale: float
) -> None:
    before, after = (measure_mesh(obj(v, mesh[1]), "obj") for v in (mesh[0], turned(mesh[0], angles, scale)))
    assert [len(hole.points) for hole in after.holes] == [len(hole.points) for hole in before.holes]
    assert after.hole_share == pytest.approx(before.hole_share, rel=1e-3, abs=1e-9)
    assert (after.open_edges, after.closed) == (before.open_edges, before.closed)


def test_the_share_of_a_hole_bounds_what_it_changes_of_the_volume() -> None:
    whole = measure_mesh(obj(HOLED.vertices, HOLED.faces), "obj")
    for mesh in (ONE_MISSING, CAP_MISSING):
        facts = measure_mesh(obj(*mesh), "obj")
        assert abs(facts.volume - whole.volume) / whole.volume <= facts.hole_share
    assert measure_mesh(obj(*ONE_MISSING), "obj").hole_share < 0.01 < measure_mesh(obj(*CAP_MISSING), "obj").hole_share


def test_non_finite_corners_are_counted_and_their_triangles_dropped() -> None:
    vertices = [*BOX.vertices.tolist(), (np.nan, 0, 0), (np.inf, 1, 1)]
    facts = measure_mesh(obj(vertices, [*BOX.faces.tolist(), (0, 1, 8), (2, 3, 9)]), "obj")
    assert facts.non_finite_vertices == 2
    assert facts.watertight
    assert np.isfinite(facts.bounds).all()


@pytest.mark.parametrize("number", [1e39, 1e200, 1e308])
def test_what_single_precision_cannot_hold_is_not_finite(number: float) -> None:
    vertices = [*BOX.vertices.tolist(), (number, 0, 0), (0, -number, 0)]
    facts = measure_mesh(obj(vertices, [*BOX.faces.tolist(), (0, 1, 8), (2, 3, 9)]), "obj")
    assert (facts.non_finite_vertices, facts.watertight) == (2, True)
    assert reason(obj(np.multiply(TETRAHEDRON[0], number), [(1, 2, 3)]), "obj") == "no-triangles"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [3e38, 1e-42, 1e-200, 5e-324])
@pytest.mark.parametrize("faces", [TETRAHEDRON[1], TETRAHEDRON[1][1:]], ids=["closed", "open"])
def test_huge_and_tiny_meshes_are_measured_without_a_warning(size: float, faces: list[tuple[int, int, int]]) -> None:
    facts = measure_mesh(obj(np.multiply(TETRAHEDRON[0], size), faces), "obj")
    assert facts.watertight is (len(faces) == 4)
    assert [b.closed for b in facts.boundaries] == [True] * (4 - len(faces))
    assert all(np.isfinite(b.centre).all() for b in facts.boundaries)
    assert np.isfinite(facts.hull.volume)


def test_facts_cannot_be_changed() -> None:
    facts = facts_of(BOX)
    turned = measure_mesh(obj(BOX.vertices, [BOX.faces[0, ::-1], *BOX.faces[1:]]), "obj").flipped_lines
    fan = measure_mesh(obj([(0, 0, 0), (0, 0, 1), *BOX.vertices[5:]], [(0, 1, 2), (0, 1, 3), (0, 1, 4)]), "obj")
    arrays = (facts.vertices, facts.faces, facts.bounds, facts.com, facts.covariance, facts.hull.vertices)
    kept = (facts.components, facts.parts["components"]["sizes"], facts.parts["surface"]["vertices"])
    for array in (*arrays, *kept, turned, fan.non_manifold_lines):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_hull_vertices_are_the_corners_and_of_a_flat_mesh_those_of_its_box() -> None:
    inner = [*BOX.vertices.tolist(), *(0.5 * BOX.vertices).tolist()]
    facts = measure_mesh(obj(inner, [*BOX.faces.tolist(), *(BOX.faces + 8).tolist()]), "obj")
    assert sorted(facts.hull.vertices.tolist()) == sorted(BOX.vertices.tolist())
    flat = measure_mesh(obj([(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 1, 2)]), "obj")
    assert {tuple(p) for p in flat.hull.vertices.tolist()} == {(0, 0, 0), (2, 0, 0), (0, 1, 0), (2, 1, 0)}
    assert flat.volume == 0.0
    assert np.isnan(flat.com).all()


def test_a_surface_that_is_stored_from_both_sides_has_no_volume_at_all() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    vertices = (ball.vertices + 0.3 * np.sin(7.0 * ball.vertices[:, ::-1])).tolist()
    facts = measure_mesh(obj(vertices, [*ball.faces.tolist(), *ball.faces[::-1, ::-1].tolist()]), "obj")
    assert facts.volume == 0.0
    assert np.isnan(facts.com).all()


# --- formats ---------------------------------------------------------------------------------------------------------


def test_a_binary_stl_that_begins_with_solid_is_read_as_binary() -> None:
    facts = measure_mesh(binary_stl(BOX.vertices, BOX.faces, header=b"solid exported by CAD"), "stl")
    assert (facts.format, facts.solid_header, facts.watertight) == ("stl-binary", True, True)
    assert measure_mesh(exported(BOX, "stl_ascii"), "stl").format == "stl-ascii"


def test_obj_polygons_negative_indices_continuations_and_comments() -> None:
    text = b"""# a tetrahedron
v 0 0 0
v 1 0 0 # right
v 0 1 0
v 0 0 1
f -4/1/1 -2//2 -3/3
f 1 2 \\
  4
f 1 4 3
f 2 3 4
"""
    facts = measure_mesh(text, "obj")
    assert facts.watertight
    assert facts.volume == pytest.approx(1 / 6)
    square = measure_mesh(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "obj")
    assert square.area == pytest.approx(1.0)


def test_an_ascii_stl_without_its_last_line_is_complete() -> None:
    text = exported(BOX, "stl_ascii").rpartition(b"endsolid")[0]
    assert measure_mesh(text, "stl").n_triangles == 12


@pytest.mark.parametrize("change", [lambda text: text + b"\0\0", lambda text: text.replace(b"\n", b"\r")])
def test_an_ascii_stl_with_zeros_after_it_or_old_line_ends(change: Callable[[bytes], bytes]) -> None:
    assert measure_mesh(change(exported(BOX, "stl_ascii")), "stl").watertight


@pytest.mark.parametrize("kind", ["obj", "off"])
def test_text_with_a_byte_order_mark_or_old_line_ends(kind: str) -> None:
    text = b"# a box\n" + exported(BOX, "obj") if kind == "obj" else exported(BOX, kind)
    assert measure_mesh(b"\xef\xbb\xbf" + text, kind).watertight
    assert measure_mesh(text.replace(b"\n", b"\r"), kind).watertight


def test_collada_units_are_recorded_and_not_applied() -> None:
    facts = measure_mesh(dae(*TETRAHEDRON, '<unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis>'), "dae")
    assert (facts.unit, facts.up_axis) == (0.0254, "Z_UP")
    assert facts.bounds.tolist() == [[0, 0, 0], [1, 1, 1]]
    assert measure_mesh(dae(*TETRAHEDRON), "dae").unit is None
    assert (facts_of(BOX).unit, facts_of(BOX).up_axis) == (None, None)


@pytest.mark.parametrize("text", ["0", "-1", "1e400", "1e308", "1e-300", "nan", "abc", "0,001", ""])
def test_a_collada_unit_that_nobody_draws_in_is_none(text: str) -> None:
    facts = measure_mesh(dae(*TETRAHEDRON, f'<unit name="inch" meter="{text}"/>'), "dae")
    assert (facts.unit, facts.bad_unit) == (None, text)
    assert measure_mesh(dae(*TETRAHEDRON, '<unit name="inch"/>'), "dae").bad_unit is None


def test_collada_numbers_that_are_nan_are_not_zero() -> None:
    text = dae([*TETRAHEDRON[0], (np.nan, 0, 0)], [*TETRAHEDRON[1], (0, 1, 4)])
    facts = measure_mesh(text, "dae")
    assert (facts.non_finite_vertices, facts.watertight) == (1, True)


def test_a_collada_scene_may_place_its_geometry_often_but_not_without_end() -> None:
    def nested(levels: int) -> bytes:
        nodes = '<node id="k0"><instance_geometry url="#g"/></node>' + "".join(
            f'<node id="k{i + 1}">' + f'<instance_node url="#k{i}"/>' * 10 + "</node>" for i in range(levels)
        )
        text = dae(*TETRAHEDRON).replace(
            b'<instance_geometry url="#g"/>', f'<instance_node url="#k{levels}"/>'.encode()
        )
        place = b"<library_visual_scenes>"
        return text.replace(place, f"<library_nodes>{nodes}</library_nodes>".encode() + place)

    assert measure_mesh(nested(2), "dae").n_triangles == 400
    with pytest.raises(MeshError, match="times, more than 100,000"):
        measure_mesh(nested(12), "dae")


@pytest.mark.parametrize(
    ("encoding", "expected"),
    [
        ("utf-8", "entities"),
        ("utf-16", "entities"),
        ("utf-16-be", "entities"),
        ("latin-1", "entities"),
        ("utf-32", "encoding"),
        ("utf-32-be", "encoding"),
        ("utf-7", "entities"),
        ("cp1252", "entities"),
        ("iso-2022-jp", "entities"),  # without a letter of another alphabet, the same text to all
        ("hz", "entities"),
        ("cp037", "encoding"),
    ],
)
def test_collada_entities_are_found_in_every_encoding_that_is_read(encoding: str, expected: str) -> None:
    head = f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE x [<!ENTITY a "b">]>'
    text = dae(*TETRAHEDRON).decode().replace('<?xml version="1.0"?>', head)
    assert reason(text.encode(encoding), "dae") == expected


def test_a_codec_with_a_state_cannot_hide_a_declaration() -> None:
    declaration = b"<!DOCTYPE x [<!E\x1b(BNTITY a '7'>]>"
    text = dae(*TETRAHEDRON).replace(b"<COLLADA", declaration + b"<COLLADA").replace(b"1.0 0.0 0.0", b"&a; 0.0 0.0")
    assert reason(text.replace(b'"1.0"?>', b'"1.0" encoding="iso-2022-jp"?>'), "dae") == "encoding"
    assert reason(text, "dae") in {"malformed", "entities"}


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1", "cp1252", "ascii"]
)
def test_collada_is_read_in_the_encodings_that_exporters_write(encoding: str) -> None:
    name = "" if encoding == "ascii" else "bätch"
    text = dae(*TETRAHEDRON, asset=f"<contributor><author>{name}</author></contributor>").decode()
    declared = "utf-8" if encoding == "utf-8-sig" else encoding
    text = text.replace('"1.0"?>', f'"1.0" encoding="{declared}"?>')
    assert measure_mesh(text.encode(encoding), "dae").watertight


# --- what other readers make of it -----------------------------------------------------------------------------------

BAD_COLOR = """<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong><diffuse>
<color>0.1 0.2 0.3 1</color></diffuse><specular>
<color>0.0 0.0 0.01.0</color></specular></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries>"""
BOUND = """<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry>"""


def with_bad_color() -> bytes:
    text = dae(*TETRAHEDRON).decode().replace("<library_geometries>", BAD_COLOR)
    return (
        text.replace('<instance_geometry url="#g"/>', BOUND).replace("<triangles ", '<triangles material="s" ').encode()
    )


def measure_file(folder: Path, content: bytes, kind: str = "dae") -> MeshFacts:
    path = folder / f"part.{kind}"
    path.write_bytes(content)
    return measure_mesh(content, kind, path=path)


def test_broken_colours_do_not_cost_the_geometry(tmp_path: Path) -> None:
    content = with_bad_color()
    line = content.decode().splitlines().index(BAD_COLOR.splitlines()[2])
    facts = measure_file(tmp_path, content)
    assert (facts.n_triangles, facts.watertight, facts.assimp) == (4, True, "loads")
    assert facts.flaw is not None
    assert f"line {line + 1}: corrupted color definition ('0.0 0.0 0.01.0')" in facts.flaw
    assert "built-in" not in facts.flaw
    # As the consequence says, pycollada drops what has the material, and trimesh what pycollada drops.
    assert not trimesh.load(io.BytesIO(content), file_type="dae").geometry


def test_a_blank_line_before_the_declaration_does_not_cost_the_geometry(tmp_path: Path) -> None:
    facts = measure_file(tmp_path, b"\n\n" + dae(*TETRAHEDRON))
    assert (facts.n_triangles, facts.assimp) == (4, "loads")
    assert facts.flaw is not None
    assert "line 3: the XML declaration" in facts.flaw
    with pytest.raises(Exception, match="XML Parsing Error"):  # as the consequence says
        trimesh.load(tmp_path / "part.dae")


def test_what_only_assimp_reads_is_measured_as_assimp_reads_it(tmp_path: Path) -> None:
    # An attribute twice: no XML, and nothing to Assimp's parser. The unit is not applied, as by our own reader.
    content = dae(*TETRAHEDRON, asset='<unit meter="0.01"/><up_axis>Y_UP</up_axis>')
    facts = measure_file(tmp_path, content.replace(b"<node>", b'<node id="n" id="n">'))
    own = measure_mesh(content, "dae")
    assert facts.bounds.tolist() == own.bounds.tolist()
    assert facts.volume == pytest.approx(own.volume)
    assert (facts.assimp, facts.flaw) == ("loads", "cannot be read as dae: line 13: duplicate attribute")


def test_several_geometries_that_only_assimp_reads_are_not_measured(tmp_path: Path) -> None:
    """The corners of the second that coal returns are those of the first."""
    second = b'<instance_geometry url="#h"/></node>'
    text = dae(*TETRAHEDRON)
    begin, end = text.index(b"<geometry "), text.index(b"</geometry>") + len(b"</geometry>")
    moved = text[begin:end].replace(b'id="', b'id="h').replace(b'="#', b'="#h').replace(b'id="hg"', b'id="h"')
    text = text[:end] + moved + text[end:].replace(b"</node>", second)
    assert measure_mesh(text, "dae").n_triangles == 8
    with pytest.raises(MeshError, match="duplicate attribute") as caught:
        measure_file(tmp_path, text.replace(b"<node>", b'<node id="n" id="n">'))
    assert caught.value.assimp == "loads"


def test_what_assimp_refuses_too_says_so_once_with_the_line(tmp_path: Path) -> None:
    path = tmp_path / "part.dae"
    path.write_bytes(dae(*TETRAHEDRON)[:-40])
    parts: dict[str, Mapping[str, NDArray[Any]]] = {}
    with pytest.raises(MeshError, match=r"^cannot be read as dae: line 15: unclosed token$") as caught:
        measure_mesh(path.read_bytes(), "dae", parts, path=path)
    assert caught.value.assimp == "refuses"
    with pytest.raises(MeshError) as again:
        restore_mesh_facts(parts)
    assert (str(again.value), again.value.assimp) == (str(caught.value), "refuses")


def test_an_accessor_beyond_its_array_is_read_by_us_and_refused_by_assimp(tmp_path: Path) -> None:
    content = dae(*TETRAHEDRON).replace(b'<accessor source="#a" count="4"', b'<accessor source="#a" count="12"')
    facts = measure_file(tmp_path, content)
    assert (facts.n_triangles, facts.assimp) == (4, "refuses")
    assert facts.flaw == "is inconsistent: the <accessor> in line 6 counts 12 numbers instead of 4 vectors"
    assert measure_mesh(content, "dae").flaw is None  # nobody was asked


# A second geometry, whose transformation cannot be read: alone, the first would pass for the whole.
SECOND_GEOMETRY = '</node><node><scale>{}</scale><instance_geometry url="#g"/></node>'


@pytest.mark.parametrize("scale", ["2 x 2", "2 2 2 x"])
def test_a_geometry_that_is_not_read_is_not_passed_over(scale: str) -> None:
    content = dae(*TETRAHEDRON).replace(b"</node>", SECOND_GEOMETRY.format(scale).encode())
    with pytest.raises(MeshError, match=r"^is only partly readable: line \d+: failed to parse scale") as caught:
        measure_mesh(content, "dae")
    assert caught.value.reason_id == "incomplete"


def test_a_geometry_that_assimp_does_not_read_either_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "part.dae"
    path.write_bytes(dae(*TETRAHEDRON).replace(b"</node>", SECOND_GEOMETRY.format("2 x 2").encode()))
    with pytest.raises(MeshError) as caught:
        measure_mesh(path.read_bytes(), "dae", path=path)
    assert caught.value.assimp == "refuses"


@pytest.mark.parametrize(
    "other",
    [
        '</node><node><instance_geometry url="#curve"/></node>',
        '</node><node><instance_geometry url="#nowhere"/></node>',
    ],
)
def test_what_has_no_triangles_is_not_missed(other: str) -> None:
    curve = b'<geometry id="curve"><spline/></geometry></library_geometries>'
    content = dae(*TETRAHEDRON).replace(b"</node>", other.encode()).replace(b"</library_geometries>", curve)
    facts = measure_mesh(content, "dae")
    assert (facts.n_triangles, facts.flaw) == (4, None)


def test_a_sound_file_is_not_given_to_assimp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("asked")

    monkeypatch.setattr(assimp, "load_by_assimp", refuse)
    assert measure_file(tmp_path, dae(*TETRAHEDRON)).assimp == ""
    assert measure_file(tmp_path, obj(*TETRAHEDRON), "obj").flaw is None
    elsewhere = b"mtllib /dev/zero\nf 1 2 3\n"
    continued = b"mtl\\\nlib /dev/zero\nf 1 2 3\n"  # to Assimp, the same
    for settled, kind in (
        (b"", "stl"),
        (b"<html></html>", "obj"),
        (b"PK\5\6", "dae"),
        (b"{}", "gltf"),
        (elsewhere, "obj"),
        (continued, "obj"),
    ):
        with pytest.raises(MeshError):
            measure_file(tmp_path, settled, kind)


NODES = b"<node><instance_geometry"


@pytest.mark.parametrize(
    "hostile",
    [
        b'<node id="c"><instance_node url="#c"/></node>' + NODES,
        b"<node>" * 20_000 + b"</node>" * 20_000 + NODES,
        b"<node><!--</node>-->" * 20_000 + b"</node>" * 20_000 + NODES,
        b'<node a="</node>">' * 20_000 + b"</node>" * 20_000 + NODES,
    ],
    ids=["circle", "deep", "hidden-in-comments", "hidden-in-values"],
)
@pytest.mark.parametrize("codec", ["utf-8", "utf-16"])
def test_collada_that_ends_the_stack_of_assimp_is_not_given_to_it(
    hostile: bytes, codec: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crash(_path: Path, _file_type: str) -> object:
        raise AssertionError("it is asked")

    monkeypatch.setattr(assimp, "load_by_assimp", crash)
    sound = dae(*TETRAHEDRON)
    assert NODES in sound
    text = sound.replace(NODES, hostile).replace(b"<asset>", b'<asset a="1" a="2">').decode().encode(codec)
    with pytest.raises(MeshError):
        measure_file(tmp_path, text)


def test_entities_are_not_measured_even_if_assimp_loads_the_file(tmp_path: Path) -> None:
    path = tmp_path / "part.dae"
    path.write_bytes(dae(*TETRAHEDRON).replace(b"<COLLADA", b"<!DOCTYPE x [<!ENTITY a '7'>]><COLLADA"))
    with pytest.raises(MeshError, match="DOCTYPE") as caught:
        measure_mesh(path.read_bytes(), "dae", path=path)
    assert (caught.value.reason_id, caught.value.assimp) == ("entities", "loads")


def test_without_coal_nothing_is_said_of_assimp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "coal", None)
    assert measure_file(tmp_path, with_bad_color()).assimp == ""
    with pytest.raises(MeshError) as caught:
        measure_file(tmp_path, dae(*TETRAHEDRON)[:-40])
    assert caught.value.assimp == ""


def test_triangles_are_counted_before_room_is_made_for_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decode_limits, "MOST_TRIANGLES", 4)
    few, many = TETRAHEDRON, (TETRAHEDRON[0], [*TETRAHEDRON[1], (0, 1, 2)])
    for kind, write in WRITERS.items():
        assert measure_mesh(write(*few), kind).n_triangles == 4
        assert reason(write(*many), kind) == "too-large"
    polygon = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + b" 1 2 3" * 2
    assert measure_mesh(polygon, "obj").n_triangles == 4
    assert reason(polygon + b" 1", "obj") == "too-large"


def off(vertices: object, faces: object) -> bytes:
    points, corners = np.asarray(vertices).tolist(), np.asarray(faces).tolist()
    lines = ["OFF", f"{len(points)} {len(corners)} 0", *(f"{x} {y} {z}" for x, y, z in points)]
    return "\n".join([*lines, *(f"3 {a} {b} {c}" for a, b, c in corners)]).encode()


def ascii_stl(vertices: object, faces: object) -> bytes:
    corners = np.asarray(vertices)[np.asarray(faces)].tolist()
    vertex = [" ".join(f"vertex {x} {y} {z}" for x, y, z in facet) for facet in corners]
    facets = "".join(f"facet normal 0 0 0 outer loop {facet} endloop endfacet\n" for facet in vertex)
    return f"solid a\n{facets}endsolid a\n".encode()


WRITERS: dict[str, Callable[[Any, Any], bytes]] = {
    "stl": binary_stl,
    "obj": obj,
    "off": off,
    "ply": lambda _, faces: ply(faces),
    "dae": dae,
}


def test_an_ascii_stl_is_counted_too(monkeypatch: pytest.MonkeyPatch) -> None:
    assert measure_mesh(ascii_stl(*TETRAHEDRON), "stl").n_triangles == 4
    monkeypatch.setattr(decode_limits, "MOST_TRIANGLES", 3)
    assert reason(ascii_stl(*TETRAHEDRON), "stl") == "too-large"


@pytest.mark.parametrize("count", [10**3, 4 * 10**9, 10**18, 10**30])
@pytest.mark.parametrize("element", ["vertex", "face"])
def test_a_ply_file_that_claims_more_than_it_holds_is_truncated(element: str, count: int) -> None:
    claim = ply(TETRAHEDRON[1]).replace(f"element {element} 4".encode(), f"element {element} {count}".encode())
    assert reason(claim, "ply") == "truncated"


def test_a_ply_file_whose_header_does_not_end_is_refused() -> None:
    header = b"ply\nformat ascii 1.0\n" + b"comment no end\n" * 9000
    assert reason(header + ply(TETRAHEDRON[1])[4:], "ply") == "malformed"


def test_collada_nodes_place_their_geometry_and_a_mirroring_one_keeps_the_outside_outside() -> None:
    facts = measure_mesh(dae(*TETRAHEDRON, node="<translate>10 0 0</translate><scale>-2 1 1</scale>"), "dae")
    assert facts.bounds.tolist() == [[8, 0, 0], [10, 1, 1]]
    assert facts.volume == pytest.approx(2 / 6)


def test_no_other_file_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    measure_mesh(dae(*TETRAHEDRON), "dae")  # imports what needs importing
    measure_mesh(gltf(BOX), "gltf")

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a file was opened")

    monkeypatch.setattr(builtins, "open", refuse)
    image = '<library_images><image id="i"><init_from>texture.png</init_from></image></library_images>'
    textured = dae(*TETRAHEDRON).replace(b"<library_geometries>", image.encode() + b"<library_geometries>")
    assert measure_mesh(textured, "dae").watertight
    assert measure_mesh(b"mtllib material.mtl\nusemtl red\n" + obj(*TETRAHEDRON), "obj").watertight
    assert reason(gltf(BOX, "box.bin"), "gltf") == "external-buffer"
    assert reason(glb(gltf(BOX, "box.bin")), "glb") == "external-buffer"


# --- broken files ----------------------------------------------------------------------------------------------------

GOOD_STL = binary_stl(BOX.vertices, BOX.faces)
NOISE = np.random.default_rng(0).bytes(9_000)
OUTSIDE = trimesh.Trimesh(TETRAHEDRON[0], [(0, 1, 9)], process=False, validate=False)
DRACO = json.dumps({**json.loads(gltf(BOX)), "extensionsRequired": ["KHR_draco_mesh_compression"]}).encode()
LFS = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32\nsize 12345\n"


@pytest.mark.parametrize(
    ("data", "file_type", "expected"),
    [
        pytest.param(b"", "stl", "empty", id="empty"),
        pytest.param(LFS, "dae", "lfs-pointer", id="lfs pointer"),
        pytest.param(b"\n<!DOCTYPE html><html></html>", "stl", "html", id="web page"),
        pytest.param(GOOD_STL, "step", "unsupported", id="unknown format"),
        pytest.param(b"\x07", "stl", "truncated", id="one byte"),
        pytest.param(b"This is no mesh.\n", "stl", "text", id="text"),
        pytest.param(b"A page that is longer than a header is.\n" * 9, "stl", "text", id="long text"),
        pytest.param(GOOD_STL[:-1], "stl", "truncated", id="one byte short"),
        pytest.param(GOOD_STL + b"\n", "stl", "wrong-size", id="one byte too many"),
        pytest.param(GOOD_STL[:500] + GOOD_STL[501:], "stl", "line-ends", id="one byte missing inside"),
        pytest.param(
            GOOD_STL[:130] + b"\r\n" + GOOD_STL[135:], "stl", "shifted", id="three bytes missing inside, CR LF left"
        ),
        pytest.param(GOOD_STL[:84] + bytes(range(150, 250)), "stl", "wrong-size", id="short, of no triangles"),
        pytest.param(b"\0" * 84 + GOOD_STL[84:], "stl", "no-count", id="no count"),
        pytest.param(b"\0" * 84 + NOISE, "stl", "random", id="encrypted"),
        pytest.param(binary_stl(BOX.vertices, BOX.faces, declared=3), "stl", "wrong-size", id="declares fewer"),
        pytest.param(binary_stl(BOX.vertices, BOX.faces, declared=2**32 - 1), "stl", "truncated", id="declares 4e9"),
        pytest.param(binary_stl(BOX.vertices, BOX.faces, b"solid", 3), "stl", "wrong-size", id="solid, declares fewer"),
        pytest.param(b"\0" * 84, "stl", "no-facets", id="STL of none"),
        pytest.param(b"solid nothing\nendsolid\n", "stl", "no-facets", id="ASCII STL of none"),
        pytest.param(exported(BOX, "stl_ascii")[:-100], "stl", "truncated", id="ASCII STL cut"),
        pytest.param(
            exported(BOX, "stl_ascii").rpartition(b"facet")[0] + b"fac", "stl", "truncated", id="cut in a word"
        ),
        pytest.param(exported(BOX, "stl_ascii").replace(b"0.5", b"0,5"), "stl", "malformed", id="decimal comma"),
        pytest.param(binary_stl([(np.nan, 0, 0)] * 3, [(0, 1, 2)]), "stl", "no-triangles", id="all NaN"),
        pytest.param(binary_stl([(1, 0, 0)] * 3, [(0, 1, 2)]), "stl", "no-triangles", id="one point"),
        pytest.param(dae(*TETRAHEDRON), "stl", "malformed", id="COLLADA named stl"),
        pytest.param(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "obj", "malformed", id="OBJ index outside"),
        pytest.param(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "obj", "malformed", id="OBJ index zero"),
        pytest.param(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2", "obj", "malformed", id="OBJ face short"),
        pytest.param(b"v 0 0\nf 1 1 1\n", "obj", "malformed", id="OBJ vertex short"),
        pytest.param(GOOD_STL, "obj", "malformed", id="STL named obj"),
        pytest.param(b"v 0 0 0\n", "obj", "no-triangles", id="OBJ without faces"),
        pytest.param(exported(BOX, "off")[:-20], "off", "truncated", id="OFF cut"),
        pytest.param(b"OFF\n", "off", "malformed", id="OFF header only"),
        pytest.param(exported(BOX, "off").rstrip() + b"\n3 0 1 2\n", "off", "malformed", id="OFF face too many"),
        pytest.param(b"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0\n", "off", "malformed", id="OFF face of none"),
        pytest.param(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "off", "malformed", id="OFF face of minus 3"),
        pytest.param(ply([(0, 1, 9)]), "ply", "malformed", id="PLY index outside"),
        pytest.param(ply([(0, 1, -1)]), "ply", "malformed", id="PLY index negative"),
        pytest.param(gltf(OUTSIDE), "gltf", "malformed", id="glTF index outside"),
        pytest.param(glb(gltf(OUTSIDE)), "glb", "malformed", id="GLB index outside"),
        pytest.param(glb(DRACO), "glb", "unsupported", id="GLB compressed"),
        pytest.param(DRACO, "gltf", "unsupported", id="glTF compressed"),
        pytest.param(exported(BOX, "ply")[:-20], "ply", "truncated", id="binary PLY cut"),
        pytest.param(BOX.export(file_type="ply", encoding="ascii")[:-40], "ply", "truncated", id="ASCII PLY cut"),
        pytest.param(exported(BOX, "glb")[:-20], "glb", "truncated", id="GLB cut"),
        pytest.param(dae(*TETRAHEDRON)[:-40], "dae", "malformed", id="DAE cut"),
        pytest.param(b"<COLLADA/>", "dae", "no-triangles", id="DAE of nothing"),
        pytest.param(dae(*TETRAHEDRON, scene=False), "dae", "no-triangles", id="DAE without scene"),
        pytest.param(dae(TETRAHEDRON[0], [(0, 1, 9)]), "dae", "malformed", id="DAE index outside"),
        pytest.param(dae(TETRAHEDRON[0], [(0, 1, -1)]), "dae", "malformed", id="DAE index negative"),
        pytest.param(
            dae(*TETRAHEDRON).replace(b'<triangles count="4"', b'<triangles count="40"'),
            "dae",
            "truncated",
            id="DAE declares 40",
        ),
        pytest.param(
            dae(*TETRAHEDRON).replace(b"<COLLADA", b'<!DOCTYPE x [<!ENTITY a "b">]><COLLADA'),
            "dae",
            "entities",
            id="DAE with entities",
        ),
    ],
)
def test_a_broken_file_says_why(data: bytes, file_type: str, expected: str) -> None:
    assert reason(data, file_type) == expected


def test_a_truncated_stl_says_what_is_declared_and_what_is_there() -> None:
    with pytest.raises(MeshError, match=r"declares 12 triangles \(684 bytes\) but has 11 \(683 bytes\)"):
        measure_mesh(GOOD_STL[:-1], "stl")


@pytest.mark.slow
@settings(max_examples=60)
@given(cut=st.integers(0, len(GOOD_STL) - 1))
def test_no_part_of_a_binary_stl_passes_for_a_mesh(cut: int) -> None:
    assert reason(GOOD_STL[:cut], "stl") == ("truncated" if cut else "empty")


@settings(max_examples=150)
@given(data=st.binary(max_size=300), file_type=st.sampled_from(["stl", "obj", "dae", "ply", "off", "glb", "gltf"]))
def test_garbage_is_refused_and_never_crashes(data: bytes, file_type: str) -> None:
    with pytest.raises(MeshError):
        measure_mesh(data, file_type)


@pytest.mark.parametrize("kind", [ImportError, MemoryError])
def test_what_is_missing_here_is_not_held_against_the_file(
    kind: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise kind

    monkeypatch.setattr(collada, "Collada", fail)
    parts: dict[str, Mapping[str, NDArray[Any]]] = {}
    with pytest.raises(kind):
        measure_mesh(dae(*TETRAHEDRON), "dae", parts)
    assert not parts


def test_what_libraries_log_about_a_file_is_not_shown(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    logger, reader = logging.getLogger("collada"), collada.Collada
    before = logger.propagate, list(logger.handlers)

    def read_noisily(*arguments: Any, **options: Any) -> Any:
        logger.error("a traceback")
        return reader(*arguments, **options)

    monkeypatch.setattr(collada, "Collada", read_noisily)
    measure_mesh(dae(*TETRAHEDRON), "dae")
    assert not caplog.records
    assert (logger.propagate, logger.handlers) == before


def test_a_mesh_error_crosses_processes() -> None:
    error = pickle.loads(pickle.dumps(MeshError("truncated", "is truncated")))
    assert (error.reason_id, str(error)) == ("truncated", "is truncated")


@pytest.mark.skipif(not CORPORA, reason="needs URDFCHECK_CORPUS, a folder of robots")
def test_meshes_of_real_robots_are_at_least_as_watertight_as_trimesh_finds_them() -> None:
    """The smallest of each repository, format and magnitude; all with ``URDFCHECK_FULL=1``. trimesh merges corners as it
    does by default; in test_oracle_meshes it tries finer roundings."""
    files = [
        (path.stat().st_size, path, path.relative_to(folder).parts[0])
        for folder in CORPORA
        for path in folder.rglob("*")
        if path.suffix.lower() in {".stl", ".obj"}
    ]
    assert files
    for _, path, _ in select_by_trait(
        sorted(files), lambda file: [(len(str(file[0])), file[1].suffix.lower(), file[2])]
    ):
        facts = measure_mesh(path.read_bytes(), path.suffix.lower()[1:])
        mesh = trimesh.load_mesh(path, skip_materials=True)
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        mesh.update_faces(mesh.unique_faces() & mesh.nondegenerate_faces(height=0.0))
        assert facts.watertight or not mesh.is_watertight, path
        if facts.watertight and mesh.is_watertight and mesh.is_winding_consistent:
            assert facts.volume == pytest.approx(mesh.volume, rel=1e-5), path


# -- colours -------------------------------------------------------------------------------------------------------------

RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)


def test_faces_of_a_collada_file_have_the_colours_of_their_materials():
    """Two boxes that touch along an edge: the corners that they share are merged, and each face keeps its material."""
    boxes = [trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1))]
    boxes[1].apply_translation((0, 1, 1))
    for box, color in zip(boxes, (RED, BLUE), strict=True):
        material = trimesh.visual.material.PBRMaterial(baseColorFactor=np.array(color) * 255)
        box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=material)
    facts = measure_mesh(trimesh.exchange.dae.export_collada(boxes), "dae")
    assert facts.colors is not None
    of_face, rgba = facts.colors
    assert facts.n_vertices == 14
    upper = facts.vertices[facts.faces][:, :, 1:].sum(axis=2).mean(axis=1) > 1.0
    assert_allclose(rgba[of_face], np.where(upper[:, None], BLUE, RED))


def test_formats_without_colours_have_none():
    assert measure_mesh(BOX.export(file_type="stl"), "stl").colors is None
    assert measure_mesh(BOX.export(file_type="obj", include_color=False).encode(), "obj").materials is None


def with_material(mesh: trimesh.Trimesh, **changes: object) -> bytes:
    """The mesh as glTF whose only material has these entries."""
    document = json.loads(gltf(mesh))
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.0, 1.0, 0.25]}, **changes}]
    for own in document["meshes"]:
        for primitive in own["primitives"]:
            primitive["material"] = 0
    return json.dumps(document).encode()


@pytest.mark.parametrize(
    ("changes", "color"),
    [
        ({}, (0.735357, 0.0, 1.0, 1.0)),
        ({"alphaMode": "BLEND"}, (0.735357, 0.0, 1.0, 0.25)),
        ({"pbrMetallicRoughness": {}}, (1.0, 1.0, 1.0, 1.0)),
        ({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, None),
        ({"pbrMetallicRoughness": {}, "extensions": {"KHR_materials_pbrSpecularGlossiness": {}}}, None),
        ({"pbrMetallicRoughness": {"baseColorFactor": [2, 0, 0, 1]}}, None),
        ({"pbrMetallicRoughness": {"baseColorFactor": [10**400, 0, 0, 1]}}, None),
        ({"pbrMetallicRoughness": {"baseColorFactor": "red"}}, None),
        ({"pbrMetallicRoughness": 7}, None),
    ],
    ids=str,
)
def test_the_base_colour_of_gltf_is_that_of_its_faces(changes, color):
    facts = measure_mesh(with_material(BOX, **changes), "gltf")
    assert facts.n_triangles == len(BOX.faces)
    if color is None:
        assert facts.colors is None
    else:
        of_face, rgba = facts.colors
        assert_allclose(rgba[of_face], [color] * len(facts.faces), atol=1e-6)


def obj_of(*boxes: tuple[str, trimesh.Trimesh], head: str = "mtllib a b.mtl\n") -> bytes:
    lines, count = [head], 0
    for material, box in boxes:
        lines += [f"v {x} {y} {z}\n" for x, y, z in box.vertices]
        lines.append(f"usemtl {material}\n" if material else "")
        lines += [f"f {a} {b} {c}\n" for a, b, c in box.faces + 1 + count]
        count += len(box.vertices)
    return "".join(lines).encode()


def test_faces_of_obj_have_the_names_of_their_materials():
    lower, upper = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1))
    upper.apply_translation((0, 1, 1))
    parts: dict = {}
    measure_mesh(obj_of(("", lower), ("dark  blue", upper)), "obj", parts)
    facts = restore_mesh_facts(parts)
    materials = facts.materials
    assert (materials.names, materials.libraries) == (("dark blue",), ("a b.mtl",))
    is_upper = facts.vertices[facts.faces][:, :, 1:].sum(axis=2).mean(axis=1) > 1.0
    assert_allclose(materials.of_face, np.where(is_upper, 0, -1))
    assert facts.colors is None
    assert measure_mesh(obj_of(("blue", lower)), "obj").materials.of_face.tolist() == [0] * 12


def test_the_materials_of_obj_change_no_measurement():
    plain, colored = (
        measure_mesh(obj_of((name, BOX), head=head), "obj") for name, head in (("", ""), ("m", "mtllib m\n"))
    )
    assert plain.parts["summary"]["text"].tobytes() == colored.parts["summary"]["text"].tobytes()
    assert plain.materials is None
    # Without a library the names say nothing.
    assert measure_mesh(obj_of(("m", BOX), head=""), "obj").materials is None


def test_a_material_library_gives_colours_to_names():
    library = """# comment
newmtl navy blue
Kd 0 0.03 0.35 # beside it
d 1.0
newmtl glass
Kd 0.5
Tr 0.75
newmtl veil
Kd 1 0 0
d -halo 0.5
newmtl hidden
Kd 0 1 0
d 0
newmtl image
Kd 1 1 1
map_Kd a.png
newmtl spectrum
Kd spectral a.rfl 1
newmtl bright
Kd 2 0 0
newmtl bare
newmtl glass
Kd 0 0 0
Kd
d
"""
    assert parse_material_library(library) == {
        "navy blue": (0.0, 0.03, 0.35, 1.0),
        "glass": (0.5, 0.5, 0.5, 0.25),
        "veil": (1.0, 0.0, 0.0, 0.5),
        "hidden": (0.0, 1.0, 0.0, 1.0),  # a part that is not drawn could not be looked at
        "image": None,
        "spectrum": None,
        "bright": None,
        "bare": None,
    }
