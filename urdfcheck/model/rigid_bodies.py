"""Rigid bodies: the links that fixed joints merge, with the mass and inertia tensor of all of them together."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.placeholders import is_round
from urdfcheck.facts.small_matrices import (
    Matrix,
    Vector,
    add_parallel_axis,
    add_tensors,
    compute_moments,
    make_tensor,
    subtract,
    turn_tensor,
)
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Inertial, Link
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A body whose radius of gyration is below a micrometre is a point: its tensor is zero or the residue of an export
# (published files hold 1e-20 kg m² for 0.1 kg). The lightest part of a watch has 1e-4 m.
POINT_RADIUS = 1e-6
# A thousandth of a body's mass and of its smallest moment is less than the accuracy to which the body is known: a motor's cable
# weighs more.
NEGLIGIBLE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class RigidLinkGroup:
    """Links that move as one."""

    links: tuple[str, ...]
    """``links[0]`` is the nearest to the root."""
    is_movable: bool
    """Whether they hang on a joint that moves."""


@dataclass(frozen=True, eq=False)
class WeighedBody:
    """Links together, in root coordinates."""

    mass: float
    """kg"""
    com: Vector
    """m"""
    tensor: Matrix
    """kg m² about the COM."""

    @cached_property
    def moments(self) -> Vector:
        """The principal moments in kg m², ascending."""
        return compute_moments(self.tensor)


@dataclass(frozen=True, slots=True, eq=False)
class MergedBody:
    """The body that fixed joints make of a link and others."""

    heaviest: str
    """The heaviest of the other links."""
    moments: tuple[float, float, float]
    """The body's principal moments (kg m²), ascending."""
    link_is_negligible: bool
    """Whether the link adds next to nothing to the body."""
    tensor_is_negligible: bool
    """Whether its own tensor does, whatever it weighs."""

    def is_physically_valid(self, rel_tol: float) -> bool:
        """Whether the moments are positive and keep the triangle inequality, to within ``rel_tol`` of the largest."""
        least, middle, largest = self.moments
        return least > rel_tol * largest and least + middle - largest >= -rel_tol * largest


def list_rigid_bodies(model: Model) -> tuple[RigidLinkGroup, ...]:
    """Return the rigid bodies, from the root outwards.

    :raises FactUnavailableError: when the tree is broken.
    """
    tree = model.tree
    heads = [name for name in tree.order if name not in tree.parent_joint or tree.parent_joint[name].type != "fixed"]
    return tuple(RigidLinkGroup(tree.list_body_links(name), name in tree.parent_joint) for name in heads)


def list_neighbour_links(model: Model, body: RigidLinkGroup) -> list[str]:
    """Return the links of the bodies in front and behind."""
    tree = model.tree
    near = [joint.child for name in body.links for joint in tree.child_joints[name]]
    if body.links[0] in tree.parent_joint:
        near.append(tree.parent_joint[body.links[0]].parent)
    found = dict.fromkeys(name for neighbour in near for name in tree.list_body_links(neighbour))
    return [name for name in found if name not in body.links]


@fact
def list_whole_bodies(model: Model) -> tuple[RigidLinkGroup, ...]:
    """Return the rigid bodies that are known to the last link, from the roots outwards, also of a robot in pieces.

    Where a joint names a link that does not exist, the rest of the robot is known: left out are the bodies to which a joint that
    does not move fixes the missing link.

    :raises FactUnavailableError: when the pieces of the robot are not trees.
    """
    try:
        return list_rigid_bodies(model)
    except FactUnavailableError:
        pieces = model.pieces
    cut = [joint for joint in model.joints if not {joint.parent, joint.child} <= pieces.child_joints.keys()]
    incomplete = {name for joint in cut if not joint.is_movable for name in (joint.parent, joint.child)}
    moved = {joint.child for joint in cut if joint.is_movable}
    bodies = dict.fromkeys(pieces.list_body_links(name) for name in pieces.order)
    return tuple(
        RigidLinkGroup(links, links[0] in pieces.parent_joint or links[0] in moved)
        for links in bodies
        if incomplete.isdisjoint(links)
    )


def add_sliding_links(model: Model, links: Iterable[str]) -> list[str]:
    """List some links and all that only slides on them: together they turn as one."""
    together = list(links)
    for name in together:
        sliding = (joint.child for joint in model.pieces.child_joints[name] if joint.type == "prismatic")
        together += [link for child in sliding for link in model.pieces.list_body_links(child)]
    return together


def has_collision_geometry(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a link of the body has a ``<collision>``."""
    return any(model.link_by_name[name].collisions for name in body.links)


def is_world_link(model: Model, link: Link) -> bool:
    """Whether a link is the root by whose name programs fix a robot to the world."""
    return link.name == "world" and not any(joint.child == link.name for joint in model.joints)


def is_point_mass(inertial: Inertial) -> bool:
    """Whether the inertia tensor is zero as far as the mass can tell; False without mass."""
    components, mass = inertial.inertia_components, inertial.mass
    return (
        components is not None and mass is not None and mass > 0 and max(map(abs, components)) <= mass * POINT_RADIUS**2
    )


@fact
def compute_body_mass(model: Model, links: tuple[str, ...]) -> float | None:
    """Compute the total mass in kg of some links; None when one is malformed.

    A link without ``<inertial>`` counts nothing.

    :raises FactUnavailableError: when the tree is broken.
    """
    inertials = [model.link_by_name[name].inertial for name in links]
    masses = [inertial.mass for inertial in inertials if inertial is not None]
    return None if any(m is None for m in masses) else sum(m for m in masses if m is not None)


def compute_body_tensor(model: Model, links: tuple[str, ...]) -> Array | None:
    """Compute the inertia tensor (3, 3) in kg m² of some links together, about their common COM, in root coordinates.

    None when an inertial is malformed or the links have no mass together.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    inertia = compute_body_inertia(model, links)
    return None if inertia is None else inertia[2]


@fact
def compute_body_inertia(model: Model, links: tuple[str, ...]) -> tuple[float, Array, Array] | None:
    """Return what `weigh_body` does as mass in kg, COM (3,) in m and tensor (3, 3) in kg m².

    :raises FactUnavailableError: as there.
    """
    import numpy as np

    whole = weigh_body(model, links)
    return None if whole is None else (whole.mass, np.array(whole.com), np.array(whole.tensor))


@fact
def weigh_body(model: Model, links: tuple[str, ...]) -> WeighedBody | None:
    """Compute mass, COM and inertia tensor of some links together; None when an inertial is malformed or they have no mass.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    inertials = [
        (model.piece_placements[name], i) for name in links if (i := model.link_by_name[name].inertial) is not None
    ]
    parts: list[tuple[float, Vector, Matrix]] = []
    for frame, inertial in inertials:
        origin, components = inertial.origin.placement, inertial.inertia_components
        if inertial.mass is None or origin is None or components is None:
            return None
        placed = frame.carry(origin)
        parts.append((inertial.mass, placed.place, turn_tensor(placed.rotation, make_tensor(components))))
    total = sum(mass for mass, _, _ in parts)
    if not total > 0:
        return None
    x, y, z = (sum(mass * place[axis] for mass, place, _ in parts) / total for axis in range(3))
    about_com = [add_parallel_axis(tensor, mass, subtract(place, (x, y, z))) for mass, place, tensor in parts]
    return WeighedBody(total, (x, y, z), add_tensors(about_com))


def find_merged_body(model: Model, link: Link) -> MergedBody | None:
    """Return the body that a link with an inertial is part of.

    None when nothing else in it has mass, or when that is not known.
    """
    try:
        names = model.pieces.list_body_links(link.name)
        whole = weigh_body(model, names)
    except FactUnavailableError:
        return None
    if link.inertial is None or whole is None:
        return None
    heaviest = next((name for name in _find_two_heaviest(model, names) if name != link.name), "")
    if not heaviest or not _get_link_mass(model, heaviest) > 0:
        return None
    largest = max(map(abs, link.inertial.inertia_components or (0.0,)))
    is_light = _get_link_mass(model, link.name) <= NEGLIGIBLE * whole.mass
    is_small = largest <= NEGLIGIBLE * whole.moments[0]
    return MergedBody(heaviest, whole.moments, is_light and is_small, is_small)


@fact
def _find_two_heaviest(model: Model, links: tuple[str, ...]) -> tuple[str, ...]:
    """Return the two of some links that have the most mass."""
    known = [name for name in links if model.link_by_name[name].inertial is not None]
    return tuple(sorted(known, key=lambda name: -_get_link_mass(model, name))[:2])


def _get_link_mass(model: Model, link: str) -> float:
    inertial = model.link_by_name[link].inertial
    return 0.0 if inertial is None else inertial.mass or 0.0


@fact
def has_one_round_mass(model: Model) -> bool:
    """Whether one round number is the mass of every link that has one: typed for all of them, it is that of none."""
    masses = [declared.mass for declared in model.masses if declared.mass > 0]
    return len(masses) > 1 and len(set(masses)) == 1 and is_round(masses[0])
