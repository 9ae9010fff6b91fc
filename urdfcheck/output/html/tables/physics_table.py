"""What each link weighs, as a table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from urdfcheck.core.scene import Scene, SceneInertia, SceneLink
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import (
    NO_VALUE,
    format_millimetres,
    format_number,
    format_scaled,
    format_whole_number,
)
from urdfcheck.output.html.tables.html_table import render_name_cell, render_number_cell, render_table
from urdfcheck.output.html.tables.joints_table import list_clamped_joints
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark

# Ratio to the uniform solid's principal moment from which on a moment is far off: e^1.6, the limit of INR009.
FAR_RATIO = 5.0


def render_physics_table(scene: Scene, marks: Mapping[ElementKey, SeverityMark]) -> str:
    """Render the inertial of each link, compared with its drawn geometry filled uniformly with the same mass."""
    head = (
        '<tr><th scope="col" rowspan="2">Link</th><th scope="col" rowspan="2" class="num">Mass<br><small>kg</small></th>'
        '<th scope="colgroup" colspan="4">Moments ÷ solid’s</th>'
        '<th scope="col" rowspan="2" class="num">COMs apart<br><small>mm</small></th>'
        '<th scope="col" rowspan="2" class="num">Density<br><small>kg/m³</small></th>'
        '<th scope="colgroup" colspan="3">Centre of mass <small>mm, link frame</small></th>'
        '<th scope="colgroup" colspan="4">Principal moments <small>kg·m²</small></th></tr><tr>'
        + "".join(f'<th scope="col" class="num">{name}</th>' for name in ("I₁", "I₂", "I₃"))
        + '<th scope="col"><span class="sr">verdict</span></th>'
        + "".join(f'<th scope="col" class="num">{name}</th>' for name in ("x", "y", "z", "I₁", "I₂", "I₃"))
        + '<th scope="col" class="power"><span class="sr">power of ten</span></th></tr>'
    )
    rows = (_render_physics_row(link, marks.get(("link", link.name))) for link in scene.links)
    solid = (
        "<p>The solid of a link is its drawn geometry, filled uniformly with its mass. "
        f'<span class="marks warning">{render_glyph("warning")}</span> marks moments that differ from those of the solid '
        "by a factor of five or more.</p>"
    )
    foot = _render_total_row(scene)
    return solid + render_table(
        "What the file says, and how far it is from the solid", head, rows, foot=foot, is_sortable=True
    )


def _render_physics_row(link: SceneLink, mark: SeverityMark | None) -> str:
    inertial = link.inertial
    if inertial is None:
        return f'<tr>{render_name_cell(("link", link.name), mark)}<td class="none" colspan="14">no inertial</td></tr>'
    com = [NO_VALUE] * 3 if not inertial.com else [format_millimetres(v) for v in inertial.com]
    moments, power = ([NO_VALUE] * 3, "") if not inertial.moments else format_scaled(inertial.moments)
    density = NO_VALUE if link.density is None else _format_density(link.density)
    ratios = _compute_moment_ratios(inertial.moments, link.drawn_moments)
    far = any(not 1 / FAR_RATIO < ratio < FAR_RATIO for ratio in ratios)
    verdict = (
        f'<td class="warning">{render_glyph("warning")}<span class="sr"> far off</span></td>' if far else "<td></td>"
    )
    ratio_texts = [format_number(ratio, 3) for ratio in ratios] or [NO_VALUE] * 3
    has_both_coms = inertial.com and link.drawn_com
    distance = format_millimetres(math.dist(inertial.com, link.drawn_com)) if has_both_coms else NO_VALUE
    typed = [
        render_number_cell(moment, value)
        for moment, value in zip(moments, inertial.moments or (None,) * 3, strict=True)
    ]
    cells = (
        render_number_cell(format_number(inertial.mass)),
        *map(render_number_cell, ratio_texts),
        verdict,
        render_number_cell(distance),
        render_number_cell(density),
        *map(render_number_cell, com),
        *typed,
        f'<td class="power">{power}</td>',
    )
    return f"<tr>{render_name_cell(('link', link.name), mark)}{''.join(cells)}</tr>"


def _compute_moment_ratios(moments: Sequence[float], drawn_moments: Sequence[float]) -> list[float]:
    """Compute the ratio of each principal moment to the uniform solid's, smallest to smallest; none if one is not positive."""
    if not moments or not drawn_moments or not all(d > 0 for d in drawn_moments):
        return []
    return [m / d for m, d in zip(moments, drawn_moments, strict=True)]


def _render_total_row(scene: Scene) -> str:
    """Render the mass of all links and, if each of them has a pose, their COM in the pose in which the robot is drawn."""
    bodies = [link for link in scene.links if link.inertial is not None and link.inertial.mass is not None]
    if not bodies:
        return ""
    placed = [_locate_base_com(link) for link in bodies]
    total = math.fsum(mass for mass, _ in placed)
    com = [NO_VALUE] * 3
    if total > 0 and all(place for _, place in placed):
        com = [format_millimetres(math.fsum(mass * place[i] for mass, place in placed) / total) for i in range(3)]
    return (
        f'<tr><th scope="row">All together<br><small>base frame, {_describe_pose(scene)}</small></th>'
        f'{render_number_cell(format_number(total))}<td colspan="6"></td>{"".join(map(render_number_cell, com))}'
        '<td colspan="4"></td></tr>'
    )


def _describe_pose(scene: Scene) -> str:
    """Describe the pose in which the robot is drawn."""
    if not any(link.start for link in scene.links):
        return "joints at zero"
    clamped = ", or at the limit next to it" if list_clamped_joints(scene) else ""
    return f"as drawn: joints at zero{clamped}{', followers where &lt;mimic&gt; puts them' if _has_followers(scene) else ''}"


def _has_followers(scene: Scene) -> bool:
    return any(joint.mimic is not None for joint in scene.joints)


def _locate_base_com(link: SceneLink) -> tuple[float, tuple[float, ...]]:
    """Return the mass (kg) and the COM (m) in the base frame; no COM without a pose."""
    inertial = link.inertial or SceneInertia()
    pose = link.start or link.world
    if not pose or not inertial.com:
        return inertial.mass or 0.0, ()
    rows = (pose[0:4], pose[4:8], pose[8:12])
    return inertial.mass or 0.0, tuple(
        math.fsum(a * b for a, b in zip(row, (*inertial.com, 1.0), strict=True)) for row in rows
    )


def _format_density(value: float) -> str:
    return format_whole_number(float(f"{value:.3g}")) if 100 <= value < 1e6 else format_number(value, 3)
