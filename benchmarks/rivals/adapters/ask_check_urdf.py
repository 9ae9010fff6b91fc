"""``check_urdf`` of urdfdom, the parser of ROS: the program beside the Python that runs this."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

PROGRAM = Path(sys.executable).with_name("check_urdf")


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield its lines that are errors or warnings, and that it refuses the file."""
    done = subprocess.run([PROGRAM, file], capture_output=True, text=True, errors="replace", check=False)
    for line in (done.stderr + done.stdout).splitlines():
        if line.startswith(("Error:", "ERROR:", "Warning:")):
            yield "warning" if line.startswith("Warning") else "error", "line", "", line
    if done.returncode:
        yield "error", "refused", "", f"ends with {done.returncode}"
