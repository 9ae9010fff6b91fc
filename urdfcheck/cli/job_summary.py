"""The summary of a GitHub job: a file, named by the runner, to which each command of a step appends Markdown."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Run
    from urdfcheck.core.model_diff import Diff

# Characters below which no useful summary fits. GitHub shows nothing of a summary that is too large.
LEAST = 2_000


def find_summary_file() -> Path | None:
    """Return the file of the summary; None outside a job."""
    name = os.environ.get("GITHUB_STEP_SUMMARY")
    return Path(name) if name else None


def append_summary(run: Run, reports: Sequence[str], file: Path) -> None:
    """Append the findings of a run, as many as fit; ``reports``: the files of its HTML reports.

    :raises UrdfcheckError: when the file cannot be written.
    """
    from urdfcheck.output.markdown import render_job_summary

    _append(lambda room: render_job_summary(run, reports, room), file)


def append_comparison(diff: Diff, file: Path) -> None:
    """Append what a change does to the robots, as much as fits.

    :raises UrdfcheckError: when the file cannot be written.
    """
    from urdfcheck.output.changes.markdown import render_job_summary

    _append(lambda room: render_job_summary(diff, room), file)


def _append(render: Callable[[int], str], file: Path) -> None:
    """Append a text that is made for so many bytes."""
    from urdfcheck.output.markdown import SUMMARY_LIMIT

    try:
        room = SUMMARY_LIMIT - (file.stat().st_size if file.is_file() else 0)
        if room >= LEAST:
            with open(file, "a", encoding="utf-8", newline="\n") as out:
                out.write(render(room) + "\n")
    except OSError as error:
        raise UrdfcheckError(f"cannot write the summary of the job, {file}: {error.strerror or error}") from None
