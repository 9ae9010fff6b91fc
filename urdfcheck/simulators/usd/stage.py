"""Read a robot from a USD file, as the importers write it: a tree of links, and joints beside it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import Any

from urdfcheck.core.records import dataclass
from urdfcheck.simulators.engine_input import compute_dynamics, make_inertia
from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot, Range, Vector
from urdfcheck.simulators.usd.bounds import bound_drawn

# USD has positions, rotations and moments in single precision: of 32 published robots the frames and mass matrices differ by up
# to 3e-6 behind a chain of joints.
_ACCURACY = 1e-5
# Names that are printed of those that were replaced.
_MOST_NAMES = 3


@dataclass(frozen=True, slots=True)
class _StagedRobot:
    """The bodies and joints of a stage as a ``pinocchio.Model`` with a fixed root."""

    built: Any
    supports: dict[Any, tuple[int, Any]] = field(default_factory=dict)
    """Path of a prim → index of the joint that moves it, and its placement behind that joint."""


def read_robot(path: str, robot: EngineInput) -> LoadedRobot:
    """Read the robot of a USD file. Prints which names the importer replaced."""
    from pxr import Usd, UsdPhysics

    stage = Usd.Stage.Open(path)
    prims = list(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
    bodies = [prim for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    joints = {_read_name(prim): prim for prim in prims if prim.IsA(UsdPhysics.Joint)}
    _print_renamed([*bodies, *joints.values()])
    links = _find_links(prims, bodies, robot)
    staged = _build_robot(prims, joints)
    return LoadedRobot(
        links={_read_name(prim): float(UsdPhysics.MassAPI(prim).GetMassAttr().Get() or 0.0) for prim in bodies},
        joints=tuple(joints),
        limits={name: _read_limits(joints[name]) for name in robot.joints if name in joints},
        shapes=sum(prim.HasAPI(UsdPhysics.CollisionAPI) for prim in prims),
        motion=None if staged is None else _compute_motion(staged, bodies, robot),
        frames=None if staged is None else _compute_frames(staged, links, joints, robot),
        drawn=dict(bound_drawn(links)),
        accuracy=_ACCURACY,
    )


def _read_name(prim: Any) -> str:
    name: str = prim.GetDisplayName() or prim.GetName()
    return name


def _print_renamed(prims: list[Any]) -> None:
    """Print which names were replaced, as what the engine says."""
    renamed = list(_iter_renamed(prims))
    if renamed:
        more = f" and {len(renamed) - _MOST_NAMES} more" if len(renamed) > _MOST_NAMES else ""
        print(f"replaces names that USD does not allow: {', '.join(renamed[:_MOST_NAMES])}{more}")


def _iter_renamed(prims: list[Any]) -> Iterator[str]:
    for prim in prims:
        if _read_name(prim) != prim.GetName():
            yield f"{_read_name(prim)} by {prim.GetName()}"


def _find_links(prims: list[Any], bodies: list[Any], robot: EngineInput) -> dict[str, Any]:
    """Find the prims of the links: bodies, and what has the name of another link and is in a link or is the root.

    A visual may have the name of a link too: a name that several prims could have got is left out.
    """
    found = {_read_name(prim): prim for prim in bodies}
    names = set() if robot.typed is None else set(robot.typed.heads) - set(found)
    paths = {prim.GetPath() for prim in bodies}
    several: set[str] = set()
    for prim in prims:  # parents first
        name = _read_name(prim)
        if name not in names or prim.GetTypeName() != "Xform":
            continue
        above = prim.GetParent()
        if above.GetPath() in paths or above.GetTypeName() == "Scope":
            if name in found:
                several.add(name)
            found.setdefault(name, prim)
            paths.add(prim.GetPath())
    return {name: prim for name, prim in found.items() if name not in several}


def _read_limits(prim: Any) -> Range | None:
    """Read the limits of a joint in rad or m; infinity where there is none."""
    from pxr import UsdPhysics

    kinds = (UsdPhysics.RevoluteJoint, UsdPhysics.PrismaticJoint)
    kind = next((kind for kind in kinds if prim.IsA(kind)), None)
    if kind is None:
        return None
    lower, upper = kind(prim).GetLowerLimitAttr().Get(), kind(prim).GetUpperLimitAttr().Get()
    unit = _get_unit(prim)
    return None if lower is None or upper is None else (float(lower) * unit, float(upper) * unit)


def _get_unit(prim: Any) -> float:
    """Return the unit of a joint's position in rad or m: USD has degrees."""
    from pxr import UsdPhysics

    return math.radians(1.0) if prim.IsA(UsdPhysics.RevoluteJoint) else 1.0


def _build_robot(prims: list[Any], joints: Mapping[str, Any]) -> _StagedRobot | None:
    """Build the robot; None where a joint is of another kind, or a link is not below what its joint hangs on."""
    import pinocchio as pin
    from pxr import Sdf, UsdGeom, UsdPhysics

    above = {}
    for name, prim in joints.items():
        for path in UsdPhysics.Joint(prim).GetBody1Rel().GetTargets():
            above[path] = name, prim
    cache = UsdGeom.XformCache()
    staged = _StagedRobot(pin.Model(), {Sdf.Path.absoluteRootPath: (0, pin.SE3.Identity())})
    supports = staged.supports
    for prim in prims:  # parents first, and depth first as Pinocchio requires it
        path = prim.GetPath()
        if path not in above:
            index, placement = supports.get(path.GetParentPath(), (0, None))
            if placement is not None and prim.IsA(UsdGeom.Imageable):
                supports[path] = index, placement * _make_placement(cache.GetLocalTransformation(prim)[0])
            continue
        name, joint = above[path]
        hung = UsdPhysics.Joint(joint).GetBody0Rel().GetTargets() or [Sdf.Path.absoluteRootPath]
        if hung[0] not in supports:
            return None
        index, placement = supports[hung[0]]
        before, after = _read_joint_frames(joint)
        if not joint.IsA(UsdPhysics.FixedJoint):
            kind = _make_joint_model(joint)
            if kind is None:
                return None
            index, placement = staged.built.addJoint(index, kind, placement * before, name), pin.SE3.Identity()
            before = pin.SE3.Identity()
        supports[path] = index, placement * before * after.inverse()
    return staged


def _make_placement(matrix: Any) -> Any:
    """Make the placement of a matrix of USD, whose rows are the axes; a scale is left out."""
    import numpy as np
    import pinocchio as pin

    without = np.array(matrix.RemoveScaleShear()).T
    return pin.SE3(without[:3, :3], without[:3, 3])


def _read_joint_frames(prim: Any) -> tuple[Any, Any]:
    """Read the frames of a joint in its two bodies."""
    import numpy as np
    import pinocchio as pin
    from pxr import UsdPhysics

    joint = UsdPhysics.Joint(prim)
    frames = []
    for place, turn in (
        (joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
        (joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
    ):
        rotation = turn.Get()
        quaternion = pin.Quaternion(rotation.GetReal(), *map(float, rotation.GetImaginary())).normalized()
        frames.append(pin.SE3(quaternion.matrix(), np.array(place.Get(), dtype=float)))
    return frames[0], frames[1]


def _make_joint_model(prim: Any) -> Any:
    """Make Pinocchio's model of a joint; None for one that is neither revolute nor prismatic."""
    import numpy as np
    import pinocchio as pin
    from pxr import UsdPhysics

    for kind, model in (
        (UsdPhysics.RevoluteJoint, pin.JointModelRevoluteUnaligned),
        (UsdPhysics.PrismaticJoint, pin.JointModelPrismaticUnaligned),
    ):
        if prim.IsA(kind):
            return model(np.array([float(kind(prim).GetAxisAttr().Get() == axis) for axis in "XYZ"]))
    return None


def _compute_motion(staged: _StagedRobot, bodies: list[Any], robot: EngineInput) -> EngineDynamics | None:
    """Compute the dynamics with Pinocchio, from the numbers that the importer wrote."""
    built = staged.built.copy()
    for prim in bodies:
        index, placement = staged.supports[prim.GetPath()]
        built.appendBodyToJoint(index, _read_inertia(prim), placement)
    motion = compute_dynamics(built, robot)
    return None if motion is None else replace(motion, accelerations=())  # the accelerations depend on the simulator


def _read_inertia(prim: Any) -> Any:
    """Read the inertia of a body; what the importer left out counts as zero."""
    import numpy as np
    import pinocchio as pin
    from pxr import UsdPhysics

    api = UsdPhysics.MassAPI(prim)
    centre = np.array(api.GetCenterOfMassAttr().Get() or (0.0, 0.0, 0.0), dtype=float)
    moments = np.array(api.GetDiagonalInertiaAttr().Get() or (0.0, 0.0, 0.0), dtype=float)
    axes = api.GetPrincipalAxesAttr().Get()
    tensor = np.diag(moments)
    if axes is not None and axes.GetLength() > 0:
        turned = pin.Quaternion(axes.GetReal(), *map(float, axes.GetImaginary())).normalized().matrix()
        tensor = turned @ tensor @ turned.T
    mass = float(api.GetMassAttr().Get() or 0.0)
    return make_inertia(mass, np.where(np.isfinite(centre), centre, 0.0), tensor)


def _compute_frames(
    staged: _StagedRobot, links: Mapping[str, Any], joints: Mapping[str, Any], robot: EngineInput
) -> tuple[Mapping[str, Vector], ...] | None:
    """Compute the frames of the links in that of the root at each sample; None where the root has none."""
    import pinocchio as pin

    built, supports = staged.built, staged.supports
    root = None if robot.typed is None else links.get(robot.typed.root)
    if root is None:
        return None
    data, found = built.createData(), []
    for values in robot.samples:
        positions = _apply_mimics(dict(zip(robot.joints, values, strict=True)), joints)
        q = pin.neutral(built)
        for name, value in positions.items():
            if built.existJointName(name):
                q[built.joints[built.getJointId(name)].idx_q] = value
        pin.forwardKinematics(built, data, q)
        placed = {
            name: data.oMi[supports[prim.GetPath()][0]] * supports[prim.GetPath()][1] for name, prim in links.items()
        }
        base = placed[robot.typed.root].inverse() if robot.typed is not None else pin.SE3.Identity()
        found.append({name: tuple((base * frame).homogeneous[:3].ravel().tolist()) for name, frame in placed.items()})
    return tuple(found)


def _apply_mimics(values: dict[str, float], joints: Mapping[str, Any]) -> dict[str, float]:
    """Return the positions of the joints where those that mimic others follow them, also in chains.

    One that mimics a joint that does not move is left where it is: what a simulator makes of that is not in the file.
    """
    names = {prim.GetPath(): name for name, prim in joints.items()}
    leaders = {}
    for name, prim in joints.items():
        relation = prim.GetRelationship("newton:mimicJoint")
        for path in relation.GetTargets() if relation else ():
            offset, factor = (float(prim.GetAttribute(f"newton:mimicCoef{i}").Get() or 0.0) for i in (0, 1))
            if names.get(path) in values:
                leaders[name] = names[path], factor, offset * _get_unit(prim)
    moved = dict(values)
    for _ in leaders:  # at most as many steps as there are followers
        for name, (leader, factor, offset) in leaders.items():
            moved[name] = factor * moved[leader] + offset
    return moved
