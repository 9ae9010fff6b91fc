"""GZB007 reports launch files that spawn meshes by `package://` in a Gazebo that is not told where the packages are."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.nodes_python import read_python_actions
from urdfcheck.source.launch.nodes_xml import LaunchAction, LaunchContents, read_launch_actions
from urdfcheck.source.package.finder import Package, PackageFinder
from urdfcheck.source.package.package_folders import read_package_texts
from urdfcheck.source.ros.gazebo_paths import RESOURCE_PATH
from urdfcheck.source.ros.srdf import has_dependency
from urdfcheck.source.text.xml import Attribute

# Whatever leads Gazebo to a package: an export, an environment hook or a variable that a launch file sets; or it replaces the
# paths itself.
_PATH = re.compile(rf"{RESOURCE_PATH.pattern}|package://")
# A variant of the robot whose meshes are given by folders, or a folder that the launch file may pass.
_OTHER_ROOT = re.compile(r"file://\$|<xacro:arg\b[^>]*=\s*[\"']package://")
_SPAWNERS = frozenset({("ros_gz_sim", "create"), ("ros_ign_gazebo", "create"), ("gazebo_ros", "spawn_entity.py")})
# These read the exports of all packages and set the variable of Gazebo.
_SIMULATORS = {
    "ros_gz_sim": re.compile(r"gz_sim\.launch\.py|gz_server\.launch\.py"),
    "ros_ign_gazebo": re.compile(r"ign_gazebo\.launch\.py"),
    "gazebo_ros": re.compile(r"(?:gazebo|gzserver)\.launch\.py"),
}


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch, model = context.launch, context.model
    if model is None or launch.dialect == "ros1":
        return
    meshes = {
        name: attribute
        for link in model.links
        for shape in (*link.visuals, *link.collisions)
        if (attribute := shape.mesh_filename) is not None and (name := _read_package(attribute))
    }
    if any(_OTHER_ROOT.search(file.text) for file in model.source.files.values()):
        return  # what the launch file passes to xacro decides
    if not meshes or not _starts_gazebo(contents := _read_actions(launch)):
        return
    finder = launch.finder
    found = [package for name in meshes if (package := _load_package(finder, name)) is not None]
    if len(found) < len(meshes):
        return  # a package that is not here may have what it needs
    packages = {package.path for package in (*found, launch.package, model.package) if package is not None}
    # What starts the robot may be elsewhere, and sets the variable for it.
    packages.update(
        path for path in finder.list_workspace_packages().values() if any(has_dependency(path, name) for name in meshes)
    )
    if any(_PATH.search(text) for path in sorted(packages) for text in read_package_texts(path, finder.can_open)):
        return
    spawner = next(node for node in contents.nodes if (node.package, node.program) in _SPAWNERS and not node.off)
    first = next(iter(meshes))
    yield rule.finding(
        "absent",
        at=Location("launch", spawner.spans[0]),
        related=[meshes[first]],
        packages=join_names(meshes),
        which="package" if len(meshes) == 1 else "packages",
        package=first,
        spawner=spawner.program,
    )


def _read_package(attribute: Attribute) -> str:
    scheme, _, rest = attribute.value.strip().partition("://")
    return rest.partition("/")[0] if scheme == "package" else ""


def _read_actions(launch: Launch) -> LaunchContents:
    return read_launch_actions(launch) if launch.python is None else read_python_actions(launch)


def _starts_gazebo(contents: LaunchContents) -> bool:
    """Whether one launch file starts Gazebo and spawns the robot: only then are its variables those of Gazebo."""
    nodes = [node for node in contents.nodes if not node.off]
    spawns = any((node.package, node.program) in _SPAWNERS and node.spans for node in nodes)
    others = [node for node in nodes if node.kind == "launch file" and not _is_simulator(node)]
    return spawns and any(map(_is_simulator, nodes)) and not others


def _is_simulator(node: LaunchAction) -> bool:
    pattern = _SIMULATORS.get(node.package)
    return node.kind == "launch file" and pattern is not None and pattern.search(node.program) is not None


def _load_package(finder: PackageFinder, name: str) -> Package | None:
    folder = finder.find(name)
    return None if folder is None else finder.find_package_of(folder / "package.xml")
