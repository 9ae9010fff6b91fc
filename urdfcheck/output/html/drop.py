"""The drop test: what came of it with and without torques, what touches the ground, and speed against time step as a curve."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from urdfcheck.core.drop_test import SECONDS, STEP, DropTest, ReleaseResult, StabilityCurve
from urdfcheck.output.html.tables import render_table
from urdfcheck.output.html.text import escape_html, format_number
from urdfcheck.output.shared.drops import (
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

# Of the drawing, and of what is inside its axes.
WIDTH, HEIGHT = 640, 260
LEFT, RIGHT, TOP, BOTTOM = 64, 620, 16, 212


def render_drop_test(drop_test: DropTest) -> str:
    """The section's content."""
    told = "".join(f"<p>{escape_html(line)}.</p>" for line in describe_drop_setup(drop_test))
    runs = (drop_test.held,) if has_equal_contacts(drop_test) else (drop_test.free, drop_test.held)
    contacts = "".join(
        _render_contacts_table(drop_test, release, len(runs) == 1) for release in runs if release.touching
    )
    return (
        f"<h3>Drop test</h3><p>Let go for {SECONDS:g} s at a time step of {1e3 * STEP:g} ms in {escape_html(drop_test.simulator)}.</p>"
        f"{told}{_render_outcomes_table(drop_test)}{contacts}{_render_stability_figure(drop_test.curves)}"
    )


def _render_outcomes_table(drop_test: DropTest) -> str:
    runs = (drop_test.free, drop_test.held)
    heads = "".join(f'<th scope="col">{format_release_heading(release)}</th>' for release in runs)
    rows = []
    for name, word in OUTCOMES:
        cells = "".join(f"<td>{escape_html(_replace_minus_sign(word(release)))}</td>" for release in runs)
        rows.append(f'<tr><th scope="row">{name}</th>{cells}</tr>')
    return render_table(
        f"What came of it. {escape_html(describe_reference_scales(drop_test))}", f"<tr><td></td>{heads}</tr>", rows
    )


def _render_contacts_table(drop_test: DropTest, release: ReleaseResult, is_shared: bool) -> str:
    heads = "".join(f'<th scope="col" class="num">{name}</th>' for name in CONTACT_HEAD)
    rows = []
    for touching in release.touching:
        cells = "".join(f'<td class="num">{_replace_minus_sign(cell)}</td>' for cell in format_contact_cells(touching))
        rows.append(f'<tr><th scope="row"><code>{escape_html(touching.link)}</code></th>{cells}</tr>')
    load, weight = sum(t.load for t in release.touching), drop_test.mass * 9.81
    foot = (
        f'<tr><th scope="row">Together, of a weight of {format_number(weight)} N</th><td colspan="5"></td>'
        f'<td class="num">{format_number(load)}</td></tr>'
    )
    how = "with and without torques" if is_shared else format_release_heading(release)
    head = f'<tr><th scope="col">Link</th>{heads}</tr>'
    return render_table(f"On the ground at the end, {how}; places in the root link’s frame", head, rows, foot)


def _replace_minus_sign(text: str) -> str:
    """With a true minus sign where the text begins with one."""
    return f"−{text[1:]}" if text[:1] == "-" and len(text) > 1 else text


# -- the curve ---------------------------------------------------------------------------------------------------------


def _render_stability_figure(curves: Sequence[StabilityCurve]) -> str:
    told = "".join(
        f'<li><svg class="chart" width="34" height="10" aria-hidden="true" focusable="false"><path class="curve '
        f'{_get_curve_class(curve)}" d="M1 5H33"/></svg> {describe_damping_scheme(curve)}: largest stable step {escape_html(format_largest_stable_step(curve))}</li>'
        for curve in curves
    )
    return (
        f'<figure><div class="scroll" role="group" tabindex="0" aria-label="Speed against time step">{_draw_stability_chart(curves)}</div>'
        f'<ul class="legend">{told}</ul><figcaption>The fastest speed of any link within {SECONDS:g} s without torques, against '
        f"the time step; a cross is where the simulation burst or gained energy.</figcaption></figure>"
        f"<details><summary>The curve as numbers</summary>{''.join(map(_render_curve_table, curves))}</details>"
    )


def _get_curve_class(curve: StabilityCurve) -> str:
    return "implicit" if curve.implicit else "explicit"


def _draw_stability_chart(curves: Sequence[StabilityCurve]) -> str:
    steps = sorted({step for curve in curves for step in curve.steps})
    known = [v for curve in curves for v in curve.speeds if v is not None and v > 0]
    # Whole decades, and one at least.
    low, high = _compute_decades(known or [1.0])

    def project_step(step: float) -> float:
        return LEFT + (RIGHT - LEFT) * math.log(step / steps[0]) / math.log(steps[-1] / steps[0])

    def project_speed(speed: float) -> float:
        part = (math.log10(max(speed, 10.0**low)) - low) / (high - low)
        return BOTTOM - (BOTTOM - TOP) * min(part, 1.0)

    drawn = [_draw_grid(project_step, project_speed, steps, low, high)]
    for curve in curves:
        points = list(zip(curve.steps, curve.speeds, curve.stable, strict=True))
        line = [
            (project_step(step), project_speed(speed)) for step, speed, stable in points if speed is not None and stable
        ]
        path = " ".join(f"{'L' if i else 'M'}{px:.1f} {py:.1f}" for i, (px, py) in enumerate(line))
        drawn.append(f'<path class="curve {_get_curve_class(curve)}" d="{path}"/>' if line else "")
        for step, speed, stable in points:
            px, py = project_step(step), TOP if speed is None else project_speed(speed)
            mark = (
                f'<circle class="{_get_curve_class(curve)}" cx="{px:.1f}" cy="{py:.1f}" r="3.5"/>'
                if stable
                else f'<path class="bad" d="M{px - 4:.1f} {py - 4:.1f}l8 8m0-8l-8 8"/>'
            )
            told = f"{1e3 * step:.3g} ms: {format_peak_speed(speed)}{'' if speed is None else ' m/s'}"
            drawn.append(f"<g>{mark}<title>{escape_html(told)}</title></g>")
    return (
        f'<svg class="chart" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="Largest speed of a link against the time step">{"".join(drawn)}</svg>'
    )


def _compute_decades(speeds: Sequence[float]) -> tuple[int, int]:
    low, high = math.floor(math.log10(min(speeds))), math.ceil(math.log10(max(speeds)))
    low = max(low, high - 8)  # below there is nothing to see
    return low, max(high, low + 1)


def _draw_grid(
    project_step: Callable[[float], float],
    project_speed: Callable[[float], float],
    steps: Sequence[float],
    low: int,
    high: int,
) -> str:
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


def _render_curve_table(curve: StabilityCurve) -> str:
    head = '<tr><th scope="col" class="num">Step, ms</th><th scope="col" class="num">Fastest, m/s</th>'
    head += '<th scope="col" class="num">Energy gained, % of weight × size</th><th scope="col">Stable</th></tr>'
    rows = (
        f'<tr><td class="num">{format_number(1e3 * step)}</td><td class="num">{format_peak_speed(speed)}</td>'
        f'<td class="num">{format_number(None if gain is None else 100 * gain, 3)}</td><td>{"yes" if stable else "no"}</td></tr>'
        for step, speed, gain, stable in zip(curve.steps, curve.speeds, curve.gains, curve.stable, strict=True)
    )
    return render_table(describe_damping_scheme(curve), head, rows)
