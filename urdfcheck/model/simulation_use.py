"""Whether a robot is simulated, as far as its own files show."""

from __future__ import annotations

import re
from collections.abc import Iterable

from urdfcheck.core import FactUnavailableError
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link
from urdfcheck.model.rigid_bodies import list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import MODEL_FILE, name_other_models_only, read_includers, read_project_texts
from urdfcheck.source.xacro.usage import ARGUMENT, find_expression_names, iter_elements_by_tag, strip_namespace

# Elements of a robot that only simulators read.
_ELEMENTS = ("gazebo", "mujoco")
# Hardware of ros2_control that a simulator provides.
_HARDWARE = re.compile(r"gazebo|gz_|ign_|mujoco|isaac", re.IGNORECASE)
# Packages, plugins and programs of simulators, as manifests, launch files and scripts name them.
_SIMULATOR = re.compile(
    r"gazebo_ros|gazebo_plugins|gazebo_msgs|ros_gz|ros_ign|gz_sim|gz_ros2_control|ign_ros2_control|gzserver"
    r"|mujoco|pybullet|pydrake|isaac(?:sim|lab|gym|_)|webots|coppelia|raisim",
    re.IGNORECASE,
)
_GAZEBO = re.compile(r"gazebo|ros_gz|ros_ign|gz_sim|gzserver")
# How launch files, scripts and manifests name the successor of Gazebo Classic.
_SUCCESSOR = re.compile(r"\b(?:ros_gz|ros_ign|gz_sim|gz_ros2_control|ign_ros2_control)")
# How launch files and scripts start Classic and spawn a robot there.
_CLASSIC_START = re.compile(r"\b(?:gzserver|gzclient|spawn_entity\.py)\b|\bgazebo_ros\b[^\n]{0,80}\bgazebo\.launch")
# The engines of the new Gazebo that have mimic constraints, as launch files (--physics-engine) and worlds (<engine>) name them.
_MIMIC_ENGINE = re.compile(r"gz-physics-(?:bullet-featherstone|mujoco)")
# The packages of ros_control that read transmissions, in manifests, launch files and scripts.
_ROS_CONTROL = re.compile(
    r"gazebo_ros_control|hardware_interface|transmission_interface|controller_manager|ros_control"
)
# Programs that check a robot for collisions with itself, in manifests, launch files and scripts.
_COLLISION_CHECKER = re.compile(r"moveit|pinocchio|\bfcl\b|hpp-?fcl|\bcoal\b|tesseract|\bompl\b|curobo", re.IGNORECASE)
# Engines in which the links of one robot collide, at least on request, without an element of its file.
_COLLIDING_ENGINE = re.compile(
    r"mujoco|mjcf|isaac|drake|bullet|webots|coppelia|raisim|newton|genesis|sapien", re.IGNORECASE
)
# Programs that compute with masses without being simulators, in launch files and scripts. KDL's kinematics for MoveIt do not.
_DYNAMICS = re.compile(
    r"pinocchio|rbdl|\bkdl(?!_kinematics)|drake|crocoddyl|inverse_dynamics|gravity|placo|mjcf", re.IGNORECASE
)
# Programs that draw a COLLADA file as if it were in metres, in manifests and scripts.
_UNITLESS = re.compile(r"pinocchio|trimesh|yourdfpy|urdfpy|yourdf|mujoco|isaac|pydrake|\bdrake\b|newton", re.IGNORECASE)
# Elements and files of a robot for a simulator or for controllers, as a xacro file names them.
_CONTROLLED = re.compile(r"gazebo|mujoco|isaac|ros2_control|transmission")
# The program that publishes the frames of a robot and reads no mass.
_STATE_PUBLISHER = re.compile(r"\b(?:robot_state_publisher|state_publisher)\b")
# Programs that leave out a part of a lidar's scan, in manifests, launch files and their parameters.
_SCAN_FILTER = re.compile(r"laser_filter|scan_filter|scan_to_scan_filter|LaserScan\w*Filter")
# The option of Gazebo's spawners that puts a joint at a position.
_START_OPTION = re.compile(r"(?<![\w-])-J\b")
# How launch files give Gazebo an SDF of their own, and how they give it a robot_description.
_SDF = re.compile(r"\w\.sdf\b")
_SPAWNS_FILE = re.compile(r"(?<![\w-])-file\b")
_SPAWNS_DESCRIPTION = re.compile(r"(?<![\w-])-(?:topic|param|string|urdf)\b")
# A model of a folder, as worlds include it.
_WORLD_MODEL = re.compile(r"<uri>\s*model://(?!sun\b|ground_plane\b)")
# Programs and services that put a robot into a world of Gazebo that runs.
_SPAWNER = re.compile(r"spawn|SpawnEntity|EntityFactory|/create\b|[\"']create[\"']")
# A program that adds a file to the robot that runs, as launch files name it: send_urdf_fragment.py of the arms of Rethink.
_FRAGMENT_PROGRAM = re.compile(r"(?<![\w.-])\w*urdf_fragment\w*(?:\.py)?")
_MJCF = re.compile(r"\s*(?:<\?xml[^>]*>\s*)?<mujoco\b")
# The names of plugins and of hardware of the new Gazebo.
_NEW_PLUGIN = re.compile(r"(?:lib)?(?:gz|ign|ignition)[-_]")
# A model of MuJoCo's own, as launch files and scripts name it.
_SCENE = re.compile(r"(?<![\w-])(?!package\.)[\w-]+\.xml\b")
_REMARK = re.compile(r"^[ \t]*#[^\n]*", re.MULTILINE)


def is_simulated_hardware(control: Element) -> bool:
    """Whether a simulator provides the hardware of a ``<ros2_control>`` block."""
    return any(_HARDWARE.search(element.text) for element in control.walk() if element.tag == "plugin")


@fact
def is_simulated(model: Model) -> bool:
    """Whether the robot has elements for a simulator, or a file of the model's package, or of a package that depends on it,
    names one, and is not about other models only."""
    if _has_elements(model):
        return True
    return any(map(_SIMULATOR.search, _list_project_texts(model))) and not is_left_aside(model)


@fact
def is_started_in_simulator(model: Model) -> bool:
    """Whether the robot has elements for a simulator, or one of these files names a simulator, the robot's own file and no other
    model: of two, one may be for display.

    Where the folder of that is typed before its name, it must be the robot's too.
    """
    path = model.source.path.absolute()
    own = re.compile(rf"(?<![\w.-])(?:{re.escape(path.parent.name)}/|(?<![\w.-]/)){re.escape(path.name)}(?![\w.-])")
    return _has_elements(model) or any(
        _SIMULATOR.search(text) and own.search(text) and not _names_other_model(text, path.name)
        for text in _list_project_texts(model)
    )


def _names_other_model(text: str, own: str) -> bool:
    """Whether a text names another model file, or one of MuJoCo's own format beside MuJoCo."""
    if any(name != own for name in MODEL_FILE.findall(text)):
        return True
    return "mujoco" in text.lower() and _SCENE.search(text) is not None


def is_modelled_for_mujoco(model: Model) -> bool:
    """Whether a file of the project is a model of MuJoCo (MJCF) with all joints of the robot that move."""
    names = [joint.name for joint in model.joints if joint.is_movable]
    return any(
        _MJCF.match(text) and all(f'name="{name}"' in text for name in names) for text in _list_project_texts(model)
    )


def _has_elements(model: Model) -> bool:
    """Whether the robot has elements for a simulator."""
    return any(model.robot.find_child(tag) is not None for tag in _ELEMENTS) or any(
        map(is_simulated_hardware, model.robot.find_children("ros2_control"))
    )


def is_left_aside(model: Model) -> bool:
    """Whether files of the model's package, or of those that depend on it, name other models and not this one: a copy for
    display, or for other programs."""
    return name_other_models_only(_list_project_texts(model), model.source.path.name)


def is_named_in_package(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, names the model's own file. True without a package."""
    own = re.compile(rf"(?<![\w.-]){re.escape(model.source.path.name)}(?![\w.-])")
    return model.source.package is None or any(map(own.search, _list_project_texts(model)))


def is_only_displayed(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, publishes the model's own file, and none names a
    simulator. False without a package."""
    texts = _list_project_texts(model)
    if model.source.package is None or any(_GAZEBO.search(text) or _SIMULATOR.search(text) for text in texts):
        return False
    own = re.compile(rf"(?<![\w.-]){re.escape(model.source.path.name)}(?![\w.-])")
    return any("robot_state_publisher" in text and own.search(text) for text in texts)


def find_attaching_program(model: Model, links: Iterable[str]) -> str | None:
    """Return the program to which a file of the model's package, or of one that depends on it, hands the model's own file with
    the names of these links: one for fragments, which it attaches to a robot that runs. None if there is none."""
    names = [re.compile(rf"(?<![\w.-]){re.escape(name)}(?![\w.-])") for name in (model.source.path.name, *links)]
    for text in _list_project_texts(model):
        program = _FRAGMENT_PROGRAM.search(text)
        if program is not None and all(name.search(text) for name in names):
            return program[0]
    return None


@fact
def is_left_out_of_gazebo(model: Model) -> bool:
    """Whether files of the model's package, or of those that depend on it, give other models to Gazebo, and neither they nor one
    that loads a robot_description names this one, by its name up to the first dot; or they give it an SDF and no
    robot_description. Or nothing in them and in the robot is for Gazebo."""
    own, texts = _cut_name(model.source.path.name), _list_project_texts(model)
    spawning = [text for text in texts if _GAZEBO.search(text)]
    blocks = [
        *model.robot.find_children("gazebo"),
        *filter(is_simulated_hardware, model.robot.find_children("ros2_control")),
    ]
    if model.source.package is not None and not spawning and not blocks:
        return True
    if gives_gazebo_sdf(model):
        return True
    simulated = {_cut_name(name) for text in texts if _GAZEBO.search(text) for name in MODEL_FILE.findall(text)}
    loaded = {_cut_name(name) for text in texts if "robot_description" in text for name in MODEL_FILE.findall(text)}
    return bool(simulated) and own not in simulated | loaded


def gives_gazebo_sdf(model: Model) -> bool:
    """Whether files of the model's package, or of those that depend on it, give Gazebo an SDF and no robot_description."""
    spawning = [text for text in _list_project_texts(model) if _GAZEBO.search(text)]
    gives_sdf = any(_SDF.search(text) and _SPAWNS_FILE.search(text) for text in spawning)
    return gives_sdf and not any(map(_SPAWNS_DESCRIPTION.search, spawning))


def is_spawned_in_gazebo(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, starts Gazebo, names the model's own file and no other
    model, and gives Gazebo a file, or a robot_description."""
    own = _compile_names((model.source.path.name,))
    return any(
        _GAZEBO.search(text)
        and own.search(text)
        and not _names_other_model(text, model.source.path.name)
        and (_SPAWNS_FILE.search(text) or _SPAWNS_DESCRIPTION.search(text))
        and not _SDF.search(text)
        for text in _list_project_texts(model)
    )


def is_left_to_world(model: Model) -> bool:
    """Whether no file of the model's package, or of one that depends on it, spawns a robot in Gazebo, and a world of theirs has
    models in it: then the simulated robot is one of these."""
    texts = _list_project_texts(model)
    return any("<world" in text and _WORLD_MODEL.search(text) for text in texts) and not any(
        map(_SPAWNER.search, texts)
    )


def _cut_name(file: str) -> str:
    return file.partition(".")[0]


def is_started_elsewhere(model: Model) -> bool:
    """Whether a plugin of the simulator gets a start of some joints (``<initialConfiguration>``, ``<initial_position>``), or a
    file of the model's package, or of one that depends on it, passes one to Gazebo's spawner (``-J``)."""
    in_plugin = any(
        "initial" in element.tag.lower()
        for block in model.robot.find_children("gazebo")
        for plugin in block.find_children("plugin")
        for element in plugin.walk()
    )
    return in_plugin or any(map(_START_OPTION.search, _list_project_texts(model)))


@fact
def has_bare_joints(model: Model) -> bool:
    """Whether no body that moves has an ``<inertial>`` or a ``<collision>``, and nothing simulates the robot. False where the
    tree is broken."""
    links = _list_moving_links(model)
    bare = not any(link.inertial is not None or link.collisions for link in links)
    return bool(links) and bare and not is_simulated(model)


def is_made_for_display(model: Model) -> bool:
    """Whether a robot is drawn, and its moving parts with it, but never simulated: then an inertial of its root is a dummy."""
    return has_bare_joints(model) and any(link.visuals for link in _list_moving_links(model))


@fact
def is_loaded_for_frames(model: Model) -> bool:
    """Whether the files that name the model's own one, or one that includes it, start a program that publishes its frames, and
    none that reads a mass; and no file gives whatever robot is loaded to one that does. The robot itself is for none either."""
    includers = read_includers(model.source)
    own = _compile_names((model.source.path.name, *includers))
    texts = _list_project_texts(model)
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
    own, texts = _compile_names((model.source.path.name,)), _list_project_texts(model)
    if model.source.package is None or _has_elements(model) or not any(map(own.search, texts)):
        return False
    return not any(_GAZEBO.search(text) or _reads_masses(text) for text in texts)


def _compile_names(names: Iterable[str]) -> re.Pattern[str]:
    return re.compile(rf"(?<![\w.-])(?:{'|'.join(map(re.escape, names))})(?![\w.-])")


def _reads_masses(text: str) -> bool:
    return _SIMULATOR.search(text) is not None or _DYNAMICS.search(text) is not None


def is_without_dynamics(model: Model) -> bool:
    """Whether no body that moves has an ``<inertial>``, and neither a simulator nor a program that checks for collisions is named
    in a file of the model's package, or of one that depends on it."""
    links = _list_moving_links(model)
    if not links or any(link.inertial is not None for link in links) or is_simulated(model):
        return False
    return not any(map(_COLLISION_CHECKER.search, _list_project_texts(model)))


def _list_moving_links(model: Model) -> list[Link]:
    try:
        moving = [body for body in list_rigid_bodies(model) if body.is_movable]
    except FactUnavailableError:
        return []
    return [model.link_by_name[name] for body in moving for name in body.links]


def names_successor(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names the new Gazebo."""
    return any(map(_SUCCESSOR.search, _list_project_texts(model)))


def starts_classic(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, starts Gazebo Classic."""
    return any(map(_CLASSIC_START.search, _list_project_texts(model)))


def is_steered_in_sdf(model: Model, joint: str) -> bool:
    """Whether an SDF of the model's package, or of one that depends on it, gives a joint of this name two axes, or names it as
    one that steers."""
    name = re.escape(joint)
    steered = re.compile(
        rf"""<joint\s(?=[^<>]*name=["']{name}["'])[^<>]*type=["'](?:universal|revolute2)["']"""
        rf"""|<\w*steering\w*>\s*{name}\s*<"""
    )
    return any(map(steered.search, _list_project_texts(model)))


def names_unitless_program(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names a program that ignores the unit of a
    COLLADA file. True where the model has no package."""
    return model.source.package is None or any(map(_UNITLESS.search, _list_project_texts(model)))


def ignores_self_collisions(model: Model) -> bool:
    """Whether the files of the model's package, and of packages that depend on it, name Gazebo and nothing else in which links of
    one robot collide, and no element of the robot makes them collide there."""
    texts = _list_project_texts(model)
    if model.source.package is None or not any(map(_GAZEBO.search, texts)):
        return False
    if any(_COLLISION_CHECKER.search(text) or _COLLIDING_ENGINE.search(text) for text in texts):
        return False
    blocks = (element for block in model.robot.find_children("gazebo") for element in block.walk())
    return not any(
        strip_namespace(element.tag).lower().replace("_", "") == "selfcollide"
        and element.text.strip().lower() in {"true", "1"}
        for element in blocks
    )


def names_mimic_engine(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names an engine of the new Gazebo that couples
    joints by ``<mimic>``."""
    return any(map(_MIMIC_ENGINE.search, _list_project_texts(model)))


def names_ros_control(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names what reads transmissions."""
    return any(map(_ROS_CONTROL.search, _list_project_texts(model)))


def names_scan_filter(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names a filter of a lidar's scan."""
    return any(map(_SCAN_FILTER.search, _list_project_texts(model)))


def has_successor_branch(model: Model, element: Element) -> bool:
    """Whether other arguments of the model load a plugin of the new Gazebo instead of an element, which is of Classic.

    Both are under conditions that read one name, perhaps around the calls of their macros, and this robot lacks the plugin.
    """
    read = _collect_condition_names(model, element)
    here = set(map(_get_place, iter_elements_by_tag({"": model.robot}, "plugin"))) if read else set()
    others = iter_elements_by_tag(model.source.trees, "plugin")
    return bool(read) and any(
        _NEW_PLUGIN.match(other.get("filename") or other.text.strip()) is not None
        and _get_place(other) not in here
        and bool(read & _collect_condition_names(model, other))
        for other in others
    )


def _collect_condition_names(model: Model, element: Element) -> set[str]:
    """Collect what the conditions around an element read, where it is typed and where the macros around it are called."""
    place = _get_place(element)
    tree = None if place is None else model.source.trees.get(place[0])
    around = [] if tree is None else [e for e in tree.walk() if _get_place(e) == place][:1]
    names: set[str] = set()
    followed: set[str] = set()
    while around:
        typed = around.pop()
        macro = strip_namespace(typed.get("name"))
        if typed.tag in {"xacro:if", "xacro:unless"}:
            value = typed.get("value")
            names |= find_expression_names(value) | {*ARGUMENT.findall(value)}
        elif typed.tag == "xacro:macro" and macro not in followed:
            followed.add(macro)
            around += iter_elements_by_tag(model.source.trees, f"xacro:{macro}")
        if typed.parent is not None:
            around.append(typed.parent)
    return names


def _get_place(element: Element) -> tuple[str, int] | None:
    return None if element.span is None else (element.span.file, element.span.start)


@fact
def _list_project_texts(model: Model) -> tuple[str, ...]:
    """List the texts of `read_project_texts` without comments."""
    return tuple(_drop_comments(text) for text in read_project_texts(model.source))


def _drop_comments(text: str) -> str:
    """Leave out comments: generated manifests mention Gazebo in theirs."""
    head, *rest = text.split("<!--")
    return _REMARK.sub("", head + "".join(piece.partition("-->")[2] for piece in rest))
