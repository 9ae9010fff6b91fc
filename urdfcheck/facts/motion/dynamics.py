"""Statics and dynamics of a tree in sampled configurations, by Pinocchio: what its joints hold, and how easily they move.

``model`` is a ``pinocchio.Model`` with a fixed root whose z points up, ``data`` its scratch memory (to make it takes longer
than to use it); configurations are rows (N, nq) of its own coordinates. Every number follows from the masses, tensors and
places in the file: a motor's rotor, which URDF cannot say, is not in them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from urdfcheck.facts.arrays import Array, Bools


# What a body adds to the inertia that its joint moves, for the mass matrix to be well conditioned.
ADDED_INERTIA_SHARE = 0.01
# How often all joints are moved to find where one of them holds most; more changes less than a thousandth.
_ROUNDS = 4
_THIRDS = 2.0 * np.pi / 3.0 * np.arange(3)


@dataclass(frozen=True, slots=True, eq=False)
class JointCoordinates:
    """``neutral`` (nq,): the neutral configuration. ``position`` (J,): each joint's place in it, ``turns`` (J,): whether it is
    continuous and has two, the cosine and the sine of its angle; ``velocity`` (J,): its place among the velocities."""

    neutral: Array
    position: NDArray[np.intp]
    continuous: Bools
    velocity: NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Conditioning:
    """``number``: the median condition number, that of configuration ``index``; infinite for a singular matrix.
    ``direction`` (V,): the unit combination of scaled joint velocities that moves least inertia there."""

    number: float
    index: int
    direction: Array


@dataclass(frozen=True, slots=True, eq=False)
class JointLoad:
    """The largest ``torque`` (N·m or N, positive) that a joint was found to hold, at ``values`` (J,) of all joints."""

    torque: float
    values: Array


def locate_joint_coordinates(model: Any, names: Sequence[str]) -> JointCoordinates:
    """Where joints with one degree of freedom are among Pinocchio's coordinates and velocities."""
    import pinocchio

    joints = [model.joints[model.getJointId(name)] for name in names]
    return JointCoordinates(
        np.asarray(pinocchio.neutral(model), dtype=float),
        np.array([joint.idx_q for joint in joints], dtype=np.intp),
        np.array([joint.nq == 2 for joint in joints], dtype=bool),
        np.array([joint.idx_v for joint in joints], dtype=np.intp),
    )


def build_configurations(coordinates: JointCoordinates, values: ArrayLike) -> Array:
    """Pinocchio's coordinates (N, nq) of joint ``values`` (N, J), rad or m; other joints stay neutral."""
    positions = np.asarray(values, dtype=float)
    q = np.tile(coordinates.neutral, (len(positions), 1))
    q[:, coordinates.position] = np.where(coordinates.continuous, np.cos(positions), positions)
    q[:, coordinates.position[coordinates.continuous] + 1] = np.sin(positions[:, coordinates.continuous])
    return q


def compute_gravity_torques(model: Any, data: Any, q: Array) -> Array:
    """Generalised forces (N, nv) that hold the tree still against gravity, N·m or N."""
    import pinocchio

    found = np.empty((len(q), model.nv))
    for row, configuration in zip(found, q, strict=True):
        row[:] = pinocchio.computeGeneralizedGravity(model, data, configuration)
    return found


def compute_mass_matrices(model: Any, data: Any, q: Array) -> Array:
    """Joint-space inertia matrices (N, nv, nv), by the composite-rigid-body algorithm."""
    import pinocchio

    found = np.empty((len(q), model.nv, model.nv))
    for matrix, configuration in zip(found, q, strict=True):
        matrix[:] = pinocchio.crba(model, data, configuration)
    return found


def compute_inverse_mass_matrices(model: Any, data: Any, q: Array) -> Array:
    """Inverses (N, nv, nv) of :func:`compute_mass_matrices`, by the articulated-body algorithm: a quarter of the time that
    inverting takes for a humanoid. They mean nothing where the mass matrix is singular."""
    import pinocchio

    found = np.empty((len(q), model.nv, model.nv))
    for matrix, configuration in zip(found, q, strict=True):
        matrix[:] = pinocchio.computeMinverse(model, data, configuration)
    return found


def scale_to_unit_diagonal(matrices: Array) -> Array:
    """Symmetric matrices (N, V, V) with positive diagonals, scaled to ones on it: ``D^-½ M D^-½``.

    Jacobi's scaling is within a factor V of the best diagonal one (van der Sluis, 1969). It takes away the units of the
    joints and the mere size of what they move, which make the plain condition number of sound robots 1e7.
    """
    diagonal = np.sqrt(np.einsum("nii->ni", matrices))
    shaped: Array = matrices / diagonal[:, :, None] / diagonal[:, None, :]
    return shaped


def measure_conditioning(matrices: Array) -> Conditioning:
    """The median condition number of :func:`scale_to_unit_diagonal` ``matrices`` (N, V, V) with positive diagonals.

    Not the largest: two axes of a sound wrist or shoulder move the same inertia in the poses in which they meet.
    """
    shaped = scale_to_unit_diagonal(matrices)
    values = np.linalg.eigvalsh(shaped)
    with np.errstate(divide="ignore"):
        numbers = np.where(values[:, 0] > 0, values[:, -1] / values[:, 0], np.inf)
    at = int(np.argsort(numbers, kind="stable")[len(numbers) // 2])
    return Conditioning(float(numbers[at]), at, np.linalg.eigh(shaped[at])[1][:, 0])


def measure_relieved_conditioning(matrices: Array, joints: Sequence[int]) -> float:
    """The :func:`measure_conditioning` number if each of some joints moved a hundredth more inertia than it does.

    It falls to some 400 where those joints are the cause. In a long chain, where every joint moves nearly
    what its neighbours do, it hardly changes: by a factor of 2.7 at most for 4 to 24 equal links, straight or folded.
    """
    changed = matrices.copy()
    for joint in joints:
        changed[:, joint, joint] *= 1.0 + ADDED_INERTIA_SHARE
    return measure_conditioning(changed).number


def compute_effective_inertias(inverses: Array) -> Array:
    """What each joint feels of the tree (N, V) when all other joints move freely, kg m² or kg: ``1 / (M^-1)_ii``."""
    felt: Array = 1.0 / np.einsum("nii->ni", inverses)
    return felt


def compute_own_inertia(model: Any, name: str, q: Array) -> float:
    """What of the inertia that a joint moves (kg m² or kg) is that of its own body, at the configuration ``q`` (nq,)."""
    import pinocchio

    alone, place = model.copy(), model.getJointId(name)
    for other in range(1, alone.njoints):
        if other != place:
            alone.inertias[other] = pinocchio.Inertia.Zero()
    index = model.joints[place].idx_v
    return float(pinocchio.crba(alone, alone.createData(), q)[index, index])


def compute_damping_rate(inverse: ArrayLike, damping: ArrayLike) -> float:
    """The fastest decay (1/s) of joint velocities under viscous ``damping`` (V,): the largest eigenvalue of ``M^-1 D``.

    An integrator that takes damping from the velocity before the step (explicit Euler) is stable below ``2 / rate``.
    A single joint's ``d_i (M^-1)_ii`` is a Rayleigh quotient of it, so the rate is at least the largest of those.
    """
    root = np.sqrt(np.asarray(damping, dtype=float))
    return float(np.linalg.eigvalsh(np.asarray(inverse, dtype=float) * np.outer(root, root))[-1])


def find_largest_load(
    torque: Callable[[Array], Array], start: Array, ranges: ArrayLike, coupling: ArrayLike, joints: Sequence[int]
) -> JointLoad:
    """Climb from the joint values ``start`` (J,) to where a joint holds most, moving one of the ``joints`` at a time.

    ``torque`` maps values (N, J) to the joint's torques (N,); ``ranges`` (J, 2) are the limits; column i of ``moved`` (J, J)
    says how all joints move with joint i. Along a slide the torque is a line, along an angle ``a + b cos q + c sin q``: three
    values tell where its tops are. A joint with followers is looked at in five places besides.
    """
    bounds, shares = np.asarray(ranges, dtype=float), np.asarray(coupling, dtype=float)
    values = np.array(start, dtype=float)
    best = float(np.abs(torque(values[None]))[0])
    for _ in range(_ROUNDS):
        before = best
        for i in joints:
            third = torque(values + (_THIRDS - values[i])[:, None] * shares[:, i])
            top = np.arctan2(third @ np.sin(_THIRDS), third @ np.cos(_THIRDS)) + np.pi * np.arange(-3, 4)
            low, high = bounds[i]
            tried = np.concatenate((np.linspace(low, high, 5), top[(low < top) & (top < high)]))
            rows = values + (tried - values[i])[:, None] * shares[:, i]
            found = np.abs(torque(rows))
            if found.max() > best:
                best, values = float(found.max()), rows[int(found.argmax())]
        if best <= before * 1.001:
            break
    return JointLoad(best, values)
