"""The drop test: what came of it with and without torques, what touches the ground, and speed against time step as a curve."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core.drive_test import DriveTest
from urdfcheck.core.drop_test import SECONDS, STEP, DropTest, ReleaseResult, StabilityCurve
from urdfcheck.output.html.html_text import escape_html, format_number
from urdfcheck.output.html.svg.stability_chart import draw_stability_chart, get_curve_class
from urdfcheck.output.html.tables.html_table import render_table
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


def render_drop_test(drop_test: DropTest) -> str:
    """Render the content of the section."""
    setup = "".join(f"<p>{escape_html(line)}.</p>" for line in describe_drop_setup(drop_test))
    runs = (drop_test.held,) if has_equal_contacts(drop_test) else (drop_test.free, drop_test.held)
    contacts = "".join(
        _render_contacts_table(drop_test, release, len(runs) == 1) for release in runs if release.touching
    )
    return (
        f"<p>Let go for {SECONDS:g} s at a time step of {1e3 * STEP:g} ms in "
        f"{escape_html(drop_test.simulator)}.</p>{setup}{_render_outcomes_table(drop_test)}{contacts}"
        f"{'' if drop_test.drive is None else _render_drive(drop_test.drive)}{_render_stability_figure(drop_test.curves)}"
    )


def _render_outcomes_table(drop_test: DropTest) -> str:
    runs = (drop_test.free, drop_test.held)
    heads = "".join(f'<th scope="col">{format_release_heading(release)}</th>' for release in runs)
    rows = []
    for name, word in OUTCOMES:
        cells = "".join(f"<td>{escape_html(_replace_minus_sign(word(release)))}</td>" for release in runs)
        rows.append(f'<tr><th scope="row">{name}</th>{cells}</tr>')
    return render_table(
        f"Results. {escape_html(describe_reference_scales(drop_test))}", f"<tr><td></td>{heads}</tr>", rows
    )


def _render_contacts_table(drop_test: DropTest, release: ReleaseResult, is_shared: bool) -> str:
    heads = "".join(f'<th scope="col" class="num">{name}</th>' for name in CONTACT_HEAD)
    rows = []
    for touching in release.touching:
        cells = "".join(f'<td class="num">{_replace_minus_sign(cell)}</td>' for cell in format_contact_cells(touching))
        rows.append(f'<tr><th scope="row"><code>{escape_html(touching.link)}</code></th>{cells}</tr>')
    load = sum(t.load for t in release.touching)
    foot = (
        f'<tr><th scope="row">Together, of a weight of {format_number(drop_test.weight)} N</th><td colspan="5"></td>'
        f'<td class="num">{format_number(load)}</td></tr>'
    )
    how = "with and without torques" if is_shared else format_release_heading(release)
    head = f'<tr><th scope="col">Link</th>{heads}</tr>'
    return render_table(f"On the ground at the end, {how}; places in the root link’s frame", head, rows, foot=foot)


def _render_drive(drive: DriveTest) -> str:
    setup = "".join(f"<p>{escape_html(line)}.</p>" for line in describe_drive_setup(drive))
    heads = "".join(f'<th scope="col" class="num">{name}</th>' for name in DRIVE_HEAD)
    rows = []
    for name, *cells in format_drive_rows(drive):
        values = "".join(f'<td class="num">{escape_html(_replace_minus_sign(cell))}</td>' for cell in cells)
        rows.append(f'<tr><th scope="row">{name}</th>{values}</tr>')
    title = DRIVE_TITLE.capitalize()
    runs = render_table(title, f"<tr><td></td>{heads}</tr>", rows)
    heads = "".join(f'<th scope="col" class="num">{name}</th>' for name in WHEEL_HEAD)
    rows = []
    for wheel in drive.wheels:
        values = "".join(f'<td class="num">{_replace_minus_sign(cell)}</td>' for cell in format_wheel_cells(wheel))
        rows.append(f'<tr><th scope="row"><code>{escape_html(wheel.joint)}</code></th>{values}</tr>')
    wheels = render_table("The wheels, all ahead", f'<tr><th scope="col">Joint</th>{heads}</tr>', rows)
    return f"{setup}{runs}{wheels}"


def _replace_minus_sign(text: str) -> str:
    """Replace a hyphen at the beginning of the text by a true minus sign."""
    return f"−{text[1:]}" if text[:1] == "-" and len(text) > 1 else text


def _render_stability_figure(curves: Sequence[StabilityCurve]) -> str:
    if not curves:
        return ""
    legend = "".join(
        '<li><svg class="chart" width="34" height="10" aria-hidden="true" focusable="false">'
        f'<path class="curve {get_curve_class(curve)}" d="M1 5H33"/></svg> {describe_damping_scheme(curve)}: '
        f"largest stable step {escape_html(format_largest_stable_step(curve))}</li>"
        for curve in curves
    )
    return (
        '<figure><div class="scroll" role="group" tabindex="0" aria-label="Speed against time step">'
        f"{draw_stability_chart(curves)}</div>"
        f'<ul class="legend">{legend}</ul><figcaption>The fastest speed of any link within {SECONDS:g} s without '
        f"torques, against the time step; a cross is where the simulation diverged or gained energy.</figcaption></figure>"
        f"<details><summary>The curve as numbers</summary>{''.join(map(_render_curve_table, curves))}</details>"
    )


def _render_curve_table(curve: StabilityCurve) -> str:
    head = '<tr><th scope="col" class="num">Step, ms</th><th scope="col" class="num">Fastest, m/s</th>'
    head += '<th scope="col" class="num">Energy gained, % of weight × size</th><th scope="col">Stable</th></tr>'
    rows = (
        f'<tr><td class="num">{format_number(1e3 * step)}</td><td class="num">{format_peak_speed(speed)}</td>'
        f'<td class="num">{format_number(None if gain is None else 100 * gain, 3)}</td><td>{"yes" if stable else "no"}</td></tr>'
        for step, speed, gain, stable in zip(curve.steps, curve.speeds, curve.gains, curve.stable, strict=True)
    )
    return render_table(describe_damping_scheme(curve), head, rows)
