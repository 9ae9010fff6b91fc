"""The kind of a file by its name alone: mesh, launch file, semantic description."""

from __future__ import annotations

from pathlib import Path

MESH_SUFFIXES = (".stl", ".dae", ".obj", ".ply", ".off", ".glb", ".gltf")
LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".launch.py", "_launch.xml", "_launch.py")
SRDF_SUFFIXES = (".srdf", ".srdf.xacro")
# The folders in which a package keeps its configurations.
CONFIG_FOLDERS = ("config", "params", "controllers", "control", "launch")


def is_srdf(path: Path) -> bool:
    """Whether a file is named like a semantic description."""
    return path.name.endswith(SRDF_SUFFIXES)


def is_launch(path: Path) -> bool:
    """Whether a file is named like a launch file."""
    return path.name.endswith(LAUNCH_SUFFIXES)
