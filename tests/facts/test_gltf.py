"""glTF: what the default scene places, as trimesh reads it, and refusal of what claims more than there is."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose

from urdfcheck.facts.mesh import decode_limits
from urdfcheck.facts.mesh.decode import RawMesh, decode_mesh
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.formats import gltf

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
Json = dict[str, Any]


def scene(indices: list[int] | None = None, mode: int | None = None, **primitive: object) -> tuple[Json, bytes]:
    """Four corners of a square, with indices of one byte after them."""
    points = np.array(CORNERS, "<f4").tobytes()
    numbers = bytes(indices or ())
    drawn: Json = {"attributes": {"POSITION": 0}, **primitive}
    if mode is not None:
        drawn["mode"] = mode
    if indices is not None:
        drawn["indices"] = 1
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [drawn]}],
        "buffers": [{"byteLength": len(points + numbers)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(numbers)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": len(numbers), "type": "SCALAR"},
        ],
    }
    return document, points + numbers


def glb(document: Json, binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return b"glTF" + struct.pack("<2I", 2, 12 + len(chunks)) + chunks


def read(document: Json, binary: bytes) -> RawMesh:
    return decode_mesh(glb(document, binary), "glb")


def refusal(document: Json, binary: bytes) -> MeshError:
    with pytest.raises(MeshError) as caught:
        read(document, binary)
    return caught.value


@pytest.mark.parametrize(
    ("indices", "mode", "faces"),
    [
        ([0, 1, 2, 0, 2, 3], None, [(0, 1, 2), (0, 2, 3)]),
        ([0, 1, 2, 0, 2, 3], 4, [(0, 1, 2), (0, 2, 3)]),
        ([1, 2, 0, 3], 5, [(1, 2, 0), (2, 3, 0)]),
        ([0, 1, 2, 3], 6, [(1, 2, 0), (2, 3, 0)]),
        (None, 5, [(0, 1, 2), (1, 3, 2)]),
    ],
)
def test_corners_are_triangles_in_turn_a_strip_or_a_fan(
    indices: list[int] | None, mode: int | None, faces: list[tuple[int, int, int]]
) -> None:
    found = read(*scene(indices, mode))
    assert found.faces is not None
    assert found.faces.tolist() == [list(face) for face in faces]
    assert found.vertices.tolist() == [list(corner) for corner in CORNERS]


def test_points_and_lines_are_no_triangles() -> None:
    assert refusal(*scene([0, 1], 1)).reason_id == "no-triangles"


def test_numbers_may_lie_apart_and_be_whole_ones_that_stand_for_fractions() -> None:
    document, _ = scene()
    document["meshes"][0]["primitives"][0]["mode"] = 5
    document["accessors"][0] |= {"componentType": 5122, "normalized": True}
    document["bufferViews"][0] |= {"byteStride": 8, "byteOffset": 4, "byteLength": 32}
    rows = [struct.pack("<4h", *(c * 32767 for c in corner), 99) for corner in CORNERS]
    assert read(document, b"skip" + b"".join(rows)).vertices.tolist() == [list(c) for c in CORNERS]


def test_nodes_are_placed_as_trimesh_places_them() -> None:
    tree = trimesh.Scene()
    turn = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3), (0.1, 0.2, 0.3))
    box = trimesh.creation.box((1, 2, 3))
    tree.add_geometry(box, node_name="a", geom_name="box", transform=turn)
    tree.add_geometry(box, node_name="b", geom_name="box", parent_node_name="a", transform=turn @ np.diag((2, 1, 1, 1)))
    found = decode_mesh(tree.export(file_type="glb"), "glb")
    assert found.n_triangles == 24
    assert_allclose(
        sorted(map(tuple, found.vertices.round(5).tolist())),
        sorted(map(tuple, np.round(tree.to_mesh().vertices, 5).tolist())),
        atol=2e-5,
    )


def test_a_node_may_say_how_it_is_moved_turned_and_scaled() -> None:
    document, binary = scene(None, 5)
    document["nodes"][0] |= {"translation": [1, 2, 3], "rotation": [0, 0, 2**0.5, 2**0.5], "scale": [2, 1, 1]}
    assert_allclose(read(document, binary).vertices[1], (1, 4, 3), atol=1e-12)


CHANGES: dict[str, tuple[Callable[[Json], object], str]] = {
    "count": (lambda d: d["accessors"][0].update(count=10**12, type="VEC3"), "truncated"),
    "count of indices": (lambda d: d["accessors"][1].update(count=10**15), "too-large"),
    "negative count": (lambda d: d["accessors"][0].update(count=-1), "malformed"),
    "fraction": (lambda d: d["accessors"][1].update(count=1e12), "malformed"),
    "offset": (lambda d: d["bufferViews"][0].update(byteOffset=10**18), "truncated"),
    "negative offset": (lambda d: d["accessors"][1].update(byteOffset=-4), "malformed"),
    "no stride": (lambda d: d["bufferViews"][0].update(byteStride=0), "truncated"),
    "length": (lambda d: d["bufferViews"][1].update(byteLength=10**9, byteOffset=0, byteStride=10**8), "truncated"),
    "sparse": (lambda d: d["accessors"][0].update(sparse={"count": 10**12}), "unsupported"),
    "without numbers": (lambda d: d["accessors"][0].pop("bufferView"), "unsupported"),
    "indices that are no indices": (lambda d: d["accessors"][1].update(componentType=5120), "malformed"),
    "its own child": (lambda d: d["nodes"][0].update(children=[0]), "malformed"),
    "two parents": (lambda d: d["scenes"][0].update(nodes=[0, 0]), "malformed"),
    "deep": (
        lambda d: (
            d.update(nodes=[{"mesh": 0}, *({"children": [i]} for i in range(999))]),
            d["scenes"][0].update(nodes=[999]),
        ),
        "malformed",
    ),
    "no scene": (lambda d: d.update(scenes=[]), "no-triangles"),
    "file": (lambda d: d["buffers"][0].update(uri="file:///etc/passwd"), "external-buffer"),
    "list": (lambda d: d.update(meshes=7), "malformed"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_what_claims_more_than_there_is_is_refused_before_room_is_made_for_it(name: str) -> None:
    document, binary = scene([0, 1, 2])
    change, expected = CHANGES[name]
    change(document)
    assert refusal(document, binary).reason_id == expected


def test_a_mesh_may_be_placed_often_but_not_without_end(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (decode_limits, gltf):
        monkeypatch.setattr(module, "MOST_PLACED", 3)
    document, binary = scene([0, 1, 2])
    for times in (3, 4):
        document["nodes"] = [{"mesh": 0}] * times
        document["scenes"][0]["nodes"] = list(range(times))
        if times == 3:
            assert read(document, binary).n_triangles == 3
    error = refusal(document, binary)
    assert (error.reason_id, error.message) == ("too-large", "places its geometry 4 times, more than 3")


def test_triangles_are_counted_as_often_as_they_are_placed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decode_limits, "MOST_TRIANGLES", 2)
    document, binary = scene([0, 1, 2])
    document["nodes"].append({"mesh": 0})
    document["scenes"][0]["nodes"].append(1)
    assert read(document, binary).n_triangles == 2
    document["meshes"][0]["primitives"][0]["mode"] = 5
    document["accessors"][1]["count"] = 5
    assert refusal(document, binary).message == "has 6 triangles, more than 2"


def test_a_fallback_beside_compressed_numbers_is_read_and_images_are_not() -> None:
    document, binary = scene([0, 1, 2], extensions={"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}})
    document |= {
        "extensionsUsed": ["KHR_draco_mesh_compression"],
        "images": [{"uri": "/etc/passwd"}, {"bufferView": 0}],
    }
    assert read(document, binary).n_triangles == 1


def test_a_chunk_that_is_cut_off_is_truncated() -> None:
    data = glb(*scene([0, 1, 2]))
    with pytest.raises(MeshError, match="ends 1 too early"):
        decode_mesh(data[:-1], "glb")
    with pytest.raises(MeshError, match="only glTF 2 is supported"):
        decode_mesh(b"glTF\1" + data[5:], "glb")


def test_the_files_of_buffers_are_listed_as_they_are_written() -> None:
    document, binary = scene()
    document["buffers"] = [{"uri": uri} for uri in ("a%20b.bin", "data:,x", "../c.bin", "a%20b.bin")] + [{}]
    assert gltf.list_buffer_files(json.dumps(document).encode(), "gltf") == ("a%20b.bin", "../c.bin")
    assert gltf.list_buffer_files(glb(document, binary), "glb") == ("a%20b.bin", "../c.bin")


@pytest.mark.parametrize(
    "data", [b"", b"{", b"[]", b'{"buffers": 7}', b'{"buffers": [7]}', b'{"buffers": [{"uri": 7}]}', b"[" * 99999]
)
def test_what_is_no_document_names_no_files(data: bytes) -> None:
    assert gltf.list_buffer_files(data, "gltf") == ()


def test_a_document_may_not_name_any_number_of_files() -> None:
    document, _ = scene()
    document["buffers"] = [{"uri": f"{i}.bin"} for i in range(gltf.MOST_BUFFERS + 1)]
    with pytest.raises(MeshError) as caught:
        gltf.list_buffer_files(json.dumps(document).encode(), "gltf")
    assert caught.value.reason_id == "too-large"
