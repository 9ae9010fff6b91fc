"""A drive test in words and numbers, the same in every format."""

from __future__ import annotations

import math

from urdfcheck.core.drive_test import DriveTest, WheelTravel
from urdfcheck.output.shared.escaping import escape_one_line

DRIVE_TITLE = "driven: half a turn of the wheels"
DRIVE_HEAD = ("all ahead", "against each other, to the left")
WHEEL_HEAD = ("radius, mm", "rotation lost", "load, N")


def describe_drive_setup(drive: DriveTest) -> list[str]:
    """Describe what drives the robot, and what was expected, a sentence a line."""
    left, right = (", ".join(map(escape_one_line, side[:4])) for side in (drive.left, drive.right))
    typed = [
        f"{name} {size:.4g} m"
        for name, size in (("wheel radius", drive.typed_radius), ("separation", drive.typed_separation))
        if size is not None
    ]
    return [
        f"driven wheels by {escape_one_line(drive.source)}: {left} on the left, {right} on the right; "
        f"ahead is the x axis of {escape_one_line(drive.frame)}",
        f"in the model: wheel radius {drive.radius:.4g} m, separation {drive.separation:.4g} m"
        + (f"; typed: {', '.join(typed)}" if typed else ""),
        "only the driven wheels have friction: what else touches the ground slides",
    ]


def format_drive_rows(drive: DriveTest) -> list[tuple[str, str, str]]:
    """Return the name of each outcome, and its text for the run ahead and for the turn."""
    ahead, turning = drive.forward, drive.turning
    return [
        ("ahead", _format_length(ahead.ahead), _format_length(turning.ahead)),
        ("to the left", _format_length(ahead.aside), _format_length(turning.aside)),
        ("heading", _format_angle(ahead.turned), _format_angle(turning.turned)),
        ("expected", _format_length(drive.expected_distance), _format_angle(drive.expected_turn)),
        ("greatest slip", _format_share(ahead.slip), _format_share(turning.slip)),
    ]


def format_wheel_cells(wheel: WheelTravel) -> tuple[str, ...]:
    """Return the height of the axle (mm), the share of the rotation that was lost, and the load (N)."""
    return f"{1e3 * wheel.radius:.4g}", _format_share(wheel.slip), f"{wheel.load:.4g}"


def _format_length(length: float) -> str:
    return f"{round(1e3 * length, 1) + 0.0:.1f} mm"


def _format_angle(angle: float) -> str:
    return f"{round(math.degrees(angle), 1) + 0.0:.1f}°"


def _format_share(share: float) -> str:
    return f"{round(100 * share, 1) + 0.0:.1f} %"
