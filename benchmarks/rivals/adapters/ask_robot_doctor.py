"""isaaclab-robot-doctor, as ``isaaclab-robot-doctor check`` does."""

from __future__ import annotations

from collections.abc import Iterator

from isaaclab_robot_doctor.checks import ERROR, WARN, run_checks
from isaaclab_robot_doctor.loader import load_robot
from isaaclab_robot_doctor.urdf import RobotParseError

SEVERITIES = {ERROR: "error", WARN: "warning"}


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield what it reports."""
    try:
        model = load_robot(file)
    except RobotParseError as error:
        yield "error", "refused", "", str(error)
        return
    for found in run_checks(model):
        yield SEVERITIES.get(found.severity, "info"), found.id, found.subject, f"{found.message} {found.hint}"
