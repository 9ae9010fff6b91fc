"""The meshes of a model: each use resolved to a file, each content read once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.model.parts import Link, Shape
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Resource
from urdfcheck.source.text.xml import Attribute
from urdfcheck.system.array_cache import ArrayCache, compute_code_version, find_library_origin
from urdfcheck.system.files import MAX_MESH, FileTooLargeError, read_regular

if TYPE_CHECKING:
    from urdfcheck.facts.mesh.decode_limits import MeshError
    from urdfcheck.facts.mesh.measure import MeshFacts
    from urdfcheck.system.array_cache import Entry

# What the measurements of a mesh depend on besides its content.
MEASURING_MODULES = ("urdfcheck.facts.mesh",)
# The libraries that read the formats that urdfcheck does not read itself.
READERS = {"dae": "collada", "ply": "trimesh"}


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
    """SHA-256 of the content, by file."""
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
        return meshes._read_files(cache) if read and meshes.group_by_file() else meshes

    def get_facts(self, shape: Shape) -> MeshFacts | None:
        """Return the facts of a shape's mesh; None when it is not a mesh, is missing or could not be read."""
        use = self.by_shape.get(id(shape))
        return None if use is None or use.resource.path is None else self.facts.get(use.resource.path)

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

    def _read_files(self, cache: ArrayCache) -> ModelMeshes:
        from urdfcheck.facts.mesh.decode_limits import MeshError
        from urdfcheck.facts.mesh.measure import restore_mesh_facts

        facts: dict[Path, MeshFacts] = {}
        errors: dict[Path, MeshError] = {}
        digests: dict[Path, str] = {}
        by_content: dict[str, MeshFacts | MeshError] = {}
        for path in sorted(self.group_by_file()):
            kind = _get_file_kind(path)
            try:
                digests[path], data = cache.compute_digest(path)
                key = f"{digests[path]}-{kind}-{_compute_reader_version(kind)}"
                if key not in by_content:
                    parts = cache.entry("meshes", key)
                    known = restore_mesh_facts(parts, remeasure=partial(_measure_mesh, path, parts))
                    by_content[key] = known or _measure_mesh(path, parts, data)
            except MeshError as error:
                by_content[key] = error
            except (OSError, ImportError, MemoryError) as error:
                errors[path] = _make_mesh_error(error)
                continue
            result = by_content[key]
            if isinstance(result, MeshError):
                errors[path] = result
            else:
                facts[path] = result
        return replace(self, facts=facts, errors=errors, digests=digests)


def _measure_mesh(path: Path, parts: Entry, data: bytes | None = None) -> MeshFacts:
    from urdfcheck.facts.mesh.measure import measure_mesh

    return measure_mesh(read_regular(path, MAX_MESH) if data is None else data, _get_file_kind(path), parts)


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
    reader = READERS.get(kind)
    return compute_code_version(*MEASURING_MODULES, library=reader and find_library_origin(reader))


def _get_file_kind(path: Path) -> str:
    return path.suffix.lower().lstrip(".")
