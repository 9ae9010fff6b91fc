"""Inertials with all that is drawn round them, by the link itself and by those that are fixed to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Inertial, Link
from urdfcheck.model.rigid_bodies import compute_body_mass, compute_body_tensor, list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import (
    collect_body_corners,
    has_drawn_shape,
    has_unit_ambiguity,
    has_up_axis_ambiguity,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A link lighter than this that draws nothing is a frame: its mass is there for a program that wants one.
FRAME_MASS = 1e-3
# Below this part of its body's mass or moments a link decides nothing about how the body moves.
NEGLIGIBLE_SHARE = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class EnclosedInertial:
    """An inertial and what is drawn round it. ``com`` (3,) and ``covariance`` (3, 3) in the axes of the root link (m, m²);
    ``readings``: the corners (K, 3) of all that the link and the links fixed to it draw or collide with, likewise: as RViz
    draws it, and without COLLADA's ``<unit>`` and with its ``<up_axis>`` where that makes a difference. ``alone``: no other
    link is fixed to this one. ``mass_share`` and ``moment_share``: what the link has of its body's mass and largest
    principal moment."""

    link: Link
    inertial: Inertial
    mass: float
    com: Array
    covariance: Array
    readings: tuple[Array, ...]
    is_single_link: bool
    mass_share: float
    moment_share: float

    @property
    def geometry_phrase(self) -> str:
        """Whose geometry it is, for a message about the link."""
        return "the drawn geometry" if self.is_single_link else "the drawn geometry of it and of the links fixed to it"


@fact
def enclosed_inertials(model: Model) -> tuple[EnclosedInertial, ...]:
    """Pair the inertials of links that are bodies, not mere frames, with all geometry around them, where that is known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return tuple(_generate_enclosed_inertials(model))


def _generate_enclosed_inertials(model: Model) -> Iterator[EnclosedInertial]:
    for body in list_rigid_bodies(model):
        readings = tuple(_list_corner_readings(model, body.links))
        if not readings:
            continue
        shares = compute_body_shares(model, body.links)
        for name in body.links:
            link, frame = model.link_by_name[name], model.frames[name]
            inertial = link.inertial
            if name not in shares or inertial is None or inertial.mass is None or inertial.tensor_in_link is None:
                continue
            if is_massless_frame(link):
                continue
            pose = inertial.origin.matrix
            assert pose is not None
            turn = frame[:3, :3]
            com = turn @ pose[:3, 3] + frame[:3, 3]
            covariance = turn @ compute_mass_covariance(inertial.tensor_in_link, inertial.mass) @ turn.T
            alone = len(body.links) == 1
            yield EnclosedInertial(link, inertial, inertial.mass, com, covariance, readings, alone, *shares[name])


def _list_corner_readings(model: Model, links: tuple[str, ...]) -> Iterator[Array]:
    for unit in (True, False) if has_unit_ambiguity(model, links) else (True,):
        for upright in (False, True) if has_up_axis_ambiguity(model, links) else (False,):
            points = collect_body_corners(model, links, apply_unit=unit, apply_up_axis=upright)
            if points is not None:
                yield points


def is_massless_frame(link: Link) -> bool:
    """Whether a link draws nothing and has next to no mass."""
    mass = None if link.inertial is None else link.inertial.mass
    return not has_drawn_shape(link) and (mass is None or mass < FRAME_MASS)


def compute_body_shares(model: Model, links: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """What each of the ``links`` of a body with a positive mass and a tensor has of the body's mass and of its largest principal
    moment, which may be more than all of it where others are negative; all of it where that of the body is not known.

    :raises Unavailable: when the tree is broken or an origin is malformed.
    """
    known = {}
    for name in links:
        inertial = model.link_by_name[name].inertial
        if (
            inertial is not None
            and inertial.mass is not None
            and inertial.mass > 0
            and inertial.tensor_in_link is not None
        ):
            known[name] = inertial.mass, float(np.abs(np.linalg.eigvalsh(inertial.tensor_in_link)).max())
    mass, tensor = compute_body_mass(model, links), compute_body_tensor(model, links)
    if len(known) == 1 or not mass or tensor is None:
        return dict.fromkeys(known, (1.0, 1.0))
    largest = max(float(np.linalg.eigvalsh(tensor)[-1]), 1e-300)
    return {name: (own / mass, moment / largest) for name, (own, moment) in known.items()}
