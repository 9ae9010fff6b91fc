"""A drop test for a terminal and for other programs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from rich.text import Text

from urdfcheck.core.drop_test import LATE_SECONDS, SECONDS, STEP, DropTest, GroundContact, ReleaseResult, StabilityCurve
from urdfcheck.output.shared.inert import escape_one_line

# Links that are told of in one table.
MOST_LINKS = 12


def iter_drop_test_lines(drop_test: DropTest) -> Iterator[Text]:
    """What came of it, as lines that are not wrapped yet."""
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
    for curve in drop_test.curves:
        yield from _iter_stability_lines(curve)
    yield Text()


def describe_drop_setup(drop_test: DropTest) -> list[str]:
    """How it was set down, a sentence a line."""
    shapes = "what it draws, for it collides with nothing" if drop_test.drawn else "its collision geometry"
    moving = " can move" if drop_test.fixed else ""
    root = f"root fixed ({escape_one_line(drop_test.fixed)})" if drop_test.fixed else "root free"
    told = [
        f"{drop_test.mass:.4g} kg{moving}, {root}; ground at z = {_format_metres(drop_test.ground)} m, the lowest point of {shapes}"
    ]
    if drop_test.unlimited:
        told.append(f"held without limit, because the effort is 0 (JNT007): {_join_names(drop_test.unlimited)}")
    if drop_test.later is not None:
        told.append(f"held for {LATE_SECONDS:g} s: {_describe_outcome(drop_test.later)}")
    if drop_test.held.saturated:
        told.append(f"held with all their effort at the end: {_join_names(drop_test.held.saturated)}")
    return told


def describe_reference_scales(drop_test: DropTest) -> str:
    """What the numbers are measured by."""
    return (
        f"At rest: below {_format_speed(drop_test.slow)}. Soft contacts sink in by about {1e3 * drop_test.soft:.2f} mm. "
        f"100 % is weight × size: {_format_energy(drop_test.mass * 9.81 * drop_test.size)} J."
    )


def format_release_heading(release: ReleaseResult) -> str:
    """What holds the joints."""
    return "holding torques" if release.held else "no torques"


def _describe_outcome(release: ReleaseResult) -> str:
    if release.burst is not None:
        return f"explodes after {release.burst:.2g} s"
    if release.settled is None:
        return "falls, still moves" if release.has_tipped else "still moves"
    rest = "at rest" if release.settled == 0 else f"at rest after {release.settled:.2g} s"
    return f"tips over, {rest}" if release.has_tipped else rest


def _format_end_speed(release: ReleaseResult) -> str:
    if release.speed is None:
        return "-"
    named = f" ({escape_one_line(release.moving)})" if release.settled is None else ""
    return _format_speed(release.speed) + named


def _format_speed(speed: float) -> str:
    return f"{1e3 * speed:.2g} mm/s" if speed < 0.1 else f"{speed:.2g} m/s"


def _format_energy(value: float) -> str:
    return f"{float(f'{value:.3g}'):,g}"


def _format_metres(value: float) -> str:
    return f"{round(value, 4) + 0.0:.4f}"


def _format_tilt(release: ReleaseResult) -> str:
    return "-" if release.tilt is None else f"{math.degrees(release.tilt):.1f}°"


def _format_penetration(release: ReleaseResult) -> str:
    if release.burst is not None:
        return "-"
    return f"{1e3 * release.depth:.2f} mm" if release.touching else "touches nothing"


def _format_peak_energy_gain(release: ReleaseResult) -> str:
    return "-" if release.gain is None else f"{100 * release.gain:.2g} %"


def _format_energy_change(release: ReleaseResult) -> str:
    return "-" if release.change is None else f"{100 * release.change:+.2g} %"


def _format_joint_sag(release: ReleaseResult) -> str:
    if release.sag is None:
        return "-" if release.burst is not None else "nothing is driven" if release.held else "not held"
    return f"{release.sag:.2g}" + (f" ({escape_one_line(release.sagging)})" if release.sag > 1e-3 else "")


# Name of each outcome and how it is told.
OUTCOMES = (
    ("outcome", _describe_outcome),
    ("speed at the end", _format_end_speed),
    ("root turned by", _format_tilt),
    ("sinks in by", _format_penetration),
    ("energy, most above start", _format_peak_energy_gain),
    ("energy at the end", _format_energy_change),
    ("joints give way, rad or m", _format_joint_sag),
)


def format_largest_stable_step(curve: StabilityCurve) -> str:
    """The largest step, in words."""
    if curve.largest_step is None:
        return f"below {1e3 * curve.steps[0]:g} ms"
    if curve.all_stable:
        return f"{1e3 * curve.largest_step:.3g} ms or more"
    return f"{1e3 * curve.largest_step:.3g} ms"


def describe_damping_scheme(curve: StabilityCurve) -> str:
    """How damping is integrated."""
    return "as MuJoCo steps" if curve.implicit else "as Bullet steps, damping taken before the step"


def format_contact_cells(touching: GroundContact) -> tuple[str, ...]:
    """Number of points, x, y and z in the root's frame, depth and load."""
    x, y, _ = touching.place
    places = map(_format_metres, (x, y, touching.lowest))
    return str(touching.points), *places, f"{1e3 * touching.depth:.2f}", f"{touching.load:.4g}"


CONTACT_HEAD = ("points", "x, m", "y, m", "z, m", "deep, mm", "load, N")


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
    if len(release.touching) > len(shown):
        yield Text(f"… and {len(release.touching) - len(shown)} more links")
    yield Text(
        f"together {sum(t.load for t in release.touching):.4g} N of {drop_test.mass * 9.81:.4g} N, the robot's weight"
    )


def has_equal_contacts(drop_test: DropTest) -> bool:
    """Whether the tables of both would say the same."""
    free, held = (
        [(t.link, t.points, round(t.lowest, 4)) for t in r.touching] for r in (drop_test.free, drop_test.held)
    )
    return free == held


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


def format_peak_speed(speed: float | None) -> str:
    return "burst" if speed is None else f"{speed:.2g}"


def is_doubled_step(curve: StabilityCurve, index: int) -> bool:
    """Whether a step is one of those that were tried first, not one between two of them."""
    return math.log2(curve.steps[index] / curve.steps[0]).is_integer()


def _join_names(names: Sequence[str], most: int = 4) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(map(escape_one_line, names[:most])) + more


def build_drop_test_object(drop_test: DropTest) -> dict[str, Any]:
    """A drop test as the schema describes it."""
    curves = [
        {**asdict(curve), "largest": curve.largest_step, "all_stable": curve.all_stable} for curve in drop_test.curves
    ]
    return {**asdict(drop_test), "seconds": SECONDS, "step": STEP, "curves": curves}
