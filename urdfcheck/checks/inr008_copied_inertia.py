"""INR008 reports links of different shape with the same inertia tensor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.diagnosis import VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model import Link, Model
from urdfcheck.model.parts import Inertial
from urdfcheck.model.rigid_bodies import is_point_mass
from urdfcheck.model.shapes.visual_solid import has_drawn_shape, has_unit_ambiguity, measure_link_geometry

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# Tensors that agree in this many digits are one number that was copied.
_DIGITS = 9


@dataclass(frozen=True, slots=True, eq=False)
class _InertiaSignature:
    """A link with a tensor and a shape. ``declared``, ``solid`` and ``hull``: logarithms (3,) of the eigenvalues, ascending, of
    the covariance that the inertial has, and the drawn solid and its hull at uniform density."""

    link: Link
    inertial: Inertial
    declared: Array
    solid: Array
    hull: Array

    def measure_shape_distance(self, other: _InertiaSignature) -> float:
        """How far the shapes are from each other, size included; 0 for equal, turned or mirrored ones."""
        return min(_measure_distance(self.solid, other.solid), _measure_distance(self.hull, other.hull))

    @property
    def misfit(self) -> float:
        """How far the tensor is from the link's own shape."""
        return _measure_distance(self.declared, self.solid)


def check(model: Model, rule: Rule, *, shape: float) -> Iterator[Finding]:
    groups: dict[tuple[str, ...], list[Link]] = {}
    for link in model.links:
        if link.inertial is not None and link.inertial.inertia_components is not None:
            # A mirrored part has products of the other sign.
            groups.setdefault(tuple(f"{abs(v):.{_DIGITS}g}" for v in link.inertial.inertia_components), []).append(link)
    for links in groups.values():
        group = [part for link in links if len(links) > 1 and (part := _compute_signature(model, link)) is not None]
        if not group:
            continue
        # The tensor is the one of the part that it fits; without such a part nobody knows which is the copy.
        original = min(group, key=lambda part: part.misfit)
        copies = [part for part in group if part.measure_shape_distance(original) > shape]
        if copies:
            yield _build_finding(
                rule, original, copies, len(group), original.misfit <= 2 * shape < min(c.misfit for c in copies)
            )


def _compute_signature(model: Model, link: Link) -> _InertiaSignature | None:
    inertial = link.inertial
    if inertial is None or inertial.mass is None or inertial.inertia_components is None or inertial.tensor is None:
        return None
    if (
        not inertial.mass > 0
        or not has_drawn_shape(link)
        or is_point_mass(inertial)
        or describe_placeholder(inertial.mass, inertial.inertia_components)
    ):
        return None
    drawn = measure_link_geometry(model, link)
    # A mesh that programs read in different sizes (MSH008) is compared with nothing.
    if drawn is None or drawn.hull is None or has_unit_ambiguity(model, (link.name,)):
        return None
    declared, solid, hull = (
        _compute_log_eigenvalues(c)
        for c in (compute_mass_covariance(inertial.tensor, inertial.mass), *_get_covariances(drawn))
    )
    return _InertiaSignature(link, inertial, declared, solid, hull)


def _get_covariances(drawn: VisualGeometry) -> tuple[Array, Array]:
    assert drawn.hull is not None
    return drawn.solid.covariance, drawn.hull.covariance


def _compute_log_eigenvalues(covariance: Array) -> Array:
    """Of the eigenvalues, none of them below the thickness of a sheet of that size."""
    values = np.linalg.eigvalsh(covariance)
    logarithms: Array = np.log(np.maximum(values, 1e-6 * max(float(values[-1]), 1e-300)))
    return logarithms


def _measure_distance(first: Array, second: Array) -> float:
    return float(np.linalg.norm(first - second))


def _build_finding(
    rule: Rule, original: _InertiaSignature, copies: Sequence[_InertiaSignature], count: int, is_original_known: bool
) -> Finding:
    worst = max(copies, key=lambda part: part.measure_shape_distance(original))
    places = [_locate(part) for part in copies]
    finding = rule.finding(
        "copied" if is_original_known else "shared",
        at=places[0],
        related=[_locate(original), *places[1:]],
        links=join_names([part.link.name for part in copies]),
        have="has" if len(copies) == 1 else "have",
        original=original.link.name,
        worst=worst.link.name,
        size=_format_box_size(worst),
        original_size=_format_box_size(original),
        count=count,
    )
    wrong = places if is_original_known else [*places, _locate(original)]
    return replace(finding, subjects=tuple(dict.fromkeys(p.location.subject for p in wrong)))


def _format_box_size(part: _InertiaSignature) -> str:
    """Edges of the solid box with the same second moments as the drawn shape."""
    return " × ".join(f"{edge:.2g}" for edge in np.sqrt(12.0 * np.exp(part.solid))[::-1]) + " m"


def _locate(part: _InertiaSignature) -> Located:
    return part.inertial.tensor_element or part.inertial
