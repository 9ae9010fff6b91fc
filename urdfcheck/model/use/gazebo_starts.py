"""How a project starts its robot in Gazebo, and in which Gazebo."""

from __future__ import annotations

import re

from urdfcheck.core.text import compile_names
from urdfcheck.model.fact import fact
from urdfcheck.model.gazebo import GazeboSensor, collect_plugin_texts, is_for_new_gazebo
from urdfcheck.model.robot import Model
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.model.use.simulators import GAZEBO, is_simulated_hardware, names_other_model
from urdfcheck.source.package.package_folders import read_package_texts
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import MODEL_FILE, computes_name, iter_user_texts
from urdfcheck.source.xacro.usage import ARGUMENT, find_expression_names, iter_elements_by_tag, strip_namespace

# How launch files, scripts and manifests name the successor of Gazebo Classic.
_SUCCESSOR = re.compile(r"\b(?:ros_gz|ros_ign|gz_sim|gz_ros2_control|ign_ros2_control)")
# How launch files and scripts start Classic and spawn a robot there.
_CLASSIC_START = re.compile(
    r"\b(?:gzserver|gzclient|spawn_entity\.py)\b|\bgazebo_ros\b[^\n]{0,80}(?:\b(?:gazebo|\w+_world)\.launch|\bspawn_model\b)"
)
# How launch files and scripts give gzserver a plugin of their own, which may add types of sensors; not those of gazebo_ros.
_SYSTEM_PLUGIN = re.compile(
    r"(?<![\w-])(?:-s|--server-plugin)[\s\"',=]+(?:\$\([^()]*\))?(?:[\w.-]*/)*lib(?!gazebo_ros_)\w[\w.-]*\.so\b"
)
# The engines of the new Gazebo that have mimic constraints, as launch files (--physics-engine) and worlds (<engine>) name them.
_MIMIC_ENGINE = re.compile(r"gz-physics-(?:bullet-featherstone|mujoco)")
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
# How scripts make an SDF of a model, and what publishes the frames of a robot.
_CONVERTS = re.compile(r"\b(?:gz|ign)\s+sdf\b|\bgzsdf\b")
_FRAMES = re.compile(r"robot_description|state_publisher|rviz|moveit", re.IGNORECASE)
# What reads a robot for other simulations.
_READERS = re.compile(r"drake|bullet", re.IGNORECASE)
# The plugins of ROS for Classic.
_CLASSIC_PLUGIN = re.compile(r"gazebo_ros\d?_")
# The names of plugins and of hardware of the new Gazebo.
_NEW_PLUGIN = re.compile(r"(?:lib)?(?:gz|ign|ignition)[-_]")


def names_successor(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names the new Gazebo."""
    return any(map(_SUCCESSOR.search, list_project_texts(model)))


def starts_classic(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, starts Gazebo Classic."""
    return any(map(_CLASSIC_START.search, list_project_texts(model)))


def is_only_for_classic(model: Model) -> bool:
    """Whether a plugin of the robot is one of ROS for Classic, or a file starts it there, and nothing names the successor."""
    if is_for_new_gazebo(model) or names_successor(model):
        return False
    plugins = (e for block in model.robot.find_children("gazebo") for e in block.walk() if e.tag == "plugin")
    return any(_CLASSIC_PLUGIN.search(plugin.get("filename")) for plugin in plugins) or starts_classic(model)


def is_unread(model: Model, sensor: GazeboSensor) -> bool:
    """Whether no plugin of the robot is in a sensor or names it, and Classic alone simulates the robot: the new Gazebo publishes
    the data of each sensor, and Classic leaves that to plugins."""
    return not sensor.has_plugin and sensor.name not in collect_plugin_texts(model) and is_only_for_classic(model)


def loads_system_plugin(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, gives Gazebo Classic a plugin for the server,
    other than those of gazebo_ros."""
    return any(map(_SYSTEM_PLUGIN.search, list_project_texts(model)))


def names_mimic_engine(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, names an engine of the new Gazebo that couples
    joints by ``<mimic>``."""
    return any(map(_MIMIC_ENGINE.search, list_project_texts(model)))


def is_only_made_into_sdf(model: Model) -> bool:
    """Whether a file of the model's package, or of a package that depends on it, makes an SDF of the model's own file, and none
    that names the file, or computes the name of one, publishes frames: then they are names in Gazebo alone."""
    own, texts = compile_names((model.source.path.name,)), list_project_texts(model)
    is_made = any(own.search(text) and _CONVERTS.search(text) for text in texts)
    publishing = filter(_FRAMES.search, texts) if is_made else ()
    return is_made and not any(own.search(text) or computes_name(text, model.source.path.name) for text in publishing)


@fact
def is_only_for_gazebo(model: Model) -> bool:
    """Whether the files of the model's package, and those of packages that depend on it and name the model's file, name Gazebo,
    and no program that draws or reads the robot by itself. Manifests do not count: they name what is only copied."""
    package, own = model.source.package, compile_names((model.source.path.name,))
    texts = [
        text
        for path, text in iter_user_texts(model.source)
        if path.name != "package.xml" and (package is None or path.is_relative_to(package.path) or own.search(text))
    ]
    return any(map(GAZEBO.search, texts)) and not any(_FRAMES.search(t) or _READERS.search(t) for t in texts)


@fact
def is_left_out_of_gazebo(model: Model) -> bool:
    """Whether files of the model's package, or of those that depend on it, give other models to Gazebo, and neither they nor one
    that loads a robot_description names this one, by its name up to the first dot; or they give it an SDF and no
    robot_description. Or nothing in them and in the robot is for Gazebo. Without a package: whether scripts of its project name
    it, and none of these is about Gazebo or loads a robot_description."""
    own, texts = _cut_name(model.source.path.name), list_project_texts(model)
    spawning = [text for text in texts if GAZEBO.search(text)]
    blocks = [
        *model.robot.find_children("gazebo"),
        *filter(is_simulated_hardware, model.robot.find_children("ros2_control")),
    ]
    if not blocks and (not spawning if model.source.package is not None else _is_loaded_by_other_programs(model)):
        return True
    if gives_gazebo_sdf(model):
        return True
    simulated = {_cut_name(name) for text in texts if GAZEBO.search(text) for name in MODEL_FILE.findall(text)}
    loaded = {_cut_name(name) for text in texts if "robot_description" in text for name in MODEL_FILE.findall(text)}
    return bool(simulated) and own not in simulated | loaded


def _is_loaded_by_other_programs(model: Model) -> bool:
    """Whether files of the project around a model without a package name it, and none of them is about Gazebo or ROS."""
    finder, path = model.source.finder, model.source.path.absolute()
    project, own = finder.find_project_above(path), compile_names((path.name,))
    texts = () if project is None else read_package_texts(project, finder.can_open)
    naming = [text for text in texts if own.search(text)]
    return bool(naming) and not any(GAZEBO.search(text) or "robot_description" in text for text in naming)


def gives_gazebo_sdf(model: Model) -> bool:
    """Whether files of the model's package, or of those that depend on it, give Gazebo an SDF and no robot_description."""
    spawning = [text for text in list_project_texts(model) if GAZEBO.search(text)]
    gives_sdf = any(_SDF.search(text) and _SPAWNS_FILE.search(text) for text in spawning)
    return gives_sdf and not any(map(_SPAWNS_DESCRIPTION.search, spawning))


def is_spawned_in_gazebo(model: Model) -> bool:
    """Whether a file of the model's package, or of one that depends on it, starts Gazebo, names the model's own file and no other
    model, and gives Gazebo a file, or a robot_description."""
    own = compile_names((model.source.path.name,))
    return any(
        GAZEBO.search(text)
        and own.search(text)
        and not names_other_model(text, model.source.path.name)
        and (_SPAWNS_FILE.search(text) or _SPAWNS_DESCRIPTION.search(text))
        and not _SDF.search(text)
        for text in list_project_texts(model)
    )


def is_left_to_world(model: Model) -> bool:
    """Whether no file of the model's package, or of one that depends on it, spawns a robot in Gazebo, and a world of theirs has
    models in it: then the simulated robot is one of these."""
    texts = list_project_texts(model)
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
    return in_plugin or any(map(_START_OPTION.search, list_project_texts(model)))


def is_steered_in_sdf(model: Model, joint: str) -> bool:
    """Whether an SDF of the model's package, or of one that depends on it, gives a joint of this name two axes, or names it as
    one that steers."""
    name = re.escape(joint)
    steered = re.compile(
        rf"""<joint\s(?=[^<>]*name=["']{name}["'])[^<>]*type=["'](?:universal|revolute2)["']"""
        rf"""|<\w*steering\w*>\s*{name}\s*<"""
    )
    return any(map(steered.search, list_project_texts(model)))


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
