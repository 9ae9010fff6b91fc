"""SYM006 reports wheels that do not touch the ground together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from urdfcheck.core import Edit, Finding, Location, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.ground.rest_pose import is_caster_joint
from urdfcheck.model.ground.wheel_plane import find_uneven_wheels
from urdfcheck.model.ground.wheels import Wheel
from urdfcheck.model.parts import Joint
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.model.repairs.number_text import keep_notation

# Casters of published robots are up to so much (m) off the plane of their driven wheels, partly on purpose (DYN006).
_PLAY = 3e-3
# Wheels of one row, or of one axle, are level with each other to this (m, chosen).
_IN_ROW = 1e-3


def check(model: Model, rule: Rule, *, spread: float, least: float) -> Iterator[Finding]:
    footing = find_uneven_wheels(model, rel_tol=spread, abs_tol=least)
    if footing is None:
        return
    wheels, odd = footing.wheels, footing.odd_wheel
    radius = min(wheel.radius for wheel in wheels)
    heights = {wheel.joint.child: round(float(wheel.contact[2]), 6) for wheel in wheels}
    data: dict[str, Any] = {
        "gap": footing.gap * 1e3,
        # What hangs at least so high may not be rounded up.
        "least": math.floor(footing.gap * 1e5) / 1e2,
        "part": footing.gap / radius,
        "radius": radius * 1e3,
        "contacts": {w.joint.child: [round(float(v), 6) + 0.0 for v in w.contact] for w in wheels},
        "heights": ", ".join(f"{name} {1e3 * height:.1f}" for name, height in heights.items()),
    }
    if odd is None:
        yield rule.finding(
            "axles" if footing.are_axles else "uneven",
            severity=Severity.INFO if footing.are_axles or _is_play_of_casters(wheels, least) else None,
            at=_locate_xyz(wheels[0].joint),
            related=[_locate_xyz(wheel.joint) for wheel in wheels[1:]],
            count=len(wheels),
            **data,
        )
        return
    joint = odd.wheel.joint
    data |= {
        "wheel": joint.child,
        "joint": joint.name,
        "off": abs(odd.rise) * 1e3,
        "where": "above" if odd.rise > 0 else "below",
        "others": ", ".join(wheel.joint.child for wheel in wheels if wheel is not odd.wheel),
    }
    if odd.is_caused_by_radius:
        data |= {"own": odd.wheel.radius * 1e3, "usual": (odd.wheel.radius + odd.radius_deficit) * 1e3}
        yield rule.finding("radius", at=_locate_xyz(joint), **data)
        return
    before, after, edits = _propose_origin_xyz(model, joint, odd.rise)
    repair = f"write xyz `{after}` in the origin of {joint.name}"
    if abs(odd.rise) > odd.wheel.radius or not _is_in_rows(odd.wheel, wheels):
        # It is not its height alone that is wrong.
        repair, edits = (
            f"compare the origin of {joint.name} with those of the other wheels: not its height alone differs",
            [],
        )
    severity = Severity.INFO if _is_play_of_casters(wheels, least) else None
    yield rule.finding(
        "odd", at=_locate_xyz(joint), edits=edits, before=before, after=after, severity=severity, repair=repair, **data
    )


def _is_play_of_casters(wheels: Sequence[Wheel], least: float) -> bool:
    """Whether the driven wheels are level, and only casters end a little above them: the load stays on the driven wheels."""
    driven = [float(wheel.contact[2]) for wheel in wheels if not is_caster_joint(wheel.joint)]
    turned = [float(wheel.contact[2]) for wheel in wheels if is_caster_joint(wheel.joint)]
    if len(driven) < 2 or not turned or max(driven) - min(driven) > least:
        return False
    return min(driven) - least <= min(turned) and max(turned) - max(driven) <= _PLAY


def _is_in_rows(wheel: Wheel, wheels: Sequence[Wheel]) -> bool:
    """Whether a wheel is level with another one across the robot and with one along it, as if only its height were wrong."""
    apart = np.abs([(other.centre - wheel.centre)[:2] for other in wheels if other is not wheel])
    return bool((apart.min(axis=0) <= _IN_ROW).all())


def _propose_origin_xyz(model: Model, joint: Joint, rise: float) -> tuple[str, str, list[Edit]]:
    """Return the xyz of a joint, the xyz that lowers the wheel by ``rise`` (m), and the edit."""
    typed = joint.origin.xyz or (0.0, 0.0, 0.0)
    shift = model.frames[joint.parent][:3, :3].T @ np.array((0.0, 0.0, -rise))
    attribute = joint.origin.get_attribute("xyz")
    words = ["0", "0", "0"] if attribute is None else attribute.value.split()
    # Numbers that the shift does not change stay as typed.
    moved = [
        word if abs(step) < 1e-3 * abs(rise) else f"{round(value + step, 6) + 0.0:.10g}"
        for word, value, step in zip(words, typed, shift.tolist(), strict=True)
    ]
    before, after = " ".join(words), keep_notation(" ".join(words), " ".join(moved))
    return before, after, edit_numbers(attribute, after)


def _locate_xyz(joint: Joint) -> Location:
    attribute = joint.origin.get_attribute("xyz")
    return joint.location if attribute is None else attribute.location
