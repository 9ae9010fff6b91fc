"""What undoes the mistake that was found in an ``<inertial>``, and how certain that is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from urdfcheck.core import FactUnavailableError, Span
from urdfcheck.facts.inertials.certainty import EXACT, UNIFORM
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import Diagnosis, diagnose_inertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance, compute_solid_inertia
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.proposals.com_places import has_com_of_shell
from urdfcheck.model.inertials.proposals.inertial_texts import describe_own_call, links_by_inertial_text
from urdfcheck.model.likeness.mirror_pairs import list_named_pairs
from urdfcheck.model.parts import Link
from urdfcheck.model.repairs.inertial_edits import InertialRepair, build_inertial_repair
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# Causes after which the file does not show which number is right, or whose numbers come from the mesh.
_UNDECIDED_CAUSES = frozenset(
    {"other_mass", "one_piece", "mesh_frame", "shell", "bounding_box", "convex_hull", "com_missing", "mesh_scale"}
)
# Units: all links of a file have the same.
_UNIT_CAUSES = frozenset({"inertia_unit", "mass_unit", "com_unit", "units"})
# The undone mistake must leave no more than this part of the mismatch, and no more than lumps of a third of the mass make.
_REMAINING, LARGEST_SOUND_MISMATCH = 0.3, 0.75
# Another decimal point brings one number near the part's by chance: of 1,200 lumped parts of which one moment was multiplied by
# any factor from 1/2000 to 2000, 12 % fit one with a mismatch below 0.75, and 2.4 % below 0.3; of those with a slip 57 % do.
_LONE_NUMBER = 0.3
# What tessellation leaves of a part's second moments, and the most that pieces which a mesh does not show one by one add.
_FACETS, _MORE_PIECES = 0.005, 0.15
# A COM that is moved must get nearer to the drawn part's than this part of its distance, or of the part's size; farther outside
# the part than that, INR006 reports it.
_FAR_COM = 0.1


def propose_undo(model: Model, link: Link) -> InertialRepair | None:
    """Propose what undoes the mistake that was found in a link's inertial.

    None where no mistake is certain, or it is not in the inertial. Without edits where the evidence is weak, and where a macro
    wrote the same text for other links, in which this mistake was not found.
    """
    diagnosed, inertial = inertial_diagnoses(model).get(link.name), link.inertial
    if diagnosed is None or inertial is None or diagnosed.diagnosis.mended is None:
        return None
    if diagnosed.diagnosis.cause == "shell" and has_com_of_shell(model, link):
        return None  # the part may be hollow: then all of its numbers are right
    change = build_inertial_repair(inertial, _complete_term(model, link, diagnosed) or diagnosed.diagnosis.mended)
    if not change.text or _leaves_com_off(model, link, diagnosed):
        return None
    is_certain = (
        not diagnosed.diagnosis.com_order  # two mistakes, and only the numbers of one of them are proven
        and is_evident(diagnosed.diagnosis)
        and _has_same_mistake(model, inertial.element.span)
        and not _contradicts_twins(model, link, diagnosed)
        and not _is_lone_unit(model, diagnosed)
        and not _is_of_either_side(model, link, diagnosed)
        and not any(_leaves_mistake(model, name) for name in _list_links_to_mend(model, link, diagnosed))
    )
    change = replace(change, where=describe_own_call(model, link, change))
    return change if is_certain else replace(change, edits=())


def _complete_term(model: Model, link: Link, diagnosed: DiagnosedInertial) -> DeclaredInertial | None:
    """Return the numbers of the drawn part, where a tensor lacks the parallel-axis term of more pieces than its mesh shows: the
    COM is the uniform part's, and what is left once the term is added is such a term, too. None elsewhere."""
    diagnosis, drawn = diagnosed.diagnosis, measure_link_geometry(model, link)
    if diagnosis.cause != "steiner_missing" or diagnosis.mended is None or drawn is None or not drawn.closed:
        return None
    if diagnosis.detail or diagnosis.com_mismatch > UNIFORM:
        return None
    declared, solid = diagnosed.declared, drawn.solid
    left = solid.covariance - compute_mass_covariance(diagnosis.mended.inertia, declared.mass)
    size = float(np.trace(solid.covariance))
    is_of_pieces = float(np.linalg.eigvalsh(left)[0]) > -_FACETS * size
    if not is_of_pieces or not _FACETS * size < float(np.trace(left)) < _MORE_PIECES * size:
        return None
    uniform = compute_solid_inertia(solid, declared.mass)
    return replace(declared, tensor=declared.rotation.T @ uniform @ declared.rotation)


@fact
def _leaves_mistake(model: Model, name: str) -> bool:
    """Whether a link's numbers without the mistake show another one, or are those of no mass inside the drawn part: the link
    would be reported again."""
    drawn, diagnosis = measure_link_geometry(model, model.link_by_name[name]), inertial_diagnoses(model)[name].diagnosis
    if drawn is None or diagnosis.mended is None or diagnosis.judged_by == "twin":
        return False
    left = diagnose_inertial(diagnosis.mended, drawn)
    return left is not None and not left.sound and (left.cause is not None or not left.fits_geometry)


def has_mistake(model: Model, link: Link, cause: str) -> bool:
    """Whether this mistake (a cause of INR009) was found in the inertial of a link."""
    return identify_mistake(model, link)[0] == cause


def identify_mistake(model: Model, link: Link) -> tuple[str | None, str]:
    """Return the mistake (a cause of INR009) found in the inertial of a link, and its detail; None and "" without one."""
    diagnosed = inertial_diagnoses(model).get(link.name)
    return (None, "") if diagnosed is None else (diagnosed.diagnosis.cause, diagnosed.diagnosis.detail)


def _leaves_com_off(model: Model, link: Link, diagnosed: DiagnosedInertial) -> bool:
    """Whether a repair moves the COM to a place that is far from the drawn part's and not much nearer, or farther than before; by
    the twin, outside the drawn part: then the twin's is not right either."""
    drawn, mended = measure_link_geometry(model, link), diagnosed.diagnosis.mended
    if drawn is None or mended is None:
        return False
    if diagnosed.diagnosis.judged_by == "twin":
        return measure_hull_distance(drawn.points, mended.com) > _FAR_COM * measure_extent(drawn.points)
    if diagnosed.diagnosis.judged_by != "mesh":
        return False
    before, after = (float(np.linalg.norm(com - drawn.solid.com)) for com in (diagnosed.declared.com, mended.com))
    is_moved = float(np.linalg.norm(mended.com - diagnosed.declared.com)) > 0.0
    is_worse = drawn.closed and after > before
    return is_moved and (is_worse or after > _FAR_COM * max(before, measure_extent(drawn.points)))


def is_evident(diagnosis: Diagnosis) -> bool:
    """Whether the named mistake is so certain that undoing it is offered as an edit.

    It is where the numbers without it are those of the drawn part or the twin. Otherwise it must be the mistake that makes most
    of the mismatch, and leave a part that may well be; a decimal point of the tensor has to leave one that is nearly uniform.
    """
    if diagnosis.cause in _UNDECIDED_CAUSES:
        return False
    if diagnosis.unique or diagnosis.judged_by == "twin":
        return True
    before, after = diagnosis.tensor_mismatch, diagnosis.mended_tensor_mismatch
    if diagnosis.mended_com_mismatch != diagnosis.com_mismatch:
        before, after = max(before, diagnosis.com_mismatch), max(after, diagnosis.mended_com_mismatch)
    is_of_tensor = diagnosis.cause == "decimal_point" and not diagnosis.detail.startswith("com ")
    most = _LONE_NUMBER if is_of_tensor else LARGEST_SOUND_MISMATCH
    return after < most and after < _REMAINING * before


def _list_links_to_mend(model: Model, link: Link, diagnosed: DiagnosedInertial) -> list[str]:
    """List the links that are repaired together: where most links of a file are in another unit, these, and else one alone."""
    if not diagnosed.is_habit or diagnosed.diagnosis.cause not in _UNIT_CAUSES:
        return [link.name]
    return [name for name, one in inertial_diagnoses(model).items() if one.is_habit]


def _is_lone_unit(model: Model, diagnosed: DiagnosedInertial) -> bool:
    """Whether a unit was found in one link alone, and the numbers in that unit are not exactly the drawn part's: no program
    writes one link of a file in another unit."""
    diagnosis = diagnosed.diagnosis
    is_exact = max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch) < EXACT
    if is_exact or diagnosed.is_habit or diagnosis.judged_by == "twin" or diagnosis.cause not in _UNIT_CAUSES:
        return False
    numbers = {(one.declared.mass, *one.declared.tensor.ravel()) for one in inertial_diagnoses(model).values()}
    with_unit = {
        (one.declared.mass, *one.declared.tensor.ravel())
        for one in inertial_diagnoses(model).values()
        if one.diagnosis.cause == diagnosis.cause
    }
    return len(numbers) > len(with_unit) == 1


def _is_of_either_side(model: Model, link: Link, diagnosed: DiagnosedInertial) -> bool:
    """Whether a decimal point may also have slipped in the twin: the numbers that the twin has are not sound for the drawing,
    so that it does not say which side is right."""
    diagnosis, drawn = diagnosed.diagnosis, measure_link_geometry(model, link)
    if diagnosis.judged_by != "twin" or diagnosis.cause != "decimal_point" or diagnosis.mended is None:
        return False
    of_twin = None if drawn is None else diagnose_inertial(diagnosis.mended, drawn)
    return of_twin is None or not of_twin.sound


def _contradicts_twins(model: Model, link: Link, diagnosed: DiagnosedInertial) -> bool:
    """Whether undoing a mistake may make two parts differ that are drawn alike, where the other does not have the mistake, or
    that are left and right, where what is wrong with the other is not known."""
    diagnosis, judged = diagnosed.diagnosis, inertial_diagnoses(model)
    if diagnosis.judged_by == "twin":
        return False
    sides = [judged[other].diagnosis for other in _list_other_sides(model, link) if other in judged]
    if any(side.cause is None and not side.sound for side in sides):
        return True
    return any(identify_mistake(model, model.link_by_name[twin])[0] != diagnosis.cause for twin in diagnosed.twins)


def _list_other_sides(model: Model, link: Link) -> list[str]:
    """List the links whose names differ from that of a link in nothing but the side."""
    try:
        pairs = list_named_pairs(model)
    except FactUnavailableError:
        return []
    return [other for pair in pairs for one, other in (pair, pair[::-1]) if one == link.name]


@fact
def _has_same_mistake(model: Model, text: Span | None) -> bool:
    """Whether one mistake was found in all links whose inertials are one text."""
    return len({identify_mistake(model, link) for link in links_by_inertial_text(model)[text]}) == 1
