"""TrueRig, as ``truerig validate`` does."""

from __future__ import annotations

from collections.abc import Iterator

from truerig import load
from truerig.validate import validate

SEVERITIES = {"info": "info", "warn": "warning", "error": "error"}


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield what it reports when it loads the file and of the loaded model."""
    try:
        robot = load(file)
    except Exception as error:  # whatever its parser raises, the command ends with it
        yield "error", "refused", "", str(error)
        return
    for event in (*robot.loss_log, *validate(robot)):
        yield SEVERITIES[event.severity.value], event.category, event.element, event.message
