"""GEO004 reports dense visual meshes that also serve as collision geometry."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from urdfcheck.core import Finding, Rule
from urdfcheck.facts.arrays import Array
from urdfcheck.facts.inertials.equivalent_solids import fit_equivalent_box, fit_equivalent_cylinder
from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    compute_principal_moments,
    compute_solid_inertia,
)
from urdfcheck.facts.mesh.measure import compute_mesh_solid
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.solids import compute_drawn_scale

# Names and primitives that a message lists before it counts the rest.
LISTED = 8
IDENTITY, NO_TRANSLATION = np.eye(3), np.zeros(3)


def check(model: Model, rule: Rule, *, triangles: int) -> Iterator[Finding]:
    dense: list[tuple[MeshUse, int]] = []
    for use in model.meshes.uses:
        facts = model.meshes.get_facts(use.shape)
        if facts is not None and facts.n_triangles > triangles and _is_drawn_too(model, use):
            dense.append((use, facts.n_triangles))
    if not dense:
        return
    fits: dict[str, list[str]] = {}
    for use, _ in dense:
        if (fit := _fit_primitive(model, use)) is not None:
            fits.setdefault(fit, []).append(use.link.name)
    yield rule.finding(
        "fits" if fits else "dense",
        at=dense[0][0].filename,
        related=[use.filename for use, _ in dense[1:]],
        links=_format_list([f"{use.link.name} ({n:,})" for use, n in dense]),
        fits=_format_list([f"{fit} for {_format_list(names)}" for fit, names in fits.items()], "; "),
        total=sum(n for _, n in dense),
    )


def _format_list(items: list[str], separator: str = ", ") -> str:
    more = len(items) - LISTED
    return separator.join(items[:LISTED]) + (f"{separator}and {more} more" if more > 0 else "")


def _is_drawn_too(model: Model, use: MeshUse) -> bool:
    """Whether the link's visual and collision use the same file."""
    if use.shape.role != "collision":
        return False
    drawn = [model.meshes.by_shape.get(id(shape)) for shape in use.link.visuals]
    return use.resource.path in {other.resource.path for other in drawn if other is not None}


def _fit_primitive(model: Model, use: MeshUse) -> str | None:
    """Return the cylinder or box with the volume and second moments of the mesh to within 2 %, as URDF text.

    Its axes must be the mesh's own and its extent the mesh's to within a quarter, which excludes rings and combs.
    """
    facts, scale = model.meshes.get_facts(use.shape), compute_drawn_scale(model, use.shape)
    if facts is None or scale is None or not facts.closed or not facts.volume * np.prod(scale):
        return None
    solid = compute_mesh_solid(facts, scale, rotation=IDENTITY, translation=NO_TRANSLATION)
    extent = np.ptp(facts.bounds * np.array(scale), axis=0)
    moments, axes = compute_principal_moments(compute_solid_inertia(solid, solid.volume))
    return _fit_cylinder(solid, moments, axes, extent) or _fit_box(solid, moments, axes, extent)


def _fit_cylinder(solid: Solid, moments: Array, axes: Array, extent: Array) -> str | None:
    axis, radius, length = fit_equivalent_cylinder(solid.volume, moments.tolist())
    along = None if axis is None else _find_nearest_axis(axes[:, axis])
    if along is None or abs(np.pi * radius**2 * length / solid.volume - 1) > 0.02:
        return None
    expected = [length if i == along else 2 * radius for i in range(3)]
    if not np.allclose(extent, expected, rtol=0.25):
        return None
    return f'<cylinder radius="{radius:.3f}" length="{length:.3f}"/> along {"xyz"[along]}'


def _fit_box(solid: Solid, moments: Array, axes: Array, extent: Array) -> str | None:
    edges = fit_equivalent_box(solid.volume, moments.tolist())
    places = [_find_nearest_axis(axes[:, i]) for i in range(3)]
    if None in places or abs(np.prod(edges) / solid.volume - 1) > 0.02:
        return None
    size = [edge for _, edge in sorted(zip([p or 0 for p in places], edges, strict=True))]
    if not np.allclose(extent, size, rtol=0.25):
        return None
    return '<box size="' + " ".join(f"{edge:.3f}" for edge in size) + '"/>'


def _find_nearest_axis(direction: Array) -> int | None:
    """Return the coordinate axis within 3° of a direction, if there is one."""
    best = int(np.argmax(np.abs(direction)))
    return best if abs(direction[best]) > 0.9986 else None
