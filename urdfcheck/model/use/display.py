"""Whether a robot is only drawn, or its frames published, so that nothing reads its masses."""

from __future__ import annotations

import re
from dataclasses import replace

from urdfcheck.core import FactUnavailableError, Finding, Severity
from urdfcheck.core.text import compile_names
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link
from urdfcheck.model.rigid_bodies import list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.model.use.simulators import GAZEBO, SIMULATOR, has_elements, is_simulated
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.source.uses_elsewhere import CALLER_SUFFIXES, MODEL_FILE, iter_project_files, read_includers

# Programs that compute with masses without being simulators, in launch files and scripts. KDL's kinematics for MoveIt do not.
_DYNAMICS = re.compile(
    r"pinocchio|rbdl|\bkdl(?!_kinematics)|drake|crocoddyl|inverse_dynamics|gravity|placo|mjcf", re.IGNORECASE
)
# Programs that check a robot for collisions with itself, in manifests, launch files and scripts.
_COLLISION_CHECKER = re.compile(r"moveit|pinocchio|\bfcl\b|hpp-?fcl|\bcoal\b|tesseract|\bompl\b|curobo", re.IGNORECASE)
# Elements and files of a robot for a simulator or for controllers, as a xacro file names them.
_CONTROLLED = re.compile(r"gazebo|mujoco|isaac|ros2_control|transmission")
# The program that publishes the frames of a robot and reads no mass.
_STATE_PUBLISHER = re.compile(r"\b(?:robot_state_publisher|state_publisher)\b")


def is_only_displayed(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, publishes the model's own file, and none names a
    simulator. False without a package."""
    texts = list_project_texts(model)
    if model.source.package is None or any(GAZEBO.search(text) or SIMULATOR.search(text) for text in texts):
        return False
    own = compile_names((model.source.path.name,))
    return any("robot_state_publisher" in text and own.search(text) for text in texts)


@fact
def has_bare_joints(model: Model) -> bool:
    """Whether no body that moves has an ``<inertial>`` or a ``<collision>``, and nothing simulates the robot. False where the
    tree is broken."""
    links = _list_moving_links(model)
    bare = not any(link.inertial is not None or link.collisions for link in links)
    return bool(links) and bare and not is_simulated(model)


def judge_as_drawing(model: Model, finding: Finding) -> Finding:
    """Make a finding about where parts are a note if a package only draws them (`has_bare_joints`): RViz alone shows it."""
    if model.source.package is None or not has_bare_joints(model):
        return finding
    effects = {program: effect for program, effect in finding.consequences.items() if program == "rviz"}
    return replace(finding, severity=min(finding.severity, Severity.INFO), consequences=effects)


def is_made_for_display(model: Model) -> bool:
    """Whether a robot is drawn, and its moving parts with it, but never simulated: then an inertial of its root is a dummy."""
    return has_bare_joints(model) and any(link.visuals for link in _list_moving_links(model))


@fact
def is_loaded_for_frames(model: Model) -> bool:
    """Whether the files that name the model's own one, or one that includes it, start a program that publishes its frames, and
    none that reads a mass; and no file gives whatever robot is loaded to one that does. The robot itself is for none either."""
    includers = read_includers(model.source)
    own = compile_names((model.source.path.name, *includers))
    texts = list_project_texts(model)
    # What includes it may make of the part a robot for a simulator.
    if any(_CONTROLLED.search(text) for text in includers.values()):
        return False
    naming = [text for text in texts if own.search(text) and text not in includers.values()]
    if not naming or not all(_STATE_PUBLISHER.search(text) and not _reads_masses(text) for text in naming):
        return False
    if any("robot_description" in text and not MODEL_FILE.search(text) and _reads_masses(text) for text in texts):
        return False
    return not any(model.robot.find_child(tag) is not None for tag in ("gazebo", "ros2_control", "transmission"))


def is_never_weighed(model: Model) -> bool:
    """Whether nothing that is known of a project reads the masses of the model: it is only displayed, or a file of its package,
    or of one that depends on it, names it, and none names a simulator or another program that reads them. Motion planning does
    not, nor do drives that follow positions."""
    if is_loaded_for_frames(model):
        return True
    own, texts = compile_names((model.source.path.name,)), list_project_texts(model)
    if model.source.package is None or has_elements(model) or not any(map(own.search, texts)):
        return False
    return not any(GAZEBO.search(text) or _reads_masses(text) for text in texts)


def _reads_masses(text: str) -> bool:
    return SIMULATOR.search(text) is not None or _DYNAMICS.search(text) is not None


def is_without_dynamics(model: Model) -> bool:
    """Whether no body that moves has an ``<inertial>``, and neither a simulator nor a program that checks for collisions is named
    in a file of the model's package, or of one that depends on it."""
    links = _list_moving_links(model)
    if not links or any(link.inertial is not None for link in links) or is_simulated(model):
        return False
    return not is_checked_for_collisions(model)


def is_checked_for_collisions(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, names a program that checks a robot for collisions
    with itself."""
    return any(map(_COLLISION_CHECKER.search, list_project_texts(model)))


def is_never_collided(model: Model) -> bool:
    """Whether a file of the project outside the model's package names that package, and no file of the project names a simulator
    or a program that checks for collisions. It is not known who uses a description alone."""
    package = model.source.package
    if package is None or is_simulated(model) or is_checked_for_collisions(model):
        return False
    own, is_used = compile_names((package.name,)), False
    for path, text in iter_project_files(model.source, (*CALLER_SUFFIXES, "package.xml")):
        told = drop_comments(text)
        if GAZEBO.search(told) or SIMULATOR.search(told) or _COLLISION_CHECKER.search(told):
            return False
        is_used |= package.path not in path.parents and own.search(told) is not None
    return is_used


def _list_moving_links(model: Model) -> list[Link]:
    try:
        moving = [body for body in list_rigid_bodies(model) if body.is_movable]
    except FactUnavailableError:
        return []
    return [model.link_by_name[name] for body in moving for name in body.links]
