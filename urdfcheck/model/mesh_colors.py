"""The colours in which the file of a mesh is drawn. Those of OBJ are in other files, which are read only where a robot is drawn.

What holds for a mesh file holds for them: its reach, and a limit of their size.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.files import read_text_or_nothing

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices
    from urdfcheck.facts.mesh.formats.collada import Color
    from urdfcheck.facts.mesh.measure import MeshFacts

# Bytes of a material library. Those of robots have some hundred.
MAX_LIBRARY = 1024**2


def find_mesh_colors(path: Path, facts: MeshFacts, finder: PackageFinder) -> tuple[Indices, Array] | None:
    """Find what `MeshFacts.colors` says, for OBJ by the material libraries that it names; None if there are no colours."""
    import numpy as np

    materials = facts.materials
    if materials is None:
        return facts.colors
    known: dict[str, Color | None] = {}
    for library in _iter_libraries(materials.libraries, path, finder):
        known = {**library, **known}
    named = [known.get(name) for name in materials.names]
    if not any(named):
        return None
    rgba = np.array([color or (0.0, 0.0, 0.0, 0.0) for color in named])
    number = np.array([-1 if color is None else i for i, color in enumerate(named)] + [-1])
    return number[materials.of_face], rgba


def _iter_libraries(names: tuple[str, ...], document: Path, finder: PackageFinder) -> Iterator[dict[str, Color | None]]:
    """Yield the colours of each library that exists and may be opened, once in whatever spellings it is named."""
    from urdfcheck.facts.mesh.formats.obj_materials import parse_material_library

    seen: set[Path] = set()
    for line in names:
        # One file whose name has blanks, or several files.
        for name in dict.fromkeys((line, *line.split())):
            resource = finder.resolve_resource(name, document.parent)
            if resource.path is None or not resource.exists or not resource.allowed:
                continue
            path = resource.path.resolve()
            if path not in seen:
                seen.add(path)
                yield parse_material_library(read_text_or_nothing(resource.path, MAX_LIBRARY))
