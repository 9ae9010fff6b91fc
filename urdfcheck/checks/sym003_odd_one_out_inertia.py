"""SYM003: links that draw one part have one inertial."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.core.text import listed
from urdfcheck.facts.inertials.diagnosis import Declared
from urdfcheck.facts.inertials.inertia_tensor import inertia_of
from urdfcheck.facts.likeness.mirror import deviation
from urdfcheck.model import Model
from urdfcheck.model.inertials.inertial_differences import differences, place_of_difference
from urdfcheck.model.likeness.identical_parts import Opinion, differing_pairs, opinions
from urdfcheck.model.parts import Inertial, Link
from urdfcheck.model.repairs.inertial_edits import mending
from urdfcheck.model.shapes.visual_solid import geometry

# A uniform part of the drawn shape has an inertial this near to that of a part with screws and bearings in it; and the wrong
# one of two is three times as far from it.
FITS, FARTHER = 0.1, 3.0


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    for opinion in opinions(model, note):
        judged = model.diagnoses.get(opinion.link.name)
        if judged is not None and judged.diagnosis.by == "twin" and not judged.diagnosis.decided:
            continue  # its own numbers are those of what it draws: the others may be wrong alike
        count = len(opinion.by)
        why = f"{count} like links that draw the same part ({listed(link.name for link in opinion.by)}) agree on theirs"
        yield _odd(rule, opinion, why, differ, note)
    sides = {frozenset((pair.one, pair.other)) for pair in model.pairs}
    for pair in differing_pairs(model, note, but=sides):
        wrong = _wrong(model, pair)
        if wrong is None:
            yield _pair(rule, pair, note)
        else:
            why = f"its like link {wrong.by[0].name} has those of the part that both draw"
            yield _odd(rule, wrong, why, differ, note)


def _odd(rule: Rule, opinion: Opinion, why: str, differ: float, note: float) -> Finding:
    inertial = _inertial(opinion.link)
    mended = mending(inertial, opinion.wanted)
    shared = any(_inertial(link).element.span == inertial.element.span for link in opinion.by)
    return rule.finding(
        "odd" if mended.edits and not shared else "computed",
        at=place_of_difference(inertial, opinion.apart, note),
        related=[place_of_difference(_inertial(link), opinion.apart, note) for link in opinion.by],
        edits=() if shared else mended.edits,
        severity=None if opinion.apart.worst >= differ else Severity.INFO,
        numbers=mended.text,
        why=why,
        siblings=listed(link.name for link in opinion.by),
        **_data(opinion, note),
    )


def _pair(rule: Rule, pair: Sequence[Opinion], note: float) -> Finding:
    one, other = pair
    places = [place_of_difference(_inertial(opinion.link), opinion.apart, note) for opinion in pair]
    return rule.finding(
        "pair",
        at=places[0],
        related=[places[1]],
        severity=Severity.INFO,
        confidence=Confidence.HEURISTIC,
        sibling=other.link.name,
        there=mending(_inertial(other.link), other.wanted).text,
        here=mending(_inertial(one.link), one.wanted).text,
        **_data(one, note),
    )


def _data(opinion: Opinion, note: float) -> dict[str, Any]:
    return {
        "link": opinion.link.name,
        "differences": ", ".join(differences(opinion.found, opinion.wanted, opinion.apart, note)),
        "share": opinion.apart.worst,
    }


def _wrong(model: Model, pair: Sequence[Opinion]) -> Opinion | None:
    """The one of two whose inertial is not that of the part that both draw, where the other's is and undoing one mistake leads to
    it: without a mistake one may hold a motor that the other has not. Its mass may not differ."""
    misses = [_miss(model, opinion.link, opinion.found) for opinion in pair]
    known = [miss for miss in misses if miss is not None]
    if len(known) != len(pair) or min(known) > FITS or max(known) < max(FITS, FARTHER * min(known)):
        return None
    wrong = pair[known.index(max(known))]
    judged = model.diagnoses.get(wrong.link.name)
    mistaken = judged is not None and judged.diagnosis.cause is not None
    return wrong if mistaken and wrong.apart.worst > wrong.apart.mass else None


def _miss(model: Model, link: Link, found: Declared) -> float | None:
    """How far COM and tensor are from those of a uniform part of this mass."""
    drawn = geometry(model, link)
    if drawn is None or not drawn.closed:
        return None
    uniform = Declared(found.mass, drawn.solid.com, inertia_of(drawn.solid, found.mass))
    return deviation(found, uniform).worst


def _inertial(link: Link) -> Inertial:
    assert link.inertial is not None
    return link.inertial
