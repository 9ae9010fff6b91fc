"""Mistakes that mix the numbers, or lose some: undoing them depends on the part. And the list of all explanations."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    compute_covariance_inertia,
    compute_mass_covariance,
    compute_parallel_axis_term,
    compute_solid_inertia,
)
from urdfcheck.facts.inertials.inertial_fit import LOG_SQRT_2PI, InertialBatch, Reference, compute_whitening
from urdfcheck.facts.inertials.materials import CAD_DEFAULT
from urdfcheck.facts.inertials.mistakes.mistake import (
    COMPONENT_INDICES,
    EFFECT,
    LOG_PRIORS,
    Mistake,
    Suspect,
    make_mistake,
)
from urdfcheck.facts.inertials.mistakes.multiplying_mistakes import stack_multipliers
from urdfcheck.facts.inertials.mistakes.wrong_formulas import (
    ROUNDING_SLACK,
    is_rounding_of,
    is_tensor_of,
    list_wrong_formulas,
    measure_decimal,
)

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3, Vec3

# A mass that was changed afterwards differs by this much (standard deviation of its logarithm).
_REVISION = 1.2
# What tessellation and three digits leave of the default density.
_DEFAULT_WITHIN = 0.01
# In a part of more pieces, nobody mistakes one for the whole.
_MOST_PIECES = 6
# The component at each of the nine places of the matrix, row by row.
_TO_MATRIX = (0, 1, 2, 1, 3, 4, 2, 4, 5)
# The products of a tensor with the other sign.
_OTHER_SIGNS = 2.0 * np.eye(3) - 1.0
# A number of fewer digits may be twice there by chance.
_TELLING_DIGITS = 4
# Products below this part of the largest moment do not show on which side of a mirror a part is.
_NO_PRODUCT = 0.02
# Each of three products is near the reference's by chance, sign and size, in one tensor of thousands. Below this part of the
# largest moment it is what tessellation makes of none.
_NEAR_PRODUCT, _LEAST_PRODUCT = 0.1, 1e-4
_PRODUCTS = np.triu_indices(3, 1)
# Detail of a mistake that left the COM as it should be.
TENSOR_ALONE = "the tensor alone"
# Detail of a COM that is missing beside a tensor that is not about it.
ABOUT_ORIGIN = "tensor about the link's origin"
# Half a unit of the last decimal, and what tessellation adds. Rounding that changes no moment by this part is not worth saying.
_HALF, _LOST = 0.5 * ROUNDING_SLACK, 1.0 / 3.0
# Programs print six decimals or more.
_PRINTED = 1e-5
# The tensor of pieces without extent is known to this share of itself: what tessellation and different densities leave.
_SAME_TERM = 0.05

Corrected = Iterator[tuple[Mistake, DeclaredInertial]]


def _undo_about_origin(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    yield make_mistake("about_origin"), replace(declared, tensor=declared.tensor - suspect.parallel_axis_shift)


def _undo_positive_notation(suspect: Suspect) -> Corrected:
    """About the link's origin, with products of the other sign: CAD programs print ∫xy dm "at the output coordinate system"."""
    declared = suspect.declared
    tensor = declared.tensor * _OTHER_SIGNS - suspect.parallel_axis_shift
    yield make_mistake("positive_notation"), replace(declared, tensor=tensor)


def _undo_steiner_twice(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    yield make_mistake("steiner_twice"), replace(declared, tensor=declared.tensor + suspect.parallel_axis_shift)


def _undo_quarter_turn(suspect: Suspect) -> Corrected:
    declared = suspect.declared
    for name, turn in _list_quarter_turns():
        turned = replace(declared, com=turn @ declared.com)
        if suspect.has_turned_frame:
            turned = replace(turned, rotation=turn @ declared.rotation)
        else:
            turned = replace(turned, tensor=turn @ declared.tensor @ turn.T)
        yield make_mistake("quarter_turn", name), turned


@cache
def _list_quarter_turns() -> tuple[tuple[str, Mat3], ...]:
    turns = []
    for i, axis in enumerate("xyz"):
        j, k = (i + 1) % 3, (i + 2) % 3
        for sign in (1.0, -1.0):
            turn = np.zeros((3, 3))
            turn[i, i] = 1.0
            turn[k, j], turn[j, k] = sign, -sign
            turns.append((f"{'+' if sign > 0 else '-'}90° about {axis}", turn))
    return tuple(turns)


def _undo_unmirrored(suspect: Suspect) -> Corrected:
    """Without a twin, only where the tensor shows it: the sign of one coordinate of the COM is a smaller mistake. The COM is kept
    where it is nearer to the reference's than its mirror image: then only the tensor was copied from the other side."""
    declared = suspect.declared
    expected = suspect.reference.com if suspect.reference.twin is None else suspect.reference.twin.com
    prior = "unmirrored" if suspect.reference.twin is None else "unmirrored (has a twin)"
    largest = float(np.abs(declared.tensor).max())
    for i, axis in enumerate("xyz"):
        mirror = np.eye(3)
        mirror[i, i] = -1.0
        changed = np.abs(declared.inertia - mirror @ declared.inertia @ mirror).max()
        if suspect.reference.twin is None and changed <= _NO_PRODUCT * largest:
            continue
        image = mirror @ declared.com
        if np.linalg.norm(declared.com - expected) < np.linalg.norm(image - expected):
            turned = mirror @ declared.rotation
            tensor = declared.rotation.T @ turned @ declared.tensor @ turned.T @ declared.rotation
            alone = prior
            if suspect.reference.twin is None:
                alone = f"unmirrored ({TENSOR_ALONE}{', product by product' if _fits_each_product(suspect, tensor) else ''})"
            yield make_mistake(alone, f"{axis}, {TENSOR_ALONE}"), replace(declared, tensor=tensor)
            continue
        mirrored = DeclaredInertial(
            mass=declared.mass,
            com=image,
            tensor=mirror @ declared.tensor @ mirror,
            rotation=mirror @ declared.rotation @ mirror,
        )
        yield make_mistake(prior, axis), mirrored


def _fits_each_product(suspect: Suspect, tensor: Mat3) -> bool:
    """Whether each product of ``tensor`` (3, 3) has the sign and nearly the size of the reference's: then one that was right is
    among them, and the export did not flip all."""
    drawn, expected = tensor[_PRODUCTS], _compute_reference_tensor(suspect)[_PRODUCTS]
    is_shown = np.abs(expected) > _LEAST_PRODUCT * np.abs(tensor).max()
    return bool((is_shown & (np.abs(drawn - expected) < _NEAR_PRODUCT * np.abs(expected))).all())


def _undo_rpy_twice(suspect: Suspect) -> Corrected:
    if suspect.has_turned_frame:
        yield make_mistake("rpy_twice"), replace(suspect.declared, rotation=np.eye(3))


def _undo_com_missing(suspect: Suspect) -> Corrected:
    """The COM is taken from the reference. The tensor may be about the COM, or about the link's origin: CAD programs print the
    latter with either sign of the products, of which the one nearer to the reference's is taken."""
    declared, reference = suspect.declared, suspect.reference
    if np.abs(declared.com).any():
        return
    twin = suspect.reference.twin
    com = suspect.reference.com if twin is None else twin.com
    com = np.where(np.abs(com) > 1e-3 * np.abs(com).max(), com, 0.0)  # what a mesh leaves of a zero
    yield replace(make_mistake("com_missing"), borrowed=(0, 3)), replace(declared, com=com)
    lever = declared.rotation.T @ com
    shift = compute_parallel_axis_term(declared.mass, lever)
    uniform = compute_covariance_inertia(reference.covariance, declared.mass)
    expected = declared.rotation.T @ uniform @ declared.rotation + shift
    if float(np.linalg.norm(shift)) > EFFECT * float(np.linalg.norm(expected)):
        printed = (declared.tensor, declared.tensor * _OTHER_SIGNS)
        tensor = min(printed, key=lambda one: float(np.linalg.norm(one - expected)))
        mistake = make_mistake("com_missing (tensor about the origin)", ABOUT_ORIGIN)
        yield replace(mistake, borrowed=(0, 3)), replace(declared, com=com, tensor=tensor - shift)


def _undo_rpy_missing(suspect: Suspect) -> Corrected:
    """The three angles are taken from the reference."""
    tensor = suspect.declared.tensor
    diagonal = np.diag(np.diag(tensor))
    if not suspect.has_turned_frame and np.abs(tensor - diagonal).max() < 1e-3 * np.abs(tensor).max():
        aligned = _align_principal_axes(np.diag(tensor), suspect.reference.covariance)
        yield replace(make_mistake("rpy_missing"), borrowed=(3, 0)), replace(suspect.declared, tensor=aligned)


def _align_principal_axes(moments: Vec3, covariance: Mat3) -> Mat3:
    """Return the tensor (3, 3) with these principal moments along the principal axes of the reference, in the same order of
    size."""
    _, axes = np.linalg.eigh(covariance)
    ordered = np.sort(moments)[::-1]  # the least variance goes with the greatest moment
    aligned: Mat3 = (axes * ordered) @ axes.T
    return aligned


def _undo_row_major(suspect: Suspect) -> Corrected:
    """The third row is lost: the moment about z is about that of the reference."""
    declared, covariance = suspect.declared, suspect.reference.covariance
    tensor = declared.tensor
    if tensor[0, 1] != tensor[1, 1]:
        return
    prior = "row_major" if tensor[0, 1] else "row_major (of zeros)"
    expected = float(declared.mass * (covariance[0, 0] + covariance[1, 1]))
    (xx, xy, xz), yy, yz = tensor[0], tensor[1, 2], tensor[2, 2]
    for zz in expected * np.array((0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0)):
        rows = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
        yield replace(make_mistake(prior), borrowed=(1, 0)), replace(declared, tensor=rows)


def _undo_repeated_slot(suspect: Suspect) -> Corrected:
    """A product is lost where a moment was typed twice: it is about that of the reference."""
    declared, reference, tensor = suspect.declared, suspect.reference, suspect.declared.tensor
    numbers, moments = tensor.tolist(), np.diag(tensor).tolist()
    for i, j in ((0, 1), (0, 2), (1, 2)):
        for k in range(3):
            if numbers[i][j] != moments[k] or not _has_telling_digits(numbers[i][j]):
                continue
            scale = sum(moments) / (2.0 * float(np.trace(reference.covariance)))
            expected = -scale * (declared.rotation.T @ reference.covariance @ declared.rotation)[i, j]
            without = tensor.copy()
            without[i, j] = without[j, i] = expected
            detail = f"i{'xyz'[i]}{'xyz'[j]} repeats i{'xyz'[k]}{'xyz'[k]}"
            mistake = make_mistake("slots_shifted (a product repeats a moment)", detail)
            yield replace(mistake, borrowed=(1, 0)), replace(declared, tensor=without)


def _has_telling_digits(value: float) -> bool:
    """Whether a number has so many digits that it is not twice there by chance."""
    return abs(value - float(f"{value:.{_TELLING_DIGITS - 1}g}")) > 1e-9 * abs(value)


def _undo_rounded(suspect: Suspect) -> Corrected:
    """So few decimals that the part's numbers, which are taken from the reference, round to those typed."""
    declared = suspect.declared
    least = float(declared.tensor.diagonal().min())
    if float(f"{least:.0e}") != least:  # a moment of which rounding took a third has no more than one digit
        return
    if least > _PRINTED and (declared.tensor == least * np.eye(3)).all():  # a placeholder is near by chance
        return
    typed_axes = _compute_reference_tensor(suspect)
    off = np.abs(typed_axes - declared.tensor)
    if not (np.diag(off) > _LOST * np.diag(typed_axes)).any():
        return
    unit = measure_decimal(declared.tensor)
    if unit is not None and off.max() <= _HALF * unit:
        detail = f"{max(0, -round(math.log10(unit)))} decimals"
        yield replace(make_mistake("rounded", detail), borrowed=(6, 0)), replace(declared, tensor=typed_axes)


def _compute_reference_tensor(suspect: Suspect) -> Mat3:
    """Compute the reference's tensor (3, 3) at the declared mass, in the inertial frame's axes."""
    uniform = compute_covariance_inertia(suspect.reference.covariance, suspect.declared.mass)
    tensor: Mat3 = suspect.declared.rotation.T @ uniform @ suspect.declared.rotation
    return tensor


def _shows_rounding_alone(suspect: Suspect) -> bool:
    """Whether the tensor is the reference's to the digits typed, so that neither another solid nor another mass shows in it."""
    return is_rounding_of(suspect.declared.tensor, _compute_reference_tensor(suspect))


def _undo_wrong_formula(suspect: Suspect) -> Corrected:
    """The numbers are those of a textbook formula for another solid than the one that is drawn."""
    declared, geometry = suspect.declared, suspect.geometry
    if geometry is None or geometry.primitive is None or _shows_rounding_alone(suspect):
        return
    own = suspect.reference.twin or replace(
        declared, tensor=declared.rotation.T @ compute_solid_inertia(geometry.solid, declared.mass) @ declared.rotation
    )
    white = _compute_solid_whitening(suspect, geometry.solid)
    for name, has_other_axes, body in list_wrong_formulas(geometry.primitive):
        if not is_tensor_of(declared, body) or not _is_different_shape(body, white):
            continue
        mistake = make_mistake("wrong_formula (other axes)" if has_other_axes else "wrong_formula", name)
        yield replace(mistake, source_body=replace(body, com=geometry.solid.com)), own


def _undo_other_mass(suspect: Suspect) -> Corrected:
    """The size of the tensor is taken from the reference; a mass that is farther from the declared one is less likely."""
    declared = suspect.declared
    scale = _compute_tensor_scale(declared, suspect.reference)
    if scale is None or _shows_rounding_alone(suspect):
        return
    log_prior = LOG_PRIORS["other_mass"] - 0.5 * (math.log(scale) / _REVISION) ** 2 - math.log(_REVISION) - LOG_SQRT_2PI
    detail = f"{declared.mass / scale:.3g} kg"
    if is_default_density(suspect.geometry, declared.mass / scale):
        detail += f" at {CAD_DEFAULT:g} kg/m³"
    mistake = Mistake(id="other_mass", detail=detail, log_prior=log_prior, borrowed=(1, 0))
    yield mistake, replace(declared, tensor=declared.tensor * scale)


def is_default_density(geometry: VisualGeometry | None, mass: float) -> bool:
    """Whether a mass gives what is drawn the density of a part without a material, to within `_DEFAULT_WITHIN`."""
    if geometry is None or not geometry.closed:
        return False
    default = CAD_DEFAULT * geometry.solid.volume
    return abs(mass - default) < _DEFAULT_WITHIN * default


def _compute_tensor_scale(declared: DeclaredInertial, reference: Reference) -> float | None:
    """Compute by what the tensor must be multiplied for the second moments to have the reference's size; None when they have
    none."""
    covariance = compute_mass_covariance(declared.inertia, declared.mass) if declared.mass > 0 else np.zeros((3, 3))
    white = reference.whitening
    ratios = np.linalg.eigvalsh(white @ covariance @ white)
    return float(np.exp(-np.log(ratios).mean())) if ratios[0] > 0 else None


def _undo_steiner_missing(suspect: Suspect) -> Corrected:
    geometry, declared = suspect.geometry, suspect.declared
    if geometry is not None and len(geometry.pieces) > 1:
        term = compute_term_of_pieces(geometry, declared.mass, declared.rotation)
        yield make_mistake("steiner_missing"), replace(declared, tensor=declared.tensor + term)


def compute_term_of_pieces(geometry: VisualGeometry, mass: float, rotation: Mat3) -> Mat3:
    """Compute what the parallel-axis theorem adds (3, 3, kg m²) for the pieces of a part of uniform density and this ``mass``
    (kg), in the inertial frame's axes, whose columns in the link's are ``rotation`` (3, 3)."""
    volumes = np.array([piece.volume for piece in geometry.pieces])
    levers = (np.array([piece.com for piece in geometry.pieces]) - geometry.solid.com) @ rotation
    return compute_covariance_inertia((levers.T * (volumes / volumes.sum())) @ levers, mass)


def _undo_own_missing(suspect: Suspect) -> Corrected:
    """The pieces were moved to the common COM (parallel-axis theorem) as if they were points: the tensor is that of their mass
    alone, and the part's own is that of its uniform solid."""
    geometry, declared = suspect.geometry, suspect.declared
    if geometry is None or len(geometry.pieces) < 2:
        return
    term = compute_term_of_pieces(geometry, declared.mass, declared.rotation)
    own = declared.rotation.T @ compute_solid_inertia(geometry.solid, declared.mass) @ declared.rotation
    off = float(np.linalg.norm(declared.tensor - term))
    if off < _SAME_TERM * float(np.linalg.norm(term)) and np.linalg.norm(own - term) > EFFECT * np.linalg.norm(own):
        second = 0.5 * np.trace(term) * np.eye(3) - term
        points = Solid(geometry.solid.volume, geometry.solid.com, second / declared.mass)
        yield replace(make_mistake("own_missing"), source_body=points), replace(declared, tensor=own)


def _undo_other_body(suspect: Suspect) -> Corrected:
    """The numbers are those of another body: the part's own are those of its twin, or of its uniform solid."""
    geometry, mass = suspect.geometry, suspect.declared.mass
    if geometry is None:
        return
    solid = geometry.solid
    own = suspect.reference.twin or DeclaredInertial(mass, solid.com, compute_solid_inertia(solid, mass))
    white = _compute_solid_whitening(suspect, solid)
    for name, body in _iter_other_bodies(geometry):
        is_excluded = (name == "convex_hull" and _has_no_products_of(suspect.declared, body)) or (
            name == "one_piece" and _has_com_of_whole(suspect.declared, solid, body)
        )
        if _is_different_shape(body, white) and not is_excluded:
            yield replace(make_mistake(name), source_body=body), own


def _has_no_products_of(declared: DeclaredInertial, body: Solid) -> bool:
    """Whether all typed products are zero, and those of a body are not: a formula makes such a tensor, no hull."""
    products = (declared.rotation.T @ body.covariance @ declared.rotation)[_PRODUCTS]
    is_turned = np.abs(products).max() > _LEAST_PRODUCT * np.trace(body.covariance)
    return bool(is_turned and not declared.tensor[_PRODUCTS].any())


def _has_com_of_whole(declared: DeclaredInertial, whole: Solid, piece: Solid) -> bool:
    """Whether the COM is that of all pieces: then the tensors of like pieces were added where they are, which makes a tensor like
    that of one (``steiner_missing``)."""
    return bool(np.linalg.norm(declared.com - whole.com) < np.linalg.norm(declared.com - piece.com))


def _iter_other_bodies(geometry: VisualGeometry) -> Iterator[tuple[str, Solid]]:
    """Return the bodies that may be taken for the part."""
    if geometry.shell is not None:
        yield "shell", geometry.shell
    if geometry.box is not None:
        yield "bounding_box", geometry.box
    if geometry.closed and geometry.hull is not None:
        yield "convex_hull", geometry.hull
    if len(geometry.pieces) > 1:
        for piece in geometry.pieces[:_MOST_PIECES]:
            yield "one_piece", piece


def _compute_solid_whitening(suspect: Suspect, solid: Solid) -> Mat3:
    """Return the whitening of what is drawn, which the reference knows where it is not a twin."""
    return suspect.reference.whitening if suspect.reference.twin is None else compute_whitening(solid.covariance)


def _is_different_shape(body: Solid, white: Mat3) -> bool:
    """Whether mistaking a body for that of the ``white`` has an effect."""
    ratios = np.linalg.eigvalsh(white @ body.covariance @ white)
    return bool(ratios[0] <= 0.0 or np.linalg.norm(np.log(ratios)) > EFFECT)


# Mistakes that mix the numbers or lose some, in the order in which equally likely ones are preferred.
MIXING_MISTAKES: tuple[Callable[[Suspect], Corrected], ...] = (
    _undo_about_origin,
    _undo_positive_notation,
    _undo_steiner_twice,
    _undo_quarter_turn,
    _undo_unmirrored,
    _undo_rpy_twice,
    _undo_com_missing,
    _undo_rpy_missing,
    _undo_row_major,
    _undo_repeated_slot,
    _undo_rounded,
    _undo_wrong_formula,
    _undo_other_mass,
    _undo_steiner_missing,
    _undo_own_missing,
    _undo_other_body,
)


def list_explanations(suspect: Suspect) -> tuple[list[Mistake], InertialBatch]:
    """List every mistake, "none" first, and the numbers without it."""
    declared = suspect.declared
    multiplying, mass, com, components = stack_multipliers()
    typed = np.array([declared.tensor[place] for place in COMPONENT_INDICES])
    multiplied = InertialBatch(
        mass=mass * declared.mass,
        com=com * declared.com,
        tensor=(components @ typed)[:, _TO_MATRIX].reshape(-1, 3, 3),
        rotation=np.broadcast_to(declared.rotation, (len(multiplying), 3, 3)),
    )
    others = [corrected for undo in MIXING_MISTAKES for corrected in undo(suspect)]
    mistakes = [*multiplying, *(mistake for mistake, _ in others)]
    return mistakes, multiplied.concatenate_with(InertialBatch.from_inertials([numbers for _, numbers in others]))
