"""The robot set on a plane at its lowest point, and let go in a simulator."""

from __future__ import annotations

import math
import re

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core import drop_test as drop
from urdfcheck.core.drop_test import DropTest, GroundContact, ReleaseResult, StabilityCurve
from urdfcheck.facts.motion.simulation import (
    AVERAGING_WINDOW,
    GRAVITY,
    MotionTrace,
    PlaneContact,
    Simulation,
    SimulationRefusedError,
    compute_rest_depth,
)
from urdfcheck.model.fact import fact
from urdfcheck.model.motion.mechanism import StandingRobot, build_standing_robot
from urdfcheck.model.robot import Model

# Between a stable and an unstable step so many more are tried: the largest is then known to 4 %.
_HALVINGS = 4
_BODY = re.compile(r"\bb(\d+)\b")


@fact
def run_drop_test(model: Model) -> DropTest:
    """Let go for two seconds, with zero and with holding torques, and with zero torques at other time steps.

    :raises FactUnavailableError: when MuJoCo is not installed or refuses the model, or when the tree, a shape or a mass is not known.
    """
    if not model.may_simulate:
        raise FactUnavailableError("needs a simulator: urdfcheck drop")
    one = build_standing_robot(model)
    try:
        return _simulate_drop(one, Simulation(one.mechanism, one.ground))
    except ImportError:
        raise FactUnavailableError("MuJoCo is not installed: pip install 'urdfcheck[engines]'") from None
    except SimulationRefusedError as reason:
        named = _BODY.search(reason.element)
        link = f", link {one.heads[int(named[1])]!r}" if named is not None else ""
        raise FactUnavailableError(f"MuJoCo refuses the model: {reason}{link}") from None


def _simulate_drop(one: StandingRobot, simulation: Simulation) -> DropTest:
    slow = drop.SETTLED_SPEED_RATIO * math.sqrt(GRAVITY * one.size)
    free, held = (_simulate_release(one, simulation, slow, drop.SECONDS, held=held) for held in (False, True))
    damped = any(body.joint.damping for body in one.mechanism.bodies)
    return DropTest(
        model="",
        simulator=f"MuJoCo {simulation.version}",
        fixed=one.fixed_reason,
        drawn=one.uses_visuals,
        ground=one.ground,
        size=one.size,
        mass=simulation.weight / GRAVITY,
        slow=slow,
        soft=compute_rest_depth(),
        unlimited=tuple(
            joint.name
            for joint, body in zip(one.joints, one.mechanism.bodies, strict=True)
            if joint is not None and body.joint.effort is not None and not math.isfinite(body.joint.effort)
        ),
        free=free,
        held=held,
        later=_simulate_release(one, simulation, slow, drop.LATE_SECONDS, held=True) if held.is_restless else None,
        curves=tuple(
            _measure_step_curve(one, simulation, implicit=implicit)
            for implicit in ((True, False) if damped else (True,))
        ),
    )


def _simulate_release(
    one: StandingRobot, simulation: Simulation, slow: float, seconds: float, *, held: bool
) -> ReleaseResult:
    motion = simulation.run(seconds, drop.STEP, hold_joints=held)
    gain, change = _compute_energy_change(one, simulation, motion)
    burst = motion.burst_time is not None
    driven = [place for place, body in enumerate(one.mechanism.bodies) if body.joint.effort is not None]
    worst = (
        max(driven, key=lambda place: abs(motion.joint_offsets[place]), default=None) if held and not burst else None
    )
    loose = {place for place in range(len(one.heads)) if _is_loose(one, place)}
    return ReleaseResult(
        held=held,
        burst=motion.burst_time,
        fastest=one.heads[motion.fastest_body],
        gain=gain,
        change=change,
        speed=None if burst else float(motion.speed[motion.time > motion.time[-1] - AVERAGING_WINDOW].max()),
        moving=one.heads[motion.last_fastest_body],
        settled=None if burst else _find_settling_time(motion, slow),
        tilt=None if burst else motion.tilt,
        touching=_list_ground_contacts(one, motion),
        saturated=tuple(joint.name for place in motion.saturated if (joint := one.joints[place]) is not None),
        sag=None if worst is None else abs(float(motion.joint_offsets[worst])),
        sagging="" if worst is None or (joint := one.joints[worst]) is None else joint.name,
        rolls=motion.last_fastest_body in loose
        or any(one.mechanism.geoms[touch.geom].body in loose for touch in motion.touching),
    )


def _find_settling_time(motion: MotionTrace, slow: float) -> float | None:
    """Since when (s) nothing is faster than ``slow`` (m/s); None when something was in the last quarter of a second."""
    quick = np.flatnonzero(motion.speed > slow)
    if not len(quick):
        return 0.0
    last = int(quick[-1])
    return None if motion.time[last] > motion.time[-1] - AVERAGING_WINDOW else float(motion.time[last + 1])


def _list_ground_contacts(one: StandingRobot, motion: MotionTrace) -> tuple[GroundContact, ...]:
    """What touches the ground, the shapes of one link together."""
    links: dict[str, list[PlaneContact]] = {}
    for touch in motion.touching:
        links.setdefault(one.links[touch.geom], []).append(touch)
    return tuple(_merge_touches(link, group) for link, group in links.items())


def _merge_touches(link: str, group: list[PlaneContact]) -> GroundContact:
    points = [touch.points for touch in group]
    x, y, z = np.average([touch.place for touch in group], axis=0, weights=points).tolist()
    return GroundContact(
        link,
        sum(points),
        (x, y, z),
        min(touch.lowest for touch in group),
        max(touch.depth for touch in group),
        sum(touch.load for touch in group),
    )


def _is_loose(one: StandingRobot, place: int) -> bool:
    """Whether a joint that nothing holds lies between a body and the root."""
    while place >= 0:
        joint, body = one.joints[place], one.mechanism.bodies[place]
        if joint is not None and body.joint.effort is None and joint.mimic is None:
            return True
        place = body.parent
    return False


def _measure_step_curve(one: StandingRobot, simulation: Simulation, *, implicit: bool) -> StabilityCurve:
    found: dict[float, tuple[float | None, float | None, bool]] = {}

    def is_stable(step: float) -> bool:
        motion = simulation.run(drop.SECONDS, step, hold_joints=False, implicit_damping=implicit)
        gain, _ = _compute_energy_change(one, simulation, motion)
        found[step] = (
            None if gain is None else float(motion.speed.max()),
            gain,
            gain is not None and gain <= drop.MAX_ENERGY_GAIN,
        )
        return found[step][2]

    for step in drop.STEPS:
        is_stable(step)
    bad = next((step for step in drop.STEPS if not found[step][2]), None)
    if bad is not None and bad > drop.STEPS[0]:
        low = bad / 2.0
        for _ in range(_HALVINGS):
            middle = math.sqrt(low * bad)
            low, bad = (middle, bad) if is_stable(middle) else (low, middle)
    steps = tuple(sorted(found))
    speeds, gains, good = zip(*(found[step] for step in steps), strict=True)
    return StabilityCurve(implicit, steps, speeds, gains, good)


def _compute_energy_change(
    one: StandingRobot, simulation: Simulation, motion: MotionTrace
) -> tuple[float | None, float | None]:
    """By how much the energy rose above that at the beginning, and how it changed until the end; parts of weight times size."""
    if motion.burst_time is not None:
        return None, None
    scale = simulation.weight * one.size
    over = motion.energy - motion.energy[0]
    return max(0.0, float(over.max()) / scale), float(over[-1]) / scale
