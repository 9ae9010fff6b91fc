"""INR005 reports inertia tensors that need mass outside the drawn geometry."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import merge_identical
from urdfcheck.facts.inertials.certainty import VAST
from urdfcheck.facts.inertials.hull_bounds import compute_spread_ratios, measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, list_half_units
from urdfcheck.facts.inertials.materials import DENSEST_PART
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.facts.mesh.measure import compute_convex_hull
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, EnclosedInertial, enclosed_inertials
from urdfcheck.model.inertials.inertial_proposals import (
    LARGEST_SOUND_MISMATCH,
    describe_drawn_inertial,
    describe_mistake,
    has_com_apart,
    propose_undo,
)
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.model.repairs.inertial_edits import InertialRepair
from urdfcheck.model.shapes.visual_solid import has_drawn_shape, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# kg·m² in one unit that a tensor is written in by mistake, from programs that calculate in grams or in smaller lengths.
_TENSOR_UNITS = {"kg·cm²": 1e-4, "kg·mm²": 1e-6, "g·m²": 1e-3, "g·cm²": 1e-7, "g·mm²": 1e-9}
# A part has a tensor like that of its uniform solid, within this factor.
_UNIT_RANGE = 10.0
# A part that is not drawn may be larger than what it is fixed to, but not ten times: variances, (10)².
_OTHER_PART = 100.0


def check(model: Model, rule: Rule, *, ratio: float, margin: float) -> Iterator[Finding]:
    # Wheels with one inertia are one finding.
    findings = _check_each_link(model, rule, ratio=ratio, margin=margin)
    yield from merge_identical(rule, findings, "link", varying=("computed",))


def _check_each_link(model: Model, rule: Rule, *, ratio: float, margin: float) -> Iterator[Finding]:
    for part in enclosed_inertials(model):
        if part.moment_share < NEGLIGIBLE_SHARE:
            continue
        declared = model.tensor_by_name[part.link.name]
        # If programs disagree about the size (MSH008) or the up axis of a mesh, the excess must be there in all readings.
        excess, spread = min(
            _compute_excess(part, declared, points, ratio=ratio, margin=margin) for points in part.readings
        )
        if not (ratio if part.has_own_geometry else _OTHER_PART) < excess < np.inf:
            continue
        if excess < VAST and _is_stand_in(part):
            continue
        repair, computed, explained = _propose(model, part, declared, ratio=ratio, excess=excess)
        yield rule.finding(
            "exceeds",
            at=declared.element,
            severity=Severity.ERROR if excess >= VAST and part.has_own_geometry else None,
            edits=() if repair is None else repair.edits,
            computed=computed,
            explained=explained,
            link=part.link.name,
            ratio=float(f"{excess:.3g}"),
            wider=float(f"{excess**0.5:.3g}"),
            mass=part.mass,
            spread=float(f"{spread:.3g}"),
            most=float(f"{spread / excess**0.5:.3g}"),
            around=part.geometry_phrase,
        )


def _is_stand_in(part: EnclosedInertial) -> bool:
    """Whether no part of any ordinary material is so heavy in the hull: then the drawing is that of a smaller thing, such as the
    rod in the middle of a leg."""
    with np.errstate(all="ignore"):  # other rules report impossible numbers
        return part.mass > DENSEST_PART * max(compute_convex_hull(points).volume for points in part.readings) > 0.0


def _propose(
    model: Model, part: EnclosedInertial, declared: DeclaredTensor, *, ratio: float, excess: float
) -> tuple[InertialRepair | None, str, str]:
    """Return a repair, what the advice says about it, and the end of the message about its cause."""
    diagnosed = inertial_diagnoses(model).get(part.link.name)
    is_explained = (
        diagnosed is not None
        and diagnosed.diagnosis.at_fault
        and diagnosed.diagnosis.mended_tensor_mismatch < LARGEST_SOUND_MISMATCH
    )
    if diagnosed is not None and is_explained and (undo := propose_undo(model, part.link)) is not None:
        mistake = describe_mistake(diagnosed.diagnosis.cause or "", diagnosed.diagnosis.detail)
        return undo, f"write {undo.words} if that is the mistake", f". One mistake explains it: {mistake}"
    if excess >= VAST and (unit := _guess_unit(model, part, ratio)) is not None:
        name, factor = unit
        tensor = [
            f'{axis}="{factor * value:.6g}"' for axis, value in zip(TENSOR_NAMES, declared.components, strict=True)
        ]
        fits = f". The same numbers are possible in {name}, and in no other unit"
        return None, f"write {' '.join(tensor)} if they are in {name}", fits
    is_known = has_drawn_shape(part.link) and len(part.readings) == 1
    drawn = describe_drawn_inertial(model, part.link, with_com=has_com_apart(model, part.link)) if is_known else ""
    return None, f"write {drawn}" if drawn else "compute them from the mesh", ""


def _guess_unit(model: Model, part: EnclosedInertial, ratio: float) -> tuple[str, float] | None:
    """Return the one unit in which the author's own tensor is possible inside the geometry, and about as large as that of a
    uniform part; None where none is, or several are, for a placeholder, and for a unit that no program writes."""
    drawn, declared = measure_link_geometry(model, part.link), model.tensor_by_name[part.link.name]
    if drawn is None or describe_placeholder(part.mass, declared.components) is not None:
        return None
    uniform = float(np.trace(compute_solid_inertia(drawn.solid, part.mass)))
    fitting = []
    for name, factor in _TENSOR_UNITS.items():
        size = factor * float(np.trace(declared.tensor)) / uniform if uniform > 0.0 else 0.0
        if 1.0 / _UNIT_RANGE < size < _UNIT_RANGE and all(
            compute_spread_ratios(points, part.com, factor * part.covariance, margin=0.0)[0].max() <= ratio
            for points in part.readings
        ):
            fitting.append((name, factor))
    return fitting[0] if len(fitting) == 1 and fitting[0][0] != "g·m²" else None


def _compute_excess(
    part: EnclosedInertial, declared: DeclaredTensor, points: Array, *, ratio: float, margin: float
) -> tuple[float, float]:
    """Return the worst ratio of the inertial's variance along an axis to the greatest possible one, and its root (m) there.

    If the centre of mass is outside, the geometry is enlarged until it is inside.
    """
    slack = margin * measure_extent(points)
    covariance = part.covariance - _estimate_rounding(part, declared) * np.eye(3)
    ratios, axes = compute_spread_ratios(points, part.com, covariance, margin=slack)
    if ratios.max() > ratio and (distance := measure_hull_distance(points, part.com)) > 0.0:
        ratios, axes = compute_spread_ratios(points, part.com, covariance, margin=slack + distance)
    worst = int(ratios.argmax())
    variance = float(axes[:, worst] @ part.covariance @ axes[:, worst])
    return float(ratios[worst]), max(0.0, variance) ** 0.5


def _estimate_rounding(part: EnclosedInertial, declared: DeclaredTensor) -> float:
    """Return the largest change of a variance (m²) by rounding the tensor to the typed digits; a placeholder is not rounded."""
    if describe_placeholder(part.mass, declared.components) is not None:
        return 0.0
    xx, xy, xz, yy, yz, zz = list_half_units(declared.texts)
    products = 2.0 * (xy * xy + xz * xz + yz * yz)
    return float(0.5 * (xx + yy + zz) + np.sqrt(xx * xx + yy * yy + zz * zz + products)) / part.mass
