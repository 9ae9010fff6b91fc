"""Causes that explain the numbers of a link too little, or rest on what proves nothing: then none is named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import EXACT, FAR
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.materials import LIGHTEST
from urdfcheck.facts.inertials.mistakes.wrong_formulas import is_rounding_of
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
    from urdfcheck.facts.inertials.diagnosis import Diagnosis
    from urdfcheck.model.parts import Link

# A mistake of the tensor leaves less than this share of the difference from the drawn part's.
_LEFT = 0.5
# A turn of one link, one of many turns, leaves less than this share of the distance from where the COM is drawn, where this is
# more than some radii of gyration (both chosen).
_LEFT_BY_TURN, _AWAY = 0.25, 0.1
# Causes that take what is drawn apart: collision shapes are not the pieces that a CAD program added.
_OF_PIECES = frozenset({"steiner_missing", "own_missing", "one_piece"})
# A mass and a tensor with so many digits each were computed together: nobody typed one of them later. What is not drawn, or a
# second material, changes a size by less than this share.
_EXPORTED_DIGITS, _OTHER_MATERIAL = 12, 0.25
# The units that programs write are those of all links of a file: one link shows one by the tensor of its part, to this share
# (chosen).
_UNITS, _OWN_TENSOR = frozenset({"inertia_unit", "mass_unit", "units"}), 0.1
# Primitives that stand for a part bound it. What is off them by less than this factor may be the rest of the part (chosen).
_BOUNDED = 10.0
# Mistakes of signs: the magnitudes are the twin's, right or wrong.
_OF_SIGNS = frozenset({"unmirrored", "products_sign", "one_sign"})
# Causes whose numbers come from the drawing, that are in the drawing, or of which the tensor shows only a part.
_TOLD_BY_OTHERS = frozenset(
    {"rounded", "other_mass", "wrong_formula", "shell", "bounding_box", "convex_hull", "one_piece", "mesh_scale"}
)


def drop_weak_causes(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts, without the causes that the drawing of a link does not show."""
    return {
        name: _withdraw_cause(one)
        if _is_weak(model, model.link_by_name[name], numbers[name], one)
        or _is_unit_by_chance(model, name, numbers, found)
        else one
        for name, one in found.items()
    }


def drop_causes_of_bounds(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts, without the causes that collision shapes show which only bound the part, be they those of the file."""
    return {
        name: _withdraw_cause(one) if _rests_on_bounds(model, model.link_by_name[name], numbers[name], one) else one
        for name, one in found.items()
    }


def _is_weak(model: Model, link: Link, declared: DeclaredInertial, diagnosis: Diagnosis) -> bool:
    drawn = None if diagnosis.cause is None else measure_link_geometry(model, link)
    if drawn is None:
        return False
    if diagnosis.judged_by == "twin":  # a collision shape only bounds both
        return explain_collision_stand_in(model, link) is None and _is_twin_far(declared, drawn, diagnosis)
    if diagnosis.judged_by != "mesh":
        return False
    if diagnosis.cause == "inertia_unit" and _is_lighter_than_foam(declared, drawn):
        return True  # the mass is the wrong number, and some unit brings a tensor near that of any mass
    if diagnosis.cause in _OF_PIECES and explain_collision_stand_in(model, link) is not None:
        return True
    if diagnosis.cause == "quarter_turn" and not diagnosis.unique and diagnosis.com_mismatch > _AWAY:
        return diagnosis.mended_com_mismatch > _LEFT_BY_TURN * diagnosis.com_mismatch
    mended = diagnosis.mended
    if diagnosis.cause == "other_mass" and _is_of_one_export(declared, drawn):
        return True
    if diagnosis.cause in _TOLD_BY_OTHERS or mended is None or (mended.com != declared.com).any():
        return False
    if mended.mass != declared.mass:
        return False
    uniform = compute_solid_inertia(drawn.solid, declared.mass)
    if is_rounding_of(declared.tensor, declared.rotation.T @ uniform @ declared.rotation):
        return True  # the last digits are all that differs
    left, before = (float(np.linalg.norm(tensor - uniform)) for tensor in (mended.inertia, declared.inertia))
    return drawn.closed and not diagnosis.unique and left > _LEFT * before


def _is_twin_far(declared: DeclaredInertial, drawn: VisualGeometry, diagnosis: Diagnosis) -> bool:
    """Whether the twin's numbers, to which a mistake leads, are themselves those of no part like the drawn one."""
    mended = diagnosis.mended
    if mended is None or not drawn.closed or diagnosis.cause in _OF_SIGNS:
        return False
    tensor, com = measure_inertial_mismatch(mended, drawn.solid.com, drawn.solid.covariance)
    changes = (mended.inertia != declared.inertia).any(), (mended.com != declared.com).any()
    return bool((changes[0] and tensor > FAR) or (changes[1] and com > FAR))


def _rests_on_bounds(model: Model, link: Link, declared: DeclaredInertial, diagnosis: Diagnosis) -> bool:
    """Whether a mistake is found by collision shapes that only bound a part: primitives whose COM and tensor the numbers do not
    have without it, while the mistake changes sizes by no more than a part differs from its bounds."""
    mended = diagnosis.mended
    if mended is None or diagnosis.judged_by != "mesh" or explain_collision_stand_in(model, link) is None:
        return False
    if not diagnosis.fits_geometry or any(shape.kind == "mesh" for shape in link.collisions):
        return False
    if diagnosis.cause == "com_missing" or max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch) < EXACT:
        return False
    sizes = [float(np.trace(one.tensor)) / one.mass for one in (declared, mended)]
    lengths = [float(np.linalg.norm(one.com)) for one in (declared, mended)]
    return all(max(pair) < _BOUNDED * min(pair) or pair[0] == pair[1] for pair in (sizes, lengths))


def _is_unit_by_chance(
    model: Model, name: str, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> bool:
    """Whether a unit fits one link of a file whose other links fit neither it nor their drawings, and not to the part's own
    tensor: of many wrong numbers, one is about right in some unit."""
    one = found[name]
    if one.cause not in _UNITS or one.judged_by != "mesh" or one.unique or one.mended is None:
        return False
    drawn = measure_link_geometry(model, model.link_by_name[name])
    if drawn is None:
        return False
    uniform = compute_solid_inertia(drawn.solid, one.mended.mass)
    if float(np.linalg.norm(one.mended.inertia - uniform)) <= _OWN_TENSOR * float(np.linalg.norm(uniform)):
        return False
    own = _list_invariants(numbers[name])
    others = [other for key, other in found.items() if _list_invariants(numbers[key]) != own]
    if any((other.cause, other.detail) == (one.cause, one.detail) for other in others):
        return False
    return 2 * sum(not other.sound for other in others) > len(others)


def _list_invariants(declared: DeclaredInertial) -> tuple[str, ...]:
    """What copies and mirror images have in common: three digits of the mass and of the principal moments."""
    return tuple(f"{value:.3g}" for value in (declared.mass, *np.linalg.eigvalsh(declared.tensor)))


def _is_lighter_than_foam(declared: DeclaredInertial, drawn: VisualGeometry) -> bool:
    return drawn.solid.volume > 0.0 and declared.mass < LIGHTEST * drawn.solid.volume


def _is_of_one_export(declared: DeclaredInertial, drawn: VisualGeometry) -> bool:
    """Whether mass and tensor come from one computation, and the tensor is nearly of the size that the drawn part has."""
    uniform = compute_solid_inertia(drawn.solid, declared.mass)
    if abs(float(np.trace(declared.inertia) / np.trace(uniform)) - 1.0) >= _OTHER_MATERIAL:
        return False
    return all(_has_exported_digits(value) for value in (declared.mass, *declared.tensor.diagonal().tolist()))


def _has_exported_digits(value: float) -> bool:
    return float(f"{value:.{_EXPORTED_DIGITS - 2}e}") != value


def _withdraw_cause(diagnosis: Diagnosis) -> Diagnosis:
    return replace(
        diagnosis,
        cause=None,
        detail="",
        mended=None,
        mended_tensor_mismatch=diagnosis.tensor_mismatch,
        mended_com_mismatch=diagnosis.com_mismatch,
        unique=False,
        com_order="",
    )
