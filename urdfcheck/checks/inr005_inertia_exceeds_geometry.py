"""INR005 reports inertia tensors that would need mass farther out than anything that is drawn."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Rule
from urdfcheck.core.merging import merge_identical
from urdfcheck.facts.inertials.hull_bounds import compute_spread_ratios, measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import list_half_units
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model import Model
from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, EnclosedInertial, enclosed_inertials
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.model.repairs.inertial_edits import propose_from_geometry
from urdfcheck.model.shapes.visual_solid import has_drawn_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray


def check(model: Model, rule: Rule, *, ratio: float, margin: float) -> Iterator[Finding]:
    """Wheels with one inertia are one finding."""
    yield from merge_identical(rule, _check_each_link(model, rule, ratio, margin), "link", varying=("computed",))


def _check_each_link(model: Model, rule: Rule, ratio: float, margin: float) -> Iterator[Finding]:
    for part in enclosed_inertials(model):
        if part.moment_share < NEGLIGIBLE_SHARE:
            continue
        # Where programs disagree about the size (MSH008) or the up axis of a mesh, all have to agree about this.
        excess, spread = min(_compute_excess(part, points, margin, ratio) for points in part.readings)
        if not ratio < excess < np.inf:
            continue
        assert part.inertial.tensor_element is not None
        drawn = (
            propose_from_geometry(model, part.link) if has_drawn_shape(part.link) and len(part.readings) == 1 else None
        )
        yield rule.finding(
            "exceeds",
            at=part.inertial.tensor_element,
            edits=() if drawn is None else drawn.edits,
            computed=f"; as uniform as it is drawn, it has {drawn.text}" if drawn is not None and drawn.text else "",
            link=part.link.name,
            ratio=float(f"{excess:.3g}"),
            mass=part.mass,
            spread=float(f"{spread:.3g}"),
            most=float(f"{spread / excess**0.5:.3g}"),
            around=part.geometry_phrase,
        )


def _compute_excess(
    part: EnclosedInertial, points: NDArray[np.float64], margin: float, ratio: float
) -> tuple[float, float]:
    """How many times the greatest possible variance the inertial has along the axis where that is worst, and its root (m)
    there. Where the centre of mass is outside, so much more is taken to be drawn that it is not."""
    slack = margin * measure_extent(points)
    covariance = part.covariance - _estimate_rounding(part) * np.eye(3)
    ratios, axes = compute_spread_ratios(points, part.com, covariance, slack)
    if ratios.max() > ratio and (distance := measure_hull_distance(points, part.com)) > 0.0:
        ratios, axes = compute_spread_ratios(points, part.com, covariance, slack + distance)
    worst = int(ratios.argmax())
    variance = float(axes[:, worst] @ part.covariance @ axes[:, worst])
    return float(ratios[worst]), max(0.0, variance) ** 0.5


def _estimate_rounding(part: EnclosedInertial) -> float:
    """By how much (m²) the variances may differ from those of the tensor that was rounded to the typed digits; a number that
    was typed for want of one was not rounded."""
    element, six = part.inertial.tensor_element, part.inertial.inertia_components
    assert element is not None
    assert six is not None
    if describe_placeholder(part.mass, six) is not None:
        return 0.0
    xx, xy, xz, yy, yz, zz = list_half_units([element.get(name) for name in TENSOR_NAMES])
    products = 2.0 * (xy * xy + xz * xz + yz * yz)
    return float(0.5 * (xx + yy + zz) + np.sqrt(xx * xx + yy * yy + zz * zz + products)) / part.mass
