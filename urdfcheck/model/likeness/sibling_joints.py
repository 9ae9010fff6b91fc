"""Groups of matching joints: the wheels of a car, the hips of a quadruped."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import permutations, product
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance, compute_principal_moments
from urdfcheck.facts.likeness.mirror import measure_outline_mismatch
from urdfcheck.facts.likeness.symmetry import LinkSignature, build_link_signature, group_by_signature
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import PLACE, mirror_pairs
from urdfcheck.model.likeness.shape_comparison import ALIKE, get_outline
from urdfcheck.model.parts import Joint, Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# The mass of a body of revolution lies about its axis to within this share of its second moments.
_ROUND = 1e-3
# Two COMs are in one place within this share of their distance from the joint's axis: 0.6° (chosen).
_SAME_COM = 0.01
# Axes have the same numbers to within those of three digits.
_SAME_AXIS = 2e-3


@fact
def sibling_joints(model: Model) -> tuple[tuple[Joint, ...], ...]:
    """Group moving joints that have the same type, the same number of moving joints before them, and like children.

    Children are alike in mass, principal moments and the shape of what they draw, whatever their names and however their
    frames are turned. A child with neither an inertial nor a mesh is in no group.

    :raises FactUnavailableError: when the tree is broken.
    """
    tree = model.tree
    kinds: dict[tuple[str, int], list[tuple[Joint, LinkSignature]]] = {}
    for name in tree.order[1:]:
        joint = tree.parent_joint[name]
        signature = compute_link_signature(model, model.link_by_name[name]) if joint.has_axis else None
        if signature is not None:
            depth = sum(j.is_movable for j in tree.find_path_to(name))
            kinds.setdefault((joint.type, depth), []).append((joint, signature))
    groups = []
    for members in kinds.values():
        for indices in group_by_signature([s for _, s in members]):
            groups.append(tuple(members[i][0] for i in indices))
    return tuple(group for group in groups if len(group) > 1)


def find_common_base(model: Model, group: Sequence[Joint]) -> str:
    """Return the last link on which all joints of a group hang.

    Their author thought of their places and frames in its axes.

    :raises FactUnavailableError: when the tree is broken.
    """
    paths = [[joint.parent for joint in model.tree.find_path_to(one.child)] for one in group]
    shared: list[str] = [names[0] for names in zip(*paths, strict=False) if len(set(names)) == 1]
    return shared[-1]


def trace_fixed_chain(model: Model, joint: Joint, base: str) -> tuple[Joint, ...]:
    """Return the fixed joints that lead to a joint, and the joint last.

    They begin at the link ``base``, or at the moving joint before this one.

    :raises FactUnavailableError: when the tree is broken.
    """
    chain = [joint]
    before = model.tree.parent_joint.get(joint.parent)
    while before is not None and before.type == "fixed" and before.child != base:
        chain.append(before)
        before = model.tree.parent_joint.get(before.parent)
    return tuple(reversed(chain))


def compute_link_signature(model: Model, link: Link) -> LinkSignature | None:
    """Compute what a link has in common with its like; None where it has neither an inertial nor a mesh, or it is malformed."""
    inertial, surface = link.inertial, _compute_surface_moments(model, link)
    if inertial is None:
        return build_link_signature(0.0, (), surface) if surface else None
    if inertial.mass is None or inertial.tensor is None:
        return None
    moments, _ = compute_principal_moments(inertial.tensor)
    return build_link_signature(inertial.mass, moments.tolist(), surface)


def _compute_surface_moments(model: Model, link: Link) -> Sequence[float]:
    """Compute the principal second moments (m²) of the surface of the first mesh that the link draws; empty without a mesh.

    A surface has them whether or not it is closed.
    """
    import numpy as np

    for shape in (*link.visuals, *link.collisions):
        facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
        if facts is not None and scale is not None:
            factors = np.array(scale)
            moments, _ = compute_principal_moments(facts.surface_covariance * np.outer(factors, factors))
            return [float(m) for m in moments]
    return ()


def is_drawn_in_place(model: Model, joint: Joint, like: Joint, expected: Array) -> bool:
    """Whether the part behind a joint is drawn where it would be if the joint's frame had the rotation ``expected`` (3, 3), in
    root coordinates: only the frame is rotated, and what is in it takes that back.

    ``like`` is a joint of the pattern that ``expected`` follows. Where on its axis a joint's frame lies is a choice. The COMs
    decide where the drawings are not known. False where the part looks the same either way, and where neither is known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    back = model.frames[joint.child][:3, :3].T @ expected
    found = _measure_drawn_alike(model, joint, like, (back, np.eye(3)))
    return found is not None and found[0] < 1.0 and found[0] < found[1] / 2.0


def is_turned_with_frame(model: Model, joint: Joint, like: Joint) -> bool:
    """Whether the part behind a joint lies in the joint's frame as that of a joint like it does: then it is rotated as the frame
    is. True where neither the drawings nor the COMs are known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    found = _measure_drawn_alike(model, joint, like, (np.eye(3),))
    return found is None or found[0] < 1.0


def _measure_drawn_alike(model: Model, joint: Joint, like: Joint, turns: Sequence[Array]) -> list[float] | None:
    """Measure how far the part behind a joint is from where each of some rotations (3, 3) of the frame takes that of a joint like
    it, below 1 for as good as there; by the COMs where the drawings are not known. None where neither is."""
    one, other = get_outline(model, like.child), get_outline(model, joint.child)
    if joint.axis is None:
        return None
    axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
    if one is None or other is None:
        return _measure_coms_alike(model, joint, like, axis=axis, turns=turns)

    def measure_best(turn: Array) -> float:
        best = math.inf
        for renaming in _list_axis_renamings():
            linear = turn @ renaming
            shift = axis * float((other.centroid - linear @ one.centroid) @ axis)
            best = min(best, measure_outline_mismatch(one, other, linear=linear, shift=shift, limit=best))
        return best / ALIKE

    return [measure_best(turn) for turn in turns]


def _measure_coms_alike(
    model: Model, joint: Joint, like: Joint, *, axis: Array, turns: Sequence[Array]
) -> list[float] | None:
    """Measure the same by the COMs, which are off the ``axis`` (3,) of the joint."""
    one, other = (read_declared_inertial(model.link_by_name[name]) for name in (like.child, joint.child))
    lever = 0.0 if other is None else float(np.linalg.norm(np.cross(axis, other.com)))
    if one is None or other is None or not lever > 0.0:
        return None

    def measure_best(turn: Array) -> float:
        offsets = (other.com - turn @ renaming @ one.com for renaming in _list_axis_renamings())
        return min(float(np.linalg.norm(np.cross(axis, offset))) for offset in offsets) / (_SAME_COM * lever)

    return [measure_best(turn) for turn in turns]


def is_drawn_square(model: Model, joint: Joint, expected: Array) -> bool:
    """Whether the part behind a joint is drawn symmetric to a plane of the root's axes, and would not be if the joint's frame had
    the rotation ``expected`` (3, 3), in root coordinates: the frame takes back how the part is turned in its file.

    False where the part looks the same either way, and where it is not known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    outline = get_outline(model, joint.child)
    if outline is None:
        return False
    typed = model.frames[joint.child][:3, :3]

    def measure_asymmetry(turn: Array, axis: int) -> float:
        signs = np.ones(3)
        signs[axis] = -1.0
        linear = turn.T @ np.diag(signs) @ turn
        shift = outline.centroid - linear @ outline.centroid
        return measure_outline_mismatch(outline, outline, linear=linear, shift=shift)

    pairs = ((measure_asymmetry(typed, axis), measure_asymmetry(expected, axis)) for axis in range(3))
    return any(now < ALIKE and now < then / 2.0 and then > ALIKE for now, then in pairs)


def is_round_about_joint(model: Model, joint: Joint) -> bool:
    """Whether the child of a joint looks the same at every angle: what it draws and its inertial, as far as they are known, are
    of revolution about the joint's axis. The file then has no zero of it."""
    link = model.link_by_name[joint.child]
    drawn = measure_link_geometry(model, link)
    bodies = [] if drawn is None else [(drawn.solid.com, drawn.solid.covariance)]
    declared = read_declared_inertial(link)
    if declared is not None and declared.mass > 0.0:
        bodies.append((declared.com, compute_mass_covariance(declared.inertia, declared.mass)))
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    return bool(bodies) and all(_is_round(com, covariance, axis / np.linalg.norm(axis)) for com, covariance in bodies)


def _is_round(com: Array, covariance: Array, axis: Array) -> bool:
    """Whether a mass with this ``com`` (3,) in m and ``covariance`` (3, 3) in m² is of revolution about a unit ``axis`` (3,)
    through the origin."""
    size = float(np.trace(covariance))
    if not size > 0.0 or float(np.linalg.norm(np.cross(com, axis))) > _ROUND * size**0.5:
        return False
    along = float(axis @ covariance @ axis)
    round_one = along * np.outer(axis, axis) + 0.5 * (size - along) * (np.eye(3) - np.outer(axis, axis))
    return float(np.abs(covariance - round_one).max()) <= _ROUND * size


def is_frame_evidence(model: Model, joint: Joint, others: Sequence[Joint], expected: Array, *, kind: str) -> bool:
    """Whether a frame that differs from the expected one (3, 3) puts anything elsewhere: the axis, and what the joint carries.

    A tilted frame with an axis of other numbers than the siblings' may have the same axis: exporters write both from one
    drawing. What the joints behind it put back in place would leave it with the expected frame.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    if kind == "axis_tilt" and not any(_has_like_axis(joint, other) for other in others):
        return False
    back = expected @ model.frames[joint.child][:3, :3].T
    start, carried = model.frames[joint.child][:3, 3], {joint.child}
    for link in model.tree.order:
        before = model.tree.parent_joint.get(link)
        if before is not None and before.parent in carried:
            carried.add(link)
    for pair in mirror_pairs(model):
        inside = [name for name in (pair.one, pair.other) if name in carried and name != joint.child]
        if len(inside) == 1 and pair.is_in_place:
            arm = model.frames[inside[0]][:3, 3] - start
            if float(np.linalg.norm(back @ arm - arm)) > PLACE:
                return False
    return True


def _has_like_axis(one: Joint, other: Joint) -> bool:
    """Whether the axes of two joints have the same numbers, whatever their order and signs."""
    first, second = (
        np.sort(np.abs(np.array(joint.axis or (1.0, 0.0, 0.0)) / np.linalg.norm(joint.axis or (1.0, 0.0, 0.0))))
        for joint in (one, other)
    )
    return bool(np.abs(first - second).max() < _SAME_AXIS)


def _list_axis_renamings() -> list[Array]:
    """Return the 48 signed permutations (3, 3)."""
    return [
        np.diag(signs) @ np.eye(3)[list(order)]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ]
