"""The reports of single units: of a folder in which one file changed, the other models are not audited again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport
from urdfcheck.run.replay.entries import Replays, is_repeatable, keep_result, make_key
from urdfcheck.source.project_folders import list_shared_folders
from urdfcheck.system.observing.observations import Observations


def enable_replay(settings: AuditSettings) -> AuditSettings:
    """Return settings with which reports are kept and recalled; the same ones where a report holds more than findings."""
    options = settings.options
    has_more = options.scene or options.pairs or options.drop or options.mechanism or options.index
    if settings.cache is None or options.texts or has_more:
        return settings
    return replace(settings, replay_key=make_key(settings, list_shared_folders()))


def keep_report(unit: Unit, settings: AuditSettings, report: UnitReport, observations: Observations) -> None:
    """Keep the report on a unit, if the same audit would give it again."""
    if settings.cache is None or not settings.replay_key or not is_repeatable(report.findings, report.failures):
        return
    keep_result(Path(settings.cache), _make_unit_key(unit, settings), report, observations)


class KnownReports:
    """The reports of earlier runs that still hold."""

    def __init__(self, settings: AuditSettings) -> None:
        self._settings = settings
        self._replays = Replays(Path(settings.cache)) if settings.cache is not None and settings.replay_key else None

    def recall(self, unit: Unit) -> UnitReport | None:
        """Return the report on a unit; None where it must be audited."""
        found = None if self._replays is None else self._replays.recall(_make_unit_key(unit, self._settings))
        if found is None:
            return None
        report: UnitReport = found[0]
        return replace(report, observations=found[1])


def _make_unit_key(unit: Unit, settings: AuditSettings) -> str:
    return make_key(settings.replay_key, unit)
