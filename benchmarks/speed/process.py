"""Whole processes, timed from outside, with the memory of the largest process among them and their workers."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
CHECK = (sys.executable, "-m", "urdfcheck", "check")
SCRIPT = (sys.executable, str(HERE / "careful_user.py"))
SCRIPT_IMPORTS = (sys.executable, "-c", "import numpy, pinocchio, trimesh, yourdfpy")
PINOCCHIO = (sys.executable, "-c", "import pinocchio")
EMPTY = (sys.executable, "-c", "pass")


@dataclass(frozen=True, slots=True)
class Took:
    """``seconds`` of wall time; ``processor`` seconds of all processes and ``peak`` MiB of the largest single one, 0 where the
    platform does not tell."""

    seconds: float
    processor: float
    peak: float
    code: int


def took(command: Sequence[str], *, cache: str = "") -> Took:
    """Run a command to its end, its output thrown away. ``cache`` is urdfcheck's folder for results that it keeps.

    :raises SystemExit: when urdfcheck itself fails (exit code 2 or more): its time would mean nothing.
    """
    environment = {**os.environ, "URDFCHECK_CACHE_DIR": cache} if cache else dict(os.environ)
    with tempfile.TemporaryFile() as errors:
        began = time.perf_counter()
        process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=errors)
        if hasattr(os, "wait4"):
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            # Kibibytes on Linux, bytes on macOS; of the process or of one of the workers it waited for.
            peak = usage.ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)
            processor = usage.ru_utime + usage.ru_stime
        else:
            process.wait()
            peak = processor = 0.0
        seconds = time.perf_counter() - began
        if command[: len(CHECK)] == CHECK and process.returncode not in (0, 1):
            errors.seek(0)
            said = errors.read().decode(errors="replace")[-2000:]
            raise SystemExit(f"{' '.join(command)[:300]} ended with {process.returncode}:\n{said}")
    return Took(seconds, processor, peak, process.returncode)
