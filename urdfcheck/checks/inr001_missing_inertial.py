"""INR001 reports moving bodies without an `<inertial>`."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Link, Model
from urdfcheck.model.gazebo import collect_plugin_texts, list_sensors
from urdfcheck.model.motion.controllers import collect_controlled_joints
from urdfcheck.model.rigid_bodies import RigidLinkGroup, has_collision_geometry, list_rigid_bodies
from urdfcheck.model.stated_reasons import is_called_virtual
from urdfcheck.model.use.display import has_bare_joints, is_loaded_for_frames
from urdfcheck.model.use.gazebo_starts import gives_gazebo_sdf, is_left_to_world, is_spawned_in_gazebo
from urdfcheck.model.use.simulators import is_modelled_for_mujoco, is_started_in_simulator
from urdfcheck.policy.consumers import SIMULATORS
from urdfcheck.source.text.grammar import JOINT_TYPES
from urdfcheck.source.xacro.usage import find_unprefixed_tags

# Those that stop, or compute with what they assume, where a body that moves has no mass. Gazebo drops the link.
_WEIGHING = SIMULATORS - {"gazebo"} | {"pinocchio"}
# MuJoCo's treatment of a body without mass.
INFERS = "replaces the missing inertial by that of the collision geometry at 1000 kg/m³"
# Isaac Sim's, where no collision geometry says how large the body is.
OWN_CHOICE = "replaces the missing inertial by a mass of its own choice"
REFUSES = "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL"
# Pinocchio and Drake: the joint moves a mass behind the body, or none at all.
LIGHT = "loads it without mass"
NAN = "computes NaN accelerations: the joint moves no mass (Drake stops with an error)"

# What to do about a frame that moves: one between two joints, or the last of its chain.
_JOINING = (
    "add an <inertial>; if the link only joins two joints, use small values compared with its neighbours', not zero"
)
_LAST = "make its joint fixed if it need not move; otherwise add an <inertial> small compared with its neighbours'"


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    moving = [body for body in list_rigid_bodies(model) if body.is_movable]
    if not moving:
        return
    if all(link.inertial is None for link in model.links):
        if is_modelled_for_mujoco(model) and not SIMULATORS.intersection(model.targets):
            return
        solid = all(has_collision_geometry(model, body) for body in moving)
        is_simulated = is_started_in_simulator(model) and not gives_gazebo_sdf(model) and not is_left_to_world(model)
        yield rule.finding(
            "kinematic" if SIMULATORS.intersection(model.targets) or is_simulated else "display",
            at=model.name_location,
            severity=Severity.WARNING if is_simulated and is_spawned_in_gazebo(model) else Severity.INFO,
            consequences={"mujoco": INFERS if solid else REFUSES},
            robot=model.name,
            what=f"robot {model.name}" if model.name else "the robot",
            links=len(model.links),
        )
        return
    is_known = all(model.tree.parent_joint[body.links[0]].type in JOINT_TYPES for body in moving)
    if is_known and has_bare_joints(model) and not SIMULATORS.intersection(model.targets):
        yield rule.finding(
            "drawing",
            at=model.name_location,
            severity=Severity.INFO,
            what=f"robot {model.name}" if model.name else "the robot",
            bodies=len(moving),
        )
        return
    if "bullet" in model.targets:
        yield from _check_assumed_masses(rule, moving, model)
    yield from _check_inferred_masses(rule, moving, model)
    blocks = model.robot.find_children("gazebo")
    added = {child.get("name").strip() for block in blocks for child in block.children if child.tag == "joint"}
    for body in moving:
        links = [model.link_by_name[name] for name in body.links]
        if any(link.inertial is not None for link in links):
            continue
        head = links[0]
        joint = model.tree.parent_joint[head.name]
        if joint.type not in JOINT_TYPES:
            continue  # it may be meant to be fixed (KIN009)
        behind, heavy = _inspect_subtree(model, body)
        is_solid = has_collision_geometry(model, body)
        message = "missing" if any(link.visuals or link.collisions for link in links) else "frame"
        if message == "frame" and joint.name in added:
            continue  # Gazebo has this joint from the block, between the links that are meant
        yield rule.finding(
            message,
            at=head,
            severity=Severity.INFO
            if is_loaded_for_frames(model) or (message == "frame" and not heavy and _is_virtual(model, body))
            else None,
            consequences={
                "mujoco": INFERS if is_solid else REFUSES,
                **({} if is_solid else {"isaac": OWN_CHOICE}),
                **dict.fromkeys(("pinocchio", "drake"), LIGHT if heavy else NAN),
            },
            link=head.name,
            joint=joint.name,
            lost=f"the link and the {format_count(behind, 'link')} behind it" if behind else "the link",
            behind=behind,
            repair=(_JOINING if behind else _LAST) if message == "frame" else _describe_addition(model, links),
        )


def _is_virtual(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a comment says that a body, or one before it that has no mass either, is virtual, and nothing drives its joint: it
    is there for its frame, which no simulator has to move. Not where a program that needs masses is meant, nor where a sensor of
    Gazebo is on it, which is dropped with it."""
    if not _WEIGHING.isdisjoint(model.targets) or model.robot.find_child("mujoco") is not None:
        return False
    tree = model.tree
    joint = tree.parent_joint[body.links[0]]
    places = {joint.name, *body.links}
    # Not only what is commanded (JNT007): a joint whose state is read has to be in the simulation, too.
    named = collect_controlled_joints(model) | collect_plugin_texts(model)
    if joint.name in named or any(s.reference in places for s in list_sensors(model)):
        return False
    while True:
        elements = (joint.element, *(model.link_by_name[name].element for name in tree.list_body_links(joint.child)))
        if any(is_called_virtual(model, element) for element in elements):
            return True
        before = tree.list_body_links(joint.parent)
        if before[0] not in tree.parent_joint or any(model.link_by_name[name].inertial is not None for name in before):
            return False
        joint = tree.parent_joint[before[0]]


def _describe_addition(model: Model, links: list[Link]) -> str:
    """Say what to add to a body; first what is there already, and is only called wrongly."""
    elements = {id(link.element) for link in links}
    calls = find_unprefixed_tags(model.source.trees, model.robot, only_calls=True)
    called = next((call.tag for call in calls if call.parent is not None and id(call.parent) in elements), None)
    if called is None:
        return "add an <inertial> with mass, COM and inertia tensor"
    return f"write <xacro:{called}> for <{called}> if that macro makes its <inertial> (XAC007); otherwise add one"


def _check_assumed_masses(rule: Rule, moving: list[RigidLinkGroup], model: Model) -> Iterator[Finding]:
    """Report together all links for which Bullet assumes a mass although their moving body has one."""
    frames = _list_bare_links(moving, model)
    if frames:
        yield rule.finding(
            "assumed",
            at=frames[0],
            related=frames[1:],
            links=join_names(link.name for link in frames),
            count=format_count(len(frames), "link"),
            added=len(frames),
        )


def _check_inferred_masses(rule: Rule, moving: list[RigidLinkGroup], model: Model) -> Iterator[Finding]:
    """Report together all links whose collision geometry MuJoCo gives a mass although their moving body has one."""
    links = [link for link in _list_bare_links(moving, model) if link.collisions]
    if links:
        yield build_group_finding(
            rule,
            "inferred",
            links,
            severity=Severity.WARNING if "mujoco" in model.targets else Severity.INFO,
            links=join_names(link.name for link in links),
            count=format_count(len(links), "link"),
        )


def _list_bare_links(moving: list[RigidLinkGroup], model: Model) -> list[Link]:
    """List the links without inertial in moving bodies that have one."""
    bare: list[Link] = []
    for body in moving:
        links = [model.link_by_name[name] for name in body.links]
        without = [link for link in links if link.inertial is None]
        if len(without) < len(links):
            bare += without
    return bare


def _inspect_subtree(model: Model, body: RigidLinkGroup) -> tuple[int, bool]:
    """Return the number of links behind the body's first link, and whether one of them or that link has a mass."""
    queue, count, heavy = [body.links[0]], -1, False
    while queue:
        count += 1
        inertial = model.link_by_name[queue[-1]].inertial
        heavy = heavy or (inertial is not None and bool(inertial.mass))
        queue.extend(joint.child for joint in model.tree.child_joints[queue.pop()])
    return count, heavy
