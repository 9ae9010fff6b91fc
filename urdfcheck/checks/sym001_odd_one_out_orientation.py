"""SYM001 reports a joint whose frame breaks the pattern of like joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Confidence, Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.symmetry import (
    SuspectFrames,
    find_odd_frame,
    find_suspect_frames,
    is_axis_renaming,
    measure_rotation_angle,
)
from urdfcheck.facts.motion.kinematics import matrix_to_rpy
from urdfcheck.model import Joint, Model
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.likeness.sibling_joints import find_common_base, sibling_joints, trace_fixed_chain
from urdfcheck.model.repairs.origin_edits import describe_definitions, list_definitions, locate_origin_attribute
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# The frames that a pattern predicts are only as exact as the siblings' rpy, of which 1.57 is the coarsest.
ANGLE_TOLERANCE = 2e-3
ROUND_STEP = math.pi / 12
# An angle within 0.06° of a multiple of 0.5°, or with at most three decimals, may have been typed by hand (JNT016).
MAX_ROUND_DEVIATION, MAX_TYPED_DECIMALS = 0.06, 3
NUMBER_WORDS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True, slots=True, eq=False)
class _RotationCorrection:
    """A joint whose origin is turned wrongly, the rotation (3, 3) that it needs, and the joints in its siblings' place."""

    joint: Joint
    expected: Array
    counterparts: tuple[Joint, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _OrientationOutlier:
    """A joint that is turned by ``angle`` against ``expected`` (3, 3), why that is said of it, and who says it."""

    joint: Joint
    others: tuple[Joint, ...]
    kind: str
    angle: float
    expected: Array
    pattern: str
    why: str


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    odd: dict[str, _OrientationOutlier] = {}
    pairs: dict[str, tuple[Joint, Joint, SuspectFrames]] = {}
    for group in sibling_joints(model):
        name = find_common_base(model, group)
        base = model.frames[name]
        frames = np.linalg.inv(base) @ np.array([model.frames[joint.child] for joint in group])
        axes = [joint.axis or (1.0, 0.0, 0.0) for joint in group]
        found = find_odd_frame(frames[:, :3, 3], frames[:, :3, :3], axes)
        doubtful = None if found is not None else find_suspect_frames(frames[:, :3, 3], frames[:, :3, :3], axes)
        if found is not None:
            others = tuple(joint for i, joint in enumerate(group) if i != found.index)
            why = f"its {_format_count(others)} like siblings ({_join_joint_names(others)}) follow one pattern of frames ({found.pattern})"
            expected = base[:3, :3] @ found.expected_frame
            one = _OrientationOutlier(group[found.index], others, found.kind, found.angle, expected, found.pattern, why)
            odd[one.joint.name] = one
        elif doubtful is not None and _has_consistent_bases(model, group, doubtful):
            decided = _pick_outlier_by_angles(model, group, doubtful)
            if decided is not None:
                odd[decided.joint.name] = decided
            elif len(doubtful.members) == 2 and not _is_reported_as_mirror(model, group, doubtful):
                both = [group[i] for i in doubtful.members]
                first, second = sorted(both, key=lambda joint: not _collect_unround_rpys(model, joint, name))
                pairs[first.name] = first, second, doubtful
    for name in (*odd, *pairs):
        before = {joint.name for joint in model.tree.find_path_to(model.joint_by_name[name].child)} - {name}
        if before & (odd.keys() | pairs.keys()):
            continue  # it stands askew because the joint before it does
        yield _build_finding(model, rule, odd[name]) if name in odd else _build_pair_finding(rule, *pairs[name])


def _has_consistent_bases(model: Model, group: Sequence[Joint], found: SuspectFrames) -> bool:
    """Whether what the joints hang on is related as their places are, so that the joints themselves are what differs."""
    name = find_common_base(model, group)
    base = model.frames[name][:3, :3]
    bases = [base.T @ model.frames[trace_fixed_chain(model, joint, name)[0].parent][:3, :3] for joint in group]
    among = range(len(group)) if len(found.members) == 1 else found.members
    return all(is_axis_renaming(bases[k].T @ found.linear @ bases[i]) for i in found.members for k in among if i != k)


def _is_reported_as_mirror(model: Model, group: Sequence[Joint], found: SuspectFrames) -> bool:
    """Whether SYM004 tells it: the axes of left and right."""
    names = {group[i].child for i in found.members}
    return found.kind == "axis_tilt" and any(names == {pair.one, pair.other} for pair in mirror_pairs(model))


def _pick_outlier_by_angles(model: Model, group: Sequence[Joint], found: SuspectFrames) -> _OrientationOutlier | None:
    """The suspect that an angle gives away that nobody chooses, when those that it is compared with have round ones."""
    name = find_common_base(model, group)
    base = model.frames[name][:3, :3]
    for index, angle, expected in zip(found.members, found.angles, found.expected_frames, strict=True):
        among = range(len(group)) if len(found.members) == 1 else found.members
        others = tuple(group[i] for i in among if i != index)
        typed = _collect_unround_rpys(model, group[index], name)
        if len(typed) == 1 and all(
            _has_round_angles(one) for other in others for one in trace_fixed_chain(model, other, name)
        ):
            few = "sibling" if len(others) == 1 else "siblings"
            have = "has" if len(others) == 1 else "have"
            why = (
                f"its like {few} {_join_joint_names(others)} ({found.pattern}) {have} round angles, "
                f"and this one's `{typed[0]}` is none that anybody chooses"
            )
            return _OrientationOutlier(group[index], others, found.kind, angle, base @ expected, found.pattern, why)
    return None


def _collect_unround_rpys(model: Model, joint: Joint, base: str) -> list[str]:
    return [text for one in trace_fixed_chain(model, joint, base) if (text := _get_unround_rpy(one)) is not None]


def _get_unround_rpy(joint: Joint) -> str | None:
    """The rpy of a joint as typed when an angle in it is neither round nor short: nobody types such a one by hand."""
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


def _has_round_angles(joint: Joint) -> bool:
    rpy = joint.origin.rpy
    return rpy is not None and all(
        abs(angle - round(angle / ROUND_STEP) * ROUND_STEP) < ANGLE_TOLERANCE for angle in rpy
    )


def _build_pair_finding(rule: Rule, first: Joint, second: Joint, found: SuspectFrames) -> Finding:
    return rule.finding(
        "pair" if found.kind == "zero_offset" else "pair_tilt",
        at=locate_origin_attribute(first, "rpy"),
        related=[locate_origin_attribute(second, "rpy")],
        severity=Severity.INFO,
        confidence=Confidence.HEURISTIC,
        joint=first.name,
        sibling=second.name,
        pattern=found.pattern,
        size=math.degrees(abs(found.angles[0])),
    )


def _format_count(others: Sequence[Joint]) -> str:
    return NUMBER_WORDS.get(len(others), str(len(others)))


def _join_joint_names(others: Sequence[Joint]) -> str:
    return ", ".join(other.name for other in others)


def _build_finding(model: Model, rule: Rule, odd: _OrientationOutlier) -> Finding:
    joint, others = odd.joint, odd.others
    suspect = _find_rotation_correction(model, joint, others, odd.expected)
    data: dict[str, Any] = {
        "joint": joint.name,
        "siblings": _join_joint_names(others),
        "count": _format_count(others),
        "pattern": odd.pattern,
        "why": odd.why,
        "angle": math.degrees(odd.angle),
        "size": math.degrees(abs(odd.angle)),
    }
    if suspect is None:
        chain = trace_fixed_chain(model, joint, find_common_base(model, (joint, *others)))
        places = [locate_origin_attribute(other, "rpy") for other in (*reversed(chain[:-1]), *others)]
        own = locate_origin_attribute(joint, "rpy")
        return rule.finding(
            "chain",
            at=own,
            related=[place for place in places if place.span != own.span],
            chain=join_names([j.name for j in chain]),
            **data,
        )
    place = locate_origin_attribute(suspect.joint, "rpy")
    rpy = [_snap_angle(angle) for angle in matrix_to_rpy(suspect.expected)]
    data["expected"] = " ".join(_format_angle(angle, xacro=False) for angle in rpy)
    attribute, definitions = suspect.joint.origin.get_attribute("rpy"), list_definitions(suspect.joint, "rpy")
    around = [locate_origin_attribute(other, "rpy") for other in suspect.counterparts]
    extra: dict[str, Any]
    if attribute is not None and definitions:
        message = "computed"
        extra = {
            "typed": attribute.typed,
            "origin": suspect.joint.name,
            "definitions": join_names(describe_definitions(definitions)),
        }
    elif suspect.joint is not joint:
        message, extra = "mount", {"mount": suspect.joint.name}
    else:
        message, extra = _choose_message(model, joint, odd)
    return rule.finding(
        message,
        at=place,
        cause="free_mate" if odd.kind == "zero_offset" and message not in {"computed", "mount"} else None,
        edits=_propose_edits(model, suspect.joint, rpy),
        related=[*definitions, *(other for other in around if other.span != place.span)],
        **data,
        **extra,
    )


def _find_rotation_correction(
    model: Model, joint: Joint, others: Sequence[Joint], expected: Array
) -> _RotationCorrection | None:
    """The joint of a chain whose rpy has to change: with it turned as in a sibling's chain, the pattern holds.

    None when that can be said of no joint or of several, when the chains have different lengths, and when the line to
    change made the siblings as well.
    """
    base = find_common_base(model, (joint, *others))
    chain = trace_fixed_chain(model, joint, base)
    whole = [trace_fixed_chain(model, other, base) for other in others]
    chains = [other[-len(chain) :] for other in whole]
    found = []
    for place, one in enumerate(chain):
        # What comes before and after stays as it is: parent @ rotation @ after = expected.
        after = model.frames[one.child][:3, :3].T @ model.frames[joint.child][:3, :3]
        needed = model.frames[one.parent][:3, :3].T @ expected @ after.T
        like = tuple(other[place] for other in chains if len(other) == len(chain))
        if len(chain) == 1 or any(
            measure_rotation_angle(needed, _compute_relative_rotation(model, other)) < ANGLE_TOLERANCE for other in like
        ):
            found.append(_RotationCorrection(one, needed, like))
    if len(found) > 1:  # the one that no sibling has as it is
        found = [
            s
            for s in found
            if all(
                measure_rotation_angle(_compute_relative_rotation(model, s.joint), _compute_relative_rotation(model, o))
                > ANGLE_TOLERANCE
                for o in s.counterparts
            )
        ]
    if len(found) != 1 or (len(chain) > 1 and any(len(other) != len(chain) for other in whole)):
        return None
    (only,) = found
    shared = not list_definitions(only.joint, "rpy") and locate_origin_attribute(only.joint, "rpy").span in {
        locate_origin_attribute(o, "rpy").span for o in only.counterparts
    }
    return None if shared else only


def _compute_relative_rotation(model: Model, joint: Joint) -> Array:
    turn: Array = model.frames[joint.parent][:3, :3].T @ model.frames[joint.child][:3, :3]
    return turn


def _choose_message(model: Model, joint: Joint, odd: _OrientationOutlier) -> tuple[str, dict[str, Any]]:
    if odd.kind == "zero_offset":
        message = {"continuous": "zero", "revolute": "limits"}.get(joint.type, "turned")
        return message, {"imbalance": _describe_com_offset(model, joint)}
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    wanted, found = odd.expected @ axis, model.frames[joint.child][:3, :3] @ axis
    if joint.type != "continuous" or abs(wanted[2]) > 0.1:
        return "tilt", {}
    toe = math.atan2(wanted[0] * found[1] - wanted[1] * found[0], wanted[:2] @ found[:2])
    camber = math.asin(np.clip(found[2], -1, 1)) - math.asin(np.clip(wanted[2], -1, 1))
    return "wheel", {"toe": math.degrees(toe), "camber": math.degrees(camber)}


def _describe_com_offset(model: Model, joint: Joint) -> str:
    """What turns with the child besides its picture: its COM, when that is off the axis."""
    inertial = model.link_by_name[joint.child].inertial
    if inertial is None or inertial.origin.xyz is None or joint.axis is None:
        return ""
    com, axis = np.array(inertial.origin.xyz), np.array(joint.axis) / np.linalg.norm(joint.axis)
    distance = float(np.linalg.norm(com - (com @ axis) * axis))
    return f", its centre of mass ({_format_length(distance)} off the axis)" if distance > 1e-9 else ""


def _format_length(metres: float) -> str:
    for factor, unit in ((1.0, "m"), (1e3, "mm")):
        if metres * factor >= 1:
            return f"{metres * factor:.3g} {unit}"
    return f"{metres * 1e6:.3g} µm"


def _snap_angle(angle: float) -> float:
    """The multiple of 15° that a predicted angle means, else the angle to 1e-6 rad."""
    nearest = round(angle / ROUND_STEP) * ROUND_STEP
    return nearest if abs(angle - nearest) < ANGLE_TOLERANCE else round(angle, 6)


def _format_angle(angle: float, *, xacro: bool) -> str:
    """A number with all its digits, or in a xacro the constant that it is."""
    parts = round(angle / ROUND_STEP)
    if not xacro or not parts or abs(angle - parts * ROUND_STEP) > 1e-12:
        return f"{angle:.15g}" if angle else "0"
    common = math.gcd(parts, 12)
    top, bottom = abs(parts) // common, 12 // common
    text = ("-" if parts < 0 else "") + (f"{top}*pi" if top > 1 else "pi") + (f"/{bottom}" if bottom > 1 else "")
    return f"${{{text}}}"


def _propose_edits(model: Model, joint: Joint, rpy: Sequence[float]) -> list[Edit]:
    attribute = joint.origin.get_attribute("rpy")
    if attribute is None or not attribute.literal or attribute.span is None:
        return []
    text = " ".join(_format_angle(angle, xacro=model.source.is_xacro) for angle in rpy)
    return [Edit(attribute.span, attribute.typed, text)]
