"""How much a wrong inertial matters, and whether another rule reports it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.certainty import VAST
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import (
    check_inertia_validity,
    compute_parallel_axis_term,
    compute_solid_inertia,
    list_half_units,
    make_box_solid,
)
from urdfcheck.facts.inertials.materials import DENSEST
from urdfcheck.facts.inertials.placeholders import describe_placeholder, is_unknown_mass
from urdfcheck.model import DeclaredTensor, Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.rigid_bodies import (
    compute_body_inertia,
    compute_body_mass,
    compute_body_tensor,
    has_one_round_mass,
)
from urdfcheck.model.shapes.bounds import compute_bounding_box
from urdfcheck.model.shapes.visual_solid import (
    measure_link_geometry,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from urdfcheck.facts.arrays import Array, Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
    from urdfcheck.facts.inertials.diagnosis import Diagnosis


# A part of a rigid body that is lighter than this share of it hardly changes how the body moves.
LIGHT = 0.05
# Unless its COM is so far away that it makes more than this share of the largest moment of its body: of 98 such links of
# published robots one reaches 0.065, the others less than 0.05.
_FAR_MOMENT = 0.1
# A tensor that is more than half of its body's counts, however light the part is.
_MOST = 0.5
# Moments so many times too small are those of a part of a seventh of the size.
TINY = 50.0
# Moments that are all so many times too small, to within the other factor, are those of a lighter part of the same shape. Of
# 1,475 links of published robots with closed meshes one has such: its mass is 0.07 mg.
SCALED, _ONE_SCALE = 5.0, 1.25
# Moments that differ by a third in sum are of one size; those of a simpler body are near up to a half.
SIMILAR, NEAR = 1.33, 1.5
# Bodies whose formula is typed for a part that has none.
APPROXIMATIONS = frozenset({"bounding_box", "convex_hull", "one_piece", "shell"})
# A correction that changes the tensor by less than the first part of it, and the COM by less than the second of the drawn part,
# or by less than these metres, is worth an info: a motor or a cover changes as much. It is worth none where no moment, not that
# about the axis of a rod either, changes by more than the first part.
SLIGHT_TENSOR, SLIGHT, SLIGHT_LENGTH = 0.1, 0.05, 5e-3
# A rigid body with moments that change by less than this share, and with a COM that moves by less than this share of its radius
# of gyration, or by less than these metres, moves as before (chosen: its cables weigh as much).
_LITTLE, _LITTLE_MOVE, _LITTLE_LENGTH = 0.02, 0.01, 1e-3
_DECIMALS = frozenset({"decimal_point", "decimal_point_of_all", "rounded"})
# A link of a gram (kg) or less, that is less than this share of its robot.
_MARK, _MARK_SHARE = 1e-3, 1e-3
# Robots lighter than this (kg) are only in a few laboratories: INR015 reports them.
_LEAST_ROBOT = 1e-3
# A box is that of a tensor to within this share, and its centre the COM to within this share of its diagonal.
_SAME_BOX = 0.02


def measure_mismatch(diagnosis: Diagnosis, *, is_mended: bool) -> float:
    """Return how far the numbers are from the drawn part, with the mistake or with it undone."""
    if is_mended:
        return max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch)
    return max(diagnosis.tensor_mismatch, diagnosis.com_mismatch)


def is_placeholder(tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether the tensor was typed rather than computed: INR007 reports it where it matters."""
    return describe_placeholder(judged.declared.mass, tensor.components) is not None


def is_chance_decimal(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether a tensor with another decimal point, or fewer decimals, is a typed number times the identity, and so is another
    link's (INR007): of numbers that were made up, one is a power of ten off, or the rounded one, by chance."""
    if judged.diagnosis.cause not in _DECIMALS or not is_placeholder(tensor, judged):
        return False
    others = [one for one in model.tensors if one.link is not tensor.link]
    return any(describe_placeholder(one.inertial.mass or 0.0, one.components) is not None for one in others)


def measure_difference(numbers: DeclaredInertial, drawn: VisualGeometry) -> float:
    """Measure how far a tensor is from that of the drawn part at the same mass, as a share of the latter (Frobenius norms)."""
    uniform = compute_solid_inertia(drawn.solid, numbers.mass)
    return float(np.linalg.norm(numbers.inertia - uniform) / np.linalg.norm(uniform))


def is_possible(judged: DiagnosedInertial) -> bool:
    """Whether a body can have the tensor; otherwise INR003 or INR004 reports it, with the cause found here. Three points have a
    tensor that rounding makes impossible."""
    if judged.diagnosis.cause == "own_missing":
        return True
    validity = check_inertia_validity(judged.declared.tensor)
    return validity.positive_definite and validity.triangle_inequality


def is_too_dense(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether no material explains the mass: INR010 reports the number that is wrong."""
    drawn = measure_link_geometry(model, link)
    return drawn is not None and drawn.hull is not None and judged.declared.mass > DENSEST * drawn.hull.volume


def is_rounded_uniform(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether the tensor is that of the drawn part, rounded to the typed digits.

    0.01, 0.01 and 0.02 are the moments of a plate without thickness, and to one digit those of a thick one.
    """
    declared, drawn = judged.declared, measure_link_geometry(model, tensor.link)
    if drawn is None:
        return False
    uniform = declared.rotation.T @ compute_solid_inertia(drawn.solid, declared.mass) @ declared.rotation
    rows, columns = np.triu_indices(3)
    halves = np.array(list_half_units(tensor.texts))
    halves[halves == 0.0] = halves.max()  # a zero was rounded like its neighbours
    return bool((np.abs(declared.tensor - uniform)[rows, columns] <= halves).all())


def is_slight(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether undoing the mistake changes next to nothing."""
    declared, mended, drawn = judged.declared, judged.diagnosis.mended, measure_link_geometry(model, link)
    if (
        mended is None
        or drawn is None
        or judged.diagnosis.judged_by != "mesh"
        or judged.diagnosis.cause == "mesh_scale"
    ):
        return False  # the scale of a mesh is not in the inertial
    moved = float(np.linalg.norm(mended.com - declared.com))
    changed = float(np.linalg.norm(mended.inertia - declared.inertia))
    weight = abs(mended.mass - declared.mass)
    return (
        (moved < SLIGHT_LENGTH or moved < SLIGHT * measure_extent(drawn.points))
        and changed < SLIGHT_TENSOR * float(np.linalg.norm(declared.inertia))
        and weight < SLIGHT * declared.mass
    )


def changes_body_little(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether a link is fixed to others, and the body of all of them has nearly the same mass, COM and moments with the right
    numbers of the link: those of the drawn part, or with the mistake undone. The ball of a foot is on a long leg, for example.

    The other wrong links of the body count with their right numbers, for next to a tensor that is vast all others are little. Of
    several wrong links each has its part of what is little: four brackets together are not.
    """
    wanted = _find_right_numbers(model, link, judged)
    try:
        links = model.pieces.list_body_links(link.name)
        whole = compute_body_inertia(model, links)
        frames = model.piece_frames
    except FactUnavailableError:
        return False
    if wanted is None or whole is None or len(links) == 1:
        return False
    diagnoses = inertial_diagnoses(model)
    wrong = {name: diagnoses[name] for name in links if name in diagnoses and not diagnoses[name].diagnosis.sound}
    others = [(name, one) for name, one in wrong.items() if name != link.name]
    swaps = [
        (frames[name], one.declared, right)
        for name, one in others
        if (right := _find_right_numbers(model, model.link_by_name[name], one)) is not None
    ]
    before = _swap_numbers(whole, swaps)
    after = None if before is None else _swap_numbers(before, [(frames[link.name], judged.declared, wanted)])
    if before is None or after is None:
        return False
    mass, com, tensor = after
    share = 1.0 / max(1, len(wrong))
    gyration = float(np.sqrt(max(0.0, float(np.trace(tensor))) / (2.0 * mass)))
    return (
        abs(before[0] - mass) < share * _LITTLE * mass
        and float(np.linalg.norm(before[1] - com)) < share * max(_LITTLE_LENGTH, _LITTLE_MOVE * gyration)
        and measure_largest_change(tensor, before[2] - tensor) < share * _LITTLE
    )


def _swap_numbers(
    body: tuple[float, Array, Array], swaps: Sequence[tuple[Array, DeclaredInertial, DeclaredInertial]]
) -> tuple[float, Array, Array] | None:
    """Return mass, COM and tensor of a ``body`` with other numbers of some links; None without mass. ``swaps``: the frame of each
    link, and its numbers before and after."""
    parts = [body]
    for frame, before, after in swaps:
        turn = frame[:3, :3]
        for sign, one in ((-1.0, before), (1.0, after)):  # take the link out of its body, and put it in again
            parts.append((sign * one.mass, turn @ one.com + frame[:3, 3], sign * (turn @ one.inertia @ turn.T)))
    total = sum(mass for mass, _, _ in parts)
    if not total > 0.0:
        return None
    com = sum((mass * place for mass, place, _ in parts), np.zeros(3)) / total
    tensor = sum((one + compute_parallel_axis_term(mass, place - com) for mass, place, one in parts), np.zeros((3, 3)))
    return total, com, tensor


def _find_right_numbers(model: Model, link: Link, judged: DiagnosedInertial) -> DeclaredInertial | None:
    """Return the numbers that a link should have; where its mass is right, if another mass is one that fits."""
    mended, drawn = judged.diagnosis.mended, measure_link_geometry(model, link)
    if mended is not None and judged.diagnosis.cause != "other_mass":
        return mended
    if drawn is None:
        return None
    tensor = compute_solid_inertia(drawn.solid, judged.declared.mass)
    turn = judged.declared.rotation
    return replace(judged.declared, com=drawn.solid.com, tensor=turn.T @ tensor @ turn)


def is_next_to_nothing(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether undoing the mistake changes next to nothing about any axis: the small moment of a rod is a small part of its
    tensor, and counts too."""
    declared, mended = judged.declared, judged.diagnosis.mended
    if mended is None or not is_slight(model, link, judged):
        return False
    return measure_largest_change(mended.inertia, declared.inertia - mended.inertia) < SLIGHT_TENSOR


def measure_largest_change(tensor: Mat3, change: Mat3) -> float:
    """Return the largest share by which a ``change`` of a ``tensor`` (3, 3) changes its moments; infinite if it is impossible."""
    moments, axes = np.linalg.eigh(tensor)
    if not moments[0] > 0.0:
        return float("inf")
    white = axes / np.sqrt(moments) @ axes.T
    return float(np.abs(np.linalg.eigvalsh(white @ change @ white)).max())


def is_vast(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the tensor is so large that no mass inside the drawn part comes near it, and that it rules the whole body."""
    drawn, declared = measure_link_geometry(model, link), judged.declared
    if judged.diagnosis.fits_geometry or drawn is None or is_light(model, link):
        return False
    return float(np.trace(declared.tensor)) >= VAST * float(np.trace(compute_solid_inertia(drawn.solid, declared.mass)))


def is_approximation(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the tensor is that of a simpler body in place of the drawn part (`APPROXIMATIONS`), and no moment is far off.

    Such a formula is meant to be near.
    """
    drawn = measure_link_geometry(model, link)
    if drawn is None or judged.diagnosis.cause not in APPROXIMATIONS or not judged.diagnosis.fits_geometry:
        return False
    uniform = np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, judged.declared.mass))
    moments = np.linalg.eigvalsh(judged.declared.tensor)
    return bool((moments < NEAR * uniform).all() and (uniform < NEAR * moments).all())


def is_box_of_one_shape(model: Model, link: Link, declared: DeclaredInertial) -> bool:
    """Whether COM and tensor are those of the box around one of several shapes of a link: its author left out the others."""
    for shape in link.visuals if len(link.visuals) > 1 else ():
        box = compute_bounding_box(model, [(shape, np.eye(4))])
        if box is None:
            continue
        edges = box[1] - box[0]
        tensor = compute_solid_inertia(make_box_solid(edges), declared.mass)
        is_centred = np.linalg.norm(box.mean(axis=0) - declared.com) <= _SAME_BOX * np.linalg.norm(edges)
        if is_centred and np.linalg.norm(declared.inertia - tensor) <= _SAME_BOX * np.linalg.norm(tensor):
            return True
    return False


def has_unknown_mass(model: Model, link: Link, mass: float, tensor: Mat3) -> bool:
    """Whether the mass (kg) of a link is a placeholder, which is the mistake (INR012, INR015), and not its ``tensor`` (3, 3)."""
    drawn = measure_link_geometry(model, link)
    # INR015 reports one round mass in a robot that is lighter; of kilograms, a tensor says which of the two is wrong.
    is_of_all = has_one_round_mass(model) and sum(declared.mass for declared in model.masses) < _LEAST_ROBOT
    return drawn is not None and is_unknown_mass(mass, tensor, drawn.solid, is_of_all=is_of_all)


def is_hull_enough(model: Model, link: Link, judged: DiagnosedInertial, *, far: float) -> bool:
    """Whether what is drawn shows that numbers without a cause are wrong. The hull of an open mesh is only the most that the part
    can fill: smaller moments are possible, except for those of a part of a seventh of its size, and any COM inside."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return False
    return drawn.closed or judged.diagnosis.com_mismatch > far or is_tiny(model, link, judged)


def is_tiny(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the moments are so small that the mass would be in a seventh of the drawn part's size."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return False
    uniform = compute_solid_inertia(drawn.solid, judged.declared.mass)
    return float(np.trace(uniform)) >= TINY * float(np.trace(judged.declared.tensor))


def is_scaled_down(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether all moments of a tensor are the same small part of those of the drawn part, about its axes.

    Lumps make the moments about some axes smaller, and those about others less so. Mass and tensor are of two parts, or a decimal
    point slipped.
    """
    drawn = measure_link_geometry(model, link)
    if drawn is None or not drawn.closed:
        return False
    moments, axes = np.linalg.eigh(compute_solid_inertia(drawn.solid, judged.declared.mass))
    if not moments[0] > 0.0:
        return False
    white = axes / np.sqrt(moments) @ axes.T
    shares = np.linalg.eigvalsh(white @ judged.declared.inertia @ white)
    return bool(0.0 < shares[-1] < min(1.0 / SCALED, _ONE_SCALE * shares[0]))


def is_mark(model: Model, mass: float) -> bool:
    """Whether a link of this ``mass`` (kg) is a mark on its robot: where its COM is makes no difference."""
    return mass <= _MARK and mass < _MARK_SHARE * sum(declared.mass for declared in model.masses)


def is_light(model: Model, link: Link, mended: DeclaredInertial | None = None) -> bool:
    """Whether the link is a small part of a rigid body, whose motion its numbers hardly change: also with the ``mended`` ones,
    for a mass that lost a decimal makes any part light."""
    try:
        body = model.pieces.list_body_links(link.name)
    except FactUnavailableError:
        return False
    whole = compute_body_mass(model, body)
    mass = None if link.inertial is None else link.inertial.mass
    if len(body) == 1 or whole is None or mass is None:
        return False
    lost = 0.0 if mended is None else max(0.0, mended.mass - mass)
    return mass + lost < LIGHT * (whole + lost) and not (is_at_long_lever(model, link) or rules_body(model, link))


def rules_body(model: Model, link: Link) -> bool:
    """Whether most of the moments of a link's rigid body are those of the link's own tensor, about its COM."""
    declared = model.tensor_by_name.get(link.name)
    tensor = compute_body_tensor(model, model.pieces.list_body_links(link.name))
    if declared is None or tensor is None:
        return False
    return float(np.trace(declared.tensor)) > _MOST * float(np.trace(tensor))


def is_at_long_lever(model: Model, link: Link) -> bool:
    """Whether the COM of a link is so far from its frame that the mass alone matters for the moments of its body."""
    com, mass = (None, None) if link.inertial is None else (link.inertial.origin.xyz, link.inertial.mass)
    tensor = compute_body_tensor(model, model.pieces.list_body_links(link.name))
    if com is None or mass is None or tensor is None:
        return False
    return mass * float(np.dot(com, com)) > _FAR_MOMENT * float(np.linalg.eigvalsh(tensor)[-1])
