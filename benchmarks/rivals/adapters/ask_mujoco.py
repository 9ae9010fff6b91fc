"""MuJoCo's compiler. It is told to keep the paths of meshes, as its documentation says for URDF; all else is its default."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import mujoco
from printed import capture_lines

COMPILER = '<mujoco><compiler strippath="false"/></mujoco>'


def load(file: str) -> mujoco.MjModel:
    """Return the compiled model.

    :raises ValueError: if MuJoCo refuses the file.
    """
    text = Path(file).read_text(encoding="utf-8")
    return mujoco.MjModel.from_xml_string(re.sub(r"(<robot\b[^>]*>)", rf"\1{COMPILER}", text, count=1))


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield why it refuses the file, and its warnings."""
    with capture_lines() as lines:
        try:
            load(file)
            refused = ""
        except ValueError as error:
            refused = " ".join(str(error).split())
    if refused:
        yield "error", "refused", "", refused
    for line in lines:
        if "WARNING" in line.upper():
            yield "warning", "warning", "", line
