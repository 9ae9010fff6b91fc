"""The rigid bodies that joints move, as statics and dynamics take them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.dynamics import BodyTree, MovingBody
from urdfcheck.model.fact import fact
from urdfcheck.model.motion.poses import ONE_DEGREE_OF_FREEDOM, normalize_axis
from urdfcheck.model.parts import Joint
from urdfcheck.model.rigid_bodies import compute_body_inertia, list_rigid_bodies
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array

# The axes of the joints that a joint with several degrees of freedom is a chain of: slides first, then turns.
_SLIDES, _TURNS = {"planar": "xy", "floating": "xyz"}, {"planar": "z", "floating": "xyz"}


@dataclass(frozen=True, slots=True, eq=False)
class MovingBodies:
    """The bodies of a model, each with one degree of freedom, V in all."""

    tree: BodyTree
    places: Mapping[str, int]
    """The index of the body that each joint moves, by the joint's name; of a chain that of the last."""

    def locate(self, joints: tuple[Joint, ...]) -> NDArray[np.intp]:
        """Return the indices (J,) of the bodies that these joints move."""
        return np.array([self.places[joint.name] for joint in joints], dtype=np.intp)

    def spread(self, joints: tuple[Joint, ...], values: Array) -> Array:
        """Return the values (N, V) of all joints, those of ``joints`` from ``values`` (N, J) and the others at zero."""
        spread = np.zeros((len(values), len(self.tree.bodies)))
        spread[:, self.locate(joints)] = values
        return spread


@fact
def list_moving_bodies(model: Model) -> MovingBodies:
    """List the bodies that joints move, from the root outwards. One without mass has no inertia.

    :raises FactUnavailableError: when the tree is broken, or an origin is malformed.
    """
    bodies: list[MovingBody] = []
    places: dict[str, int] = {}
    carriers: dict[str, tuple[int, Array]] = {}  # of each link: the index of its body, and the frame of the body
    for group in list_rigid_bodies(model):
        head = group.links[0]
        frame, joint = model.frames[head], model.tree.parent_joint.get(head)
        if joint is not None:
            parent, carrier = carriers[joint.parent]
            placement = _invert_placement(carrier) @ frame
            mass, com, tensor = _measure_inertia(model, group.links, frame)
            chain = _list_freedoms(joint)
            for number, (axis, rotates) in enumerate(chain, start=1):
                is_last = number == len(chain)
                bodies.append(
                    MovingBody(
                        parent=parent,
                        placement=placement,
                        axis=axis,
                        rotates=rotates,
                        mass=mass if is_last else 0.0,
                        com=com if is_last else np.zeros(3),
                        tensor=tensor if is_last else np.zeros((3, 3)),
                    )
                )
                parent, placement = len(bodies) - 1, np.eye(4)
            places[joint.name] = len(bodies) - 1
        carriers |= dict.fromkeys(group.links, (len(bodies) - 1 if joint is not None else -1, frame))
    return MovingBodies(BodyTree.from_bodies(bodies), places)


def _list_freedoms(joint: Joint) -> list[tuple[Array, bool]]:
    """Return the axes (3,) of a joint in its frame, each with whether the joint turns about it or slides along it."""
    if joint.type in ONE_DEGREE_OF_FREEDOM:
        return [(normalize_axis(joint), joint.type != "prismatic")]
    unit = dict(zip("xyz", np.eye(3), strict=True))
    return [
        *((unit[name], False) for name in _SLIDES[joint.type]),
        *((unit[name], True) for name in _TURNS[joint.type]),
    ]


def _measure_inertia(model: Model, links: tuple[str, ...], frame: Array) -> tuple[float, Array, Array]:
    """Measure mass, COM (3,) and tensor (3, 3) of a body in a frame (4, 4) in root coordinates."""
    inertia = compute_body_inertia(model, links)
    if inertia is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    mass, com, tensor = inertia
    back = frame[:3, :3].T
    return mass, back @ (com - frame[:3, 3]), back @ tensor @ back.T


def _invert_placement(placement: Array) -> Array:
    """Return the inverse of a rigid transform (4, 4)."""
    inverse = np.eye(4)
    inverse[:3, :3] = placement[:3, :3].T
    inverse[:3, 3] = -placement[:3, :3].T @ placement[:3, 3]
    return inverse
