"""DYN005 reports robots that, dropped in a simulator, burst, gain energy, sink in or never come to rest."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.core.drop_test import LATE_SECONDS, STEP, DropTest, ReleaseResult
from urdfcheck.model import Model
from urdfcheck.model.motion.simulated_drop import run_drop_test

# Contacts that are as deep as the deepest but for rounding: of these the first one is told.
_AS_DEEP = 0.99


def check(model: Model, rule: Rule, *, gain: float, sink: float) -> Iterator[Finding]:
    found = run_drop_test(model)
    for release, message, told in _iter_drop_defects(found, gain, sink):
        link = model.link_by_name[told["link"]]
        inertial = link.inertial
        at: Located = link if inertial is None else inertial
        own = 0.0 if inertial is None else inertial.mass or 0.0
        torques = "its joints held where they are" if release.held else "no torques"
        yield rule.finding(message, at=at, torques=torques, own=own, seconds=LATE_SECONDS, step=1e3 * STEP, **told)
        return  # the worst one: what gains energy or sinks in may well burst


def _iter_drop_defects(
    found: DropTest, gain: float, sink: float
) -> Iterator[tuple[ReleaseResult, str, dict[str, Any]]]:
    """What is wrong with how it fell, the worst first, and the numbers that say so; ``link`` is where it shows."""
    releases = (found.free, found.held)
    for release in releases:
        if release.burst is not None:
            yield release, "explodes", {"link": release.fastest, "time": release.burst}
    if found.free.gain is not None and found.free.gain > gain:
        joules = found.free.gain * found.mass * 9.81 * found.size
        yield found.free, "gains", {"link": found.free.fastest, "gain": found.free.gain, "joules": joules}
    for release in releases:
        stands = release.settled is not None and not (release.has_tipped or release.saturated)
        if stands and release.depth > sink * found.soft:
            deepest = next(touching for touching in release.touching if touching.depth >= _AS_DEEP * release.depth)
            numbers = {"depth": 1e3 * deepest.depth, "load": deepest.load, "soft": 1e3 * found.soft}
            yield release, "sinks", {"link": deepest.link, **numbers}
    later = found.later
    if later is not None and later.is_restless and later.speed is not None:
        yield later, "restless", {"link": later.moving, "speed": 1e3 * later.speed, "slow": 1e3 * found.slow}
