"""Programs of a project, other than simulators, on which it depends how a part of its robot is read."""

from __future__ import annotations

import re
from collections.abc import Iterable

from urdfcheck.core.text import compile_names
from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.source.package.package_folders import drop_comments, read_package_texts

# The packages of ros_control that read transmissions, in manifests, launch files and scripts.
_ROS_CONTROL = re.compile(
    r"gazebo_ros_control|hardware_interface|transmission_interface|controller_manager|ros_control"
)
# Programs that draw a COLLADA file as if it were in metres, in manifests and scripts.
_UNITLESS = re.compile(r"pinocchio|trimesh|yourdfpy|urdfpy|yourdf|mujoco|isaac|pydrake|\bdrake\b|newton", re.IGNORECASE)
_BULLET = re.compile(r"pybullet")
# What has Bullet read the inertias of a file, and other programs that read them.
_OTHER_INERTIA = re.compile(r"URDF_USE_INERTIA_FROM_FILE|gazebo|ros_gz|mujoco|pydrake|isaac|pinocchio", re.IGNORECASE)
# Programs that leave out a part of a lidar's scan, in manifests, launch files and their parameters.
_SCAN_FILTER = re.compile(r"laser_filter|scan_filter|scan_to_scan_filter|LaserScan\w*Filter")
# A program that adds a file to the robot that runs, as launch files name it: send_urdf_fragment.py of the arms of Rethink.
_FRAGMENT_PROGRAM = re.compile(r"(?<![\w.-])\w*urdf_fragment\w*(?:\.py)?")


def is_named_in_package(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, names the model's own file. True without a package."""
    own = compile_names((model.source.path.name,))
    return model.source.package is None or any(map(own.search, list_project_texts(model)))


def find_attaching_program(model: Model, links: Iterable[str]) -> str | None:
    """Return the program to which a file of the model's package, or of one that depends on it, hands the model's own file with
    the names of these links: one for fragments, which it attaches to a robot that runs. None if there is none."""
    names = [compile_names((name,)) for name in (model.source.path.name, *links)]
    for text in list_project_texts(model):
        program = _FRAGMENT_PROGRAM.search(text)
        if program is not None and all(name.search(text) for name in names):
            return program[0]
    return None


def names_unitless_program(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names a program that ignores the unit of a
    COLLADA file. True where the model has no package."""
    return model.source.package is None or any(map(_UNITLESS.search, list_project_texts(model)))


def names_ros_control(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names what reads transmissions."""
    return any(map(_ROS_CONTROL.search, list_project_texts(model)))


def names_bullet(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, names PyBullet; without a package, one of the
    project."""
    return any(map(_BULLET.search, _list_texts_around(model)))


def is_weighed_by_bullet(model: Model) -> bool:
    """Whether all files that name the model's own file load it into PyBullet, and none says to read the inertias of the file:
    then Bullet computes them from the collision shapes."""
    own = compile_names((model.source.path.name,))
    naming = [text for text in _list_texts_around(model) if own.search(text)]
    return bool(naming) and all(_BULLET.search(text) and not _OTHER_INERTIA.search(text) for text in naming)


@fact
def _list_texts_around(model: Model) -> tuple[str, ...]:
    """List the texts of the model's package and of those that depend on it; without a package, those of the project."""
    source = model.source
    project = None if source.package is not None else source.finder.find_project_above(source.path.absolute())
    around = () if project is None else read_package_texts(project, source.finder.can_open)
    return (*list_project_texts(model), *map(drop_comments, around))


def names_scan_filter(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names a filter of a lidar's scan."""
    return any(map(_SCAN_FILTER.search, list_project_texts(model)))
