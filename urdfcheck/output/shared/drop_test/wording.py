"""A drop test in words and numbers, the same in every format."""

from __future__ import annotations

import math
from collections.abc import Sequence

from urdfcheck.core.drop_test import LATE_SECONDS, DropTest, GroundContact, ReleaseResult, StabilityCurve
from urdfcheck.output.shared.escaping import escape_one_line


def describe_drop_setup(drop_test: DropTest) -> list[str]:
    """Describe how the robot was set down, a sentence a line."""
    shapes = (
        "its visual geometry, because it has no collision geometry" if drop_test.drawn else "its collision geometry"
    )
    moving = " can move" if drop_test.fixed else ""
    root = f"root fixed ({escape_one_line(drop_test.fixed)})" if drop_test.fixed else "root free"
    ground = f"ground at z = {_format_metres(drop_test.ground)} m, the lowest point of {shapes}"
    if not drop_test.shapes:
        ground = "no ground: no shape could touch it"
    sentences = [f"{drop_test.mass:.4g} kg{moving}, {root}; {ground}"]
    if drop_test.unread:
        sentences.append(f"without the shapes that could not be measured: {_join_names(drop_test.unread)}")
    if drop_test.unlimited:
        sentences.append(f"held without limit, because the effort is 0 (JNT007): {_join_names(drop_test.unlimited)}")
    if drop_test.later is not None:
        sentences.append(f"held for {LATE_SECONDS:g} s: {_describe_outcome(drop_test.later)}")
    if drop_test.held.saturated:
        sentences.append(f"at their effort limit at the end: {_join_names(drop_test.held.saturated)}")
    if drop_test.undriven:
        sentences.append(f"not driven: {escape_one_line(drop_test.undriven)}")
    return sentences


def describe_reference_scales(drop_test: DropTest) -> str:
    """Describe the scales of the numbers: speed at rest, depth of a soft contact, energy."""
    return (
        f"At rest: below {_format_speed(drop_test.slow)}. Soft contacts sink in by about {1e3 * drop_test.soft:.2f} mm. "
        f"100 % is weight × size: {_format_energy(drop_test.weight * drop_test.size)} J."
    )


def format_release_heading(release: ReleaseResult) -> str:
    """Return what holds the joints in a release."""
    return "holding torques" if release.held else "no torques"


def _describe_outcome(release: ReleaseResult) -> str:
    if release.burst is not None:
        return f"explodes after {release.burst:.2g} s"
    if release.settled is None:
        return "falls over, still moves" if release.has_tipped else "still moves"
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


# Name of each outcome and how it is formatted.
OUTCOMES = (
    ("outcome", _describe_outcome),
    ("speed at the end", _format_end_speed),
    ("root rotated by", _format_tilt),
    ("sinks in by", _format_penetration),
    ("peak energy gain", _format_peak_energy_gain),
    ("energy at the end", _format_energy_change),
    ("joint deflection, rad or m", _format_joint_sag),
)


def format_largest_stable_step(curve: StabilityCurve) -> str:
    """Return the largest stable time step in words."""
    if curve.largest_step is None:
        return f"below {1e3 * curve.steps[0]:g} ms"
    if curve.all_stable:
        return f"{1e3 * curve.largest_step:.3g} ms or more"
    return f"{1e3 * curve.largest_step:.3g} ms"


def describe_damping_scheme(curve: StabilityCurve) -> str:
    """Return how damping is integrated."""
    return "MuJoCo's scheme" if curve.implicit else "Bullet's scheme: damping from before the step"


def format_contact_cells(touching: GroundContact) -> tuple[str, ...]:
    """Return the number of points, x, y and z (m) in the root's frame, depth (mm) and load (N)."""
    x, y, _ = touching.place
    places = map(_format_metres, (x, y, touching.lowest))
    return str(touching.points), *places, f"{1e3 * touching.depth:.2f}", f"{touching.load:.4g}"


CONTACT_HEAD = ("points", "x, m", "y, m", "z, m", "deep, mm", "load, N")


def has_equal_contacts(drop_test: DropTest) -> bool:
    """Whether the contact tables of both releases would be equal."""
    free, held = (
        [(t.link, t.points, round(t.lowest, 4)) for t in r.touching] for r in (drop_test.free, drop_test.held)
    )
    return free == held


def format_peak_speed(speed: float | None) -> str:
    """Format a speed in m/s; None means that the simulation burst."""
    return "burst" if speed is None else f"{speed:.2g}"


def _join_names(names: Sequence[str], most: int = 4) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(map(escape_one_line, names[:most])) + more
