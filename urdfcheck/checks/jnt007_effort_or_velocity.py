"""JNT007 reports effort and velocity limits that are missing, zero, negative or beyond any drive."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names, split_name_words
from urdfcheck.model import Joint, Model
from urdfcheck.model.gazebo import collect_plugin_texts, is_held_still
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.motion.rotors import is_named_rotor
from urdfcheck.model.stated_reasons import collect_reasoned_joints
from urdfcheck.model.use.display import has_bare_joints
from urdfcheck.model.use.other_programs import is_only_for_bullet, is_read_without_urdfdom
from urdfcheck.model.use.simulators import is_simulated_hardware
from urdfcheck.source.text.grammar import is_attribute_missing, list_attributes_as_children
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import is_certainly_left_aside, is_named_around

_EFFORT_INTERFACE = "EffortJointInterface"
_SETS_DIRECTLY = "gazebo_ros2_control/"
# SDFormat's default of <effort> and <velocity>: no limit.
_SDF_UNLIMITED = -1.0
# So many joints are a robot of which one joint can be the odd one.
_MANY = 4
# rad: 160 turns either way (chosen). A range that large means that there is none.
_ENDLESS = 1000.0
# The words of joints that springs hold.
_PASSIVE_WORDS = frozenset({"passive", "suspension", "spring", "shock", "damper"})
_PLANNED = {"moveit": "loads it: joint_limits.yaml has the speeds"}
_WANTED = {
    "effort": "effort, the highest torque in N·m (force in N),",
    "velocity": "velocity, the highest speed in rad/s (m/s),",
}


def check(model: Model, rule: Rule, *, most_effort: float, most_velocity: float) -> Iterator[Finding]:
    for joint in model.joints:
        limit = joint.limit
        missing = [] if limit is None else [n for n in ("effort", "velocity") if is_attribute_missing(limit, n)]
        if limit is not None and missing:
            children = [f"<{child.tag}>" for child in list_attributes_as_children(limit) if child.tag in missing]
            yield rule.finding(
                "missing",
                at=limit,
                severity=Severity.WARNING if is_read_without_urdfdom(model) else Severity.ERROR,
                joint=joint.name,
                names=" and ".join(missing),
                typed=""
                if not children
                else f" ({join_names(children)} inside it is an element, which no program reads)",
                wanted=" and ".join(_WANTED[name] for name in missing),
            )
    joints = [] if is_held_still(model.robot) else model.joints
    driven = [joint for joint in joints if joint.is_driven and not joint.is_held]
    chosen = collect_reasoned_joints(model)
    yield from _check_zeros(model, rule, driven, chosen=chosen)
    moving = [joint for joint in _drop_idle_joints(model, driven) if joint.name not in chosen]
    idle = _collect_read_joints(model)
    free = [joint for joint in moving if joint.name in idle and _is_endless(joint)]
    if beyond := [joint for joint in free if _is_beyond(joint, effort=most_effort, velocity=most_velocity)]:
        largest = _find_largest(beyond)
        name = "velocity" if largest["velocity"] >= most_velocity else "effort"
        yield _build_finding(rule, "endless", name, beyond, largest=max(map(_measure_reach, beyond)))
        moving = [joint for joint in moving if joint not in beyond]
    commanded = _collect_commanded_joints(model)
    # Where blocks name the motors of some joints, a spring or a free hinge has none, and no data sheet.
    moving = [joint for joint in moving if joint.name in commanded or not commanded]
    absurd: dict[str, list[Joint]] = {}
    unlimited = {name: [j for j in driven if j.get_limit_value(name) == _SDF_UNLIMITED] for name in _WANTED}
    without_both = [joint for joint in unlimited["effort"] if joint in unlimited["velocity"]]
    if without_both:  # as with the two placeholders below
        yield _build_finding(rule, "both-unlimited", "effort", without_both)
    for name, most in (("effort", most_effort), ("velocity", most_velocity)):
        # Joints with the same defect come from one template or one exporter's default.
        negative = [j for j in driven if (j.get_limit_value(name) or 0.0) < 0 and j not in without_both]
        if negative:
            is_unlimited = all(joint in unlimited[name] for joint in negative)
            yield _build_finding(rule, f"{name}-unlimited" if is_unlimited else f"{name}-negative", name, negative)
        absurd[name] = [joint for joint in moving if (joint.get_limit_value(name) or 0.0) >= most]
    both = [joint for joint in absurd["effort"] if joint in absurd["velocity"]]
    if both:  # the two placeholders of one <limit> are one defect
        largest = _find_largest(both)
        yield _build_finding(
            rule,
            "both-absurd",
            "effort",
            both,
            effort=largest["effort"],
            velocity=largest["velocity"],
            followers=_describe_followers(model, "effort", most_effort),
        )
    for name, most in (("effort", most_effort), ("velocity", most_velocity)):
        if one := [joint for joint in absurd[name] if joint not in both]:
            yield _build_finding(
                rule,
                f"{name}-absurd",
                name,
                one,
                severity=Severity.INFO if name == "velocity" else None,
                largest=_find_largest(one)[name],
                most=most,
                followers=_describe_followers(model, name, most),
            )


def _collect_read_joints(model: Model) -> set[str]:
    """Collect the joints that blocks of ros2_control only read: they have no command interface, so nothing drives them."""
    joints = [j for control in model.robot.find_children("ros2_control") for j in control.find_children("joint")]
    commanded = {joint.get("name") for joint in joints if joint.find_child("command_interface") is not None}
    return {joint.get("name") for joint in joints} - commanded


def _collect_commanded_joints(model: Model) -> set[str]:
    """Collect the joints with a transmission or a command interface, or in a plugin; none where only plugins name any."""
    controlled = (j for control in model.robot.find_children("ros2_control") for j in control.find_children("joint"))
    commanded = {joint.get("name") for joint in controlled if joint.find_child("command_interface") is not None}
    transmissions = model.robot.find_children("transmission")
    commanded |= {joint.get("name") for transmission in transmissions for joint in transmission.find_children("joint")}
    return commanded and commanded | collect_plugin_texts(model)


def _measure_reach(joint: Joint) -> float:
    """Return how far (rad or m) from zero both ends of a range are at least; 0 for no range."""
    span = joint.position_range
    return 0.0 if span is None else min(-span[0], span[1])


def _is_endless(joint: Joint) -> bool:
    """Whether a revolute joint has a range that no turning reaches the end of."""
    return joint.type == "revolute" and _measure_reach(joint) >= _ENDLESS


def _is_beyond(joint: Joint, **most: float) -> bool:
    return any((joint.get_limit_value(name) or 0.0) >= value for name, value in most.items())


def _describe_followers(model: Model, name: str, most: float) -> str:
    """Say how many joints that mimic others have such a limit too: no drive turns them, but a repair means them."""
    count = sum(joint.mimic is not None and (joint.get_limit_value(name) or 0.0) >= most for joint in model.joints)
    if not count:
        return ""
    return f"; so {'does' if count == 1 else 'do'} {format_count(count, 'joint that mimics another', 'joints that mimic others')}"


def _drop_idle_joints(model: Model, joints: Sequence[Joint]) -> list[Joint]:
    """Leave out the joints without a drive: those that are passive or springs by name, and those that move neither a mass nor a
    shape nor another joint, but carry a number (the stiffness of a real joint) to a controller.

    All are kept if none is left: then the file describes no bodies.
    """
    parents = {joint.parent for joint in model.joints}
    empty = {
        link.name
        for link in model.links
        if not (link.visuals or link.collisions or link.inertial or link.name in parents)
    }
    return [joint for joint in joints if joint.child not in empty and not _is_named_passive(joint)] or list(joints)


def _is_named_passive(joint: Joint) -> bool:
    """Whether the name says that no drive turns the joint: a data sheet has no speed for it."""
    return not _PASSIVE_WORDS.isdisjoint(word.lower() for word in split_name_words(joint.name))


def _find_largest(joints: Sequence[Joint]) -> dict[str, float]:
    """Return the largest of each limit."""
    return {name: max(j.get_limit_value(name) or 0.0 for j in joints) for name in ("effort", "velocity")}


def _check_zeros(model: Model, rule: Rule, driven: Sequence[Joint], *, chosen: AbstractSet[str]) -> Iterator[Finding]:
    """Report limits of zero; ``chosen``: the joints for whose limits a comment gives a reason."""
    still = {joint.name for joint in driven if joint.get_limit_value("velocity") == 0}
    powerless = [joint for joint in driven if joint.get_limit_value("effort") == 0]
    simulated = _collect_simulated_motors(model)
    with_motor = [joint for joint in powerless if joint.name in simulated]
    # A velocity of 0 that all joints have says nothing of one.
    idle = still if len(still) < len(driven) else set()
    # Nor has a joint a motor, such as the pin that closes a loop, that nothing commands while something commands others.
    commanded = _collect_commanded_joints(model)
    loose = {joint.name for joint in driven} - commanded if commanded else set()
    forgotten = [
        j
        for j in powerless
        if j not in with_motor and j.name not in idle | loose | chosen and _is_odd(j, powerless, driven)
    ]
    without = [joint for joint in powerless if joint not in with_motor and joint not in forgotten]
    # Where the velocity is 0 too, who writes the effort alone repairs half.
    # No simulator reads a file that the project leaves aside for another one.
    is_unused = bool(with_motor) and is_certainly_left_aside(model.source) and not is_named_around(model.source)
    unused = Severity.INFO if is_unused else None
    for is_still in (False, True):
        if alike := [joint for joint in with_motor if (joint.name in still and not _is_locked(joint)) == is_still]:
            also, speed = (' and velocity="0"', "; and the highest speed in rad/s (m/s)") if is_still else ("", "")
            yield _build_finding(rule, "effort-zero", "effort", alike, severity=unused, also=also, speed=speed)
    if forgotten:
        yield _build_finding(rule, "effort-odd", "effort", forgotten)
    # If no joint has either, the fields of the exporter's dialog were empty. Where lower and upper are 0 too, JNT005 reports all
    # four, and this finding gives way to it.
    is_empty = len(without) == len(driven) > 1 and all(joint.name in still for joint in without)
    is_empty = is_empty and not has_bare_joints(model)  # a drawing that moves needs neither
    named = collect_plugin_texts(model) if is_empty else frozenset()
    for is_locked in (True, False):
        if alike := [joint for joint in without if (joint.name in still and _is_locked(joint)) == is_locked]:
            # A plugin that drives the joints (rotors) reads no limit, nor does a script that sets the force of Bullet's motors.
            is_read = not is_only_for_bullet(model) and not all(
                joint.name in named or is_named_rotor(joint) for joint in alike
            )
            message = "both-zero" if is_empty and is_read else "effort-unused"
            yield _build_finding(rule, message, "effort", alike, severity=Severity.INFO)
    is_odd = any((joint.get_limit_value("velocity") or 0.0) > 0 for joint in driven)
    # A joint without effort has no motor, unless no joint has any: then nobody wrote the efforts.
    unknown = is_odd and len(powerless) == len(driven)
    with_command = {joint.get("name") for _, joint in _iter_simulated_joints(model)}
    # JNT005 reports a joint that cannot move: it needs no speed. Of those with a motor, both numbers are told above.
    slow = [
        joint
        for joint in driven
        if joint.name in still
        and joint not in with_motor
        and (unknown or joint not in without or (joint.name in with_command and not is_empty))
        and not _is_locked(joint)
    ]
    if slow:
        is_planned = _have_planning_speeds(model, slow)
        yield _build_finding(
            rule,
            "velocity-zero",
            "velocity",
            slow,
            severity=None if is_odd and not is_planned and _is_any_used(model, slow, commanded) else Severity.INFO,
            consequences=_PLANNED if is_planned else None,
            **_describe_joints_beside(slow, [joint for joint in powerless if joint.name in still]),
        )


def _describe_joints_beside(slow: Sequence[Joint], both: Sequence[Joint]) -> dict[str, str]:
    """Say that other joints have a velocity of 0 too, but no effort either, so that the number is not taken for that of all."""
    others = [joint for joint in both if joint not in slow]
    if not others:
        return {"alone": "", "beside": ""}
    counted = format_count(len(others), "other joint has", "other joints have")
    return {
        "alone": "" if any(joint in both for joint in slow) else " but an effort limit",
        "beside": f'; {counted} velocity="0" and effort="0" ({join_names((joint.name for joint in others), 4)})',
    }


def _have_planning_speeds(model: Model, joints: Sequence[Joint]) -> bool:
    """Whether MoveIt gets the speeds of joints from its own limits, which replace those of the model."""
    from urdfcheck.model.motion.planning_limits import load_joint_limits  # few models have such joints
    from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
    from urdfcheck.source.ros.srdf import is_about_model, is_set_up_for_another

    known = {
        limits.joint.text
        for srdf in semantic_descriptions(model)
        if is_about_model(srdf, model.source) and not is_set_up_for_another(srdf, model.source)
        for limits in load_joint_limits(model, srdf)
        if limits.is_on("has_velocity_limits") and (limits.get_number("max_velocity") or 0.0) > 0.0
    }
    return all(joint.name in known for joint in joints)


def _is_any_used(model: Model, joints: Sequence[Joint], commanded: AbstractSet[str]) -> bool:
    """Whether a program that reads speeds may move one of some joints: a controller, which takes a limit of 0 literally, a plugin
    that names the joint, or MoveIt, which plans for its group with a default speed. Any may where no drive is known."""
    from urdfcheck.model.motion.planning_limits import collect_listed_joints  # few models have such joints
    from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions

    moved = set(commanded)
    for srdf in semantic_descriptions(model):
        for group in srdf.root.find_children("group"):
            moved |= collect_listed_joints(model, srdf, group)
    return not moved or any(joint.name in moved | collect_plugin_texts(model) for joint in joints)


def _is_odd(joint: Joint, powerless: Sequence[Joint], driven: Sequence[Joint]) -> bool:
    """Whether a joint without effort is like others that have one: those of its name elsewhere (``front_hip``, ``joint_3``), or
    all of its type in a robot. Three others of a name are like it whatever their type: the slide ``joint_3`` of a SCARA.

    Joints with springs and casters come in pairs at least, and all of them have none.
    """
    name = _strip_place(joint)
    named = [other for other in driven if other is not joint and _strip_place(other) == name]
    like = [other for other in named if other.type == joint.type] or (named if len(named) >= _MANY - 1 else [])
    if like:
        return not any(other in powerless for other in like)
    of_type = [other for other in driven if other.type == joint.type]
    return len(of_type) >= _MANY and len(powerless) == 1 and joint.type != "continuous"


def _strip_place(joint: Joint) -> tuple[str, ...]:
    """Return the words of a name without places and numbers."""
    return tuple(word for word in remove_places(joint.name) if not word.isdigit())


def _is_locked(joint: Joint) -> bool:
    """Whether lower and upper of a joint with a range are both typed as 0."""
    limit = joint.limit
    if limit is None or joint.type == "continuous" or not {"lower", "upper"} <= limit.attributes.keys():
        return False
    return joint.get_limit_value("lower") == joint.get_limit_value("upper") == 0


def _collect_simulated_motors(model: Model) -> frozenset[str]:
    """Collect the joints whose motors a simulator makes from the file, with the effort limit as the most that they can do: those
    with an effort interface of a transmission, or with a command interface of a simulator's ros2_control hardware."""
    transmitted = (
        joint
        for transmission in model.robot.find_children("transmission")
        for joint in transmission.find_children("joint")
        if any(_EFFORT_INTERFACE in e.text for e in transmission.walk() if e.tag == "hardwareInterface")
    )
    controlled = (joint for control, joint in _iter_simulated_joints(model) if _is_moved_by_effort(control, joint))
    return frozenset(joint.get("name") for joint in (*transmitted, *controlled))


def _iter_simulated_joints(model: Model) -> Iterator[tuple[Element, Element]]:
    """Yield the joints with a command interface of a simulator's ros2_control hardware, each after its block."""
    for control in model.robot.find_children("ros2_control"):
        if is_simulated_hardware(control):
            for joint in control.find_children("joint"):
                if joint.find_child("command_interface") is not None:
                    yield control, joint


def _is_moved_by_effort(control: Element, joint: Element) -> bool:
    """Whether what moves a joint of a simulator's hardware is limited by its effort.

    gazebo_ros2_control sets positions and velocities of Classic's joints directly, unless a PID turns them into efforts.
    """
    if not any(_SETS_DIRECTLY in plugin.text for plugin in control.walk() if plugin.tag == "plugin"):
        return True
    has_pid = any("kp" in param.get("name") for param in joint.walk() if param.tag == "param")
    return has_pid or any(
        command.get("name").strip() == "effort" for command in joint.find_children("command_interface")
    )


def _build_finding(
    rule: Rule,
    message: str,
    name: str,
    joints: Sequence[Joint],
    *,
    severity: Severity | None = None,
    consequences: Mapping[str, str] | None = None,
    **data: float | str,
) -> Finding:
    return build_group_finding(
        rule,
        message,
        [joint.limit.attributes[name] for joint in joints if joint.limit is not None],
        severity=severity,
        consequences=consequences,
        joints=join_names(joint.name for joint in joints),
        count=len(joints),
        noun="joint" if len(joints) == 1 else "joints",
        verb="has" if len(joints) == 1 else "have",
        **data,
    )
