"""GEO004: collision geometry is simpler than what is drawn."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from urdfcheck.core import Finding, Rule
from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    equivalent_box,
    equivalent_cylinder,
    inertia_of,
    principal_moments,
)
from urdfcheck.facts.mesh.measure import transformed_moments
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse

# Names and primitives that a message lists before it counts the rest.
LISTED = 8
IDENTITY, NOWHERE = np.eye(3), np.zeros(3)


def check(model: Model, rule: Rule, *, triangles: int) -> Iterator[Finding]:
    found: list[tuple[MeshUse, int]] = []
    for use in model.meshes.uses:
        facts = model.meshes.facts_of(use.shape)
        if facts is not None and facts.n_triangles > triangles and _is_drawn_too(model, use):
            found.append((use, facts.n_triangles))
    if not found:
        return
    fits: dict[str, list[str]] = {}
    for use, _ in found:
        if (fit := _primitive(model, use)) is not None:
            fits.setdefault(fit, []).append(use.link.name)
    yield rule.finding(
        "fits" if fits else "dense",
        at=found[0][0].filename,
        related=[use.filename for use, _ in found[1:]],
        links=_list([f"{use.link.name} ({n:,} triangles)" for use, n in found]),
        fits=_list([f"{fit} for {_list(names)}" for fit, names in fits.items()], "; "),
        total=sum(n for _, n in found),
    )


def _list(items: list[str], separator: str = ", ") -> str:
    more = len(items) - LISTED
    return separator.join(items[:LISTED]) + (f"{separator}and {more} more" if more > 0 else "")


def _is_drawn_too(model: Model, use: MeshUse) -> bool:
    """Whether the link draws the file that it collides with."""
    if use.shape.role != "collision":
        return False
    drawn = [model.meshes.by_shape.get(id(shape)) for shape in use.link.visuals]
    return use.resource.path in {other.resource.path for other in drawn if other is not None}


def _primitive(model: Model, use: MeshUse) -> str | None:
    """The cylinder or box that has the volume and second moments of the mesh to within 2 %, as URDF text.

    Only where its axes are the mesh's own, and where it reaches as far as the mesh to within a quarter, which leaves
    out rings and combs.
    """
    facts, scale = model.meshes.facts_of(use.shape), use.shape.size
    if facts is None or scale is None or not facts.closed or not facts.volume * np.prod(scale):
        return None
    solid = transformed_moments(facts, scale, IDENTITY, NOWHERE)
    extent = np.ptp(facts.bounds * np.array(scale), axis=0)
    _, axes = principal_moments(inertia_of(solid, solid.volume))
    return _cylinder(solid, axes, extent) or _box(solid, axes, extent)


def _cylinder(solid: Solid, axes: np.typing.NDArray[np.float64], extent: np.typing.NDArray[np.float64]) -> str | None:
    axis, radius, length = equivalent_cylinder(solid.volume, inertia_of(solid, solid.volume))
    along = None if axis is None else _own_axis(axes[:, axis])
    if along is None or abs(np.pi * radius**2 * length / solid.volume - 1) > 0.02:
        return None
    expected = [length if i == along else 2 * radius for i in range(3)]
    if not np.allclose(extent, expected, rtol=0.25):
        return None
    return f'<cylinder radius="{radius:.3f}" length="{length:.3f}"/> along {"xyz"[along]}'


def _box(solid: Solid, axes: np.typing.NDArray[np.float64], extent: np.typing.NDArray[np.float64]) -> str | None:
    edges = equivalent_box(solid.volume, inertia_of(solid, solid.volume))
    places = [_own_axis(axes[:, i]) for i in range(3)]
    if None in places or abs(np.prod(edges) / solid.volume - 1) > 0.02:
        return None
    size = [edge for _, edge in sorted(zip([p or 0 for p in places], edges, strict=True))]
    if not np.allclose(extent, size, rtol=0.25):
        return None
    return '<box size="' + " ".join(f"{edge:.3f}" for edge in size) + '"/>'


def _own_axis(direction: np.typing.NDArray[np.float64]) -> int | None:
    """The coordinate axis that a direction is within 3° of."""
    best = int(np.argmax(np.abs(direction)))
    return best if abs(direction[best]) > 0.9986 else None
