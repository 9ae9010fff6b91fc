"""Whether a file shows a defect at all: what a careful reader could go by.

Without evidence a defect is a robot like any other: a link whose tensor is ten times another, and no mesh, no twin and no limit
that contradicts it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from itertools import chain

import numpy as np
from injections import Array, Body, Numbers, rotation_of, tensor_of
from scoring import effect

from real.changes import Part, ReadRobot, read_numbers
from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.model.parts import Shape
from urdfcheck.model.shapes.bounds import compute_bounding_box
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, measure_link_geometry
from urdfcheck.model.tree import Tree

# A part whose numbers are so near to those of its drawing at uniform density (`scoring.effect`, without the mass) shows a defect
# that takes it so much further away, and beyond where 99 % of the sound parts are that have up to 60 % of their mass in lumps.
_SOUND, _FURTHER, _LUMPED = 1.0, 0.5, 1.8
# Second moments that are each so many times as large are as far off as that: so much may a rod be off about all axes.
_LUMPED_MOMENT = float(np.exp(_LUMPED / np.sqrt(3.0)))
# Cosine: an axis is along a rod within 25°.
_ALONG = 0.9
# So near its uniform solid a part also shows which defect it is: half the step between neighbouring units (a factor of 3.2).
_NEAR = 0.57
# kg/m³, of the convex hull, for what is drawn may be a cover: air and tungsten, with room.
_DENSITIES = 1.2, 25_000.0
# A part of a rigid body that is lighter than this share of it hardly changes how the body moves.
_LIGHT = 0.05
# What no robot's part may exceed: its COM or radius of gyration, in lengths of the whole robot.
_REACH = 1.0
# The triangle inequality is broken beyond rounding.
_SLACK = 1e-3
_SIDES = re.compile(r"(?i)(?<![a-z])(left|right|l|r|fl|fr|rl|rr|bl|br|front|rear|back|lf|rf|lh|rh|hl|hr)(?![a-z])")
_NUMBERS = re.compile(r"[0-9]+")
# A number that differs by less from a twin's is not seen.
_UNLIKE = 0.05
# A collision shape smaller than this share of what is drawn is a stand-in.
_TOKEN = 0.1
# Shorter origins (m) are zero.
_NO_LENGTH = 1e-6
_SCENE = re.compile(r"(?i)world|map|odom")
# To what is fixed to a link of this name simulators give no freedom.
_WORLD = "world"
# So many other joints say what a robot's joints are like.
_LEAST_JOINTS = 3


def find_inertial_evidence(part: Part, new: Numbers, *, with_meshes: bool, shared: Collection[str] = ()) -> set[str]:
    """Find what shows that an inertial with ``new`` numbers is wrong.

    :param shared: labels of links that the same text changes, such as those of one macro: they do not show anything.
    :returns: some of ``impossible``, ``reach``, ``mesh``, ``near`` (the mesh shows which defect it is, too), ``density``,
        ``twin``.
    """
    old = part.numbers
    assert old is not None
    found = set()
    if _is_impossible(new) and not _is_impossible(old) and not _is_point_of_body(part, new):
        found.add("impossible")
    if _is_base_of_limb(part) or _is_fixed_to_world(part):
        return found
    reach = measure_reach(part.owner)
    if _has_telling_joints(part) and max(_size(new)) > _REACH * reach >= max(_size(old)):
        found.add("reach")
    if max(old.mass, new.mass) < _LIGHT * _measure_body_mass(part):
        return found
    if with_meshes:
        found |= _find_drawn_evidence(part, old, new)
    if _differs_from_twins(part, old, new, with_meshes=with_meshes, shared=shared):
        found.add("twin")
    return found


def _is_base_of_limb(part: Part) -> bool:
    """Whether a link belongs to the root's body, and one limb of two joints or more is all that moves: an arm, whose base is
    bolted down."""
    model = part.owner.model
    try:
        tree = model.tree
        body = tree.list_body_links(tree.root)
        limbs = [joint for name in body for joint in tree.child_joints[name] if joint.is_movable]
        return part.link.name in body and len(limbs) == 1 < sum(joint.is_movable for joint in model.joints)
    except FactUnavailableError:
        return False


def _is_fixed_to_world(part: Part) -> bool:
    """Whether a link is part of a body that is fixed to ``world``: it cannot move, and nothing depends on its inertia."""
    tree = _get_tree(part)
    return tree is not None and tree.root == _WORLD and part.link.name in tree.list_body_links(_WORLD)


def _is_point_of_body(part: Part, new: Numbers) -> bool:
    """Whether a link is a point mass that is fixed to links with a tensor: a body can have a mass in one point."""
    tree = _get_tree(part)
    if tree is None or new.six.any() or not new.mass > 0:
        return False
    body = set(tree.list_body_links(part.link.name)) - {part.link.name}
    return any(
        other.link.name in body and other.numbers is not None and other.numbers.six.any() for other in part.owner.parts
    )


def _get_tree(part: Part) -> Tree | None:
    """Return the tree of the robot; None where it is broken."""
    try:
        return part.owner.model.tree
    except FactUnavailableError:
        return None


def _has_telling_joints(part: Part) -> bool:
    """Whether so many joints have a length that they say how large the robot is."""
    lengths = [float(np.linalg.norm(joint.origin.xyz or (0, 0, 0))) for joint in part.owner.model.joints]
    return sum(length > _NO_LENGTH for length in lengths) >= _LEAST_JOINTS


def _measure_body_mass(part: Part) -> float:
    """Return the mass (kg) of the links that are fixed to a link, itself included; zero where the tree is broken."""
    model = part.owner.model
    try:
        body = set(model.tree.list_body_links(part.link.name))
    except FactUnavailableError:
        return 0.0
    return sum(n.mass for other in part.owner.parts if other.link.name in body and (n := other.numbers) is not None)


def find_joint_evidence(part: Part, old: Array, new: Array, shared: Collection[str] = ()) -> set[str]:
    """Find what shows that a joint's origin or axis is wrong: a joint on the other side, or two others of a row on the same
    parent; or lengths that no other joint has.

    :param shared: joints that the same text changes, such as those of one macro: they do not show anything.
    """
    joint = part.joint
    assert joint is not None
    if joint.type == "fixed" and not _carries_something(part):
        return set()  # where a bare frame should be shows nowhere
    found = set()
    mine = np.linalg.norm(joint.origin.xyz or (0, 0, 0))
    sides = row = 0
    lengths = [1e-9]
    for other in part.owner.model.joints:
        if other.name == joint.name or f"joint[{other.name}]" in shared:
            continue
        length = float(np.linalg.norm(other.origin.xyz or (0, 0, 0)))
        lengths.append(length)
        if other.type == joint.type and np.isclose(length, mine, rtol=1e-3, atol=1e-5):
            # Two covers with the origin of the body that they are on say nothing of each other.
            may_mirror = mine > _NO_LENGTH or other.parent != joint.parent
            sides += (
                may_mirror
                and _is_other_side(other.name, joint.name)
                and _is_other_side(other.parent, joint.parent, or_same=True)
            )
            row += other.parent == joint.parent and _strip(other.name) == _strip(joint.name)
    if sides or row >= 2:
        found.add("twin")
    if len(new) == 3 and new.any() and row < 2 and _makes_images(part, old, new):
        found.discard("twin")
    # One or two other joints do not say how large a robot is.
    known = sum(length > _NO_LENGTH for length in lengths) >= _LEAST_JOINTS
    if (
        known
        and not _SCENE.fullmatch(joint.parent)  # a robot is anywhere in its world
        and len(new) == 3
        and np.linalg.norm(new) > 10 * max(lengths)
        and np.linalg.norm(new) > 2 * np.linalg.norm(old)
    ):
        found.add("reach")
    return found


def _makes_images(part: Part, old: Array, new: Array) -> bool:
    """Whether a joint that had the origin of its counterpart, on the same link, now has the one with one other sign: a left and a
    right part look like that."""
    joint = part.joint
    assert joint is not None
    is_sign = np.allclose(np.abs(old), np.abs(new)) and int((~np.isclose(old, new)).sum()) == 1
    return is_sign and any(
        other.parent == joint.parent
        and _is_other_side(other.name, joint.name)
        and np.allclose(other.origin.xyz or (0, 0, 0), old)
        for other in part.owner.model.joints
        if other is not joint
    )


def is_zero_of_hinge(part: Part, rpy: Sequence[float]) -> bool:
    """Whether a joint without limits is rotated about its own axis: its zero is elsewhere, and no number depends on that."""
    joint = part.joint
    assert joint is not None
    if joint.type != "continuous" or joint.axis is None or joint.origin.matrix is None:
        return False
    away = rotation_of(np.array(rpy)) @ joint.origin.matrix[:3, :3].T
    axis = joint.origin.matrix[:3, :3] @ np.array(joint.axis)
    return bool(np.allclose(away @ axis, axis, atol=1e-6 * float(np.linalg.norm(axis))))


def find_reversal_evidence(part: Part, shared: Collection[str] = ()) -> set[str]:
    """Find what shows that an axis has the other sign: three others of its name with the axis that it had, or a joint on the
    other side whose range is not symmetric, or that is a wheel.

    Published robots have both conventions for left and right: axes that are mirrored, and axes that are parallel.
    """
    joint = part.joint
    assert joint is not None
    evidence = find_joint_evidence(part, np.zeros(3), np.zeros(3), shared)
    others = [
        other
        for other in part.owner.model.joints
        if other is not joint and other.type == joint.type and _name_without_side(other.name) == _name_without_side(joint.name)
        and f"joint[{other.name}]" not in shared
    ]  # fmt: skip
    if joint.type == "continuous" or sum(other.axis == joint.axis for other in others) >= _LEAST_JOINTS:
        return evidence
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    return evidence if lower is not None and upper is not None and not np.isclose(lower, -upper, atol=1e-3) else set()


def find_zero_evidence(part: Part, name: str, shared: Collection[str] = ()) -> set[str]:
    """Find what shows that an effort or a velocity must not be 0: all joints of its name have one, or all others, three
    at least. A robot of one joint, or one whose other joints have 0 too, does not show it; nor does a joint that follows another
    one (`<mimic>`), which has no drive of its own that a limit would stop.

    A joint without effort may have a spring instead of a drive: the slide in the tool of an arm, or all joints that one macro
    makes. So the three others are of its type, and none is without effort by the same text.
    """
    joint = part.joint
    assert joint is not None
    if not joint.is_driven:
        return set()
    may_be_spring = name == "effort"
    all_others = [other for other in part.owner.model.joints if other is not joint and other.is_driven]
    others = [other for other in all_others if f"joint[{other.name}]" not in shared]
    values = {other.name: other.get_limit_value(name) or 0.0 for other in others}
    like = [other for other in others if other.type == joint.type and _strip(other.name) == _strip(joint.name)]
    if like:
        return {"twin"} if min(values[other.name] for other in like) > 0 else set()
    if may_be_spring and len(others) < len(all_others):
        return set()
    count = sum(other.type == joint.type or not may_be_spring for other in others)
    return {"others"} if count >= _LEAST_JOINTS and min(values.values()) > 0 else set()


def find_shape_evidence(part: Part, shape: Shape, moved: float) -> set[str]:
    """Find what shows that a collision shape was moved by so many metres: the same mesh is drawn at the old place, or the shape
    is smaller than that. One that is far smaller than what the link draws stands for nothing, wherever it is."""
    name = shape.mesh_filename
    if name is not None:
        drawn = [visual.mesh_filename for visual in part.link.visuals if visual.origin.xyz == shape.origin.xyz]
        return {"drawn"} if any(other is not None and other.value == name.value for other in drawn) else set()
    size = 2 * max(shape.size) if shape.size else np.inf
    is_part = _measure_edge(part, [shape]) >= _TOKEN * _measure_edge(part, part.link.visuals)
    return {"drawn"} if moved > size and is_part else set()


def _measure_edge(part: Part, shapes: Sequence[Shape]) -> float:
    """Return the longest edge (m) of the box around some shapes of a link; 0 where that is not known."""
    box = compute_bounding_box(part.owner.model, [(shape, np.eye(4)) for shape in shapes])
    return 0.0 if box is None else float(np.ptp(box, axis=0).max())


def find_size_evidence(part: Part, shared: Collection[str]) -> set[str]:
    """Find what shows that a collision shape has another size: two others of a row, or the other side, have the old one.

    What is drawn does not: of the collision boxes of published robots 98 % are 0.49 to 1.47 times as large as what is drawn, and
    sound ones 0.2 to 5 times (`rules/GEO003-*.md`).

    :param shared: labels of links that the same text changes.
    """
    mine = _list_sizes(part)
    sides = row = 0
    for other in part.owner.parts:
        if other is part or f"link[{other.link.name}]" in shared or _list_sizes(other) != mine:
            continue
        sides += _is_other_side(other.link.name, part.link.name)
        row += _strip(other.link.name) == _strip(part.link.name)
    return {"twin"} if sides or row >= 2 else set()


def _list_sizes(part: Part) -> list[tuple[str, tuple[float, ...]]]:
    return [(shape.kind, tuple(shape.size or ())) for shape in part.link.collisions]


def measure_reach(read: ReadRobot) -> float:
    """Return the length of the whole robot (m): all joints' distances, how far they slide, and the largest thing drawn by a
    primitive or a COM."""
    lengths = [float(np.linalg.norm(joint.origin.xyz or (0, 0, 0))) for joint in read.model.joints]
    sizes = [
        float(np.abs(values).max())
        for link in read.model.links
        for shape in chain(link.visuals, link.collisions)
        for name in ("size", "radius", "length")
        if (values := read_numbers(shape.geometry_element, name)) is not None and len(values)
    ]
    coms = [max(_size(part.numbers)) for part in read.parts if part.numbers is not None]
    travels = [
        max(abs(joint.get_limit_value(name) or 0.0) for name in ("lower", "upper"))
        for joint in read.model.joints
        if joint.type == "prismatic"
    ]
    # One part with wrong numbers of its own does not stretch the robot.
    return sum(lengths) + sum(travels) + max([*sizes, float(np.median(coms)) if coms else 0.0, 0.05])


def _is_impossible(n: Numbers) -> bool:
    if n.mass <= 0:
        return True
    moments = np.linalg.eigvalsh(tensor_of(n.six))
    return bool(moments[0] <= 0 or moments[0] + moments[1] < moments[2] * (1 - _SLACK))


def _size(n: Numbers) -> tuple[float, float]:
    """Distance of the COM and radius of gyration (m)."""
    return float(np.linalg.norm(n.com)), float(np.sqrt(max(np.trace(tensor_of(n.six)), 0) / (2 * n.mass)))


def _find_drawn_evidence(part: Part, old: Numbers, new: Numbers) -> set[str]:
    try:
        drawn = measure_link_geometry(part.owner.model, part.link)
    except FactUnavailableError:
        return set()
    if drawn is None or not drawn.closed or drawn.solid.volume <= 0:
        return set()
    solid, found = drawn.solid, set()
    covariance = np.asarray(solid.covariance)
    tensor = np.trace(covariance) * np.eye(3) - covariance

    def differ(n: Numbers) -> float:
        given = DeclaredInertial(mass=n.mass, com=n.com, tensor=tensor_of(n.six), rotation=rotation_of(n.rpy))
        return effect(Body(n.mass, np.asarray(solid.com), tensor * n.mass), given)

    with np.errstate(all="ignore"):
        sound, broken = differ(old), differ(new)
    is_far = sound < _SOUND and broken > max(sound + _FURTHER, _LUMPED)
    if is_far and not _swings_as_before(part, old, new, tensor * new.mass):
        found |= {"mesh", "near"} if sound < _NEAR else {"mesh"}
    if explain_collision_stand_in(part.owner.model, part.link) == "unread":
        return found  # what is drawn may be larger than what collides
    low, high = _DENSITIES
    largest = _measure_body_hulls(part)

    def is_material(mass: float) -> bool:
        return low * solid.volume < mass < high * largest

    if is_material(old.mass) and not is_material(new.mass):
        found.add("density")
    return found


def _measure_body_hulls(part: Part) -> float:
    """Return the volume (m³) of the hulls of all links that are fixed to a link, itself included: which of them has the mass of
    another is arbitrary."""
    model = part.owner.model
    try:
        names = model.tree.list_body_links(part.link.name)
    except FactUnavailableError:
        names = (part.link.name,)
    drawn = (measure_link_geometry(model, model.link_by_name[name]) for name in names)
    hulls = ((one.solid.volume if one.hull is None else one.hull.volume) for one in drawn if one is not None)
    return sum(volume for volume in hulls if volume > 0)


def _swings_as_before(part: Part, old: Numbers, new: Numbers, solid: Array) -> bool:
    """Whether only the moment of a rod about its own length is beyond that of a lumped part, and its joint does not turn it about
    that. Mass and COM are as they were.

    :param solid: (3, 3), the tensor of the uniform solid in the link's axes.
    """
    if not (np.isclose(new.mass, old.mass) and np.allclose(new.com, old.com)):
        return False
    moments, axes = np.linalg.eigh(solid)
    turn = rotation_of(new.rpy).T @ axes
    ratios = np.diag(turn.T @ tensor_of(new.six) @ turn)[1:] / moments[1:]
    if not (ratios.max() < _LUMPED_MOMENT and ratios.min() > 1.0 / _LUMPED_MOMENT):
        return False
    joint = part.joint
    if joint is None or joint.axis is None or joint.type not in ("revolute", "continuous"):
        return True
    axis = np.array(joint.axis)
    return bool(abs(float(axes[:, 0] @ axis)) <= _ALONG * float(np.linalg.norm(axis)))


def _is_drawing_known(part: Part) -> bool:
    """Whether what a link draws can be read."""
    try:
        return measure_link_geometry(part.owner.model, part.link) is not None
    except FactUnavailableError:
        return False


def _differs_from_twins(part: Part, old: Numbers, new: Numbers, *, with_meshes: bool, shared: Collection[str]) -> bool:
    """Whether mass, moments or the COM's distance now differ from those of the other side, or of two others of a row. Where what
    is drawn is not known, the frames may be at different points of equal parts, and the COM's distance says nothing."""
    count = 5 if with_meshes and _is_drawing_known(part) else 4
    if np.allclose(_list_invariants(new)[:count], _list_invariants(old)[:count], rtol=_UNLIKE):
        return False
    sides = row = 0
    for other in part.owner.parts:
        n = other.numbers
        if (
            other is part
            or f"link[{other.link.name}]" in shared
            or n is None
            or not np.allclose(_list_invariants(n), _list_invariants(old), rtol=1e-2)
        ):
            continue
        sides += _is_other_side(other.link.name, part.link.name)
        row += _strip(other.link.name) == _strip(part.link.name)
    return bool(sides or row >= 2)


def _list_invariants(n: Numbers) -> list[float]:
    """What another frame or a mirror does not change."""
    return [n.mass, *np.linalg.eigvalsh(tensor_of(n.six)).tolist(), _size(n)[0] + 1e-4]


def _carries_something(part: Part) -> bool:
    """Whether a link behind the joint has a shape or a mass, or another joint moves; true of robots without any of these."""
    model = part.owner.model

    def has_body(name: str) -> bool:
        link = model.link_by_name[name]
        has_mass = link.inertial is not None and link.inertial.mass != 0
        return bool(link.visuals or link.collisions or has_mass)

    if not any(has_body(link.name) for link in model.links):
        return True
    try:
        below = model.tree.child_joints
    except FactUnavailableError:  # the robot is wrong already: what its joint carries is not known
        return False
    names = [part.link.name]
    for name in names:
        names += [joint.child for joint in below[name]]
    return any(map(has_body, names))


def _name_without_side(name: str) -> str:
    """The name in lower case, without words for sides."""
    return _SIDES.sub("#", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).replace("_", " ")).lower()


def _is_other_side(one: str, other: str, *, or_same: bool = False) -> bool:
    """Whether two names differ in the words for sides only."""
    names = [re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).replace("_", " ") for name in (one, other)]
    return (one != other or or_same) and _SIDES.sub("#", names[0]).lower() == _SIDES.sub("#", names[1]).lower()


def _strip(name: str) -> str:
    """The name without sides and numbers."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).replace("_", " ")
    return _NUMBERS.sub("#", _SIDES.sub("#", words)).lower()
