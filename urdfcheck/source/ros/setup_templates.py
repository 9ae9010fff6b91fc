"""What MoveIt's setup assistant leaves out of the package.xml that it writes with its launch files."""

from __future__ import annotations

import re
from pathlib import Path

from urdfcheck.source.ros.srdf import SETUP_FILE
from urdfcheck.system.files import note_lookup, read_text_or_nothing

# The package of the model in the assistant's file.
_MODEL_PACKAGE = re.compile(r"(?mi)^ +urdf:[ \t]*\r?\n +package:[ \t]*[\"']?([\w.-]+)")

# The packages that the launch files of its templates name and that its package.xml does not, by the file. The last templates of
# ROS 1 and those before them were read: what the last ones declare was forgotten earlier, and is not listed.
_LEFT_OUT = {
    "default_warehouse_db.launch": {"moveit_ros_warehouse"},
    "gazebo.launch": {"controller_manager", "gazebo_ros"},
    "joystick_control.launch": {"joy"},
    "ros_controllers.launch": {"controller_manager"},
    "run_benchmark_ompl.launch": {"moveit_ros_benchmarks"},
    "run_benchmark_server_ompl.launch": {"moveit_ros_benchmarks"},
    "run_benchmark_trajopt.launch": {
        *("moveit_resources", "moveit_resources_panda_moveit_config", "moveit_ros_benchmarks", "panda_moveit_config"),
    },
    "warehouse.launch": {"warehouse_ros", "warehouse_ros_mongo"},
}


def is_left_out_by_template(name: str, file: Path, package: Path) -> bool:
    """Whether a file of a package is one that the setup assistant writes, and it leaves out the package that the file names.

    The launch files for Gazebo, the warehouse and benchmarks are there for those who want them and install what they need.
    """
    return name in _LEFT_OUT.get(file.name, ()) and _is_template(file, package)


def is_side_template(file: Path, package: Path) -> bool:
    """Whether a file of a package is one that the setup assistant writes for benchmarks or the warehouse: few robots use them."""
    is_for_few = "benchmark" in file.name or "warehouse" in file.name
    return is_for_few and file.name in _LEFT_OUT and _is_template(file, package)


def read_setup_package(package: Path) -> str:
    """Return the package from which the setup assistant took the model for a package; empty where it is unknown."""
    note_lookup(package / SETUP_FILE)
    model = _MODEL_PACKAGE.search(read_text_or_nothing(package / SETUP_FILE))
    return "" if model is None else model[1]


def _is_template(file: Path, package: Path) -> bool:
    if file.parent.name != "launch":
        return False
    note_lookup(package / SETUP_FILE)
    return (package / SETUP_FILE).is_file()
