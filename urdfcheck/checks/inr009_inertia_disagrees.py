"""INR009 reports inertials that disagree with the drawn part or with its mirror image."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Confidence, FactUnavailableError, Finding, Located, Rule, Severity
from urdfcheck.core.merging import merge_identical
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.diagnosis import EXACT
from urdfcheck.facts.inertials.inertia_tensor import (
    check_inertia_validity,
    compute_principal_moments,
    compute_solid_inertia,
    list_half_units,
)
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.mirrored_inertials import find_contradicted_links
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.model.repairs.inertial_edits import InertialRepair, propose_from_geometry, propose_undo
from urdfcheck.model.rigid_bodies import compute_body_mass
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.xml import Attribute

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.inertials.diagnosis import VisualGeometry

    Array = NDArray[np.float64]

# A part of a rigid body that is lighter than this share of it decides nothing about how the body moves.
LIGHT = 0.05
# A body may well be a thin shell, its hull or its box was taken because it was easier, and a piece that is only decoration
# was left out: worth knowing, and rarely harmful.
MILD_CAUSES = frozenset({"shell", "convex_hull", "bounding_box", "one_piece"})
# The mass may be the wrong number as well as the tensor: two edits make such an inertial agree.
AMBIGUOUS_CAUSES = frozenset({"other_mass", "one_piece"})
# A tenth of a radius of gyration, or of a second moment, is worth saying; so are moments that differ by a third in size.
NOTABLE, SIMILAR = 0.1, 1.33
# What links may differ in that have one mistake: numbers and the repair that go beyond what the message measures.
PER_LINK_DATA = ("edit", "mismatch", "twins", "moments", "expected", "ruled_out")
# What `urdfcheck.model.likeness.mirror_pairs` knows better, because it compares the two sides' drawings.
MIRROR_CAUSES = frozenset({"unmirrored"})


def check(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    """Legs that were exported alike are one finding."""
    yield from merge_identical(rule, _check_each_link(model, rule, far, concentrated), "link", varying=PER_LINK_DATA)


def _check_each_link(model: Model, rule: Rule, far: float, concentrated: float) -> Iterator[Finding]:
    doubtful: list[Link] = []
    contradicted_links = find_contradicted_links(model)
    for name, judged in inertial_diagnoses(model).items():
        link, diagnosis = model.link_by_name[name], judged.diagnosis
        if diagnosis.sound or not diagnosis.decided or not _is_valid_inertia(judged):
            continue
        if diagnosis.cause is not None:
            by_twin, unmirrored = diagnosis.by == "twin", diagnosis.cause in MIRROR_CAUSES
            if by_twin + unmirrored + (name in contradicted_links) < 2:
                yield _build_cause_finding(model, rule, link, judged)
        elif (
            diagnosis.by == "mesh"
            and diagnosis.possible
            and max(diagnosis.tensor_mismatch, diagnosis.com_mismatch) > far
        ):
            if diagnosis.com_mismatch <= far and _is_rounded_uniform(model, link, judged):
                continue
            if diagnosis.min_moment_ratio > concentrated or _is_light(model, link):
                doubtful.append(link)
            else:
                yield _build_mismatch_finding(model, rule, link, judged)
    if doubtful:
        yield rule.finding(
            "doubtful",
            at=_locate(doubtful[0], None),
            related=[_locate(link, None) for link in doubtful[1:]],
            severity=Severity.INFO,
            confidence=Confidence.HEURISTIC,
            links=join_names(link.name for link in doubtful),
            first=doubtful[0].name,
            ruled_out=_format_ruled_out(inertial_diagnoses(model)[doubtful[0].name]),
        )


def _is_valid_inertia(judged: DiagnosedInertial) -> bool:
    """Whether a body can have the tensor: else INR003 and INR004 report it, with the cause found here."""
    found = check_inertia_validity(judged.declared.tensor)
    return found.positive_definite and found.triangle_inequality


def _is_rounded_uniform(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the drawn part's own tensor, rounded to the digits that were typed, is the declared one: 0.01, 0.01 and 0.02 are
    those of a plate without thickness, and of a thick one to one digit."""
    own, drawn = judged.declared, measure_link_geometry(model, link)
    assert link.inertial is not None
    element = link.inertial.tensor_element
    if drawn is None or element is None:
        return False
    uniform = own.rotation.T @ compute_solid_inertia(drawn.solid, own.mass) @ own.rotation
    rows, columns = np.triu_indices(3)
    halves = np.array(list_half_units([element.get(name) for name in TENSOR_NAMES]))
    halves[halves == 0.0] = halves.max()  # a zero was rounded like its neighbours
    return bool((np.abs(own.tensor - uniform)[rows, columns] <= halves).all())


def _build_cause_finding(model: Model, rule: Rule, link: Link, judged: DiagnosedInertial) -> Finding:
    diagnosis = judged.diagnosis
    assert link.inertial is not None
    assert diagnosis.cause is not None
    mended = propose_undo(model, link)
    data = _collect_data(model, link, judged)
    exact = diagnosis.unique and mended is not None and diagnosis.cause not in AMBIGUOUS_CAUSES
    message = "cause" if mended is None else "exact" if exact else "named"
    if mended is not None and diagnosis.by == "twin":
        message = "twin"
    elif diagnosis.cause in {"com_missing", "mesh_scale"}:
        message = diagnosis.cause
    mild = diagnosis.cause in MILD_CAUSES or _is_light(model, link)
    return rule.finding(
        message,
        at=_locate(link, mended),
        cause=diagnosis.cause,
        edits=() if mended is None else mended.edits,
        related=[*_list_twins(model, judged), *_iter_definitions(mended)],
        severity=Severity.INFO if mild else None,
        edit="" if mended is None else mended.text,
        why=_lower_first_letter(rule.causes[diagnosis.cause].format_map(data)),
        **data,
    )


def _lower_first_letter(sentence: str) -> str:
    """A sentence as it goes on after a colon; abbreviations keep their capitals."""
    return sentence if sentence[1].isupper() else sentence[0].lower() + sentence[1:]


def _build_mismatch_finding(model: Model, rule: Rule, link: Link, judged: DiagnosedInertial) -> Finding:
    mended = propose_from_geometry(model, link)
    return rule.finding(
        "disagrees",
        at=_locate(link, None),
        edits=() if mended is None else mended.edits,
        edit="" if mended is None else mended.text,
        **_collect_data(model, link, judged),
    )


def _collect_data(model: Model, link: Link, judged: DiagnosedInertial) -> dict[str, Any]:
    own, diagnosis = judged.declared, judged.diagnosis
    drawn = measure_link_geometry(model, link)
    moments, _ = compute_principal_moments(own.inertia)
    uniform = None if drawn is None else compute_principal_moments(compute_solid_inertia(drawn.solid, own.mass))[0]
    return {
        "link": link.name,
        "detail": diagnosis.detail,
        "twins": join_names(judged.twins),
        "mass": f"{own.mass:g}",
        "moments": _format_moments(moments),
        "expected": "" if uniform is None else _format_moments(uniform),
        "measured": "" if drawn is None or uniform is None else _describe_mismatch(judged, drawn, moments, uniform),
        # Not told apart by: one macro line makes many links, each with its own numbers and one mistake.
        "mismatch": {
            "tensor": diagnosis.tensor_mismatch,
            "com": diagnosis.com_mismatch,
            "mended_tensor": diagnosis.mended_tensor_mismatch,
            "mended_com": diagnosis.mended_com_mismatch,
        },
        "agree": "exactly"
        if max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch) < EXACT
        else "much better",
        "ruled_out": _format_ruled_out(judged),
    }


def _format_ruled_out(judged: DiagnosedInertial) -> str:
    return join_names(text.replace("_", " ") for text in judged.diagnosis.ruled_out)


def _list_twins(model: Model, judged: DiagnosedInertial) -> list[Link]:
    return [model.link_by_name[twin] for twin in judged.twins] if judged.diagnosis.by == "twin" else []


def _iter_definitions(mended: InertialRepair | None) -> Iterator[Located]:
    """Where the numbers that have to change were defined, when they are computed."""
    for place in () if mended is None else mended.places:
        if isinstance(place, Attribute):
            yield from place.collect_definitions()


def _describe_mismatch(judged: DiagnosedInertial, drawn: VisualGeometry, moments: Array, uniform: Array) -> str:
    """How the numbers differ from those of the drawn part."""
    told = []
    apart = float(np.linalg.norm(judged.declared.com - drawn.solid.com))
    if judged.diagnosis.com_mismatch > NOTABLE:
        told.append(f"its centre of mass is {_format_length(apart)} off")
    times = float(moments.sum() / uniform.sum())
    if not 1 / SIMILAR < times < SIMILAR:
        size = f"{times:.3g} times too large" if times > 1 else f"{1 / times:.3g} times too small"
        told.append(f"its moments of inertia are {size} for this mass at uniform density")
    elif judged.diagnosis.tensor_mismatch > NOTABLE:
        where = " in other directions" if np.allclose(moments, uniform, rtol=0.1) else ""
        told.append(
            f"its principal moments are {_format_moments(moments)} instead of {_format_moments(uniform)} kg·m²{where}"
        )
    return " and ".join(told) or "it is little off"


def _format_moments(moments: Array) -> str:
    return ", ".join(f"{moment:.3g}" for moment in moments)


def _format_length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"


def _is_light(model: Model, link: Link) -> bool:
    """Whether the link is a small part of a rigid body, whose motion its numbers hardly change."""
    try:
        body = model.tree.list_body_links(link.name)
    except FactUnavailableError:
        return False
    whole = compute_body_mass(model, body)
    mass = None if link.inertial is None else link.inertial.mass
    return len(body) > 1 and whole is not None and mass is not None and mass < LIGHT * whole


def _locate(link: Link, mended: InertialRepair | None) -> Located:
    """The narrowest text that holds what has to change; the tensor where that is not known."""
    inertial = link.inertial
    assert inertial is not None
    tensor = inertial.tensor_element or inertial.element
    places = [place for place in (() if mended is None else mended.places) if place is not None]
    if not places:
        return tensor
    if len(places) == 1:
        return places[0]
    if all(isinstance(place, Attribute) and place.owner is tensor for place in places):
        return tensor
    return inertial.element
