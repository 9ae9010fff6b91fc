"""Whether a robot stands on the ground by itself, or its base is bolted down: arms, hands and grippers."""

from __future__ import annotations

import re
from collections.abc import Sequence

from urdfcheck.core import FactUnavailableError
from urdfcheck.model.fact import fact
from urdfcheck.model.ground.support_polygon import LEG
from urdfcheck.model.ground.wheels import rolling_wheels
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.parts import GROUND_NAMES, Joint
from urdfcheck.model.rigid_bodies import add_sliding_links, compute_body_mass
from urdfcheck.model.robot import Model
from urdfcheck.model.wheel_names import CASTER_NAME, WHEEL_NAME
from urdfcheck.source.uses_elsewhere import read_includers

# Parts on which a robot drives, swims or flies. A base_footprint is the place of a mobile robot on the ground.
_MOBILE_NAME = re.compile(
    r"footprint|track(?!er)|tread|crawler|roller|rotor|propell|prop_?\d|thruster|wing|fin(?![a-z])|buoy|hull|skid",
    re.IGNORECASE,
)
# Robots that fly, dive or sail: the forces of a program act on their body, whatever it touches.
_VEHICLE_NAME = re.compile(
    r"copter|drone|(?<![a-z])(?:uav|auv|rov|uuv|usv)(?![a-z])|aircraft|(?<![a-z])boat", re.IGNORECASE
)
# Limbs that handle things; in a name like larm or r_gripper_l_finger, not in alarm or swarm.
HANDLING_NAME = re.compile(
    r"(?:^|[^a-z]|(?<=[a-z])(?=[A-Z])|(?:^|[^a-z])[lr])(?:arm(?!at)|finger|thumb|gripper|jaw|hand|palm|knuckle)",
    re.IGNORECASE,
)
# What fingers are on.
_PALM_NAME = re.compile(r"hand|palm|gripper", re.IGNORECASE)
# What makes a file that includes a model more than another name for it: parts, a plugin, or a second file.
_ADDS = re.compile(r"<(?:xacro:include|joint|link|plugin|xacro:macro)\b")
# A root that weighs so many times what the rest of the robot does is ballast: a stand that is not to move.
_BALLAST = 10.0
# An arm of a robot with several has at least so many joints that move; a finger has fewer (chosen).
_ARM_JOINTS = 6
# A single joint may be the lid of a box.
_FEWEST_CHAIN_JOINTS = 2


@fact
def explain_fixed_base(model: Model) -> str:
    """Return why the base of a robot cannot move, empty if it can.

    It is what `Model.base` says. With auto, the base is fixed if the root link is named world or map or has no mass, if the
    semantic description (SRDF) fixes it, or if the robot is an arm or a hand: one limb of several joints, or limbs that are arms
    or fingers by name, and no wheel, leg, track or rotor.

    :raises FactUnavailableError: when the tree is broken or the mass of the root is malformed or negative.
    """
    if model.base != "auto":
        return "as asked" if model.base == "fixed" else ""
    root = model.tree.root
    if root in GROUND_NAMES:
        return f"its root is {root}"
    mass = compute_body_mass(model, model.tree.list_body_links(root))
    if mass is None:
        raise FactUnavailableError(f"the mass of link {root!r} is not known (XML005, XML007)")
    if mass < 0:
        raise FactUnavailableError(f"the mass of link {root!r} is negative (INR002)")
    if not mass:
        return f"its root {root} has no mass"
    kinds = _list_virtual_joint_types(model)
    if kinds:
        return f"the SRDF fixes {root} to the world" if kinds == {"fixed"} else ""
    return _explain_manipulator(model)


def is_bolted(model: Model) -> bool:
    """Whether the base cannot move in a simulation either: planners hold the base of a mobile manipulator still, but it rolls.

    :raises FactUnavailableError: when the tree is broken or the mass of the root is malformed or negative.
    """
    return bool(explain_fixed_base(model)) and not rolling_wheels(model)


def is_bolted_arm(model: Model) -> bool:
    """Whether a robot is one limb on a base that cannot move; a hand is fixed to an arm, and its base moves then.

    :raises FactUnavailableError: when the tree is broken or the mass of the root is malformed or negative.
    """
    return is_bolted(model) and len(_list_limb_joints(model, model.tree.list_body_links(model.tree.root))) == 1


def list_bolted_links(model: Model) -> Sequence[str]:
    """List the links of a base that cannot move: nothing depends on their inertia. Empty where it can, or that is not known.

    A hand is fixed to an arm, unless its file says that it is fixed to the world.
    """
    if _is_in_pieces(model):
        return _list_links_on_world(model)
    try:
        root = model.tree.root
        is_held = is_bolted(model) if root in GROUND_NAMES or _carries_long_arms(model) else is_bolted_arm(model)
        return model.tree.list_body_links(root) if is_held else ()
    except FactUnavailableError:  # the mass of the base is not known
        return ()


def list_unturned_links(model: Model) -> Sequence[str]:
    """List the links of a base that cannot move, and of what only slides on it: nothing depends on their inertia."""
    return add_sliding_links(model, list_bolted_links(model))


def _carries_long_arms(model: Model) -> bool:
    """Whether a robot is several limbs on one base, all of them arms by name and one with more joints than a finger has."""
    deepest = max(
        (sum(one.is_movable for one in model.tree.find_path_to(name)) for name in model.tree.order), default=0
    )
    return deepest >= _ARM_JOINTS and bool(_explain_manipulator(model))


@fact
def is_untouched(model: Model) -> bool:
    """Whether a model is one rigid body that nothing turns: no joint moves, it collides with nothing, neither a simulator's
    plugin nor a rotor pushes it, its name is not that of a vehicle that flies or swims, and no file that includes it fixes it to
    something that moves."""
    if model.source.is_part or _has_drives(model) or any(joint.is_movable for joint in model.joints):
        return False
    names = " ".join((model.name, *(link.name for link in model.links)))
    is_vehicle = any(pattern.search(names) for pattern in (_MOBILE_NAME, _VEHICLE_NAME))
    return not is_vehicle and not any(link.collisions for link in model.links)


def _has_drives(model: Model) -> bool:
    """Whether a robot has plugins, or elements for a simulator other than what a block for Gazebo says about looks."""
    blocks = model.robot.find_children("gazebo")
    if any(element.tag in {"plugin", "sensor"} for block in blocks for element in block.walk()):
        return True
    return any(model.robot.find_child(tag) is not None for tag in ("mujoco", "ros2_control", "transmission"))


@fact
def is_sensor_stand(model: Model) -> bool:
    """Whether a model only carries sensors of a simulator: no joint of it moves, no plugin but theirs is in it, no part of it is
    that of a robot that drives, swims or flies, and no file that includes it adds anything that moves it."""
    if any(joint.is_movable for joint in model.joints):
        return False
    includers = read_includers(model.source).values() if model.source.is_part else ()
    if model.source.is_part and (not includers or any(len(_ADDS.findall(text)) > 1 for text in includers)):
        return False
    inside = [element for block in model.robot.find_children("gazebo") for element in block.walk()]
    sensors = [element for element in inside if element.tag == "sensor"]
    of_sensors = {id(element) for sensor in sensors for element in sensor.walk()}
    if not sensors or any(element.tag == "plugin" and id(element) not in of_sensors for element in inside):
        return False
    # The pedestal of an example has the frames of a robot.
    names = " ".join(link.name for link in model.links).replace("footprint", "")
    return not any(pattern.search(names) for pattern in (LEG, WHEEL_NAME, CASTER_NAME, _MOBILE_NAME))


def is_ballast(model: Model, links: Sequence[str]) -> bool:
    """Whether the body of these ``links`` is the stand of a robot that it outweighs: what it weighs is a choice and has no
    effect.

    The body of a mobile robot outweighs its wheels too, but it moves.

    :raises FactUnavailableError: when the tree is broken or the mass of the root is malformed or negative.
    """
    head = model.pieces.list_body_links(links[0])[0]
    # In a robot in pieces the parent of the joint that moves the body may not exist.
    if head in model.pieces.parent_joint or any(joint.child == head and joint.is_movable for joint in model.joints):
        return False
    own = sum(declared.mass for declared in model.masses if declared.link.name in links)
    rest = sum(declared.mass for declared in model.masses if declared.link.name not in links)
    return own > _BALLAST * rest > 0.0 and (_is_in_pieces(model) or is_bolted(model))


def _is_in_pieces(model: Model) -> bool:
    """Whether the robot is not one tree: then it is not known what carries a piece."""
    try:
        _ = model.tree
    except FactUnavailableError:
        return True
    return False


def _list_links_on_world(model: Model) -> Sequence[str]:
    """List the links that fixed joints hang on a world, also one which the file does not declare: Drake has a body of that name.

    Empty where wheels turn on the robot, by their names: such a base rolls in other programs.
    """
    if model.base not in {"auto", "fixed"}:
        return ()
    turning = [joint for joint in model.joints if joint.type == "continuous"]
    if any(p.search(f"{one.name} {one.child}") for one in turning for p in (WHEEL_NAME, CASTER_NAME)):
        return ()
    try:
        pieces = model.pieces
    except FactUnavailableError:  # the pieces are not trees
        return ()
    if "world" in model.link_by_name:
        return () if "world" in pieces.parent_joint else pieces.list_body_links("world")
    hung = [joint.child for joint in model.joints if joint.type == "fixed" and joint.parent == "world"]
    roots = [name for name in hung if name in pieces.child_joints and name not in pieces.parent_joint]
    return [link for name in roots for link in pieces.list_body_links(name)]


def _list_virtual_joint_types(model: Model) -> set[str]:
    """List how the semantic descriptions connect the root with the world."""
    return {
        joint.get("type").strip()
        for srdf in semantic_descriptions(model)
        for joint in srdf.root.find_children("virtual_joint")
        if joint.get("child_link").strip() == model.tree.root
    }


def _explain_manipulator(model: Model) -> str:
    root = model.tree.root
    names = [*(link.name for link in model.links), *(joint.name for joint in model.joints)]
    mobile = (LEG, WHEEL_NAME, CASTER_NAME, _MOBILE_NAME)
    if any(pattern.search(name) for pattern in mobile for name in names) or rolling_wheels(model):
        return ""
    if any(joint.type in {"floating", "planar"} for joint in model.joints):
        return ""
    body = model.tree.list_body_links(root)
    limbs = _list_limb_joints(model, body)
    if len(limbs) == 1 and _count_chain_joints(model, limbs[0]) >= _FEWEST_CHAIN_JOINTS:
        return f"all that moves is one limb on {root}, without wheels or legs"
    is_hand = any(_PALM_NAME.search(name) for name in body)
    if limbs and all(is_hand or _is_handling_limb(model, limb) for limb in limbs):
        return f"all that moves on {root} are arms or fingers"
    return ""


def _count_chain_joints(model: Model, first: Joint) -> int:
    """Count the joints that move one after the other, up to the first branch."""
    count, following = 0, [first]
    while len(following) == 1:
        count += 1
        body = model.tree.list_body_links(following[0].child)
        following = _list_limb_joints(model, body)
    return count


def _list_limb_joints(model: Model, body: Sequence[str]) -> list[Joint]:
    """List the joints at the end of a body, without those of empty links beside real ones: they carry a number, such as the
    stiffness of a real joint."""
    joints = [joint for name in body for joint in model.tree.child_joints[name] if joint.type != "fixed"]
    return [joint for joint in joints if not _is_empty_end(model, joint.child)] or joints


def _is_empty_end(model: Model, name: str) -> bool:
    link = model.link_by_name[name]
    return not (link.visuals or link.collisions or link.inertial or model.tree.child_joints[name])


def _is_handling_limb(model: Model, first: Joint) -> bool:
    """Whether a part of a limb is named an arm, a hand or a finger."""
    waiting = [first]
    while waiting:
        joint = waiting.pop()
        if HANDLING_NAME.search(joint.name) or HANDLING_NAME.search(joint.child):
            return True
        waiting += model.tree.child_joints[joint.child]
    return False
