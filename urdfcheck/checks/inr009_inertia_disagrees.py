"""INR009 reports inertials that disagree with the drawn part or with its mirror image."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Confidence, FactUnavailableError, Finding, Located, Rule, Severity
from urdfcheck.core.merging import build_group_finding, merge_identical
from urdfcheck.core.text import format_length, join_names, join_numbers
from urdfcheck.facts.inertials.certainty import EXACT, FAR, VAST
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import (
    check_inertia_validity,
    compute_mass_covariance,
    compute_principal_moments,
    compute_solid_inertia,
    list_half_units,
)
from urdfcheck.facts.inertials.materials import DENSEST
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model import DeclaredTensor, Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.inertial_proposals import (
    describe_drawn_inertial,
    describe_mistake,
    name_mistake,
    propose_undo,
)
from urdfcheck.model.inertials.mirrored_inertials import find_contradicted_links
from urdfcheck.model.repairs.inertial_edits import InertialRepair
from urdfcheck.model.rigid_bodies import compute_body_mass
from urdfcheck.model.shapes.visual_solid import (
    describe_geometry_source,
    explain_collision_stand_in,
    has_loose_hull,
    has_up_axis_ambiguity,
    measure_link_geometry,
)
from urdfcheck.source.text.xml import Attribute

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
    from urdfcheck.facts.inertials.diagnosis import Diagnosis

    Moments = NDArray[np.floating[Any]]

# A part of a rigid body that is lighter than this share of it hardly changes how the body moves.
LIGHT = 0.05
# The body may be a thin shell, its hull or box may have been easier to compute, and a decorative piece may have been left out:
# such causes are worth knowing and rarely harmful. So is rounding, which leaves a possible tensor here.
MILD_CAUSES = frozenset({"shell", "convex_hull", "bounding_box", "one_piece", "rounded"})
# Causes after which the numbers come from the drawn part, so that they agree with it by construction.
_FROM_DRAWING = MILD_CAUSES | {"own_missing", "com_missing"}
# What agrees where the pieces of a part were taken for points.
_POINTLIKE = "the tensor is the drawn part's: what is written is the parallel-axis terms of its bodies, to within 5 %"
# What a program gets wrong in all links of a model alike.
UNIT_CAUSES = frozenset({"com_unit", "mass_unit", "inertia_unit"})
_OF_ALL_LINKS = UNIT_CAUSES | {"units"}
# Either the mass or the tensor may be the wrong number: two different edits make such an inertial agree.
AMBIGUOUS_CAUSES = frozenset({"other_mass", "one_piece"})
# What typed digits and tessellation leave of equal numbers.
DIGITS = 0.01
# A tenth of a radius of gyration, or of a second moment, is worth saying; so are moments that differ by a third in size.
NOTABLE, SIMILAR = 0.1, 1.33
# Moments so many times too small are those of a part of a tenth of the size.
_TINY = 100.0
# All second moments below this part of the drawn part's are those of a smaller part.
_MUCH_LESS = 0.25
# A tensor so many times farther off than its principal moments is about other axes.
_ROTATED = 1.5
# Two fifths of the mass in a motor make a tensor differ by less from that of the drawn part (a share of its norm).
_LUMPED = 0.4
# The tensor that is left may differ by this share from the drawn part's where a mistake of the whole file is edited.
_PROVEN = 0.1
# A correction that changes the tensor by less than this part of it, and the COM by less than this part of the drawn part, or by
# less than these metres, is worth an info: a motor or a cover changes as much.
SLIGHT, SLIGHT_LENGTH = 0.05, 5e-3
# Principal moments that agree in this share, of a part with its COM where it is drawn, are those of the part; moments that
# differ by less than this share of the largest do not show their axes. The tensor differs by this share at least.
_SAME_MOMENTS, _DISTINCT, _OTHER_AXES = 0.02, 0.1, 0.1
# Causes that make a tensor too large or too small as a whole.
SIZE_CAUSES = frozenset(
    {
        *(
            "inertia_unit",
            "about_origin",
            "positive_notation",
            "steiner_twice",
            "steiner_missing",
            "own_missing",
            "other_mass",
        ),
        *("wrong_formula", *MILD_CAUSES),
    },
)
# What a headline calls the numbers that are wrong; for any other cause, the inertia.
FAULTY_NUMBERS = {
    "mass_unit": "mass",
    "com_unit": "COM",
    "units": "units",
    "decimal_point": "number",
    "quarter_turn": "COM and inertia",
    "unmirrored": "COM and inertia",
}
# A cause in the few words of a headline.
SHORT_CAUSES = {
    "inertia_unit": "{detail}, not kg·m²",
    "mass_unit": "{detail}, not kg",
    "com_unit": "{detail}, not m",
    "units": "{detail}",
    "about_origin": "about the origin, not the COM",
    "positive_notation": "at the origin, CAD signs",
    "steiner_twice": "parallel-axis term twice",
    "steiner_missing": "no parallel-axis term",
    "own_missing": "own tensors of the pieces left out",
    "one_piece": "of one piece only",
    "products_sign": "products have flipped signs",
    "axes_permuted": "its x y z are {detail}",
    "slots_swapped": "{detail} swapped",
    "slots_shifted": "{detail}",
    "quarter_turn": "rotated by {detail}",
    "unmirrored": "not mirrored",
    "rpy_missing": "rpy left out",
    "rpy_twice": "rpy applied twice",
    "diagonal_first": "diagonal typed first",
    "row_major": "matrix typed row by row",
    "one_sign": "sign of {detail} flipped",
    "decimal_point": "decimal point off: {detail}×",
    "rounded": "rounded to {detail}",
    "wrong_formula": "of {detail}",
    "shell": "of a hollow shell",
    "bounding_box": "of the bounding box",
    "convex_hull": "of the convex hull",
    "other_mass": "fits {detail}",
}
# Links with one mistake may differ in these data: the repair, and numbers that the message does not measure.
PER_LINK_DATA = ("edit", "mismatch", "twins", "moments", "expected", "ruled_out")
# `urdfcheck.model.likeness.mirror_pairs` is the better judge of these: it compares the drawings of the two sides.
MIRROR_CAUSES = frozenset({"unmirrored"})


def check(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    # Legs with the same mistake are one finding.
    findings = _check_each_link(model, rule, far=far, concentrated=concentrated)
    yield from merge_identical(rule, findings, "link", varying=PER_LINK_DATA)


def _check_each_link(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    doubtful: list[DeclaredTensor] = []
    habitual = _list_habitual_links(model)
    pointlike = _list_pointlike_links(model)
    for group in (habitual, pointlike):
        if group:
            yield _build_habit_finding(model, rule, group)
    grouped = {link.name for link in (*habitual, *pointlike)}
    rotated = _find_rotated_tensors(model)
    for name in rotated:
        yield _build_axes_finding(model, rule, name, rotated)
    contradicted_links = find_contradicted_links(model)
    disputed = _find_disputed_units(model)
    for name, judged in inertial_diagnoses(model).items():
        tensor, diagnosis = model.tensor_by_name[name], judged.diagnosis
        if diagnosis.sound or not diagnosis.at_fault or not _is_possible(judged) or name in grouped:
            continue
        if name in rotated or (judged.is_habit and not _shows_habit_alone(model, tensor.link, diagnosis)):
            continue
        if diagnosis.cause is not None:
            by_twin, unmirrored = diagnosis.judged_by == "twin", diagnosis.cause in MIRROR_CAUSES
            if by_twin + unmirrored + (name in contradicted_links) < 2:
                yield _build_cause_finding(model, rule, judged, tensor=tensor, others=disputed.get(diagnosis.cause, ""))
        elif (
            diagnosis.judged_by == "mesh"
            and diagnosis.fits_geometry
            and max(diagnosis.tensor_mismatch, diagnosis.com_mismatch) > far
        ):
            if diagnosis.com_mismatch <= far and (
                _is_rounded_uniform(model, tensor, judged) or _is_placeholder(tensor, judged)
            ):
                continue
            if explain_collision_stand_in(model, tensor.link) == "unread" or has_loose_hull(model, tensor.link):
                continue  # the shape of the part is not known
            if diagnosis.min_moment_ratio > concentrated or _is_light(model, tensor.link):
                if _is_too_dense(model, tensor.link, judged):
                    continue
                doubtful.append(tensor)
            else:
                yield _build_mismatch_finding(model, rule, judged, tensor=tensor)
    if doubtful:
        first = doubtful[0].link.name
        yield rule.finding(
            "doubtful",
            at=doubtful[0].element,
            related=[tensor.element for tensor in doubtful[1:]],
            severity=Severity.INFO,
            confidence=Confidence.HEURISTIC,
            links=join_names(tensor.link.name for tensor in doubtful),
            first=first,
            ruled_out=_format_ruled_out(inertial_diagnoses(model)[first]),
        )


def _list_habitual_links(model: Model) -> list[Link]:
    """List the links that have the mistake that most links of the file have, and of whose mismatch it makes at least half, or
    that show it by themselves; none where fewer than two are left to report."""
    links = [
        model.link_by_name[name]
        for name, judged in inertial_diagnoses(model).items()
        if judged.is_habit and _is_possible(judged) and _shows_habit(model, model.link_by_name[name], judged.diagnosis)
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


def _list_pointlike_links(model: Model) -> list[Link]:
    """List the links whose pieces count as points, which is what a program does to all links; none where there is only one."""
    diagnosed = inertial_diagnoses(model).items()
    links = [model.link_by_name[name] for name, judged in diagnosed if judged.diagnosis.cause == "own_missing"]
    return links if len(links) > 1 else []


def _shows_habit(model: Model, link: Link, diagnosis: Diagnosis) -> bool:
    """Whether a link shows the mistake of its file: by itself, or because undoing it leaves less than half of the mismatch, and
    the tensor of such a part."""
    if diagnosis.unique:
        return True
    drawn, mended = measure_link_geometry(model, link), diagnosis.mended
    left = 0.0 if drawn is None or mended is None else _measure_difference(mended, drawn)
    if diagnosis.cause not in UNIT_CAUSES and left > _LUMPED:
        return False
    return _measure_mismatch(diagnosis, is_mended=True) < 0.5 * _measure_mismatch(diagnosis, is_mended=False)


def _shows_habit_alone(model: Model, link: Link, diagnosis: Diagnosis) -> bool:
    """Whether a link shows the mistake of its file, and not something else beside it. A unit that is left to one link has to
    fit it exactly."""
    return _shows_habit(model, link, diagnosis) and (diagnosis.cause not in UNIT_CAUSES or _is_proven(model, link))


def _measure_mismatch(diagnosis: Diagnosis, *, is_mended: bool) -> float:
    """Return how far the numbers are from the drawn part, with the mistake or with it undone."""
    if is_mended:
        return max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch)
    return max(diagnosis.tensor_mismatch, diagnosis.com_mismatch)


def _is_placeholder(tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether the tensor was typed rather than computed: INR007 reports it where it matters."""
    return describe_placeholder(judged.declared.mass, tensor.components) is not None


def _find_rotated_tensors(model: Model) -> dict[str, float]:
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
            or not _is_possible(judged)
            or _is_light(model, link)
        ):
            continue
        uniform = compute_solid_inertia(drawn.solid, declared.mass)
        moments, expected = np.linalg.eigvalsh(declared.inertia), np.linalg.eigvalsh(uniform)
        if np.abs(moments / expected - 1.0).max() < _SAME_MOMENTS and np.ptp(expected) > _DISTINCT * expected[-1]:
            off = float(np.linalg.norm(declared.inertia - uniform) / np.linalg.norm(uniform))
            if off > _OTHER_AXES:
                rotated[name] = off
    return rotated


def _build_axes_finding(model: Model, rule: Rule, name: str, rotated: Mapping[str, float]) -> Finding:
    """Report a tensor with the drawn part's principal moments about other axes."""
    tensor, diagnoses = model.tensor_by_name[name], inertial_diagnoses(model)
    others = [other for other in rotated if other != name]
    others += [other for other, judged in diagnoses.items() if judged.diagnosis.cause == "axes_permuted"]
    drawn = describe_drawn_inertial(model, tensor.link)
    return rule.finding(
        "axes",
        at=tensor.element,
        edit=f"write {drawn}, or export the tensor again in the axes of the link"
        if drawn
        else "export the tensor again",
        percent=float(f"{100.0 * rotated[name]:.2g}"),
        others=f". The tensors of {join_names(others)} are about other axes, too" if others else "",
        **_collect_data(model, tensor.link, diagnoses[name]),
    )


def _build_habit_finding(model: Model, rule: Rule, links: Sequence[Link]) -> Finding:
    """Report a mistake of the program that exported the file, once."""
    diagnoses = inertial_diagnoses(model)
    judged = [diagnoses[link.name] for link in links]
    repairs = [propose_undo(model, link) for link in links]
    complete = [repair for repair in repairs if repair is not None and repair.edits]
    cause, detail = judged[0].diagnosis.cause or "", judged[0].diagnosis.detail
    is_vast = any(_is_vast(model, link, one) for link, one in zip(links, judged, strict=True))
    is_proven = len(complete) == len(links) and all(_is_proven(model, link) for link in links)
    edits = {edit.span: edit for repair in complete for edit in repair.edits} if is_proven else {}
    return build_group_finding(
        rule,
        "habit",
        [model.tensor_by_name[link.name].element for link in links],
        cause=cause,
        edits=tuple(edits.values()),
        severity=Severity.ERROR if is_vast else Severity.INFO if all(_is_light(model, one) for one in links) else None,
        links=join_names(link.name for link in links),
        first=links[0].name,
        count=len(links),
        known=len(diagnoses),
        faulty=FAULTY_NUMBERS.get(cause, "inertia"),
        why=SHORT_CAUSES.get(cause, name_mistake(cause)).format(detail=detail),
        detail=detail,
        mistake=describe_mistake(cause, detail),
        before=float(f"{_compute_median_mismatch(judged, is_mended=False):.2g}"),
        after=float(f"{_compute_median_mismatch(judged, is_mended=True):.2g}"),
        better=_describe_median_agreement(model, links),
        edit="" if repairs[0] is None else repairs[0].words,
    )


def _compute_median_mismatch(judged: Sequence[DiagnosedInertial], *, is_mended: bool) -> float:
    """Return the median of how far the inertials are from the drawn parts; a tensor that no body has is infinitely far."""
    return float(np.median([_measure_mismatch(one.diagnosis, is_mended=is_mended) for one in judged]))


def _is_proven(model: Model, link: Link) -> bool:
    """Whether a mistake of the whole file leaves the tensor of the drawn part in this link, or shows by itself."""
    diagnosis, drawn = inertial_diagnoses(model)[link.name].diagnosis, measure_link_geometry(model, link)
    if diagnosis.unique:
        return True
    if diagnosis.mended is None or drawn is None:
        return False
    return _measure_difference(diagnosis.mended, drawn) <= _PROVEN


def _describe_median_agreement(model: Model, links: Sequence[Link]) -> str:
    """Describe how much nearer the numbers of links are to those of the drawn parts when their mistake is undone."""
    if inertial_diagnoses(model)[links[0].name].diagnosis.cause == "own_missing":
        return _POINTLIKE
    shares, distances = [], []
    for link in links:
        judged, drawn = inertial_diagnoses(model)[link.name], measure_link_geometry(model, link)
        if judged.diagnosis.mended is None or drawn is None:
            continue
        pair = (judged.declared, judged.diagnosis.mended)
        shares.append([_measure_difference(numbers, drawn) for numbers in pair])
        distances.append([float(np.linalg.norm(numbers.com - drawn.solid.com)) for numbers in pair])
    if not shares:
        return "they agree better with the drawn parts"
    (before, after), (far, near) = np.median(shares, axis=0), np.median(distances, axis=0)
    claims = []
    if after < before:
        claims.append(
            f"the median tensor is {_format_share(after)} off the drawn part's instead of {_format_share(before)}"
        )
    if near < 0.5 * far:
        claims.append(f"the median COM is {format_length(near)} off instead of {format_length(far)}")
    return " and ".join(claims) or "they agree better with the drawn parts"


def _measure_difference(numbers: DeclaredInertial, drawn: VisualGeometry) -> float:
    """Measure how far a tensor is from that of the drawn part at the same mass, as a share of the latter (Frobenius norms)."""
    uniform = compute_solid_inertia(drawn.solid, numbers.mass)
    return float(np.linalg.norm(numbers.inertia - uniform) / np.linalg.norm(uniform))


def _format_share(share: float) -> str:
    if share < 1.0:
        return f"{100.0 * share:.2g} %"
    return f"{100.0 * share:.0f} %" if share < 10.0 else f"{float(f'{share:.3g}'):,.0f} times"


def _find_disputed_units(model: Model) -> dict[str, str]:
    """Return the causes (`UNIT_CAUSES`) for which links of the model fit different units, with what fits them in words.

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
        cause: join_names(f"{name} {detail}" for name, detail in links.items())
        for cause, links in units.items()
        if set(links.values()) != {"none"}
        and not set.intersection(*(set(detail.split(" or ")) for detail in links.values()))
    }


def _is_possible(judged: DiagnosedInertial) -> bool:
    """Whether a body can have the tensor; otherwise INR003 or INR004 reports it, with the cause found here. Three points have a
    tensor that rounding makes impossible."""
    if judged.diagnosis.cause == "own_missing":
        return True
    validity = check_inertia_validity(judged.declared.tensor)
    return validity.positive_definite and validity.triangle_inequality


def _is_too_dense(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether no material explains the mass: INR010 reports the number that is wrong."""
    drawn = measure_link_geometry(model, link)
    return drawn is not None and drawn.hull is not None and judged.declared.mass > DENSEST * drawn.hull.volume


def _is_rounded_uniform(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether the tensor is that of the drawn part, rounded to the typed digits.

    0.01, 0.01 and 0.02 are the moments of a plate without thickness, and to one digit those of a thick one.
    """
    declared, drawn = judged.declared, measure_link_geometry(model, tensor.link)
    if drawn is None:
        return False
    uniform = declared.rotation.T @ compute_solid_inertia(drawn.solid, declared.mass) @ declared.rotation
    rows, columns = np.triu_indices(3)
    halves = np.array(list_half_units(tensor.texts))
    halves[halves == 0.0] = halves.max()  # a zero was rounded like its neighbours
    return bool((np.abs(declared.tensor - uniform)[rows, columns] <= halves).all())


def _build_cause_finding(
    model: Model, rule: Rule, judged: DiagnosedInertial, *, tensor: DeclaredTensor, others: str
) -> Finding:
    """Report an inertial with a cause. ``others``: the units that links of the model fit where these differ."""
    diagnosis, link = judged.diagnosis, tensor.link
    cause = diagnosis.cause or ""
    mended = propose_undo(model, link) if not others else None
    exact = diagnosis.unique and mended is not None and cause not in AMBIGUOUS_CAUSES
    message = "cause" if mended is None else "exact" if exact else "named"
    if mended is not None and diagnosis.judged_by == "twin":
        message = "twin"
    elif cause in {"com_missing", "mesh_scale"}:
        message = cause
    elif others:
        message = "disputed"
    data = {**_collect_data(model, link, judged, is_certain=message == "exact"), "others": others}
    mild = cause in MILD_CAUSES or _is_light(model, link) or _is_slight(model, link, judged)
    return rule.finding(
        message,
        at=tensor.element if mended is None else _locate_repair(tensor, mended),
        cause=cause,
        edits=() if mended is None else mended.edits,
        related=[*_list_twins(model, judged), *_iter_definitions(mended)],
        severity=Severity.ERROR if _is_vast(model, link, judged) else Severity.INFO if mild else None,
        edit="" if mended is None else mended.words,
        **data,
    )


def _is_slight(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether undoing the mistake changes next to nothing."""
    declared, mended, drawn = judged.declared, judged.diagnosis.mended, measure_link_geometry(model, link)
    if (
        mended is None
        or drawn is None
        or judged.diagnosis.judged_by != "mesh"
        or judged.diagnosis.cause == "mesh_scale"
    ):
        return False  # the scale of a mesh is not in the inertial
    moved = float(np.linalg.norm(mended.com - declared.com))
    changed = float(np.linalg.norm(mended.inertia - declared.inertia))
    weight = abs(mended.mass - declared.mass)
    return (
        (moved < SLIGHT_LENGTH or moved < SLIGHT * measure_extent(drawn.points))
        and changed < SLIGHT * float(np.linalg.norm(declared.inertia))
        and weight < SLIGHT * declared.mass
    )


def _is_vast(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the tensor is so large that no mass inside the drawn part comes near it, and that it rules the whole body."""
    drawn, declared = measure_link_geometry(model, link), judged.declared
    if judged.diagnosis.fits_geometry or drawn is None or _is_light(model, link):
        return False
    return float(np.trace(declared.tensor)) >= VAST * float(np.trace(compute_solid_inertia(drawn.solid, declared.mass)))


def _build_mismatch_finding(model: Model, rule: Rule, judged: DiagnosedInertial, *, tensor: DeclaredTensor) -> Finding:
    drawn = describe_drawn_inertial(model, tensor.link, with_com=judged.diagnosis.com_mismatch > NOTABLE)
    is_tiny = _is_tiny(model, tensor.link, judged)
    return rule.finding(
        "disagrees",
        at=tensor.element,
        severity=None if is_tiny else Severity.INFO,
        confidence=None if is_tiny else Confidence.HEURISTIC,
        edit=f", or write {drawn}" if drawn else "",
        unlike=_describe_other_shape(model, tensor.link, judged),
        **_collect_data(model, tensor.link, judged),
    )


def _is_tiny(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the moments are so small that the mass would be in a tenth of the drawn part's size."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return False
    uniform = compute_solid_inertia(drawn.solid, judged.declared.mass)
    return float(np.trace(uniform)) >= _TINY * float(np.trace(judged.declared.tensor))


def _describe_other_shape(model: Model, link: Link, judged: DiagnosedInertial) -> str:
    """Say for a headline what disagrees most: the COM, or the tensor, by the direction in which it misses the drawn one most."""
    drawn, declared, source = measure_link_geometry(model, link), judged.declared, describe_geometry_source(model, link)
    if drawn is None:
        return f"inertia does not fit {source}"
    which = "the drawn one" if source == "the drawn part" else "its collision shape"
    moments, uniform = (
        np.linalg.eigvalsh(t) for t in (declared.inertia, compute_solid_inertia(drawn.solid, declared.mass))
    )
    is_similar = bool(((moments < SIMILAR * uniform) & (uniform < SIMILAR * moments)).all())
    if judged.diagnosis.com_mismatch > (NOTABLE if is_similar else judged.diagnosis.tensor_mismatch):
        return f"COM {format_length(float(np.linalg.norm(declared.com - drawn.solid.com)))} from that of {source}"
    if moments.sum() > SIMILAR * uniform.sum() or uniform.sum() >= _TINY * moments.sum():
        return f"inertia {_compare_sizes(moments, uniform, '×', digits=2)}"
    variances, axes = np.linalg.eigh(drawn.solid.covariance)  # along the drawn part's axes, the longest last
    along = np.diag(axes.T @ compute_mass_covariance(declared.inertia, declared.mass) @ axes) / variances
    if along.max() < _MUCH_LESS:
        return f"inertia fits a far smaller part than {which}"
    least = int(along.argmin())
    is_rod = variances[1] < 0.5 * variances[2]
    word = "thinner" if least == 0 else "shorter" if least == 2 and is_rod else "narrower"
    return f"inertia fits a far {word} part than {which}"


def _collect_data(model: Model, link: Link, judged: DiagnosedInertial, *, is_certain: bool = False) -> dict[str, Any]:
    declared, diagnosis = judged.declared, judged.diagnosis
    drawn = measure_link_geometry(model, link)
    source = describe_geometry_source(model, link)
    moments, _ = compute_principal_moments(declared.inertia)
    expected = measured = size = apart = ""
    if drawn is not None:
        uniform, _ = compute_principal_moments(compute_solid_inertia(drawn.solid, declared.mass))
        expected = join_numbers(uniform, digits=3)
        mismatch = (diagnosis.tensor_mismatch, diagnosis.com_mismatch)
        measured = _describe_mismatch(declared, drawn, mismatch=mismatch, moments=moments, uniform=uniform)
        size = _compare_sizes(moments, uniform, "×", digits=2)
        apart = format_length(float(np.linalg.norm(declared.com - drawn.solid.com)))
    return {
        "link": link.name,
        "detail": diagnosis.detail,
        "mistake": describe_mistake(diagnosis.cause or "", diagnosis.detail),
        "why": SHORT_CAUSES.get(diagnosis.cause or "", "").format(detail=diagnosis.detail),
        "fault": _describe_fault(
            diagnosis.cause or "", diagnosis.detail, size=size, apart=apart, is_certain=is_certain
        ),
        "source": source,
        "off": f", {apart} from {'the drawn part' if source == 'the drawn part' else 'the shape'}'s" if apart else "",
        "twins": join_names(judged.twins),
        "mass": f"{declared.mass:g}",
        "moments": join_numbers(moments, digits=3),
        "expected": expected,
        "measured": measured,
        # One macro line makes many links, each with its own numbers and one mistake: these do not tell findings apart.
        "mismatch": {
            "tensor": diagnosis.tensor_mismatch,
            "com": diagnosis.com_mismatch,
            "mended_tensor": diagnosis.mended_tensor_mismatch,
            "mended_com": diagnosis.mended_com_mismatch,
        },
        "agree": _describe_agreement(judged, drawn),
        "ruled_out": _format_ruled_out(judged),
    }


def _describe_fault(cause: str, detail: str, *, size: str, apart: str, is_certain: bool) -> str:
    """Say for a headline what is wrong, with the number that shows it; ``apart``: how far the COM is from the drawn part's."""
    if cause == "com_unit" and apart:
        return f"COM {apart} off"
    if cause in SIZE_CAUSES and size:
        return f"inertia {size}"
    faulty = "COM" if detail.startswith("com ") else FAULTY_NUMBERS.get(cause, "inertia")
    return f"{'wrong' if is_certain else 'suspect'} {faulty}"


def _describe_agreement(judged: DiagnosedInertial, drawn: VisualGeometry | None) -> str:
    """Describe how near the numbers are to those of the drawn part when the mistake is undone."""
    diagnosis = judged.diagnosis
    residual, mended = max(diagnosis.mended_tensor_mismatch, diagnosis.mended_com_mismatch), diagnosis.mended
    if diagnosis.com_order:
        return f"the tensor agrees, and the COM does with its x y z as {diagnosis.com_order}"
    if diagnosis.cause == "own_missing":
        return _POINTLIKE
    if residual < EXACT:
        return f"the two agree to within {max(1.0, 100 * residual):.0f} %"
    if mended is None or drawn is None:
        return "the two agree better"
    left = []
    is_own = diagnosis.cause not in _FROM_DRAWING
    if is_own and diagnosis.mended_com_mismatch < diagnosis.com_mismatch - DIGITS:
        apart = format_length(float(np.linalg.norm(mended.com - drawn.solid.com)))
        left.append("the COM agrees" if diagnosis.mended_com_mismatch < DIGITS else f"the COM is {apart} off")
    before, after = (_measure_difference(numbers, drawn) for numbers in (judged.declared, mended))
    if is_own and diagnosis.mended_tensor_mismatch < diagnosis.tensor_mismatch - DIGITS and after < before:
        falls = f"the tensor is {_format_share(after)} off instead of {_format_share(before)}"
        left.append("the tensor agrees" if diagnosis.mended_tensor_mismatch < DIGITS else falls)
    if not is_own and diagnosis.com_mismatch > NOTABLE:
        apart = format_length(float(np.linalg.norm(judged.declared.com - drawn.solid.com)))
        return f"the tensor agrees, and the COM stays {apart} off"
    return " and ".join(left) or "the two agree better"


def _format_ruled_out(judged: DiagnosedInertial) -> str:
    return join_names(map(name_mistake, judged.diagnosis.ruled_out))


def _list_twins(model: Model, judged: DiagnosedInertial) -> list[Link]:
    return [model.link_by_name[twin] for twin in judged.twins] if judged.diagnosis.judged_by == "twin" else []


def _iter_definitions(mended: InertialRepair | None) -> Iterator[Located]:
    """Iterate over the definitions that the numbers of a repair are computed from."""
    for place in () if mended is None else mended.places:
        if isinstance(place, Attribute):
            yield from place.collect_definitions()


def _describe_mismatch(
    numbers: DeclaredInertial,
    drawn: VisualGeometry,
    *,
    mismatch: tuple[float, float],
    moments: Array,
    uniform: Array,
) -> str:
    """Describe how numbers differ from those of the drawn part, whose principal moments are ``uniform``; ``mismatch``: of the
    tensor and of the COM."""
    differences = []
    of_tensor, of_com = mismatch
    apart = float(np.linalg.norm(numbers.com - drawn.solid.com))
    if of_com > NOTABLE:
        differences.append(f"the COM is {format_length(apart)} off")
    size = _compare_sizes(moments, uniform, " times", digits=3)
    if size:
        differences.append(f"the moments of inertia are {size} for this mass at uniform density")
    elif of_tensor > max(NOTABLE, _ROTATED * _measure_shape_mismatch(moments, uniform)):
        differences.append("the inertia tensor is about other axes")
    elif of_tensor > NOTABLE:
        actual, expected = join_numbers(moments, digits=3), join_numbers(uniform, digits=3)
        differences.append(f"the principal moments are {actual} instead of {expected} kg·m²")
    return " and ".join(differences) or "the inertial is only slightly off"


def _compare_sizes(moments: Moments, uniform: Moments, times: str, *, digits: int) -> str:
    """Say how much too large or too small principal moments (3,) are; nothing if they are ``SIMILAR`` in size."""
    ratio = float(moments.sum() / uniform.sum())
    if 1 / SIMILAR < ratio < SIMILAR:
        return ""
    factor = float(f"{max(ratio, 1 / ratio):.{digits}g}")
    shown = f"{factor:,.0f}" if 100 <= factor < 1e6 else f"{factor:g}"
    return f"{shown}{times} too {'large' if ratio > 1 else 'small'}"


def _measure_shape_mismatch(moments: Array, uniform: Array) -> float:
    """Return how far principal moments (3,) are from others as the mismatch of a tensor is, the axes of the two aside."""
    first, other = (np.maximum(m.sum() / 2 - m, 1e-6 * m.sum()) for m in (moments, uniform))
    return float(np.linalg.norm(np.log(first / other)))


def _is_light(model: Model, link: Link) -> bool:
    """Whether the link is a small part of a rigid body, whose motion its numbers hardly change."""
    try:
        body = model.tree.list_body_links(link.name)
    except FactUnavailableError:
        return False
    whole = compute_body_mass(model, body)
    mass = None if link.inertial is None else link.inertial.mass
    return len(body) > 1 and whole is not None and mass is not None and mass < LIGHT * whole


def _locate_repair(tensor: DeclaredTensor, mended: InertialRepair) -> Located:
    """Return the narrowest text that holds all numbers to change."""
    places = [place for place in mended.places if place is not None]
    if len(places) == 1:
        return places[0]
    if all(isinstance(place, Attribute) and place.owner is tensor.element for place in places):
        return tensor.element
    return tensor.inertial.element
