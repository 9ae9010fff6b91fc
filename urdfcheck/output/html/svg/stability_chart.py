"""Speed against time step as a chart."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from urdfcheck.core.drop_test import StabilityCurve
from urdfcheck.output.html.html_text import escape_html, format_number
from urdfcheck.output.shared.drop_test.wording import format_peak_speed

# Size of the drawing, and the area inside its axes, in px.
WIDTH, HEIGHT = 640, 260
LEFT, RIGHT, TOP, BOTTOM = 64, 620, 16, 212


def get_curve_class(curve: StabilityCurve) -> str:
    """Return the CSS class of a curve."""
    return "implicit" if curve.implicit else "explicit"


def draw_stability_chart(curves: Sequence[StabilityCurve]) -> str:
    """Draw the speed of the fastest link (m/s) against the time step (ms), both logarithmic."""
    steps = sorted({step for curve in curves for step in curve.steps})
    speeds = [speed for curve in curves for speed in curve.speeds if speed is not None and speed > 0]
    low, high = _compute_decades(speeds or [1.0])

    def project_step(step: float) -> float:
        return LEFT + (RIGHT - LEFT) * math.log(step / steps[0]) / math.log(steps[-1] / steps[0])

    def project_speed(speed: float) -> float:
        part = (math.log10(max(speed, 10.0**low)) - low) / (high - low)
        return BOTTOM - (BOTTOM - TOP) * min(part, 1.0)

    drawn = [_draw_grid(project_step, project_speed, steps=steps, decades=(low, high))]
    for curve in curves:
        points = list(zip(curve.steps, curve.speeds, curve.stable, strict=True))
        line = [
            (project_step(step), project_speed(speed)) for step, speed, stable in points if speed is not None and stable
        ]
        path = " ".join(f"{'L' if i else 'M'}{px:.1f} {py:.1f}" for i, (px, py) in enumerate(line))
        drawn.append(f'<path class="curve {get_curve_class(curve)}" d="{path}"/>' if line else "")
        for step, speed, stable in points:
            px, py = project_step(step), TOP if speed is None else project_speed(speed)
            mark = (
                f'<circle class="{get_curve_class(curve)}" cx="{px:.1f}" cy="{py:.1f}" r="3.5"/>'
                if stable
                else f'<path class="bad" d="M{px - 4:.1f} {py - 4:.1f}l8 8m0-8l-8 8"/>'
            )
            tooltip = f"{1e3 * step:.3g} ms: {format_peak_speed(speed)}{'' if speed is None else ' m/s'}"
            drawn.append(f"<g>{mark}<title>{escape_html(tooltip)}</title></g>")
    return (
        f'<svg class="chart" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="Largest speed of a link against the time step">{"".join(drawn)}</svg>'
    )


def _compute_decades(speeds: Sequence[float]) -> tuple[int, int]:
    """Compute the whole decades that contain the speeds, at least one and at most the eight highest."""
    low, high = math.floor(math.log10(min(speeds))), math.ceil(math.log10(max(speeds)))
    low = max(low, high - 8)
    return low, max(high, low + 1)


def _draw_grid(
    project_step: Callable[[float], float],
    project_speed: Callable[[float], float],
    *,
    steps: Sequence[float],
    decades: tuple[int, int],
) -> str:
    low, high = decades
    parts = []
    every = max(1, math.ceil((high - low) / 5))
    for power in range(low, high + 1, every):
        at = project_speed(10.0**power)
        parts.append(f'<path class="line" d="M{LEFT} {at:.1f}H{RIGHT}"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">{format_number(10.0**power)}</text>')
    for step in (steps[0] * 2.0**k for k in range(round(math.log2(steps[-1] / steps[0])) + 1)):
        at = project_step(step)
        parts.append(f'<path class="line" d="M{at:.1f} {TOP}V{BOTTOM}"/>')
        parts.append(f'<text x="{at:.1f}" y="{BOTTOM + 18}" text-anchor="middle">{1e3 * step:g}</text>')
    middle = (LEFT + RIGHT) / 2
    parts.append(f'<text x="{middle:.0f}" y="{HEIGHT - 8}" text-anchor="middle">time step, ms</text>')
    across = (TOP + BOTTOM) / 2
    parts.append(
        f'<text x="14" y="{across:.0f}" text-anchor="middle" transform="rotate(-90 14 {across:.0f})">m/s</text>'
    )
    return "".join(parts)
