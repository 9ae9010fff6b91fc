"""Whether and how a robot is simulated, as far as its own files show."""

from __future__ import annotations

import re

from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import MODEL_FILE, name_other_models_only

# Elements of a robot that only simulators read.
_ELEMENTS = ("gazebo", "mujoco")
# Hardware of ros2_control that a simulator provides.
_HARDWARE = re.compile(r"gazebo|gz_|ign_|mujoco|isaac", re.IGNORECASE)
# Packages, plugins and programs of simulators, as manifests, launch files and scripts name them.
SIMULATOR = re.compile(
    r"gazebo_ros|gazebo_plugins|gazebo_msgs|ros_gz|ros_ign|gz_sim|gz_ros2_control|ign_ros2_control|gzserver"
    r"|mujoco|pybullet|pydrake|isaac(?:sim|lab|gym|_)|webots|coppelia|raisim",
    re.IGNORECASE,
)
# Gazebo of either kind, as they name it; MoveIt Servo has a setting `use_gazebo: false`.
GAZEBO = re.compile(r"gazebo(?!:\s*false)|ros_gz|ros_ign|gz_sim|gzserver")
_MJCF = re.compile(r"\s*(?:<\?xml[^>]*>\s*)?<mujoco\b")
# A model of MuJoCo's own, as launch files and scripts name it.
_SCENE = re.compile(r"(?<![\w-])(?!package\.)[\w-]+\.xml\b")


def is_simulated_hardware(control: Element) -> bool:
    """Whether a simulator provides the hardware of a ``<ros2_control>`` block."""
    return any(_HARDWARE.search(element.text) for element in control.walk() if element.tag == "plugin")


@fact
def is_simulated(model: Model) -> bool:
    """Whether the robot has elements for a simulator, or a file of the model's package, or of a package that depends on it,
    names one, and is not about other models only."""
    if has_elements(model):
        return True
    return any(map(SIMULATOR.search, list_project_texts(model))) and not is_left_aside(model)


@fact
def is_started_in_simulator(model: Model) -> bool:
    """Whether the robot has elements for a simulator, or one of these files names a simulator, the robot's own file and no other
    model: of two, one may be for display.

    Where the folder of that is typed before its name, it must be the robot's too.
    """
    path = model.source.path.absolute()
    own = re.compile(rf"(?<![\w.-])(?:{re.escape(path.parent.name)}/|(?<![\w.-]/)){re.escape(path.name)}(?![\w.-])")
    return has_elements(model) or any(
        path.name in text and own.search(text) and SIMULATOR.search(text) and not names_other_model(text, path.name)
        for text in list_project_texts(model)
    )


def names_other_model(text: str, own: str) -> bool:
    """Whether a text names another model file, or one of MuJoCo's own format beside MuJoCo."""
    if any(name != own for name in MODEL_FILE.findall(text)):
        return True
    return "mujoco" in text.lower() and _SCENE.search(text) is not None


def is_modelled_for_mujoco(model: Model) -> bool:
    """Whether a file of the project is a model of MuJoCo (MJCF) with all joints of the robot that move."""
    names = [joint.name for joint in model.joints if joint.is_movable]
    return any(
        _MJCF.match(text) and all(f'name="{name}"' in text for name in names) for text in list_project_texts(model)
    )


def has_elements(model: Model) -> bool:
    """Whether the robot has elements for a simulator."""
    return any(model.robot.find_child(tag) is not None for tag in _ELEMENTS) or any(
        map(is_simulated_hardware, model.robot.find_children("ros2_control"))
    )


def is_left_aside(model: Model) -> bool:
    """Whether files of the model's package, or of those that depend on it, name other models and not this one: a copy for
    display, or for other programs."""
    return name_other_models_only(list_project_texts(model), model.source.path.name)
