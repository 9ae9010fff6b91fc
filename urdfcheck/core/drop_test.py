"""What came of a robot that was set on a plane and let go, as plain values. Standard library only.

Places are in the root link's frame, in m. A number that is no number, because the simulation burst, is None.
"""

from __future__ import annotations

from dataclasses import dataclass

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


@dataclass(frozen=True, slots=True)
class GroundContact:
    """A link on the plane at the end: the number of ``points``, their middle ``place`` on its surface, ``lowest`` z of them,
    ``depth`` (m) in the plane, ``load`` (N, over the last quarter of a second)."""

    link: str
    points: int
    place: tuple[float, float, float]
    lowest: float
    depth: float
    load: float


@dataclass(frozen=True, slots=True)
class ReleaseResult:
    """The robot let go, ``held`` by its motors or not.

    ``burst`` (s): when the simulator gave up, None if it did not; ``fastest``: the link that was the fastest of all.
    ``gain``: by how much its mechanical energy rose above that at the beginning, and ``change``: what it is at the end, both in
    parts of weight times size. ``speed`` (m/s): of ``moving``, the fastest link in the last quarter of a second;
    ``settled`` (s): since when none is faster than the limit, None when one still is. ``tilt`` (rad): of the root.
    ``saturated``: joints that are held with all their effort at the end. ``sag`` (rad or m): how far the joint ``sagging`` has
    given way, the farthest of those that are held. ``rolls``: whether it stands on something that no motor holds, or what
    moves is such a thing.
    """

    held: bool
    burst: float | None
    fastest: str
    gain: float | None
    change: float | None
    speed: float | None
    moving: str
    settled: float | None
    tilt: float | None
    touching: tuple[GroundContact, ...]
    saturated: tuple[str, ...]
    sag: float | None
    sagging: str
    rolls: bool

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
        """Whether it lies or leans otherwise than it was set down."""
        return self.tilt is None or self.tilt > TIPPED_ANGLE


@dataclass(frozen=True, slots=True)
class StabilityCurve:
    """Time ``steps`` (s), ascending, and for each the largest ``speeds`` (m/s) of a body within two seconds without torques
    and the energy that was ``gains`` as in `ReleaseResult`, None where it burst. ``implicit``: how the damping of joints is
    integrated. ``largest`` (s): the largest step up to which all are stable, None where none is; ``all_stable``: there may be
    larger ones."""

    implicit: bool
    steps: tuple[float, ...]
    speeds: tuple[float | None, ...]
    gains: tuple[float | None, ...]
    stable: tuple[bool, ...]

    @property
    def largest_step(self) -> float | None:
        """See above."""
        found = None
        for step, stable in zip(self.steps, self.stable, strict=True):
            if not stable:
                break
            found = step
        return found

    @property
    def all_stable(self) -> bool:
        """See above."""
        return all(self.stable)


@dataclass(frozen=True, slots=True)
class DropTest:
    """A drop test.

    ``model``: id of the model; ``fixed``: why its root cannot move, empty if it can; ``drawn``: whether it stands on what it
    draws, because it collides with nothing. ``ground`` (m): the height of the plane in the root's frame at the beginning, the
    robot's lowest point; ``size`` (m): the diagonal of the box round it; ``mass`` in kg. ``slow`` (m/s): what counts as
    settled; ``soft`` (m): how deep MuJoCo's default softness lets a body sink. ``unlimited``: joints that are held without a
    limit, because their effort is zero. ``later``: held for ten seconds, where it did not settle in two. ``simulator``: its
    name and version.
    """

    model: str
    simulator: str
    fixed: str
    drawn: bool
    ground: float
    size: float
    mass: float
    slow: float
    soft: float
    unlimited: tuple[str, ...]
    free: ReleaseResult
    held: ReleaseResult
    later: ReleaseResult | None
    curves: tuple[StabilityCurve, ...]
