"""Rigid bodies: what fixed joints make one, with the mass and inertia tensor of all their links together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from urdfcheck.model.model import Model
from urdfcheck.model.parts import Inertial

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


# A body whose radius of gyration is below a micrometre is a point: its tensor is zero or the residue of an export
# (published files hold 1e-20 kg m² for 0.1 kg). The lightest part of a watch has 1e-4 m.
POINT_RADIUS = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """Links that move as one, ``links[0]`` the nearest to the root. ``moves``: whether it hangs on a joint that does."""

    links: tuple[str, ...]
    moves: bool


def bodies(model: Model) -> tuple[Body, ...]:
    """The rigid bodies, from the root outwards.

    :raises Unavailable: when the tree is broken.
    """
    tree = model.tree
    heads = [name for name in tree.order if name not in tree.parent_joint or tree.parent_joint[name].type != "fixed"]
    return tuple(Body(tree.body(name), name in tree.parent_joint) for name in heads)


def is_point(inertial: Inertial) -> bool:
    """Whether the inertia tensor is zero for all that its mass can tell; False without mass."""
    six, mass = inertial.six, inertial.mass
    return six is not None and mass is not None and mass > 0 and max(map(abs, six)) <= mass * POINT_RADIUS**2


def body_mass(model: Model, links: Sequence[str]) -> float | None:
    """Total mass in kg of these links, those without ``<inertial>`` counting nothing; None when one is malformed."""
    masses = [model.link_by_name[name].inertial for name in links]
    known = [inertial.mass for inertial in masses if inertial is not None]
    return None if any(m is None for m in known) else sum(m for m in known if m is not None)


def body_tensor(model: Model, links: Sequence[str]) -> NDArray[np.float64] | None:
    """Inertia tensor (3, 3) in kg m² of these links together, about their common COM, in root coordinates.

    None when an inertial is malformed or the links have no mass together.

    :raises Unavailable: when the tree is broken or an origin is malformed.
    """
    import numpy as np

    inertials = [(model.frames[name], i) for name in links if (i := model.link_by_name[name].inertial) is not None]
    parts: list[tuple[float, NDArray[np.float64], NDArray[np.float64]]] = []
    for frame, inertial in inertials:
        matrix, tensor = inertial.origin.matrix, inertial.tensor_in_link
        if inertial.mass is None or matrix is None or tensor is None:
            return None
        turn = frame[:3, :3]
        parts.append((inertial.mass, turn @ matrix[:3, 3] + frame[:3, 3], turn @ tensor @ turn.T))
    total = sum(mass for mass, _, _ in parts)
    if not total > 0:
        return None
    com = sum((mass * place for mass, place, _ in parts), np.zeros(3)) / total
    summed = np.zeros((3, 3))
    for mass, place, tensor in parts:
        lever = place - com
        summed += tensor + mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    return summed
