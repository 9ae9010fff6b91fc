"""glTF 2.0, as text and binary (GLB): the triangles that its default scene places, and the base colours of their materials.
Images, animations and skins are ignored, nothing is decompressed, and no other file is opened: the caller reads those that
`list_buffer_files` names.

Khronos Group, *glTF 2.0 Specification*, sections 3.5 (scenes), 3.6 (accessors), 3.7 (primitives), 3.9 (materials) and 4.4 (GLB).
"""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator, Mapping
from itertools import islice
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.facts.mesh.decode_limits import MOST_NESTED, MOST_PLACED, MeshError, ensure_size_limits
from urdfcheck.facts.mesh.formats.polygons import narrow_indices

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Indices, Mat4
    from urdfcheck.facts.mesh.formats.collada import Color

    Json = Mapping[str, Any]
    Buffer = bytes | memoryview
    # The content of other files by URI, or why one is not read.
    Files = Mapping[str, bytes | MeshError]
    # Placed vertices (V, 3), faces (F, 3) and the matrix (4, 4) that placed them, for each primitive of each node.
    Parts = list[tuple[Array, Indices, Mat4]]
    # Runs of faces with the colour of their material; empty if there are none.
    Colors = tuple[tuple[int, Color | None], ...]

# The most files that the buffers of one document may be in: exporters write one.
MOST_BUFFERS = 64
_COMPRESSED = {"KHR_draco_mesh_compression": "Draco", "EXT_meshopt_compression": "meshopt"}
_NUMBERS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_TRIANGLES, _STRIP, _FAN = _DRAWN = (4, 5, 6)
_GLB_HEADER, _CHUNK_HEADER = 12, 8
_NO_FILES: Files = MappingProxyType({})


def list_buffer_files(data: bytes, file_type: str) -> tuple[str, ...]:
    """List the URIs, as written, of the other files in which a glTF document (``gltf`` or ``glb``) keeps its buffers.

    A document that cannot be read has none.

    :raises MeshError: when there are more than `MOST_BUFFERS`.
    """
    try:
        document, _ = _parse_gltf(data) if file_type == "gltf" else _parse_glb(data)
        named = [buffer.get("uri", "") for buffer in document.get("buffers", ())]
        files = tuple(dict.fromkeys(uri for uri in named if uri and not uri.startswith("data:")))
    except (MeshError, ValueError, AttributeError, TypeError, RecursionError):
        return ()
    if len(files) > MOST_BUFFERS:
        raise MeshError("too-large", f"keeps its geometry in {len(files):,} files, more than {MOST_BUFFERS}")
    return files


def read_gltf_parts(data: bytes, files: Files = _NO_FILES) -> tuple[Parts, Colors]:
    """Read the parts, and the colours of their faces.

    ``files``: the content of other files by URI, or why one is not read.

    :raises MeshError: when the geometry is in another file, compressed, truncated, or above the limits.
    """
    return _GltfDocument(*_parse_gltf(data), files).read_parts()


def read_glb_parts(data: bytes, files: Files = _NO_FILES) -> tuple[Parts, Colors]:
    """Read the parts as :func:`read_gltf_parts` does, from the binary form."""
    return _GltfDocument(*_parse_glb(data), files).read_parts()


def _parse_gltf(data: bytes) -> tuple[Json, Buffer]:
    return json.loads(data), b""


def _parse_glb(data: bytes) -> tuple[Json, Buffer]:
    """Return the document, and the buffer beside its JSON."""
    version = int.from_bytes(data[4:8], "little")
    if version != 2:
        raise MeshError("unsupported", f"is glTF {version}, but only glTF 2 is supported")
    chunks: dict[bytes, memoryview] = {}
    at = _GLB_HEADER
    while at + _CHUNK_HEADER <= len(data):
        size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
        at += _CHUNK_HEADER
        if at + size > len(data):
            raise MeshError(
                "truncated", f"is truncated: a chunk of {size:,} bytes ends {at + size - len(data):,} too early"
            )
        chunks.setdefault(kind, memoryview(data)[at : at + size])
        at += size
    if b"JSON" not in chunks:
        raise MeshError("malformed", "cannot be read as glb: it has no JSON chunk")
    return json.loads(bytes(chunks[b"JSON"])), chunks.get(b"BIN\0", b"")


class _GltfDocument:
    """One document; ``binary`` is the buffer beside its JSON, ``files`` those in other files."""

    def __init__(self, document: Json, binary: Buffer, files: Files) -> None:
        self.document = document
        self.binary = binary
        self.files = files
        self.buffers: dict[int, Buffer] = {}

    def read_parts(self) -> tuple[Parts, Colors]:
        self.refuse_unread()
        placed = list(islice(self.iter_placed_meshes(), MOST_PLACED + 1))
        primitives = ((p, matrix) for mesh, matrix in placed for p in self.document["meshes"][mesh]["primitives"])
        drawn = list(islice((pair for pair in primitives if _get_primitive_mode(pair[0]) in _DRAWN), MOST_PLACED + 1))
        ensure_size_limits(sum(self.count_triangles(p) for p, _ in drawn), max(len(placed), len(drawn)))
        parts: Parts = []
        colors: list[tuple[int, Color | None]] = []
        for primitive, matrix in drawn:
            points = self.read_accessor(primitive["attributes"]["POSITION"], "VEC3")
            if not np.array_equal(matrix, np.eye(4)):
                points = points @ matrix[:3, :3].T
                points += matrix[:3, 3]
            faces = self.read_faces(primitive)
            parts.append((points, faces, matrix))
            colors.append((len(faces), self.find_color(primitive)))
        return parts, tuple(colors) if any(color is not None for _, color in colors) else ()

    def find_color(self, primitive: Json) -> Color | None:
        """Find the base colour of a primitive; None without a material, with an image or with a colour for each corner.

        A material that cannot be read spoils no geometry.
        """
        try:
            material = self.document["materials"][_parse_index(primitive["material"])]
            surface = material.get("pbrMetallicRoughness", {})
            if "baseColorTexture" in surface or "COLOR_0" in primitive["attributes"]:
                return None
            if not surface and material.get("extensions"):
                return None  # described by an extension alone
            red, green, blue, alpha = map(float, surface.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)))
        except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError):
            return None
        if not all(0.0 <= part <= 1.0 for part in (red, green, blue, alpha)):
            return None
        # Unlike a material of the other formats, it is opaque unless it says otherwise.
        alpha = (alpha or 1.0) if material.get("alphaMode") == "BLEND" else 1.0
        return _encode_srgb(red), _encode_srgb(green), _encode_srgb(blue), alpha

    def refuse_unread(self) -> None:
        for extension, name in _COMPRESSED.items():
            if extension in self.document.get("extensionsRequired", ()):
                for problem in self.files.values():
                    if isinstance(problem, MeshError) and problem.reason_id == "missing-buffer":
                        raise problem  # also programs that decompress lack it
                raise MeshError("unsupported", f"is compressed with {name} ({extension}), which is not supported")

    def iter_placed_meshes(self) -> Iterator[tuple[int, Array]]:
        """Iterate over the meshes of the default scene with their matrices (4, 4), in document order."""
        scenes, nodes = self.document.get("scenes", ()), self.document.get("nodes", ())
        if not scenes:
            raise MeshError("no-triangles", "has no scene that places its geometry")
        roots = scenes[_parse_index(self.document.get("scene", 0))].get("nodes", ())
        visited: set[int] = set()
        stack = [(_parse_index(root), np.eye(4), 1) for root in reversed(roots)]
        while stack:
            index, outer, level = stack.pop()
            if index in visited or level > MOST_NESTED:  # a node has one parent, which excludes cycles and bombs
                why = "has more than one parent" if index in visited else f"is nested more than {MOST_NESTED} deep"
                raise MeshError("malformed", f"cannot be read as glTF: node {index} {why}")
            visited.add(index)
            node = nodes[index]
            matrix = outer @ _compute_node_matrix(node)
            if "mesh" in node:
                yield _parse_index(node["mesh"]), matrix
            stack.extend((_parse_index(child), matrix, level + 1) for child in reversed(node.get("children", ())))

    def count_triangles(self, primitive: Json) -> int:
        """Count the triangles that a primitive declares, before any is read."""
        accessor = primitive.get("indices", primitive["attributes"]["POSITION"])
        count = _parse_index(self.document["accessors"][_parse_index(accessor)]["count"])
        return count // 3 if _get_primitive_mode(primitive) == _TRIANGLES else max(count - 2, 0)

    def read_faces(self, primitive: Json) -> Indices:
        position, indices = primitive["attributes"]["POSITION"], primitive.get("indices")
        if indices is None:
            corners = np.arange(_parse_index(self.document["accessors"][_parse_index(position)]["count"]))
        else:
            corners = narrow_indices(self.read_accessor(indices, "SCALAR", whole=True)).reshape(-1)
        if _get_primitive_mode(primitive) == _TRIANGLES:
            return corners.reshape(-1, 3)
        first, second, third = corners[:-2], corners[1:-1], corners[2:]
        if _get_primitive_mode(primitive) == _FAN:
            return np.stack((second, third, np.broadcast_to(corners[0], second.shape)), axis=1)
        odd = np.arange(len(first)) % 2 == 1
        return np.stack((first, np.where(odd, third, second), np.where(odd, second, third)), axis=1)

    def read_accessor(self, accessor: Any, kind: str, *, whole: bool = False) -> NDArray[Any]:
        """Read the numbers (count, width) of an accessor: as float64, or as stored if they are ``whole``."""
        entry = self.document["accessors"][_parse_index(accessor)]
        if entry["type"] != kind:
            raise MeshError("malformed", f"cannot be read as glTF: an accessor is {entry['type']!r:.40}, not {kind}")
        if "sparse" in entry or "bufferView" not in entry:
            raise MeshError("unsupported", "keeps its geometry in a sparse accessor, which is not supported")
        view = self.document["bufferViews"][_parse_index(entry["bufferView"])]
        numbers = np.dtype(_NUMBERS[entry["componentType"]])
        if whole and numbers.kind != "u":
            raise MeshError("malformed", "cannot be read as glTF: its indices are not unsigned numbers")
        count, width = _parse_index(entry["count"]), 3 if kind == "VEC3" else 1
        row = width * numbers.itemsize
        stride = _parse_index(view.get("byteStride", row))
        within, begin = _parse_index(entry.get("byteOffset", 0)), _parse_index(view.get("byteOffset", 0))
        buffer, length = self.read_buffer(_parse_index(view["buffer"])), _parse_index(view["byteLength"])
        end = within + (count - 1) * stride + row if count else 0
        if stride < row or end > length or begin + length > len(buffer):
            raise MeshError(
                "truncated", f"is truncated: it declares {count:,} rows of numbers, which its buffer does not hold"
            )
        stored: NDArray[Any] = np.ndarray(
            (count, width), numbers, buffer, offset=begin + within, strides=(stride, numbers.itemsize)
        )
        if whole:
            return stored
        values = stored.astype(np.float64)
        if entry.get("normalized") and numbers.kind != "f":
            values = np.maximum(values / np.iinfo(numbers).max, -1.0)
        return values

    def read_buffer(self, index: int) -> Buffer:
        if index not in self.buffers:
            entry = self.document["buffers"][index]
            uri = entry.get("uri")
            if uri is None:
                self.buffers[index] = self.binary
            elif uri.startswith("data:"):
                self.buffers[index] = base64.b64decode(uri.partition(",")[2])
            else:
                self.buffers[index] = self.get_file(uri)
        return self.buffers[index]

    def get_file(self, uri: str) -> bytes:
        content = self.files.get(uri)
        if isinstance(content, bytes):
            return content
        raise content or MeshError(
            "external-buffer", f"keeps its geometry in another file ({uri[:200]!r}), not read here"
        )


def _encode_srgb(linear: float) -> float:
    """Return how a linear part of a colour, as glTF has them, is written for a screen: by the curve of IEC 61966-2-1."""
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1.0 / 2.4) - 0.055


def _get_primitive_mode(primitive: Json) -> Any:
    """Return the mode of a primitive; triangles if it has none."""
    return primitive.get("mode", _TRIANGLES)


def _parse_index(value: Any) -> int:
    """Return a whole number from 0 up; a negative one would count from the end of a list."""
    if not isinstance(value, int) or value < 0:
        raise ValueError(f"{str(value)[:40]!r} is neither a count nor an index")
    return value


def _compute_node_matrix(node: Json) -> Mat4:
    """Compute the matrix (4, 4) of a node: its own, stored by columns, or that of its translation, rotation and scale."""
    if "matrix" in node:
        by_columns: Mat4 = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        return by_columns
    matrix = np.eye(4)
    turn = np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
    x, y, z, w = turn / (np.linalg.norm(turn) or 1.0)
    matrix[:3, :3] = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    matrix[:3, :3] *= np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix
