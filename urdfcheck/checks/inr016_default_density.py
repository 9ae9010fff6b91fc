"""INR016 reports links that all have the default density of a CAD program, and links of ten times the others' density."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.equivalent_solids import compute_equivalent_density
from urdfcheck.facts.inertials.materials import describe_density, format_density
from urdfcheck.model import DeclaredMass, Model
from urdfcheck.model.shapes.solids import measure_link_solid
from urdfcheck.model.use.display import is_loaded_for_frames

# A program that gives parts without a material another density, as the exporter's header names it.
_SOLIDWORKS = re.compile(r"SolidWorks", re.IGNORECASE)
# kg/m³ of a part without a material -> the cause that names the programs.
DEFAULTS = {1000.0: "unassigned", 7850.0: "steel"}


def check(
    model: Model, rule: Rule, *, mesh_tol: float, solid_tol: float, fraction: float, evidence: int
) -> Iterator[Finding]:
    heavy = [declared for declared in model.masses if declared.mass > 0]
    measured = _measure_densities(model, heavy)
    yield from _check_tenfold(model, rule, measured, tolerance=mesh_tol, evidence=evidence)
    for default, cause in DEFAULTS.items():
        if cause == "steel" and _is_of_solidworks(model):
            continue
        densities: dict[str, float] = {}
        for declared in heavy:
            density = measured.get(declared.link.name)
            if density is None:
                density = _match_solid_density(model, declared, default=default, tolerance=solid_tol)
            if density is not None:
                densities[declared.link.name] = density
        tolerance = max(mesh_tol, solid_tol)
        near = [declared for declared in heavy if _is_near(densities.get(declared.link.name), default, tolerance)]
        # Equal parts are one piece of evidence: two wheels of one file weigh the same whatever they are made of.
        different = {f"{declared.mass:.3g}" for declared in near}
        if len(different) < 2 or len(near) < fraction * len(densities) or 2 * len(near) < len(heavy):
            continue
        spread = max(abs(densities[declared.link.name] / default - 1.0) for declared in near)
        yield rule.finding(
            "default",
            at=near[0].attribute.location,
            related=[declared.attribute.location for declared in near[1:]],
            cause=cause,
            severity=None if _is_felt(model) else Severity.INFO,
            count=len(near),
            known=len(densities),
            default=default,
            spread=f" to within {spread:.1%}" if spread >= 5e-4 else "",
            mass=sum(declared.mass for declared in near),
            links=[declared.link.name for declared in near],
        )


def _is_of_solidworks(model: Model) -> bool:
    """Whether a comment of the model's own file says that SolidWorks wrote it: there the author chose steel."""
    file = model.source.files.get(model.source.name)
    return file is not None and any(_SOLIDWORKS.search(comment.text) for comment in file.comments)


def _measure_densities(model: Model, heavy: Sequence[DeclaredMass]) -> dict[str, float]:
    """Measure the densities of the links whose meshes were read (kg/m³), by the link's name."""
    if not model.meshes.facts:
        return {}
    from urdfcheck.model.inertials.mesh_density import compute_mesh_density  # loads numpy

    densities = {declared.link.name: compute_mesh_density(model, declared) for declared in heavy}
    return {name: density for name, density in densities.items() if density is not None}


def _is_felt(model: Model) -> bool:
    """Whether a joint moves a mass of the model, and the project is not known to display it alone."""
    return any(joint.is_movable for joint in model.joints) and not is_loaded_for_frames(model)


def _check_tenfold(
    model: Model, rule: Rule, measured: Mapping[str, float], *, tolerance: float, evidence: int
) -> Iterator[Finding]:
    """Report links that are ten times as dense as others: one program wrote both, and one of the two with another decimal
    point."""
    if len(measured) < evidence:
        return
    from urdfcheck.model.inertials.mesh_density import find_tenfold_density
    from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity

    densities = {
        name: (model.mass_by_name[name], density)
        for name, density in measured.items()
        if not has_unit_ambiguity(model, [name])
    }
    found = find_tenfold_density(densities, tolerance=tolerance, evidence=evidence)
    if found is None:
        return
    yield build_group_finding(
        rule,
        "tenfold",
        [declared.attribute for declared in found.high],
        links=join_names(declared.link.name for declared in found.high),
        others=join_names(declared.link.name for declared in found.low),
        count=len(found.high),
        high=format_density(10.0 * found.density),
        low=describe_density(found.density),
    )


def _is_near(density: float | None, default: float, tolerance: float) -> bool:
    return density is not None and abs(density / default - 1.0) <= tolerance


def _match_solid_density(model: Model, declared: DeclaredMass, *, default: float, tolerance: float) -> float | None:
    """Return the density of the box or cylinder with the link's mass and inertia if it is the default.

    Another value is not evidence: the part may have any shape. Nor is that of primitives, whose numbers were computed.
    """
    link, tensor = declared.link, model.tensor_by_name.get(declared.link.name)
    if tensor is None or any(shape.kind != "mesh" for shape in (*link.visuals, *link.collisions)):
        return None
    if measure_link_solid(model, link) is not None or not _has_positive_moments(tensor.components):
        return None
    equivalent = compute_equivalent_density(declared.mass, tensor.moments)
    for density in (equivalent.box, equivalent.cylinder):
        if density is not None and _is_near(density, default, tolerance):
            return density
    return None


def _has_positive_moments(components: tuple[float, ...]) -> bool:
    return min(components[0], components[3], components[5]) > 0
