"""PLY files of every kind against trimesh, and broken ones."""

from __future__ import annotations

import io
import struct
import tracemalloc
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from urdfcheck.facts.mesh.decode import RawMesh, decode_mesh
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.formats import ply
from urdfcheck.facts.mesh.measure import measure_mesh

CODES = {
    "char": "b",
    "uchar": "B",
    "short": "h",
    "ushort": "H",
    "int": "i",
    "uint": "I",
    "float": "f",
    "double": "d",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "float64": "d",
}
POINTS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.25), (0.0, 1.0, 0.0), (0.5, 0.5, 2.0)]
EXTRA = ("uchar", "float", "short")


@dataclass(frozen=True, kw_only=True)
class File:
    """What a generated file looks like."""

    form: str = "ascii"
    real: str = "float"
    length: str = "uchar"
    index: str = "int"
    name: str = "vertex_indices"
    polygons: tuple[tuple[int, ...], ...] = ((0, 1, 2), (0, 2, 3))
    before_points: tuple[str, ...] = ()
    after_points: tuple[str, ...] = ()
    before_list: tuple[str, ...] = ()
    after_list: tuple[str, ...] = ()
    second_list: bool = False
    rows_before: int = 0
    rows_after: int = 0
    newline: bytes = b"\n"
    notes: tuple[bytes, ...] = ()

    @property
    def rows(self) -> list[tuple[list[str], list[list[tuple[str, float]]]]]:
        """The lines of the header of each element, and its rows as types and numbers."""
        kinds = [*self.before_points, *[self.real] * 3, *self.after_points]
        names = [*(f"b{i}" for i in range(len(self.before_points))), *"xyz"]
        names += [f"a{i}" for i in range(len(self.after_points))]
        vertices = []
        for point in POINTS:
            values = [*(7.0 for _ in self.before_points), *point, *(9.0 for _ in self.after_points)]
            vertices.append(list(zip(kinds, values, strict=True)))
        lines = [f"property {kind} {name}" for kind, name in zip(kinds, names, strict=True)]
        faces = [
            [
                *((kind, 5.0) for kind in self.before_list),
                (self.length, float(len(polygon))),
                *((self.index, float(corner)) for corner in polygon),
                *([("uchar", 2.0), ("float", 0.5), ("float", 0.25)] if self.second_list else []),
                *((kind, 6.0) for kind in self.after_list),
            ]
            for polygon in self.polygons
        ]
        of_faces = [f"property {kind} f{i}" for i, kind in enumerate(self.before_list)]
        of_faces += [f"property list {self.length} {self.index} {self.name}"]
        of_faces += ["property list uchar float weights"] if self.second_list else []
        of_faces += [f"property {kind} g{i}" for i, kind in enumerate(self.after_list)]
        other = ["property int id", "property double weight"]
        before, after = (
            [[("int", 3.0), ("double", 0.125)] for _ in range(count)] for count in (self.rows_before, self.rows_after)
        )
        return [
            *([([f"element camera {len(before)}", *other], before)] if before else []),
            ([f"element vertex {len(vertices)}", *lines], vertices),
            ([f"element face {len(faces)}", *of_faces], faces),
            *([([f"element material {len(after)}", *other], after)] if after else []),
        ]

    def write(self) -> bytes:
        header = [b"ply", f"format {self.form} 1.0".encode(), *self.notes]
        header += [line.encode() for lines, _ in self.rows for line in lines]
        data = self.newline.join([*header, b"end_header", b""])
        every = [row for _, rows in self.rows for row in rows]
        if self.form == "ascii":
            text = [" ".join(repr(v) if CODES[kind] in "fd" else str(int(v)) for kind, v in row) for row in every]
            return data + self.newline.join([*(line.encode() for line in text), b""])
        order = "<" if "little" in self.form else ">"
        numbers = [(CODES[kind], v) for row in every for kind, v in row]
        return data + b"".join(struct.pack(order + code, v if code in "fd" else int(v)) for code, v in numbers)


def read(data: bytes) -> RawMesh:
    return decode_mesh(data, "ply")


def find_triangles(vertices: Any, faces: Any) -> list[Any]:
    """The triangles in an order, and from a corner, that do not depend on the reader."""
    corners = np.asarray(vertices, dtype=np.float64)[np.asarray(faces, dtype=np.int64)].tolist()
    return sorted(min(t[i:] + t[:i] for i in range(3)) for t in corners)


def expect_triangles(file: File) -> list[Any]:
    fans = [(p[0], p[i], p[i + 1]) for p in file.polygons for i in range(1, len(p) - 1)]
    return find_triangles(POINTS, fans)


polygons = st.lists(st.lists(st.integers(0, 4), min_size=0, max_size=5).map(tuple), min_size=1, max_size=6).map(tuple)
extras = st.lists(st.sampled_from(EXTRA), max_size=2).map(tuple)
FILES = st.builds(
    File,
    form=st.sampled_from(["ascii", "binary_little_endian", "binary_big_endian"]),
    real=st.sampled_from(["float", "double", "float64"]),
    length=st.sampled_from(["char", "uchar", "uint8", "short", "ushort", "int", "uint", "int32", "uint32"]),
    index=st.sampled_from(["uchar", "short", "int", "uint", "int32", "uint16"]),
    name=st.sampled_from(["vertex_indices", "vertex_index"]),
    polygons=polygons,
    before_points=extras,
    after_points=extras,
    before_list=extras,
    after_list=extras,
    second_list=st.booleans(),
    rows_before=st.integers(0, 2),
    rows_after=st.integers(0, 2),
    newline=st.sampled_from([b"\n", b"\r\n"]),
    notes=st.lists(
        st.sampled_from([b"comment end_header follows", b"obj_info scanned", b"comment TextureFile a.png"]), max_size=2
    ).map(tuple),
)


@settings(max_examples=200)
@given(file=FILES, block=st.sampled_from([1, 16, 1 << 16]))
def test_every_kind_of_file_gives_its_triangles(file: File, block: int) -> None:
    expected = expect_triangles(file)
    assume(expected)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ply, "_BLOCK", block)
        mesh = read(file.write())
    assert find_triangles(mesh.vertices, mesh.faces) == expected


@settings(max_examples=100)
@given(file=FILES, count=st.integers(3, 4))
def test_files_that_trimesh_reads_are_read_alike(file: File, count: int) -> None:
    """In binary files it reads lists of one length only, and in texts one list beside numbers."""
    alike = tuple((*range(count - 1), 4) for _ in file.polygons)
    data = replace(file, polygons=alike, second_list=False, notes=(b"comment one",)).write()
    known = trimesh.load_mesh(io.BytesIO(data), file_type="ply", process=False)
    mesh = read(data)
    assert find_triangles(mesh.vertices, mesh.faces) == find_triangles(known.vertices, known.faces)


@settings(max_examples=200)
@given(file=FILES, place=st.floats(0, 1), new=st.binary(max_size=4))
def test_a_damaged_file_is_read_or_refused(file: File, place: float, new: bytes) -> None:
    data = file.write()
    at = int(place * len(data))
    for damaged in (data[:at], data[:at] + new + data[at + len(new) :], data[:at] + new + data[at:]):
        with suppress(MeshError):
            vertices, faces = ply.read_ply(damaged)
            assert vertices.shape[1] == faces.shape[1] == 3


def refusal(data: bytes) -> tuple[str, str]:
    with pytest.raises(MeshError) as caught:
        read(data)
    return caught.value.reason_id, caught.value.message


LITTLE = File(form="binary_little_endian", length="int")


@pytest.mark.parametrize("file", [LITTLE, replace(LITTLE, polygons=((0, 1, 2), (0, 2, 3, 4)))])
def test_no_part_of_a_binary_file_passes_for_the_whole(file: File) -> None:
    data = file.write()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    for cut in range(start, len(data)):
        assert refusal(data[:cut])[0] == "truncated"
    assert refusal(data + b"\x01") == ("wrong-size", "has 1 more bytes than its header declares")
    assert read(data + b"\n").n_triangles == read(data).n_triangles


@pytest.mark.parametrize(
    ("old", "new", "reason", "message"),
    [
        ("ply\n", "plx\n", "malformed", "does not begin like a ply file"),
        ("format ascii 1.0\n", "", "malformed", "its header does not name a format"),
        ("format ascii", "format ebcdic", "malformed", "line 2 is 'format ebcdic 1.0'"),
        ("property float x", "property quad x", "malformed", "line 4 is 'property quad x'"),
        ("element vertex 5\n", "", "malformed", "line 3 is 'property float x'"),
        ("element face 2", "element face -2", "malformed", "line 7 is 'element face -2'"),
        ("element face 2", "element vertex 2", "malformed", "line 7 is 'element vertex 2'"),
        ("element face 2", "element face 3", "truncated", "5 vertices and 3 faces, 8 lines, and has 7"),
        ("element face 2", f"element face {10**30}", "truncated", "bytes of them"),
        ("end_header\n", "", "malformed", "its header does not end"),
        ("float y", "float x", "malformed", "line 5 repeats a property"),
        ("float y", "float v", "malformed", "its vertices have no y"),
        ("list uchar int", "int", "malformed", "its faces have no list of their vertices"),
        ("list uchar int", "list uchar float", "malformed", "its faces have no list of their vertices"),
        ("1.0 1.0 0.25", "1.0 one 0.25", "malformed", "line 12 is '1.0 one 0.25'"),
        ("1.0 1.0 0.25", "1.0 1.0", "malformed", "line 12 is '1.0 1.0'"),
        ("3 0 2 3", "4 0 2 3", "malformed", "line 16 is '4 0 2 3'"),
        ("3 0 1 2", "4 0 1 2", "malformed", "line 15 is '4 0 1 2'"),
        ("3 0 2 3", "-3 0 2 3", "malformed", "line 16 is '-3 0 2 3'"),
        ("3 0 2 3", f"{10**15} 0 2 3", "malformed", f"line 16 is '{10**15} 0 2 3'"),
        ("3 0 2 3", "3 0 2 x", "malformed", "line 16 is '3 0 2 x'"),
        ("3 0 2 3", f"3 0 2 {2**32 + 3}", "malformed", "has 1 faces that refer to a missing vertex"),
        ("3 0 1 2\n3 0 2 3", "2 0 1\n0", "no-triangles", "has no triangles"),
    ],
)
def test_a_broken_text_says_where(old: str, new: str, reason: str, message: str) -> None:
    data = File().write().decode()
    assert old in data
    found = refusal(data.replace(old, new, 1).encode())
    assert found[0] == reason
    assert message in found[1]


def test_what_a_list_lacks_in_a_binary_file_is_counted() -> None:
    three = struct.pack("<i", 3)
    head, _, last = LITTLE.write().rpartition(three + struct.pack("<3i", 0, 2, 3))
    assert last == b""
    for length in (4, -1, 2**31 - 1):
        reason, message = refusal(head + struct.pack("<4i", length, 0, 2, 3))
        assert (reason, message) == ("truncated", "is truncated: it declares 2 faces but has 1")


def test_triangle_strips_are_named() -> None:
    header = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    strips = b"element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    assert refusal(header + strips)[0] == "unsupported"


def test_a_header_may_end_its_lines_as_old_computers_did() -> None:
    data = replace(LITTLE, newline=b"\r").write()
    assert read(data).n_triangles == 2


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_memory_is_a_small_multiple_of_the_file(encoding: str) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=6)
    data = mesh.export(file_type="ply", encoding=encoding)
    read(data)
    tracemalloc.start()
    decoded = read(data)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert decoded.n_triangles == len(mesh.faces)
    assert peak < 6 * len(data)


@pytest.mark.parametrize("holes", [False, True])
@pytest.mark.parametrize("kind", ["ply", "glb"])
def test_to_measure_a_mesh_takes_a_small_multiple_of_its_file(kind: str, holes: bool) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=6)
    if holes:
        mesh.update_faces(np.arange(len(mesh.faces)) % 1000 != 0)
    data = mesh.export(file_type=kind)
    measure_mesh(data, kind)
    tracemalloc.start()
    facts = measure_mesh(data, kind)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert facts.watertight is not holes
    assert peak < 5.5 * len(data)


def test_a_small_file_that_claims_much_takes_little_memory() -> None:
    claim = (
        LITTLE.write().replace(b"element face 2", b"element face 9").replace(b"element vertex 5", b"element vertex 4")
    )
    tracemalloc.start()
    with pytest.raises(MeshError):
        read(claim)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 10_000_000
