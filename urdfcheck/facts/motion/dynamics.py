"""Statics and dynamics of a tree in sampled configurations: joint loads and effective inertias.

The root of the tree is fixed, and its z points up. A joint with several degrees of freedom is a chain of joints with one each,
whose bodies have no mass, apart from the last. Every number follows from the masses, tensors and placements in the file: the
rotor of a motor, which URDF cannot describe, is not included.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.drop_test import GRAVITY
from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Bools, Mat3, Mat4, Vec3


# The share that a body adds to the inertia that its joint moves in a well conditioned mass matrix.
ADDED_INERTIA_SHARE = 0.01
# Rounds over all joints in the search for the largest load of one; more rounds change it by less than a thousandth.
_ROUNDS = 4
_THIRDS = 2.0 * np.pi / 3.0 * np.arange(3)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MovingBody:
    """A rigid body and the joint with one degree of freedom that moves it."""

    parent: int
    """The index of the body that carries it, lower than its own; -1 for the root."""
    placement: Mat4
    """Of its frame in the parent's, the joint at zero."""
    axis: Vec3
    """The joint's unit axis through the origin of the frame, in the frame."""
    rotates: bool
    mass: float
    com: Vec3
    """In the frame."""
    tensor: Mat3
    """About the COM, in the axes of the frame."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BodyTree:
    """The V bodies of a tree, as arrays."""

    bodies: Sequence[MovingBody]
    chains: Sequence[Sequence[int]]
    """Of each body: the bodies whose joints carry it, from the root, and itself."""
    turns: Bools
    """(V,), whether its joint rotates."""
    axes: Array
    """(V, 3)"""
    offsets: Array
    """(V, 3), of its frame in the parent's, the joint at zero."""
    slides: Array
    """(V, 3), what a joint that slides adds to the offset for each metre."""
    rotations: Array
    """(3, V, 3, 3): at q it is turned in the parent's frame by the first, plus sin(q) times the second, plus 1 - cos(q) times the
    third (Rodrigues)."""
    masses: Array
    """(V,)"""
    coms: Array
    """(V, 3)"""

    @classmethod
    def from_bodies(cls, bodies: Sequence[MovingBody]) -> BodyTree:
        """Stack the bodies, each after the one that carries it."""
        chains: list[list[int]] = []
        for i, body in enumerate(bodies):
            chains.append([*(chains[body.parent] if body.parent >= 0 else ()), i])
        axes = np.array([body.axis for body in bodies])
        turns = np.array([body.rotates for body in bodies])
        homes = np.array([body.placement for body in bodies])
        skews = np.where(turns[:, None, None], [_make_cross_matrix(axis) for axis in axes], 0.0)
        home = homes[:, :3, :3]
        return cls(
            bodies=bodies,
            chains=chains,
            turns=turns,
            axes=axes,
            offsets=homes[:, :3, 3],
            slides=np.where(turns[:, None], 0.0, (home @ axes[:, :, None])[:, :, 0]),
            rotations=np.array((home, home @ skews, home @ skews @ skews)),
            masses=np.array([body.mass for body in bodies]),
            coms=np.array([body.com for body in bodies]),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _PlacedBodies:
    """The V bodies of a tree in N configurations, in root coordinates."""

    rotations: Array
    """(V, N, 3, 3)"""
    points: Array
    """(V, N, 3), the origins of their frames."""
    axes: Array
    """(V, N, 3), of their joints."""
    levers: Array
    """(V, N, 3), of their COMs from the origins."""


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


def _place_bodies(tree: BodyTree, values: Array) -> _PlacedBodies:
    """Place the bodies where their joints have ``values`` (N, V), rad or m."""
    amounts = values.T[:, :, None]
    home, sine, cosine = tree.rotations[:, :, None]
    turned = home + np.sin(amounts)[..., None] * sine + (1.0 - np.cos(amounts))[..., None] * cosine
    moved = tree.offsets[:, None] + amounts * tree.slides[:, None]
    for i, body in enumerate(tree.bodies):
        if body.parent >= 0:  # placed already
            before = turned[body.parent]
            moved[i] = moved[body.parent] + (before @ moved[i, :, :, None])[..., 0]
            turned[i] = before @ turned[i]
    axes, levers = (turned @ vectors[:, None, :, None] for vectors in (tree.axes, tree.coms))
    return _PlacedBodies(turned, moved, axes[..., 0], levers[..., 0])


def _make_cross_matrix(vector: Vec3) -> Mat3:
    x, y, z = vector
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))


def _cross(one: Array, other: Array) -> Array:
    """Return the cross products of vectors (…, 3); numpy's takes four times as long for a few."""
    (a, b, c), (x, y, z) = np.moveaxis(one, -1, 0), np.moveaxis(other, -1, 0)
    return np.stack((b * z - c * y, c * x - a * z, a * y - b * x), axis=-1)


def compute_gravity_torques(tree: BodyTree, values: Array) -> Array:
    """Compute the torques and forces (N, V) that hold the tree still at ``values`` (N, V), N·m or N."""
    placed = _place_bodies(tree, values)
    masses = tree.masses.copy()
    moments = masses[:, None, None] * (placed.points + placed.levers)
    for i in range(len(tree.bodies) - 1, -1, -1):
        parent = tree.bodies[i].parent
        if parent >= 0:
            masses[parent] += masses[i]
            moments[parent] += moments[i]
    levers = moments - masses[:, None, None] * placed.points
    turning = placed.axes[..., 0] * levers[..., 1] - placed.axes[..., 1] * levers[..., 0]
    sliding = masses[:, None] * placed.axes[..., 2]
    torques: Array = GRAVITY * np.where(tree.turns[:, None], turning, sliding).T
    return torques


def compute_mass_matrices(tree: BodyTree, values: Array) -> Array:
    """Compute the joint-space inertia matrices (N, V, V), by the composite-rigid-body algorithm.

    All that a joint carries is one body, whose moments are taken about the origin of the joint's frame.
    """
    placed = _place_bodies(tree, values)
    masses = tree.masses.copy()
    firsts = masses[:, None, None] * placed.levers
    tensors = np.array([_compute_frame_tensor(body) for body in tree.bodies])[:, None]
    seconds = placed.rotations @ tensors @ np.swapaxes(placed.rotations, -1, -2)
    matrices = np.zeros((len(tree.bodies), len(tree.bodies), len(values)))
    for i in range(len(tree.bodies) - 1, -1, -1):
        axis, first, second, chain = placed.axes[i], firsts[i], seconds[i], tree.chains[i]
        if tree.turns[i]:
            momentum, spin = _cross(axis, first), (second @ axis[:, :, None])[:, :, 0]
        else:
            momentum, spin = masses[i] * axis, _cross(first, axis)
        spins = spin + _cross(placed.points[i] - placed.points[chain], momentum)
        moved = np.where(tree.turns[chain, None, None], spins, momentum)
        matrices[i, chain] = matrices[chain, i] = np.einsum("kni,kni->kn", placed.axes[chain], moved)
        parent = tree.bodies[i].parent
        if parent >= 0:
            lever = placed.points[i] - placed.points[parent]
            seconds[parent] += second + _shift_moments(masses[i], first, lever)
            firsts[parent] += first + masses[i] * lever
            masses[parent] += masses[i]
    return np.ascontiguousarray(np.moveaxis(matrices, -1, 0))


def _compute_frame_tensor(body: MovingBody) -> Mat3:
    """Compute the tensor (3, 3) of a body about the origin of its frame."""
    (gained,) = _shift_moments(body.mass, np.zeros((1, 3)), body.com[None])
    tensor: Mat3 = body.tensor + gained
    return tensor


def _shift_moments(mass: float, first: Array, lever: Array) -> Array:
    """Return what tensors (N, 3, 3) about a point gain about another, from which the point is ``lever`` (N, 3).

    ``first`` (N, 3): mass times place of the COM from the point.
    """
    half = lever[:, :, None] * (first + 0.5 * mass * lever)[:, None, :]
    outer = half + np.swapaxes(half, -1, -2)
    gained: Array = np.einsum("nii->n", outer)[:, None, None] * np.eye(3) - outer
    return gained


def invert_mass_matrices(matrices: Array) -> Array:
    """Invert ``matrices`` (N, V, V), with a diagonal of ones in between, which keeps the digits of joints that move little.

    They are meaningless where a matrix is singular.
    """
    inner = 1.0 / np.sqrt(np.einsum("nii->ni", matrices))
    try:
        inverses = np.linalg.inv(matrices * inner[:, :, None] * inner[:, None, :])
    except np.linalg.LinAlgError:
        inverses = np.full_like(matrices, np.inf)
    scaled: Array = inverses * inner[:, :, None] * inner[:, None, :]
    return scaled


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


def compute_added_matrices(tree: BodyTree, values: Array, inertias: Mapping[int, float]) -> Array:
    """Compute what the mass matrices (N, V, V) gain at ``values`` (N, V) if the bodies of these indices have that much more
    inertia (kg m²) about every axis; behind a prismatic joint as much mass (kg), at its COM."""
    alone = [
        replace(
            body,
            mass=0.0 if body.rotates else inertias.get(i, 0.0),
            tensor=(inertias.get(i, 0.0) if body.rotates else 0.0) * np.eye(3),
        )
        for i, body in enumerate(tree.bodies)
    ]
    return compute_mass_matrices(BodyTree.from_bodies(alone), values)


def compute_effective_inertias(inverses: Array) -> Array:
    """Compute the inertia at each joint (N, V) when all other joints move freely, kg m² or kg: ``1 / (M^-1)_ii``."""
    effective: Array = 1.0 / np.einsum("nii->ni", inverses)
    return effective


def compute_own_inertia(body: MovingBody) -> float:
    """Compute the share of a joint's inertia (kg m² or kg) that its own body has."""
    if not body.rotates:
        return body.mass
    return float(body.axis @ _compute_frame_tensor(body) @ body.axis)


def compute_damping_rate(inverse: ArrayLike, damping: ArrayLike) -> float:
    """Compute the fastest decay (1/s) of joint velocities under viscous ``damping`` (V,): the largest eigenvalue of ``M^-1 D``.

    An integrator that takes damping from the velocity before the step (explicit Euler) is stable below ``2 / rate``.
    A single joint's ``d_i (M^-1)_ii`` is a Rayleigh quotient of it, so the rate is at least the largest of those.
    """
    root = np.sqrt(np.asarray(damping, dtype=float))
    return float(np.linalg.eigvalsh(np.asarray(inverse, dtype=float) * np.outer(root, root))[-1])


def find_largest_load(
    torque: Callable[[Array], Array],
    starts: ArrayLike,
    *,
    ranges: ArrayLike,
    coupling: ArrayLike,
    joints: Sequence[int],
) -> JointLoad:
    """Climb from joint values ``starts`` (S, J) to where a joint holds most, moving one of the ``joints`` at a time.

    ``torque`` maps values (N, J) to the joint's torques (N,); ``ranges`` (J, 2) are the limits; column i of ``coupling`` (J, J)
    is the motion of all joints with joint i. Along a slide the torque is linear, along an angle ``a + b cos q + c sin q``:
    three values determine its maxima. Five more places are tried because of joints with followers. All starts climb at once,
    because a few more rows take no longer.
    """
    bounds, shares = np.asarray(ranges, dtype=float), np.asarray(coupling, dtype=float)
    values = np.array(starts, dtype=float)
    best = np.abs(torque(values))
    climbing = np.arange(len(values))
    for _ in range(_ROUNDS):
        before = best.copy()
        for i in joints:
            here = values[climbing]

            def move(amounts: Array, here: Array = here, i: int = i) -> tuple[Array, Array]:
                """Return the rows (S, K, J) with joint i at ``amounts`` (S, K), and the torques there."""
                rows = here[:, None] + (amounts - here[:, [i]])[:, :, None] * shares[:, i]
                return rows, torque(rows.reshape(-1, rows.shape[-1])).reshape(amounts.shape)

            _, third = move(np.broadcast_to(_THIRDS, (len(here), 3)))
            tops = np.arctan2(third @ np.sin(_THIRDS), third @ np.cos(_THIRDS))[:, None] + np.pi * np.arange(-3, 4)
            low, high = bounds[i]
            # Outside the limits, a limit is tried once more.
            evenly = np.broadcast_to(np.linspace(low, high, 5), (len(here), 5))
            rows, torques = move(np.concatenate((evenly, np.clip(tops, low, high)), axis=1))
            top = np.abs(torques).argmax(axis=1)
            most, each = np.abs(torques).max(axis=1), np.arange(len(here))
            is_better = most > best[climbing]
            best[climbing[is_better]] = most[is_better]
            values[climbing[is_better]] = rows[each, top][is_better]
        climbing = climbing[best[climbing] > before[climbing] * 1.001]
        if not len(climbing):
            break
    highest = int(best.argmax())
    return JointLoad(float(best[highest]), values[highest])
