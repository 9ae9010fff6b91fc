"""What the `<gazebo>` blocks of a robot say about the simulator that it is for, and their sensors."""

from __future__ import annotations

import re

from urdfcheck.core.records import dataclass
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import Element

_NEW_GAZEBO = re.compile(r"(?:lib)?(?:gz|ignition-gazebo|gz_ros2_control|ign_ros2_control)[-_]")

# The class with which gazebo_ros_control simulates the hardware of a robot that names none.
_DEFAULT_SIM = "gazebo_ros_control/DefaultRobotHWSim"
_TRUE = frozenset({"true", "1"})
# The elements that name the frame of a sensor's messages: in the sensors of the new Gazebo, and in plugins of Classic too.
FRAME_TAGS = frozenset({"frame_id", "gz_frame_id", "ignition_frame_id"})
PLUGIN_FRAME_TAGS = FRAME_TAGS | {"frameName", "frame_name"}
# The element that names the frame of a camera's pictures.
OPTICAL_FRAME_TAG = "optical_frame_id"
# The types of sensors that take pictures.
CAMERA_TYPE = re.compile(r"camera|depth|rgbd|thermal|segmentation|boundingbox")


@dataclass(frozen=True, slots=True, eq=False)
class GazeboSensor:
    """A ``<sensor>`` in a ``<gazebo>`` block."""

    element: Element
    reference: str
    """The link or joint that the block names."""

    @property
    def name(self) -> str:
        return self.element.get("name")

    @property
    def type(self) -> str:
        return self.element.get("type").strip()

    @property
    def has_plugin(self) -> bool:
        return any(child.tag == "plugin" for child in self.element.children)


def is_held_still(robot: Element) -> bool:
    """Whether Gazebo holds the whole model still: a block without reference says ``<static>``."""
    blocks = (block for block in robot.find_children("gazebo") if not block.get("reference"))
    return any(e.text.strip() in _TRUE for block in blocks for e in block.find_children("static"))


def is_posed(robot: Element) -> bool:
    """Whether no force moves any part of the model in Gazebo: it is held still, or it is one body that is kinematic, which only
    a plugin or a service moves."""
    is_one_body = all(joint.get("type").strip() == "fixed" for joint in robot.find_children("joint"))
    return is_held_still(robot) or (is_one_body and bool(find_kinematic_links(robot)))


def find_kinematic_links(robot: Element) -> frozenset[str]:
    """Find the links whose bodies are kinematic in Gazebo: gravity and contacts do not move these, whatever they weigh."""
    named = {
        block.get("reference")
        for block in robot.find_children("gazebo")
        if any(e.text.strip() in _TRUE for e in block.find_children("kinematic"))
    }
    # A block of a link that the robot lacks is ignored.
    return frozenset(named.intersection(link.get("name") for link in robot.find_children("link")) if named else ())


def has_posed_root(model: Model) -> bool:
    """Whether Gazebo holds the root still, or moves it only where a plugin or a service says; no other simulator reads this.

    :raises FactUnavailableError: when the tree is broken.
    """
    kinematic = find_kinematic_links(model.robot)
    return is_held_still(model.robot) or not kinematic.isdisjoint(model.tree.list_body_links(model.tree.root))


def list_sensors(model: Model) -> list[GazeboSensor]:
    """Return the sensors of all blocks that name a link or joint."""
    blocks = [block for block in model.robot.find_children("gazebo") if block.get("reference")]
    return [GazeboSensor(e, b.get("reference")) for b in blocks for e in b.children if e.tag == "sensor"]


def list_loop_joints(model: Model) -> list[tuple[str, str, str]]:
    """Return type, parent and child of each ``<joint>`` that a block adds for Gazebo between two links, as URDF cannot close a
    loop."""
    joints = (e for block in model.robot.find_children("gazebo") for e in block.children if e.tag == "joint")
    loops = []
    for joint in joints:
        one, other = joint.find_child("parent"), joint.find_child("child")
        if (
            one is not None
            and other is not None
            and {one.text.strip(), other.text.strip()} <= model.link_by_name.keys()
        ):
            loops.append((joint.get("type").strip(), one.text.strip(), other.text.strip()))
    return loops + _list_detachable_joints(model)


def _list_detachable_joints(model: Model) -> list[tuple[str, str, str]]:
    """Return the fixed joints that the DetachableJoint system adds between two links of the robot itself, to close a loop."""
    found = []
    for block in model.robot.find_children("gazebo"):
        for plugin in (e for e in block.children if e.tag == "plugin" and e.get("name").endswith("DetachableJoint")):
            texts = {e.tag: e.text.strip() for e in plugin.children}
            one, other = texts.get("parent_link", ""), texts.get("child_link", "")
            is_own = texts.get("child_model", "") in {model.name, "__model__", ""}
            if is_own and {one, other} <= model.link_by_name.keys():
                found.append(("fixed", one, other))
    return found


def collect_plugin_texts(model: Model) -> frozenset[str]:
    """Collect the words that stand alone in an element of a plugin: names of links and joints are among them."""
    return frozenset(
        element.text.strip()
        for block in model.robot.find_children("gazebo")
        for plugin in block.walk()
        if plugin.tag == "plugin"
        for element in plugin.walk()
    )


def reads_transmissions(model: Model) -> bool:
    """Whether the robot loads gazebo_ros_control: nothing else in a model reads its transmissions."""
    return bool(_list_control_plugins(model))


def find_own_hardware_sim(model: Model) -> str:
    """Return the class with which gazebo_ros_control simulates the hardware, if it is not its own: that class decides which
    interfaces of joints there are. Empty if one plugin names none."""
    named = [
        (e.text.strip() if e is not None else "")
        for e in (p.find_child("robotSimType") for p in _list_control_plugins(model))
    ]
    is_own = bool(named) and all(name and name != _DEFAULT_SIM for name in named)
    return named[0] if is_own else ""


def _list_control_plugins(model: Model) -> list[Element]:
    plugins = (e for block in model.robot.find_children("gazebo") for e in block.walk() if e.tag == "plugin")
    return [plugin for plugin in plugins if "gazebo_ros_control" in plugin.get("filename")]


# What becomes of transmissions where the model has no plugin that reads them.
UNREAD_TRANSMISSIONS = {"gazebo": "loads it: no plugin of the model reads transmissions"}


def is_for_new_gazebo(model: Model) -> bool:
    """Whether the robot uses a plugin that only the successor of Gazebo Classic can load."""
    plugins = [e for block in model.robot.find_children("gazebo") for e in block.walk() if e.tag == "plugin"]
    return any(_NEW_GAZEBO.match(plugin.get("filename").strip()) for plugin in plugins)
