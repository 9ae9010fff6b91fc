"""How well a robot stands that is meant to, in both versions."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core.mechanism import MechanismStance
from urdfcheck.core.model_diff import MechanismEffect
from urdfcheck.facts.comparison.alignment import PlacedPair

# Margins that change by less (m, and as a share) and angles (rad) are those of digits, facets and hulls.
_LEAST_MARGIN, _LEAST_SHARE, _LEAST_ANGLE = 1e-4, 1e-2, math.radians(0.1)


def compare_stances(pair: PlacedPair) -> Iterator[MechanismEffect]:
    """Yield what changes in how a robot stands that both versions mean to stand: whether it falls, how near it is to that, and
    how much it leans."""
    first, second = pair.before.mechanism.stance, pair.after.mechanism.stance
    if first is None or second is None:
        return
    numbers = {
        "margin_before": first.margin,
        "margin_after": second.margin,
        "tip_before": first.tip_angle,
        "tip_after": second.tip_angle,
    }
    subject = f"link[{pair.before.mechanism.root}]"
    if math.isfinite(first.tilt) != math.isfinite(second.tilt):
        name = "falls" if math.isfinite(first.tilt) else "stands"
        yield MechanismEffect(kind="stability", id=name, subject=subject, numbers=numbers)
    elif _has_other_margin(first, second):
        words = {"before": ", ".join(first.supports), "after": ", ".join(second.supports)}
        yield MechanismEffect(kind="stability", id="support-margin", subject=subject, numbers=numbers, words=words)
    if math.isfinite(first.tilt + second.tilt) and abs(second.tilt - first.tilt) > _LEAST_ANGLE:
        angles = {"before": first.tilt, "after": second.tilt}
        yield MechanismEffect(kind="stability", id="lean", subject=subject, numbers=angles)


def _has_other_margin(first: MechanismStance, second: MechanismStance) -> bool:
    change = abs(second.margin - first.margin)
    return change > max(_LEAST_MARGIN, _LEAST_SHARE * max(abs(first.margin), abs(second.margin)))
