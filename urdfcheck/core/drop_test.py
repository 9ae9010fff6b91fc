"""The result of setting a robot on a plane and releasing it, as plain values. Standard library only.

Places are in the root link's frame, in m. A value that is not a number, because the simulation burst, is None.
"""

from __future__ import annotations

from urdfcheck.core.drive_test import DriveTest
from urdfcheck.core.records import dataclass

# m/s², downwards.
GRAVITY = 9.81
# s that a robot is watched, and between two steps: 1 ms is Gazebo's default; MuJoCo's is 2 ms.
SECONDS, STEP = 2.0, 1e-3
# s after which a robot that is held and has not come to rest is looked at again: what leans has fallen by then, and what swings
# has calmed down.
LATE_SECONDS = 10.0
# Steps (s) that are tried to find the largest that is stable; 64 ms is a sixteenth of a second, where nobody simulates any more.
STEPS = tuple(2.5e-4 * 2.0**k for k in range(9))
# A robot has settled while no body of it is faster than this part of √(g·size), the speed of a fall from half its size: in the
# time of such a fall it goes less than a hundredth of its size.
SETTLED_SPEED_RATIO = 0.01
# A robot that is turned by more (rad) has tipped over or fallen: 15°, and no robot on its wheels or feet leans as far by itself.
TIPPED_ANGLE = 0.26
# Energy may come from rounding and from soft contacts, in parts of weight times size: 5e-4 is the most that 55 published
# models gained at a step of 1 ms.
MAX_ENERGY_GAIN = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundContact:
    """A link on the plane at the end."""

    link: str
    points: int
    """Number of contact points."""
    place: tuple[float, float, float]
    """Middle of the contact points on the link's surface."""
    lowest: float
    """Lowest z of the contact points."""
    depth: float
    """Depth (m) in the plane."""
    load: float
    """N, over the last quarter of a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReleaseResult:
    """The motion of the robot after its release."""

    held: bool
    """Whether the motors hold the joints."""
    burst: float | None
    """When (s) the simulator gave up, None if it did not."""
    fastest: str
    """The link that was the fastest of all."""
    gain: float | None
    """Largest rise of the mechanical energy above that at the beginning, in parts of weight times size."""
    change: float | None
    """Change of the mechanical energy at the end, in parts of weight times size."""
    speed: float | None
    """Speed (m/s) of the link ``moving``."""
    moving: str
    """The fastest link in the last quarter of a second."""
    settled: float | None
    """Since when (s) no link is faster than the limit, None when one still is."""
    tilt: float | None
    """Tilt (rad) of the root."""
    touching: tuple[GroundContact, ...]
    saturated: tuple[str, ...]
    """Joints that are held with all their effort at the end."""
    sag: float | None
    """How far (rad or m) the joint ``sagging`` has given way."""
    sagging: str
    """The joint that has given way the farthest of those that are held."""
    rolls: bool
    """Whether the robot rests on a part that no motor holds, or such a part is what moves."""

    @property
    def depth(self) -> float:
        """m: the deepest contact."""
        return max((touching.depth for touching in self.touching), default=0.0)

    @property
    def is_restless(self) -> bool:
        """Whether it still moves, and neither falls nor rolls, nor gives way because its motors are too weak."""
        still = self.burst is None and self.settled is None
        return still and self.held and not (self.has_tipped or self.saturated or self.rolls)

    @property
    def has_tipped(self) -> bool:
        """Whether it lies or leans differently from how it was set down."""
        return self.tilt is None or self.tilt > TIPPED_ANGLE


def is_upset(release: ReleaseResult) -> bool:
    """Whether the simulator gave up, or the robot gained energy from nowhere."""
    return release.burst is not None or (release.gain or 0.0) > MAX_ENERGY_GAIN


@dataclass(frozen=True, slots=True, kw_only=True)
class StabilityCurve:
    """The stability of the simulation over its time step."""

    implicit: bool
    """Whether the damping of joints is integrated implicitly."""
    steps: tuple[float, ...]
    """Time steps (s), ascending."""
    speeds: tuple[float | None, ...]
    """For each step the largest speed (m/s) of a body within two seconds without torques, None where it burst."""
    gains: tuple[float | None, ...]
    """For each step the energy gain as in `ReleaseResult`, None where it burst."""
    stable: tuple[bool, ...]

    @property
    def largest_step(self) -> float | None:
        """The largest step (s) up to which all are stable, None where the smallest is not."""
        largest = None
        for step, stable in zip(self.steps, self.stable, strict=True):
            if not stable:
                break
            largest = step
        return largest

    @property
    def all_stable(self) -> bool:
        """Whether all steps are stable, so that larger ones may be too."""
        return all(self.stable)


@dataclass(frozen=True, slots=True, kw_only=True)
class DropTest:
    """A drop test."""

    model: str
    """Id of the model."""
    simulator: str
    """Name and version."""
    fixed: str
    """Why the root cannot move, empty if it can."""
    drawn: bool
    """Whether the robot rests on its visual geometry, because it has no collision geometry."""
    unread: tuple[str, ...]
    """Links of which a shape could not be read and does not touch: a robot that is not fixed may stand on something else."""
    shapes: int
    """Number of shapes that can touch the plane."""
    ground: float
    """Height (m) of the plane in the root's frame at the beginning: the robot's lowest point."""
    size: float
    """Diagonal (m) of the robot's bounding box; of that of its frames where it has no shape."""
    mass: float
    """kg."""
    slow: float
    """Speed (m/s) below which a body counts as settled."""
    soft: float
    """How deep (m) MuJoCo's default softness lets a body sink."""
    unlimited: tuple[str, ...]
    """Joints that are held without a limit, because their effort is zero."""
    free: ReleaseResult
    """Without motors."""
    held: ReleaseResult
    """With the joints held by their motors."""
    later: ReleaseResult | None
    """Held for ten seconds, where the robot did not settle in two."""
    finer: ReleaseResult | None
    """Without motors at a quarter of the time step, where it burst or gained energy at the whole one."""
    curves: tuple[StabilityCurve, ...]
    """Empty where only a check wanted to know how the robot stands."""
    drive: DriveTest | None
    """How the robot drives with its differential drive; None where it was not driven."""
    undriven: str
    """Why it was not driven; empty where it was, and where its root cannot move."""

    @property
    def weight(self) -> float:
        """N."""
        return self.mass * GRAVITY

    @property
    def is_marginal(self) -> bool:
        """Whether the simulation fails only with motors, which are those of this test, or only without them and not at a quarter
        of the time step: then parts are light, and not necessarily wrong."""
        if not is_upset(self.free):
            return self.held.burst is not None
        return self.held.burst is None and self.finer is not None and not is_upset(self.finer)

    @property
    def knows_ground(self) -> bool:
        """Whether all is known that could touch the ground, or nothing has to."""
        return bool(self.fixed) or not self.unread
