"""Vectors, rotations and tensors as tuples: numpy takes as long to load as the check of a model's text, which does without it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

from urdfcheck.core.records import dataclass

Vector: TypeAlias = tuple[float, float, float]
"""A place or a direction."""

Matrix: TypeAlias = tuple[Vector, Vector, Vector]
"""The rows of a rotation or a tensor."""

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
# Jacobi's method doubles the digits with each sweep; published tensors take three.
_MOST_SWEEPS = 20
# A product of inertia of this share of the moments changes none of their digits.
_NO_PRODUCT = 1e-18


@dataclass(frozen=True, slots=True)
class Placement:
    """A frame in another one."""

    rotation: Matrix
    place: Vector
    """m"""

    def carry(self, inner: Placement) -> Placement:
        """Return where a frame is that is placed in this one."""
        return Placement(multiply(self.rotation, inner.rotation), self.carry_point(inner.place))

    def carry_point(self, point: Sequence[float]) -> Vector:
        """Return where a point (3,) of this frame is."""
        x, y, z = rotate(self.rotation, point)
        return x + self.place[0], y + self.place[1], z + self.place[2]


UNMOVED = Placement(IDENTITY, (0.0, 0.0, 0.0))


def make_rotation(rpy: Sequence[float]) -> Matrix:
    """Make the rotation of URDF's fixed-axis roll, pitch, yaw (rad): ``Rz(yaw) Ry(pitch) Rx(roll)``."""
    roll, pitch, yaw = rpy
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def make_quaternion_rotation(xyzw: Sequence[float]) -> Matrix:
    """Make the rotation of a quaternion ``x y z w`` of any length.

    :raises ValueError: when its length is zero or not finite.
    """
    length = math.hypot(*xyzw)
    if not 0.0 < length < math.inf:
        raise ValueError("a quaternion of zero or infinite length is not a rotation")
    x, y, z, w = (value / length for value in xyzw)
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )


def rotate(rotation: Matrix, vector: Sequence[float]) -> Vector:
    """Multiply a vector (3,) by a matrix."""
    x, y, z = vector
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = rotation
    return ax * x + ay * y + az * z, bx * x + by * y + bz * z, cx * x + cy * y + cz * z


def multiply(one: Matrix, other: Matrix) -> Matrix:
    """Multiply two matrices."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = other
    first, second, third = (
        (x * ax + y * bx + z * cx, x * ay + y * by + z * cy, x * az + y * bz + z * cz) for x, y, z in one
    )
    return first, second, third


def transpose(matrix: Matrix) -> Matrix:
    """Return the columns as rows: the inverse of a rotation."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = matrix
    return (ax, bx, cx), (ay, by, cy), (az, bz, cz)


def list_entries(matrix: Matrix) -> tuple[float, ...]:
    """List the nine entries of a matrix, row by row."""
    return (*matrix[0], *matrix[1], *matrix[2])


def measure_change(one: Matrix, other: Matrix) -> float:
    """Measure the largest difference between entries of two matrices."""
    return max(abs(a - b) for a, b in zip(list_entries(one), list_entries(other), strict=True))


def subtract(one: Sequence[float], other: Sequence[float]) -> Vector:
    """Return the vector from the ``other`` point to the ``one``."""
    return one[0] - other[0], one[1] - other[1], one[2] - other[2]


def multiply_inner(one: Sequence[float], other: Sequence[float]) -> float:
    """Compute the inner product of two vectors."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def multiply_outer(one: Sequence[float], other: Sequence[float]) -> Vector:
    """Compute the cross product of two vectors."""
    (a, b, c), (x, y, z) = one, other
    return b * z - c * y, c * x - a * z, a * y - b * x


def make_tensor(components: Sequence[float]) -> Matrix:
    """Make the tensor of URDF's ``ixx ixy ixz iyy iyz izz``."""
    ixx, ixy, ixz, iyy, iyz, izz = components
    return (ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)


def turn_tensor(rotation: Matrix, tensor: Matrix) -> Matrix:
    """Return a tensor in the axes of the frame in which its own is rotated."""
    return multiply(multiply(rotation, tensor), transpose(rotation))


def add_tensors(tensors: Sequence[Matrix]) -> Matrix:
    """Add tensors about one point in the same axes."""
    first, second, third = (
        (sum(row[0] for row in rows), sum(row[1] for row in rows), sum(row[2] for row in rows))
        for rows in zip(*tensors, strict=True)
    )
    return first, second, third


def add_parallel_axis(tensor: Matrix, mass: float, lever: Vector) -> Matrix:
    """Return the tensor (kg m²) of a mass (kg) about a point that is ``lever`` (m) away from its COM, about which ``tensor``
    is."""
    x, y, z = lever
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor
    return make_tensor(
        (
            xx + mass * (y * y + z * z),
            xy - mass * x * y,
            xz - mass * x * z,
            yy + mass * (x * x + z * z),
            yz - mass * y * z,
            zz + mass * (x * x + y * y),
        )
    )


def measure_rotation(rotation: Matrix) -> float:
    """Measure the angle (rad) of a rotation."""
    return find_turn(rotation)[1]


def find_turn(rotation: Sequence[Sequence[float]]) -> tuple[Vector, float]:
    """Find the unit axis and the angle (rad, within [0, π]) of a rotation; axis x if the angle is 0.

    Goes through the quaternion's largest component (Shepperd, *Quaternion from rotation matrix*, 1978), which keeps
    full precision both near 0, where the arc cosine of the trace loses it, and near π, where the skew part does.
    """
    r = rotation
    trace = r[0][0] + r[1][1] + r[2][2]
    candidates = (r[0][0], r[1][1], r[2][2], trace)
    i = candidates.index(max(candidates))
    if i == 3:
        vector = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]
        scalar = 1.0 + trace
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        vector = [0.0] * 3
        vector[i] = 1.0 - trace + 2.0 * r[i][i]
        vector[j] = r[j][i] + r[i][j]
        vector[k] = r[k][i] + r[i][k]
        scalar = r[k][j] - r[j][k]
    length = math.hypot(*vector)
    if length == 0.0:
        return (1.0, 0.0, 0.0), 0.0
    x, y, z = (component / (-length if scalar < 0.0 else length) for component in vector)
    return (x, y, z), 2.0 * math.atan2(length, abs(scalar))


def compute_moments(tensor: Matrix) -> Vector:
    """Compute the principal moments of a tensor, ascending, to the last digits of a double, by Jacobi's rotations."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor
    moments = [xx, yy, zz]
    products = [yz, xz, xy]  # by the axis that a product does not name
    for _ in range(_MOST_SWEEPS):
        is_diagonal = True
        for p, q, r in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
            product = products[r]
            if abs(product) <= _NO_PRODUCT * (abs(moments[p]) + abs(moments[q])):
                continue
            is_diagonal = False
            slope = (moments[q] - moments[p]) / (2.0 * product)
            tangent = math.copysign(1.0 / (abs(slope) + math.hypot(slope, 1.0)), slope)
            cosine = 1.0 / math.hypot(tangent, 1.0)
            sine = tangent * cosine
            moments[p] -= tangent * product
            moments[q] += tangent * product
            products[r] = 0.0
            products[q], products[p] = (
                cosine * products[q] - sine * products[p],
                sine * products[q] + cosine * products[p],
            )
        if is_diagonal:
            break
    first, second, third = sorted(moments)
    return first, second, third


def compute_excess(moments: Sequence[float]) -> float:
    """Compute ``(I1 + I2 - I3) / I3`` of ascending principal moments: negative when no body has them.

    1 for a sphere, 0 for a flat plate. NaN when the largest moment is not positive.
    """
    first, second, third = moments
    return (first + second - third) / third if third > 0.0 else math.nan
