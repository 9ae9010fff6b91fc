"""Fixed joints whose numbers were measured on one robot: each side has its own, and they mirror nothing."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core.text import split_name_words
from urdfcheck.model.parts import Joint
from urdfcheck.model.repairs.rpy_text import is_round
from urdfcheck.source.text.handed_values import find_typed_value

# Angles of two exports of one assembly differ by less (rad; chosen).
_OWN = 1e-4
# So do the coordinates of their places (m; chosen).
_OWN_PLACE = 1e-5
# A calibration writes so many significant digits or more, of so many angles (chosen): a slip of one angle changes one.
_DIGITS, _ANGLES = 6, 2


def are_measured(joints: Sequence[Joint], *, is_of_angles: bool) -> bool:
    """Whether a fixed joint is named as a calibration, or two that are fixed have angles of their own with many digits. Their
    places were not measured if they differ in nothing but signs; ``is_of_angles``: whether only the angles matter."""
    fixed = [joint for joint in joints if joint.type == "fixed"]
    if any(word.lower().startswith("calib") for joint in fixed for word in split_name_words(joint.name)):
        return True
    if not len(fixed) == len(joints) == 2 or not _have_own_angles(*fixed):
        return False
    return is_of_angles or not _have_one_place(*fixed)


def _have_one_place(one: Joint, other: Joint) -> bool:
    """Whether the coordinates of two joints are alike, apart from signs."""
    places = (joint.origin.xyz or (0.0, 0.0, 0.0) for joint in (one, other))
    return all(abs(abs(first) - abs(second)) < _OWN_PLACE for first, second in zip(*places, strict=True))


def _have_own_angles(one: Joint, other: Joint) -> bool:
    """Whether several angles of two joints are neither round nor alike, apart from signs, and were typed with many digits."""
    typed = [_read_angles(joint) for joint in (one, other)]
    if not all(typed):
        return False
    own = [
        texts
        for *texts, first, second in zip(*typed, one.origin.rpy or (), other.origin.rpy or (), strict=True)
        if abs(abs(first) - abs(second)) > _OWN and not is_round(first) and not is_round(second)
    ]
    return len(own) >= _ANGLES and all(_count_digits(text) >= _DIGITS for texts in own for text in texts)


def _read_angles(joint: Joint) -> list[str]:
    """Return the three angles of a joint's origin as they were typed; nothing where they are computed."""
    attribute = joint.origin.get_attribute("rpy")
    typed = None if attribute is None else find_typed_value(attribute)
    words = [] if typed is None else typed.text.split()
    return words if len(words) == 3 else []


def _count_digits(number: str) -> int:
    """Count the significant digits of a number as typed."""
    return len("".join(filter(str.isdigit, number.lower().partition("e")[0])).lstrip("0"))
