"""What engines did with single models: an engine is not asked again about a model that has not changed."""

from __future__ import annotations

from pathlib import Path

from urdfcheck.core import EngineAnswer
from urdfcheck.run.jobs import AuditSettings, Unit
from urdfcheck.run.replay.entries import Replays, keep_result, make_key
from urdfcheck.system.observing.observations import Observations


class KnownAnswers:
    """The answers of earlier runs that still hold."""

    def __init__(self, settings: AuditSettings) -> None:
        """``settings``: those of `urdfcheck.run.replay.reports.enable_replay`."""
        self._settings = settings
        self._folder = Path(settings.cache) if settings.cache is not None and settings.replay_key else None
        self._replays = None if self._folder is None else Replays(self._folder)

    def recall(self, unit: Unit, engine: str, version: str) -> tuple[EngineAnswer, Observations] | None:
        """Return what an engine did with the model of a unit, and what that depends on; None where it must be asked."""
        return None if self._replays is None else self._replays.recall(self._make_key(unit, engine, version))

    def keep(self, unit: Unit, answer: EngineAnswer, observations: Observations) -> None:
        """Keep an answer that the engine would give again."""
        if self._folder is not None and not answer.stopped:
            keep_result(self._folder, self._make_key(unit, answer.engine, answer.version), answer, observations)

    def _make_key(self, unit: Unit, engine: str, version: str) -> str:
        return make_key(self._settings.replay_key, unit, engine, version)
