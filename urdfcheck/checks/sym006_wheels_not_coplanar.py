"""SYM006: the wheels touch the ground together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Finding, Location, Rule
from urdfcheck.facts.contact import rocking
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.model.wheels import Wheel, is_suspended

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A wheel whose lowest point is farther from the others' than this part of a radius was not typed wrongly but stands on nothing.
_AWAY = 0.2
# What differs by less than this part of the gap does not make it.
_EXPLAINED = 0.1


@dataclass(frozen=True, slots=True)
class _Odd:
    """The one wheel that is off: by its ``rise`` (m) its lowest point is above the others', and its radius by ``smaller`` (m)
    below theirs, 0 where they differ among themselves."""

    wheel: Wheel
    rise: float
    smaller: float


def check(model: Model, rule: Rule, *, spread: float, least: float) -> Iterator[Finding]:
    found = model.wheels
    if len(found) < 4 or any(is_suspended(model, wheel.joint.child) for wheel in found):
        return
    found = _on_one_ground(found)
    if len(found) < 4:
        return
    contacts = np.array([wheel.contact for wheel in found])
    gaps = rocking(contacts)
    radius = min(wheel.radius for wheel in found)
    if gaps is None or gaps.max() <= max(spread * radius, least):
        return
    heights = {wheel.joint.child: round(float(wheel.contact[2]), 6) for wheel in found}
    data: dict[str, Any] = {
        "gap": float(gaps.max()) * 1e3,
        "part": float(gaps.max()) / radius,
        "radius": radius * 1e3,
        "contacts": {w.joint.child: [round(float(v), 6) + 0.0 for v in w.contact] for w in found},
        "heights": ", ".join(f"{name} {1e3 * height:.1f}" for name, height in heights.items()),
    }
    odd = _odd(found, float(gaps.max()))
    if odd is None:
        yield rule.finding(
            "uneven", at=_place(found[0].joint), related=[_place(w.joint) for w in found[1:]], count=len(found), **data
        )
        return
    joint = odd.wheel.joint
    data |= {
        "wheel": joint.child,
        "joint": joint.name,
        "off": abs(odd.rise) * 1e3,
        "where": "above" if odd.rise > 0 else "below",
        "others": ", ".join(w.joint.child for w in found if w is not odd.wheel),
    }
    if abs(odd.smaller - odd.rise) < _EXPLAINED * abs(odd.rise):
        data |= {"own": odd.wheel.radius * 1e3, "usual": (odd.wheel.radius + odd.smaller) * 1e3}
        yield rule.finding("radius", at=_place(joint), **data)
        return
    before, after, edits = _moved(model, joint, odd.rise)
    yield rule.finding("odd", at=_place(joint), edits=edits, before=before, after=after, **data)


def _on_one_ground(found: Sequence[Wheel]) -> tuple[Wheel, ...]:
    """The wheels without those that stand on nothing: two or more whose lowest points are elsewhere, or one of another size."""
    usual = float(np.median([wheel.radius for wheel in found]))
    ground = float(np.median([wheel.contact[2] for wheel in found]))
    away = [wheel for wheel in found if abs(wheel.contact[2] - ground) > _AWAY * usual]
    alike = len(away) == 1 and abs(away[0].radius - usual) < _AWAY * usual
    return tuple(wheel for wheel in found if alike or wheel not in away)


def _odd(found: Sequence[Wheel], gap: float) -> _Odd | None:
    """The only wheel whose lowest point is at another height than those of all others; None when several are off."""
    heights = np.array([wheel.contact[2] for wheel in found])
    usual = float(np.median(heights))
    off = np.flatnonzero(np.abs(heights - usual) > _EXPLAINED * gap)
    if len(off) != 1:
        return None
    wheel = found[int(off[0])]
    radii = [other.radius for other in found if other is not wheel]
    smaller = max(radii) - wheel.radius if max(radii) - min(radii) < _EXPLAINED * gap else 0.0
    return _Odd(wheel, float(heights[off[0]]) - usual, smaller)


def _moved(model: Model, joint: Joint, rise: float) -> tuple[str, str, list[Edit]]:
    """The xyz of a joint's origin, what it has to be to bring the wheel down by ``rise``, and the edit that makes it so."""
    typed = joint.origin.xyz or (0.0, 0.0, 0.0)
    shift = model.frames[joint.parent][:3, :3].T @ np.array((0.0, 0.0, -rise))
    attribute = joint.origin.attribute("xyz")
    words = ["0", "0", "0"] if attribute is None else attribute.value.split()
    # What the shift does not reach stays as it was typed.
    moved = [
        word if abs(step) < 1e-3 * abs(rise) else f"{round(value + step, 6) + 0.0:.10g}"
        for word, value, step in zip(words, typed, shift.tolist(), strict=True)
    ]
    before, after = " ".join(words), " ".join(moved)
    if attribute is None or not attribute.literal or attribute.span is None:
        return before, after, []
    return before, after, [Edit(attribute.span, attribute.typed, after)]


def _place(joint: Joint) -> Location:
    attribute = joint.origin.attribute("xyz")
    return joint.location if attribute is None else attribute.location
