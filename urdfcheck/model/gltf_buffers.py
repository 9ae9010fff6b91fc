"""The files in which glTF documents keep their geometry. What holds for a mesh file holds for them: its reach, its limits."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.reach import OUT_OF_REACH
from urdfcheck.system.files import MAX_MESH, FileTooLargeError, read_regular

if TYPE_CHECKING:
    from urdfcheck.facts.mesh.decode_limits import MeshError
    from urdfcheck.system.array_cache import ArrayCache

FORMATS = frozenset({"gltf", "glb"})
# A URI with a scheme, and paths that do not start at the document: glTF 2.0 allows neither, in section 2.8.
_NOT_RELATIVE = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:|[/\\~]")
_LFS = b"version https://git-lfs.github.com/spec/"


@dataclass(frozen=True, slots=True)
class Buffers:
    """The buffer files of one document, by their URIs as written."""

    paths: Mapping[str, Path]
    """Those that exist and may be read."""
    errors: Mapping[str, MeshError]
    """Why the others are not read."""
    digest: str
    """Of all that they contain."""

    def read(self) -> dict[str, bytes | MeshError]:
        """Read the files.

        :raises OSError: when one can no longer be read.
        """
        from urdfcheck.facts.mesh.decode_limits import MeshError

        files: dict[str, bytes | MeshError] = {**self.errors}
        for uri, path in self.paths.items():
            content = read_regular(path, MAX_MESH)
            pointer = MeshError("missing-buffer", f"keeps its geometry in {uri[:200]!r}, which is a Git LFS pointer")
            files[uri] = pointer if content.startswith(_LFS) else content
        return files


def resolve_buffers(uris: Iterable[str], document: Path, finder: PackageFinder, cache: ArrayCache) -> Buffers:
    """Find the buffer files that a document names.

    :raises OSError: when one exists and cannot be read.
    """
    from urdfcheck.facts.mesh.decode_limits import MeshError

    paths: dict[str, Path] = {}
    errors: dict[str, MeshError] = {}
    digest, left = hashlib.sha256(), MAX_MESH
    for uri in uris:
        found = _find_buffer(uri, document, finder)
        if isinstance(found, Path):
            try:
                content, _ = cache.compute_digest(found, left)
                left -= found.stat().st_size
                paths[uri] = found
                digest.update(f"{uri}\0{content}\0".encode("utf-8", "surrogatepass"))
                continue
            except FileTooLargeError:
                found = MeshError("too-large", f"has buffers of more than {MAX_MESH // 1024**2} MiB together")
        errors[uri] = found
        digest.update(f"{uri}\0{found}\0".encode("utf-8", "surrogatepass"))
    return Buffers(paths, errors, digest.hexdigest())


def _find_buffer(uri: str, document: Path, finder: PackageFinder) -> Path | MeshError:
    from urdfcheck.facts.mesh.decode_limits import MeshError

    shown = repr(uri[:200])
    if _NOT_RELATIVE.match(uri):
        return MeshError("external-buffer", f"keeps its geometry in {shown}, but glTF only allows relative paths")
    resource = finder.resolve_resource(unquote(uri), document.parent)
    if not resource.allowed:
        return MeshError("external-buffer", f"keeps its geometry in {shown}, and {OUT_OF_REACH}")
    if resource.path is None or not resource.exists:
        there = "" if resource.actual_spelling is None else f" (there is {resource.actual_spelling!r})"
        return MeshError("missing-buffer", f"keeps its geometry in {shown}, which does not exist{there}")
    return resource.path
