"""Programs of a project, other than simulators, on which it depends how a part of its robot is read."""

from __future__ import annotations

import re
from collections.abc import Iterable

from urdfcheck.core.text import compile_names
from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.model.use.simulators import GAZEBO, has_elements
from urdfcheck.source.package.package_folders import drop_comments, read_package_texts
from urdfcheck.source.uses_elsewhere import CALLER_SUFFIXES, iter_project_files

# The packages of ros_control that read transmissions, in manifests, launch files and scripts.
_ROS_CONTROL = re.compile(
    r"gazebo_ros_control|hardware_interface|transmission_interface|controller_manager|ros_control"
)
# Programs that draw a COLLADA file as if it were in metres, in manifests and scripts.
_UNITLESS = re.compile(r"pinocchio|trimesh|yourdfpy|urdfpy|yourdf|mujoco|isaac|pydrake|\bdrake\b|newton", re.IGNORECASE)
_BULLET = re.compile(r"pybullet")
# Programs that check the inertia of each link by itself, or replace it, and do not know that a fixed joint hides what is wrong.
_LINKWISE = re.compile(r"mujoco|\bdrake\b|pydrake|pybullet|bullet3|isaac", re.IGNORECASE)
# What has Bullet read the inertias of a file, and other programs that read them.
_OTHER_INERTIA = re.compile(r"URDF_USE_INERTIA_FROM_FILE|gazebo|ros_gz|mujoco|pydrake|isaac|pinocchio", re.IGNORECASE)
# Programs other than Bullet that read URDF, and what has ROS read it; PyBullet itself has a parser of Gazebo's worlds.
_OTHER_READER = re.compile(
    r"gazebo(?!_world_parser)|ros_gz|gz_sim|gzserver|mujoco|drake|isaac|newton|genesis|sapien|webots|coppelia|raisim|pinocchio|crocoddyl|dartpy"
    r"|trimesh|yourdfpy|urdfpy|urdf_parser|kdl|moveit|rviz|robot_description|robot_state_publisher",
    re.IGNORECASE,
)
# Simulators, and a library of tasks for one, that read URDF by parsers of their own; and programs that read it by urdfdom, with
# what has ROS read it.
_OWN_PARSER = re.compile(r"isaac|legged_?gym|pybullet|mujoco|pydrake", re.IGNORECASE)
_URDFDOM = re.compile(
    r"gazebo|ros_gz|gz_sim|gzserver|pinocchio|crocoddyl|placo|dartpy|urdf_parser|kdl|moveit|rviz|robot_description"
    r"|robot_state_publisher",
    re.IGNORECASE,
)
# Programs that leave out a part of a lidar's scan, in manifests, launch files and their parameters.
_SCAN_FILTER = re.compile(r"laser_filter|scan_filter|scan_to_scan_filter|LaserScan\w*Filter")
# A program that adds a file to the robot that runs, as launch files name it: send_urdf_fragment.py of the arms of Rethink.
_FRAGMENT_PROGRAM = re.compile(r"(?<![\w.-])\w*urdf_fragment\w*(?:\.py)?")
# The variables by which the robots of Clearpath include a file of their user.
_EXTRAS = re.compile(r"\b[A-Z][A-Z0-9]*_URDF_EXTRAS\b")
# An argument of a launch file, where it is declared or handed on; its attributes; what reads one; and what loads a robot.
_ARGUMENT = re.compile(r"<arg\b[^<>]*>")
_ATTRIBUTES = re.compile(r"\b(\w+)\s*=\s*\"([^\"]*)\"")
_HANDED = re.compile(r"\$\(arg (\w+)\)")
_LOADING = re.compile(r"\b(?:command|textfile)\s*=\s*\"([^\"]*)\"")


def is_named_in_package(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, names the model's own file. True without a package."""
    own = compile_names((model.source.path.name,))
    return model.source.package is None or any(map(own.search, list_project_texts(model)))


def find_attaching_program(model: Model, links: Iterable[str]) -> str | None:
    """Return the program to which a file of the model's package, or of one that depends on it, hands the model's own file with
    the names of these links: one for fragments, which it attaches to a robot that runs. So does the variable of a robot that its
    comments name, or that such a file sets to it. None if there is none."""
    source = model.source
    file = source.files.get(source.name)
    own = compile_names((source.path.name,))
    texts = [text for text in list_project_texts(model) if own.search(text)]
    for text in (*(comment.text for comment in (() if file is None else file.comments)), *texts):
        variable = _EXTRAS.search(text)
        if variable is not None:
            return variable[0]
    names = [compile_names((name,)) for name in links]
    for text in texts:
        program = _FRAGMENT_PROGRAM.search(text)
        if program is not None and all(name.search(text) for name in names):
            return program[0]
    return None


def find_handing_argument(model: Model) -> str:
    """Return the argument with which the launch files that name the model's own file hand it to another launch file; empty if
    another text names it, or one here loads what it is given so."""
    own = compile_names((model.source.path.name,))
    texts = list_project_texts(model)
    loaded = {name for text in texts for command in _LOADING.findall(text) for name in _HANDED.findall(command)}
    found = ""
    for text in (text for text in texts if own.search(text)):
        arguments = [dict(_ATTRIBUTES.findall(tag)) for tag in _ARGUMENT.findall(text)]
        naming = [a for a in arguments if own.search(a.get("default", "") + " " + a.get("value", ""))]
        declared = {a.get("name", "") for a in naming if "default" in a}
        handed = [a for a in arguments if "value" in a and (a in naming or set(_HANDED.findall(a["value"])) & declared)]
        uses = sum(name in declared for name in _HANDED.findall(text))
        if not handed or len(naming) < len(own.findall(text)) or uses > len(handed):
            return ""
        if not loaded.isdisjoint({a.get("name", "") for a in handed} | declared):
            return ""
        found = found or handed[0].get("name", "")
    return found


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


@fact
def is_merged_wherever_loaded(model: Model) -> bool:
    """Whether the robot is for Gazebo, as its elements or a file of its package, or of one that depends on it, say, and no file
    of the project, its README included, names a program that checks the inertia of each link by itself."""
    robot = model.robot
    is_for_gazebo = robot.find_child("gazebo") is not None or any(map(GAZEBO.search, list_project_texts(model)))
    if not is_for_gazebo or robot.find_child("mujoco") is not None:
        return False
    texts = iter_project_files(model.source, (*CALLER_SUFFIXES, "package.xml", ".md"))
    return not any(_LINKWISE.search(drop_comments(text)) for _, text in texts)


def is_weighed_by_bullet(model: Model) -> bool:
    """Whether all files that name the model's own file load it into PyBullet, and none says to read the inertias of the file:
    then Bullet computes them from the collision shapes."""
    naming = _list_naming_texts(model)
    return bool(naming) and all(_BULLET.search(text) and not _OTHER_INERTIA.search(text) for text in naming)


def is_only_for_bullet(model: Model) -> bool:
    """Whether a file that names the model's own file loads it into PyBullet, none of them names another program that reads URDF,
    and the robot has no elements for one. Files that name no program may install the model, or hold its path for a script."""
    if has_elements(model):
        return False
    naming = _list_naming_texts(model)
    return any(map(_BULLET.search, naming)) and not any(map(_OTHER_READER.search, naming))


@fact
def is_read_without_urdfdom(model: Model) -> bool:
    """Whether a file of the project loads the model into a simulator that has its own parser, and none that names the model
    names a program that reads it by urdfdom. False in a package of ROS, and for a robot with elements for a simulator.

    A model that no file names is read as the others of its folder are.
    """
    path = model.source.path.absolute()
    if model.source.package is not None or has_elements(model):
        return False
    texts = [drop_comments(text) for _, text in iter_project_files(model.source, CALLER_SUFFIXES)]
    folder = re.escape("/".join(path.parts[-3:-1]))
    beside = re.compile(rf"(?<![\w.-]){folder}/[\w.-]+\.(?:urdf|xacro)\b")
    named = (list(filter(name.search, texts)) for name in (compile_names((path.name,)), beside))
    naming = next(filter(None, named), [])
    return any(map(_OWN_PARSER.search, naming)) and not any(map(_URDFDOM.search, naming))


def _list_naming_texts(model: Model) -> list[str]:
    """List the texts around the model that name its own file."""
    own = compile_names((model.source.path.name,))
    return [text for text in _list_texts_around(model) if own.search(text)]


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
