"""The robot set on a plane at its lowest point, and released in a simulator."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from urdfcheck.core import FactUnavailableError, drop_test
from urdfcheck.core.drop_test import DropTest, GroundContact, ReleaseResult, StabilityCurve
from urdfcheck.facts.motion.simulation import (
    AVERAGING_WINDOW,
    MotionTrace,
    PlaneContact,
    Simulation,
    SimulationRefusedError,
    compute_rest_depth,
)
from urdfcheck.model.fact import fact
from urdfcheck.model.motion.driving.simulated_drive import run_drive_test
from urdfcheck.model.motion.mechanism import StandingRobot, build_standing_robot
from urdfcheck.model.robot import Model

# A check drops no robot with more joints: one of 50 that lies on the ground takes a second, one of 100 seven seconds. Published
# robots have up to 58.
MOST_JOINTS = 75
# This many steps are tried between a stable and an unstable one: the largest stable step is then known to 4 %.
_HALVINGS = 4
_BODY = re.compile(r"\bb(\d+)\b")


@fact
def run_drop_test(model: Model) -> DropTest:
    """Release the robot for two seconds, with zero and with holding torques, and drive it if it stands on wheels.

    No curve is measured: see `measure_step_curves`.

    :raises FactUnavailableError: when MuJoCo is not installed or refuses the model, when the tree or a mass is not known, or
        when the robot is too large for a check.
    """
    robot = build_standing_robot(model)
    count = sum(joint is not None for joint in robot.joints)
    if model.simulation == "brief" and count > MOST_JOINTS:
        raise FactUnavailableError(
            f"{count} joints move, and a check drops robots with up to {MOST_JOINTS}: urdfcheck drop"
        )
    with _explain_refusal(robot):
        test = _simulate_drop(robot, Simulation(robot.mechanism, robot.ground))
    return test if test.fixed else _add_drive(model, test)


@fact
def measure_step_curves(model: Model) -> tuple[StabilityCurve, ...]:
    """Release the robot with zero torques at other time steps, which takes ten times as long as `run_drop_test`.

    One curve as MuJoCo integrates damping; if there is any, another one as Bullet does.

    :raises FactUnavailableError: as `run_drop_test`.
    """
    robot = build_standing_robot(model)
    schemes = (True, False) if any(body.joint.damping for body in robot.mechanism.bodies) else (True,)
    with _explain_refusal(robot):
        simulation = Simulation(robot.mechanism, robot.ground)
        return tuple(_measure_step_curve(robot, simulation, implicit=implicit) for implicit in schemes)


@contextlib.contextmanager
def _explain_refusal(robot: StandingRobot) -> Iterator[None]:
    """Turn what keeps MuJoCo from simulating a robot into a `FactUnavailableError`."""
    try:
        yield
    except ImportError:
        raise FactUnavailableError("MuJoCo is not installed: pip install 'urdfcheck[engines]'") from None
    except SimulationRefusedError as reason:
        named = _BODY.search(reason.element)
        link = f", link {robot.heads[int(named[1])]!r}" if named is not None else ""
        raise FactUnavailableError(f"MuJoCo refuses the model: {reason}{link}") from None


def _add_drive(model: Model, test: DropTest) -> DropTest:
    """Drive a robot that stands."""
    if not test.knows_ground:
        return replace(test, undriven=f"a shape of link {test.unread[0]!r} could not be measured")
    if test.free.burst is not None or test.held.burst is not None or test.held.has_tipped:
        return replace(test, undriven="it does not stand")
    try:
        return replace(test, drive=run_drive_test(model))
    except FactUnavailableError as reason:
        return replace(test, undriven=str(reason))


def _simulate_drop(robot: StandingRobot, simulation: Simulation) -> DropTest:
    slow = drop_test.SETTLED_SPEED_RATIO * math.sqrt(drop_test.GRAVITY * robot.size)
    free, held = (
        _simulate_release(robot, simulation, slow=slow, seconds=drop_test.SECONDS, held=held) for held in (False, True)
    )
    return DropTest(
        model="",
        simulator=f"MuJoCo {simulation.version}",
        fixed=robot.fixed_reason,
        drawn=robot.uses_visuals,
        unread=robot.unread,
        shapes=len(robot.links),
        ground=robot.ground,
        size=robot.size,
        mass=simulation.weight / drop_test.GRAVITY,
        slow=slow,
        soft=compute_rest_depth(),
        unlimited=tuple(
            joint.name
            for joint, body in zip(robot.joints, robot.mechanism.bodies, strict=True)
            if joint is not None and body.joint.effort is not None and not math.isfinite(body.joint.effort)
        ),
        free=free,
        held=held,
        later=_simulate_release(robot, simulation, slow=slow, seconds=drop_test.LATE_SECONDS, held=True)
        if held.is_restless
        else None,
        finer=_simulate_release(
            robot, simulation, slow=slow, seconds=drop_test.SECONDS, held=False, step=drop_test.STEP / 4
        )
        if drop_test.is_upset(free)
        else None,
        curves=(),
        drive=None,
        undriven="",
    )


def _simulate_release(
    robot: StandingRobot,
    simulation: Simulation,
    *,
    slow: float,
    seconds: float,
    held: bool,
    step: float = drop_test.STEP,
) -> ReleaseResult:
    motion = simulation.run(seconds, step, hold_joints=held)
    gain, change = _compute_energy_change(robot, simulation, motion)
    burst = motion.burst_time is not None
    driven = [place for place, body in enumerate(robot.mechanism.bodies) if body.joint.effort is not None]
    worst = (
        max(driven, key=lambda place: abs(motion.joint_offsets[place]), default=None) if held and not burst else None
    )
    loose = {place for place in range(len(robot.heads)) if _is_loose(robot, place)}
    return ReleaseResult(
        held=held,
        burst=motion.burst_time,
        fastest=robot.heads[motion.fastest_body],
        gain=gain,
        change=change,
        speed=None if burst else float(motion.speed[motion.time > motion.time[-1] - AVERAGING_WINDOW].max()),
        moving=robot.heads[motion.last_fastest_body],
        settled=None if burst else _find_settling_time(motion, slow),
        tilt=None if burst else motion.tilt,
        touching=_list_ground_contacts(robot, motion),
        saturated=tuple(joint.name for place in motion.saturated if (joint := robot.joints[place]) is not None),
        sag=None if worst is None else abs(float(motion.joint_offsets[worst])),
        sagging="" if worst is None or (joint := robot.joints[worst]) is None else joint.name,
        rolls=motion.last_fastest_body in loose
        or any(robot.mechanism.geoms[touch.geom].body in loose for touch in motion.touching),
    )


def _find_settling_time(motion: MotionTrace, slow: float) -> float | None:
    """Return the time (s) after which nothing is faster than ``slow`` (m/s).

    None when something was in the last quarter of a second.
    """
    quick = np.flatnonzero(motion.speed > slow)
    if not len(quick):
        return 0.0
    last = int(quick[-1])
    return None if motion.time[last] > motion.time[-1] - AVERAGING_WINDOW else float(motion.time[last + 1])


def _list_ground_contacts(robot: StandingRobot, motion: MotionTrace) -> tuple[GroundContact, ...]:
    """Return what touches the ground, the shapes of one link merged."""
    links: dict[str, list[PlaneContact]] = {}
    for touch in motion.touching:
        links.setdefault(robot.links[touch.geom], []).append(touch)
    return tuple(_merge_touches(link, group) for link, group in links.items())


def _merge_touches(link: str, group: list[PlaneContact]) -> GroundContact:
    points = [touch.points for touch in group]
    x, y, z = np.average([touch.place for touch in group], axis=0, weights=points).tolist()
    return GroundContact(
        link=link,
        points=sum(points),
        place=(x, y, z),
        lowest=min(touch.lowest for touch in group),
        depth=max(touch.depth for touch in group),
        load=sum(touch.load for touch in group),
    )


def _is_loose(robot: StandingRobot, index: int) -> bool:
    """Whether a joint that nothing holds lies between a body and the root."""
    while index >= 0:
        joint, body = robot.joints[index], robot.mechanism.bodies[index]
        if joint is not None and body.joint.effort is None and joint.mimic is None:
            return True
        index = body.parent
    return False


def _measure_step_curve(robot: StandingRobot, simulation: Simulation, *, implicit: bool) -> StabilityCurve:
    results: dict[float, tuple[float | None, float | None, bool]] = {}

    def is_stable(step: float) -> bool:
        motion = simulation.run(drop_test.SECONDS, step, hold_joints=False, implicit_damping=implicit)
        gain, _ = _compute_energy_change(robot, simulation, motion)
        results[step] = (
            None if gain is None else float(motion.speed.max()),
            gain,
            gain is not None and gain <= drop_test.MAX_ENERGY_GAIN,
        )
        return results[step][2]

    for step in drop_test.STEPS:
        is_stable(step)
    bad = next((step for step in drop_test.STEPS if not results[step][2]), None)
    if bad is not None and bad > drop_test.STEPS[0]:
        low = bad / 2.0
        for _ in range(_HALVINGS):
            middle = math.sqrt(low * bad)
            low, bad = (middle, bad) if is_stable(middle) else (low, middle)
    steps = tuple(sorted(results))
    speeds, gains, good = zip(*(results[step] for step in steps), strict=True)
    return StabilityCurve(implicit=implicit, steps=steps, speeds=speeds, gains=gains, stable=good)


def _compute_energy_change(
    robot: StandingRobot, simulation: Simulation, motion: MotionTrace
) -> tuple[float | None, float | None]:
    """Compute by how much the energy rose above its initial value, and how it had changed at the end.

    Both as shares of weight times size; None for a simulation that burst.
    """
    if motion.burst_time is not None:
        return None, None
    scale = simulation.weight * robot.size
    over = motion.energy - motion.energy[0]
    return max(0.0, float(over.max()) / scale), float(over[-1]) / scale
