"""What Assimp makes of a mesh file that our own readers refuse or doubt. Pinocchio loads meshes by the same function of coal.

Assimp takes the file by its path, and is asked only about files for which it opens no other.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from urdfcheck.facts.mesh.decode import RawMesh, decode_mesh
from urdfcheck.facts.mesh.decode_limits import MeshError, ensure_size_limits
from urdfcheck.facts.mesh.formats.binary_stl import BinaryStl

# The formats of robots. Not glTF, whose buffers are other files; not OFF and PLY, of which hand-made files crash Assimp 6.0.
FORMATS = frozenset({"stl", "obj", "dae"})
# Reasons that do not depend on the reader: what is no mesh, what is given to no library, and formats that we do not read.
SETTLED = frozenset({"empty", "no-facets", "html", "lfs-pointer", "too-large", "archive", "unsupported"})
# Elements of COLLADA within each other; of published meshes, none has 30. Assimp's stack ends at some 10,000.
MAX_DEPTH = 200
_TOKEN = re.compile(
    rb"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<!DOCTYPE[^\[>]*(?:\[.*?\]\s*)?>|(?P<closing></[^>]*>)"
    rb"|<[^/!?](?:[^>\"'/]|\"[^\"]*\"|'[^']*'|/(?!>))*(?:/>|(?P<opening>>))",
    re.DOTALL,
)
# Files that are one text to Assimp, which expands and decodes nothing, and may be another to other readers.
SEVERAL_TEXTS = frozenset({"entities", "encoding"})


def decode_with_assimp(
    data: bytes | BinaryStl, file_type: str, path: Path | None, files: Mapping[str, bytes | MeshError] | None = None
) -> RawMesh:
    """Decode a mesh as `decode_mesh` does, and ask Assimp about the file at ``path`` where that fails or leaves a doubt.

    :raises MeshError: when neither reads it; ``assimp`` says what Assimp does.
    :raises ImportError, MemoryError: see `decode_mesh`.
    """
    try:
        mesh = decode_mesh(data, file_type, files)
    except MeshError as error:
        if path is None or error.reason_id in SETTLED or not _can_ask(data, file_type):
            raise
        return _load_refused(error, path, file_type)
    suspect = mesh.flaw or mesh.doubt
    if suspect is None or path is None or not _can_ask(data, file_type):
        return mesh
    try:
        load_by_assimp(path, file_type)
    except ImportError:
        return mesh
    except MeshError as error:
        return mesh if error.reason_id == "too-large" else replace(mesh, flaw=suspect, assimp="refuses")
    return replace(mesh, assimp="loads")


def _can_ask(data: bytes | BinaryStl, file_type: str) -> bool:
    """Whether Assimp opens no other file for this one, and comes to an end.

    It would open the materials of OBJ, whatever the place that is named; a backslash may continue their keyword in the next
    line. In COLLADA it goes down by calling itself, without a limit, and into nodes that stand for each other: its stack ends.
    """
    if isinstance(data, BinaryStl):
        return True
    if file_type == "obj":
        return not (b"mtllib" in data or b"\\" in data)
    if file_type == "dae":
        text = data.replace(b"\0", b"")  # it reads UTF-16 as well
        return b"instance_node" not in text and _is_shallow(text)
    return file_type in FORMATS


def _is_shallow(text: bytes) -> bool:
    """Whether the elements of a file that need not be well-formed hold each other at most `MAX_DEPTH` deep."""
    depth = 0
    at = text.find(b"<")
    while at >= 0:
        token = _TOKEN.match(text, at)
        if token is None:
            return text.find(b">", at) < 0  # it is cut off there: no parser gets further
        depth += {"opening": 1, "closing": -1}.get(token.lastgroup or "", 0)
        if depth > MAX_DEPTH:
            return False
        at = text.find(b"<", token.end())
    return True


def _load_refused(error: MeshError, path: Path, file_type: str) -> RawMesh:
    """Load what our own reader refused."""
    try:
        mesh = load_by_assimp(path, file_type)
    except ImportError:
        raise error from None
    except MeshError as refusal:
        if refusal.reason_id == "too-large":
            raise
        raise MeshError(error.reason_id, error.message, "refuses") from None
    # The corners count from the start of their own geometry (coal 3.0.3, buildMesh): of several in one node, all but those of the
    # first are others.
    is_mixed_up = mesh.faces is not None and len(np.unique(mesh.faces)) < len(mesh.vertices)
    if is_mixed_up or error.reason_id in SEVERAL_TEXTS:
        raise MeshError(error.reason_id, error.message, "loads") from None
    return replace(mesh, flaw=error.message, assimp="loads")


def load_by_assimp(path: Path, file_type: str) -> RawMesh:
    """Load a mesh as Pinocchio does: coal lets Assimp place and triangulate it, ignoring COLLADA's unit and axis.

    :raises MeshError: when Assimp refuses it, or it has more triangles than the limit.
    :raises ImportError: when coal is not installed.
    """
    import coal

    try:
        mesh = coal.MeshLoader().load(str(path))
    except (ValueError, RuntimeError) as error:
        raise MeshError("refused", "is refused by Assimp") from error
    ensure_size_limits(mesh.num_tris)
    triangles = (mesh.tri_indices(i) for i in range(mesh.num_tris))
    faces = np.array([(t[0], t[1], t[2]) for t in triangles], dtype=np.int64).reshape(-1, 3)
    return RawMesh(format=file_type, vertices=np.array(mesh.vertices(), dtype=np.float64).reshape(-1, 3), faces=faces)
