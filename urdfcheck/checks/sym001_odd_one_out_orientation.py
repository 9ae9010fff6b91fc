"""SYM001 reports a joint whose frame breaks the pattern of matching joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Confidence, Edit, Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_length, join_names
from urdfcheck.facts.likeness.symmetry import (
    OddFrame,
    SuspectFrames,
    find_odd_frame,
    find_suspect_frames,
    is_axis_renaming,
    measure_rotation_angle,
)
from urdfcheck.model import Joint, Model
from urdfcheck.model.ground.wheels import rolling_wheels
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.likeness.sibling_joints import (
    find_common_base,
    is_drawn_in_place,
    is_drawn_square,
    is_frame_evidence,
    is_round_about_joint,
    is_turned_with_frame,
    sibling_joints,
    trace_fixed_chain,
)
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.model.repairs.origin_edits import describe_definitions, list_definitions, locate_origin_attribute
from urdfcheck.model.repairs.rpy_text import ANGLE_TOLERANCE, find_nearest_rpy, format_angle, has_round_angles
from urdfcheck.model.wheel_names import PASSIVE_NAME, WHEEL_CARRIER_NAME, WHEEL_NAME
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# An angle within 0.06° of a multiple of 0.5°, or with at most three decimals, may have been typed by hand (JNT016).
MAX_ROUND_DEVIATION, MAX_TYPED_DECIMALS = 0.06, 3
# Fingers of grippers are drawn in poses that differ by about a degree.
_SLIGHT = math.radians(2)
# The pose of an export may be so much beside the zero of a joint that is calibrated anyway (chosen).
_SMALL = math.radians(1)
# A joint that is turned in its parent as its siblings are, apart from a slip.
_NEAR_SIBLING = math.radians(5)
# Rotations take each other back, and places are turned alike, within this share of what they differ by (chosen).
_RESIDUE = 0.1
# Of a place (m): more than six decimals round off.
_LEAST_MOVE = 1e-5
# An angle (rad) whose axis is plain.
_HALF_TURN = 3.0
# Two joints are opposite each other if they are apart along a mirror by less than this share of their distance across it.
_OPPOSITE = 0.1
NUMBER_WORDS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True, slots=True, eq=False)
class _RotationCorrection:
    """A joint whose rpy has to change."""

    joint: Joint
    expected: Array
    """The rotation (3, 3) that its origin needs."""
    counterparts: tuple[Joint, ...]
    """The joints at its place in the chains of the siblings."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _OrientationOutlier:
    """A joint whose frame breaks the pattern of its siblings."""

    joint: Joint
    others: tuple[Joint, ...]
    """The siblings that follow the pattern."""
    kind: str
    """zero_offset | axis_tilt"""
    angle: float
    """Of its rotation against the expected frame (rad)."""
    expected: Array
    """The rotation (3, 3) of its child that the pattern predicts, in root coordinates."""
    pattern: str
    why: str
    """The evidence, as a clause."""


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    outliers: dict[str, _OrientationOutlier] = {}
    pairs: dict[str, tuple[Joint, Joint, SuspectFrames]] = {}
    for group in sibling_joints(model):
        name = find_common_base(model, group)
        base = model.frames[name]
        frames = np.linalg.inv(base) @ np.array([model.frames[joint.child] for joint in group])
        axes = [joint.axis or (1.0, 0.0, 0.0) for joint in group]
        odd = find_odd_frame(frames[:, :3, 3], frames[:, :3, :3], axes)
        if odd is not None:
            by_pattern = _build_outlier(group, odd, base)
            joint, others = by_pattern.joint, by_pattern.others
            if (
                not _is_choice_of_frame(model, joint, others[0], by_pattern.expected, kind=odd.kind)
                and not _takes_back_drawing(model, by_pattern)
                and not _is_off_before(model, by_pattern)
                and is_frame_evidence(model, joint, others, by_pattern.expected, kind=odd.kind)
            ):
                outliers[joint.name] = by_pattern
            continue
        suspects = find_suspect_frames(frames[:, :3, 3], frames[:, :3, :3], axes)
        if suspects is None or not _has_consistent_bases(model, group, suspects):
            continue
        suspect, like = [*suspects.members, *(i for i in range(len(group)) if i not in suspects.members)][:2]
        expected = base[:3, :3] @ suspects.expected_frames[0]
        if _is_choice_of_frame(model, group[suspect], group[like], expected, kind=suspects.kind):
            continue
        others = tuple(joint for joint in group if joint is not group[suspect])
        if not is_frame_evidence(model, group[suspect], others, expected, kind=suspects.kind):
            continue
        outlier = _pick_outlier_by_angles(model, group, suspects)
        if outlier is not None:
            if not _takes_back_drawing(model, outlier):
                outliers[outlier.joint.name] = outlier
        elif (
            len(suspects.members) == 2
            and not _is_reported_as_mirror(model, group, suspects)
            and not _are_neighbours(group, suspects)
            and not _have_other_partners(model, group, suspects)
            and not _has_no_zero(model, group, suspects)
        ):
            both = [group[i] for i in suspects.members]
            first, second = sorted(both, key=lambda joint: not _collect_unround_rpys(model, joint, name))
            pairs[first.name] = first, second, suspects
    for name in (*outliers, *pairs):
        before = {joint.name for joint in model.tree.find_path_to(model.joint_by_name[name].child)} - {name}
        if before & (outliers.keys() | pairs.keys()):
            continue  # the joint before it rotates it
        yield (
            _build_finding(model, rule, outliers[name])
            if name in outliers
            else _build_pair_finding(model, rule, pairs[name])
        )


def _is_choice_of_frame(model: Model, joint: Joint, like: Joint, expected: Array, *, kind: str) -> bool:
    """Whether a frame is rotated about the joint's axis, and what is in it takes that back, or does not lie in it as the other
    part does in its own: then the drawing does not show that anything is elsewhere."""
    return kind == "zero_offset" and (
        is_drawn_in_place(model, joint, like, expected) or not is_turned_with_frame(model, joint, like)
    )


def _takes_back_drawing(model: Model, odd: _OrientationOutlier) -> bool:
    """Whether a frame draws its part square to the root, which the pattern would end: the part is turned in its own file."""
    return odd.kind == "zero_offset" and is_drawn_square(model, odd.joint, odd.expected)


def _is_off_before(model: Model, odd: _OrientationOutlier) -> bool:
    """Whether a moving joint before the odd one is off too: several siblings are turned as it is in their parents, apart from a
    slip, and the pattern would turn it farther away from them."""
    base = find_common_base(model, (odd.joint, *odd.others))
    if odd.joint.parent == base or len(trace_fixed_chain(model, odd.joint, base)) > 1:
        return False
    typed = _compute_relative_rotation(model, odd.joint)
    needed = model.frames[odd.joint.parent][:3, :3].T @ odd.expected
    turns = [_compute_relative_rotation(model, other) for other in odd.others]
    alike = [turn for turn in turns if measure_rotation_angle(turn, typed) < _NEAR_SIBLING]
    return len(alike) > 1 and all(
        measure_rotation_angle(turn, needed) > measure_rotation_angle(turn, typed) + ANGLE_TOLERANCE for turn in alike
    )


def _build_outlier(group: Sequence[Joint], odd: OddFrame, base: Array) -> _OrientationOutlier:
    """Return the member of a group whose frame the others contradict; ``base``: (4, 4), their common base in the root frame."""
    others = tuple(joint for i, joint in enumerate(group) if i != odd.index)
    count, names = _format_count(others), _join_joint_names(others)
    return _OrientationOutlier(
        joint=group[odd.index],
        others=others,
        kind=odd.kind,
        angle=odd.angle,
        expected=base[:3, :3] @ odd.expected_frame,
        pattern=odd.pattern,
        why=f"its {count} siblings ({names}) follow one pattern ({odd.pattern})",
    )


def _has_consistent_bases(model: Model, group: Sequence[Joint], suspects: SuspectFrames) -> bool:
    """Whether the parents of the joints follow the pattern, so that the joints themselves differ."""
    name = find_common_base(model, group)
    base = model.frames[name][:3, :3]
    bases = [base.T @ model.frames[trace_fixed_chain(model, joint, name)[0].parent][:3, :3] for joint in group]
    among = range(len(group)) if len(suspects.members) == 1 else suspects.members
    return all(
        is_axis_renaming(bases[k].T @ suspects.linear @ bases[i]) for i in suspects.members for k in among if i != k
    )


def _is_reported_as_mirror(model: Model, group: Sequence[Joint], suspects: SuspectFrames) -> bool:
    """Whether SYM004 reports the suspects: axes of left and right."""
    names = {group[i].child for i in suspects.members}
    return suspects.kind == "axis_tilt" and any(names == {pair.one, pair.other} for pair in mirror_pairs(model))


def _are_neighbours(group: Sequence[Joint], suspects: SuspectFrames) -> bool:
    """Whether two joints are only beside each other on one link, like fingers: their axes may fan out."""
    parents = {group[i].parent for i in suspects.members}
    return suspects.kind == "axis_tilt" and suspects.pattern.startswith("translation") and len(parents) == 1


def _have_other_partners(model: Model, group: Sequence[Joint], suspects: SuspectFrames) -> bool:
    """Whether each of two joints has its mirror image in a third on the same link, like the four fingers of a hand."""
    if np.linalg.det(suspects.linear) > 0.0:
        return False
    base = np.linalg.inv(model.frames[find_common_base(model, group)])
    normal = (1.0 - np.diag(suspects.linear)) / 2.0
    both = [group[i] for i in suspects.members]

    def is_mirrored(one: Joint, other: Joint) -> bool:
        first, second = (base @ model.frames[joint.child] for joint in (one, other))
        apart = first[:3, 3] - second[:3, 3]
        across = abs(float(apart @ normal))
        is_opposite = float(np.linalg.norm(apart - normal * (apart @ normal))) < _OPPOSITE * across
        return is_opposite and is_axis_renaming(first[:3, :3].T @ suspects.linear @ second[:3, :3])

    return all(
        any(
            is_mirrored(one, third)
            for third in model.joints
            if (third.parent, third.type) == (one.parent, one.type) and third not in both
        )
        for one in both
    )


def _has_no_zero(model: Model, group: Sequence[Joint], suspects: SuspectFrames) -> bool:
    """Whether one of two joints carries a part that looks the same at every angle, such as a pin: no zero of it is off."""
    return suspects.kind == "zero_offset" and any(is_round_about_joint(model, group[i]) for i in suspects.members)


def _pick_outlier_by_angles(
    model: Model, group: Sequence[Joint], suspects: SuspectFrames
) -> _OrientationOutlier | None:
    """Return the suspect with an implausible angle, if the joints it is compared with have round ones."""
    name = find_common_base(model, group)
    base = model.frames[name][:3, :3]
    for index, angle, expected in zip(suspects.members, suspects.angles, suspects.expected_frames, strict=True):
        among = range(len(group)) if len(suspects.members) == 1 else suspects.members
        others = tuple(group[i] for i in among if i != index)
        typed = _collect_unround_rpys(model, group[index], name)
        if len(typed) == 1 and all(
            one.origin.rpy is not None and has_round_angles(one.origin.rpy)
            for other in others
            for one in trace_fixed_chain(model, other, name)
        ):
            few = "sibling" if len(others) == 1 else "siblings"
            have = "has" if len(others) == 1 else "have"
            why = (
                f"its {few} {_join_joint_names(others)} ({suspects.pattern}) {have} round angles, "
                f"but `{typed[0]}` is implausible"
            )
            return _OrientationOutlier(
                joint=group[index],
                others=others,
                kind=suspects.kind,
                angle=angle,
                expected=_name_axes_alike(model, group[index], base @ expected, kind=suspects.kind),
                pattern=suspects.pattern,
                why=why,
            )
    return None


def _name_axes_alike(model: Model, joint: Joint, expected: Array, *, kind: str) -> Array:
    """Return a frame (3, 3) with the choice of axes that the tilted frame of a joint has, for a tilt is less than a half turn."""
    choice = np.rint(expected.T @ model.frames[joint.child][:3, :3])
    is_choice = kind == "axis_tilt" and is_axis_renaming(choice) and float(np.linalg.det(choice)) > 0.0
    named: Array = expected @ choice if is_choice else expected
    return named


def _collect_unround_rpys(model: Model, joint: Joint, base: str) -> list[str]:
    return [text for one in trace_fixed_chain(model, joint, base) if (text := _get_unround_rpy(one)) is not None]


def _get_unround_rpy(joint: Joint) -> str | None:
    """Return the typed rpy of a joint if one of its angles is neither round nor short, unlike those typed by hand; else None."""
    attribute = joint.origin.get_attribute("rpy")
    if attribute is None or not attribute.literal:
        return None
    for word in attribute.value.split():
        angle = parse_number(word)
        degrees = 0.0 if angle is None else math.degrees(angle)
        if (
            abs(degrees - round(degrees * 2) / 2) > MAX_ROUND_DEVIATION
            and len(word.partition(".")[2]) > MAX_TYPED_DECIMALS
        ):
            return attribute.value
    return None


def _build_pair_finding(model: Model, rule: Rule, pair: tuple[Joint, Joint, SuspectFrames]) -> Finding:
    first, second, suspects = pair
    angle = abs(suspects.angles[0])
    # Nothing commands the angle of a wheel.
    zeros = "pair_slight" if angle < _SLIGHT or (_is_wheel(model, first) and _is_wheel(model, second)) else "pair"
    return rule.finding(
        zeros if suspects.kind == "zero_offset" else "pair_tilt",
        at=locate_origin_attribute(first, "rpy"),
        related=[locate_origin_attribute(second, "rpy")],
        severity=Severity.INFO,
        confidence=Confidence.HEURISTIC,
        joint=first.name,
        sibling=second.name,
        pattern=suspects.pattern,
        size=math.degrees(angle),
    )


def _format_count(others: Sequence[Joint]) -> str:
    return NUMBER_WORDS.get(len(others), str(len(others)))


def _join_joint_names(others: Sequence[Joint]) -> str:
    return ", ".join(other.name for other in others)


def _build_finding(model: Model, rule: Rule, odd: _OrientationOutlier) -> Finding:
    joint, others = odd.joint, odd.others
    correction = _find_rotation_correction(model, joint, others, expected=odd.expected)
    data: dict[str, Any] = {
        "joint": joint.name,
        "siblings": _join_joint_names(others),
        "count": _format_count(others),
        "others": others[0].name if len(others) == 1 else f"its {_format_count(others)} siblings",
        "pattern": odd.pattern,
        "why": odd.why,
        "angle": math.degrees(odd.angle),
        "size": math.degrees(abs(odd.angle)),
        # A wheel with camber stands higher or lower than the others.
        "explains": [f"SYM006 joint[{joint.name}]"] if odd.kind == "axis_tilt" else [],
    }
    together = _describe_common_turn(model, odd)
    if together:
        return rule.finding(
            "together",
            at=locate_origin_attribute(joint, "rpy"),
            related=[locate_origin_attribute(other, "rpy") for other in others],
            severity=Severity.INFO,
            confidence=Confidence.HEURISTIC,
            together=together,
            **data,
        )
    if correction is None:
        chain = trace_fixed_chain(model, joint, find_common_base(model, (joint, *others)))
        places = [locate_origin_attribute(other, "rpy") for other in (*reversed(chain[:-1]), *others)]
        at = locate_origin_attribute(joint, "rpy")
        return rule.finding(
            "chain",
            at=at,
            related=[place for place in places if place.span != at.span],
            chain=join_names(link.name for link in chain),
            **data,
        )
    at = locate_origin_attribute(correction.joint, "rpy")
    rpy = find_nearest_rpy(correction.expected, correction.joint.origin.rpy)
    data["expected"] = " ".join(format_angle(angle, xacro=False) for angle in rpy)
    attribute, definitions = correction.joint.origin.get_attribute("rpy"), list_definitions(correction.joint, "rpy")
    around = [locate_origin_attribute(other, "rpy") for other in correction.counterparts]
    extra: dict[str, Any]
    if attribute is not None and definitions:
        message = "computed"
        extra = {
            "typed": attribute.typed,
            "origin": correction.joint.name,
            "definitions": join_names(describe_definitions(definitions)),
        }
    elif correction.joint is not joint:
        message, extra = "mount", {"mount": correction.joint.name}
    else:
        message, extra = _choose_message(model, joint, odd)
    slight = (message == "limits" and _is_slight(joint, odd.angle)) or (
        message == "zero" and ((abs(odd.angle) < _SLIGHT and _is_wheel(model, joint)) or _is_idler(model, joint))
    )
    return rule.finding(
        message,
        severity=Severity.INFO if slight else None,
        confidence=Confidence.HEURISTIC if slight else None,
        at=at,
        cause="free_mate" if message == "zero" else None,
        edits=_propose_edits(model, correction.joint, rpy),
        related=[*definitions, *(other for other in around if other.span != at.span)],
        **data,
        **extra,
    )


def _describe_common_turn(model: Model, odd: _OrientationOutlier) -> str:
    """Say what is turned with an odd frame, or takes the turn back; empty where nothing is: then one rpy is a slip.

    A part that was exported in another pose, or that is canted, has its joints turned with it, in place and direction; its
    author turns the next part back. Another rpy alone would tilt what is behind it.
    """
    joint = odd.joint
    turn = model.frames[joint.child][:3, :3] @ odd.expected.T
    angle = measure_rotation_angle(turn, np.eye(3))
    for other in model.joints:
        if other is joint or joint not in model.tree.find_path_to(other.child):
            continue
        own = _compute_relative_rotation(model, other)
        naming = np.rint(own)
        if not np.array_equal(naming @ naming.T, np.eye(3)):
            continue
        parent = model.frames[other.parent][:3, :3]
        if measure_rotation_angle(turn @ parent @ own @ naming.T @ parent.T, np.eye(3)) < _RESIDUE * angle:
            return f"the rpy of {other.name}, behind it, takes that back"
    return "its xyz is rotated by as much" if _is_place_turned(model, odd, turn, angle) else ""


def _is_place_turned(model: Model, odd: _OrientationOutlier, turn: Array, angle: float) -> bool:
    """Whether the xyz of an odd joint is that of a sibling, up to signs, rotated by its ``turn`` (3, 3) in root coordinates."""
    parent = model.frames[odd.joint.parent][:3, :3]
    own = odd.joint.origin.xyz
    if own is None:
        return False
    local = parent.T @ turn @ parent
    axis = np.array((local[2, 1] - local[1, 2], local[0, 2] - local[2, 0], local[1, 0] - local[0, 1]))
    length = float(np.linalg.norm(axis))
    if not length > 0.0 or abs(angle) > _HALF_TURN:
        return False
    across = np.eye(3) - np.outer(axis, axis) / length**2
    back = local.T @ np.array(own)
    for other in odd.others:
        if other.origin.xyz is None:
            continue
        like = np.abs(np.array(other.origin.xyz))
        before, after = (float(np.linalg.norm(across @ (np.abs(place) - like))) for place in (np.array(own), back))
        if before > _LEAST_MOVE and after < _RESIDUE * before:
            return True
    return False


def _is_slight(joint: Joint, angle: float) -> bool:
    """Whether a zero is less than a degree (rad) beside its place, or about that on a joint that nothing commands: it follows
    another one, or has no range, like a bearing of a linkage."""
    is_free = joint.mimic is not None or joint.position_range is None
    return abs(angle) < (_SLIGHT if is_free else _SMALL)


def _is_idler(model: Model, joint: Joint) -> bool:
    """Whether a joint carries a wheel that looks the same at every angle and that nothing drives, by its name."""
    return PASSIVE_NAME.search(f"{joint.name} {joint.child}") is not None and is_round_about_joint(model, joint)


def _find_rotation_correction(
    model: Model, joint: Joint, others: Sequence[Joint], *, expected: Array
) -> _RotationCorrection | None:
    """Return the joint of a chain whose rpy has to change: rotated as in a sibling's chain, it restores the pattern.

    None if that holds for no joint or for several, if the chains have different lengths, or if the line to change
    also makes the siblings.
    """
    base = find_common_base(model, (joint, *others))
    chain = trace_fixed_chain(model, joint, base)
    whole = [trace_fixed_chain(model, other, base) for other in others]
    chains = [other[-len(chain) :] for other in whole]
    corrections = []
    for place, one in enumerate(chain):
        # The joints before and after it do not change: parent @ rotation @ after = expected.
        after = model.frames[one.child][:3, :3].T @ model.frames[joint.child][:3, :3]
        needed = model.frames[one.parent][:3, :3].T @ expected @ after.T
        like = tuple(other[place] for other in chains if len(other) == len(chain))
        if len(chain) == 1 or any(
            measure_rotation_angle(needed, _compute_relative_rotation(model, other)) < ANGLE_TOLERANCE for other in like
        ):
            corrections.append(_RotationCorrection(one, needed, like))
    if len(corrections) > 1:
        corrections = [correction for correction in corrections if _differs_from_counterparts(model, correction)]
    if len(corrections) != 1 or (len(chain) > 1 and any(len(other) != len(chain) for other in whole)):
        return None
    (only,) = corrections
    shared = not list_definitions(only.joint, "rpy") and locate_origin_attribute(only.joint, "rpy").span in {
        locate_origin_attribute(o, "rpy").span for o in only.counterparts
    }
    return None if shared else only


def _differs_from_counterparts(model: Model, correction: _RotationCorrection) -> bool:
    rotation = _compute_relative_rotation(model, correction.joint)
    return all(
        measure_rotation_angle(rotation, _compute_relative_rotation(model, other)) > ANGLE_TOLERANCE
        for other in correction.counterparts
    )


def _compute_relative_rotation(model: Model, joint: Joint) -> Array:
    turn: Array = model.frames[joint.parent][:3, :3].T @ model.frames[joint.child][:3, :3]
    return turn


def _choose_message(model: Model, joint: Joint, odd: _OrientationOutlier) -> tuple[str, dict[str, Any]]:
    if odd.kind == "zero_offset":
        message = {"continuous": "zero", "revolute": "limits"}.get(joint.type, "turned")
        return message, {"imbalance": _describe_com_offset(model, joint)}
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    expected, actual = odd.expected @ axis, model.frames[joint.child][:3, :3] @ axis
    if not _is_wheel(model, joint) or abs(expected[2]) > 0.1:
        return "tilt", {}
    toe = math.atan2(expected[0] * actual[1] - expected[1] * actual[0], expected[:2] @ actual[:2])
    camber = math.asin(np.clip(actual[2], -1, 1)) - math.asin(np.clip(expected[2], -1, 1))
    return "wheel", {"toe": math.degrees(toe), "camber": math.degrees(camber)}


def _is_wheel(model: Model, joint: Joint) -> bool:
    """Whether a joint turns a wheel, by a name or by what is drawn: only wheels have toe and camber."""
    if joint.type != "continuous":
        return False
    name = f"{joint.name} {joint.child}"
    is_named = WHEEL_NAME.search(name) is not None and WHEEL_CARRIER_NAME.search(name) is None
    return is_named or any(wheel.joint is joint for wheel in rolling_wheels(model))


def _describe_com_offset(model: Model, joint: Joint) -> str:
    """Mention the COM of the child, which is also rotated, if it is off the axis."""
    inertial = model.link_by_name[joint.child].inertial
    if inertial is None or inertial.origin.xyz is None or joint.axis is None:
        return ""
    com, axis = np.array(inertial.origin.xyz), np.array(joint.axis) / np.linalg.norm(joint.axis)
    distance = float(np.linalg.norm(com - (com @ axis) * axis))
    return f", its COM ({format_length(distance, micrometres=True)} off the axis)" if distance > 1e-9 else ""


def _propose_edits(model: Model, joint: Joint, rpy: Sequence[float]) -> list[Edit]:
    text = " ".join(format_angle(angle, xacro=model.source.may_hold_expressions) for angle in rpy)
    return edit_numbers(joint.origin.get_attribute("rpy"), text)
