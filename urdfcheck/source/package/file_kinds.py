"""The kind of a file by its name alone, in upper or lower case: model, mesh, launch file, semantic description."""

from __future__ import annotations

from pathlib import Path

MODEL_SUFFIXES = (".urdf", ".xacro")
# The names of files that are made for xacro. The launch files of ros2_control_demos hand it `robot.xacro.urdf`.
XACRO_SUFFIXES = (".xacro", ".xacro.urdf")
MESH_SUFFIXES = (".stl", ".dae", ".obj", ".ply", ".off", ".glb", ".gltf")
# The files in which a glTF mesh keeps its geometry.
BUFFER_SUFFIXES = (".bin",)
LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".launch.py", "_launch.xml", "_launch.py")
SRDF_SUFFIXES = (".srdf", ".srdf.xacro")
YAML_SUFFIXES = (".yaml", ".yml")
# The folders in which a package keeps its configurations.
CONFIG_FOLDERS = ("config", "params", "controllers", "control", "launch")
# What a model in another format is called, by the suffix of its file.
_OTHER_FORMATS = {
    ".sdf": "an SDF model",
    ".world": "a world for Gazebo (SDF)",
    ".mjcf": "a MuJoCo model (MJCF)",
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), "a USD model"),
}
# The same by the root element of an XML file.
FORMATS_BY_ROOT = {
    "sdf": "an SDF model",
    "gazebo": "an old SDF model",
    "mujoco": "a MuJoCo model",
    "mujocoinclude": "a part of a MuJoCo model",
    "COLLADA": "a COLLADA mesh",
    "launch": "a launch file",
    "package": "a package manifest",
    "html": "a web page",
    "svg": "a drawing",
    "Robot": "URDF with a capital letter: names in XML distinguish upper and lower case",
}


def is_model(path: Path) -> bool:
    """Whether a file is named like a robot model or a part of one (URDF, xacro), and not like a semantic description.

    ``config.json.urdf`` is the settings with which a program writes URDF, beside those for other formats.
    """
    name = path.name.lower()
    return name.endswith(MODEL_SUFFIXES) and not name.endswith(".json.urdf") and not is_srdf(path)


def is_xacro(path: Path) -> bool:
    """Whether a file is named like one that xacro expands."""
    return path.name.lower().endswith(XACRO_SUFFIXES)


def is_mesh(path: Path) -> bool:
    """Whether a file is named like a mesh."""
    return path.name.lower().endswith(MESH_SUFFIXES)


def is_buffer(path: Path) -> bool:
    """Whether a file is named like one in which a glTF mesh keeps its geometry."""
    return path.name.lower().endswith(BUFFER_SUFFIXES)


def is_srdf(path: Path) -> bool:
    """Whether a file is named like a semantic description."""
    return path.name.lower().endswith(SRDF_SUFFIXES)


def is_launch(path: Path) -> bool:
    """Whether a file is named like a launch file."""
    return path.name.lower().endswith(LAUNCH_SUFFIXES)


def is_yaml(path: Path) -> bool:
    """Whether a file is named like one in yaml."""
    return path.name.lower().endswith(YAML_SUFFIXES)


def find_other_format(path: Path) -> str | None:
    """Return what a model is whose name says that it is neither URDF nor xacro: ``an SDF model``; None for any other name."""
    return _OTHER_FORMATS.get(path.suffix.lower())
