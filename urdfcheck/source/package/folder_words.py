"""What the names of folders say about the files in them."""

from __future__ import annotations

import os
import re
from pathlib import Path

# What folders of meshes are called, whatever the robot is.
_FOLDER_WORDS = frozenset({
    *("3d", "assets", "backup", "bin", "binary", "cad", "col", "collada", "collision", "collisions", "coarse", "convex", "dae"),
    *("description", "fine", "full", "glb", "high", "hull", "low", "lowpoly", "media", "mesh", "meshes", "model", "models"),
    *("new", "obj", "old", "original", "ply", "poly", "res", "resources", "robot", "robots", "share", "simple", "simplified"),
    *("src", "step", "stl", "stls", "textures", "urdf", "vis", "visual", "visuals"),
})  # fmt: skip


def is_in_folder_of_another(path: Path, other: Path) -> bool:
    """Whether a file is in a folder that is neither on the way to a missing one nor named after what it holds.

    ``gripper/base.stl`` is not the ``base.stl`` of an arm; ``visual/base.stl`` may be.
    """
    path, other = path.absolute(), other.absolute()
    common = Path(os.path.commonpath([path, other]))
    names = {word for part in path.parts for word in split_folder_words(part)}
    return any(not split_folder_words(part) <= names | _FOLDER_WORDS for part in other.parent.relative_to(common).parts)


def split_folder_words(name: str) -> set[str]:
    """Return the words of a folder's name in lower case."""
    return {word for word in re.split(r"[^a-z0-9]+", name.lower()) if word}
