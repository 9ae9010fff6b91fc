"""INR009: an inertial agrees with the part that is drawn, and with its twin."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.facts.diagnosis import EXACT
from urdfcheck.facts.inertia import half_units, inertia_of, principal_moments, validity
from urdfcheck.model import Link, Model
from urdfcheck.model.body import body_mass
from urdfcheck.model.diagnoses import Judged
from urdfcheck.model.drawn import geometry
from urdfcheck.model.mending import from_geometry, undone
from urdfcheck.model.names import listed
from urdfcheck.model.parts import TENSOR
from urdfcheck.model.twin_inertials import contradicted

# A part of a rigid body that is lighter than this share of it decides nothing about how the body moves.
LIGHT = 0.05
# A body may well be a thin shell, and its hull or its box was taken because it was easier: worth knowing, and rarely harmful.
MILD = frozenset({"shell", "convex_hull", "bounding_box"})
# The mass may be the wrong number as well as the tensor: two edits make such an inertial agree.
EITHER = frozenset({"other_mass"})
# What `urdfcheck.model.twins` knows better, because it compares the two sides' drawings.
MIRRORED = frozenset({"unmirrored"})


def check(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    doubtful: list[Link] = []
    contradicted_links = contradicted(model)
    for name, judged in model.diagnoses.items():
        link, diagnosis = model.link_by_name[name], judged.diagnosis
        if diagnosis.sound or not diagnosis.decided or not _valid(judged):
            continue
        if diagnosis.cause is not None:
            by_twin, unmirrored = diagnosis.by == "twin", diagnosis.cause in MIRRORED
            if by_twin + unmirrored + (name in contradicted_links) < 2:
                yield _explained(model, rule, link, judged)
        elif diagnosis.by == "mesh" and diagnosis.possible and max(diagnosis.shape, diagnosis.place) > far:
            if diagnosis.place <= far and _rounds_to(model, link, judged):
                continue
            if diagnosis.least > concentrated or _is_light(model, link):
                doubtful.append(link)
            else:
                yield _unexplained(model, rule, link, judged)
    if doubtful:
        yield rule.finding(
            "doubtful",
            at=_place(doubtful[0], None),
            related=[_place(link, None) for link in doubtful[1:]],
            severity=Severity.INFO,
            confidence=Confidence.HEURISTIC,
            links=listed(link.name for link in doubtful),
        )


def _valid(judged: Judged) -> bool:
    """Whether a body can have the tensor: else INR003 and INR004 report it, with the cause found here."""
    found = validity(judged.declared.tensor)
    return found.positive_definite and found.triangle


def _rounds_to(model: Model, link: Link, judged: Judged) -> bool:
    """Whether the drawn part's own tensor, rounded to the digits that were typed, is the declared one: 0.01, 0.01 and 0.02 are
    those of a plate without thickness, and of a thick one to one digit."""
    own, drawn = judged.declared, geometry(model, link)
    assert link.inertial is not None
    element = link.inertial.tensor_element
    if drawn is None or element is None:
        return False
    uniform = own.rotation.T @ inertia_of(drawn.solid, own.mass) @ own.rotation
    rows, columns = np.triu_indices(3)
    halves = np.array(half_units([element.get(name) for name in TENSOR]))
    halves[halves == 0.0] = halves.max()  # a zero was rounded like its neighbours
    return bool((np.abs(own.tensor - uniform)[rows, columns] <= halves).all())


def _explained(model: Model, rule: Rule, link: Link, judged: Judged) -> Finding:
    diagnosis = judged.diagnosis
    assert link.inertial is not None
    assert diagnosis.cause is not None
    mended = undone(model, link)
    exact = diagnosis.unique and mended is not None and diagnosis.cause not in EITHER
    message = ("twin" if diagnosis.by == "twin" else "exact" if exact else "named") if mended is not None else "cause"
    mild = diagnosis.cause in MILD or _is_light(model, link)
    return rule.finding(
        message,
        at=_place(link, diagnosis.cause),
        cause=diagnosis.cause,
        edits=() if mended is None else mended.edits,
        related=[model.link_by_name[twin] for twin in judged.twins] if diagnosis.by == "twin" else [],
        severity=Severity.INFO if mild else None,
        edit="" if mended is None else mended.text,
        **_data(model, link, judged),
    )


def _unexplained(model: Model, rule: Rule, link: Link, judged: Judged) -> Finding:
    mended = from_geometry(model, link)
    return rule.finding(
        "disagrees",
        at=_place(link, None),
        edits=() if mended is None else mended.edits,
        edit="" if mended is None else mended.text,
        **_data(model, link, judged),
    )


def _data(model: Model, link: Link, judged: Judged) -> dict[str, Any]:
    own, diagnosis = judged.declared, judged.diagnosis
    drawn = geometry(model, link)
    moments, _ = principal_moments(own.inertia)
    uniform = None if drawn is None else principal_moments(inertia_of(drawn.solid, own.mass))[0]
    return {
        "link": link.name,
        "detail": diagnosis.detail,
        "twins": ", ".join(judged.twins),
        "mass": own.mass,
        "moments": ", ".join(f"{m:.3g}" for m in moments),
        "expected": "" if uniform is None else ", ".join(f"{m:.3g}" for m in uniform),
        "shape": diagnosis.shape,
        "place": diagnosis.place,
        "mended_shape": diagnosis.mended_shape,
        "mended_place": diagnosis.mended_place,
        "agree": "exactly" if max(diagnosis.mended_shape, diagnosis.mended_place) < EXACT else "much better",
        "ruled_out": listed(text.replace("_", " ") for text in diagnosis.ruled_out),
    }


def _is_light(model: Model, link: Link) -> bool:
    """Whether the link is a small part of a rigid body, whose motion its numbers hardly change."""
    body = model.tree.body(link.name)
    whole = body_mass(model, body)
    mass = None if link.inertial is None else link.inertial.mass
    return len(body) > 1 and whole is not None and mass is not None and mass < LIGHT * whole


def _place(link: Link, cause: str | None) -> Any:
    """The text that has to change."""
    inertial = link.inertial
    assert inertial is not None
    if cause == "mass_unit" and inertial.mass_attribute is not None:
        return inertial.mass_attribute
    if cause in {"com_unit", "com_missing"} and inertial.origin.element is not None:
        return inertial.origin.element
    return inertial.tensor_element or inertial.element
