"""Links whose pieces were added, or of which one piece was taken, judged by all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import EXACT
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.mistakes.mixing_mistakes import compute_term_of_pieces
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry, split_visual_bodies

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis
    from urdfcheck.facts.inertials.inertia_tensor import Solid

# So many links show the signs of the products, each of which is nearer to the drawn part by this factor with the other signs.
_FEWEST, _NEARER = 2, 0.7
_DIGITS = 5
# Detail of a tensor whose products have the signs of CAD programs besides.
_OTHER_SIGNS = "its products have the other signs, too"


def join_added_pieces(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts: with the other signs of the products before the term of the parallel-axis theorem is added, where the
    links of the file that lack the term show these; and with the cause of a link for those that have its numbers."""
    joined = dict(found)
    keys = {_get_key(numbers[name]) for name, one in found.items() if _lacks_term(one)}
    for name, one in found.items():
        if _get_key(numbers[name]) in keys and not _lacks_term(one):
            joined[name] = _add_term(model, name, numbers[name], one)
    lacking = [name for name, one in found.items() if one.cause == "steiner_missing" and one.mended is not None]
    signed = {name: _negate_products(model, name, numbers[name], found[name]) for name in lacking}
    shown = [one for one in signed.values() if one is not None]
    if len(shown) >= _FEWEST and all(is_nearer for _, is_nearer in shown):
        joined |= {name: one[0] for name, one in signed.items() if one is not None}
    of_piece = {_get_key(numbers[name]): one for name, one in found.items() if one.cause == "one_piece"}
    for name, one in found.items():
        like = of_piece.get(_get_key(numbers[name]))
        if like is not None and one.cause is None and not one.sound and one.judged_by == "mesh":
            joined[name] = replace(
                one,
                cause=like.cause,
                detail=like.detail,
                mended_tensor_mismatch=like.mended_tensor_mismatch,
                mended_com_mismatch=like.mended_com_mismatch,
                ruled_out=like.ruled_out,
            )
    return joined


def _get_key(numbers: DeclaredInertial) -> tuple[str, ...]:
    """Return what one piece has in common wherever it is: mass and principal moments, to the digits of an exporter."""
    return tuple(f"{value:.{_DIGITS}g}" for value in (numbers.mass, *np.linalg.eigvalsh(numbers.tensor)))


def _lacks_term(diagnosis: Diagnosis) -> bool:
    return diagnosis.cause == "steiner_missing" and diagnosis.judged_by == "mesh"


def _add_term(model: Model, name: str, declared: DeclaredInertial, diagnosis: Diagnosis) -> Diagnosis:
    """Return the verdict on a link with the numbers of one that lacks the term of its pieces: the same, if the COM is that of
    what it draws, and the term brings its tensor nearer. A COM that is elsewhere is another defect, which other rules report."""
    link = model.link_by_name[name]
    drawn = measure_link_geometry(model, link)
    pieces = () if drawn is None else drawn.pieces if len(drawn.pieces) > 1 else split_visual_bodies(model, link)
    if drawn is None or not drawn.closed or len(pieces) < 2:
        return diagnosis
    before = measure_inertial_mismatch(declared, drawn.solid.com, drawn.solid.covariance)
    if before[1] > EXACT:
        return diagnosis
    term = compute_term_of_pieces(replace(drawn, pieces=pieces), declared.mass, declared.rotation)
    mended = replace(declared, tensor=declared.tensor + term)
    if _measure_distance(mended, drawn.solid) > _NEARER * _measure_distance(declared, drawn.solid):
        return diagnosis
    of_mesh = replace(
        diagnosis, judged_by="mesh", at_fault=True, tensor_mismatch=before[0], com_mismatch=before[1], com_order=""
    )
    return of_mesh.name_cause("steiner_missing", mended, drawn.solid, unique=False)


def _negate_products(
    model: Model, name: str, declared: DeclaredInertial, diagnosis: Diagnosis
) -> tuple[Diagnosis, bool] | None:
    """Return the verdict with the products of a tensor negated before the term is added, and whether that is nearer to the drawn
    part; None where nothing is known of it."""
    drawn, mended = measure_link_geometry(model, model.link_by_name[name]), diagnosis.mended
    if drawn is None or mended is None:
        return None
    signed = replace(mended, tensor=mended.tensor - 2.0 * _take_products(declared.tensor))
    left, before = (_measure_distance(one, drawn.solid) for one in (signed, mended))
    tensor_mismatch, _ = measure_inertial_mismatch(signed, drawn.solid.com, drawn.solid.covariance)
    verdict = replace(diagnosis, detail=_OTHER_SIGNS, mended=signed, mended_tensor_mismatch=tensor_mismatch)
    return verdict, left < _NEARER * before


def _measure_distance(numbers: DeclaredInertial, solid: Solid) -> float:
    """Measure how far a tensor is from a uniform solid's at the same mass (Frobenius norm, kg m²)."""
    return float(np.linalg.norm(numbers.inertia - compute_solid_inertia(solid, numbers.mass)))


def _take_products(tensor: Array) -> Array:
    products: Array = tensor - np.diag(tensor.diagonal())
    return products
