"""SYM005 reports wheels that a positive velocity rolls in opposite directions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.ground.wheels import LEVEL, DrivenWheel, find_driven_wheels


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    found = find_driven_wheels(model)
    if len(found) < 2:
        return
    first = found[0].axis
    if any(abs(float(wheel.axis @ first)) < 1 - LEVEL for wheel in found):
        return  # wheels in several directions: a holonomic base, whose wheels roll outwards by convention
    along = [wheel for wheel in found if float(wheel.axis @ first) > 0]
    against = [wheel for wheel in found if wheel not in along]
    if not against:
        return
    odd, rest = _pick_outliers(along, against)
    yield rule.finding(
        "opposed" if len(odd) == len(rest) else "minority",
        at=odd[0].joint.axis_location,
        related=[wheel.joint.axis_location for wheel in (*odd[1:], *rest)],
        edits=_propose_edits(odd),
        odd=_join_joint_names(odd),
        rest=_join_joint_names(rest),
        odd_axis=_format_axis(odd[0]),
        rest_axis=_format_axis(rest[0]),
    )


def _pick_outliers(
    one: Sequence[DrivenWheel], other: Sequence[DrivenWheel]
) -> tuple[Sequence[DrivenWheel], Sequence[DrivenWheel]]:
    """The wheels to turn over and the others: the fewer, or of equally many those that do not roll towards +x (+y)."""
    if len(one) != len(other):
        return (one, other) if len(one) < len(other) else (other, one)
    # A wheel under the robot that turns about +y rolls towards +x; one that turns about -x rolls towards +y.
    axis = one[0].axis
    forward = axis[1] > 0 if abs(axis[1]) > abs(axis[0]) else axis[0] < 0
    return (other, one) if forward else (one, other)


def _propose_edits(odd: Sequence[DrivenWheel]) -> list[Edit]:
    """The opposite axis for each wheel; nothing when one of them is not typed as it stands."""
    edits = []
    for wheel in odd:
        element = wheel.joint.axis_element
        attribute = None if element is None else element.attributes.get("xyz")
        if attribute is None or not attribute.literal or attribute.span is None:
            return []
        words = " ".join(_invert_sign(word) for word in attribute.value.split())
        edits.append(Edit(attribute.span, attribute.typed, words))
    return edits


def _invert_sign(word: str) -> str:
    return word if float(word) == 0 else word[1:] if word.startswith("-") else f"-{word.removeprefix('+')}"


def _join_joint_names(found: Sequence[DrivenWheel]) -> str:
    return ", ".join(wheel.joint.name for wheel in found)


def _format_axis(wheel: DrivenWheel) -> str:
    """The axis in root coordinates, to three decimals."""
    return " ".join(f"{round(float(v), 3) + 0.0:g}" for v in wheel.axis)
