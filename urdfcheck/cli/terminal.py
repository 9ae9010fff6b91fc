"""What the commands print and write, and the exit codes that they end with."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from urdfcheck.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Run, Severity

OK, FINDINGS, FAILED, NOTHING = 0, 1, 2, 3
# Seconds from which on, and between which, a run says how far it is.
PROGRESS_FROM, PROGRESS_EVERY = 1.0, 0.2


def say(text: str, stream: TextIO | None = None) -> None:
    """Print a line for a person; on standard output, if on no other stream."""
    from urdfcheck.output.inert import for_log

    print(for_log(text), file=stream)


def silence_stdout() -> None:
    """What is left in the buffer goes nowhere, so that the interpreter does not try to write it once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def show(run: Run, output_format: str, color: str) -> None:
    """Print a run in this format; ``color``: auto | always | never."""
    from urdfcheck import output

    if output_format != "text":
        show_document(output.render(run, output_format))
        return
    from urdfcheck.output import text

    width, colored = text.WIDTH, color == "always"  # a CI log has no width of its own
    if sys.stdout.isatty() or os.environ.keys() & {"COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"}:
        from rich.console import Console

        # rich knows terminals, NO_COLOR and the window's width.
        terminal = Console()
        colored = colored or (color == "auto" and terminal.is_terminal and not terminal.no_color)
        width = terminal.width if terminal.is_terminal or "COLUMNS" in os.environ else width
    sys.stdout.write(text.render(run, width=width, color=colored))


def show_document(text: str) -> None:
    """JSON, HTML and XML are UTF-8 wherever they go; text has the terminal's encoding."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(text)


def write(text: str, file: Path) -> None:
    """Write a file whole or not at all; what is no file (``/dev/null``, a pipe) is written to, and not put in the place of."""
    import tempfile

    try:
        if file.exists() and not file.is_file() and not file.is_dir():
            with open(file, "w", encoding="utf-8", newline="\n") as out:
                out.write(text)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
        try:
            with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as out:
                out.write(text)
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(temporary, 0o666 & ~mask)
            os.replace(temporary, file)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise UrdfcheckError(f"cannot write {file}: {error.strerror or error}") from None


def progress() -> Callable[[int, int], None] | None:
    """Shows on a terminal how far a run is; nothing where no one watches."""
    if not sys.stderr.isatty():
        return None
    import time

    began = time.monotonic()
    shown = 0.0

    def show(done: int, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if done == total:
            text = ""
        elif now - began < PROGRESS_FROM or now - shown < PROGRESS_EVERY:
            return
        else:
            left = (now - began) / done * (total - done)
            text = f"{done:,} of {total:,} checked, about {left:,.0f} s left"
        if text or shown:
            print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)
            shown = now

    return show


def exit_code(run: Run, fail_on: str, *, allow_empty: bool = False) -> int:
    """Our own failures weigh more than findings, findings more than having had nothing to check. ``fail_on`` holds for what
    belongs to no model whose configuration says otherwise."""
    codes = {code_of(bool(run.failures), None, fail_on)}
    codes |= {code_of(False, f.severity, run.fail_on.get(f.model, fail_on)) for f in run.active}
    code = max(codes)
    return NOTHING if code == OK and not run.units and not allow_empty else code


def code_of(failed: bool, worst: Severity | None, fail_on: str) -> int:
    from urdfcheck.core import Severity

    if failed:
        return FAILED
    if fail_on != "never" and worst is not None and worst >= Severity.parse(fail_on):
        return FINDINGS
    return OK
