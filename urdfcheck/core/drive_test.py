"""The result of driving a robot on a plane with the wheels of its differential drive, as plain values. Standard library only.

Lengths in m, angles in rad. Ahead is the direction of the x axis of the frame, aside that of its y axis, both when the robot
begins to move.
"""

from __future__ import annotations

import math

from urdfcheck.core.records import dataclass

# How far each wheel rotates.
HALF_TURN = math.pi
# s in which the robot settles before and after it moves, and between two steps.
REST_SECONDS, STEP = 0.4, 1e-3
# m/s²: the greatest acceleration, a twentieth of what a wheel with a friction of 1 transmits, and below what tips a robot.
ACCELERATION = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class WheelTravel:
    """What one wheel did while all rotated ahead."""

    joint: str
    radius: float
    """Height of the axle above the ground."""
    rolled: float
    """Radius times the angle by which the wheel rotated."""
    travelled: float
    """How far the middle of the wheel moved at right angles to its axle."""
    load: float
    """N, mean over the drive."""

    @property
    def slip(self) -> float:
        """Share of the rotation that did not move the robot."""
        return 1.0 - abs(self.travelled) / abs(self.rolled) if self.rolled else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveRun:
    """Where the robot went while its wheels rotated by half a turn each."""

    ahead: float
    aside: float
    """Of the middle between the wheels."""
    turned: float
    """Change of the heading, positive to the left."""
    slip: float
    """Greatest share of a wheel's rotation that did not move the wheel; negative where it was pushed."""

    @property
    def distance(self) -> float:
        """How far it went."""
        return math.hypot(self.ahead, self.aside)


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTest:
    """A drive test."""

    source: str
    """What says which wheels drive: the controller, the plugin, the names or the symmetry of the wheels."""
    frame: str
    """The link whose x axis is ahead."""
    left: tuple[str, ...]
    right: tuple[str, ...]
    radius: float
    """Of the wheels in the model."""
    separation: float
    """Of the wheels in the model."""
    typed_radius: float | None
    """What the controller or plugin computes with; None where it does not say."""
    typed_separation: float | None
    forward: DriveRun
    """Each wheel rotated as if the robot were sent ahead."""
    turning: DriveRun
    """Each wheel rotated as if the robot were sent to the left."""
    wheels: tuple[WheelTravel, ...]

    @property
    def turn(self) -> float:
        """By which angle half a turn of wheels that do not slip rotates the robot in the model."""
        return 2 * HALF_TURN * self.radius / self.separation

    @property
    def expected_distance(self) -> float:
        """How far half a turn moves the robot, by what controller or plugin say, or else by the model."""
        return HALF_TURN * (self.typed_radius or self.radius)

    @property
    def expected_turn(self) -> float:
        """By which angle half a turn rotates the robot, by what controller or plugin say, or else by the model."""
        return 2 * HALF_TURN * (self.typed_radius or self.radius) / (self.typed_separation or self.separation)
