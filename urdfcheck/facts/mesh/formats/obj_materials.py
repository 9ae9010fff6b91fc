"""The materials of OBJ: which faces have which, by name, and the colours that a material library (.mtl) gives to the names.

Wavefront, *Object Files* and *MTL material format*, Alias|Wavefront 1995. Of a material, the diffuse colour (``Kd``) and how
solid it is (``d``, or ``Tr``) are read. A material with an image has no colour here: images are not read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Bools, Indices
    from urdfcheck.facts.mesh.formats.collada import Color
    from urdfcheck.facts.mesh.formats.number_text import TokenizedText

# More changes of the material are not followed: exporters write one for each group of faces.
_MOST_CHANGES = 100_000
# Libraries of one file that are named.
_MOST_LIBRARIES = 16
# Characters of a name that count.
_LONGEST_NAME = 200


@dataclass(frozen=True, slots=True)
class ObjMaterials:
    """The materials that the faces of a file have."""

    runs: tuple[tuple[int, str | None], ...]
    """Numbers of triangles in turn, with the name of their material; None before the first."""
    libraries: tuple[str, ...]
    """The files that describe them, as written: each line as a whole, as a name may have blanks."""


def read_obj_materials(text: TokenizedText, starts: Indices, counts: Indices, is_face: Bools) -> ObjMaterials | None:
    """Read the materials of an OBJ file; None if it names none, or no library.

    ``starts`` and ``counts`` (n,): the first token of each line and how many follow; ``is_face``: which lines are faces.
    """
    uses = np.flatnonzero(text.match_word(b"usemtl", starts))
    named = np.flatnonzero(text.match_word(b"mtllib", starts))[:_MOST_LIBRARIES]
    if not len(uses) or not len(named) or len(uses) > _MOST_CHANGES:
        return None
    before = np.concatenate(((0,), np.cumsum(np.where(is_face, counts - 2, 0))))
    ends = np.append(before[uses], before[-1])
    names = [None, *(_read_rest(text, starts[line], counts[line]) for line in uses)]
    sizes = np.diff(ends, prepend=0)
    runs = tuple((int(size), name) for size, name in zip(sizes, names, strict=True) if size)
    return ObjMaterials(runs, tuple(_read_rest(text, starts[line], counts[line]) for line in named))


def _read_rest(text: TokenizedText, first: int, count: int) -> str:
    """Return what follows the keyword of a line."""
    words = (text.get_token(first + 1 + i)[:_LONGEST_NAME] for i in range(min(count, _LONGEST_NAME)))
    return _cut_name(b" ".join(words).decode("utf-8", "replace"))


def _cut_name(name: str) -> str:
    return name[:_LONGEST_NAME]


def parse_material_library(text: str) -> dict[str, Color | None]:
    """Return the r g b a (0 to 1) of the materials of a library by name; None for one without a colour, and for an image."""
    colors: dict[str, Color | None] = {}
    name, red_green_blue, alpha, has_image = None, None, 1.0, False

    def close() -> None:
        if name is not None:
            colors.setdefault(name, None if has_image or red_green_blue is None else (*red_green_blue, alpha or 1.0))

    for line in text.splitlines():
        key, *values = line.partition("#")[0].split() or ("",)
        match key.lower():
            case "newmtl":
                close()
                name, red_green_blue, alpha, has_image = _cut_name(" ".join(values)), None, 1.0, False
            case "kd":
                red_green_blue = _parse_color(values)
            case "d":
                # A factor that depends on the view follows ``-halo``.
                alpha = _parse_share(values[-1:], alpha)
            case "tr":
                alpha = 1.0 - _parse_share(values, 1.0 - alpha)
            case "map_kd":
                has_image = True
    close()
    return colors


def _parse_color(values: list[str]) -> tuple[float, float, float] | None:
    """Return the colour of one number for all three parts, or of three; None for a spectrum and for what is no colour."""
    try:
        parts = [float(value) for value in values]
    except ValueError:
        return None
    parts = parts * 3 if len(parts) == 1 else parts
    if len(parts) != 3 or not all(0.0 <= part <= 1.0 for part in parts):
        return None
    red, green, blue = parts
    return red, green, blue


def _parse_share(values: list[str], default: float) -> float:
    try:
        share = float(values[0])
    except (IndexError, ValueError):
        return default
    return share if 0.0 <= share <= 1.0 else default
