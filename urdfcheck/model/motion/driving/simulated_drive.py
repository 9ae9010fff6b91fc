"""The robot driven on a plane in a simulator: half a turn of its wheels ahead, and half a turn against each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError, drive_test
from urdfcheck.core.drive_test import DriveRun, DriveTest, WheelTravel
from urdfcheck.facts.likeness.revolution import measure_outline
from urdfcheck.facts.motion.driving import DriveTrace, DrivingSimulation
from urdfcheck.facts.motion.simulation import Geom, Mechanism, SimulationRefusedError
from urdfcheck.model.fact import fact
from urdfcheck.model.ground.drive_plugins import read_friction
from urdfcheck.model.ground.wheels import is_suspended, rolling_wheels
from urdfcheck.model.motion.driving.drive_plan import DrivePlan, find_drive_plan
from urdfcheck.model.motion.mechanism import StandingRobot, build_standing_robot
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A robot that leans by more (rad) when it begins to move does not stand on its wheels.
_FALLEN = 0.26
_DEFAULT_FRICTION = 1.0
# Width of a disc, as a share of its radius; cosine of the angle between a cylinder and its axis: 1°.
_THIN, _ALIGNED = 0.02, 0.99985


@fact
def run_drive_test(model: Model) -> DriveTest:
    """Drive the robot with its differential drive.

    :raises FactUnavailableError: when it has none, stands on something else or is not known well enough; when MuJoCo is not
        installed or refuses the model.
    """
    robot = build_standing_robot(model)
    if robot.fixed_reason:
        raise FactUnavailableError("the root is fixed")
    plan = find_drive_plan(model)
    if plan is None:
        raise FactUnavailableError(
            "neither a controller, nor a plugin, nor one pair of wheels shows a differential drive"
        )
    names = (*plan.left, *plan.right)
    if any(is_suspended(model, model.joint_by_name[name].child) for name in names):
        raise FactUnavailableError("its wheels are suspended")
    round_joints = {wheel.joint.name: wheel.radius for wheel in rolling_wheels(model)}
    unknown = [name for name in names if name not in round_joints]
    if unknown:
        raise FactUnavailableError(f"the child of joint {unknown[0]!r} is not known to be a round wheel")
    places = {joint.name: place for place, joint in enumerate(robot.joints) if joint is not None}
    wheels = {places[name]: read_wheel_friction(model, name) for name in names}
    mechanism = robot.mechanism
    for name in names:
        mechanism = _make_discs(mechanism, places[name], name)
    radius = max(round_joints[name] for name in names)
    try:
        simulation = DrivingSimulation(mechanism, robot.ground, wheels, radius)
        signs = [plan.signs[name not in plan.left] for name in names]
        sides = [-1.0 if name in plan.left else 1.0 for name in names]
        ahead = _drive(simulation, [drive_test.HALF_TURN * sign for sign in signs])
        against = _drive(
            simulation, [drive_test.HALF_TURN * sign * side for sign, side in zip(signs, sides, strict=True)]
        )
    except ImportError:
        raise FactUnavailableError("MuJoCo is not installed: pip install 'urdfcheck[engines]'") from None
    except SimulationRefusedError as reason:
        raise FactUnavailableError(f"MuJoCo refuses the model: {reason}") from None
    return _build_test(model, robot, plan, ahead=ahead, against=against)


def _make_discs(mechanism: Mechanism, place: int, name: str) -> Mechanism:
    """Replace what a wheel touches the ground with by a thin disc in the middle of its width.

    Over the corners of a mesh the robot would jolt, and where across its width a wide wheel pivots depends on the engine. A
    cylinder that is askew on its axis stays what it is.

    :raises FactUnavailableError: when it touches the ground with something that is not round.
    """
    geoms = [geom for geom in mechanism.geoms if geom.body == place]
    if any(geom.kind == "box" for geom in geoms):
        raise FactUnavailableError(f"the wheel of joint {name!r} collides as a box")
    if not geoms:
        raise FactUnavailableError(f"the wheel of joint {name!r} has no shape that could touch the ground")
    axis = mechanism.bodies[place].joint.axis
    hulls = [geom.points @ geom.pose[:3, :3].T + geom.pose[:3, 3] for geom in geoms if geom.points is not None]
    discs = [_thin_cylinder(geom, axis) for geom in geoms if geom.points is None]
    if hulls:
        outline = measure_outline(np.concatenate(hulls), axis, np.zeros(3))
        if not outline.is_round():
            raise FactUnavailableError(
                f"the wheel of joint {name!r} collides as a mesh that is not round about the axis"
            )
        pose = np.eye(4)
        across = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
        across /= np.linalg.norm(across)
        pose[:3, :3] = np.column_stack((across, np.cross(axis, across), axis))
        pose[:3, 3] = outline.centre
        radius = float(outline.radius)
        discs.append(Geom(body=place, kind="cylinder", size=(radius, _THIN * radius), pose=pose))
    return replace(mechanism, geoms=(*(geom for geom in mechanism.geoms if geom.body != place), *discs))


def _thin_cylinder(geom: Geom, axis: Array) -> Geom:
    if geom.kind != "cylinder" or abs(float(geom.pose[:3, 2] @ axis)) < _ALIGNED:
        return geom
    radius, length = geom.size
    return replace(geom, size=(radius, min(length, _THIN * radius)))


def read_wheel_friction(model: Model, name: str) -> float:
    """Read the friction that a ``<gazebo>`` gives a wheel; 1 where none is typed, Gazebo's and MuJoCo's default."""
    child = model.joint_by_name[name].child
    for block in model.robot.find_children("gazebo"):
        if block.get("reference") == child and (friction := read_friction(block)) is not None:
            return min(max(0.0, *friction), _DEFAULT_FRICTION)
    return _DEFAULT_FRICTION


def _drive(simulation: DrivingSimulation, angles: list[float]) -> DriveTrace:
    trace = simulation.drive(
        angles,
        rest=drive_test.REST_SECONDS,
        step=drive_test.STEP,
        acceleration=drive_test.ACCELERATION,
    )
    if trace is None:
        raise FactUnavailableError("the simulation of the drive diverges")
    if any(math.acos(min(1.0, float(pose[2, 2]))) > _FALLEN for pose in (trace.poses[0], trace.poses[-1])):
        raise FactUnavailableError("it does not stay upright on its wheels")
    return trace


def _build_test(
    model: Model, robot: StandingRobot, plan: DrivePlan, *, ahead: DriveTrace, against: DriveTrace
) -> DriveTest:
    frame = model.frames[plan.frame][:3, :3]
    heights = ahead.centres[0, :, 2] - robot.ground
    if min(heights) <= 0:
        raise FactUnavailableError("an axle is below the ground")
    return DriveTest(
        source=plan.source,
        frame=plan.frame,
        left=plan.left,
        right=plan.right,
        radius=float(heights.mean()),
        separation=_measure_separation(model, plan),
        typed_radius=None if plan.radius is None else plan.radius.size,
        typed_separation=None if plan.separation is None else plan.separation.size,
        forward=_measure_run(ahead, frame, _measure_wheels(model, plan, ahead, heights)),
        turning=_measure_run(against, frame, _measure_wheels(model, plan, against, heights)),
        wheels=_measure_wheels(model, plan, ahead, heights),
    )


def _measure_wheels(model: Model, plan: DrivePlan, trace: DriveTrace, heights: Array) -> tuple[WheelTravel, ...]:
    return tuple(
        WheelTravel(
            joint=name,
            radius=float(heights[index]),
            rolled=float(heights[index] * (trace.angles[-1, index] - trace.angles[0, index])),
            travelled=_measure_travel(model, name, trace, index),
            load=float(trace.loads[index]),
        )
        for index, name in enumerate((*plan.left, *plan.right))
    )


def _measure_heading_directions(frame: Array) -> Array:
    """Return the level directions (2, 3) of the x axis of a frame (3, 3), and of what is to its left."""
    ahead = np.array((frame[0, 0], frame[1, 0], 0.0))
    length = float(np.linalg.norm(ahead))
    if not length > 0.5:
        raise FactUnavailableError("the x axis of the frame that drives is not level")
    ahead /= length
    return np.array((ahead, np.cross((0.0, 0.0, 1.0), ahead)))


def _measure_run(trace: DriveTrace, frame: Array, wheels: Sequence[WheelTravel]) -> DriveRun:
    middle = trace.centres.mean(axis=1)
    directions = _measure_heading_directions(trace.poses[0, :3, :3] @ frame)
    ahead, aside = (directions @ (middle[-1] - middle[0])).tolist()
    headings = np.unwrap(np.arctan2(trace.poses[:, 1, 0], trace.poses[:, 0, 0]))
    return DriveRun(
        ahead=ahead,
        aside=aside,
        turned=float(headings[-1] - headings[0]),
        slip=max(wheel.slip for wheel in wheels),
    )


def _measure_travel(model: Model, name: str, trace: DriveTrace, index: int) -> float:
    """Measure how far (m) a wheel moved at right angles to its axis, along the ground."""
    axes = trace.poses[:, :3, :3] @ model.axes[name]
    along = np.cross(axes, (0.0, 0.0, 1.0))
    along /= np.linalg.norm(along, axis=1)[:, None]
    steps = np.diff(trace.centres[:, index], axis=0)
    return float((steps * (along[1:] + along[:-1]) / 2).sum())


def _measure_separation(model: Model, plan: DrivePlan) -> float:
    """Measure the distance (m) between the middles of the wheels of the two sides."""
    wheels = {wheel.joint.name: wheel for wheel in rolling_wheels(model)}
    left, right = (np.mean([wheels[name].centre for name in side], axis=0) for side in (plan.left, plan.right))
    apart = abs(float((left - right) @ wheels[plan.left[0]].axis))
    if not apart > 0:
        raise FactUnavailableError("the wheels of both sides are in one plane")
    return apart
