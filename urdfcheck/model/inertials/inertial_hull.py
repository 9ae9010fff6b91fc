"""Inertials with all that is drawn round them, by the link itself and by those that are fixed to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import covariance_of
from urdfcheck.model.parts import Inertial, Link
from urdfcheck.model.rigid_bodies import bodies, body_mass, body_tensor
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import body_points, draws, follows_unit, lies

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A link lighter than this that draws nothing is a frame: its mass is there for a program that wants one.
FRAME_MASS = 1e-3
# Below this part of its body's mass or moments a link decides nothing about how the body moves.
LITTLE = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Enclosed:
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
    alone: bool
    mass_share: float
    moment_share: float

    @property
    def around(self) -> str:
        """Whose geometry it is, for a message about the link."""
        return "the drawn geometry" if self.alone else "the drawn geometry of it and of the links fixed to it"


def enclosed(model: Model) -> Iterator[Enclosed]:
    """The inertials of links that are bodies and not mere frames, where all that is drawn round them is known.

    :raises Unavailable: when the tree is broken or an origin is malformed.
    """
    for body in bodies(model):
        readings = tuple(_readings(model, body.links))
        if not readings:
            continue
        shares = body_shares(model, body.links)
        for name in body.links:
            link, frame = model.link_by_name[name], model.frames[name]
            inertial = link.inertial
            if name not in shares or inertial is None or inertial.mass is None or inertial.tensor_in_link is None:
                continue
            if is_frame(link):
                continue
            pose = inertial.origin.matrix
            assert pose is not None
            turn = frame[:3, :3]
            com = turn @ pose[:3, 3] + frame[:3, 3]
            covariance = turn @ covariance_of(inertial.tensor_in_link, inertial.mass) @ turn.T
            alone = len(body.links) == 1
            yield Enclosed(link, inertial, inertial.mass, com, covariance, readings, alone, *shares[name])


def _readings(model: Model, links: tuple[str, ...]) -> Iterator[Array]:
    for unit in (True, False) if follows_unit(model, links) else (True,):
        for upright in (False, True) if lies(model, links) else (False,):
            points = body_points(model, links, unit=unit, upright=upright)
            if points is not None:
                yield points


def is_frame(link: Link) -> bool:
    """Whether a link draws nothing and has next to no mass."""
    mass = None if link.inertial is None else link.inertial.mass
    return not draws(link) and (mass is None or mass < FRAME_MASS)


def body_shares(model: Model, links: tuple[str, ...]) -> dict[str, tuple[float, float]]:
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
    mass, tensor = body_mass(model, links), body_tensor(model, links)
    if len(known) == 1 or not mass or tensor is None:
        return dict.fromkeys(known, (1.0, 1.0))
    largest = max(float(np.linalg.eigvalsh(tensor)[-1]), 1e-300)
    return {name: (own / mass, moment / largest) for name, (own, moment) in known.items()}
