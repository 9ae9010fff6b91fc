"""Tensors to which the reflected inertia of a motor's rotor was added, in all links of a file about their own joint's axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments
from urdfcheck.facts.small_matrices import compute_excess
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import DeclaredTensor
from urdfcheck.model.rigid_bodies import is_point_mass
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Vec3

# By chance, the axis of the largest moment is that of the joint in one of three links: four that differ, of which most must have
# it, and joints about two different axes of their links show that it is none.
_FEWEST_LINKS, _FEWEST_AXES, _SHARE = 4, 2, 0.8
# Cosine: two axes are one below 8°; an axis of a link is x, y or z to within as much.
_PARALLEL = 0.99
# A tensor that breaks the triangle inequality by less, relative to its largest moment, was rounded or is flat.
_LEAST_EXCESS = 0.05
# Copies and mirror images are one piece of evidence: their principal moments agree in so many digits.
_DIGITS = 3
# One number was added to the largest moments of different tensors, where these exceed the middle ones by it to so many digits.
_ADDED_DIGITS = 6


@fact
def find_rotor_inertias(model: Model) -> frozenset[str]:
    """Find the links (by name) whose largest moment is more than the sum of the others, and about the axis of the joint that
    rotates the link; none unless this is so in most of the links that break the triangle inequality.

    A rotor behind a gear acts on its joint like a moment of ratio² times its own, about the joint's axis only. Added to the
    link, it makes a tensor that no body has, and one that is wrong for every other rotation. One number by which the largest
    moments of different tensors exceed the others shows it too, where all joints have one axis and copies leave few tensors.
    """
    broken = [
        declared
        for declared in model.tensors
        if not is_point_mass(declared.inertial) and -compute_excess(declared.moments) > _LEAST_EXCESS
    ]
    if len(broken) < _FEWEST_LINKS:
        return frozenset()
    found: set[str] = set()
    axes: set[tuple[float, ...]] = set()
    different: dict[tuple[str, ...], bool] = {}
    added: dict[str, set[tuple[str, ...]]] = {}
    for declared in broken:
        moments, _ = compute_principal_moments(declared.tensor)
        key = tuple(f"{value:.{_DIGITS}g}" for value in moments)
        axis = _find_common_axis(model, declared)
        different[key] = different.get(key, False) or axis is not None
        if axis is not None:
            found.add(declared.link.name)
            axes.add(tuple(np.abs(np.round(axis, 1)).tolist()))
            added.setdefault(f"{moments[2] - moments[1]:.{_ADDED_DIGITS}g}", set()).add(key)
    if len(found) >= max(_FEWEST_LINKS, _SHARE * len(broken)) and any(len(tensors) > 1 for tensors in added.values()):
        return frozenset(found)
    members = sum(different.values())
    if members < max(_FEWEST_LINKS, _SHARE * len(different)) or len(axes) < _FEWEST_AXES:
        return frozenset()
    return frozenset(found)


def _find_common_axis(model: Model, declared: DeclaredTensor) -> Vec3 | None:
    """Find the axis of a joint, a unit vector (3,) in the link's frame, that is also that of the link's largest moment; None
    where the link's joint has another axis, or none."""
    try:
        joint = model.tree.parent_joint.get(declared.link.name)
    except FactUnavailableError:
        return None
    matrix = declared.inertial.origin.matrix
    if joint is None or joint.type not in {"revolute", "continuous"} or joint.axis is None or matrix is None:
        return None
    axis = np.array(joint.axis, dtype=float)
    length = float(np.linalg.norm(axis))
    _, frame = np.linalg.eigh(declared.tensor)
    if not length > 0.0 or abs(float(matrix[:3, :3] @ frame[:, 2] @ axis)) < _PARALLEL * length:
        return None
    return axis / length
