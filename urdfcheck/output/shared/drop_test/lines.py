"""A drop test as styled lines for a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.text import Text

from urdfcheck.core.drive_test import DriveTest
from urdfcheck.core.drop_test import SECONDS, STEP, DropTest, ReleaseResult, StabilityCurve
from urdfcheck.output.shared.drop_test.drive_wording import (
    DRIVE_HEAD,
    DRIVE_TITLE,
    WHEEL_HEAD,
    describe_drive_setup,
    format_drive_rows,
    format_wheel_cells,
)
from urdfcheck.output.shared.drop_test.wording import (
    CONTACT_HEAD,
    OUTCOMES,
    describe_damping_scheme,
    describe_drop_setup,
    describe_reference_scales,
    format_contact_cells,
    format_largest_stable_step,
    format_peak_speed,
    format_release_heading,
    has_equal_contacts,
)
from urdfcheck.output.shared.escaping import escape_one_line

# Rows of a contact table.
MOST_LINKS = 12


def iter_drop_test_lines(drop_test: DropTest) -> Iterator[Text]:
    """Yield the setup and the outcome of a drop test, as lines that are not wrapped yet."""
    yield Text(
        f"let go for {SECONDS:g} s at a step of {1e3 * STEP:g} ms in {escape_one_line(drop_test.simulator)}", "bold"
    )
    for line in describe_drop_setup(drop_test):
        yield Text(line)
    yield Text()
    runs = (drop_test.free, drop_test.held)
    rows = [
        ("", *map(format_release_heading, runs)),
        *((name, *(word(release) for release in runs)) for name, word in OUTCOMES),
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    for number, row in enumerate(rows):
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield Text(line.rstrip(), "dim" if not number else "")
    yield Text(describe_reference_scales(drop_test), "dim")
    both = has_equal_contacts(drop_test)
    for release in (drop_test.held,) if both else runs:
        yield from _iter_contact_lines(drop_test, release, both)
    if drop_test.drive is not None:
        yield from _iter_drive_lines(drop_test.drive)
    for curve in drop_test.curves:
        yield from _iter_stability_lines(curve)
    yield Text()


def _iter_contact_lines(drop_test: DropTest, release: ReleaseResult, is_shared: bool) -> Iterator[Text]:
    if not release.touching:
        return
    yield Text()
    yield Text(
        f"on the ground at the end, {'with and without torques' if is_shared else format_release_heading(release)}",
        "bold",
    )
    shown = release.touching[:MOST_LINKS]
    rows = [("link", *CONTACT_HEAD), *((escape_one_line(t.link), *format_contact_cells(t)) for t in shown)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for number, row in enumerate(rows):
        cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        yield Text("  ".join(cells), "dim" if not number else "")
    if (rest := len(release.touching) - len(shown)) > 0:
        yield Text(f"… and {rest} more {'link' if rest == 1 else 'links'}")
    yield Text(
        f"together {sum(t.load for t in release.touching):.4g} N of {drop_test.weight:.4g} N, the robot's weight"
    )


def _iter_drive_lines(drive: DriveTest) -> Iterator[Text]:
    yield Text()
    yield Text(DRIVE_TITLE, "bold")
    for line in describe_drive_setup(drive):
        yield Text(line)
    shown = drive.wheels[:MOST_LINKS]
    tables = (
        (("", *DRIVE_HEAD), *format_drive_rows(drive)),
        (("joint", *WHEEL_HEAD), *((escape_one_line(w.joint), *format_wheel_cells(w)) for w in shown)),
    )
    for rows in tables:
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        for number, row in enumerate(rows):
            cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
            yield Text("  ".join(cells), "dim" if not number else "")


def _iter_stability_lines(curve: StabilityCurve) -> Iterator[Text]:
    yield Text()
    yield Text.assemble(
        f"{describe_damping_scheme(curve)}: ", (f"largest stable step {format_largest_stable_step(curve)}", "bold")
    )
    shown = [k for k in range(len(curve.steps)) if is_doubled_step(curve, k)]
    rows = (
        ("step, ms", *(f"{1e3 * curve.steps[k]:g}" for k in shown)),
        ("fastest, m/s", *(format_peak_speed(curve.speeds[k]) for k in shown)),
    )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row, style in zip(rows, ("dim", ""), strict=True):
        cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        yield Text("  ".join(cells), style)


def is_doubled_step(curve: StabilityCurve, index: int) -> bool:
    """Whether a step is a power of two times the smallest, and not one tried later between two of them."""
    return math.log2(curve.steps[index] / curve.steps[0]).is_integer()
