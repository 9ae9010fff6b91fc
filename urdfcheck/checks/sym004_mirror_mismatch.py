"""SYM004 reports left and right parts that are not mirror images of each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Location, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.likeness.mirror import InertialDeviation, find_wrong_signs, measure_principal_deviation
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_differences import describe_differences, locate_difference
from urdfcheck.model.inertials.mirrored_inertials import (
    CONTRADICTIONS,
    PairSide,
    compare_sides,
    find_cause,
    find_wrong_side,
    get_comparable_inertial,
    list_inertial_changes,
)
from urdfcheck.model.likeness.mirror_pairs import MirrorPair, mirror_pairs
from urdfcheck.model.likeness.mirrored_joints import (
    MismatchedLimit,
    find_mismatched_limit,
    find_misplaced_joint,
    find_pair_joints,
    group_by_chain,
    is_shifted,
)
from urdfcheck.model.repairs.edits import AttributeChange, describe_remedy, make_attribute_edits
from urdfcheck.source.text.values import read_attribute_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# A mistake that INR009 leaves to this rule.
UNMIRRORED = "unmirrored"
# So many joints of one chain with wrong limits have one cause.
MIN_CHAIN_JOINTS = 3
ONE_SIDE_RELATIONS = {
    "mirrored": "the mirror image of {}",
    "both": "the same part as {}, mirrored or turned",
    "copied": "the same part as {}",
}
BOTH_SIDES_RELATIONS = {
    "mirrored": "mirror images of each other",
    "both": "one part twice, mirrored or turned",
    "copied": "one part twice",
}


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    found = mirror_pairs(model)
    wrong = [
        one
        for pair in _skip_repeated_pairs(found)
        if (one := find_mismatched_limit(model, pair, found, note)) is not None
    ]
    for chain in group_by_chain(wrong):
        if len(chain) < MIN_CHAIN_JOINTS:
            yield from (_build_limits_finding(rule, one, differ) for one in chain)
        else:
            yield _build_chain_finding(model, rule, chain, differ, note)
    told: dict[str, set[str]] = {"inertial": set(), "dynamics": set(), "place": set()}
    for pair in found:
        for subject, finding in (
            ("inertial", _compare_inertials(model, rule, pair, differ, note)),
            ("dynamics", _compare_dynamics(model, rule, pair, differ, note)),
            ("place", _compare_origins(model, rule, pair, found)),
        ):
            # A link may be in a pair of its hand and in one of the robot: what is wrong with it is told once.
            if finding is not None and not told[subject] & {pair.one, pair.other}:
                told[subject] |= {pair.one, pair.other}
                yield finding


def _skip_repeated_pairs(found: Iterable[MirrorPair]) -> Iterator[MirrorPair]:
    """The pairs without those of links that are in an earlier one."""
    seen: set[str] = set()
    for pair in found:
        if not seen & {pair.one, pair.other}:
            seen |= {pair.one, pair.other}
            yield pair


def _choose_severity(share: float, differ: float, pair: MirrorPair, cause: str | None = None) -> Severity:
    """Parts that only their places and drawings make a pair may be meant to differ."""
    return Severity.WARNING if share >= differ and (pair.is_named or cause is not None) else Severity.INFO


# -- inertials --------------------------------------------------------------------------------------------------------


def _compare_inertials(model: Model, rule: Rule, pair: MirrorPair, differ: float, note: float) -> Finding | None:
    both = compare_sides(model, pair)
    if both is None:
        return (
            None
            if _is_explained_by_one_side(model, pair)
            else _compare_principal_moments(model, rule, pair, differ, note)
        )
    if not both[1].deviation.worst > note:
        return None
    wrong = find_wrong_side(model, pair, both, note)
    side, like = (both[1], ()) if wrong is None else wrong
    apart, cause = side.deviation, find_cause(pair, side, note)
    if cause not in CONTRADICTIONS and _is_explained_by_one_side(model, pair):
        return None
    parts = (("centre of mass", apart.com_offset), ("inertia tensor", apart.spread))
    data: dict[str, Any] = {
        "one": both[0].link.name,
        "other": both[1].link.name,
        "link": side.link.name,
        "twin": side.twin.name,
        "relation": (BOTH_SIDES_RELATIONS if wrong is None else ONE_SIDE_RELATIONS)[pair.drawn_as or ""].format(
            side.twin.name
        ),
        "differences": ", ".join(describe_differences(side.actual, side.expected, apart, note)),
        "what": " and the ".join(word for word, share in parts if share > note),
        "signs": join_names(find_wrong_signs(side.actual, side.expected, note), 9),
        "share": apart.worst,
        "between": _list_subjects(both[0].link, both[1].link),
    }
    place: dict[str, Any] = {
        "at": _locate_difference(side.link, apart, note),
        "related": [_locate_difference(side.twin, apart, note)],
        "cause": cause,
        "severity": _choose_severity(apart.worst, differ, pair, cause),
    }
    shared = _has_shared_inertial(side)
    if wrong is None:
        other_way = "the other way round" if shared else _describe_remedy(both[0])
        return rule.finding("pair", **place, first=_describe_remedy(both[1]), second=other_way, **data)
    message, edits = "like" if like else "inertial", () if shared else make_attribute_edits(list_inertial_changes(side))
    return rule.finding(message, **place, edits=edits, remedy=_describe_remedy(side), like=join_names(like), **data)


def _is_explained_by_one_side(model: Model, pair: MirrorPair) -> bool:
    """Whether one link's numbers have a mistake of their own, which INR009 names: then the pair differs for that."""
    causes = []
    for name in (pair.one, pair.other):
        judged = inertial_diagnoses(model).get(name)
        found = None if judged is None or not judged.diagnosis.at_fault else judged.diagnosis.cause
        causes.append(None if found == UNMIRRORED else found)
    return causes[0] != causes[1]


def _compare_principal_moments(
    model: Model, rule: Rule, pair: MirrorPair, differ: float, note: float
) -> Finding | None:
    """What holds of mirror images and of copies alike, for a pair of which the drawings say nothing."""
    if pair.drawn_as not in {None, "neither"} or not (
        pair.is_named and pair.is_in_place and pair.is_alike is not False
    ):
        return None
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = get_comparable_inertial(one), get_comparable_inertial(other)
    apart = None if first is None or second is None else measure_principal_deviation(second, first)
    if first is None or second is None or apart is None or not apart.worst > note:
        return None
    told = []
    if apart.mass > note:
        told.append(f"masses of {first.mass:.4g} and {second.mass:.4g} kg")
    if apart.spread > note:
        told.append(
            f"principal moments of ({_format_principal_moments(first)}) and ({_format_principal_moments(second)}) kg·m²"
        )
    return rule.finding(
        "moments",
        at=_locate_difference(other, apart, note),
        related=[_locate_difference(one, apart, note)],
        severity=_choose_severity(apart.worst, differ, pair),
        one=one.name,
        other=other.name,
        differences=" and ".join(told),
        share=apart.worst,
        between=_list_subjects(one, other),
    )


def _format_principal_moments(numbers: DeclaredInertial) -> str:
    return ", ".join(f"{moment:.3g}" for moment in np.linalg.eigvalsh(numbers.inertia))


def _locate_difference(link: Link, apart: InertialDeviation, note: float) -> Located:
    assert link.inertial is not None
    return locate_difference(link.inertial, apart, note)


def _describe_remedy(side: PairSide) -> str:
    return describe_remedy(
        list_inertial_changes(side), side.link.name, side.twin.name, shared=_has_shared_inertial(side)
    )


def _has_shared_inertial(side: PairSide) -> bool:
    """Whether one text makes the inertials of both sides."""
    one, other = side.link.inertial, side.twin.inertial
    assert one is not None
    assert other is not None
    return one.element.span == other.element.span


def _list_subjects(*both: Link | Joint) -> list[str]:
    """The elements of both sides: a rule that explains either explains the difference (`worker.hide`)."""
    return [one.location.subject for one in both]


# -- joints -----------------------------------------------------------------------------------------------------------


def _build_limits_finding(rule: Rule, one: MismatchedLimit, differ: float) -> Finding:
    limit, twin = one.joint.limit, one.twin.limit
    assert limit is not None
    assert twin is not None
    cause = "limits_copied" if one.copied else None
    texts = {name: f"{value + 0.0:.10g}" for name, value in one.expected.items()}
    shared = limit.span == twin.span
    wanted = [AttributeChange(limit.attributes.get(name), name, text) for name, text in texts.items()]
    return rule.finding(
        "limits" if one.agreeing_joints else "limits_pair",
        at=limit,
        related=[twin],
        cause=cause,
        severity=_choose_severity(one.max_difference, differ, one.pair, cause),
        edits=make_attribute_edits(wanted) if one.agreeing_joints and not shared else [],
        joint=one.joint.name,
        twin=one.twin.name,
        differences=_describe_limit_differences(one),
        like=join_names(one.agreeing_joints),
        remedy=describe_remedy(wanted, one.joint.name, one.twin.name, shared=shared),
        share=one.max_difference,
    )


def _build_chain_finding(
    model: Model, rule: Rule, chain: Sequence[MismatchedLimit], differ: float, note: float
) -> Finding:
    limits = [limit for one in chain for limit in (one.joint.limit, one.twin.limit) if limit is not None]
    cause = "shifted" if is_shifted(model, chain, note) else None
    return rule.finding(
        "chain",
        at=limits[0],
        related=limits[1:],
        cause=cause,
        severity=_choose_severity(max(one.max_difference for one in chain), differ, chain[0].pair, cause),
        count=len(chain),
        joints=join_names((one.joint.name for one in chain), 12),
        twins=join_names((one.twin.name for one in chain), 12),
        joint=chain[0].joint.name,
        differences=_describe_limit_differences(chain[0]),
    )


def _describe_limit_differences(one: MismatchedLimit) -> str:
    return ", ".join(
        f"{name} {one.joint.get_limit_value(name) or 0.0:.6g} instead of {value + 0.0:.6g}"
        for name, value in one.expected.items()
    )


def _compare_dynamics(model: Model, rule: Rule, pair: MirrorPair, differ: float, note: float) -> Finding | None:
    joints = find_pair_joints(model, pair)
    if joints is None or pair.drawn_as == "neither":
        return None
    elements = [joint.element.find_child("dynamics") for joint in joints]
    told: list[str] = []
    share = 0.0
    for name in ("damping", "friction"):
        a, b = (0.0 if e is None or name not in e.attributes else read_attribute_number(e, name) for e in elements)
        if a is not None and b is not None and abs(a - b) > note * max(abs(a), abs(b)):
            told.append(f"{name} {b:g} instead of {a:g}")
            share = max(share, abs(a - b) / max(abs(a), abs(b)))
    if not told:
        return None
    return rule.finding(
        "dynamics",
        at=elements[1] or joints[1].element,
        related=[elements[0] or joints[0].element],
        severity=_choose_severity(share, differ, pair),
        joint=joints[1].name,
        twin=joints[0].name,
        differences=", ".join(told),
        share=share,
    )


def _compare_origins(model: Model, rule: Rule, pair: MirrorPair, found: Sequence[MirrorPair]) -> Finding | None:
    off = find_misplaced_joint(model, pair, found)
    if off is None:
        return None
    both = off.joint, off.twin
    data: dict[str, Any] = {"joint": off.joint.name, "twin": off.twin.name, "between": _list_subjects(*both)}
    if off.distance:
        at, related = (_locate_origin(joint, "xyz") for joint in both)
        back, there = off.places
        first, second = _describe_move(off.joint, off.twin, there), _describe_move(off.twin, off.joint, back)
        return rule.finding(
            "origin", at=at, related=[related], distance=off.distance * 1e3, first=first, second=second, **data
        )
    at, related = (_locate_origin(joint, "rpy") if off.turned else joint.axis_location for joint in both)
    return rule.finding("axis", at=at, related=[related], angle=math.degrees(off.angle), **data)


def _describe_move(joint: Joint, twin: Joint, place: Array) -> str:
    """How a joint gets to another place (3,) in its parent's frame."""
    text = " ".join(f"{round(float(v), 6) + 0.0:g}" for v in place)
    attributes = [one.origin.get_attribute("xyz") for one in (joint, twin)]
    shared = attributes[0] is not None and attributes[1] is not None and attributes[0].span == attributes[1].span
    return describe_remedy([AttributeChange(attributes[0], "xyz", text)], joint.name, twin.name, shared=shared)


def _locate_origin(joint: Joint, name: str) -> Location:
    attribute = joint.origin.get_attribute(name)
    if attribute is not None:
        return attribute.location
    return joint.location if joint.origin.element is None else joint.origin.element.location
