"""Mistakes that several links of a file have in common, and units about which they disagree."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.certainty import FAR, SHOWN_BY_HULLS
from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_solid_inertia
from urdfcheck.facts.median import compute_median
from urdfcheck.model import Link, Model
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.diagnosis.edited_masses import shows_edited_masses
from urdfcheck.model.inertials.diagnosis_words import NOTABLE
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_effects import is_light, is_possible, measure_difference, measure_mismatch
from urdfcheck.model.shapes.visual_solid import (
    has_up_axis_ambiguity,
    measure_link_geometry,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis


# What a program gets wrong in all links of a model alike.
UNIT_CAUSES = frozenset({"com_unit", "mass_unit", "inertia_unit"})
_OF_ALL_LINKS = UNIT_CAUSES | {"units", "decimal_point"}
# Two fifths of the mass in a motor make a tensor differ by less from that of the drawn part (a share of its norm).
LUMPED = 0.4
# The tensor that is left may differ by this share from the drawn part's where a mistake of the whole file is edited.
_PROVEN = 0.1
# Principal moments that agree in this share, of a part with its COM where it is drawn, are those of the part; moments that
# differ by less than this share of the largest do not show their axes. The tensor differs by this share at least.
_SAME_MOMENTS, _DISTINCT, _OTHER_AXES = 0.02, 0.1, 0.1

# Tensors of one density are those of so many links of different mass densities, to within this share.
_FEWEST_DENSITIES, _SAME_DENSITY = 3, 0.03


def list_habitual_links(model: Model) -> list[Link]:
    """List the links that have the mistake that most links of the file have, and of whose mismatch it makes at least half, or
    that show it by themselves; none where fewer than two are left to report."""
    links = [
        model.link_by_name[name]
        for name, judged in inertial_diagnoses(model).items()
        if judged.is_habit and is_possible(judged) and _shows_habit(model, model.link_by_name[name], judged.diagnosis)
    ]
    if links and inertial_diagnoses(model)[links[0].name].diagnosis.cause in _OF_ALL_LINKS:
        numbers = inertial_diagnoses(model).values()
        judged = {(one.declared.mass, *one.declared.tensor.ravel()) for one in numbers}
        members = {
            (d.mass, *d.tensor.ravel()) for link in links for d in (inertial_diagnoses(model)[link.name].declared,)
        }
        if 2 * len(members) <= len(judged):
            return []
    return links if len(links) > 1 else []


def list_pointlike_links(model: Model) -> list[Link]:
    """List the links whose pieces count as points, which is what a program does to all links; none where there is only one."""
    links = _list_links_with(model, "own_missing")
    return links if len(links) > 1 else []


def list_unmoved_links(model: Model) -> list[Link]:
    """List the links that show that their pieces were added without the parallel-axis term; none where fewer than two differ."""
    links = []
    for link in _list_links_with(model, "steiner_missing"):
        judged = inertial_diagnoses(model)[link.name]
        if judged.diagnosis.judged_by == "mesh" and is_possible(judged) and is_proven(model, link):
            links.append(link)
    different = {_list_invariants(inertial_diagnoses(model)[link.name].declared) for link in links}
    return links if len(different) > 1 else []


def _list_links_with(model: Model, cause: str) -> list[Link]:
    diagnosed = inertial_diagnoses(model).items()
    return [model.link_by_name[name] for name, judged in diagnosed if judged.diagnosis.cause == cause]


def _list_invariants(declared: DeclaredInertial) -> tuple[str, ...]:
    """What copies and mirror images have in common: three digits of the mass and of the principal moments."""
    return tuple(f"{value:.3g}" for value in (declared.mass, *np.linalg.eigvalsh(declared.tensor)))


def _shows_habit(model: Model, link: Link, diagnosis: Diagnosis) -> bool:
    """Whether a link shows the mistake of its file: by itself, or because undoing it leaves less than half of the mismatch, and
    the tensor of such a part."""
    if diagnosis.cause not in SHOWN_BY_HULLS and not _fits_closed_mesh(model, diagnosis.cause):
        return False
    if diagnosis.unique:
        return True
    drawn, mended = measure_link_geometry(model, link), diagnosis.mended
    left = 0.0 if drawn is None or mended is None else measure_difference(mended, drawn)
    if diagnosis.cause not in UNIT_CAUSES and left > LUMPED:
        return False
    return measure_mismatch(diagnosis, is_mended=True) < 0.5 * measure_mismatch(diagnosis, is_mended=False)


@fact
def _fits_closed_mesh(model: Model, cause: str | None) -> bool:
    """Whether the mistake that the links of a file have in common shows in one of them by a closed mesh: the hulls of open ones
    are not the parts, and another mistake may fit what they draw."""
    alike = [name for name, one in inertial_diagnoses(model).items() if one.is_habit and one.diagnosis.cause == cause]
    measured = (measure_link_geometry(model, model.link_by_name[name]) for name in alike)
    return any(drawn is None or drawn.closed for drawn in measured)


def shows_habit_alone(model: Model, link: Link, diagnosis: Diagnosis) -> bool:
    """Whether a link shows the mistake of its file, and not something else beside it. A unit that is left to one link has to
    fit it exactly."""
    return _shows_habit(model, link, diagnosis) and (diagnosis.cause not in UNIT_CAUSES or is_proven(model, link))


def find_rotated_tensors(model: Model) -> dict[str, float]:
    """Return the links whose tensors have the principal moments of the drawn part about other axes, and no cause, each with the
    share of the drawn part's tensor by which the two differ."""
    rotated = {}
    for name, judged in inertial_diagnoses(model).items():
        diagnosis, declared, link = judged.diagnosis, judged.declared, model.link_by_name[name]
        drawn = measure_link_geometry(model, link)
        if (
            diagnosis.cause is not None
            or diagnosis.judged_by != "mesh"
            or diagnosis.com_mismatch > NOTABLE
            or diagnosis.tensor_mismatch < NOTABLE
            or drawn is None
            or not drawn.closed
            or has_up_axis_ambiguity(model, [name])
            or not is_possible(judged)
            or is_light(model, link)
        ):
            continue
        off = measure_turn_of_tensor(declared, drawn.solid)
        if off:
            rotated[name] = off
    return rotated


def measure_turn_of_tensor(declared: DeclaredInertial, solid: Solid) -> float:
    """Return the share of a uniform solid's tensor by which the declared one differs, if its principal moments are those of the
    solid about other axes; 0 otherwise."""
    uniform = compute_solid_inertia(solid, declared.mass)
    moments, expected = np.linalg.eigvalsh(declared.inertia), np.linalg.eigvalsh(uniform)
    if np.abs(moments / expected - 1.0).max() >= _SAME_MOMENTS or np.ptp(expected) <= _DISTINCT * expected[-1]:
        return 0.0
    off = float(np.linalg.norm(declared.inertia - uniform) / np.linalg.norm(uniform))
    return off if off > _OTHER_AXES else 0.0


def is_proven(model: Model, link: Link) -> bool:
    """Whether a mistake of the whole file leaves the tensor of the drawn part in this link, or shows by itself."""
    diagnosis, drawn = inertial_diagnoses(model)[link.name].diagnosis, measure_link_geometry(model, link)
    if diagnosis.unique:
        return True
    if diagnosis.mended is None or drawn is None:
        return False
    return measure_difference(diagnosis.mended, drawn) <= _PROVEN


def has_edited_masses(model: Model) -> bool:
    """Whether the masses of a file were edited and not its tensors, which then fit no unit but by chance."""
    judged = inertial_diagnoses(model)
    return shows_edited_masses(
        model,
        {name: one.declared for name, one in judged.items()},
        {name: one.diagnosis for name, one in judged.items()},
    )


def find_disputed_units(model: Model) -> dict[str, str]:
    """Return the causes (`UNIT_CAUSES`) for which links of the model fit different units, with what fits them in words; empty
    words where one unit fits some links and none fits the others.

    No program writes one link in inches and the next in centimetres, so a unit that fits one of them is a coincidence.
    """
    units: dict[str, dict[str, str]] = {}
    for name, judged in inertial_diagnoses(model).items():
        diagnosis = judged.diagnosis
        if diagnosis.sound or not diagnosis.at_fault:
            continue
        if diagnosis.cause in UNIT_CAUSES:
            units.setdefault(diagnosis.cause, {})[name] = diagnosis.detail
        elif diagnosis.cause is None and not diagnosis.fits_geometry and diagnosis.com_mismatch > FAR:
            units.setdefault("com_unit", {})[name] = "none"
    return {
        cause: ""
        if _find_common_units(links, but="none")
        else join_names(f"{n} {detail}" for n, detail in links.items())
        for cause, links in units.items()
        if set(links.values()) != {"none"} and not _find_common_units(links)
    }


def _find_common_units(links: Mapping[str, str], but: str = "") -> set[str]:
    """Return the units that fit every link, of those that do not fit ``but``."""
    return set.intersection(*(set(detail.split(" or ")) for detail in links.values() if detail != but))


@fact
def find_tensor_density(model: Model) -> tuple[float, Mapping[str, float]]:
    """Find the one density in kg/m³ at which the drawn parts have the tensors of links whose masses give other densities, and
    these links, each with that of its tensor; empty where no three different links share one.

    Each of them alone fits another mass or another decimal point.
    """
    densities, masses = {}, {}
    for name, judged in inertial_diagnoses(model).items():
        drawn, diagnosis = measure_link_geometry(model, model.link_by_name[name]), judged.diagnosis
        is_scaled = diagnosis.cause == "other_mass" or (
            diagnosis.cause == "decimal_point" and diagnosis.detail.startswith("tensor")
        )
        if drawn is not None and drawn.closed and diagnosis.at_fault and is_scaled:
            tensor = compute_solid_inertia(drawn.solid, drawn.solid.volume)
            densities[name] = float(np.trace(judged.declared.inertia) / np.trace(tensor))
            masses[name] = judged.declared.mass / drawn.solid.volume
    if not densities:
        return 0.0, {}
    median = compute_median(list(densities.values()))
    shared = {name: one for name, one in densities.items() if abs(one - median) < _SAME_DENSITY * median}
    different = {f"{masses[name]:.2g}" for name in shared}
    return (median, shared) if len(different) >= _FEWEST_DENSITIES else (0.0, {})
