"""What Assimp makes of a mesh file that our own readers refuse or doubt. Pinocchio loads meshes by the same function of coal.

Assimp takes the file by its path, and is asked only about files for which it opens no other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from urdfcheck.facts.mesh.decode import RawMesh, decode_mesh
from urdfcheck.facts.mesh.decode_limits import MeshError, ensure_size_limits

# The formats of robots. Not glTF, whose buffers are other files; not OFF and PLY, of which hand-made files crash Assimp 6.0.
FORMATS = frozenset({"stl", "obj", "dae"})
# Reasons that do not depend on the reader: what is no mesh, what is given to no library, and formats that we do not read.
SETTLED = frozenset({"empty", "html", "lfs-pointer", "too-large", "archive", "unsupported"})
# Files that are one text to Assimp, which expands and decodes nothing, and may be another to other readers.
SEVERAL_TEXTS = frozenset({"entities", "encoding"})


def decode_with_assimp(
    data: bytes, file_type: str, path: Path | None, files: Mapping[str, bytes | MeshError] | None = None
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
    if suspect is None or path is None:
        return mesh
    try:
        load_by_assimp(path, file_type)
    except ImportError:
        return mesh
    except MeshError as error:
        return mesh if error.reason_id == "too-large" else replace(mesh, flaw=suspect, assimp="refuses")
    return replace(mesh, assimp="loads")


def _can_ask(data: bytes, file_type: str) -> bool:
    """Whether Assimp opens no other file for this one: it would open the materials of OBJ, whatever the place that is named.

    A backslash may continue their keyword in the next line.
    """
    return file_type in FORMATS and not (file_type == "obj" and (b"mtllib" in data or b"\\" in data))


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
    if error.reason_id in SEVERAL_TEXTS:
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
