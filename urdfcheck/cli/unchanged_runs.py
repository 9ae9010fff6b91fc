"""A run whose options and files are those of an earlier one: its outcome is reported again, and nothing else is loaded."""

from __future__ import annotations

import argparse
import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.system.cache_folder import find_default_folder

if TYPE_CHECKING:
    from urdfcheck.core import Run
    from urdfcheck.system.observing.observations import Observations

# Options that decide what is done with an outcome, and on how many cores it is found.
_OF_REPORTS = frozenset({"format", "output", "color", "quiet", "statistics", "allow_empty", "jobs", "no_cache"})


@dataclass(frozen=True, slots=True)
class UnchangedRuns:
    """Where the outcome of a command is kept."""

    folder: Path
    """That of the cache."""
    key: str

    @classmethod
    def for_options(cls, options: argparse.Namespace, *, has_texts: bool, needs_scene: bool) -> UnchangedRuns | None:
        """Return the place for the options of ``urdfcheck check``; None for those with which no outcome is kept.

        ``has_texts``: whether it checks what no file holds; ``needs_scene``: whether a report draws.
        """
        is_plain = not (options.fix or options.diff or options.watch or options.no_cache or has_texts or needs_scene)
        folder = find_default_folder() if is_plain else None
        if folder is None:
            return None
        from urdfcheck.run.replay.outcomes import make_outcome_key

        asked = {name: value for name, value in vars(options).items() if name not in _OF_REPORTS}
        return cls(folder, make_outcome_key(asked))

    def recall(self) -> tuple[Run, str] | None:
        """Return what :func:`urdfcheck.run.replay.outcomes.recall_outcome` does."""
        from urdfcheck.run.replay.outcomes import recall_outcome

        return recall_outcome(self.folder, self.key)

    def keep(self, outcome: Run, fail_on: str, observations: Observations | None) -> None:
        """Keep an outcome."""
        from urdfcheck.run.replay.outcomes import keep_outcome

        if observations is not None:
            keep_outcome(self.folder, self.key, outcome, fail_on, observations)


@contextlib.contextmanager
def observe_run(unchanged: UnchangedRuns | None) -> Iterator[Observations | None]:
    """Observe what a run depends on that may be kept."""
    if unchanged is None:
        yield None
        return
    from urdfcheck.system.installation import list_own_files
    from urdfcheck.system.observing.observations import observe

    with observe(apart=(unchanged.folder, *list_own_files())) as observations:
        yield observations
