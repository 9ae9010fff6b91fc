"""The meshes of a model: each use resolved to a file, each content read once."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.model.gltf_buffers import FORMATS as GLTF_FORMATS
from urdfcheck.model.gltf_buffers import Buffers, resolve_buffers
from urdfcheck.model.parts import Link, Shape
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import PackageFinder, Resource
from urdfcheck.source.text.xml import Attribute
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.files import MAX_MESH, FileTooLargeError, read_regular, read_with_digest
from urdfcheck.system.installation import compute_code_version, find_library_origin

if TYPE_CHECKING:
    from urdfcheck.facts.mesh.decode_limits import MeshError
    from urdfcheck.facts.mesh.formats.binary_stl import BinaryStl
    from urdfcheck.facts.mesh.measure import MeshFacts
    from urdfcheck.system.array_cache import Entry

# What the measurements of a mesh depend on besides its content.
MEASURING_MODULES = ("urdfcheck.facts.mesh",)
# The libraries that read the formats that urdfcheck does not read itself, and the one by which it asks Assimp.
READERS = {"dae": "collada"}
SECOND_READER = "coal"
# Where it is not installed, another library computes convex hulls.
HULLS = "scipy"


@dataclass(frozen=True, slots=True, eq=False)
class MeshUse:
    """One ``<mesh filename=…>`` of a shape, and the file that it names."""

    link: Link
    shape: Shape
    filename: Attribute
    resource: Resource

    @property
    def name(self) -> str:
        """The file's name without its folders."""
        return self.filename.value.rpartition("/")[2]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ModelMeshes:
    """The meshes of a model, and what was measured on their files."""

    uses: tuple[MeshUse, ...]
    """In document order."""
    facts: Mapping[Path, MeshFacts]
    """By file, of those that could be read; empty in the source tier, as the next two."""
    errors: Mapping[Path, MeshError]
    """By file, of those that could not."""
    digests: Mapping[Path, str]
    """SHA-256 of the content, by file; of glTF, with that of the files in which it keeps its geometry."""
    by_shape: Mapping[int, MeshUse]
    """The use of each shape, by the ``id`` of the shape."""

    @classmethod
    def from_links(cls, links: Sequence[Link], source: Source, cache: ArrayCache, *, read: bool) -> ModelMeshes:
        """Resolve the meshes of all links; with ``read``, measure every file that exists, or recall what was measured."""
        uses: list[MeshUse] = []
        for link in links:
            for shape in (*link.visuals, *link.collisions):
                filename = shape.mesh_filename
                if filename is not None:
                    resource = source.finder.resolve_resource(filename.value, source.path.parent)
                    uses.append(MeshUse(link=link, shape=shape, filename=filename, resource=resource))
        meshes = cls(uses=tuple(uses), facts={}, errors={}, digests={}, by_shape={id(u.shape): u for u in uses})
        return meshes._read_files(cache, source.finder) if read and meshes.group_by_file() else meshes

    def get_facts(self, shape: Shape) -> MeshFacts | None:
        """Return the facts of a shape's mesh; None when it is not a mesh, is missing or could not be read."""
        use = self.by_shape.get(id(shape))
        return None if use is None or use.resource.path is None else self.facts.get(use.resource.path)

    def is_drawn(self, use: MeshUse) -> bool:
        """Whether a visual draws the file too: then nobody made it for collision."""
        return any(u.resource.path == use.resource.path and u.shape.role == "visual" for u in self.uses)

    def group_by_file(self) -> Mapping[Path, tuple[MeshUse, ...]]:
        """Return the uses of each file that exists; those for collision first, otherwise in document order."""
        by_file: dict[Path, list[MeshUse]] = {}
        for use in self.uses:
            if use.resource.exists and use.resource.path is not None:
                by_file.setdefault(use.resource.path, []).append(use)
        return {path: tuple(sorted(uses, key=lambda u: u.shape.role != "collision")) for path, uses in by_file.items()}

    def list_measured(self) -> Iterator[tuple[tuple[MeshUse, ...], MeshFacts]]:
        """Yield the uses, as in :meth:`group_by_file`, and the facts of each file that could be read."""
        for path, uses in self.group_by_file().items():
            facts = self.facts.get(path)
            if facts is not None:
                yield uses, facts

    def compute_content_key(self, path: Path) -> str | None:
        """Return a text that identifies a file's content and how it is read; None for a file that could not be opened."""
        digest = self.digests.get(path)
        return None if digest is None else f"{digest}-{_get_file_kind(path)}"

    def _read_files(self, cache: ArrayCache, finder: PackageFinder) -> ModelMeshes:
        from urdfcheck.facts.mesh.decode_limits import MeshError

        facts: dict[Path, MeshFacts] = {}
        errors: dict[Path, MeshError] = {}
        digests: dict[Path, str] = {}
        by_content: dict[str, MeshFacts | MeshError] = {}
        for path in sorted(self.group_by_file()):
            try:
                content = _read_content(path, cache, finder)
                digests[path] = content.digest
                kind = _get_file_kind(path)
                key = f"{content.digest}-{kind}-{_compute_reader_version(kind)}"
                if key not in by_content:
                    by_content[key] = _recall_or_measure(content, cache.entry("meshes", key))
            except MeshError as error:  # of the buffers of one document
                errors[path] = error
                continue
            except (OSError, ImportError, MemoryError) as error:
                errors[path] = _make_mesh_error(error)
                continue
            result = by_content[key]
            if isinstance(result, MeshError):
                errors[path] = result
            else:
                facts[path] = result
        return replace(self, facts=facts, errors=errors, digests=digests)


def recall_mesh(path: Path, digest: str, cache: ArrayCache) -> MeshFacts | None:
    """Return the facts of a mesh file that was measured, from the cache or anew; None where its content is another by now.

    :param digest: as of `ModelMeshes.digests`. Of glTF with files of its own for buffers only the cache has the facts.
    """
    from urdfcheck.facts.mesh.decode_limits import MeshError

    kind = _get_file_kind(path)
    parts = cache.entry("meshes", f"{digest}-{kind}-{_compute_reader_version(kind)}")
    try:
        data = None
        if "summary" not in parts:
            data, found_digest = read_with_digest(path, MAX_MESH)
            if found_digest != digest:
                return None
        found = _recall_or_measure(_Content(path, digest, data), parts)
    except (OSError, ImportError):
        return None
    return None if isinstance(found, MeshError) else found


@dataclass(slots=True, eq=False)
class _Content:
    """A mesh file, and of glTF the files in which it keeps its geometry."""

    path: Path
    digest: str
    """Of all of them."""
    data: bytes | BinaryStl | None
    """What the file contains, if it was read."""
    buffers: Buffers | None = None

    def read(self) -> bytes | BinaryStl:
        """Read the file unless that was done.

        :raises OSError: when it can no longer be read.
        """
        return read_regular(self.path, MAX_MESH) if self.data is None else self.data

    def forget(self) -> None:
        """Free the memory that the file takes: it may be read again."""
        self.data = None


def _read_content(path: Path, cache: ArrayCache, finder: PackageFinder) -> _Content:
    """Compute the digest of a mesh file, and read it if that needs to.

    :raises OSError: when a file cannot be read, or is too large.
    :raises MeshError: when there are too many buffers.
    """
    from urdfcheck.facts.mesh.formats.binary_stl import read_binary_stl

    kind = _get_file_kind(path)
    digest, data = cache.compute_digest(path, read=read_binary_stl if kind == "stl" else None)
    content = _Content(path, digest, data)
    if kind not in GLTF_FORMATS:
        return content
    uris = _list_buffers(content, cache.entry("gltf-buffers", f"{digest}-{kind}-{_compute_reader_version(kind)}"))
    if uris:
        content.buffers = resolve_buffers(uris, path, finder, cache)
        content.digest = hashlib.sha256(f"{digest}{content.buffers.digest}".encode()).hexdigest()
    return content


def _list_buffers(content: _Content, known: Entry) -> tuple[str, ...]:
    """List the URIs of a document's buffer files, or recall what was listed."""
    import numpy as np

    from urdfcheck.facts.mesh.formats.gltf import list_buffer_files

    if "uris" not in known:
        data = content.read()
        assert isinstance(data, bytes)
        uris = list_buffer_files(data, _get_file_kind(content.path))
        known["uris"] = {"text": np.frombuffer(json.dumps(uris).encode(), dtype=np.uint8)}
    return tuple(json.loads(known["uris"]["text"].tobytes()))


def _recall_or_measure(content: _Content, parts: Entry) -> MeshFacts | MeshError:
    """Return the facts of a mesh, or why it gives none, as ``parts`` keeps them or anew."""
    from urdfcheck.facts.mesh.decode_limits import MeshError
    from urdfcheck.facts.mesh.measure import restore_mesh_facts

    try:
        known = restore_mesh_facts(parts, remeasure=partial(_measure_mesh, content, parts))
        return known or _measure_mesh(content, parts)
    except MeshError as error:
        return error
    finally:
        content.forget()


def _measure_mesh(content: _Content, parts: Entry) -> MeshFacts:
    from urdfcheck.facts.mesh.measure import measure_mesh

    files = None if content.buffers is None else content.buffers.read()
    return measure_mesh(content.read(), _get_file_kind(content.path), parts, path=content.path, files=files)


def _make_mesh_error(error: OSError | ImportError | MemoryError) -> MeshError:
    """Explain why a file could not be read at all; another run may be able to, so the cache does not keep it."""
    from urdfcheck.facts.mesh.decode_limits import MeshError

    if isinstance(error, FileTooLargeError):
        return MeshError("too-large", error.message.removeprefix("the file "))
    if isinstance(error, OSError):
        return MeshError("unreadable", error.strerror or str(error))
    if isinstance(error, ImportError):
        return MeshError("unsupported", f"cannot be read here: {error.name} is not installed")
    return MeshError("too-large", "does not fit into the memory that the check of one model may take")


def _compute_reader_version(kind: str) -> str:
    """Return a digest of what decides the measurements of a file of this kind besides its content."""
    libraries = (READERS.get(kind), SECOND_READER, HULLS)
    origins = [find_library_origin(library) for library in libraries if library is not None]
    return compute_code_version(*MEASURING_MODULES, library="\n".join(map(str, origins)))


def _get_file_kind(path: Path) -> str:
    return path.suffix.lower().lstrip(".")
