"""How much the process that puts the report together keeps of all models: it has no limit of memory, as workers have."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from urdfcheck.core import SkippedCheck
from urdfcheck.policy.report_limits import limit_size, measure_size
from urdfcheck.run.findings import explain_left_out
from urdfcheck.run.jobs import UnitReport

if TYPE_CHECKING:
    from urdfcheck.core.mechanism import RobotMechanism
    from urdfcheck.core.scene import Scene

# The rule about what is too large.
RULE = "URC905"
# Bytes of all findings of a run, and of what is drawn of one model and of all.
MAX_RUN_FINDINGS, MAX_SCENE, MAX_RUN_SCENES = 128 * 1024**2, 128 * 1024**2, 1024**3
# Bytes of one model in plain values, to compare it: 1,000 links with a mesh each take about 4 MB.
MAX_MECHANISM = 64 * 1024**2


def limit_scene(scene: Scene | None, unit_id: str) -> tuple[Scene | None, int, tuple[SkippedCheck, ...]]:
    """Return what is drawn of one model with its size; None and the line that says so where it is too large."""
    size = 0 if scene is None else measure_size(scene)
    return (scene, size, ()) if size <= MAX_SCENE else (None, 0, _explain_undrawn(unit_id, MAX_SCENE))


def limit_mechanism(
    mechanism: RobotMechanism | None, unit_id: str
) -> tuple[RobotMechanism | None, tuple[SkippedCheck, ...]]:
    """Return a model in plain values; None and the line that says so where it is too large."""
    if mechanism is None or measure_size(mechanism) <= MAX_MECHANISM:
        return mechanism, ()
    reason = f"it is not compared: its links and joints take more than {MAX_MECHANISM // 1024**2} MiB"
    return None, (SkippedCheck(RULE, unit_id, reason, is_partial=True),)


class ReportSizes:
    """What is left for the reports that are still to come."""

    def __init__(self) -> None:
        self._findings, self._scenes = MAX_RUN_FINDINGS, MAX_RUN_SCENES

    def limit_report(self, report: UnitReport, unit_id: str) -> UnitReport:
        """Return a report without the findings and the scene for which there is no room; its worst finding stays."""
        if report.findings_size > self._findings:
            findings, size = limit_size(report.findings, self._findings)
            why = f"those of all models take more than {MAX_RUN_FINDINGS // 1024**2} MiB"
            skipped = (*report.skipped, *explain_left_out(unit_id, report.findings, findings, why))
            report = replace(report, findings=tuple(findings), findings_size=size, skipped=skipped)
        self._findings = max(self._findings - report.findings_size, 0)
        if report.scene_size > self._scenes:
            skipped = (*report.skipped, *_explain_undrawn(unit_id, MAX_RUN_SCENES))
            report = replace(report, scene=None, scene_size=0, skipped=skipped)
        self._scenes -= report.scene_size
        return report


def _explain_undrawn(unit_id: str, limit: int) -> tuple[SkippedCheck, ...]:
    reason = f"it is not drawn: what is drawn takes more than {limit // 1024**2} MiB"
    return (SkippedCheck(RULE, unit_id, reason, is_partial=True),)
