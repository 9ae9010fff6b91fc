"""Printing, writing, progress and exit codes of the commands."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

# Type checkers take it for typing's, whose import takes a fifth of the time of --help.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import TextIO

    from urdfcheck.core import Run, Severity
    from urdfcheck.core.errors import ModelNotCheckedError
    from urdfcheck.output.text import DetailLevel
    from urdfcheck.policy.policy import Policy

OK, FINDINGS, FAILED, NOTHING = 0, 1, 2, 3
# Seconds after which the progress bar appears, seconds between its updates, and its columns.
PROGRESS_FROM, PROGRESS_EVERY, BAR = 1.0, 0.2, 30


def say(text: str, stream: TextIO | None = None) -> None:
    """Print a line for a person, on standard output unless another stream is given."""
    from urdfcheck.output.shared.escaping import escape_for_log

    print(escape_for_log(text), file=stream)


def silence_stdout() -> None:
    """Discard what is left in the buffer, so that the interpreter does not try to write it again at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def print_run(
    run: Run, output_format: str, color: str, detail: DetailLevel | None = None, fail_on: str = "error"
) -> None:
    """Print a run in a format.

    :param color: auto | always | never.
    :param detail: see :func:`urdfcheck.output.text.render`, also for ``fail_on``.
    """
    from urdfcheck import output

    if output_format != "text":
        print_document(output.render(run, output_format))
        return
    from urdfcheck.output import text

    width, colored = _choose_width_and_color(color)
    detail = text.DetailLevel.BRIEF if detail is None else detail
    sys.stdout.write(text.render(run, width=width, color=colored, detail=detail, fail_on=fail_on))


def print_statistics(run: Run, color: str) -> None:
    """Print how often each rule fired in a run; ``color``: auto | always | never."""
    from urdfcheck.output import text

    width, colored = _choose_width_and_color(color)
    sys.stdout.write(text.render_statistics(run, width=width, color=colored))


def _choose_width_and_color(color: str) -> tuple[int, bool]:
    """Return the columns of standard output, and whether it gets colours."""
    from urdfcheck.output.text import WIDTH

    width, colored = WIDTH, color == "always"  # a CI log has no width
    if sys.stdout.isatty() or os.environ.keys() & {"COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"}:
        from rich.console import Console

        # rich detects terminals, NO_COLOR and the width of the window.
        terminal = Console()
        colored = colored or (color == "auto" and terminal.is_terminal and not terminal.no_color)
        width = terminal.width if terminal.is_terminal or "COLUMNS" in os.environ else width
    return width, colored


def print_document(text: str) -> None:
    """Print JSON, HTML or XML, which are UTF-8 everywhere; text has the terminal's encoding."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(text)


def make_progress_printer() -> Callable[[int, int], None] | None:
    """Make a function that shows the progress of a run on the terminal; None without a terminal.

    Not rich.progress: its import takes 47 ms of processor time (the least: 33 ms; rich.console alone 29 ms; 30 runs), whenever
    a terminal is attached, and most runs end before the bar would appear.
    """
    if not _is_watched():
        return None
    import time

    start = time.monotonic()
    last_update = 0.0

    def show_progress(done: int, total: int) -> None:
        nonlocal last_update
        now = time.monotonic()
        if done == total:
            if last_update:
                erase_progress()
        elif now - start >= PROGRESS_FROM and now - last_update >= PROGRESS_EVERY:
            remaining = (now - start) / done * (total - done)
            print(f"\r{_format_bar(done, total, remaining)}\x1b[K", end="", file=sys.stderr, flush=True)
            last_update = now

    return show_progress


def erase_progress() -> None:
    """Erase the progress bar."""
    if _is_watched():
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def _is_watched() -> bool:
    """Whether standard error is a terminal that can erase a line."""
    return sys.stderr.isatty() and os.environ.get("TERM") != "dumb" and not os.environ.get("CI")


def get_columns() -> int:
    """Return the width of the terminal, or what ``COLUMNS`` says: the answer of `shutil.get_terminal_size`."""
    named = os.environ.get("COLUMNS", "")
    if named.isdecimal() and int(named) > 0:
        return int(named)
    try:
        return os.get_terminal_size(sys.__stdout__.fileno()).columns or 80  # type: ignore[union-attr]
    except (AttributeError, ValueError, OSError):  # there is none
        return 80


def _format_bar(done: int, total: int, remaining: float) -> str:
    """Return the progress on one line of any window, because a wrapped line could not be erased; ``remaining`` in s."""
    try:
        columns = os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except OSError:
        columns = 80
    text = f"{done:,} of {total:,} checked, about {_format_seconds(remaining)} left"
    full = BAR * done // total
    bar = "━" * full + "─" * (BAR - full)
    try:
        bar.encode(sys.stderr.encoding or "ascii")
    except UnicodeEncodeError:
        bar = "#" * full + "." * (BAR - full)
    return f"{bar}  {text}" if len(bar) + len(text) + 2 < columns else text[: columns - 1]


def _format_seconds(seconds: float) -> str:
    whole = round(seconds)
    return f"{whole} s" if whole < 100 else f"{whole // 60:,} min {whole % 60} s"


def report_accepted(error: ModelNotCheckedError, policy: Policy) -> int:
    """Say that a model was not checked and return 0, where the configuration or the command line accepts that (``unchecked``).

    :raises ModelNotCheckedError: the error, where it is not accepted.
    """
    if not policy.accepts_unchecked:
        raise error
    erase_progress()
    say(f"urdfcheck: {error} (accepted)", sys.stderr)
    return OK


def is_empty(run: Run) -> bool:
    """Whether nothing that was named was checked: of a set of macros that no model reads at most its package was."""
    return not run.units or (not run.models and any(skip.code == "ALL" for skip in run.skipped))


def compute_exit_code(run: Run, fail_on: str, *, allow_empty: bool = False) -> int:
    """Return the exit code: failures of urdfcheck outweigh findings, and these outweigh an empty run.

    A model that was not checked counts as an error, or as a warning where that is accepted.

    :param fail_on: the least severity that fails the run, except for models whose configuration sets another.
    """
    codes = {FAILED if run.failures else OK}
    codes |= {combine_exit_code(False, f.severity, run.fail_on.get(f.model, fail_on)) for f in run.active_findings}
    # Whatever the findings are: nothing is known of a model that was not checked.
    codes |= {
        combine_exit_code(False, info.unchecked_severity, run.fail_on.get(info.id, fail_on)) for info in run.models
    }
    code = max(codes)
    return NOTHING if code == OK and is_empty(run) and not allow_empty else code


def combine_exit_code(failed: bool, worst: Severity | None, fail_on: str) -> int:
    """Return the exit code for the worst severity of some findings."""
    from urdfcheck.core import Severity

    if failed:
        return FAILED
    if fail_on != "never" and worst is not None and worst >= Severity.parse(fail_on):
        return FINDINGS
    return OK
