"""SYM004 reports left and right parts that are not mirror images of each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.text import format_length, format_point, join_names, join_numbers
from urdfcheck.facts.inertials.certainty import FAR
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.twin_slips import TwinSlip, find_slip_between_twins
from urdfcheck.facts.likeness.mirror import InertialDeviation, find_wrong_signs, measure_principal_deviation
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_differences import describe_differences, locate_difference
from urdfcheck.model.inertials.inertial_proposals import describe_mistake
from urdfcheck.model.inertials.mirrored_inertials import (
    CONTRADICTIONS,
    PairSide,
    compare_sides,
    find_cause,
    find_copied_side,
    find_wrong_side,
    fit_own_drawings_alike,
    get_comparable_inertial,
    list_inertial_changes,
)
from urdfcheck.model.likeness.mirror_pairs import MirrorPair, mirror_pairs
from urdfcheck.model.likeness.mirrored_joints import (
    MismatchedLimit,
    are_limits_measured,
    find_mismatched_limit,
    find_misplaced_joint,
    find_pair_joints,
    group_by_chain,
    is_shifted,
)
from urdfcheck.model.likeness.odd_limbs import OddNumbers, iter_odd_numbers
from urdfcheck.model.likeness.origin_slips import (
    OddSign,
    OriginSlip,
    find_origin_slips,
    iter_coincident_twins,
    iter_odd_signs,
)
from urdfcheck.model.repairs.edits import change_numbers, describe_remedy, edit_all_numbers, make_attribute_edits
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.values import read_attribute_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# INR009 leaves this mistake to SYM004.
UNMIRRORED = "unmirrored"
# Mistakes that change the mass, or its ratio to the tensor: no other explains that one side is heavier by more than this share.
_MASS_CAUSES = frozenset({"mass_unit", "units", "other_mass", "decimal_point", "mesh_scale"})
_SAME_MASS = 0.2
# From so many joints on, the wrong limits of one chain have one cause.
MIN_CHAIN_JOINTS = 3
ONE_SIDE_RELATIONS = {
    "mirrored": "the mirror image of {}",
    "both": "the same part as {}, mirrored or rotated",
    "copied": "the same part as {}",
}
# What the inertials of both sides lack, for the headline.
LACKS = {"mirrored": "not mirrored", "both": "do not match", "copied": "differ"}
BOTH_SIDES_RELATIONS = {
    "mirrored": "mirror images of each other",
    "both": "one part twice, mirrored or rotated",
    "copied": "one part twice",
}


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    pairs, shares = mirror_pairs(model), _Shares(differ, note)
    yield from _compare_limits(model, rule, pairs, shares=shares)
    reported: dict[str, set[str]] = {"inertial": set(), "dynamics": set(), "place": set()}
    for odd in iter_odd_signs(model):
        if odd.joint.child not in reported["place"]:
            reported["place"].add(odd.joint.child)
            yield _report_odd_sign(rule, odd)
    for number in iter_odd_numbers(model):
        if number.joint.child not in reported["place"]:
            reported["place"].add(number.joint.child)
            yield _report_odd_numbers(rule, number)
    for slip in find_origin_slips(model):
        if not reported["place"] & {slip.joint.child, slip.twin.child}:
            reported["place"] |= {slip.joint.child, slip.twin.child}
            yield _report_slip(rule, slip)
    for one, other in iter_coincident_twins(model):
        if not reported["place"] & {one.child, other.child}:
            reported["place"] |= {one.child, other.child}
            yield _report_coincidence(rule, one, other)
    for pair in pairs:
        for subject, finding in (
            ("inertial", _compare_inertials(model, rule, pair, shares=shares)),
            ("dynamics", _compare_dynamics(model, rule, pair, shares=shares)),
            ("place", _compare_origins(model, rule, pair, pairs=pairs)),
        ):
            # A link may be in a pair of its hand and in one of the robot: its mistake is reported once.
            if finding is not None and not reported[subject] & {pair.one, pair.other}:
                reported[subject] |= {pair.one, pair.other}
                yield finding


@dataclass(frozen=True, slots=True)
class _Shares:
    """The options of the rule, as relative differences."""

    differ: float
    """From here on a difference is a warning."""
    note: float
    """Beyond this a difference is reported."""

    def choose_severity(self, difference: float, pair: MirrorPair, cause: str | None = None) -> Severity:
        """Return INFO for small differences, and for unnamed pairs without a cause, which may be meant to differ."""
        is_wrong = difference >= self.differ and (pair.is_named or cause is not None)
        return Severity.WARNING if is_wrong else Severity.INFO


# -- inertials --------------------------------------------------------------------------------------------------------


def _compare_inertials(model: Model, rule: Rule, pair: MirrorPair, *, shares: _Shares) -> Finding | None:
    both, note = compare_sides(model, pair), shares.note
    if both is None:
        if _is_explained_by_one_side(model, pair):
            return None
        return _compare_principal_moments(model, rule, pair, shares=shares)
    if not both[1].deviation.worst > note:
        return None
    wrong = find_wrong_side(model, pair, both, threshold=note)
    side, like = (both[1], ()) if wrong is None else wrong
    deviation, cause = side.deviation, find_cause(pair, side, note)
    if cause not in CONTRADICTIONS and _is_explained_by_one_side(model, pair):
        return None
    parts = (("COM", deviation.com_offset), ("inertia tensor", deviation.spread))
    differences = describe_differences(side.actual, side.expected, deviation=deviation, threshold=note)
    data: dict[str, Any] = {
        "one": both[0].link.name,
        "other": both[1].link.name,
        "link": side.link.name,
        "twin": side.twin.name,
        "relation": (BOTH_SIDES_RELATIONS if wrong is None else ONE_SIDE_RELATIONS)[pair.drawn_as or ""].format(
            side.twin.name
        ),
        "lack": LACKS[pair.drawn_as or ""],
        "differences": ", ".join(differences),
        "what": " and ".join(word for word, share in parts if share > note),
        "signs": join_names(find_wrong_signs(side.actual, side.expected, note), 9),
        "share": deviation.worst,
        "between": _list_subjects(both[0].link, both[1].link),
    }
    place: dict[str, Any] = {
        "at": _locate_difference(model, side.link, deviation, note=note),
        "related": [_locate_difference(model, side.twin, deviation, note=note)],
        "cause": cause,
        "severity": shares.choose_severity(deviation.worst, pair, cause),
    }
    shared = _has_shared_inertial(side)
    if wrong is None:
        repair = "export both again: neither COM is that of the part that it draws"
        if deviation.com_offset <= note or not all(_has_com_elsewhere(model, one.link) for one in both):
            other_way = "the other way round" if shared else _describe_remedy(both[0], note)
            repair = f"correct the wrong one: {_describe_remedy(both[1], note)}, or {other_way}"
        return rule.finding("pair", **place, repair=repair, **data)
    edits = () if shared else make_attribute_edits(list_inertial_changes(side, note))
    message, remedy = "like" if like else "inertial", _describe_remedy(side, note)
    return rule.finding(message, **place, edits=edits, remedy=remedy, like=join_names(like), **data)


def _has_com_elsewhere(model: Model, link: Link) -> bool:
    """Whether the COM is so far from the drawn part's that its mirror image does not repair the twin."""
    diagnosed, drawn = inertial_diagnoses(model).get(link.name), measure_link_geometry(model, link)
    if diagnosed is None or drawn is None:
        return False
    _, com_mismatch = measure_inertial_mismatch(diagnosed.declared, drawn.solid.com, drawn.solid.covariance)
    return com_mismatch > FAR


def _is_explained_by_one_side(model: Model, pair: MirrorPair) -> bool:
    """Whether INR009 reports a mistake in one of the links, which explains the difference: that of the masses, too."""
    masses = [model.mass_by_name[name].mass for name in (pair.one, pair.other) if name in model.mass_by_name]
    is_mass_off = len(masses) == 2 and not math.isclose(*masses, rel_tol=_SAME_MASS)
    causes = []
    for name in (pair.one, pair.other):
        diagnosed = inertial_diagnoses(model).get(name)
        cause = None if diagnosed is None or not diagnosed.diagnosis.at_fault else diagnosed.diagnosis.cause
        causes.append(None if cause == UNMIRRORED or (is_mass_off and cause not in _MASS_CAUSES) else cause)
    return causes[0] != causes[1]


def _compare_principal_moments(model: Model, rule: Rule, pair: MirrorPair, *, shares: _Shares) -> Finding | None:
    """Compare what mirror images and copies have in common, for a pair whose drawings are not related.

    Frames that are not mirror images may belong to parts that are not: there, only one mistake that explains all counts.
    """
    if pair.drawn_as not in {None, "neither"} or not pair.is_named or pair.is_alike is False:
        return None
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = get_comparable_inertial(one), get_comparable_inertial(other)
    if first is None or second is None:
        return None
    deviation, note = measure_principal_deviation(second, first), shares.note
    slip = find_slip_between_twins(first, second)
    if slip is None and not (pair.is_in_place and deviation.worst > note):
        return None
    if slip is None and fit_own_drawings_alike(model, one, other, threshold=note):
        return None
    differences = []
    if deviation.mass > note:
        differences.append(f"masses of {first.mass:.4g} and {second.mass:.4g} kg")
    if deviation.spread > note:
        moments = _format_principal_moments(first), _format_principal_moments(second)
        differences.append(f"principal moments of ({moments[0]}) and ({moments[1]}) kg·m²")
    if not differences:
        distances = [format_length(float(np.linalg.norm(numbers.com))) for numbers in (first, second)]
        differences.append(f"COMs {distances[0]} and {distances[1]} from their frames")
    ratio = float(np.trace(first.tensor)) / float(np.trace(second.tensor))
    copied = None if slip is not None else find_copied_side(model, one, other)
    wrong, right = (
        (one, other) if (slip is not None and slip.is_first) or (copied and copied[0] is one) else (other, one)
    )
    return rule.finding(
        "moments",
        at=_locate_difference(model, wrong, deviation, note=note),
        related=[_locate_difference(model, right, deviation, note=note)],
        severity=Severity.WARNING if slip is not None else shares.choose_severity(deviation.worst, pair),
        cause=_name_slip(slip) if slip is not None else "other_part" if copied is not None else None,
        factor=f"{max(ratio, 1.0 / ratio):,.0f}",
        wrong=wrong.name,
        source="" if copied is None else copied[1].name,
        detail="" if slip is None else slip.mistake.detail,
        mistake="" if slip is None else _describe_slip(slip),
        one=one.name,
        other=other.name,
        differences=" and ".join(differences),
        share=max(deviation.worst, shares.differ) if slip is not None else deviation.worst,
        between=_list_subjects(one, other),
    )


def _describe_slip(slip: TwinSlip) -> str:
    if slip.mistake.id == "com_unit":
        return f"the COM in {slip.mistake.detail}"
    return describe_mistake(slip.mistake.id, slip.mistake.detail)


def _name_slip(slip: TwinSlip) -> str:
    """Return the id of the cause on the page."""
    if slip.is_either:
        return "decimal"
    return {"inertia_unit": "unit", "mass_unit": "mass_unit"}.get(slip.mistake.id, "slip")


def _format_principal_moments(numbers: DeclaredInertial) -> str:
    return join_numbers(np.linalg.eigvalsh(numbers.inertia), digits=3)


def _locate_difference(model: Model, link: Link, deviation: InertialDeviation, *, note: float) -> Located:
    return locate_difference(model.tensor_by_name[link.name].inertial, deviation, note)


def _describe_remedy(side: PairSide, note: float) -> str:
    return describe_remedy(
        list_inertial_changes(side, note), side.link.name, side.twin.name, shared=_has_shared_inertial(side)
    )


def _has_shared_inertial(side: PairSide) -> bool:
    """Whether one text makes the inertials of both sides."""
    one, other = side.link.inertial, side.twin.inertial
    return one is not None and other is not None and one.element.span == other.element.span


def _list_subjects(*both: Link | Joint) -> list[str]:
    """Return the subjects of both sides: a stronger rule that reports either supersedes this one."""
    return [one.location.subject for one in both]


# -- joints -----------------------------------------------------------------------------------------------------------


def _compare_limits(model: Model, rule: Rule, pairs: Sequence[MirrorPair], *, shares: _Shares) -> Iterator[Finding]:
    mismatches = [
        mismatch
        for pair in _skip_repeated_pairs(pairs)
        if (mismatch := find_mismatched_limit(model, pair, known_pairs=pairs, threshold=shares.note)) is not None
    ]
    if mismatches and are_limits_measured(model, pairs):
        # Each joint was calibrated: twins differ by little in all of them.
        mismatches = [mismatch for mismatch in mismatches if mismatch.max_difference >= shares.differ]
    for chain in group_by_chain(mismatches):
        if len(chain) < MIN_CHAIN_JOINTS:
            yield from (_build_limits_finding(rule, mismatch, shares) for mismatch in chain)
        else:
            yield _build_chain_finding(model, rule, chain, shares=shares)


def _skip_repeated_pairs(pairs: Iterable[MirrorPair]) -> Iterator[MirrorPair]:
    """Yield the pairs, but not those of links in an earlier pair."""
    paired: set[str] = set()
    for pair in pairs:
        if not paired & {pair.one, pair.other}:
            paired |= {pair.one, pair.other}
            yield pair


def _build_limits_finding(rule: Rule, mismatch: MismatchedLimit, shares: _Shares) -> Finding:
    joint, twin = mismatch.joint, mismatch.twin
    limits = [side.limit or side.element for side in (joint, twin)]
    cause = "limits_copied" if mismatch.copied else None
    shared = limits[0].span == limits[1].span
    changes = [
        change_numbers(limits[0].attributes.get(name), name, f"{value + 0.0:.10g}")
        for name, value in mismatch.expected.items()
    ]
    return rule.finding(
        "limits" if mismatch.agreeing_joints else "limits_pair",
        at=limits[0],
        related=limits[1:],
        cause=cause,
        severity=shares.choose_severity(mismatch.max_difference, mismatch.pair, cause),
        edits=make_attribute_edits(changes) if mismatch.agreeing_joints and not shared else [],
        joint=joint.name,
        twin=twin.name,
        differences=_describe_limit_differences(mismatch),
        like=join_names(mismatch.agreeing_joints),
        remedy=describe_remedy(changes, joint.name, twin.name, shared=shared),
        share=mismatch.max_difference,
    )


def _build_chain_finding(model: Model, rule: Rule, chain: Sequence[MismatchedLimit], *, shares: _Shares) -> Finding:
    limits = [limit for pair in chain for limit in (pair.joint.limit, pair.twin.limit) if limit is not None]
    cause = "shifted" if is_shifted(model, chain, shares.note) else None
    return rule.finding(
        "chain",
        at=limits[0],
        related=limits[1:],
        cause=cause,
        severity=shares.choose_severity(max(pair.max_difference for pair in chain), chain[0].pair, cause),
        count=len(chain),
        joints=join_names((pair.joint.name for pair in chain), 12),
        twins=join_names((pair.twin.name for pair in chain), 12),
        joint=chain[0].joint.name,
        differences=_describe_limit_differences(chain[0]),
    )


def _describe_limit_differences(mismatch: MismatchedLimit) -> str:
    return ", ".join(
        f"{name} {mismatch.joint.get_limit_value(name) or 0.0:.6g} instead of {value + 0.0:.6g}"
        for name, value in mismatch.expected.items()
    )


def _compare_dynamics(model: Model, rule: Rule, pair: MirrorPair, *, shares: _Shares) -> Finding | None:
    joints = find_pair_joints(model, pair)
    if joints is None or pair.drawn_as == "neither":
        return None
    elements = [joint.element.find_child("dynamics") for joint in joints]
    differences: list[str] = []
    share = 0.0
    for name in ("damping", "friction"):
        a, b = (0.0 if e is None or name not in e.attributes else read_attribute_number(e, name) for e in elements)
        if a is not None and b is not None and abs(a - b) > shares.note * max(abs(a), abs(b)):
            differences.append(f"{name} {b:g} instead of {a:g}")
            share = max(share, abs(a - b) / max(abs(a), abs(b)))
    if not differences:
        return None
    return rule.finding(
        "dynamics",
        at=elements[1] or joints[1].element,
        related=[elements[0] or joints[0].element],
        severity=shares.choose_severity(share, pair),
        joint=joints[1].name,
        twin=joints[0].name,
        differences=", ".join(differences),
        share=share,
    )


def _compare_origins(model: Model, rule: Rule, pair: MirrorPair, *, pairs: Sequence[MirrorPair]) -> Finding | None:
    off = find_misplaced_joint(model, pair, pairs)
    if off is None:
        return None
    both = off.joint, off.twin
    data: dict[str, Any] = {"joint": off.joint.name, "twin": off.twin.name, "between": _list_subjects(*both)}
    if off.distance:
        at, related = (locate_origin_attribute(joint, "xyz") for joint in both)
        back, there = off.places
        first, second = _describe_move(off.joint, off.twin, there), _describe_move(off.twin, off.joint, back)
        if off.carries_mirrored:
            # What it carries must stay where it is.
            first, second = (f"{move} and move what it carries back by as much" for move in (first, second))
        return rule.finding(
            "origin", at=at, related=[related], distance=off.distance * 1e3, first=first, second=second, **data
        )
    at, related = (locate_origin_attribute(joint, "rpy") if off.turned else joint.axis_location for joint in both)
    return rule.finding("axis", at=at, related=[related], angle=math.degrees(off.angle), **data)


def _report_slip(rule: Rule, slip: OriginSlip) -> Finding:
    joint, twin = slip.joint, slip.twin
    at, related = (locate_origin_attribute(one, "xyz") for one in (joint, twin))
    attribute = joint.origin.get_attribute("xyz")
    return rule.finding(
        "slip",
        at=at,
        related=[related],
        cause=slip.kind,
        joint=joint.name,
        twin=twin.name,
        parent=joint.parent,
        typed="0 0 0" if attribute is None else attribute.value,
        expected=format_point(slip.expected, decimals=6),
        distance=float(np.linalg.norm(np.array(joint.origin.xyz or (0, 0, 0)) - slip.expected)) * 1e3,
        first=_describe_move(joint, twin, slip.expected),
        second=_describe_move(twin, joint, slip.twin_expected),
        between=_list_subjects(joint, twin),
    )


def _report_odd_sign(rule: Rule, odd: OddSign) -> Finding:
    joint, like = odd.joint, odd.others[0]
    places = [one.axis_location if odd.is_axis else locate_origin_attribute(one, "xyz") for one in (joint, *odd.others)]
    attributes = [
        (None if one.axis_element is None else one.axis_element.attributes.get("xyz"))
        if odd.is_axis
        else one.origin.get_attribute("xyz")
        for one in (joint, like)
    ]
    typed, expected = ("" if attribute is None else attribute.value for attribute in attributes)
    return rule.finding(
        "reversed" if odd.is_axis else "sign",
        at=places[0],
        related=places[1:],
        edits=edit_all_numbers([(attributes[0], expected)]) if attributes[0] is not None and expected else [],
        joint=joint.name,
        twin=like.name,
        like=join_names(one.name for one in odd.others),
        typed=typed,
        expected=expected,
    )


def _report_odd_numbers(rule: Rule, odd: OddNumbers) -> Finding:
    joint, is_axis = odd.joint, odd.attribute == "axis"
    places = [
        one.axis_location if is_axis else locate_origin_attribute(one, odd.attribute) for one in (joint, *odd.others)
    ]
    attribute, like = (
        (None if one.axis_element is None else one.axis_element.attributes.get("xyz"))
        if is_axis
        else one.origin.get_attribute(odd.attribute)
        for one in (joint, odd.others[0])
    )
    words = format_point(odd.expected, decimals=6).split() if like is None else like.value.split()
    if odd.attribute == "xyz":
        signs = ["-" if value < 0 else "" for value in odd.expected.tolist()]
        words = [sign + word.lstrip("+-") for sign, word in zip(signs, words, strict=True)]
    expected = " ".join(words)
    return rule.finding(
        "odd",
        at=places[0],
        related=places[1:],
        edits=edit_all_numbers([(attribute, expected)]) if attribute is not None else [],
        joint=joint.name,
        count=len(odd.others),
        like=join_names(one.name for one in odd.others),
        what="axis" if is_axis else f"origin's {odd.attribute}",
        typed="1 0 0" if attribute is None and is_axis else "0 0 0" if attribute is None else attribute.value,
        expected=expected,
    )


def _report_coincidence(rule: Rule, one: Joint, other: Joint) -> Finding:
    at, related = (locate_origin_attribute(joint, "xyz") for joint in (one, other))
    attribute = one.origin.get_attribute("xyz")
    return rule.finding(
        "coincident",
        at=at,
        related=[related],
        joint=one.name,
        twin=other.name,
        one=one.child,
        other=other.child,
        parent=one.parent,
        typed="" if attribute is None else attribute.value,
        between=_list_subjects(one, other),
    )


def _describe_move(joint: Joint, twin: Joint, place: Array) -> str:
    """Return the instruction that moves a joint to another position (3,) in the frame of its parent."""
    text = format_point(place, decimals=6)
    attributes = [one.origin.get_attribute("xyz") for one in (joint, twin)]
    shared = attributes[0] is not None and attributes[1] is not None and attributes[0].span == attributes[1].span
    return describe_remedy([change_numbers(attributes[0], "xyz", text)], joint.name, twin.name, shared=shared)
