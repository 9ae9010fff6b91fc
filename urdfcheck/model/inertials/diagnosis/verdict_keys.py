"""Digests of what a verdict on an inertial depends on."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.model.inertials.diagnosis.geometry_readings import list_massless_covers
from urdfcheck.model.inertials.diagnosis.inertial_references import InertialReference
from urdfcheck.model.parts import Joint, Link, Pose
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import get_mesh_scale


def compute_model_key(model: Model, numbers: Mapping[str, DeclaredInertial]) -> str:
    """Return a digest of what the verdicts on all links depend on; ``numbers``: the inertials by link."""
    others = [f"{name} {_format_numbers(declared)}" for name, declared in numbers.items()]
    return _hash_drawing(model, model.links, [*others, *map(_format_joint, model.joints)])


def compute_verdict_key(
    model: Model, link: Link, *, declared: DeclaredInertial, reference: InertialReference | None
) -> str:
    """Return a digest of what the verdict on a link depends on."""
    covers = list_massless_covers(model, link)
    places = [
        repr((np.linalg.inv(model.piece_frames[link.name]) @ model.piece_frames[one.name]).tolist()) for one in covers
    ]
    expected = () if reference is None else (_format_numbers(reference.numbers), str(reference.trusted))
    return _hash_drawing(model, [link, *covers], [*places, _format_numbers(declared), *expected])


def _hash_drawing(model: Model, links: Iterable[Link], others: Iterable[str]) -> str:
    """Return a digest of what some links draw, and of ``others``."""
    parts = list(others)
    for link in links:
        parts.append("link")
        for shape in (*link.visuals, *link.collisions):
            use = model.meshes.by_shape.get(id(shape))
            key = (
                None
                if use is None or use.resource.path is None
                else model.meshes.compute_content_key(use.resource.path)
            )
            read = shape.kind == "mesh" and get_mesh_scale(model, shape, True) is not None
            parts.append(f"{shape.role} {shape.kind} {shape.size} {_format_pose(shape.origin)} {key} {read}")
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def _format_joint(joint: Joint) -> str:
    return f"{joint.name} {joint.type} {joint.parent} {joint.child} {_format_pose(joint.origin)}"


def _format_pose(origin: Pose) -> str:
    quaternion = origin.get_attribute("quat_xyzw")
    return f"{origin.xyz} {origin.rpy} {quaternion and quaternion.value}"


def _format_numbers(numbers: DeclaredInertial) -> str:
    return " ".join(map(repr, (numbers.mass, *numbers.com, *numbers.tensor.ravel(), *numbers.rotation.ravel())))
