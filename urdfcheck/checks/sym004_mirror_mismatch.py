"""SYM004: what is left and right of a robot is each other's mirror image."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Location, Rule, Severity
from urdfcheck.core.text import listed
from urdfcheck.facts.inertials.diagnosis import Declared
from urdfcheck.facts.likeness.mirror import Deviation, principal_deviation, wrong_signs
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.inertials.inertial_differences import differences, place_of_difference
from urdfcheck.model.inertials.mirrored_inertials import (
    CONTRADICTIONS,
    Side,
    cause_of,
    changes,
    comparable,
    sides,
    wrong_side,
)
from urdfcheck.model.likeness.mirror_pairs import Pair
from urdfcheck.model.likeness.mirrored_joints import Limited, chains, displaced, is_shifted, joints_of, limited
from urdfcheck.model.repairs.edits import Change, edits_of, remedy
from urdfcheck.source.text.values import attribute_number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A mistake that INR009 leaves to this rule.
UNMIRRORED = "unmirrored"
# So many joints of one chain with wrong limits have one cause.
CHAIN = 3
SINGLE = {
    "mirrored": "the mirror image of {}",
    "both": "the same part as {}, mirrored or turned",
    "copied": "the same part as {}",
}
BOTH = {
    "mirrored": "mirror images of each other",
    "both": "one part twice, mirrored or turned",
    "copied": "one part twice",
}


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    found = model.pairs
    wrong = [one for pair in _once(found) if (one := limited(model, pair, found, note)) is not None]
    for chain in chains(wrong):
        if len(chain) < CHAIN:
            yield from (_limits(rule, one, differ) for one in chain)
        else:
            yield _chain(model, rule, chain, differ, note)
    told: dict[str, set[str]] = {"inertial": set(), "dynamics": set(), "place": set()}
    for pair in found:
        for subject, finding in (
            ("inertial", _inertials(model, rule, pair, differ, note)),
            ("dynamics", _dynamics(model, rule, pair, differ, note)),
            ("place", _place(model, rule, pair, found)),
        ):
            # A link may be in a pair of its hand and in one of the robot: what is wrong with it is told once.
            if finding is not None and not told[subject] & {pair.one, pair.other}:
                told[subject] |= {pair.one, pair.other}
                yield finding


def _once(found: Iterable[Pair]) -> Iterator[Pair]:
    """The pairs without those of links that are in an earlier one."""
    seen: set[str] = set()
    for pair in found:
        if not seen & {pair.one, pair.other}:
            seen |= {pair.one, pair.other}
            yield pair


def _severity(share: float, differ: float, pair: Pair, cause: str | None = None) -> Severity:
    """Parts that only their places and drawings make a pair may be meant to differ."""
    return Severity.WARNING if share >= differ and (pair.named or cause is not None) else Severity.INFO


# -- inertials --------------------------------------------------------------------------------------------------------


def _inertials(model: Model, rule: Rule, pair: Pair, differ: float, note: float) -> Finding | None:
    both = sides(model, pair)
    if both is None:
        return None if _explained(model, pair) else _moments(model, rule, pair, differ, note)
    if not both[1].apart.worst > note:
        return None
    wrong = wrong_side(model, pair, both, note)
    side, like = (both[1], ()) if wrong is None else wrong
    apart, cause = side.apart, cause_of(pair, side, note)
    if cause not in CONTRADICTIONS and _explained(model, pair):
        return None
    parts = (("centre of mass", apart.place), ("inertia tensor", apart.spread))
    data: dict[str, Any] = {
        "one": both[0].link.name,
        "other": both[1].link.name,
        "link": side.link.name,
        "twin": side.twin.name,
        "relation": (BOTH if wrong is None else SINGLE)[pair.drawn or ""].format(side.twin.name),
        "differences": ", ".join(differences(side.found, side.expected, apart, note)),
        "what": " and the ".join(word for word, share in parts if share > note),
        "signs": listed(wrong_signs(side.found, side.expected, note), 9),
        "share": apart.worst,
        "between": _between(both[0].link, both[1].link),
    }
    place: dict[str, Any] = {
        "at": _at(side.link, apart, note),
        "related": [_at(side.twin, apart, note)],
        "cause": cause,
        "severity": _severity(apart.worst, differ, pair, cause),
    }
    shared = _shared(side)
    if wrong is None:
        other_way = "the other way round" if shared else _remedy(both[0])
        return rule.finding("pair", **place, first=_remedy(both[1]), second=other_way, **data)
    message, edits = "like" if like else "inertial", () if shared else edits_of(changes(side))
    return rule.finding(message, **place, edits=edits, remedy=_remedy(side), like=listed(like), **data)


def _explained(model: Model, pair: Pair) -> bool:
    """Whether one link's numbers have a mistake of their own, which INR009 names: then the pair differs for that."""
    causes = []
    for name in (pair.one, pair.other):
        judged = model.diagnoses.get(name)
        found = None if judged is None or not judged.diagnosis.decided else judged.diagnosis.cause
        causes.append(None if found == UNMIRRORED else found)
    return causes[0] != causes[1]


def _moments(model: Model, rule: Rule, pair: Pair, differ: float, note: float) -> Finding | None:
    """What holds of mirror images and of copies alike, for a pair of which the drawings say nothing."""
    if pair.drawn not in {None, "neither"} or not (pair.named and pair.in_place and pair.alike is not False):
        return None
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = comparable(one), comparable(other)
    apart = None if first is None or second is None else principal_deviation(second, first)
    if first is None or second is None or apart is None or not apart.worst > note:
        return None
    told = []
    if apart.mass > note:
        told.append(f"masses of {first.mass:.4g} and {second.mass:.4g} kg")
    if apart.spread > note:
        told.append(f"principal moments of ({_principal(first)}) and ({_principal(second)}) kg·m²")
    return rule.finding(
        "moments",
        at=_at(other, apart, note),
        related=[_at(one, apart, note)],
        severity=_severity(apart.worst, differ, pair),
        one=one.name,
        other=other.name,
        differences=" and ".join(told),
        share=apart.worst,
        between=_between(one, other),
    )


def _principal(numbers: Declared) -> str:
    return ", ".join(f"{moment:.3g}" for moment in np.linalg.eigvalsh(numbers.inertia))


def _at(link: Link, apart: Deviation, note: float) -> Located:
    assert link.inertial is not None
    return place_of_difference(link.inertial, apart, note)


def _remedy(side: Side) -> str:
    return remedy(changes(side), side.link.name, side.twin.name, shared=_shared(side))


def _shared(side: Side) -> bool:
    """Whether one text makes the inertials of both sides."""
    one, other = side.link.inertial, side.twin.inertial
    assert one is not None
    assert other is not None
    return one.element.span == other.element.span


def _between(*both: Link | Joint) -> list[str]:
    """The elements of both sides: a rule that explains either explains the difference (`worker.hide`)."""
    return [one.location.subject for one in both]


# -- joints -----------------------------------------------------------------------------------------------------------


def _limits(rule: Rule, one: Limited, differ: float) -> Finding:
    limit, twin = one.joint.limit, one.twin.limit
    assert limit is not None
    assert twin is not None
    cause = "limits_copied" if one.copied else None
    texts = {name: f"{value + 0.0:.10g}" for name, value in one.wanted.items()}
    shared = limit.span == twin.span
    wanted = [Change(limit.attributes.get(name), name, text) for name, text in texts.items()]
    return rule.finding(
        "limits" if one.like else "limits_pair",
        at=limit,
        related=[twin],
        cause=cause,
        severity=_severity(one.share, differ, one.pair, cause),
        edits=edits_of(wanted) if one.like and not shared else [],
        joint=one.joint.name,
        twin=one.twin.name,
        differences=_limit_differences(one),
        like=listed(one.like),
        remedy=remedy(wanted, one.joint.name, one.twin.name, shared=shared),
        share=one.share,
    )


def _chain(model: Model, rule: Rule, chain: Sequence[Limited], differ: float, note: float) -> Finding:
    limits = [limit for one in chain for limit in (one.joint.limit, one.twin.limit) if limit is not None]
    cause = "shifted" if is_shifted(model, chain, note) else None
    return rule.finding(
        "chain",
        at=limits[0],
        related=limits[1:],
        cause=cause,
        severity=_severity(max(one.share for one in chain), differ, chain[0].pair, cause),
        count=len(chain),
        joints=listed((one.joint.name for one in chain), 12),
        twins=listed((one.twin.name for one in chain), 12),
        joint=chain[0].joint.name,
        differences=_limit_differences(chain[0]),
    )


def _limit_differences(one: Limited) -> str:
    return ", ".join(
        f"{name} {one.joint.limit_value(name) or 0.0:.6g} instead of {value + 0.0:.6g}"
        for name, value in one.wanted.items()
    )


def _dynamics(model: Model, rule: Rule, pair: Pair, differ: float, note: float) -> Finding | None:
    joints = joints_of(model, pair)
    if joints is None or pair.drawn == "neither":
        return None
    elements = [joint.element.child("dynamics") for joint in joints]
    told: list[str] = []
    share = 0.0
    for name in ("damping", "friction"):
        a, b = (0.0 if e is None or name not in e.attributes else attribute_number(e, name) for e in elements)
        if a is not None and b is not None and abs(a - b) > note * max(abs(a), abs(b)):
            told.append(f"{name} {b:g} instead of {a:g}")
            share = max(share, abs(a - b) / max(abs(a), abs(b)))
    if not told:
        return None
    return rule.finding(
        "dynamics",
        at=elements[1] or joints[1].element,
        related=[elements[0] or joints[0].element],
        severity=_severity(share, differ, pair),
        joint=joints[1].name,
        twin=joints[0].name,
        differences=", ".join(told),
        share=share,
    )


def _place(model: Model, rule: Rule, pair: Pair, found: Sequence[Pair]) -> Finding | None:
    off = displaced(model, pair, found)
    if off is None:
        return None
    both = off.joint, off.twin
    data: dict[str, Any] = {"joint": off.joint.name, "twin": off.twin.name, "between": _between(*both)}
    if off.distance:
        at, related = (_origin(joint, "xyz") for joint in both)
        back, there = off.places
        first, second = _moved(off.joint, off.twin, there), _moved(off.twin, off.joint, back)
        return rule.finding(
            "origin", at=at, related=[related], distance=off.distance * 1e3, first=first, second=second, **data
        )
    at, related = (_origin(joint, "rpy") if off.turned else joint.axis_location for joint in both)
    return rule.finding("axis", at=at, related=[related], angle=math.degrees(off.angle), **data)


def _moved(joint: Joint, twin: Joint, place: Array) -> str:
    """How a joint gets to another place (3,) in its parent's frame."""
    text = " ".join(f"{round(float(v), 6) + 0.0:g}" for v in place)
    attributes = [one.origin.attribute("xyz") for one in (joint, twin)]
    shared = attributes[0] is not None and attributes[1] is not None and attributes[0].span == attributes[1].span
    return remedy([Change(attributes[0], "xyz", text)], joint.name, twin.name, shared=shared)


def _origin(joint: Joint, name: str) -> Location:
    attribute = joint.origin.attribute(name)
    if attribute is not None:
        return attribute.location
    return joint.location if joint.origin.element is None else joint.origin.element.location
