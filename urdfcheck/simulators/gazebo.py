"""Gazebo, represented by its parser (libsdformat), which converts URDF to SDF.

The library of a Debian or Ubuntu package is called through the two functions that the command ``gz sdf`` uses. Pinocchio computes
the dynamics of the converted model.
"""

from __future__ import annotations

import ctypes
import os
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from urdfcheck.simulators.engine_input import compute_dynamics, make_inertia
from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot

INSTALL = "apt install libsdformat-dev (Debian), or Gazebo itself"
LIBRARIES = ("pinocchio",)
# Where packages of Debian, Ubuntu, ROS and Gazebo install the library, and its names.
_FOLDERS = ("/usr/lib", "/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/local/lib")
_LIBRARY = re.compile(r"lib(?:gz-)?sdformat(\d+)\.so\.(\d+\.[\d.]+)")
# Digits that it prints, and the number that it writes for no limit.
_DIGITS, _NONE = 17, 1e16
# It may print elements of plugins with names that are invalid in XML or have an undeclared prefix.
_PREFIX = re.compile(r"(?<=[<\s/])([\w.-]+):+(?=[\w.-]+[\s=>/])")
_TENSOR = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))


def get_version() -> str | None:
    """Return the installed version."""
    found = _find_library()
    return None if found is None else found[1]


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load the converted model. Gazebo spawns no model that fails the check."""
    found = _find_library()
    if found is None:
        raise RuntimeError("libsdformat is not installed")
    library = ctypes.CDLL(found[0])
    if library.cmdCheck(os.fsencode(path)) != 0:
        raise RuntimeError("sdformat finds errors")
    # Versions differ in the number of these parameters; older ones ignore the rest.
    library.cmdPrint.argtypes = [ctypes.c_char_p, *[ctypes.c_int] * 2, ctypes.c_float, *[ctypes.c_int] * 3]
    printed = Path(path).with_name("converted.sdf")
    with _redirect_stdout(printed):
        library.cmdPrint(os.fsencode(path), 0, 0, 0.0, 0, _DIGITS, 0)
    text = printed.read_text(encoding="utf-8", errors="replace")
    model = ET.fromstring(_PREFIX.sub(r"\1_", text[text.index("<sdf") :])).find("model")
    if model is None:
        raise RuntimeError("the converted file holds no model")
    joints = {joint.get("name", ""): joint for joint in model.iter("joint")}
    frames = [frame.get("name", "") for frame in model.iter("frame")]  # a merged joint leaves a frame
    return LoadedRobot(
        links={link.get("name", ""): _read_number(link, "inertial/mass", 1.0) for link in model.iter("link")},
        joints=(*joints, *frames),
        limits={name: _read_limits(joints[name]) for name in robot.joints if name in joints},
        shapes=len(list(model.iter("collision"))),
        motion=_compute_dynamics(model, robot),
    )


def _find_library() -> tuple[str, str] | None:
    """Return path and version of the newest installed library."""
    found = []
    for folder in _FOLDERS:
        for name in os.listdir(folder) if os.path.isdir(folder) else ():
            named = _LIBRARY.fullmatch(name)
            if named:
                found.append((int(named[1]), named[2], os.path.join(folder, name)))
    return (max(found)[2], max(found)[1]) if found else None


@contextmanager
def _redirect_stdout(path: Path) -> Iterator[None]:
    """Redirect the output of native code to a file."""
    flush = ctypes.CDLL(None).fflush
    flush(None)
    saved = os.dup(1)
    try:
        with path.open("wb") as file:
            os.dup2(file.fileno(), 1)
        yield
    finally:
        flush(None)
        os.dup2(saved, 1)
        os.close(saved)


def _read_numbers(element: ET.Element, path: str, default: str) -> list[float]:
    return [float(word) for word in (element.findtext(path) or default).split()]


def _read_number(element: ET.Element, path: str, default: float) -> float:
    return float(element.findtext(path) or default)


def _read_limits(joint: ET.Element) -> tuple[float, float] | None:
    axis = joint.find("axis")
    if axis is None:
        return None
    lower, upper = _read_number(axis, "limit/lower", -_NONE), _read_number(axis, "limit/upper", _NONE)
    return None if lower <= -_NONE and upper >= _NONE else (lower, upper)


def _compute_dynamics(model: ET.Element, robot: EngineInput) -> EngineDynamics | None:
    """Compute the dynamics of the converted model with Pinocchio."""
    import numpy as np
    import pinocchio as pin

    links = {link.get("name", ""): link for link in model.iter("link")}
    behind: dict[str, list[ET.Element]] = {}
    moved = set()
    for joint in model.iter("joint"):
        behind.setdefault((joint.findtext("parent") or "").strip(), []).append(joint)
        moved.add((joint.findtext("child") or "").strip())
    built = pin.Model()
    supports: dict[str, tuple[int, Any]] = {name: (0, pin.SE3.Identity()) for name in {"world", *links} - moved}
    waiting = [joint for name in supports for joint in behind.get(name, ())]
    while waiting:  # depth first: Pinocchio requires the descendants of a joint to follow it directly
        joint = waiting.pop()
        child = (joint.findtext("child") or "").strip()
        waiting += behind.pop(child, [])
        index, before = supports[(joint.findtext("parent") or "").strip()]
        placed = before * _read_pose(joint)
        kind, axis = joint.get("type"), np.array(_read_numbers(joint, "axis/xyz", "0 0 1"))
        if kind == "fixed":
            supports[child] = index, placed
            continue
        if kind not in {"revolute", "continuous", "prismatic"} or not axis.any():
            return None
        axis = axis / np.linalg.norm(axis)
        moves = pin.JointModelPrismaticUnaligned if kind == "prismatic" else pin.JointModelRevoluteUnaligned
        supports[child] = built.addJoint(index, moves(axis), placed, joint.get("name", "")), pin.SE3.Identity()
    for name, (index, placed) in supports.items():
        inertial = links[name].find("inertial") if name in links else None
        if inertial is not None:
            pose = _read_pose(inertial)
            tensor = np.array([[_read_number(inertial, f"inertia/{key}", 0.0) for key in row] for row in _TENSOR])
            body = make_inertia(_read_number(inertial, "mass", 1.0), np.zeros(3), tensor)
            built.appendBodyToJoint(index, body, placed * _read_pose(links[name]) * pose)
    motion = compute_dynamics(built, robot)
    return None if motion is None else replace(motion, accelerations=())  # the accelerations depend on the simulator


def _read_pose(element: ET.Element) -> Any:
    """Read the pose of a joint, a link or an inertial in the frame that the converter uses: parent, joint or link."""
    import numpy as np
    import pinocchio as pin

    x, y, z, roll, pitch, yaw = _read_numbers(element, "pose", "0 0 0 0 0 0")
    return pin.SE3(pin.rpy.rpyToMatrix(roll, pitch, yaw), np.array([x, y, z]))
