"""DYN005 reports robots that, dropped in a simulator, burst, gain energy, sink in or never come to rest."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from urdfcheck.core import FactUnavailableError, Finding, Located, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.robot import NO_SIMULATOR

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest, ReleaseResult

# Degrees by which published robots lean (DYN006).
USUAL_LEAN = 1.5
# Contacts as deep as the deepest but for rounding; the first of them is reported.
_AS_DEEP = 0.99


def check(model: Model, rule: Rule, *, gain: float, sink: float, lean: float) -> Iterator[Finding]:
    if model.simulation == "none":
        raise FactUnavailableError(NO_SIMULATOR)
    # Heavy, and most runs do without.
    from urdfcheck.core.drop_test import LATE_SECONDS, STEP
    from urdfcheck.model.motion.simulated_drop import run_drop_test

    test = run_drop_test(model)
    for release, message, data in _iter_drop_defects(test, gain=gain, sink=sink):
        link = model.link_by_name[data["link"]]
        inertial = link.inertial
        at: Located = link if inertial is None else inertial
        own = 0.0 if inertial is None else inertial.mass or 0.0
        torques = "its joints held" if release.held else "no torques"
        data |= {"torques": torques, "own": own, "seconds": LATE_SECONDS, "step": 1e3 * STEP}
        # A real gripper may be so light that a limp arm whips it, or stiff motors do.
        severity = Severity.INFO if test.is_marginal and message in {"explodes", "gains"} else None
        yield rule.finding(message, at=at, severity=severity, between=_list_neighbours(model, link.name), **data)
        return  # only the worst: a robot that bursts may also gain energy or sink in
    if not test.knows_ground:
        return
    from urdfcheck.model.ground.drop_verdicts import find_standing_defect, list_supports

    standing = find_standing_defect(model, test, lean=lean)
    if standing is None:
        return
    # Casters of sound robots are a little off the plane of their wheels, and wheels with corners roll onto a side.
    is_little = standing.kind == "leans" and standing.data["tilt"] <= USUAL_LEAN
    is_unexplained = standing.kind == "rolls" and not standing.data["reason"]
    is_usual = model.simulation == "brief" and (is_little or is_unexplained)
    yield rule.finding(
        standing.kind,
        at=model.link_by_name[standing.link],
        link=standing.link,
        severity=Severity.INFO if is_usual else None,
        between=list_supports(model),
        **standing.data,
    )


def _list_neighbours(model: Model, name: str) -> list[str]:
    """List a link, the links that one joint connects with it, and these joints, as subjects."""
    above = model.tree.parent_joint.get(name)
    joints = [*([] if above is None else [above]), *model.tree.child_joints[name]]
    links = dict.fromkeys((name, *(end for joint in joints for end in (joint.parent, joint.child))))
    return [*(f"link[{link}]" for link in links), *(f"joint[{joint.name}]" for joint in joints)]


def _iter_drop_defects(
    test: DropTest, *, gain: float, sink: float
) -> Iterator[tuple[ReleaseResult, str, dict[str, Any]]]:
    """Iterate over the defects of a fall, the worst first: the release, the message and its data; ``link`` shows the defect."""
    releases = (test.free, test.held)
    for release in releases:
        if release.burst is not None:
            yield release, "explodes", {"link": release.fastest, "time": release.burst}
    if test.free.gain is not None and test.free.gain > gain:
        joules = test.free.gain * test.weight * test.size
        yield test.free, "gains", {"link": test.free.fastest, "gain": test.free.gain, "joules": joules}
    if not test.knows_ground:
        return  # where it stands is not known
    for release in releases:
        stands = release.settled is not None and not (release.has_tipped or release.saturated)
        if stands and release.depth > sink * test.soft:
            deepest = next(touching for touching in release.touching if touching.depth >= _AS_DEEP * release.depth)
            numbers = {"depth": 1e3 * deepest.depth, "load": deepest.load, "soft": 1e3 * test.soft}
            yield release, "sinks", {"link": deepest.link, **numbers}
    later = test.later
    if later is not None and later.is_restless and later.speed is not None:
        yield later, "restless", {"link": later.moving, "speed": 1e3 * later.speed, "slow": 1e3 * test.slow}
