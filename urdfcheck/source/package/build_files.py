"""What a package's build installs, from the build file that its manifest calls for."""

from __future__ import annotations

from collections.abc import Callable

from urdfcheck.source.package.cmake_installs import parse_commands, read_cmake_installs
from urdfcheck.source.package.installed_files import InstalledFiles
from urdfcheck.source.package.setup_py_installs import read_setup_installs
from urdfcheck.source.text.python import parse_python
from urdfcheck.source.text.xml import Element

LARGEST_BUILD_FILE = 1_000_000


def read_build_type(root: Element | None) -> str:
    """Return the build type that a manifest exports: ament_cmake, ament_python …; empty without one."""
    export = None if root is None else root.find_child("export")
    types = [] if export is None else [e.text.strip() for e in export.find_children("build_type")]
    return types[0] if types else ""


def name_launch_command(root: Element | None) -> str:
    """Return the consumer that reads the launch files of a package with this manifest."""
    return "ros2_launch" if read_build_type(root).startswith("ament_") else "roslaunch"


def is_only_of_ros2(root: Element | None) -> bool:
    """Whether every build type that a manifest exports is one of ROS 2; a package of both has catkin's too."""
    export = None if root is None else root.find_child("export")
    types = [] if export is None else [e.text.strip() for e in export.find_children("build_type")]
    return bool(types) and all(name.startswith("ament_") for name in types)


def read_generation(root: Element | None) -> int | None:
    """Return the generation of ROS that a manifest is for: 1 or 2; None for one of both, or of neither."""
    if is_only_of_ros2(root):
        return 2
    tools = () if root is None else (*root.find_children("buildtool_depend"), *root.find_children("depend"))
    is_of_catkin = any(tool.text.strip() == "catkin" for tool in tools)
    return 1 if is_of_catkin and not read_build_type(root).startswith("ament_") else None


def read_installed_files(name: str, build: str, read_text: Callable[[str], str | None]) -> InstalledFiles | None:
    """Return what the build of a package installs into its share folder; None if no build file shows it.

    ``read_text``: returns the text of a file of the package, or None. A build type other than Python's is CMake's: catkin
    has none in its manifest.
    """
    text = read_text("setup.py" if build == "ament_python" else "CMakeLists.txt")
    if text is None:
        return None
    if build != "ament_python":
        return read_cmake_installs(list(parse_commands(text)), name, read_text)
    tree = parse_python(text)
    return None if tree is None else read_setup_installs(tree, name)
