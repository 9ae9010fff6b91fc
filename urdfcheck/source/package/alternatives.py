"""Packages of which a user needs one: those of one choice that a launch argument or the ROS distribution makes."""

from __future__ import annotations

import fnmatch
import os
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.references import PackageMention

# Gazebo Classic and its successor: no ROS distribution since Jazzy has both.
_CLASSIC = frozenset({"gazebo_plugins", "gazebo_ros", "gazebo_ros2_control", "gazebo_ros_control", "gazebo_ros_pkgs"})
_SUCCESSOR = frozenset(
    {
        "gz_ros2_control",
        "ign_ros2_control",
        "ros_gz",
        "ros_gz_bridge",
        "ros_gz_sim",
        "ros_ign",
        "ros_ign_bridge",
        "ros_ign_gazebo",
    }
)
_SUBSTITUTION = re.compile(r"\$\([^()]*\)")
_LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".launch.py")
# A computed name leads to a choice if it fits so many files.
_FEWEST = 2


def select_alternatives(
    package: Package, mentions: Iterable[PackageMention], missing: Mapping[str, Sequence[PackageMention]]
) -> list[str]:
    """Select the packages in ``missing`` that only one choice of several needs.

    Of these are the two generations of Gazebo, each started by its own launch file, and the drivers in launch files of which one
    is included by a computed name (`$(env LIDAR).launch`).

    :param mentions: all packages that the files of ``package`` name.
    :param missing: mentions of the packages that are not declared, by name.
    """
    launched = {name: files for name, uses in missing.items() if (files := _list_launch_files(package, uses))}
    used = launched.keys() | package.dependencies
    simulators = _CLASSIC | _SUCCESSOR if used & _CLASSIC and used & _SUCCESSOR else frozenset()
    chosen = _list_chosen_files(package, mentions, {file for files in launched.values() for file in files})
    return [name for name, files in launched.items() if name in simulators or chosen.issuperset(files)]


def _list_launch_files(package: Package, uses: Iterable[PackageMention]) -> list[str]:
    """Return the files of these mentions by their path in the package, if all are launch files; else nothing."""
    own = package.path.absolute()
    files = [Path(os.path.abspath(use.location.span.file)) for use in uses if use.location.span is not None]
    if not all(file.is_relative_to(own) and file.name.endswith(_LAUNCH_SUFFIXES) for file in files):
        return []
    return [file.relative_to(own).as_posix() for file in files]


def _list_chosen_files(package: Package, mentions: Iterable[PackageMention], files: Collection[str]) -> set[str]:
    """Return those of the launch files that a computed name leads to, if it leads to others too."""
    names = {
        mention.subpath.strip("/")
        for mention in mentions
        if mention.package == package.name and mention.subpath.endswith(_LAUNCH_SUFFIXES)
    }
    chosen: set[str] = set()
    for pattern in {_SUBSTITUTION.sub("*", name) for name in names if "$(" in name.rpartition("/")[2]}:
        folder = package.path / pattern.rpartition("/")[0]
        if "*" in str(folder) or not folder.is_dir():
            continue
        fitting = fnmatch.filter(os.listdir(folder), pattern.rpartition("/")[2])
        if len(fitting) >= _FEWEST:
            chosen.update(fnmatch.filter(files, pattern))
    return chosen
