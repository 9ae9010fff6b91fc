"""Statics and dynamics of a tree in sampled configurations, by Pinocchio: joint loads and effective inertias.

``model`` is a ``pinocchio.Model`` with a fixed root whose z points up, ``data`` its scratch memory (creating it takes longer
than using it); configurations are rows (N, nq) of Pinocchio's coordinates. Every number follows from the masses, tensors and
placements in the file: the rotor of a motor, which URDF cannot describe, is not included.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from urdfcheck.facts.arrays import Array, Bools


# The share that a body adds to the inertia that its joint moves in a well conditioned mass matrix.
ADDED_INERTIA_SHARE = 0.01
# Rounds over all joints in the search for the largest load of one; more rounds change it by less than a thousandth.
_ROUNDS = 4
_THIRDS = 2.0 * np.pi / 3.0 * np.arange(3)


@dataclass(frozen=True, slots=True, eq=False)
class JointCoordinates:
    """Where joints with one degree of freedom are among Pinocchio's coordinates."""

    neutral: Array
    """(nq,), the neutral configuration."""
    position: NDArray[np.intp]
    """(J,), index of each joint in it."""
    continuous: Bools
    """(J,), whether a joint is continuous and has two coordinates, the cosine and the sine of its angle."""
    velocity: NDArray[np.intp]
    """(J,), index of each joint among the velocities."""


@dataclass(frozen=True, slots=True, eq=False)
class Conditioning:
    """How well the mass matrices of several configurations are conditioned."""

    number: float
    """The median condition number; infinite for a singular matrix."""
    index: int
    """The configuration with this number."""
    direction: Array
    """(V,), the unit combination of scaled joint velocities that moves the least inertia there."""


@dataclass(frozen=True, slots=True, eq=False)
class JointLoad:
    """The largest ``torque`` (N·m or N, positive) that a joint must hold, at ``values`` (J,) of all joints."""

    torque: float
    values: Array


def locate_joint_coordinates(model: Any, names: Sequence[str]) -> JointCoordinates:
    """Locate joints with one degree of freedom among Pinocchio's coordinates and velocities."""
    import pinocchio

    joints = [model.joints[model.getJointId(name)] for name in names]
    return JointCoordinates(
        neutral=np.asarray(pinocchio.neutral(model), dtype=float),
        position=np.array([joint.idx_q for joint in joints], dtype=np.intp),
        continuous=np.array([joint.nq == 2 for joint in joints], dtype=bool),
        velocity=np.array([joint.idx_v for joint in joints], dtype=np.intp),
    )


def build_configurations(coordinates: JointCoordinates, values: ArrayLike) -> Array:
    """Build Pinocchio's coordinates (N, nq) of joint ``values`` (N, J), rad or m; other joints stay neutral."""
    positions = np.asarray(values, dtype=float)
    q = np.tile(coordinates.neutral, (len(positions), 1))
    q[:, coordinates.position] = np.where(coordinates.continuous, np.cos(positions), positions)
    q[:, coordinates.position[coordinates.continuous] + 1] = np.sin(positions[:, coordinates.continuous])
    return q


def compute_gravity_torques(model: Any, data: Any, q: Array) -> Array:
    """Compute the generalised forces (N, nv) that hold the tree still against gravity, N·m or N."""
    import pinocchio

    torques = np.empty((len(q), model.nv))
    for row, configuration in zip(torques, q, strict=True):
        row[:] = pinocchio.computeGeneralizedGravity(model, data, configuration)
    return torques


def compute_mass_matrices(model: Any, data: Any, q: Array) -> Array:
    """Compute the joint-space inertia matrices (N, nv, nv), by the composite-rigid-body algorithm."""
    import pinocchio

    matrices = np.empty((len(q), model.nv, model.nv))
    for matrix, configuration in zip(matrices, q, strict=True):
        matrix[:] = pinocchio.crba(model, data, configuration)
    return matrices


def compute_inverse_mass_matrices(model: Any, data: Any, q: Array) -> Array:
    """Compute the inverses (N, nv, nv) of :func:`compute_mass_matrices`, by the articulated-body algorithm: a quarter of the
    time that inverting takes for a humanoid. They are meaningless where the mass matrix is singular."""
    import pinocchio

    inverses = np.empty((len(q), model.nv, model.nv))
    for matrix, configuration in zip(inverses, q, strict=True):
        matrix[:] = pinocchio.computeMinverse(model, data, configuration)
    return inverses


def scale_to_unit_diagonal(matrices: Array) -> Array:
    """Scale symmetric matrices (N, V, V) with positive diagonals to a diagonal of ones: ``D^-½ M D^-½``.

    Jacobi's scaling is within a factor V of the best diagonal one (van der Sluis, 1969). It removes the units of the joints
    and the mere size of what they move, which make the plain condition number of sound robots 1e7.
    """
    diagonal = np.sqrt(np.einsum("nii->ni", matrices))
    shaped: Array = matrices / diagonal[:, :, None] / diagonal[:, None, :]
    return shaped


def measure_conditioning(matrices: Array) -> Conditioning:
    """Measure the median condition number of ``matrices`` (N, V, V), after :func:`scale_to_unit_diagonal`.

    Not the largest: two axes of a sound wrist or shoulder move the same inertia in poses where they coincide.
    """
    shaped = scale_to_unit_diagonal(matrices)
    values = np.linalg.eigvalsh(shaped)
    with np.errstate(divide="ignore"):
        numbers = np.where(values[:, 0] > 0, values[:, -1] / values[:, 0], np.inf)
    at = int(np.argsort(numbers, kind="stable")[len(numbers) // 2])
    return Conditioning(float(numbers[at]), at, np.linalg.eigh(shaped[at])[1][:, 0])


def compute_added_matrices(model: Any, q: Array, inertias: Mapping[str, float]) -> Array:
    """Compute what the mass matrices (N, nv, nv) gain at the configurations ``q`` (N, nq) if the body behind each named joint
    has that much more inertia (kg m²) about every axis; behind a prismatic joint as much mass (kg), at its COM."""
    import pinocchio

    alone = model.copy()
    for place in range(1, alone.njoints):
        amount, own = inertias.get(alone.names[place], 0.0), alone.inertias[place]
        slides = alone.joints[place].shortname().startswith("JointModelP")
        alone.inertias[place] = (
            pinocchio.Inertia(amount, own.lever, np.zeros((3, 3)))
            if slides
            else pinocchio.Inertia(0.0, np.zeros(3), amount * np.eye(3))
        )
    return compute_mass_matrices(alone, alone.createData(), q)


def compute_effective_inertias(inverses: Array) -> Array:
    """Compute the inertia at each joint (N, V) when all other joints move freely, kg m² or kg: ``1 / (M^-1)_ii``."""
    effective: Array = 1.0 / np.einsum("nii->ni", inverses)
    return effective


def compute_own_inertia(model: Any, name: str, q: Array) -> float:
    """Compute the share of a joint's inertia (kg m² or kg) that its own body has, at the configuration ``q`` (nq,)."""
    import pinocchio

    alone, place = model.copy(), model.getJointId(name)
    for other in range(1, alone.njoints):
        if other != place:
            alone.inertias[other] = pinocchio.Inertia.Zero()
    index = model.joints[place].idx_v
    return float(pinocchio.crba(alone, alone.createData(), q)[index, index])


def compute_damping_rate(inverse: ArrayLike, damping: ArrayLike) -> float:
    """Compute the fastest decay (1/s) of joint velocities under viscous ``damping`` (V,): the largest eigenvalue of ``M^-1 D``.

    An integrator that takes damping from the velocity before the step (explicit Euler) is stable below ``2 / rate``.
    A single joint's ``d_i (M^-1)_ii`` is a Rayleigh quotient of it, so the rate is at least the largest of those.
    """
    root = np.sqrt(np.asarray(damping, dtype=float))
    return float(np.linalg.eigvalsh(np.asarray(inverse, dtype=float) * np.outer(root, root))[-1])


def find_largest_load(
    torque: Callable[[Array], Array], start: Array, *, ranges: ArrayLike, coupling: ArrayLike, joints: Sequence[int]
) -> JointLoad:
    """Climb from the joint values ``start`` (J,) to where a joint holds most, moving one of the ``joints`` at a time.

    ``torque`` maps values (N, J) to the joint's torques (N,); ``ranges`` (J, 2) are the limits; column i of ``coupling`` (J, J)
    is the motion of all joints with joint i. Along a slide the torque is linear, along an angle ``a + b cos q + c sin q``:
    three values determine its maxima. Five more places are tried because of joints with followers.
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
            torques = np.abs(torque(rows))
            if torques.max() > best:
                best, values = float(torques.max()), rows[int(torques.argmax())]
        if best <= before * 1.001:
            break
    return JointLoad(best, values)
