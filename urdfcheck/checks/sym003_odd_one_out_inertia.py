"""SYM003 reports links that draw the same part with different inertials."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.likeness.mirror import measure_deviation
from urdfcheck.model import Model
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_differences import describe_differences, locate_difference
from urdfcheck.model.likeness.identical_parts import CopyComparison, find_differing_pairs, find_odd_copies
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.parts import Inertial, Link
from urdfcheck.model.repairs.inertial_edits import build_inertial_repair
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# A uniform part of the drawn shape has an inertial this near to that of a part with screws and bearings in it; and the wrong
# one of two is three times as far from it.
MAX_FIT_DEVIATION, MIN_DEVIATION_RATIO = 0.1, 3.0


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    for opinion in find_odd_copies(model, note):
        judged = inertial_diagnoses(model).get(opinion.link.name)
        if judged is not None and judged.diagnosis.judged_by == "twin" and not judged.diagnosis.at_fault:
            continue  # its own numbers are those of what it draws: the others may be wrong alike
        count = len(opinion.by)
        why = f"{count} like links that draw the same part ({join_names(link.name for link in opinion.by)}) agree on theirs"
        yield _build_outlier_finding(rule, opinion, why, differ, note)
    sides = {frozenset((pair.one, pair.other)) for pair in mirror_pairs(model)}
    for pair in find_differing_pairs(model, note, excluded=sides):
        wrong = _pick_wrong_inertial(model, pair)
        if wrong is None:
            yield _build_pair_finding(rule, pair, note)
        else:
            why = f"its like link {wrong.by[0].name} has those of the part that both draw"
            yield _build_outlier_finding(rule, wrong, why, differ, note)


def _build_outlier_finding(rule: Rule, opinion: CopyComparison, why: str, differ: float, note: float) -> Finding:
    inertial = _get_inertial(opinion.link)
    mended = build_inertial_repair(inertial, opinion.expected)
    shared = any(_get_inertial(link).element.span == inertial.element.span for link in opinion.by)
    return rule.finding(
        "odd" if mended.edits and not shared else "computed",
        at=locate_difference(inertial, opinion.deviation, note),
        related=[locate_difference(_get_inertial(link), opinion.deviation, note) for link in opinion.by],
        edits=() if shared else mended.edits,
        severity=None if opinion.deviation.worst >= differ else Severity.INFO,
        numbers=mended.text,
        why=why,
        siblings=join_names(link.name for link in opinion.by),
        **_collect_data(opinion, note),
    )


def _build_pair_finding(rule: Rule, pair: Sequence[CopyComparison], note: float) -> Finding:
    one, other = pair
    places = [locate_difference(_get_inertial(opinion.link), opinion.deviation, note) for opinion in pair]
    return rule.finding(
        "pair",
        at=places[0],
        related=[places[1]],
        severity=Severity.INFO,
        confidence=Confidence.HEURISTIC,
        sibling=other.link.name,
        there=build_inertial_repair(_get_inertial(other.link), other.expected).text,
        here=build_inertial_repair(_get_inertial(one.link), one.expected).text,
        **_collect_data(one, note),
    )


def _collect_data(opinion: CopyComparison, note: float) -> dict[str, Any]:
    return {
        "link": opinion.link.name,
        "differences": ", ".join(describe_differences(opinion.actual, opinion.expected, opinion.deviation, note)),
        "share": opinion.deviation.worst,
    }


def _pick_wrong_inertial(model: Model, pair: Sequence[CopyComparison]) -> CopyComparison | None:
    """The one of two whose inertial is not that of the part that both draw, where the other's is and undoing one mistake leads to
    it: without a mistake one may hold a motor that the other has not. Its mass may not differ."""
    misses = [_measure_uniform_deviation(model, opinion.link, opinion.actual) for opinion in pair]
    known = [miss for miss in misses if miss is not None]
    if (
        len(known) != len(pair)
        or min(known) > MAX_FIT_DEVIATION
        or max(known) < max(MAX_FIT_DEVIATION, MIN_DEVIATION_RATIO * min(known))
    ):
        return None
    wrong = pair[known.index(max(known))]
    judged = inertial_diagnoses(model).get(wrong.link.name)
    mistaken = judged is not None and judged.diagnosis.cause is not None
    return wrong if mistaken and wrong.deviation.worst > wrong.deviation.mass else None


def _measure_uniform_deviation(model: Model, link: Link, found: DeclaredInertial) -> float | None:
    """How far COM and tensor are from those of a uniform part of this mass."""
    drawn = measure_link_geometry(model, link)
    if drawn is None or not drawn.closed:
        return None
    uniform = DeclaredInertial(found.mass, drawn.solid.com, compute_solid_inertia(drawn.solid, found.mass))
    return measure_deviation(found, uniform).worst


def _get_inertial(link: Link) -> Inertial:
    assert link.inertial is not None
    return link.inertial
