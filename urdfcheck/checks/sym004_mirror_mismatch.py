"""SYM004 reports left and right parts that are not mirror images of each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from typing import Any

import numpy as np

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.certainty import FAR
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.placeholders import is_round
from urdfcheck.facts.inertials.twin_slips import TwinSlip, differ_by_last_digits, find_rounding
from urdfcheck.facts.likeness.mirror import (
    InertialDeviation,
    are_alike_when_spun,
    find_wrong_signs,
    measure_outline_mismatch,
    measure_principal_deviation,
)
from urdfcheck.model import DeclaredTensor, Joint, Link, Model
from urdfcheck.model.inertials.habits.minor_findings import set_lost_aside
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.inertial_differences import describe_differences, locate_difference
from urdfcheck.model.inertials.inertial_effects import has_unknown_mass, is_chance_decimal
from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, enclosed_inertials
from urdfcheck.model.inertials.mirrored_inertials import (
    CONTRADICTIONS,
    FACETS,
    PairSide,
    compare_sides,
    find_cause,
    find_copied_side,
    find_half_turn,
    find_side_slip,
    find_typed_side,
    find_wrong_side,
    fit_own_drawings_alike,
    get_comparable_inertial,
    get_possible_inertial,
    is_tensor_against_drawing,
    limit_to_com,
    list_inertial_changes,
)
from urdfcheck.model.inertials.proposals.com_places import has_com_of_own_mesh
from urdfcheck.model.inertials.typed_tensors import describe_typed_tensor
from urdfcheck.model.inertials.unrelated_sides import UnlikeSides, compare_unrelated_sides, describe_slip
from urdfcheck.model.likeness.mirror_pairs import MUCH_BETTER, MirrorPair, mirror_pairs
from urdfcheck.model.likeness.mirror_places import PlaceMistake, iter_place_mistakes
from urdfcheck.model.likeness.mirrored_joints import (
    MismatchedLimit,
    are_limits_measured,
    are_moved_apart,
    find_leading_link,
    find_mismatched_limit,
    find_pair_joints,
    find_spin_axis,
    group_by_chain,
    is_shifted,
)
from urdfcheck.model.likeness.shape_comparison import DIFFERENT, get_outline
from urdfcheck.model.repairs.edits import AttributeChange, change_numbers, describe_remedy, make_attribute_edits
from urdfcheck.model.repairs.inertial_edits import have_one_text, list_number_attributes
from urdfcheck.model.shapes.repeated_drawings import are_drawn_in_one_place
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, measure_link_geometry
from urdfcheck.source.text.values import read_attribute_number

# INR009 leaves this mistake to SYM004.
UNMIRRORED = "unmirrored"
# Mistakes that change the mass, or its ratio to the tensor: no other explains that one side is heavier by more than this share.
_MASS_CAUSES = frozenset({"mass_unit", "units", "other_mass", "decimal_point", "mesh_scale"})
_SAME_MASS = 0.2
# Moments of two sides that differ by less, as a share of a length, need no explanation; a mistake that is one leaves less than
# the other share of it.
_SLIGHT_SPREAD, _NEARER = 0.01, 0.5
# Tensors of two exports of one part differ by less (chosen).
_TWO_EXPORTS = 0.1
# Numbers of one side are near what it draws within this share of what is far (chosen), where nothing else says which is wrong.
_NEAR = 0.25
# A COM is the drawn part's within this share of a radius of gyration.
_OWN_COM = 0.02
# A COM is outside its drawing beyond this share of the drawing's size, as for INR006.
_OUTSIDE = 0.1
# Of numbers that are the other side's apart from signs one is the image of the other, whatever else is wrong with both.
_SIGN_CAUSES = frozenset({"signs", "products_sign", *CONTRADICTIONS})
_COMPUTE_BOTH_COMS = "compute both COMs from the parts: neither is near that of what is drawn"
# A COM that is off by less (m) may be that of a part that was turned, not mirrored, without making a difference (chosen).
_SLIGHT_TURN = 1e-3
_COMPARE_DRAWINGS = "compare both sides with the CAD model: a drawing or an inertial is wrong"
_DOUBT = "whether an inertial or a drawing is wrong"
_COMPUTE_BOTH_INERTIALS = "compute both inertials from the parts: neither is near that of what is drawn"
# What is so where the masses and the COMs are the same, and where no joint moves one side without the other.
_MASS_MATRIX = "the mass matrix differs between the two sides"
_OFF_PLANE = "the COM of the body that holds both is shifted to one side"
_SKEW_TENSOR = "the tensor of the body that holds both is not that of two equal sides"
_COMPUTE_TENSOR = "take the inertia tensors of both from the CAD model"
# So many other pairs that agree, and none that does not, show that left and right are made of the same parts (chosen).
_SAME_PAIRS = 4
# Joints of limbs are slower (rad/s or m/s): chosen.
_UNREACHED = 100.0
# No drive turns a joint so fast (rad/s or m/s), as for JNT007.
_NO_DRIVE = 1e4
# What programs do with an axis about which the limits leave no room.
_UNMOVED = dict.fromkeys(("pinocchio", "gazebo", "mujoco"), "loads it: the limits leave the joints no room")
_FREED = {"mujoco": "ignores equal limits: the joints turn about these axes"}
_NOT_TURNED = "loads it: no joint turns either link, so their tensors change nothing"
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
# Two exports of one part have the same numbers to within this share.
_LAST_DIGITS = 1e-6
# Drawings that are turned by less (rad) are shifted copies.
_SAME_AXES = 1e-6


def check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    yield from set_lost_aside(model, rule, _check(model, rule, differ=differ, note=note))


def _check(model: Model, rule: Rule, *, differ: float, note: float) -> Iterator[Finding]:
    pairs, shares = mirror_pairs(model), _Shares(differ, note)
    mistakes = list(iter_place_mistakes(model, pairs))
    misplaced = {joint.name for mistake in mistakes for joint in mistake.joints}
    yield from _compare_limits(model, rule, pairs, shares=shares, misplaced=misplaced)
    for mistake in mistakes:
        yield rule.finding(
            mistake.message,
            at=mistake.at,
            related=mistake.related,
            cause=mistake.cause,
            edits=mistake.edits,
            severity=Severity.INFO if mistake.is_minor or _is_unmoved(model, mistake) else None,
            consequences=_UNMOVED | (_FREED if mistake.is_freed_by_mujoco else {}) if mistake.is_unmoved else None,
            **mistake.data,
        )
    reported: dict[str, set[str]] = {"inertial": set(), "dynamics": set()}
    for pair in pairs:
        for subject, finding in (
            ("inertial", _compare_inertials(model, rule, pair, shares=shares)),
            ("dynamics", _compare_dynamics(model, rule, pair, shares=shares)),
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


def _is_unmoved(model: Model, mistake: PlaceMistake) -> bool:
    """Whether nothing turns about axes that are wrong, in any of the programs that are meant."""
    return mistake.is_unmoved and not (mistake.is_freed_by_mujoco and "mujoco" in model.targets)


def _compare_inertials(model: Model, rule: Rule, pair: MirrorPair, *, shares: _Shares) -> Finding | None:
    both, note = compare_sides(model, pair), shares.note
    if both is None:
        if _is_explained_by_one_side(model, pair):
            return None
        return _compare_principal_moments(model, rule, pair, shares=shares)
    is_rounded = _is_rounded(both)
    if not both[1].deviation.worst > note and not is_rounded:
        return None
    if are_drawn_in_one_place(model, both[0].link, both[1].link):
        return _build_drawing_finding(rule, pair, both[1], shares=shares)
    typed, wrong = _judge_sides(model, pair, both, note=note)
    side, like = (both[1], ()) if wrong is None else wrong
    if not is_rounded and _may_differ(model, pair, side, note=note, is_decided=wrong is not None):
        return None
    deviation = side.deviation
    # The visual mesh of one may be out of place (GEO005), and its collision mesh is not.
    if max(deviation.mass, deviation.spread) <= note < deviation.com_offset and all(
        has_com_of_own_mesh(model, one.link, one.actual, one.expected) for one in (both if wrong is None else [side])
    ):
        return None
    why = _explain_difference(model, pair, both, typed=typed, side=side, note=note, is_decided=wrong is not None)
    if why.cause not in CONTRADICTIONS and _is_explained_by_one_side(model, pair):
        return None
    cause = why.cause
    if cause is None and wrong is None and _may_hold_drive(model, pair, both[1].deviation, note):
        return None
    is_unfelt = _is_tensor_unfelt(model, pair, deviation, note)
    # Tensors of few digits that differ in the last one are those of one part.
    is_last_digit = (
        cause is None
        and max(deviation.mass, deviation.com_offset) <= note
        and differ_by_last_digits(side.actual, side.expected)
    )
    # The twin's tensor is wrong too if its products contradict the drawing: then the COM alone can be written.
    barred = [one for one in both if deviation.spread > note and is_tensor_against_drawing(model, one)]
    is_barred = wrong is not None and any(one.link is side.link for one in barred)
    written = limit_to_com(model, side, note) if is_barred else side
    shown = written or side
    parts = (("COM", deviation.com_offset), ("inertia tensor", deviation.spread))
    differences = describe_differences(shown.actual, shown.expected, deviation=shown.deviation, threshold=note)
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
        "fitting": "inertial" if written is side else "COM",
        "what": " and ".join(word for word, share in parts if share > note),
        "signs": join_names(find_wrong_signs(side.actual, side.expected, note), 9),
        "share": deviation.worst,
        "between": _list_subjects(both[0].link, both[1].link),
        **_collect_cause_data(both, why),
    }
    share = max(deviation.worst, shares.differ) if why.is_slip else deviation.worst
    place: dict[str, Any] = {
        "at": _locate_difference(model, side.link, shown.deviation, note=note),
        "related": [_locate_difference(model, side.twin, shown.deviation, note=note)],
        "cause": cause,
        "severity": Severity.INFO if is_unfelt or is_last_digit else shares.choose_severity(share, pair, cause),
        "consequences": _describe_consequences(model, pair, deviation, note),
    }
    if wrong is None:
        if deviation.worst == deviation.com_offset and all(_is_outside_body(model, one.link) for one in both):
            return None  # INR006 reports both
        repair = _describe_either_repair(model, both, why, note=note, is_barred=len(barred) == len(both))
        # Numbers that are off by a few percent are two exports of one assembly, or change nothing.
        is_slight = share < shares.differ
        data["doubt"] = "which mass is wrong" if _is_of_mass_alone(deviation, note) else _DOUBT
        if repair in {_COMPUTE_BOTH_COMS, _COMPUTE_BOTH_INERTIALS}:
            # Neither was right before it was copied.
            cause = cause if why.is_slip else None
            severity = Severity.INFO if is_unfelt or is_last_digit else shares.choose_severity(share, pair, cause)
            place |= {"cause": cause, "severity": severity}
            return rule.finding("pair_slight" if is_slight else "both", **place, repair=repair, **data)
        return rule.finding("pair_slight" if is_slight else "pair", **place, repair=repair, **data)
    if written is not None and deviation.com_offset > note and _has_com_outside(model, side.twin):
        written = None
        name = side.twin.name
        remedies = [f"repair the COM of {name} first: it is outside the drawn part; then compare the two again"]
    else:
        remedies = [] if written is None else [_describe_remedy(written, note)]
    # Masses stay as they are: where they differ, the rest alone repairs nothing.
    changes = [] if written is None else list_inertial_changes(written, note)
    is_partial = written is None or _has_shared_text(written, changes) or deviation.mass > shares.differ
    # One slip moves a COM beyond its part; that the tensors differ as those of two exports is nothing that the twin repairs.
    is_partial |= deviation.com_offset > 1.0 and note < deviation.spread < _TWO_EXPORTS
    edits = () if is_partial else make_attribute_edits(changes)
    if is_barred:
        remedies.append(
            f"{_COMPUTE_TENSOR}: {side.twin.name} has products of inertia with other signs than those of its drawing"
        )
    data["explains"] = _list_explained(side, place["severity"], note) if edits else []
    message = "typed" if typed is not None else "like" if like else "inertial"
    remedy = "; ".join(remedies)
    return rule.finding(message, **place, edits=edits, remedy=remedy, like=join_names(like), **data)


def _is_rounded(both: Sequence[PairSide]) -> bool:
    """Whether one side has the other's tensor with too few digits: the smallest moment is off, however little the sum is."""
    side = both[1]
    return any(
        find_rounding(*numbers) is not None for numbers in ((side.actual, side.expected), (side.expected, side.actual))
    )


def _describe_either_repair(
    model: Model, both: Sequence[PairSide], why: _Explanation, *, note: float, is_barred: bool
) -> str:
    """Describe the repair where nothing shows which side is wrong; ``is_barred``: the tensor of neither repairs the other."""
    if is_barred:
        return f"{_COMPUTE_TENSOR}: neither has products of inertia with the signs of its drawing"
    if why.cause == "half_turn":
        return _COMPARE_DRAWINGS
    if (why.cause not in _SIGN_CAUSES or _are_both_elsewhere(model, both, note)) and not _is_of_mass_alone(
        both[1].deviation, note
    ):
        if both[1].deviation.com_offset > note and all(_has_com_elsewhere(model, one.link) for one in both):
            return _COMPUTE_BOTH_COMS
        if all(_has_other_inertial(model, one.link) for one in both):
            return _COMPUTE_BOTH_INERTIALS
    mistaken = [side for side in both if side.link is why.find_mistaken_link(both)]
    if mistaken:
        return f"if that is the mistake, {_describe_remedy(mistaken[0], note)}"
    one, other = both[0].link.name, both[1].link.name
    is_shared = _has_shared_text(both[1], list_inertial_changes(both[1], note))
    other_way = "the other way round" if is_shared else _describe_remedy(both[0], note)
    return f"if {one} is right, {_describe_remedy(both[1], note)}; if {other} is, {other_way}"


def _are_both_elsewhere(model: Model, both: Sequence[PairSide], note: float) -> bool:
    """Whether each COM is farther from the drawn part's than from that of the other side: whichever is the image of the other,
    neither is that of its part."""
    off = float(np.linalg.norm(both[1].actual.com - both[1].expected.com))
    return both[1].deviation.com_offset > note and all(
        _has_com_elsewhere(model, one.link) and _measure_distance_to_drawing(model, one) > off / 2 for one in both
    )


def _measure_distance_to_drawing(model: Model, side: PairSide) -> float:
    """Measure how far (m) the COM of a side is from that of what it draws; 0 where that is not known."""
    drawn = measure_link_geometry(model, side.link)
    return 0.0 if drawn is None else float(np.linalg.norm(side.actual.com - drawn.solid.com))


def _is_of_mass_alone(deviation: InertialDeviation, note: float) -> bool:
    """Whether nothing but the mass of a side differs."""
    return max(deviation.com_offset, deviation.spread) <= note < deviation.mass


def _list_explained(side: PairSide, severity: Severity, note: float) -> list[str]:
    """List what is the same repair: that of a COM outside what is drawn."""
    is_of_com = side.deviation.com_offset > note and severity is Severity.WARNING
    return [f"INR006 link[{side.link.name}]"] if is_of_com else []


def _may_differ(model: Model, pair: MirrorPair, side: PairSide, *, note: float, is_decided: bool) -> bool:
    """Whether the difference of two sides may be right: of drawings that are shifted, of a part that turns, or, where nothing has
    ``is_decided`` which side is wrong, of numbers that relate alike to what each side draws."""
    axis = find_spin_axis(model, pair, side.link.name)
    if not is_decided and (_is_slight_turn(side, note) or _is_drawn_turned(model, pair, side, note)):
        return True
    if _are_shifted_drawings(pair, side) or (
        axis is not None and are_alike_when_spun(side.actual, side.expected, axis, note)
    ):
        return True
    links = model.link_by_name[pair.one], model.link_by_name[pair.other]
    return not is_decided and fit_own_drawings_alike(
        model, *links, threshold=note, com_threshold=_OWN_COM, linear=pair.linear
    )


def _judge_sides(
    model: Model, pair: MirrorPair, both: Sequence[PairSide], *, note: float
) -> tuple[Link | None, tuple[PairSide, tuple[str, ...]] | None]:
    """Find the side whose tensor was typed, where that makes the difference, and the side that is wrong, with the links that say
    so."""
    typed = find_typed_side(both[0].link, both[1].link) if both[1].deviation.spread > note else None
    if typed is not None:
        asked = _ask_drawings(model, pair, both, (both[both[1].link is typed], ()), note=note)
    else:
        found = find_wrong_side(model, pair, both, threshold=note) or _find_side_outside(model, both, note=note)
        asked = _ask_drawings(model, pair, both, found, note=note)
    return (typed if asked is not None and asked[0].link is typed else None), asked


def _ask_drawings(
    model: Model,
    pair: MirrorPair,
    both: Sequence[PairSide],
    wrong: tuple[PairSide, tuple[str, ...]] | None,
    *,
    note: float,
) -> tuple[PairSide, tuple[str, ...]] | None:
    """Return the side that is ``wrong``, where what each side draws does not say otherwise: numbers that are far from it repair
    nothing, whichever other links have them. If both are far, neither side has numbers for the other; if one is, it is wrong."""
    if find_cause(pair, both[1], note) in _SIGN_CAUSES:
        return wrong
    misses = [_measure_differing_mismatch(model, side, note) for side in both]
    if min(misses) > FAR:
        return None
    if max(misses) > FAR and (wrong is not None or min(misses) < _NEAR * FAR):
        far = both[misses.index(max(misses))]
        return wrong if wrong is not None and wrong[0].link is far.link else (far, ())
    return wrong


def _measure_differing_mismatch(model: Model, side: PairSide, note: float) -> float:
    """Measure how far what differs between the sides, COM or tensor, is from what a side draws; 0 where that is not known, as a
    collision shape in its place only bounds the part."""
    if explain_collision_stand_in(model, side.link) is not None:
        return 0.0
    tensor, com = _measure_own_mismatch(model, side.link)
    deviation = side.deviation
    return max(tensor if deviation.spread > note else 0.0, com if deviation.com_offset > note else 0.0)


def _find_side_outside(
    model: Model, both: Sequence[PairSide], *, note: float
) -> tuple[PairSide, tuple[str, ...]] | None:
    """Find the side whose COM is outside what it draws, where its twin's mirrored COM is inside, and the masses agree."""
    deviation = both[1].deviation
    if deviation.com_offset <= note or deviation.mass > note:
        return None
    outside = [side for side in both if _is_outside(model, side.link, side.actual)]
    return (
        (outside[0], ()) if len(outside) == 1 and not _is_outside(model, outside[0].link, outside[0].expected) else None
    )


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Explanation:
    """Why two sides differ."""

    cause: str | None
    """Its id on the page."""
    typed: Link | None = None
    """The side whose tensor was typed."""
    slip: TwinSlip | None = None
    """The one mistake without which the two agree."""
    copied: tuple[Link, Link] | None = None
    """The side that has the numbers of another part, and that part."""
    axis: str = ""
    """The axis about which half a turn makes one side's numbers those of the other."""

    def find_mistaken_link(self, both: Sequence[PairSide]) -> Link | None:
        """Find the link in which the cause is; None where it may be in either."""
        if self.copied is not None:
            return self.copied[0]
        if self.slip is None or self.slip.is_either or self.cause is None:
            return None
        return both[not self.slip.is_first].link

    @property
    def is_slip(self) -> bool:
        """Whether one slip explains all of the difference: it is one however small the difference is."""
        return self.slip is not None or self.cause == "rounded"


def _explain_difference(
    model: Model,
    pair: MirrorPair,
    both: Sequence[PairSide],
    *,
    typed: Link | None,
    side: PairSide,
    note: float,
    is_decided: bool,
) -> _Explanation:
    """Explain why the ``side`` is not as its twin says. Where the drawing has ``is_decided`` that it is the wrong one, a mistake
    of the other explains nothing."""
    if typed is not None:
        return _Explanation(cause="placeholder", typed=typed)
    cause = find_cause(pair, side, note)
    if cause == "signs" and not is_decided and (axis := find_half_turn(side, note)) is not None:
        return _Explanation(cause="half_turn", axis=axis)
    if cause is not None:
        return _Explanation(cause=cause)
    slip = find_side_slip(both, note)
    if slip is not None and (not is_decided or slip.is_either or both[not slip.is_first].link is side.link):
        return _Explanation(cause=_name_slip(slip, [one.actual for one in both]), slip=slip)
    copied = find_copied_side(model, both[0].link, both[1].link)
    if copied is not None and (not is_decided or copied[0] is side.link):
        return _Explanation(cause="other_part", copied=copied)
    return _Explanation(cause=None)


def _build_drawing_finding(rule: Rule, pair: MirrorPair, side: PairSide, *, shares: _Shares) -> Finding:
    """Report a side that draws the part of the other in its place: what it draws may be wrong, and its numbers right."""
    deviation = side.deviation
    differences = describe_differences(side.actual, side.expected, deviation=deviation, threshold=shares.note)
    return rule.finding(
        "drawing",
        at=side.link.visuals[0],
        related=[side.twin.visuals[0]],
        severity=shares.choose_severity(deviation.worst, pair),
        link=side.link.name,
        twin=side.twin.name,
        differences=", ".join(differences),
        share=deviation.worst,
        between=_list_subjects(side.link, side.twin),
    )


def _describe_consequences(
    model: Model, pair: MirrorPair, deviation: InertialDeviation, note: float
) -> dict[str, str] | None:
    """Return what programs do where that is less than the page says; None where it is not."""
    has_weight = max(deviation.mass, deviation.com_offset) > note
    if _is_tensor_unfelt(model, pair, deviation, note):
        return dict.fromkeys(("pinocchio", "gazebo"), _NOT_TURNED)
    if not are_moved_apart(model, pair):
        return dict.fromkeys(("pinocchio", "gazebo"), _OFF_PLANE if has_weight else _SKEW_TENSOR)
    return None if has_weight else {"pinocchio": _MASS_MATRIX}


def _is_tensor_unfelt(model: Model, pair: MirrorPair, deviation: InertialDeviation, note: float) -> bool:
    """Whether only the tensors of two sides differ, and joints move both without turning either."""
    if max(deviation.mass, deviation.com_offset) > note:
        return False
    moved = [
        {joint.type for joint in model.tree.find_path_to(name) if joint.is_movable} for name in (pair.one, pair.other)
    ]
    return all(types == {"prismatic"} for types in moved)


def _may_hold_drive(model: Model, pair: MirrorPair, deviation: InertialDeviation, note: float) -> bool:
    """Whether one side leads the joint of the other (``<mimic>``) and is heavier: the one drive of both may be booked there."""
    leader = find_leading_link(model, pair)
    if leader is None or deviation.mass <= note:
        return False
    led = pair.other if leader == pair.one else pair.one
    masses = [model.mass_by_name[name].mass or 0.0 for name in (leader, led) if name in model.mass_by_name]
    return len(masses) == 2 and masses[0] > masses[1]


def _are_shifted_drawings(pair: MirrorPair, side: PairSide) -> bool:
    """Whether two links have one inertial and one drawing, which is elsewhere in one of them: drawing or COM may be wrong."""
    twin = get_comparable_inertial(side.twin)
    if twin is None or not any(
        copy.mismatch < DIFFERENT and np.allclose(copy.rotation, np.eye(3), atol=_SAME_AXES)
        for copy in pair.copy_transforms
    ):
        return False
    size = math.sqrt(float(np.trace(twin.inertia)) / (2.0 * twin.mass))
    return bool(
        math.isclose(side.actual.mass, twin.mass, rel_tol=_LAST_DIGITS)
        and np.allclose(side.actual.com, twin.com, rtol=0.0, atol=_LAST_DIGITS * size)
        and np.allclose(side.actual.inertia, twin.inertia, rtol=0.0, atol=_LAST_DIGITS * float(twin.inertia.max()))
    )


def _is_slight_turn(side: PairSide, note: float) -> bool:
    """Whether a side has the numbers of its twin after half a turn, and only its COM is off, by a little."""
    off = float(np.linalg.norm(side.actual.com - side.expected.com))
    return side.deviation.spread <= note and off < _SLIGHT_TURN and find_half_turn(side, note) is not None


def _is_drawn_turned(model: Model, pair: MirrorPair, side: PairSide, note: float) -> bool:
    """Whether a side has the numbers of its twin after half a turn that carries one drawing onto the other as well as the mirror
    does: then the part is symmetric, and may be on the other side either way."""
    axis = find_half_turn(side, note)
    one, other = get_outline(model, side.twin.name), get_outline(model, side.link.name)
    if axis is None or one is None or other is None or pair.mirror_mismatch is None:
        return False
    turn = np.diag(2.0 * np.eye(3)["xyz".index(axis)] - 1.0)
    mismatch = measure_outline_mismatch(one, other, linear=turn, shift=np.zeros(3))
    return mismatch < MUCH_BETTER * max(FACETS, pair.mirror_mismatch)


def _has_com_outside(model: Model, link: Link) -> bool:
    """Whether the COM is outside the hull of what the link draws: then the numbers are no model for its twin."""
    numbers = get_comparable_inertial(link)
    return numbers is not None and _is_outside(model, link, numbers)


def _is_outside(model: Model, link: Link, numbers: DeclaredInertial) -> bool:
    """Whether a COM is outside the hull of what a link draws, as far as INR006 allows."""
    drawn = measure_link_geometry(model, link)
    return drawn is not None and (
        measure_hull_distance(drawn.points, numbers.com) > _OUTSIDE * measure_extent(drawn.points)
    )


def _is_outside_body(model: Model, link: Link) -> bool:
    """Whether the COM of a link is outside all that its rigid body draws, which INR006 reports."""
    parts = [part for part in enclosed_inertials(model) if part.link is link and part.mass_share >= NEGLIGIBLE_SHARE]
    return bool(parts) and all(
        measure_hull_distance(points, part.com) > _OUTSIDE * measure_extent(points)
        for part in parts
        for points in part.readings
    )


def _has_com_elsewhere(model: Model, link: Link) -> bool:
    """Whether the COM is so far from the drawn part's that its mirror image does not repair the twin."""
    return _measure_own_mismatch(model, link)[1] > FAR


def _has_other_inertial(model: Model, link: Link) -> bool:
    """Whether tensor or COM are so far from the drawn part's that their mirror image does not repair the twin."""
    return max(_measure_own_mismatch(model, link)) > FAR


def _measure_own_mismatch(model: Model, link: Link) -> tuple[float, float]:
    """Measure how far tensor and COM are from those of what a link draws; 0 where that is not known.

    The hull of an open mesh is the most that a part can fill: a smaller tensor may be that of the part.
    """
    diagnosed, drawn = inertial_diagnoses(model).get(link.name), measure_link_geometry(model, link)
    if diagnosed is None or drawn is None:
        return 0.0, 0.0
    tensor, com = measure_inertial_mismatch(diagnosed.declared, drawn.solid.com, drawn.solid.covariance)
    uniform = compute_solid_inertia(drawn.solid, diagnosed.declared.mass)
    is_less = not drawn.closed and np.trace(diagnosed.declared.tensor) < np.trace(uniform)
    return 0.0 if is_less else tensor, com


def _is_explained_by_one_side(model: Model, pair: MirrorPair) -> bool:
    """Whether INR009 reports a mistake in one of the links, which explains the difference: that of the masses, too, and of the
    moments, which are nearer to each other with the mistake undone."""
    masses = [model.mass_by_name[name].mass for name in (pair.one, pair.other) if name in model.mass_by_name]
    is_mass_off = len(masses) == 2 and not math.isclose(*masses, rel_tol=_SAME_MASS)
    causes, declared, undone = [], [], []
    for name in (pair.one, pair.other):
        diagnosed = inertial_diagnoses(model).get(name)
        cause = None if diagnosed is None or not diagnosed.diagnosis.at_fault else diagnosed.diagnosis.cause
        if diagnosed is not None and _is_left_out(model, model.tensor_by_name[name], diagnosed):
            cause = None
        causes.append(None if cause == UNMIRRORED or (is_mass_off and cause not in _MASS_CAUSES) else cause)
        if diagnosed is not None:
            declared.append(diagnosed.declared)
            mended = diagnosed.diagnosis.mended
            undone.append(diagnosed.declared if causes[-1] is None or mended is None else mended)
    if causes[0] == causes[1] or len(declared) < 2:
        return causes[0] != causes[1]
    before, after = measure_principal_deviation(*declared).spread, measure_principal_deviation(*undone).spread
    return before <= _SLIGHT_SPREAD or after < _NEARER * before


def _is_left_out(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether INR009 names no cause: a made-up number is a power of ten off by chance, or the mass is made up."""
    numbers = judged.declared
    return is_chance_decimal(model, tensor, judged) or has_unknown_mass(
        model, tensor.link, numbers.mass, numbers.tensor
    )


def _compare_principal_moments(model: Model, rule: Rule, pair: MirrorPair, *, shares: _Shares) -> Finding | None:
    sides = compare_unrelated_sides(model, pair, threshold=shares.note)
    if sides is None:
        return None
    deviation, slip, note = sides.deviation, sides.slip, shares.note
    if not sides.is_explained and _may_hold_drive(model, pair, deviation, note):
        return None
    is_slip = slip is not None or sides.lost is not None
    share = max(deviation.worst, shares.differ) if is_slip else deviation.worst
    # Without a cause, a few percent are two exports, and sides that nothing shows to be one part may be two.
    is_doubtful = not sides.is_explained and (
        share < shares.differ
        or not (sides.are_drawn or sides.is_of_one_part(note) or _do_others_agree(model, pair, shares.differ))
    )
    severity = Severity.WARNING if is_slip else shares.choose_severity(share, pair)
    repair = "compare both with the CAD model, and give the wrong one the mirrored numbers of the other"
    return rule.finding(
        "moments",
        at=_locate_difference(model, sides.wrong, deviation, note=note),
        related=[_locate_difference(model, sides.right, deviation, note=note)],
        severity=Severity.INFO if is_doubtful or _is_tensor_unfelt(model, pair, deviation, note) else severity,
        consequences=_describe_consequences(model, pair, deviation, note),
        cause=_name_unrelated_cause(sides),
        factor=f"{sides.ratio:,.0f}",
        wrong=sides.wrong.name,
        source="" if sides.copied is None else sides.copied[1].name,
        detail=describe_typed_tensor(sides.wrong) if sides.typed else slip.mistake.detail if slip is not None else "",
        mistake="" if slip is None else describe_slip(slip),
        one=sides.one.name,
        other=sides.other.name,
        differences=sides.describe_differences(note),
        repair="compare both with the CAD model: they may be two exports, or two parts" if is_doubtful else repair,
        share=share,
        between=_list_subjects(sides.one, sides.other),
    )


def _do_others_agree(model: Model, pair: MirrorPair, threshold: float) -> bool:
    """Whether all other left and right links of a robot have the same masses and principal moments, and they are so many that its
    sides are made of the same parts."""
    count = 0
    for other in mirror_pairs(model):
        both = [get_possible_inertial(model.link_by_name[name]) for name in (other.one, other.other)]
        if {other.one, other.other} & {pair.one, pair.other} or both[0] is None or both[1] is None:
            continue
        if not other.is_named or measure_principal_deviation(both[0], both[1]).worst > threshold:
            return False
        count += 1
    return count >= _SAME_PAIRS


def _name_unrelated_cause(sides: UnlikeSides) -> str | None:
    """Return the id of the cause on the page."""
    if sides.typed is not None:
        return "placeholder"
    if sides.lost is not None:
        return "com_missing"
    if sides.slip is not None:
        return _name_slip(sides.slip, sides.numbers)
    return "other_part" if sides.copied is not None else None


def _has_power_of_ten(numbers: DeclaredInertial) -> bool:
    """Whether a tensor is a power of ten times the identity."""
    largest = float(numbers.tensor.max())
    return bool((numbers.tensor == largest * np.eye(3)).all()) and f"{largest:e}".startswith("1.000000e")


def _collect_cause_data(both: Sequence[PairSide], why: _Explanation) -> dict[str, Any]:
    """Return what the cause says."""
    if why.axis:
        return {"axis": why.axis}
    if why.copied is not None:
        return {"wrong": why.copied[0].name, "source": why.copied[1].name}
    if why.typed is not None:
        return {"wrong": why.typed.name, "detail": describe_typed_tensor(why.typed)}
    if why.slip is None:
        return {}
    first, second = (float(np.trace(side.actual.tensor)) for side in both)
    return {
        "wrong": both[not why.slip.is_first].link.name,
        "factor": f"{max(first / second, second / first):,.0f}",
        "detail": why.slip.mistake.detail,
        "mistake": describe_slip(why.slip),
    }


def _name_slip(slip: TwinSlip, numbers: Iterable[DeclaredInertial]) -> str | None:
    """Return the id of the cause on the page; None for two placeholders: 0.1 and 0.001 are a power of ten apart whatever the
    reason."""
    if all(map(_has_power_of_ten, numbers)):
        return None
    if slip.is_either:
        return "decimal"
    return {"inertia_unit": "unit", "mass_unit": "mass_unit"}.get(slip.mistake.id, "slip")


def _locate_difference(model: Model, link: Link, deviation: InertialDeviation, *, note: float) -> Located:
    return locate_difference(model.tensor_by_name[link.name].inertial, deviation, note)


def _describe_remedy(side: PairSide, note: float) -> str:
    changes = list_inertial_changes(side, note)
    # A macro may make both inertials, and take some of the numbers from its calls.
    shared = [change for change in changes if _has_shared_text(side, [change])]
    own = [change for change in changes if change not in shared]
    of_twin = [] if side.twin.inertial is None else list_number_attributes(side.twin.inertial)
    return " and ".join(
        describe_remedy(some, side.link.name, side.twin.name, shared=some is shared, twin_attributes=of_twin)
        for some in (own, shared)
        if some
    )


def _has_shared_text(side: PairSide, changes: Sequence[AttributeChange]) -> bool:
    """Whether one text to change makes the inertials of both sides."""
    one, other = side.link.inertial, side.twin.inertial
    places = [change.attribute for change in changes]
    return one is not None and other is not None and have_one_text(places, one, other)


def _list_subjects(*both: Link | Joint) -> list[str]:
    """Return the subjects of both sides: a stronger rule that reports either supersedes this one."""
    return [one.location.subject for one in both]


# -- joints -----------------------------------------------------------------------------------------------------------


def _compare_limits(
    model: Model, rule: Rule, pairs: Sequence[MirrorPair], *, shares: _Shares, misplaced: AbstractSet[str]
) -> Iterator[Finding]:
    """Report limits that are not mirrored; not those of an axis that other limbs show to be reversed (``misplaced``)."""
    mismatches = [
        mismatch
        for pair in _skip_repeated_pairs(pairs)
        if (mismatch := find_mismatched_limit(model, pair, known_pairs=pairs, threshold=shares.note)) is not None
        and not (mismatch.is_axis_negated and {mismatch.joint.name, mismatch.twin.name} & misplaced)
        and not any(map(_has_other_limits, (mismatch.joint, mismatch.twin)))
    ]
    if mismatches and are_limits_measured(model, pairs):
        # Each joint was calibrated: twins differ by little in all of them.
        mismatches = [mismatch for mismatch in mismatches if mismatch.max_difference >= shares.differ]
    for chain in group_by_chain(mismatches):
        if len(chain) < MIN_CHAIN_JOINTS:
            yield from (_build_limits_finding(rule, mismatch, shares) for mismatch in chain)
        else:
            yield _build_chain_finding(model, rule, chain, shares=shares)


def _has_other_limits(joint: Joint) -> bool:
    """Whether a joint has several ``<limit>`` that differ: XML006 reports that, and any of them may be meant."""
    limits = joint.element.find_children("limit")
    return len({tuple(sorted((a.name, a.value) for a in limit.attributes.values())) for limit in limits}) > 1


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
    cause = "axis_negated" if mismatch.is_axis_negated else "limits_copied" if mismatch.copied else None
    shared = limits[0].span == limits[1].span
    changes = [
        change_numbers(limits[0].attributes.get(name), name, f"{value + 0.0:.10g}")
        for name, value in _list_notable(mismatch, shares).items()
    ]
    message = "limits" if mismatch.agreeing_joints else "limits_negated" if mismatch.is_about_normal else "limits_pair"
    of_twin = list(limits[1].attributes.values())
    remedy = describe_remedy(changes, joint.name, twin.name, shared=shared, twin_attributes=of_twin)
    # A point may have slipped in a number that was then copied to all the others.
    is_decimal = bool(mismatch.agreeing_joints) and _is_power_of_ten_off(
        mismatch, changes=_list_notable(mismatch, shares)
    )
    if is_decimal:
        remedy = f"if {joint.name} is wrong, {remedy}; if the decimal point is wrong in the others, correct these"
    is_certain = bool(mismatch.agreeing_joints) and not (
        mismatch.is_axis_negated or is_decimal or _may_be_in_degrees(joint)
    )
    severity = shares.choose_severity(mismatch.max_difference, mismatch.pair, cause)
    if not (joint.has_room or twin.has_room):
        severity = Severity.INFO
    return rule.finding(
        message,
        at=limits[0],
        related=limits[1:],
        cause=cause,
        severity=Severity.INFO if _is_about_placeholders(mismatch) else severity,
        edits=make_attribute_edits(changes) if is_certain and not shared else [],
        consequences=_describe_limit_consequences([mismatch]),
        joint=joint.name,
        twin=twin.name,
        differences=_describe_limit_differences(mismatch),
        like=join_names(mismatch.agreeing_joints),
        remedy=f"reverse the axis of {joint.name}, or {remedy}" if mismatch.is_axis_negated else remedy,
        share=mismatch.max_difference,
    )


def _list_notable(mismatch: MismatchedLimit, shares: _Shares) -> dict[str, float]:
    """List the expected limits that make the difference: where one is far off, those that are off by little stay as they are."""
    lower, upper = (mismatch.twin.get_limit_value(name) or 0.0 for name in ("lower", "upper"))

    def is_far(name: str, value: float) -> bool:
        typed = mismatch.joint.get_limit_value(name) or 0.0
        size = abs(upper - lower) if name in {"lower", "upper"} else max(abs(typed), abs(value))
        return abs(typed - value) >= shares.differ * size

    far = {name: value for name, value in mismatch.expected.items() if is_far(name, value)}
    return far or dict(mismatch.expected)


def _is_power_of_ten_off(mismatch: MismatchedLimit, *, changes: Mapping[str, float]) -> bool:
    """Whether an effort or a velocity is a power of ten times that of the twin."""
    for name in {"effort", "velocity"} & changes.keys():
        typed, expected = abs(mismatch.joint.get_limit_value(name) or 0.0), abs(changes[name])
        if typed > 0.0 and expected > 0.0:
            power = math.log10(typed / expected)
            if round(power) and math.isclose(power, round(power), abs_tol=1e-6):
                return True
    return False


def _may_be_in_degrees(joint: Joint) -> bool:
    """Whether an end of a hinge's range is beyond two turns: JNT006 knows the unit, and the numbers of the twin may not be its
    own."""
    ends = (abs(joint.get_limit_value(name) or 0.0) for name in ("lower", "upper"))
    return joint.type == "revolute" and max(ends) > 2.0 * math.tau


def _is_about_placeholders(mismatch: MismatchedLimit) -> bool:
    """Whether two limits differ only in round velocities that no joint reaches: then neither side says anything. Or only one has
    a velocity that no drive has: that joint follows the other."""
    velocities = [side.get_limit_value("velocity") or 0.0 for side in (mismatch.joint, mismatch.twin)]
    if min(velocities) < _NO_DRIVE <= max(velocities):
        return True
    return mismatch.expected.keys() == {"velocity"} and all(v >= _UNREACHED and is_round(v) for v in velocities)


def _build_chain_finding(model: Model, rule: Rule, chain: Sequence[MismatchedLimit], *, shares: _Shares) -> Finding:
    limits = [limit for pair in chain for limit in (pair.joint.limit, pair.twin.limit) if limit is not None]
    cause = "shifted" if is_shifted(model, chain, shares.note) else None
    finding = rule.finding(
        "chain",
        at=limits[0],
        related=limits[1:],
        cause=cause,
        severity=shares.choose_severity(max(pair.max_difference for pair in chain), chain[0].pair, cause),
        consequences=_describe_limit_consequences(chain),
        count=len(chain),
        joints=join_names((pair.joint.name for pair in chain), 12),
        twins=join_names((pair.twin.name for pair in chain), 12),
        joint=chain[0].joint.name,
        differences=_describe_limit_differences(chain[0]),
    )
    subjects = (pair.joint.limit for pair in chain if pair.joint.limit is not None)
    return replace(finding, subjects=tuple(limit.location.subject for limit in subjects))


def _describe_limit_consequences(mismatches: Sequence[MismatchedLimit]) -> dict[str, str] | None:
    """Return what MoveIt does where no range differs; None where one does."""
    names = {name for mismatch in mismatches for name in mismatch.expected}
    if names & {"lower", "upper"}:
        return None
    return {
        "moveit": "plans slower motions for one side" if "velocity" in names else "loads it: it plans without efforts"
    }


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
