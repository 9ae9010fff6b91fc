"""How much the process that puts the report together keeps of all models: it has no limit of memory, as workers have."""

from __future__ import annotations

import pickle
from dataclasses import replace

from urdfcheck.core import SkippedCheck
from urdfcheck.core.scene import Scene
from urdfcheck.policy.report_limits import limit_size
from urdfcheck.run.findings import explain_left_out
from urdfcheck.run.jobs import UnitReport

# The rule about what is too large.
RULE = "URC905"
# Bytes of all findings of a run, and of what is drawn of one model and of all.
MAX_RUN_FINDINGS, MAX_SCENE, MAX_RUN_SCENES = 128 * 1024**2, 128 * 1024**2, 1024**3


def limit_scene(scene: Scene | None, unit_id: str) -> tuple[Scene | None, tuple[SkippedCheck, ...]]:
    """Return what is drawn of one model, or None and the line that says so where it is too large."""
    if scene is None or _measure(scene) <= MAX_SCENE:
        return scene, ()
    return None, _explain_undrawn(unit_id, MAX_SCENE)


class ReportSizes:
    """What is left for the reports that are still to come."""

    def __init__(self) -> None:
        self._findings, self._scenes = MAX_RUN_FINDINGS, MAX_RUN_SCENES

    def limit_report(self, report: UnitReport, unit_id: str) -> UnitReport:
        """Return a report without the findings and the scene for which there is no room; its worst finding stays."""
        findings, size = limit_size(report.findings, self._findings)
        self._findings = max(self._findings - size, 0)
        why = f"those of all models take more than {MAX_RUN_FINDINGS // 1024**2} MiB"
        skipped = (*report.skipped, *explain_left_out(unit_id, report.findings, findings, why))
        report = replace(report, findings=tuple(findings), skipped=skipped)
        if report.scene is None:
            return report
        self._scenes -= _measure(report.scene)
        if self._scenes >= 0:
            return report
        self._scenes = 0
        return replace(report, scene=None, skipped=(*skipped, *_explain_undrawn(unit_id, MAX_RUN_SCENES)))


def _measure(scene: Scene) -> int:
    return len(pickle.dumps(scene, pickle.HIGHEST_PROTOCOL))


def _explain_undrawn(unit_id: str, limit: int) -> tuple[SkippedCheck, ...]:
    reason = f"it is not drawn: what is drawn takes more than {limit // 1024**2} MiB"
    return (SkippedCheck(RULE, unit_id, reason),)
