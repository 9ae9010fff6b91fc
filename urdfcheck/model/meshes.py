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
    from urdfcheck.facts.mesh.measure import MeshError, MeshFacts
    from urdfcheck.system.array_cache import Entry

# What the measurements of a mesh depend on beside its content.
MEASURING_MODULES = ("urdfcheck.facts.mesh",)
# The libraries that read what is not read by our own.
READERS = {"dae": "collada", "ply": "trimesh"}


@dataclass(frozen=True, slots=True, eq=False)
class MeshUse:
    """One ``<mesh filename=…>`` of a shape, and the file it means."""

    link: Link
    shape: Shape
    filename: Attribute
    resource: Resource

    @property
    def name(self) -> str:
        """The file's name without its folders."""
        return self.filename.value.rpartition("/")[2]


@dataclass(frozen=True, slots=True, eq=False)
class ModelMeshes:
    """``uses`` in document order; ``facts``, ``errors`` and ``digests`` of the content by file, empty in the source tier."""

    uses: tuple[MeshUse, ...]
    facts: Mapping[Path, MeshFacts]
    errors: Mapping[Path, MeshError]
    digests: Mapping[Path, str]
    by_shape: Mapping[int, MeshUse]

    @classmethod
    def from_links(cls, links: Sequence[Link], source: Source, cache: ArrayCache, *, read: bool) -> ModelMeshes:
        """Resolve the meshes of all links; with ``read``, measure every file that exists, or recall what was measured."""
        uses: list[MeshUse] = []
        for link in links:
            for shape in (*link.visuals, *link.collisions):
                filename = shape.mesh_filename
                if filename is not None:
                    uses.append(
                        MeshUse(
                            link, shape, filename, source.finder.resolve_resource(filename.value, source.path.parent)
                        )
                    )
        found = cls(tuple(uses), {}, {}, {}, {id(u.shape): u for u in uses})
        return found._read_files(cache) if read and found.group_by_file() else found

    def get_facts(self, shape: Shape) -> MeshFacts | None:
        """The facts of a shape's mesh; None when it is no mesh, is missing or could not be read."""
        use = self.by_shape.get(id(shape))
        return None if use is None or use.resource.path is None else self.facts.get(use.resource.path)

    def group_by_file(self) -> Mapping[Path, tuple[MeshUse, ...]]:
        """The uses of each file that exists; those for collision first, otherwise in document order."""
        found: dict[Path, list[MeshUse]] = {}
        for use in self.uses:
            if use.resource.exists and use.resource.path is not None:
                found.setdefault(use.resource.path, []).append(use)
        return {path: tuple(sorted(uses, key=lambda u: u.shape.role != "collision")) for path, uses in found.items()}

    def list_measured(self) -> Iterator[tuple[tuple[MeshUse, ...], MeshFacts]]:
        """The uses, as in :meth:`group_by_file`, and the facts of each file that could be read."""
        for path, uses in self.group_by_file().items():
            facts = self.facts.get(path)
            if facts is not None:
                yield uses, facts

    def compute_content_key(self, path: Path) -> str | None:
        """What identifies a file's content and how it is read; None for a file that could not be opened."""
        digest = self.digests.get(path)
        return None if digest is None else f"{digest}-{_get_file_kind(path)}"

    def _read_files(self, cache: ArrayCache) -> ModelMeshes:
        from urdfcheck.facts.mesh.measure import MeshError, restore_mesh_facts

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
            found = by_content[key]
            if isinstance(found, MeshError):
                errors[path] = found
            else:
                facts[path] = found
        return replace(self, facts=facts, errors=errors, digests=digests)


def _measure_mesh(path: Path, parts: Entry, data: bytes | None = None) -> MeshFacts:
    from urdfcheck.facts.mesh.measure import measure_mesh

    return measure_mesh(read_regular(path, MAX_MESH) if data is None else data, _get_file_kind(path), parts)


def _make_mesh_error(error: OSError | ImportError | MemoryError) -> MeshError:
    """Why a file could not even be looked at; nothing that another run must find as well."""
    from urdfcheck.facts.mesh.measure import MeshError

    if isinstance(error, FileTooLargeError):
        return MeshError("too-large", error.message.removeprefix("the file "))
    if isinstance(error, OSError):
        return MeshError("unreadable", error.strerror or str(error))
    if isinstance(error, ImportError):
        return MeshError("unsupported", f"cannot be read here: {error.name} is not installed")
    return MeshError("too-large", "does not fit into the memory that the check of one model may take")


def _compute_reader_version(kind: str) -> str:
    """A digest of what decides about the measurements of a file of this kind beside its content."""
    reader = READERS.get(kind)
    return compute_code_version(*MEASURING_MODULES, library=reader and find_library_origin(reader))


def _get_file_kind(path: Path) -> str:
    return path.suffix.lower().lstrip(".")
