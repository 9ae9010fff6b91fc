"""DYN007 reports robots that, driven in a simulator, go elsewhere than their wheels are commanded."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.robot import NO_SIMULATOR

# What a drive shows of a controller or plugin, and the programs that these command.
OF_COMMANDS = frozenset({"backwards", "sideways", "swapped", "distance", "turn"})
COMMANDING = frozenset({"gazebo", "ros2_control"})


def check(model: Model, rule: Rule, *, slip: float, drift: float, rel_tol: float) -> Iterator[Finding]:
    if model.simulation == "none":
        raise FactUnavailableError(NO_SIMULATOR)
    # Heavy, and most runs do without.
    from urdfcheck.model.motion.simulated_drop import run_drop_test

    test = run_drop_test(model)
    if test.drive is None:
        return  # the drop test says why
    from urdfcheck.model.ground.drop_verdicts import find_standing_defect, list_supports
    from urdfcheck.model.motion.driving.drive_verdicts import find_drive_defect

    standing = find_standing_defect(model, test, lean=math.inf)
    if standing is not None and standing.kind in {"touches", "unloaded", "rolls"}:
        return  # DYN005: it would not drive on its wheels
    defect = find_drive_defect(model, test.drive, slip=slip, drift=drift, rel_tol=rel_tol)
    if defect is None:
        return
    is_elsewhere = defect.kind in OF_COMMANDS and bool(model.targets) and COMMANDING.isdisjoint(model.targets)
    is_free = defect.kind == "spins" and not defect.is_commanded  # its software may reverse a wheel
    yield rule.finding(
        defect.kind,
        at=defect.at,
        related=defect.related,
        severity=Severity.INFO if is_elsewhere or is_free else None,
        between=list_supports(model),
        **defect.data,
    )
