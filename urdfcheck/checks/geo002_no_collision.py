"""GEO002 reports moving bodies with visuals but no collision geometry."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.gazebo import list_loop_joints, list_sensors
from urdfcheck.model.ground.support_polygon import LEG
from urdfcheck.model.motion.buoyancy import find_submersible_name
from urdfcheck.model.motion.fixed_base import HANDLING_NAME
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.parts import is_dummy_shape
from urdfcheck.model.rigid_bodies import RigidLinkGroup, has_collision_geometry, list_rigid_bodies
from urdfcheck.model.shapes.bounds import compute_bounding_box
from urdfcheck.model.stated_reasons import has_commented_child
from urdfcheck.model.use.simulators import is_left_aside, is_started_in_simulator
from urdfcheck.model.use.test_files import is_of_tests
from urdfcheck.model.wheel_names import WHEEL_NAME
from urdfcheck.source.text.engine_reactions import has_mujoco_option

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Names of links that stand for nothing that touches, and the share of the robot's mass that such a link has at most
# (chosen).
_SHOWN_NAME = re.compile(r"virtual|dummy|marker|indicator", re.IGNORECASE)
_NO_MASS = 1e-3
_BUMPER_NAME = re.compile(r"bumper", re.IGNORECASE)
# What MuJoCo does where the file tells it to keep visuals (checked with MuJoCo 4.0).
_UNUSED = "No SRDF was found in its package, and no file there names the model beside a simulator"
_OF_TESTS = "It is in a folder of tests, which may need none"
_KEPT = "draws the link, but nothing touches it"


def check(model: Model, rule: Rule, *, sheltered: float, majority: float, small: float) -> Iterator[Finding]:
    findings = _check_bodies(model, rule, sheltered=sheltered, majority=majority, small=small)
    keeps_visuals = has_mujoco_option(model.robot, "discardvisual", "false")
    for finding in findings:
        yield replace(finding, consequences={**finding.consequences, "mujoco": _KEPT}) if keeps_visuals else finding


def _check_bodies(model: Model, rule: Rule, *, sheltered: float, majority: float, small: float) -> Iterator[Finding]:
    moving = [body for body in list_rigid_bodies(model) if body.is_movable and _list_drawn_links(model, body)]
    if not moving:
        return
    if not any(link.collisions for link in model.links):
        if model.masses and not any(declared.mass for declared in model.masses):
            return  # made to be drawn: INR002 reports the masses of 0
        what = f"robot {model.name}" if model.name else "the robot"
        is_fixed = model.tree.order[0] == "world"
        is_simulated = _has_inertials(model, moving) and is_started_in_simulator(model)
        is_used = semantic_descriptions(model) or (is_simulated and not is_fixed)
        swims = find_submersible_name(model)
        is_meant = is_of_tests(model) or swims is not None
        yield rule.finding(
            "aside" if is_left_aside(model) else "none" if is_used and not is_meant else "drawing",
            at=model.name_location,
            severity=Severity.INFO,
            robot=model.name,
            what=what,
            bodies=len(moving),
            why=_OF_TESTS
            if is_of_tests(model)
            else f"The name {swims} suggests that it swims, where it may touch nothing"
            if swims is not None
            else "It is fixed to the world, so that it needs nothing to stand on"
            if is_simulated
            else _UNUSED,
        )
        return
    bare = [body for body in moving if not has_collision_geometry(model, body)]
    missing = [body for body in bare if not _is_exempt(model, body, sheltered)]
    if not missing:
        return
    if len(bare) > (1 - majority) * len(moving):
        yield _build_list_finding(model, rule, "most", missing, bare=len(bare), bodies=len(moving))
        return
    whole = [(shape, model.frames[link.name]) for link in model.links for shape in link.visuals]
    robot = compute_bounding_box(model, whole)
    between = [body for body in missing if _is_between(model, body) and _is_small(model, body, robot, small)]
    counterparts = _find_counterparts(model, missing)
    # What its counterpart on the other side has was forgotten, however small.
    between = [body for body in between if not _collides(model, counterparts.get(body.links[0]))]
    if between:
        yield _build_list_finding(model, rule, "between", between)
    paired = _find_paired_bodies(model, [body for body in missing if body not in between], counterparts)
    if paired:
        yield _build_list_finding(model, rule, "pairs", paired)
    rest = [body for body in missing if body not in between and body not in paired]
    carried = [] if is_started_in_simulator(model) else [body for body in rest if _is_on_bare_base(model, body)]
    if carried:
        yield _build_list_finding(model, rule, "carried", carried)
    light = [body for body in rest if body not in carried and _is_light_and_loose(model, body)]
    if light:
        yield _build_list_finding(model, rule, "light", light)
    for body in rest:
        if body in carried or body in light:
            continue
        link = _list_drawn_links(model, body)[0]
        joint = model.tree.parent_joint[body.links[0]]
        is_left_out = not _handles_or_rolls(joint) and any(
            has_commented_child(model, model.link_by_name[name].element, "collision") for name in body.links
        )
        yield rule.finding(
            "left_out" if is_left_out else "missing",
            at=link,
            severity=Severity.INFO if is_left_out else None,
            link=link.name,
            joint=joint.name,
            bodies=len(moving) - len(bare),
        )


def _is_light_and_loose(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body at the end of its branch weighs next to nothing, and its joint has an effort of 0 where others have one: an
    antenna or an ornament. Not what has to touch something, by its name or its sensor: a bumper moves by what hits it."""
    joint = model.tree.parent_joint[body.links[0]]
    if joint.get_limit_value("effort") != 0 or _handles_or_rolls(joint) or any(_list_moved_links(model, body)):
        return False
    feels = any(sensor.type == "contact" and sensor.reference in body.links for sensor in list_sensors(model))
    if feels or _BUMPER_NAME.search(f"{joint.name} {joint.child}"):
        return False
    return _weighs_nothing(model, body) and any((other.get_limit_value("effort") or 0.0) > 0 for other in model.joints)


def _handles_or_rolls(joint: Joint) -> bool:
    """Whether a joint moves what has to touch something, by its kind or its names: a wheel, a finger, a leg."""
    names = f"{joint.name} {joint.child}"
    return joint.type == "continuous" or any(one.search(names) for one in (HANDLING_NAME, WHEEL_NAME, LEG))


def _is_on_bare_base(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body hangs on the root's body, and that is drawn without a collision, too."""
    base = model.tree.list_body_links(model.tree.order[0])
    before = model.tree.parent_joint[body.links[0]].parent
    return before in base and not _collides(model, before) and any(model.link_by_name[name].visuals for name in base)


def _build_list_finding(
    model: Model, rule: Rule, message: str, listed: Sequence[RigidLinkGroup], **data: Any
) -> Finding:
    """Report several bodies as one info, at the first link that each of them draws."""
    heads = [_list_drawn_links(model, body)[0] for body in listed]
    links = join_names(link.name for link in heads)
    return rule.finding(message, at=heads[0], related=heads[1:], severity=Severity.INFO, links=links, **data)


def _has_inertials(model: Model, bodies: Sequence[RigidLinkGroup]) -> bool:
    """Whether one of the ``bodies`` can be simulated; if none can, INR001 says so."""
    return any(model.link_by_name[name].inertial is not None for body in bodies for name in body.links)


def _list_drawn_links(model: Model, body: RigidLinkGroup) -> list[Link]:
    """Return the links of a body that draw something."""
    links = [model.link_by_name[name] for name in body.links]
    return [link for link in links if any(not is_dummy_shape(shape) for shape in link.visuals)]


def _is_exempt(model: Model, body: RigidLinkGroup, sheltered: float) -> bool:
    """Whether a body does not need collision geometry: it is a marker, carries wheels, or is inside its neighbour's geometry."""
    weighs = any(model.link_by_name[name].inertial is not None for name in body.links)
    if not weighs and any(link.inertial is not None for link in model.links):
        return True
    if _is_pointer(model, body):
        return True
    return _is_wheel_carrier(model, body) or _is_sheltered(model, body, sheltered)


def _is_pointer(model: Model, body: RigidLinkGroup) -> bool:
    """Whether names say that a body is only shown, as the steering wheel of a plugin, and it weighs next to nothing: Gazebo shows
    no link without an inertial."""
    joint = model.tree.parent_joint[body.links[0]]
    if not any(_SHOWN_NAME.search(name) for name in (joint.name, *body.links)) or any(_list_moved_links(model, body)):
        return False
    return _weighs_nothing(model, body)


def _weighs_nothing(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body has at most a thousandth of the robot's mass."""
    mass = {link.name: link.inertial.mass or 0.0 for link in model.links if link.inertial is not None}
    return sum(mass.get(name, 0.0) for name in body.links) <= _NO_MASS * sum(mass.values())


def _find_counterparts(model: Model, missing: Sequence[RigidLinkGroup]) -> dict[str, str]:
    """Return the body on the other side of the robot by the body, both by their first links; nothing unless some of ``missing``
    carry others."""
    if not any(_list_moved_links(model, body) for body in missing):
        return {}
    from urdfcheck.model.likeness.mirror_pairs import mirror_pairs  # most models have none

    counterparts = {}
    for pair in mirror_pairs(model):
        one, other = (model.tree.list_body_links(name)[0] for name in (pair.one, pair.other))
        if one != other:
            counterparts.update({one: other, other: one})
    return counterparts


def _find_paired_bodies(
    model: Model, bare: Sequence[RigidLinkGroup], counterparts: Mapping[str, str]
) -> list[RigidLinkGroup]:
    """Return the bodies without collision geometry that carry others and have a counterpart which has none either.

    One that was forgotten is on one side, or at the end of a limb.
    """
    carrying = {body.links[0]: body for body in bare if any(_list_moved_links(model, body))}
    return [body for head, body in carrying.items() if counterparts.get(head) in carrying]


def _list_moved_links(model: Model, body: RigidLinkGroup) -> list[str]:
    """Return the links that the joints at the end of a body move."""
    return [j.child for name in body.links for j in model.tree.child_joints[name] if j.type != "fixed"]


def _is_between(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body is in the middle of a limb: before it, and behind it on every branch, a body has collision geometry, maybe
    after others that have none. A joint that closes a loop in Gazebo leads behind it too."""
    tree = model.tree
    before: str | None = body.links[0]
    while before is not None:
        joint = tree.parent_joint.get(tree.list_body_links(before)[0])
        before = None if joint is None else joint.parent
        if _collides(model, before):
            break
    behind = _list_moved_links(model, body)
    for _, *ends in list_loop_joints(model):
        if not set(body.links).isdisjoint(ends):
            behind += [end for end in ends if end not in body.links]
    return before is not None and bool(behind) and all(_leads_to_collision(model, link) for link in behind)


def _leads_to_collision(model: Model, link: str) -> bool:
    """Whether a link's body, or one that it moves, has collision geometry."""
    waiting = [link]
    for name in waiting:
        if _collides(model, name):
            return True
        body = model.tree.list_body_links(name)
        waiting += [joint.child for own in body for joint in model.tree.child_joints[own] if joint.type != "fixed"]
    return False


def _collides(model: Model, link: str | None) -> bool:
    """Whether the body of a link has collision geometry; False for no link."""
    return link is not None and any(model.link_by_name[name].collisions for name in model.tree.list_body_links(link))


def _is_small(model: Model, body: RigidLinkGroup, robot: Array | None, small: float) -> bool:
    """Whether a body is small compared with the ``robot``'s bounding box; whether it may be, if a mesh is missing."""
    placed = [(shape, model.frames[name]) for name in body.links for shape in model.link_by_name[name].visuals]
    own = compute_bounding_box(model, placed)
    if own is None or robot is None:
        return True
    return float(np.linalg.norm(own[1] - own[0])) <= small * float(np.linalg.norm(robot[1] - robot[0]))


def _is_wheel_carrier(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body moves only wheels that move nothing else: a caster's fork, a steering knuckle, a rocker."""
    tree = model.tree
    joints = [j for name in body.links for j in tree.child_joints[name] if j.type != "fixed"]
    return bool(joints) and all(
        joint.type == "continuous"
        and any(model.link_by_name[name].collisions for name in tree.list_body_links(joint.child))
        and not any(j.is_movable for name in tree.list_body_links(joint.child) for j in tree.child_joints[name])
        for joint in joints
    )


def _find_drawn_parent(model: Model, body: RigidLinkGroup) -> str:
    """Return the link that carries a body; one further back where that body is a bare frame, as between the axes of an eye."""
    tree = model.tree
    parent = tree.parent_joint[body.links[0]].parent
    while True:
        links = tree.list_body_links(parent)
        joint = tree.parent_joint.get(links[0])
        if joint is None or any(
            model.link_by_name[name].visuals or model.link_by_name[name].collisions for name in links
        ):
            return parent
        parent = joint.parent


def _is_sheltered(model: Model, body: RigidLinkGroup, sheltered: float) -> bool:
    """Whether the bounding box of a body's visuals lies within that of the collisions of a neighbouring body; whether it may, if
    a mesh of these is missing."""
    tree = model.tree
    near = [_find_drawn_parent(model, body), *_list_moved_links(model, body)]
    # Along the axes of the body's first link, so that the root's orientation does not matter.
    home = np.linalg.inv(model.frames[body.links[0]])
    drawn = compute_bounding_box(
        model, [(s, home @ model.frames[n]) for n in body.links for s in model.link_by_name[n].visuals]
    )
    if drawn is None:
        return False
    slack = sheltered * float(np.linalg.norm(drawn[1] - drawn[0]))
    for neighbour in near:
        placed = [
            (shape, home @ model.frames[name])
            for name in tree.list_body_links(neighbour)
            for shape in model.link_by_name[name].collisions
        ]
        around = compute_bounding_box(model, placed)
        if placed and around is None:
            return True
        if around is not None and (around[0] - slack <= drawn[0]).all() and (drawn[1] <= around[1] + slack).all():
            return True
    return False
