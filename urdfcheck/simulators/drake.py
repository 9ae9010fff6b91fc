"""Drake."""

from __future__ import annotations

import math
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution
from pathlib import Path
from typing import Any

from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot, Vector

INSTALL = "pip install 'urdfcheck[engines]'"
LIBRARIES = ("pydrake.multibody.parsing", "pydrake.multibody.plant")


def get_version() -> str | None:
    """Return the installed version."""
    try:
        return distribution("drake")
    except PackageNotFoundError:
        return None


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load with contacts and the root welded to the world; the dynamics are computed with a plant without shapes."""
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant, scene = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    links, joints = _parse_model(plant, robot, path)
    context = builder.Build().CreateDefaultContext()
    # Convex hulls are computed by the first contact query.
    scene.get_query_output_port().Eval(scene.GetMyContextFromRoot(context)).HasCollisions()
    bare = MultibodyPlant(0.0)
    _, moved = _parse_model(bare, robot, path)
    return LoadedRobot(
        links={body.name(): float(body.default_mass()) for body in links},
        joints=tuple(joints),
        limits={
            name: (float(joints[name].position_lower_limit()), float(joints[name].position_upper_limit()))
            for name in robot.joints
            if name in joints and joints[name].num_positions() == 1
        },
        shapes=plant.num_collision_geometries(),
        motion=_compute_dynamics(bare, bare.CreateDefaultContext(), joints=moved, robot=robot),
    )


def _parse_model(plant: Any, robot: EngineInput, path: str) -> tuple[list[Any], dict[str, Any]]:
    """Parse the model into the plant; return its links, and its joints by name."""
    from pydrake.multibody.parsing import Parser

    parser = Parser(plant)
    packages = parser.package_map()
    for name in packages.GetPackageNames():  # Drake's own: drake_models would be fetched from its server
        packages.Remove(name)
    (instance,) = parser.AddModels(Path(path))
    links = [plant.get_body(i) for i in plant.GetBodyIndices(instance)]
    joints = {joint.name(): joint for joint in map(plant.get_joint, plant.GetJointIndices(instance))}
    root = next((body for body in links if robot.typed is not None and body.name() == robot.typed.root), None)
    if root is not None and root.name() != "world":
        plant.WeldFrames(plant.world_frame(), root.body_frame())
    plant.Finalize()
    return links, joints


def _compute_dynamics(plant: Any, context: Any, *, joints: dict[str, Any], robot: EngineInput) -> EngineDynamics | None:
    import numpy as np

    if any(name not in joints or joints[name].num_velocities() != 1 for name in robot.joints):
        return None
    rows = [joints[name].velocity_start() for name in robot.joints]
    places = [joints[name].position_start() for name in robot.joints]
    masses, torques = [], []
    for values in (*robot.samples, robot.start):
        positions = plant.GetPositions(context)
        positions[places] = values
        plant.SetPositions(context, positions)
        masses.append(tuple(map(tuple, plant.CalcMassMatrix(context)[np.ix_(rows, rows)].tolist())))
        torques.append(tuple((-plant.CalcGravityGeneralizedForces(context))[rows].tolist()))
    return EngineDynamics(
        joints=robot.joints,
        masses=tuple(masses[:-1]),
        torques=tuple(torques[:-1]),
        accelerations=_compute_accelerations(plant, context, rows),
    )


def _compute_accelerations(plant: Any, context: Any, rows: list[int]) -> Vector:
    """Compute the accelerations at the last configuration; NaN where Drake rejects a body without inertia.

    Empty for a plant with constraints, such as mimic joints, which Drake does not support in continuous time.
    """
    if plant.num_velocities() != len(rows) or plant.num_constraints():
        return ()
    try:
        derivatives = plant.get_generalized_acceleration_output_port().Eval(context)
    except RuntimeError as error:
        print(error)
        return (math.nan,) * len(rows)
    return tuple(derivatives[rows].tolist())
