"""SYM001: the frames of like joints follow one pattern."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Finding, Location, Rule
from urdfcheck.facts.kinematics import matrix_to_rpy
from urdfcheck.facts.symmetry import OddOne, angle_between, odd_one_out
from urdfcheck.model import Joint, Model
from urdfcheck.model.names import listed
from urdfcheck.model.siblings import chain_of, siblings
from urdfcheck.source.xml import Definition

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# The frames that a pattern predicts are only as exact as the siblings' rpy, of which 1.57 is the coarsest.
SNAP = 2e-3
STEP = math.pi / 12
WORDS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True, slots=True, eq=False)
class _Suspect:
    """A joint whose origin is turned wrongly, the rotation (3, 3) that it needs, and the joints in its siblings' place."""

    joint: Joint
    expected: Array
    like: tuple[Joint, ...]


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    odd: dict[str, tuple[Sequence[Joint], OddOne]] = {}
    for group in siblings(model):
        frames = np.array([model.frames[joint.child] for joint in group])
        axes = [joint.axis or (1.0, 0.0, 0.0) for joint in group]
        found = odd_one_out(frames[:, :3, 3], frames[:, :3, :3], axes)
        if found is not None:
            odd[group[found.index].name] = group, found
    for name, (members, one) in odd.items():
        before = {joint.name for joint in model.tree.path(model.joint_by_name[name].child)} - {name}
        if not before & odd.keys():  # else it stands askew because the joint before it does
            yield _finding(model, rule, members, one)


def _finding(model: Model, rule: Rule, group: Sequence[Joint], odd: OddOne) -> Finding:
    joint = group[odd.index]
    others = [other for other in group if other is not joint]
    suspect = _suspect(model, joint, others, odd.expected_frame)
    data: dict[str, Any] = {
        "joint": joint.name,
        "siblings": ", ".join(other.name for other in others),
        "count": WORDS.get(len(others), str(len(others))),
        "pattern": odd.rule,
        "angle": math.degrees(odd.angle),
        "size": math.degrees(abs(odd.angle)),
    }
    if suspect is None:
        chain = chain_of(model, joint)
        places = [_place(other) for other in (*reversed(chain[:-1]), *others)]
        own = _place(joint)
        return rule.finding(
            "chain",
            at=own,
            related=[place for place in places if place.span != own.span],
            chain=listed([j.name for j in chain]),
            **data,
        )
    place = _place(suspect.joint)
    rpy = [_snapped(angle) for angle in matrix_to_rpy(suspect.expected)]
    data["expected"] = " ".join(_text(angle, xacro=False) for angle in rpy)
    attribute, definitions = suspect.joint.origin.attribute("rpy"), _definitions(suspect.joint)
    around = [_place(other) for other in suspect.like]
    extra: dict[str, Any]
    if attribute is not None and definitions:
        message = "computed"
        extra = {"typed": attribute.typed, "origin": suspect.joint.name, "definitions": listed(_told(definitions))}
    elif suspect.joint is not joint:
        message, extra = "mount", {"mount": suspect.joint.name}
    else:
        message, extra = _message(model, joint, odd)
    return rule.finding(
        message,
        at=place,
        cause="free_mate" if odd.kind == "zero_offset" and message not in {"computed", "mount"} else None,
        edits=_edits(model, suspect.joint, rpy),
        related=[*definitions, *(other for other in around if other.span != place.span)],
        **data,
        **extra,
    )


def _suspect(model: Model, joint: Joint, others: Sequence[Joint], expected: Array) -> _Suspect | None:
    """The joint of a chain whose rpy has to change: with it turned as in a sibling's chain, the pattern holds.

    None when that can be said of no joint or of several, when the chains have different lengths, and when the line to
    change made the siblings as well.
    """
    chain = chain_of(model, joint)
    chains = [chain_of(model, other)[-len(chain) :] for other in others]
    found = []
    for place, one in enumerate(chain):
        # What comes before and after stays as it is: parent @ rotation @ after = expected.
        after = model.frames[one.child][:3, :3].T @ model.frames[joint.child][:3, :3]
        needed = model.frames[one.parent][:3, :3].T @ expected @ after.T
        like = tuple(other[place] for other in chains if len(other) == len(chain))
        if len(chain) == 1 or any(angle_between(needed, _turn(model, other)) < SNAP for other in like):
            found.append(_Suspect(one, needed, like))
    if len(found) > 1:  # the one that no sibling has as it is
        found = [s for s in found if all(angle_between(_turn(model, s.joint), _turn(model, o)) > SNAP for o in s.like)]
    if len(found) != 1 or (len(chain) > 1 and any(len(chain_of(model, o)) != len(chain) for o in others)):
        return None
    (only,) = found
    shared = not _definitions(only.joint) and _place(only.joint).span in {_place(o).span for o in only.like}
    return None if shared else only


def _definitions(joint: Joint) -> tuple[Definition, ...]:
    """What the rpy of a joint is computed from, nearest first; nothing when it is typed as it stands."""
    attribute = joint.origin.attribute("rpy")
    return () if attribute is None or attribute.literal else attribute.related()


def _turn(model: Model, joint: Joint) -> Array:
    turn: Array = model.frames[joint.parent][:3, :3].T @ model.frames[joint.child][:3, :3]
    return turn


def _told(definitions: Sequence[Definition]) -> list[str]:
    return [
        f"{d.kind} {d.name} (line {d.span.line} of {d.span.file.rpartition('/')[2]})"
        for d in definitions
        if d.span is not None
    ]


def _message(model: Model, joint: Joint, odd: OddOne) -> tuple[str, dict[str, Any]]:
    if odd.kind == "zero_offset":
        message = {"continuous": "zero", "revolute": "limits"}.get(joint.type, "turned")
        return message, {"imbalance": _imbalance(model, joint)}
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    wanted, found = odd.expected_frame @ axis, model.frames[joint.child][:3, :3] @ axis
    if joint.type != "continuous" or abs(wanted[2]) > 0.1:
        return "tilt", {}
    toe = math.atan2(wanted[0] * found[1] - wanted[1] * found[0], wanted[:2] @ found[:2])
    camber = math.asin(np.clip(found[2], -1, 1)) - math.asin(np.clip(wanted[2], -1, 1))
    return "wheel", {"toe": math.degrees(toe), "camber": math.degrees(camber)}


def _imbalance(model: Model, joint: Joint) -> str:
    """What turns with the child besides its picture: its COM, when that is off the axis."""
    inertial = model.link_by_name[joint.child].inertial
    if inertial is None or inertial.origin.xyz is None or joint.axis is None:
        return ""
    com, axis = np.array(inertial.origin.xyz), np.array(joint.axis) / np.linalg.norm(joint.axis)
    distance = float(np.linalg.norm(com - (com @ axis) * axis))
    return f" and the child's centre of mass, {_length(distance)} off the axis," if distance > 1e-9 else ""


def _length(metres: float) -> str:
    for factor, unit in ((1.0, "m"), (1e3, "mm")):
        if metres * factor >= 1:
            return f"{metres * factor:.3g} {unit}"
    return f"{metres * 1e6:.3g} µm"


def _snapped(angle: float) -> float:
    """The multiple of 15° that a predicted angle means, else the angle to 1e-6 rad."""
    nearest = round(angle / STEP) * STEP
    return nearest if abs(angle - nearest) < SNAP else round(angle, 6)


def _text(angle: float, *, xacro: bool) -> str:
    """A number with all its digits, or in a xacro the constant that it is."""
    parts = round(angle / STEP)
    if not xacro or not parts or abs(angle - parts * STEP) > 1e-12:
        return f"{angle:.15g}" if angle else "0"
    common = math.gcd(parts, 12)
    top, bottom = abs(parts) // common, 12 // common
    text = ("-" if parts < 0 else "") + (f"{top}*pi" if top > 1 else "pi") + (f"/{bottom}" if bottom > 1 else "")
    return f"${{{text}}}"


def _edits(model: Model, joint: Joint, rpy: Sequence[float]) -> list[Edit]:
    attribute = joint.origin.attribute("rpy")
    if attribute is None or not attribute.literal or attribute.span is None:
        return []
    text = " ".join(_text(angle, xacro=model.source.is_xacro) for angle in rpy)
    return [Edit(attribute.span, attribute.typed, text)]


def _place(joint: Joint) -> Location:
    attribute = joint.origin.attribute("rpy")
    if attribute is not None:
        return attribute.location
    return joint.location if joint.origin.element is None else joint.origin.element.location
