"""A drop test for a terminal and for other programs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from rich.text import Text

from urdfcheck.core.drop_test import LATER, SECONDS, STEP, Curve, Drop, Release, Touching
from urdfcheck.output.shared.inert import one_line

# Links that are told of in one table.
MOST_LINKS = 12


def lines(found: Drop) -> Iterator[Text]:
    """What came of it, as lines that are not wrapped yet."""
    yield Text(f"let go for {SECONDS:g} s at a step of {1e3 * STEP:g} ms in {one_line(found.simulator)}", "bold")
    for line in setting(found):
        yield Text(line)
    yield Text()
    runs = (found.free, found.held)
    rows = [("", *map(heading, runs)), *((name, *(word(release) for release in runs)) for name, word in OUTCOMES)]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    for number, row in enumerate(rows):
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield Text(line.rstrip(), "dim" if not number else "")
    yield Text(scales(found), "dim")
    both = alike(found)
    for release in (found.held,) if both else runs:
        yield from _contacts(found, release, both)
    for curve in found.curves:
        yield from _curve(curve)
    yield Text()


def setting(found: Drop) -> list[str]:
    """How it was set down, a sentence a line."""
    shapes = "what it draws, for it collides with nothing" if found.drawn else "its collision geometry"
    moving = " can move" if found.fixed else ""
    root = f"root fixed ({one_line(found.fixed)})" if found.fixed else "root free"
    told = [
        f"{found.mass:.4g} kg{moving}, {root}; ground at z = {_metres(found.ground)} m, the lowest point of {shapes}"
    ]
    if found.unlimited:
        told.append(f"held without limit, because the effort is 0 (JNT007): {_some(found.unlimited)}")
    if found.later is not None:
        told.append(f"held for {LATER:g} s: {_outcome(found.later)}")
    if found.held.saturated:
        told.append(f"held with all their effort at the end: {_some(found.held.saturated)}")
    return told


def scales(found: Drop) -> str:
    """What the numbers are measured by."""
    return (
        f"At rest: below {_speed_told(found.slow)}. Soft contacts sink in by about {1e3 * found.soft:.2f} mm. "
        f"100 % is weight × size: {_joules(found.mass * 9.81 * found.size)} J."
    )


def heading(release: Release) -> str:
    """What holds the joints."""
    return "holding torques" if release.held else "no torques"


def _outcome(release: Release) -> str:
    if release.burst is not None:
        return f"explodes after {release.burst:.2g} s"
    if release.settled is None:
        return "falls, still moves" if release.tipped else "still moves"
    rest = "at rest" if release.settled == 0 else f"at rest after {release.settled:.2g} s"
    return f"tips over, {rest}" if release.tipped else rest


def _speed(release: Release) -> str:
    if release.speed is None:
        return "-"
    named = f" ({one_line(release.moving)})" if release.settled is None else ""
    return _speed_told(release.speed) + named


def _speed_told(speed: float) -> str:
    return f"{1e3 * speed:.2g} mm/s" if speed < 0.1 else f"{speed:.2g} m/s"


def _joules(value: float) -> str:
    return f"{float(f'{value:.3g}'):,g}"


def _metres(value: float) -> str:
    return f"{round(value, 4) + 0.0:.4f}"


def _tilt(release: Release) -> str:
    return "-" if release.tilt is None else f"{math.degrees(release.tilt):.1f}°"


def _sinking(release: Release) -> str:
    if release.burst is not None:
        return "-"
    return f"{1e3 * release.depth:.2f} mm" if release.touching else "touches nothing"


def _gain(release: Release) -> str:
    return "-" if release.gain is None else f"{100 * release.gain:.2g} %"


def _change(release: Release) -> str:
    return "-" if release.change is None else f"{100 * release.change:+.2g} %"


def _sag(release: Release) -> str:
    if release.sag is None:
        return "-" if release.burst is not None else "nothing is driven" if release.held else "not held"
    return f"{release.sag:.2g}" + (f" ({one_line(release.sagging)})" if release.sag > 1e-3 else "")


# Name of each outcome and how it is told.
OUTCOMES = (
    ("outcome", _outcome),
    ("speed at the end", _speed),
    ("root turned by", _tilt),
    ("sinks in by", _sinking),
    ("energy, most above start", _gain),
    ("energy at the end", _change),
    ("joints give way, rad or m", _sag),
)


def step_told(curve: Curve) -> str:
    """The largest step, in words."""
    if curve.largest is None:
        return f"below {1e3 * curve.steps[0]:g} ms"
    if curve.all_stable:
        return f"{1e3 * curve.largest:.3g} ms or more"
    return f"{1e3 * curve.largest:.3g} ms"


def curve_named(curve: Curve) -> str:
    """How damping is integrated."""
    return "as MuJoCo steps" if curve.implicit else "as Bullet steps, damping taken before the step"


def contact_cells(touching: Touching) -> tuple[str, ...]:
    """Number of points, x, y and z in the root's frame, depth and load."""
    x, y, _ = touching.place
    places = map(_metres, (x, y, touching.lowest))
    return str(touching.points), *places, f"{1e3 * touching.depth:.2f}", f"{touching.load:.4g}"


CONTACT_HEAD = ("points", "x, m", "y, m", "z, m", "deep, mm", "load, N")


def _contacts(found: Drop, release: Release, both: bool) -> Iterator[Text]:
    if not release.touching:
        return
    yield Text()
    yield Text(f"on the ground at the end, {'with and without torques' if both else heading(release)}", "bold")
    shown = release.touching[:MOST_LINKS]
    rows = [("link", *CONTACT_HEAD), *((one_line(t.link), *contact_cells(t)) for t in shown)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for number, row in enumerate(rows):
        cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        yield Text("  ".join(cells), "dim" if not number else "")
    if len(release.touching) > len(shown):
        yield Text(f"… and {len(release.touching) - len(shown)} more links")
    yield Text(
        f"together {sum(t.load for t in release.touching):.4g} N of {found.mass * 9.81:.4g} N, the robot's weight"
    )


def alike(found: Drop) -> bool:
    """Whether the tables of both would say the same."""
    free, held = ([(t.link, t.points, round(t.lowest, 4)) for t in r.touching] for r in (found.free, found.held))
    return free == held


def _curve(curve: Curve) -> Iterator[Text]:
    yield Text()
    yield Text.assemble(f"{curve_named(curve)}: ", (f"largest stable step {step_told(curve)}", "bold"))
    shown = [k for k in range(len(curve.steps)) if is_doubled(curve, k)]
    rows = (
        ("step, ms", *(f"{1e3 * curve.steps[k]:g}" for k in shown)),
        ("fastest, m/s", *(told_speed(curve.speeds[k]) for k in shown)),
    )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row, style in zip(rows, ("dim", ""), strict=True):
        cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        yield Text("  ".join(cells), style)


def told_speed(speed: float | None) -> str:
    return "burst" if speed is None else f"{speed:.2g}"


def is_doubled(curve: Curve, place: int) -> bool:
    """Whether a step is one of those that were tried first, not one between two of them."""
    return math.log2(curve.steps[place] / curve.steps[0]).is_integer()


def _some(names: Sequence[str], most: int = 4) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(map(one_line, names[:most])) + more


def drop_object(found: Drop) -> dict[str, Any]:
    """A drop test as the schema describes it."""
    curves = [{**asdict(curve), "largest": curve.largest, "all_stable": curve.all_stable} for curve in found.curves]
    return {**asdict(found), "seconds": SECONDS, "step": STEP, "curves": curves}
