"""yourdfpy, the loader of many robot learning projects; it draws with trimesh."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution
from typing import Any

from urdfcheck.simulators.outcome import EngineInput, LoadedRobot, Range, Vector

INSTALL = "pip install yourdfpy"
LIBRARIES = ("yourdfpy",)
# Placement in the frame of the root, or corners of a box, by link.
LinkValues = Mapping[str, Vector]


def get_version() -> str | None:
    """Return the installed version."""
    try:
        return distribution("yourdfpy")
    except PackageNotFoundError:
        return None


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load with yourdfpy's own defaults: the scene is what the visuals draw, and only ``validate`` reports errors."""
    import yourdfpy

    logging.basicConfig(handlers=[_MessageHandler()])
    model = yourdfpy.URDF.load(path)
    if not model.validate():
        print("\n".join(f"validate: {error.msg}" for error in model.errors))
    links = model.robot.links
    return LoadedRobot(
        links={link.name: _read_mass(link) for link in links},
        joints=tuple(joint.name for joint in model.robot.joints),
        limits={name: _read_limits(model.joint_map[name]) for name in robot.joints if name in model.joint_map},
        shapes=sum(len(link.collisions) for link in links),
        # Before the joints move: the boxes are those of the links, whose frames do not matter.
        drawn=dict(_iter_drawn_boxes(model)),
        frames=tuple(_iter_frames(model, robot)),
    )


class _MessageHandler(logging.Handler):
    """Prints messages without the tracebacks that trimesh adds, which name files of this machine."""

    def emit(self, record: logging.LogRecord) -> None:
        print(record.getMessage())


def _read_mass(link: Any) -> float:
    mass = None if link.inertial is None else link.inertial.mass
    return 0.0 if mass is None else float(mass)


def _read_limits(joint: Any) -> Range | None:
    """Read the limits of a joint. A missing one, None for yourdfpy, counts as URDF's default if the other is there."""
    limit = joint.limit
    if limit is None or (limit.lower is None and limit.upper is None):
        return None
    return (0.0 if limit.lower is None else float(limit.lower)), (0.0 if limit.upper is None else float(limit.upper))


def _iter_drawn_boxes(model: Any) -> Iterator[tuple[str, Vector]]:
    """Yield the links that draw something, with the corners of the box around it in the link frame."""
    import numpy as np

    scene = model.scene
    corners: dict[str, list[Any]] = {}
    parents = scene.graph.transforms.parents
    for node in scene.graph.nodes_geometry:
        link = parents.get(node)
        placement, geometry = scene.graph.get(node, frame_from=link)
        vertices = getattr(scene.geometry[geometry], "vertices", ())
        if len(vertices):
            corners.setdefault(link, []).append(np.asarray(vertices) @ placement[:3, :3].T + placement[:3, 3])
    for link, points in corners.items():
        stacked = np.concatenate(points)
        yield link, (*stacked.min(axis=0).tolist(), *stacked.max(axis=0).tolist())


def _iter_frames(model: Any, robot: EngineInput) -> Iterator[LinkValues]:
    """Yield the frames of the links at each configuration; joints that mimic others get no value."""
    free = {joint.name for joint in model.robot.joints if joint.mimic is None}
    for values in robot.samples:
        given = {name: value for name, value in zip(robot.joints, values, strict=True) if name in free}
        model.update_cfg(given)
        yield {
            link.name: tuple(model.get_transform(link.name, model.base_link)[:3].ravel().tolist())
            for link in model.robot.links
        }
