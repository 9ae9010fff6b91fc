"""What is wrong with the inertial of one link, judged by all that it may be meant to draw."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from urdfcheck.facts.inertials.certainty import EXACT
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.diagnosis import Diagnosis, diagnose_inertial, find_close_match, measure_evidence
from urdfcheck.facts.inertials.mistakes.file_habits import Evidence, Habit
from urdfcheck.model.inertials.diagnosis.geometry_readings import list_geometry_readings
from urdfcheck.model.inertials.diagnosis.inertial_references import InertialReference
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import (
    explain_collision_stand_in,
    integrate_open_meshes,
    measure_link_geometry,
    measure_role_geometry,
    split_visual_bodies,
)

# A COM this near the mesh's, in radii of gyration, is that of a part of uniform density.
_NEAR_COM = 0.05
# A COM that is so much nearer to one shape than to another, as a share of its distance, belongs to the former.
_MUCH_NEARER = 1.0 / 3.0
# Moments that are within 2 % of those of a shape were computed from it; second moments differ by twice that.
_COMPUTED = 0.04
# A collision shape that is rotated or moved like the inertial has the same mistake.
_OF_PLACE = frozenset({"axes_permuted", "quarter_turn", "unmirrored", "rpy_missing", "rpy_twice", "com_missing"})


def diagnose_link(
    model: Model,
    link: Link,
    *,
    declared: DeclaredInertial,
    reference: InertialReference | None,
    habit: Habit | None = None,
) -> Diagnosis | None:
    """Diagnose one link, in a file with a ``habit`` if that is known.

    None where what is drawn is not known, or where two ways to read it lead to different causes.
    """
    twin, trusted = (None, False) if reference is None else (reference.numbers, reference.trusted)
    diagnoses: list[Diagnosis] = []
    for reading in list_geometry_readings(model, link):
        diagnosis = diagnose_inertial(declared, reading, twin, trusted=trusted, habit=habit)
        diagnoses += [] if diagnosis is None else [diagnosis]
        if diagnosis is not None and diagnosis.sound:
            break
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return diagnose_inertial(declared, None, twin, trusted=trusted)
    if not diagnoses or (not diagnoses[-1].sound and len({d.cause for d in diagnoses}) > 1):
        return None
    best = diagnoses[-1] if diagnoses[-1].sound else diagnoses[0]
    if not best.sound and best.judged_by == "mesh" and not drawn.closed:
        for solid in integrate_open_meshes(model, link):  # the hull is not the part; the inside of the mesh may be
            inside = VisualGeometry(solid=solid, closed=True, points=drawn.points)
            if own := find_close_match(declared, inside, EXACT):
                return own
    if not best.sound and best.cause not in _OF_PLACE and (own := _match_collision_shape(model, link, declared)):
        return own
    if best.cause == "com_missing" and _has_visual_about_com(model, link, declared):
        return None  # the collision shape is elsewhere, not the COM
    # Whether the tensors of an assembly's parts were added shows only when its mesh is taken apart.
    explained = best.sound if best.com_mismatch > _NEAR_COM else best.tensor_mismatch < EXACT
    is_habit = habit is not None and habit.is_like(best.cause or "", best.detail)
    if explained or (best.cause is not None and (best.unique or is_habit)):
        return best
    parts = split_visual_bodies(model, link)
    if len(parts) < 2:
        return best
    taken_apart = diagnose_inertial(declared, replace(drawn, pieces=parts), twin, trusted=trusted, habit=habit)
    return taken_apart if taken_apart is not None and taken_apart.cause is not None else best


def measure_link_evidence(model: Model, link: Link, declared: DeclaredInertial) -> Evidence | None:
    """Measure how well the mistakes that a whole file may have fit one link; None where what is drawn is not known."""
    measured = [
        one
        for reading in list_geometry_readings(model, link)
        if (one := measure_evidence(declared, reading)) is not None
    ]
    return max(measured, key=lambda one: one.sound) if measured else None


def _has_visual_about_com(model: Model, link: Link, declared: DeclaredInertial) -> bool:
    """Whether the COM is much nearer to an open visual mesh than to the collision shape that is compared in its place."""
    if explain_collision_stand_in(model, link) != "open":
        return False
    visible, collision = (measure_role_geometry(model, link, role) for role in ("visual", "collision"))
    if visible is None or collision is None:
        return False
    near, far = (float(np.linalg.norm(declared.com - drawn.solid.com)) for drawn in (visible, collision))
    return near < _MUCH_NEARER * far


def _match_collision_shape(model: Model, link: Link, declared: DeclaredInertial) -> Diagnosis | None:
    """Return the verdict on numbers that were computed from the collision shapes of a link, which may well have another form
    than what it draws; None where tensor or COM are not theirs, or their density is that of no part."""
    collision = measure_role_geometry(model, link, "collision")
    if collision is None or not collision.closed:
        return None
    return find_close_match(declared, collision, _COMPUTED)
