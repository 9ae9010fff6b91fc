"""Fixed joints whose numbers were measured on one robot: each side has its own, and they mirror nothing."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core.text import split_name_words
from urdfcheck.model.parts import Joint
from urdfcheck.model.repairs.rpy_text import is_round
from urdfcheck.source.text.handed_values import find_typed_value

# Angles of two exports of one assembly differ by less (rad; chosen).
_OWN = 1e-4
# A calibration writes so many significant digits or more, of so many angles (chosen): a slip of one angle changes one.
_DIGITS, _ANGLES = 6, 2


def are_measured(joints: Sequence[Joint]) -> bool:
    """Whether a fixed joint is named as a calibration, or two that are fixed have angles of their own with many digits."""
    fixed = [joint for joint in joints if joint.type == "fixed"]
    if any(word.lower().startswith("calib") for joint in fixed for word in split_name_words(joint.name)):
        return True
    return len(fixed) == len(joints) == 2 and _have_own_angles(*fixed)


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
