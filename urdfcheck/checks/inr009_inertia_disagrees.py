"""INR009: an inertial agrees with the part that is drawn, and with its twin."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Confidence, Finding, Located, Rule, Severity, Unavailable
from urdfcheck.core.merging import alike
from urdfcheck.core.text import listed
from urdfcheck.facts.inertials.diagnosis import EXACT
from urdfcheck.facts.inertials.inertia_tensor import half_units, inertia_of, principal_moments, validity
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import Judged
from urdfcheck.model.inertials.mirrored_inertials import contradicted
from urdfcheck.model.parts import TENSOR
from urdfcheck.model.repairs.inertial_edits import Mending, from_geometry, undone
from urdfcheck.model.rigid_bodies import body_mass
from urdfcheck.model.shapes.visual_solid import geometry
from urdfcheck.source.text.xml import Attribute

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.inertials.diagnosis import Geometry

    Array = NDArray[np.float64]

# A part of a rigid body that is lighter than this share of it decides nothing about how the body moves.
LIGHT = 0.05
# A body may well be a thin shell, its hull or its box was taken because it was easier, and a piece that is only decoration
# was left out: worth knowing, and rarely harmful.
MILD = frozenset({"shell", "convex_hull", "bounding_box", "one_piece"})
# The mass may be the wrong number as well as the tensor: two edits make such an inertial agree.
EITHER = frozenset({"other_mass", "one_piece"})
# A tenth of a radius of gyration, or of a second moment, is worth saying; so are moments that differ by a third in size.
NOTABLE, SIMILAR = 0.1, 1.33
# What links may differ in that have one mistake: numbers and the repair that go beyond what the message measures.
OF_EACH = ("edit", "mismatch", "twins", "moments", "expected", "ruled_out")
# What `urdfcheck.model.likeness.mirror_pairs` knows better, because it compares the two sides' drawings.
MIRRORED = frozenset({"unmirrored"})


def check(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    """Legs that were exported alike are one finding."""
    yield from alike(rule, _each(model, rule, far, concentrated), "link", each=OF_EACH)


def _each(model: Model, rule: Rule, far: float, concentrated: float) -> Iterator[Finding]:
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
            first=doubtful[0].name,
            ruled_out=_ruled_out(model.diagnoses[doubtful[0].name]),
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
    data = _data(model, link, judged)
    exact = diagnosis.unique and mended is not None and diagnosis.cause not in EITHER
    message = "cause" if mended is None else "exact" if exact else "named"
    if mended is not None and diagnosis.by == "twin":
        message = "twin"
    elif diagnosis.cause in {"com_missing", "mesh_scale"}:
        message = diagnosis.cause
    mild = diagnosis.cause in MILD or _is_light(model, link)
    return rule.finding(
        message,
        at=_place(link, mended),
        cause=diagnosis.cause,
        edits=() if mended is None else mended.edits,
        related=[*_twins(model, judged), *_definitions(mended)],
        severity=Severity.INFO if mild else None,
        edit="" if mended is None else mended.text,
        why=_begun(rule.causes[diagnosis.cause].format_map(data)),
        **data,
    )


def _begun(sentence: str) -> str:
    """A sentence as it goes on after a colon; abbreviations keep their capitals."""
    return sentence if sentence[1].isupper() else sentence[0].lower() + sentence[1:]


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
        "twins": listed(judged.twins),
        "mass": f"{own.mass:g}",
        "moments": _listed(moments),
        "expected": "" if uniform is None else _listed(uniform),
        "measured": "" if drawn is None or uniform is None else _measured(judged, drawn, moments, uniform),
        # Not told apart by: one macro line makes many links, each with its own numbers and one mistake.
        "mismatch": {
            "tensor": diagnosis.shape,
            "com": diagnosis.place,
            "mended_tensor": diagnosis.mended_shape,
            "mended_com": diagnosis.mended_place,
        },
        "agree": "exactly" if max(diagnosis.mended_shape, diagnosis.mended_place) < EXACT else "much better",
        "ruled_out": _ruled_out(judged),
    }


def _ruled_out(judged: Judged) -> str:
    return listed(text.replace("_", " ") for text in judged.diagnosis.ruled_out)


def _twins(model: Model, judged: Judged) -> list[Link]:
    return [model.link_by_name[twin] for twin in judged.twins] if judged.diagnosis.by == "twin" else []


def _definitions(mended: Mending | None) -> Iterator[Located]:
    """Where the numbers that have to change were defined, when they are computed."""
    for place in () if mended is None else mended.places:
        if isinstance(place, Attribute):
            yield from place.related()


def _measured(judged: Judged, drawn: Geometry, moments: Array, uniform: Array) -> str:
    """How the numbers differ from those of the drawn part."""
    told = []
    apart = float(np.linalg.norm(judged.declared.com - drawn.solid.com))
    if judged.diagnosis.place > NOTABLE:
        told.append(f"its centre of mass is {_length(apart)} off")
    times = float(moments.sum() / uniform.sum())
    if not 1 / SIMILAR < times < SIMILAR:
        size = f"{times:.3g} times too large" if times > 1 else f"{1 / times:.3g} times too small"
        told.append(f"its moments of inertia are {size} for this mass at uniform density")
    elif judged.diagnosis.shape > NOTABLE:
        where = " in other directions" if np.allclose(moments, uniform, rtol=0.1) else ""
        told.append(f"its principal moments are {_listed(moments)} instead of {_listed(uniform)} kg·m²{where}")
    return " and ".join(told) or "it is little off"


def _listed(moments: Array) -> str:
    return ", ".join(f"{moment:.3g}" for moment in moments)


def _length(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"


def _is_light(model: Model, link: Link) -> bool:
    """Whether the link is a small part of a rigid body, whose motion its numbers hardly change."""
    try:
        body = model.tree.body(link.name)
    except Unavailable:
        return False
    whole = body_mass(model, body)
    mass = None if link.inertial is None else link.inertial.mass
    return len(body) > 1 and whole is not None and mass is not None and mass < LIGHT * whole


def _place(link: Link, mended: Mending | None) -> Located:
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
