"""The meshes of a model: each use resolved to a file, each content read once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.model.parts import Link, Shape
from urdfcheck.source.load import Source
from urdfcheck.source.packages import Resource
from urdfcheck.source.xml import Attribute

if TYPE_CHECKING:
    from urdfcheck.facts.mesh import MeshError, MeshFacts


@dataclass(frozen=True, slots=True, eq=False)
class MeshUse:
    """One ``<mesh filename=…>`` of a shape, and the file it means."""

    link: Link
    shape: Shape
    filename: Attribute
    resource: Resource


@dataclass(frozen=True, slots=True, eq=False)
class Meshes:
    """``uses`` in document order; ``facts`` and ``errors`` by file, empty in the source tier."""

    uses: tuple[MeshUse, ...]
    facts: Mapping[Path, MeshFacts]
    errors: Mapping[Path, MeshError]
    by_shape: Mapping[int, MeshUse]

    @classmethod
    def of(cls, links: Sequence[Link], source: Source, *, read: bool) -> Meshes:
        """Resolve the meshes of all links; with ``read``, read every file that exists."""
        uses: list[MeshUse] = []
        for link in links:
            for shape in (*link.visuals, *link.collisions):
                filename = shape.mesh
                if filename is not None:
                    uses.append(
                        MeshUse(link, shape, filename, source.finder.resolve(filename.value, source.path.parent))
                    )
        facts: dict[Path, MeshFacts] = {}
        errors: dict[Path, MeshError] = {}
        if read:
            _read_all({u.resource.path for u in uses if u.resource.exists and u.resource.path}, facts, errors)
        return cls(tuple(uses), facts, errors, {id(u.shape): u for u in uses})

    def facts_of(self, shape: Shape) -> MeshFacts | None:
        """The facts of a shape's mesh; None when it is no mesh, is missing or could not be read."""
        use = self.by_shape.get(id(shape))
        return None if use is None or use.resource.path is None else self.facts.get(use.resource.path)

    def by_file(self) -> Mapping[Path, tuple[MeshUse, ...]]:
        """The uses of each file that exists; those for collision first, otherwise in document order."""
        found: dict[Path, list[MeshUse]] = {}
        for use in self.uses:
            if use.resource.exists and use.resource.path is not None:
                found.setdefault(use.resource.path, []).append(use)
        return {path: tuple(sorted(uses, key=lambda u: u.shape.role != "collision")) for path, uses in found.items()}


def _read_all(paths: set[Path], facts: dict[Path, MeshFacts], errors: dict[Path, MeshError]) -> None:
    from urdfcheck.facts.mesh import MeshError, mesh_facts

    by_content: dict[tuple[str, bytes], MeshFacts | MeshError] = {}
    for path in sorted(paths):
        kind = path.suffix.lower().lstrip(".")
        try:
            key = (kind, path.read_bytes())
        except OSError as error:
            errors[path] = MeshError("unreadable", error.strerror or str(error))
            continue
        if key not in by_content:
            try:
                by_content[key] = mesh_facts(key[1], kind)
            except MeshError as error:
                by_content[key] = error
        known = by_content[key]
        if isinstance(known, MeshError):
            errors[path] = known
        else:
            facts[path] = known
