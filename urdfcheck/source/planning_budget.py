"""The time limit of the search for models: what is not read in time is reported, and does not stop the rest."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from urdfcheck.core.errors import ModelTimeout, UrdfcheckError
from urdfcheck.source.model_file import ModelFile
from urdfcheck.source.package.finder import format_path
from urdfcheck.system import sandbox

_Seen = TypeVar("_Seen")


class PlanningBudget:
    """The time that is left of a search. ``seconds``: for all of it; ``seconds_per_file``: for one file; 0: unlimited."""

    def __init__(self, seconds: float = 0.0, seconds_per_file: float = 0.0) -> None:
        self.seconds = seconds
        self.seconds_per_file = seconds_per_file
        self.unread: list[tuple[str, str]] = []
        """The files that were not read, each with the reason."""
        self._end = time.monotonic() + seconds if seconds else None

    def is_used_up(self) -> bool:
        """Whether no time is left."""
        return self._end is not None and time.monotonic() >= self._end

    def explain(self) -> str:
        """Return the reason for files that are no longer read."""
        return f"is not checked: looking for models took more than {self.seconds:g} s (--timeout)"

    def read_file(self, path: Path) -> ModelFile | None:
        """Read a model file; None as for `look_at`."""
        return self.look_at(path, lambda: ModelFile(path))

    def look_at(self, path: Path, read: Callable[[], _Seen]) -> _Seen | None:
        """Return what ``read`` makes of a file; None, with a note, if that takes too long or too much memory, if it fails for a
        unexpected reason, or if no time is left.

        :raises OSError: as ``read`` does, and UrdfcheckError.
        """
        if self.is_used_up():
            self.unread.append((format_path(path), self.explain()))
            return None
        try:
            with sandbox.enforce_deadline(self.seconds_per_file):
                return read()
        except ModelTimeout:
            reason = f"is not checked: reading it takes more than {self.seconds_per_file:g} s (--timeout)"
        except MemoryError:
            reason = "is not checked: reading it takes too much memory (--memory)"
        except (OSError, UrdfcheckError):
            raise
        except Exception as error:
            reason = f"is not checked: reading it crashed ({type(error).__name__})"
        self.unread.append((format_path(path), reason))
        return None
