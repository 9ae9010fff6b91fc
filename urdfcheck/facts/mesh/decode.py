"""Mesh files as raw triangles. A file that common loaders silently read as empty is rejected with the reason.

STL, OBJ, OFF and PLY are decoded here because trimesh silently returns an empty or shortened mesh for broken ones, and takes many
times the memory of the file; glTF because trimesh decodes images and decompresses. pycollada reads COLLADA
(`urdfcheck.facts.mesh.formats.collada`) from memory, so that no other file is ever read.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.decode_limits import MeshError, ensure_size_limits
from urdfcheck.facts.mesh.formats.binary_stl import HEADER, BinaryStl, count_facets, read_binary_stl
from urdfcheck.facts.mesh.formats.gltf import read_glb_parts, read_gltf_parts
from urdfcheck.facts.mesh.formats.number_text import TokenizedText
from urdfcheck.facts.mesh.formats.obj_materials import ObjMaterials, read_obj_materials
from urdfcheck.facts.mesh.formats.ply import read_ply
from urdfcheck.facts.mesh.formats.polygons import (
    make_bad_line_error,
    parse_indices,
    parse_rows,
    triangulate_text_fans,
)
from urdfcheck.facts.mesh.formats.stl_damage import make_size_error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Indices
    from urdfcheck.facts.mesh.formats.collada import Color


# The characters of plain text.
_TEXT = bytes([*range(9, 14), *range(32, 127)])
_COMMENT = re.compile(rb"#[^\r\n]*")
_LINE_END = re.compile(rb"[\r\n]")
_BOM = b"\xef\xbb\xbf"
# First bytes that identify a format regardless of the file name. STL, OBJ and OFF readers would find garbage or nothing.
_SIGNATURES = {"dae": (b"<?xml", b"<COLLADA"), "ply": (b"ply\n", b"ply\r"), "glb": (b"glTF",)}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RawMesh:
    """Triangles as a file stores them, with scene transforms applied."""

    format: str
    """The file type; ``stl-binary`` or ``stl-ascii`` for STL."""
    vertices: NDArray[np.floating]
    """(V, 3) in file units, float32 or float64."""
    faces: Indices | None
    """(F, 3); None if each three vertices in turn are a triangle."""
    solid_header: bool = False
    """Whether a binary STL begins with ``solid``, as an ASCII one must."""
    unit: float | None = None
    """Metres per file unit, of COLLADA."""
    up_axis: str | None = None
    """Of COLLADA."""
    bad_unit: str | None = None
    """The declared unit if it is not a plausible length; ``unit`` is None then."""
    colors: tuple[tuple[int, Color | None], ...] = ()
    """Runs of faces with the r g b a (0 to 1, as shown) of their material, None without one; empty if the format or file has no
    colours."""
    materials: ObjMaterials | None = None
    """Of OBJ, whose colours are in other files."""
    flaw: str | None = None
    """What is wrong with the file for stricter readers of its format, although all its triangles are here."""
    doubt: str | None = None
    """What is wrong with the file for readers that may be stricter. Both complete the sentence "the mesh …"."""
    assimp: str = ""
    """What Assimp does with a file that has a flaw or a doubt: ``loads`` or ``refuses``; empty if it was not asked."""

    @property
    def n_triangles(self) -> int:
        return len(self.vertices) // 3 if self.faces is None else len(self.faces)


def decode_mesh(
    data: bytes | BinaryStl, file_type: str, files: Mapping[str, bytes | MeshError] | None = None
) -> RawMesh:
    """Decode the triangles of a mesh file; ``file_type`` is its extension in lower case, without the dot.

    ``files``: of glTF, see `urdfcheck.facts.mesh.formats.gltf.read_gltf_parts`.

    :raises MeshError: when the file has none, or fewer than it declares.
    :raises ImportError: when the library that reads the format is not installed.
    :raises MemoryError: when there is not enough memory for what the file contains or declares.
    """
    _refuse_impostors(data.start if isinstance(data, BinaryStl) else data, file_type)
    try:
        if isinstance(data, BinaryStl):
            mesh = _make_binary_stl(data)
        elif file_type in _GLTF_READERS:
            parts, colors = _GLTF_READERS[file_type](data, files or {})
            mesh = replace(_join_parts(file_type, parts), colors=colors)
        else:
            mesh = _DECODERS[file_type](data)
    except (MeshError, ImportError, MemoryError):
        raise
    except Exception as error:  # loaders raise whatever their internals do: AttributeError, IndexError, DaeError …
        text = " ".join(str(error).split())[:200].rstrip(".")
        raise MeshError("malformed", f"cannot be read as {file_type}: {type(error).__name__}: {text}") from error
    if not mesh.n_triangles:
        # Other formats may hold what another program makes a shape of: points, lines, several scenes.
        raise MeshError("no-facets" if file_type == "stl" else "no-triangles", "has no triangles")
    return mesh


def _refuse_impostors(data: bytes, file_type: str) -> None:
    start = data[:512].removeprefix(_BOM).lstrip()
    if not data:
        raise MeshError("empty", "is empty (0 bytes)")
    if start.startswith(b"version https://git-lfs.github.com/spec/"):
        size = re.search(rb"^size (\d+)", start, re.MULTILINE)
        real = f" of {int(size[1]):,} bytes" if size else ""
        raise MeshError("lfs-pointer", f"is a Git LFS pointer; the file{real} was never fetched (git lfs pull)")
    if start[:14].lower().startswith((b"<!doctype html", b"<html")):
        raise MeshError("html", "is a web page, not a mesh: the download saved an error or a preview page")
    if file_type not in _FORMATS:
        known = ", ".join(_FORMATS)
        raise MeshError("unsupported", f"has the unsupported format {file_type or '(none)'!r}; supported are {known}")
    for name, signatures in _SIGNATURES.items():
        if name != file_type and start.startswith(signatures):
            raise MeshError("malformed", f"is named {file_type} but begins like a {name} file")


def _make_binary_stl(stl: BinaryStl) -> RawMesh:
    return RawMesh(
        format="stl-binary", vertices=stl.take_corners(), faces=None, solid_header=_begins_with_solid(stl.start)
    )


def _begins_with_solid(data: bytes) -> bool:
    return data[:512].lstrip()[:5].lower() == b"solid"


def _decode_stl(data: bytes) -> RawMesh:
    declared = int.from_bytes(data[80:HEADER], "little") if len(data) >= HEADER else 0
    solid = _begins_with_solid(data)
    if count_facets(data, len(data)) is not None:
        ensure_size_limits(declared)
        stl = read_binary_stl(BytesIO(data), len(data))
        assert stl is not None
        return _make_binary_stl(stl)
    text = data.rstrip(b"\0")
    if solid and b"\0" not in text:
        return _decode_ascii_stl(text)
    start = text[:512].strip()
    if start and not solid and start.translate(None, _TEXT) == b"":
        begin = start[:40].splitlines()[0].decode()
        raise MeshError("text", f"is text, but no STL file: it begins with {begin!r}")
    if len(data) < HEADER:
        raise MeshError("truncated", f"is truncated: {len(data)} bytes, while a binary STL's header alone has 84")
    raise make_size_error(data, declared)


def _decode_ascii_stl(data: bytes) -> RawMesh:
    text = TokenizedText(_strip_solid_names(data))
    begins, ends = np.flatnonzero(text.match_word(b"outer")), np.flatnonzero(text.match_word(b"endloop"))
    corners = np.flatnonzero(text.match_word(b"vertex"))
    facets = int(np.count_nonzero(text.match_word(b"facet")))
    if len(ends) < facets:
        raise MeshError("truncated", f"is truncated: {facets:,} facets begin but only {len(ends):,} are complete")
    # Some writers omit "endsolid", of which `_strip_solid_names` keeps "end". Nothing else follows the last facet.
    closing = text.match_word(b"end")
    if facets and not closing[ends[-1] :].any() and not text.match_word(b"endfacet")[-1]:
        raise MeshError(
            "truncated", f"is truncated: it ends with {text.get_token(len(text) - 1)[:80].decode(errors='replace')!r}"
        )
    if len(begins) != len(ends):
        raise MeshError("malformed", f"has 'outer loop' {len(begins):,} times but 'endloop' {len(ends):,} times")
    ensure_size_limits(facets)
    counts = np.searchsorted(corners, ends) - np.searchsorted(corners, begins)
    for number in np.flatnonzero(counts != 3)[:1]:
        raise MeshError("malformed", f"has {counts[number]} vertices in facet {number + 1}, instead of 3")
    inside = corners[np.searchsorted(begins, corners) > np.searchsorted(ends, corners)]
    vertices = parse_rows(text, inside + 1, 3, "stl")
    return RawMesh(format="stl-ascii", vertices=vertices, faces=None)


def _strip_solid_names(data: bytes) -> bytes:
    """Drop the lines that begin and end a solid: its name may contain any word."""
    word = b"SOLID" if data[:512].lstrip().startswith(b"SOLID") else b"solid"
    parts, at = [], 0
    while (begin := data.find(word, at)) >= 0:
        parts.append(data[at:begin])
        end = _LINE_END.search(data, begin)
        if end is None:
            return b"".join(parts)
        at = end.start()
    return b"".join((*parts, data[at:]))


def _decode_obj(data: bytes) -> RawMesh:
    if b"\0" in data:
        raise MeshError("malformed", "contains binary data, but OBJ is text")
    if b"\\" in data:
        data = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").replace(b"\\\r", b" ")
    text = TokenizedText(_COMMENT.sub(b"", data.removeprefix(_BOM)))
    starts = text.find_line_starts()
    counts = np.diff(starts, append=len(text)) - 1
    is_vertex, is_face = (text.match_word(word, starts) for word in (b"v", b"f"))
    for line in np.flatnonzero((is_vertex | is_face) & (counts < 3))[:1]:
        raise make_bad_line_error(text, starts[line], "obj")
    vertices = parse_rows(text, starts[is_vertex] + 1, 3, "obj")
    polygons = counts[is_face]
    faces = triangulate_text_fans(text, starts[is_face] + 1, polygons, "obj")
    # Negative indices count back from the vertices so far; there is no vertex 0.
    if (faces < 0).any():
        before = np.repeat(np.cumsum(is_vertex, dtype=np.int32)[is_face], polygons - 2)[:, None]
        faces += np.where(faces < 0, before + 1, 0)
    faces -= 1
    mesh = _build_checked_mesh("obj", vertices, faces)
    return replace(mesh, materials=read_obj_materials(text, starts, counts, is_face)) if b"usemtl" in data else mesh


def _decode_off(data: bytes) -> RawMesh:
    text = TokenizedText(_COMMENT.sub(b"", data.removeprefix(_BOM)))
    starts = text.find_line_starts()
    header = text.get_token(0) if len(text) else b""
    if not re.fullmatch(rb"(ST)?C?N?OFF", header):
        raise MeshError("malformed", "does not begin like an off file")
    # The counts are beside the header word or on a separate line.
    beside = len(starts) == 1 or starts[1] > 1
    n_vertices, n_faces = map(int, parse_indices(text, np.array((0, 1)) + (1 if beside else starts[1]), "off"))
    body = starts[1:] if beside else starts[2:]
    if len(body) < n_vertices + n_faces:
        raise MeshError(
            "truncated",
            f"is truncated: it declares {n_vertices:,} vertices and {n_faces:,} faces, "
            f"{n_vertices + n_faces:,} lines, and has {len(body):,}",
        )
    if len(body) > n_vertices + n_faces:
        raise make_bad_line_error(text, body[n_vertices + n_faces], "off")
    points, polygons = body[:n_vertices], body[n_vertices : n_vertices + n_faces]
    if len(points) and points[-1] + 3 >= len(text):
        raise make_bad_line_error(text, points[-1], "off")
    counts = parse_indices(text, polygons, "off")
    for polygon in np.flatnonzero((counts < 1) | (counts >= len(text) - polygons))[:1]:
        raise make_bad_line_error(text, polygons[polygon], "off")
    corners = triangulate_text_fans(text, polygons + 1, counts, "off")
    return _build_checked_mesh("off", parse_rows(text, points, 3, "off"), corners)


def _build_checked_mesh(name: str, vertices: NDArray[np.floating], faces: Indices) -> RawMesh:
    _refuse_bad_indices(faces, len(vertices))
    return RawMesh(format=name, vertices=vertices, faces=faces)


def _refuse_bad_indices(faces: Indices, n_vertices: int) -> None:
    if faces.size and (faces.min() < 0 or faces.max() >= n_vertices):
        outside = ((faces < 0) | (faces >= n_vertices)).any(axis=1)
        raise MeshError("malformed", f"has {int(outside.sum()):,} faces that refer to a missing vertex")


def _decode_dae(data: bytes) -> RawMesh:
    from urdfcheck.facts.mesh.formats.collada import read_collada  # half of what the readers load

    scene = read_collada(data)
    joined = _join_parts("dae", scene.parts)
    return replace(
        joined,
        unit=scene.unit,
        up_axis=scene.up_axis,
        bad_unit=scene.bad_unit,
        colors=scene.colors,
        flaw=scene.flaw,
        doubt=scene.doubt,
    )


def _decode_ply(data: bytes) -> RawMesh:
    return _build_checked_mesh("ply", *read_ply(data))


def _join_parts(
    name: str,
    parts: list[tuple[Array, Indices, Array]],
) -> RawMesh:
    """Join a scene's parts into one mesh: placed vertices, faces, and the (4, 4) matrix that placed them."""
    vertices: list[Array] = []
    faces: list[Indices] = []
    count = 0
    for points, corners, matrix in parts:
        _refuse_bad_indices(corners, len(points))
        # A mirroring node turns triangles inside out: their corners are reversed.
        outward = corners[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else corners
        vertices.append(points)
        faces.append(outward + count if count else outward)
        count += len(points)
    return RawMesh(format=name, vertices=_join_rows(vertices), faces=_join_rows(faces))


def _join_rows(parts: list[NDArray[Any]]) -> NDArray[Any]:
    """Join arrays (n, 3); one alone is not copied."""
    return parts[0] if len(parts) == 1 else np.concatenate((np.empty((0, 3), dtype=np.int32), *parts))


_DECODERS: dict[str, Callable[[bytes], RawMesh]] = {
    "stl": _decode_stl,
    "obj": _decode_obj,
    "dae": _decode_dae,
    "ply": _decode_ply,
    "off": _decode_off,
}
_GLTF_READERS = {"gltf": read_gltf_parts, "glb": read_glb_parts}
_FORMATS = (*_DECODERS, *_GLTF_READERS)
