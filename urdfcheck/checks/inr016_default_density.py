"""INR016 reports robots whose links all have the default density of a CAD program."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.facts.inertials.inertia_tensor import compute_equivalent_density
from urdfcheck.model import Link, Model
from urdfcheck.model.shapes.solids import measure_link_solid

# kg/m³ of a part without a material -> the cause that names the programs.
DEFAULTS = {1000.0: "unassigned", 7850.0: "steel"}


def check(model: Model, rule: Rule, *, mesh_tol: float, solid_tol: float, fraction: float) -> Iterator[Finding]:
    heavy = [link for link in model.links if link.inertial is not None and (link.inertial.mass or 0.0) > 0]
    measured = {link.name: density for link in heavy if (density := _compute_mesh_density(model, link)) is not None}
    for default, cause in DEFAULTS.items():
        densities = {
            link.name: density
            for link in heavy
            if (density := measured.get(link.name) or _match_solid_density(model, link, default, solid_tol)) is not None
        }
        at = [link for link in heavy if _is_near_default(densities.get(link.name), default, max(mesh_tol, solid_tol))]
        # Equal parts are one piece of evidence: two wheels of one file weigh the same whatever they are made of.
        different = {f"{link.inertial.mass:.3g}" for link in at if link.inertial and link.inertial.mass}
        if len(different) < 2 or len(at) < fraction * len(densities) or 2 * len(at) < len(heavy):
            continue
        spread = max(abs(densities[link.name] / default - 1.0) for link in at)
        yield rule.finding(
            "default",
            at=_locate(at[0]),
            related=[_locate(link) for link in at[1:]],
            cause=cause,
            count=len(at),
            known=len(densities),
            default=default,
            spread=f" to within {spread:.1%}" if spread >= 5e-4 else "",
            mass=sum(link.inertial.mass or 0.0 for link in heavy if link.inertial),
            links=[link.name for link in at],
        )


def _is_near_default(density: float | None, default: float, tolerance: float) -> bool:
    return density is not None and abs(density / default - 1.0) <= tolerance


def _compute_mesh_density(model: Model, link: Link) -> float | None:
    """Mass over the volume of what the link draws, kg/m³; None where that is not known or made of primitives only."""
    assert link.inertial is not None
    assert link.inertial.mass is not None
    for role, shapes in (("visual", link.visuals), ("collision", link.collisions)):
        if any(shape.kind == "mesh" for shape in shapes):
            solid = measure_link_solid(model, link, role)
            if solid is not None and solid.volume > 0:
                return link.inertial.mass / solid.volume
    return None


def _match_solid_density(model: Model, link: Link, default: float, tolerance: float) -> float | None:
    """The density of the box or cylinder with the link's mass and inertia, if it is the default.

    Another value says nothing: the part may have any shape. Nor does a link of primitives, whose numbers were computed.
    """
    inertial = link.inertial
    assert inertial is not None
    assert inertial.mass is not None
    shapes = (*link.visuals, *link.collisions)
    if inertial.tensor is None or any(shape.kind != "mesh" for shape in shapes):
        return None
    if measure_link_solid(model, link) is not None or not _has_positive_moments(inertial.inertia_components):
        return None
    equivalent = compute_equivalent_density(inertial.mass, inertial.tensor)
    for density in (equivalent.box, equivalent.cylinder):
        if density is not None and _is_near_default(density, default, tolerance):
            return density
    return None


def _has_positive_moments(six: tuple[float, ...] | None) -> bool:
    return six is not None and min(six[0], six[3], six[5]) > 0


def _locate(link: Link) -> Location:
    assert link.inertial is not None
    attribute = link.inertial.mass_attribute
    return link.inertial.location if attribute is None else attribute.location
