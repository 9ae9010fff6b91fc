"""Inertials with all geometry around them, of the link itself and of those that are fixed to it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.facts.inertials.materials import DENSEST_PART
from urdfcheck.facts.mesh.convex_hull import compute_convex_hull, compute_least_volume
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Inertial, Link, has_drawn_shape, is_dummy_shape
from urdfcheck.model.rigid_bodies import add_sliding_links, compute_body_mass, compute_body_tensor, list_whole_bodies
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_body_corners
from urdfcheck.model.shapes.repeated_drawings import find_stand_in_drawings
from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity, has_up_axis_ambiguity

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# A link lighter than this (kg) that draws nothing is a frame: its mass is there for a program that wants one.
FRAME_MASS = 1e-3
# Below this share of its body's mass or moments a link does not affect how the body moves.
NEGLIGIBLE_SHARE = 0.05
# A link of a gram (kg) or less is a mark on the body that it is fixed to. Its tensor counts from this share of the body's.
_SPECK, _SPECK_SHARE = 1e-3, 0.15


def has_negligible_moment(mass: float, share: float) -> bool:
    """Whether the tensor of a link that weighs ``mass`` (kg) has too small a ``share`` of its body's largest moment to count."""
    return share < (_SPECK_SHARE if mass <= _SPECK else NEGLIGIBLE_SHARE)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class EnclosedInertial:
    """An inertial and all geometry around it; vectors in the axes of the root link."""

    link: Link
    inertial: Inertial
    mass: float
    com: Array
    """(3,), metres."""
    covariance: Array
    """(3, 3), m²."""
    readings: tuple[Array, ...]
    """The corners (K, 3) of all that the link and the links fixed to it draw or collide with: as RViz draws it, and without
    COLLADA's ``<unit>`` and with its ``<up_axis>`` where that makes a difference. With the joints, where they draw nothing.
    """
    is_drawn: bool
    """Whether any of the links draws something; collision shapes alone may stand for a piece of a part."""
    has_own_geometry: bool
    """Whether the geometry is that of this mass: its link draws something, or nothing else in the body that does has a mass."""
    is_single_link: bool
    """Whether no other link is fixed to this one."""
    mass_share: float
    """The link's share of its body's mass."""
    moment_share: float
    """The link's share of its body's largest principal moment."""

    @property
    def geometry_phrase(self) -> str:
        """Whose geometry it is, for a message about the link."""
        shapes = "the drawn geometry" if self.is_drawn else "the collision shapes and joints"
        return shapes if self.is_single_link else f"{shapes} of it and of the links fixed to it"


@fact
def enclosed_inertials(model: Model) -> tuple[EnclosedInertial, ...]:
    """Pair the inertials of links that are bodies, not mere frames, with all geometry around them, where that is known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return tuple(_generate_enclosed_inertials(model))


def _generate_enclosed_inertials(model: Model) -> Iterator[EnclosedInertial]:
    for body in list_whole_bodies(model):
        is_drawn = any(not is_dummy_shape(shape) for name in body.links for shape in model.link_by_name[name].visuals)
        readings = tuple(_list_corner_readings(model, body.links, with_joints=not is_drawn))
        if not readings:
            continue
        shares = compute_body_shares(model, body.links)
        drawing = {name for name in body.links if has_drawn_shape(model.link_by_name[name])}
        for name in body.links:
            link, frame = model.link_by_name[name], model.piece_frames[name]
            inertial = link.inertial
            if name not in shares or inertial is None or inertial.mass is None or inertial.tensor_in_link is None:
                continue
            if is_massless_frame(link) or name in find_stand_in_drawings(model):
                continue
            pose = inertial.origin.matrix
            if pose is None:
                continue
            turn = frame[:3, :3]
            com = turn @ pose[:3, 3] + frame[:3, 3]
            covariance = turn @ compute_mass_covariance(inertial.tensor_in_link, inertial.mass) @ turn.T
            mass_share, moment_share = shares[name]
            yield EnclosedInertial(
                link=link,
                inertial=inertial,
                mass=inertial.mass,
                com=com,
                covariance=covariance,
                readings=readings,
                is_drawn=is_drawn,
                has_own_geometry=name in drawing or not drawing & shares.keys(),
                is_single_link=len(body.links) == 1,
                mass_share=mass_share,
                moment_share=moment_share,
            )


def _list_corner_readings(model: Model, links: tuple[str, ...], *, with_joints: bool) -> Iterator[Array]:
    """Yield the corners (K, 3) of some links, and the places of their joints if asked, in each way that programs read COLLADA's
    unit and up axis."""
    joined = (
        {*links, *(joint.child for name in links for joint in model.pieces.child_joints[name])} if with_joints else ()
    )
    places = np.array([model.piece_frames[name][:3, 3] for name in joined]).reshape(-1, 3)
    for unit in (True, False) if has_unit_ambiguity(model, links) else (True,):
        for upright in (False, True) if has_up_axis_ambiguity(model, links) else (False,):
            points = collect_body_corners(model, links, apply_unit=unit, apply_up_axis=upright)
            if points is not None:
                yield np.concatenate((points, places))


def is_massless_frame(link: Link) -> bool:
    """Whether a link draws nothing and has next to no mass."""
    mass = None if link.inertial is None else link.inertial.mass
    return not has_drawn_shape(link) and (mass is None or mass < FRAME_MASS)


def is_carried(model: Model, link: Link) -> bool:
    """Whether a link only slides on others, and its tensor has too small a share of the largest moment of what turns with it to
    count: a finger on a hand that an arm turns.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    links = model.pieces.list_body_links(link.name)
    above = model.pieces.parent_joint.get(links[0])
    if above is None or above.type != "prismatic":
        return False
    while above is not None and above.type == "prismatic":
        links = model.pieces.list_body_links(above.parent)
        above = model.pieces.parent_joint.get(links[0])
    shares = compute_body_shares(model, tuple(add_sliding_links(model, links))).get(link.name)
    return shares is not None and has_negligible_moment(model.mass_by_name[link.name].mass, shares[1])


def compute_body_shares(model: Model, links: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Compute the share that each link has of its body's mass and of the body's largest principal moment.

    Of the ``links`` of one body, those with a positive mass and a tensor. A share above 1 is possible where others are
    negative; it is 1 where the values of the body are not known. Where a tensor is malformed, the shares of
    the moment are 0: nothing shows how much the others matter.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    known, is_whole = {}, True
    for name in links:
        inertial = model.link_by_name[name].inertial
        if inertial is None or inertial.mass is None or not inertial.mass > 0:
            continue
        if inertial.tensor_in_link is None:
            is_whole = False
        else:
            known[name] = inertial.mass, float(np.abs(np.linalg.eigvalsh(inertial.tensor_in_link)).max())
    mass, tensor = compute_body_mass(model, links), compute_body_tensor(model, links)
    if not is_whole and mass:
        return {name: (link_mass / mass, 0.0) for name, (link_mass, _) in known.items()}
    if len(known) == 1 or not mass or tensor is None:
        return dict.fromkeys(known, (1.0, 1.0))
    largest = max(float(np.linalg.eigvalsh(tensor)[-1]), 1e-300)
    return {name: (link_mass / mass, moment / largest) for name, (link_mass, moment) in known.items()}


def is_stand_in(part: EnclosedInertial) -> bool:
    """Whether no part of any ordinary material is so heavy in the hull: then the drawing is that of a smaller thing, such as the
    rod in the middle of a leg."""
    with np.errstate(all="ignore"):  # other rules report impossible numbers
        if any(part.mass <= DENSEST_PART * compute_least_volume(points) for points in part.readings):
            return False
        return part.mass > DENSEST_PART * max(compute_convex_hull(points).volume for points in part.readings) > 0.0
