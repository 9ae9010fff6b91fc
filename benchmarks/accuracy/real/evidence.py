"""Whether a file shows a defect at all: what a careful reader could go by.

Without evidence a defect is a robot like any other: a link whose tensor is ten times another, and no mesh, no twin and no limit
that contradicts it.
"""

from __future__ import annotations

import re
from itertools import chain

import numpy as np
from injections import Array, Body, Numbers, rotation_of, tensor_of
from scoring import effect

from real.changes import Part, ReadRobot, read_numbers
from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# A sound part may be so far from one of uniform density (`scoring.effect`, without the mass), and a defect must take it so much
# further away.
_SOUND, _FURTHER = 1.0, 0.5
# kg/m³: foam and tungsten, with room.
_DENSITIES = 10.0, 25_000.0
# What no robot's part may exceed: its COM or radius of gyration, in lengths of the whole robot.
_REACH = 1.0
# The triangle inequality is broken beyond rounding.
_SLACK = 1e-3
_SIDES = re.compile(
    r"(?i)(?<![a-z])(left|right|l|r|fl|fr|rl|rr|front|rear|back|lf|rf|lh|rh|hl|hr|[1-9][0-9]?)(?![a-z])|[0-9]+"
)


def find_inertial_evidence(part: Part, new: Numbers, *, with_meshes: bool) -> set[str]:
    """Find what shows that an inertial with ``new`` numbers is wrong.

    :returns: some of ``impossible``, ``reach``, ``mesh``, ``density``, ``twin``.
    """
    old = part.numbers
    assert old is not None
    found = set()
    if _is_impossible(new) and not _is_impossible(old):
        found.add("impossible")
    reach = measure_reach(part.owner)
    if max(_size(new)) > _REACH * reach >= max(_size(old)):
        found.add("reach")
    if with_meshes:
        found |= _find_drawn_evidence(part, old, new)
    if any(_is_twin(part, old, other) for other in part.owner.parts):
        found.add("twin")
    return found


def find_joint_evidence(part: Part, old: Array, new: Array) -> set[str]:
    """Find what shows that a joint's origin or axis is wrong: another joint like it, or lengths that no other joint has."""
    joint = part.joint
    assert joint is not None
    found = set()
    others = [other for other in part.owner.model.joints if other.name != joint.name and other.type == joint.type]
    mine = np.linalg.norm(joint.origin.xyz or (0, 0, 0))
    for other in others:
        length = np.linalg.norm(other.origin.xyz or (0, 0, 0))
        if _strip_sides(other.name) == _strip_sides(joint.name) and np.isclose(length, mine, rtol=1e-3, atol=1e-5):
            found.add("twin")
    lengths = [
        float(np.linalg.norm(other.origin.xyz or (0, 0, 0))) for other in part.owner.model.joints if other != joint
    ]
    if (
        len(new) == 3
        and np.linalg.norm(new) > 10 * max([*lengths, 1e-9])
        and np.linalg.norm(new) > 2 * np.linalg.norm(old)
    ):
        found.add("reach")
    return found


def measure_reach(read: ReadRobot) -> float:
    """Return the length of the whole robot (m): all joints' distances, and the largest thing drawn by a primitive or a COM."""
    lengths = [float(np.linalg.norm(joint.origin.xyz or (0, 0, 0))) for joint in read.model.joints]
    sizes = [
        float(np.abs(values).max())
        for link in read.model.links
        for shape in chain(link.visuals, link.collisions)
        for name in ("size", "radius", "length")
        if (values := read_numbers(shape.geometry_element, name)) is not None and len(values)
    ]
    coms = [max(_size(part.numbers)) for part in read.parts if part.numbers is not None]
    # One part with wrong numbers of its own does not stretch the robot.
    return sum(lengths) + max([*sizes, float(np.median(coms)) if coms else 0.0, 0.05])


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
    covariance = np.asarray(solid.covariance) / solid.volume
    tensor = np.trace(covariance) * np.eye(3) - covariance

    def differ(n: Numbers) -> float:
        given = DeclaredInertial(mass=n.mass, com=n.com, tensor=tensor_of(n.six), rotation=rotation_of(n.rpy))
        return effect(Body(n.mass, np.asarray(solid.com), tensor * n.mass), given)

    with np.errstate(all="ignore"):
        sound, broken = differ(old), differ(new)
    if sound < _SOUND and broken > sound + _FURTHER:
        found.add("mesh")
    low, high = _DENSITIES
    if low < old.mass / solid.volume < high and not low < new.mass / solid.volume < high:
        found.add("density")
    return found


def _is_twin(part: Part, old: Numbers, other: Part) -> bool:
    """Whether another link is the same part: by mass, moments and name (sides and numbers apart)."""
    n = other.numbers
    if other is part or n is None or not np.isclose(n.mass, old.mass, rtol=1e-3):
        return False
    if _strip_sides(other.link.name) != _strip_sides(part.link.name):
        return False
    mine, its = (np.linalg.eigvalsh(tensor_of(x.six)) for x in (old, n))
    return bool(np.allclose(mine, its, rtol=1e-2) and np.isclose(_size(n)[0], _size(old)[0], rtol=1e-2, atol=1e-5))


def _strip_sides(name: str) -> str:
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name)
    return re.sub(r"[\W_]+", "_", _SIDES.sub("#", words.replace("_", " "))).lower()
