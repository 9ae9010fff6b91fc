"""SYM003 reports links that draw the same part with different inertials."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.likeness.mirror import MirrorPlane, measure_deviation
from urdfcheck.model import Model
from urdfcheck.model.inertials.habits.minor_findings import set_lost_aside
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_differences import describe_differences, format_millimetres, locate_difference
from urdfcheck.model.inertials.inertial_rows import RowSlip, find_row_slips
from urdfcheck.model.inertials.proposals.com_places import has_com_of_own_mesh
from urdfcheck.model.inertials.typed_tensors import describe_typed_tensor
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial, turn_inertial
from urdfcheck.model.likeness.identical_parts import (
    CopyComparison,
    compare_copies,
    find_differing_pairs,
    find_odd_copies,
)
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.parts import Inertial, Link
from urdfcheck.model.repairs.inertial_edits import build_inertial_repair, have_one_text
from urdfcheck.model.shapes.repeated_drawings import do_drawings_overlap
from urdfcheck.model.shapes.visual_solid import measure_link_geometry, measure_role_geometry

# The inertial of a real part, with its screws and bearings, is this near to that of a uniform part of the drawn shape. The
# wrong one of two inertials is three times as far from it.
MAX_FIT_DEVIATION, MIN_DEVIATION_RATIO = 0.1, 3.0
# The tensor of a part whose inertial is farther than this from that of the uniform part is no model for its copy (chosen).
MAX_PLAUSIBLE_MISS = 1.0
# Beyond this no motor or screw explains how far an inertial is from its drawing: a COM beside the part, moments of half the size.
MIN_CERTAIN_MISS = 0.5
# A COM so far from the drawn part's, as a share of its size, is not that of the part alone.
_COM_APART = 0.05
# No motor makes one of two copies ten times as heavy; a decimal point does. Slightly less, for rounded numbers. Nor does it make
# a moment ten times as large where the masses are equal to this share.
SLIPPED_POINT, _SAME_MASS = 9.9, 0.01
# The plane between left and right.
_MIDDLE = MirrorPlane(np.array((0.0, 1.0, 0.0)), 0.0)


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    yield from set_lost_aside(model, rule, _check(model, rule, differ=differ, note=note))


def _check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    reported: set[str] = set()
    for finding in _compare_copies(model, rule, differ=differ, note=note):
        reported |= {subject.partition("/")[0] for subject in finding.subjects}
        yield finding
    for slip in find_row_slips(model):
        if slip.link.location.subject not in reported and not _is_confirmed_by_drawing(model, slip, note):
            yield _build_row_finding(model, rule, slip)


def _compare_copies(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    """Compare links that draw the same part."""
    for odd in find_odd_copies(model, note):
        is_of_com_alone = max(odd.deviation.mass, odd.deviation.spread) < note
        if is_of_com_alone and has_com_of_own_mesh(model, odd.link, odd.actual, odd.expected):
            continue
        verdict = _ask_drawing(model, odd, note)
        if verdict == "others" and _fit_own_shapes(model, odd, note):
            continue
        if verdict == "others":
            yield _build_majority_finding(model, rule, odd, differ=differ, note=note)
            continue
        diagnosed = inertial_diagnoses(model).get(odd.link.name)
        if diagnosed is not None and diagnosed.diagnosis.judged_by == "twin" and not diagnosed.diagnosis.at_fault:
            continue  # its numbers fit its drawing: all others may have the same mistake
        names = join_names(link.name for link in odd.by)
        why = f"{len(odd.by)} links that draw the same part ({names}) agree with each other"
        yield _build_outlier_finding(model, rule, odd, why=why, differ=differ, note=note, is_known=verdict == "odd")
    sides = {frozenset((pair.one, pair.other)) for pair in mirror_pairs(model)}
    for pair in find_differing_pairs(model, note, excluded=sides):
        wrong = _pick_wrong_inertial(model, pair)
        if do_drawings_overlap(model, pair[0].link, pair[1].link):
            yield _build_drawing_finding(rule, "drawing", pair, note=note)
        elif _are_mirrored(model, pair, differ):
            yield _build_drawing_finding(rule, "mirrored", pair, note=note)
        elif wrong is None:
            yield _build_pair_finding(model, rule, pair, note=note)
        else:
            why = f"{wrong.by[0].name} has the inertial of the part that both draw"
            yield _build_outlier_finding(model, rule, wrong, why=why, differ=differ, note=note)


def _build_outlier_finding(
    model: Model, rule: Rule, odd: CopyComparison, *, why: str, differ: float, note: float, is_known: bool = True
) -> Finding:
    """Report a link that is unlike its copies. ``is_known``: whether its drawing shows that it is the wrong one."""
    is_model = _is_model(model, odd, note)
    is_known = is_known and is_model
    inertial = _get_inertial(model, odd.link)
    others = [_get_inertial(model, link) for link in odd.by]
    repair, siblings = build_inertial_repair(inertial, odd.expected), join_names(link.name for link in odd.by)
    shared = any(have_one_text(repair.places, inertial, other) for other in others)
    # Numbers that no link has are as exact as the drawing: compared, not written.
    edits = () if shared or odd.is_image or not is_known else repair.edits
    return rule.finding(
        "unknown" if not is_known else "odd" if edits or odd.is_image else "computed",
        at=locate_difference(inertial, odd.deviation, note),
        related=[locate_difference(other, odd.deviation, note) for other in others],
        edits=edits,
        severity=None if odd.deviation.worst >= differ else Severity.INFO,
        numbers=repair.text if shared or not is_known else repair.words,
        repair=f"if {odd.link.name} is the same part as the others and these are right, give it {repair.text}"
        if is_model
        else f"compute the inertials of all from the part: those of {siblings} are far from what is drawn, too",
        why=why,
        siblings=siblings,
        **_collect_data(odd, note),
    )


def _is_model(model: Model, odd: CopyComparison, note: float) -> bool:
    """Whether the numbers of the others may be those of the part that a link draws, as far as that is known."""
    if measure_role_geometry(model, odd.link, "visual") is None:
        return True  # collision shapes only bound it
    miss = _measure_least_miss(model, odd.link, odd.expected, _list_differing(odd, note))
    return miss is None or miss <= MAX_PLAUSIBLE_MISS


def _build_majority_finding(model: Model, rule: Rule, odd: CopyComparison, *, differ: float, note: float) -> Finding:
    """Report the copies that agree with each other, and not with the part that all draw, while one of them does."""
    first = odd.by[0]
    back = compare_copies(model, first, odd.link, note)
    comparison = odd if back is None else back
    return rule.finding(
        "others",
        at=locate_difference(_get_inertial(model, first), comparison.deviation, note),
        related=[
            locate_difference(_get_inertial(model, link), comparison.deviation, note)
            for link in (*odd.by[1:], odd.link)
        ],
        severity=None if comparison.deviation.worst >= differ else Severity.INFO,
        sibling=odd.link.name,
        count=len(odd.by),
        siblings=join_names(link.name for link in odd.by),
        **_collect_data(comparison, note),
    )


def _ask_drawing(model: Model, odd: CopyComparison, note: float) -> str | None:
    """Ask what a link draws which inertial is wrong: its own (``odd``) or the ``others``; None where it does not show that."""
    differing = _list_differing(odd, note)
    actual, expected = (
        _measure_least_miss(model, odd.link, numbers, differing) for numbers in (odd.actual, odd.expected)
    )
    return _choose_wrong(actual, expected, note)


def _fit_own_shapes(model: Model, odd: CopyComparison, note: float) -> bool:
    """Whether each link has the numbers of its own shapes: links that draw one part may collide with different ones."""
    first = odd.by[0]
    declared = read_declared_inertial(first)
    miss = None if declared is None else _measure_least_miss(model, first, declared, _list_differing(odd, note))
    return miss is not None and miss < note


def _list_differing(odd: CopyComparison, note: float) -> set[str]:
    """List what differs, as `InertialDeviation` calls it."""
    differing = {"com_offset"} if odd.deviation.com_offset > note else set()
    if max(odd.deviation.mass, odd.deviation.spread) > note:
        differing.add("spread")
    return differing


def _choose_wrong(odd: float | None, others: float | None, note: float) -> str | None:
    """Choose between inertials that are so far from the drawn part."""
    if odd is None or others is None or max(odd, others) < note:
        return None
    if MIN_DEVIATION_RATIO * others <= odd:
        return "odd"
    return "others" if MIN_DEVIATION_RATIO * odd <= others and odd <= MAX_FIT_DEVIATION else None


def _is_confirmed_by_drawing(model: Model, slip: RowSlip, note: float) -> bool:
    """Whether a link unlike its row has the inertial of the part that it draws, which the others have not."""
    misses = []
    for link in (slip.link, slip.row[0]):
        declared = read_declared_inertial(link)
        misses.append(None if declared is None else _measure_least_miss(model, link, declared))
    own, other = misses
    return _choose_wrong(own, other, note) == "others"


def _measure_least_miss(
    model: Model, link: Link, declared: DeclaredInertial, quantities: Iterable[str] = ("com_offset", "spread")
) -> float | None:
    """Measure how far ``quantities`` are from those of a uniform part of this mass: filled, hollow, or filled to its convex hull,
    as it is seen or as it collides. None without a drawing."""
    misses = []
    for role in ("visual", "collision"):
        drawn = measure_role_geometry(model, link, role)
        for solid in () if drawn is None else (drawn.solid, drawn.hull, drawn.shell):
            if solid is not None and solid.volume > 0.0:
                uniform = DeclaredInertial(declared.mass, solid.com, compute_solid_inertia(solid, declared.mass))
                deviation = measure_deviation(declared, uniform)
                misses.append(max(getattr(deviation, quantity) for quantity in quantities))
    return min(misses, default=None)


def _build_pair_finding(
    model: Model, rule: Rule, pair: tuple[CopyComparison, CopyComparison], *, note: float
) -> Finding:
    one, other = pair
    here, there = _get_inertial(model, one.link), _get_inertial(model, other.link)
    masses = [one.actual.mass, other.actual.mass]
    # Neither of them, and far beside what they differ by: copying one to the other would leave both wrong.
    misses, is_slipped = _measure_misses(model, pair), max(masses) >= SLIPPED_POINT * min(masses)
    least = max(MIN_CERTAIN_MISS, MIN_DEVIATION_RATIO * one.deviation.worst)
    are_off = len(misses) == len(pair) and min(misses) > least and not is_slipped
    is_com_off = not is_slipped and all(_has_com_apart(model, comparison) for comparison in pair)
    drawn = measure_link_geometry(model, one.link)
    there_text = build_inertial_repair(there, other.expected).text
    here_text = build_inertial_repair(here, one.expected).text
    # A tensor that was made up is no model for the twin, whatever the right mass is.
    are_models = all(_has_plausible_tensor(model, comparison) for comparison in pair)
    return rule.finding(
        "neither" if are_off else "neither_com" if is_com_off else "pair",
        at=locate_difference(here, one.deviation, note),
        related=[locate_difference(there, other.deviation, note)],
        severity=Severity.WARNING if is_slipped or _has_slipped_moment(one.actual, other.actual) else Severity.INFO,
        confidence=Confidence.HEURISTIC,
        sibling=other.link.name,
        repair=f"if {one.link.name} is right, write {there_text} in {other.link.name}; "
        f"if {other.link.name} is right, write {here_text} in {one.link.name}"
        if are_models
        else "weigh the part, give both links its mass, and compute COM and tensor of both from its shape",
        drawn="" if drawn is None else format_millimetres(drawn.solid.com),
        **_collect_data(one, note),
    )


def _has_plausible_tensor(model: Model, comparison: CopyComparison) -> bool:
    """Whether the tensor of a copy was computed, for a part about as large as the drawn one."""
    miss = _measure_uniform_deviation(model, comparison.link, comparison.actual)
    return describe_typed_tensor(comparison.link) is None and (miss is None or miss <= MAX_PLAUSIBLE_MISS)


def _build_drawing_finding(
    rule: Rule, message: str, pair: tuple[CopyComparison, CopyComparison], *, note: float
) -> Finding:
    """Report two links of which one may draw the part of the other by mistake, and the numbers be right."""
    one, other = pair
    return rule.finding(
        message,
        at=one.link.visuals[0],
        related=[other.link.visuals[0]],
        consequences={"rviz": "shows the same part twice"},
        severity=Severity.INFO,
        confidence=Confidence.HEURISTIC,
        sibling=other.link.name,
        **_collect_data(one, note),
    )


def _are_mirrored(model: Model, pair: Sequence[CopyComparison], differ: float) -> bool:
    """Whether two inertials are mirror images between the left and the right of the root's frame, much more than copies."""
    one, other = pair
    linear, shift = _MIDDLE.relate_frames(model.frames[one.link.name], model.frames[other.link.name])
    image = turn_inertial(one.actual, linear, com=linear @ one.actual.com + shift)
    return measure_deviation(other.actual, image).worst < min(differ, other.deviation.worst / MIN_DEVIATION_RATIO)


def _has_slipped_moment(one: DeclaredInertial, other: DeclaredInertial) -> bool:
    """Whether one of two inertials of one mass has a principal moment that is ten times the other's."""
    if abs(one.mass - other.mass) > _SAME_MASS * other.mass:
        return False
    moments = np.array([np.linalg.eigvalsh(declared.tensor) for declared in (one, other)])
    return bool(moments.min() > 0.0 and (moments.max(axis=0) >= SLIPPED_POINT * moments.min(axis=0)).any())


def _has_com_apart(model: Model, comparison: CopyComparison) -> bool:
    """Whether the COM of one of two copies differs from the other's, and is apart from that of the part which both draw."""
    drawn = measure_link_geometry(model, comparison.link)
    if drawn is None or not drawn.closed or comparison.deviation.com_offset < comparison.deviation.worst:
        return False
    apart = float(np.linalg.norm(comparison.actual.com - drawn.solid.com))
    return apart > _COM_APART * measure_extent(drawn.points)


def _build_row_finding(model: Model, rule: Rule, slip: RowSlip) -> Finding:
    """Report a link whose numbers are those of its row with one mistake."""
    inertial = _get_inertial(model, slip.link)
    return rule.finding(
        slip.kind,
        at=(inertial.tensor_element if slip.kind == "typed" else None) or inertial.element,
        related=[_get_inertial(model, link).element for link in slip.row],
        link=slip.link.name,
        count=len(slip.row),
        siblings=join_names(link.name for link in slip.row),
        mistake=slip.mistake,
    )


def _get_inertial(model: Model, link: Link) -> Inertial:
    """Return the inertial of a link with a complete tensor, which all compared links have."""
    return model.tensor_by_name[link.name].inertial


def _collect_data(comparison: CopyComparison, note: float) -> dict[str, Any]:
    differences = describe_differences(
        comparison.actual, comparison.expected, deviation=comparison.deviation, threshold=note
    )
    return {
        "link": comparison.link.name,
        "differences": ", ".join(differences),
        "share": comparison.deviation.worst,
    }


def _pick_wrong_inertial(model: Model, pair: Sequence[CopyComparison]) -> CopyComparison | None:
    """Return the one of two copies with a wrong inertial, or None.

    Only the other has the inertial of the part that both draw, and undoing one mistake leads to it: without a mistake, one
    may contain a motor that the other lacks. The masses agree.
    """
    known = _measure_misses(model, pair)
    if (
        len(known) != len(pair)
        or min(known) > MAX_FIT_DEVIATION
        or max(known) < max(MAX_FIT_DEVIATION, MIN_DEVIATION_RATIO * min(known))
    ):
        return None
    wrong = pair[known.index(max(known))]
    diagnosed = inertial_diagnoses(model).get(wrong.link.name)
    is_explained = diagnosed is not None and diagnosed.diagnosis.cause is not None
    return wrong if is_explained and wrong.deviation.worst > wrong.deviation.mass else None


def _measure_misses(model: Model, pair: Sequence[CopyComparison]) -> list[float]:
    """Measure how far each inertial is from that of the uniform part that both draw, where that is known."""
    misses = (_measure_uniform_deviation(model, comparison.link, comparison.actual) for comparison in pair)
    return [miss for miss in misses if miss is not None]


def _measure_uniform_deviation(model: Model, link: Link, declared: DeclaredInertial) -> float | None:
    """Measure the deviation of COM and tensor from those of a uniform part of this mass; None without a closed drawing."""
    drawn = measure_link_geometry(model, link)
    if drawn is None or not drawn.closed:
        return None
    uniform = DeclaredInertial(declared.mass, drawn.solid.com, compute_solid_inertia(drawn.solid, declared.mass))
    return measure_deviation(declared, uniform).worst
