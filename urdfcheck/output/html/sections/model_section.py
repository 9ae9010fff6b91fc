"""One model's part of the report: its facts, findings, kinematic tree and tables."""

from __future__ import annotations

import base64
from collections.abc import Sequence

from urdfcheck.core import Run, Severity
from urdfcheck.output.html.html_text import escape_html, format_number, render_path
from urdfcheck.output.html.report_parts import ReportPart
from urdfcheck.output.html.sections.drop_test_section import render_drop_test
from urdfcheck.output.html.sections.finding_groups import render_notes, render_problems
from urdfcheck.output.html.sections.findings_contents import render_contents
from urdfcheck.output.html.sections.launch_section import render_launch_files
from urdfcheck.output.html.sections.tree_section import render_tree
from urdfcheck.output.html.tables.consumers_table import render_consumers_table
from urdfcheck.output.html.tables.joints_table import render_joints_table
from urdfcheck.output.html.tables.meshes_table import render_meshes_table
from urdfcheck.output.html.tables.physics_table import render_physics_table
from urdfcheck.output.shared.anchors import compute_severity_marks
from urdfcheck.output.shared.robot_picture import render_scene
from urdfcheck.output.shared.wording import format_count

# Width and height of the picture, in px.
STILL_SIZE = (960, 640)
PROBLEMS = (Severity.ERROR, Severity.WARNING)
STATUS_TEXTS = {
    "needs-arguments": "Not checked: the model cannot be expanded without arguments.",
    "failed": "Not checked: the model could not be expanded. The findings say why.",
}


def render_model(run: Run, part: ReportPart, *, is_only_model: bool) -> str:
    """``alone``: no other model is drawn in this report, so that the bar has the way to its sections."""
    head = f'<section class="model" id="{part.id}">{_render_model_head(run, part, is_only_model)}{_render_still_image(part) if is_only_model else ""}'
    # Beside the drawing where the page is wide, if there is anything to put there.
    beside = " beside" if part.scene is not None and any(part.counts.get(s) for s in PROBLEMS) else ""
    problems = render_problems(run, part.cards, part.path, part.id)
    body = f'<section class="findings{beside}" id="{part.id}-findings">{problems}</section>'
    notes = render_notes(run, part.cards, part.path, part.id)
    last = f'<section class="findings">{notes}</section>' if notes else ""
    return head + body + _render_scene_sections(run, part) + last + "</section>"


def _render_model_head(run: Run, part: ReportPart, is_only_model: bool) -> str:
    lines = render_contents(part.cards, part.path)
    info = part.info
    if info is None:
        path = render_path(part.path) if part.path != part.title and part.path else ""
        return f'<div class="head"><h2>{escape_html(part.title)}</h2>{path}{lines}</div>'
    facts = [format_count(info.links, "link"), format_count(info.joints, "joint")]
    facts += [f"{format_number(info.mass)} kg"] if info.mass is not None else []
    status = f'<p class="status">{STATUS_TEXTS[info.status]}</p>' if info.status in STATUS_TEXTS else ""
    if len(run.models) == 1:
        # The head of the page has said the rest.
        return f'<div class="head"><h2 class="sr">{escape_html(part.title)}</h2>{status}{lines}</div>'
    told = status or f'<p class="facts">{" · ".join(facts)}</p>'
    way = "" if is_only_model or not part.sections else _render_section_links(part)
    return f'<div class="head"><h2>{escape_html(part.title)}</h2>{render_path(info.path, info.args)}{told}{way}{lines}</div>'


def _render_still_image(part: ReportPart) -> str:
    """The robot for a browser without scripts or WebGL; the style hides it from any other."""
    picture = b"" if part.scene is None else render_scene(part.scene, *STILL_SIZE)
    if not picture:
        return ""
    told = f"{part.title} with all joints at zero, seen from the front, right and above"
    source = base64.b64encode(picture).decode()
    return f'<img class="still" width="{STILL_SIZE[0]}" height="{STILL_SIZE[1]}" alt="{escape_html(told)}" src="data:image/png;base64,{source}">'


def _render_section_links(part: ReportPart) -> str:
    """The links to its sections, and a button for a page whose 3D view can show one robot of several."""
    items = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections)
    shown = '<button type="button" class="in-3d" hidden>Show in 3D</button>'
    name = part.title if part.info is None else f"{part.title}, {part.info.id}"
    return f'<nav class="way" aria-label="Sections of {escape_html(name)}"><ul>{items}</ul>{shown}</nav>'


def _render_scene_sections(run: Run, part: ReportPart) -> str:
    scene = part.scene
    if scene is None:
        return ""
    worst = compute_severity_marks(part.cards, scene.frames)
    programs = render_consumers_table((card.finding for card in part.cards), run.rules)
    tables: Sequence[str] = [
        ""
        if part.drop is None
        else f'<section class="drop" id="{part.id}-drop">{render_drop_test(part.drop)}</section>',
        f'<section class="consumers" id="{part.id}-consumers"><h3>In each program</h3>{programs}</section>',
        f'<section class="physics" id="{part.id}-physics"><h3>Physics</h3>{render_physics_table(scene, worst)}</section>',
        f'<section class="meshes" id="{part.id}-meshes"><h3>Meshes and shapes</h3>{render_meshes_table(scene)}</section>',
        f'<section class="joints" id="{part.id}-joints"><h3>Joints</h3>{render_joints_table(scene, worst)}</section>'
        if scene.joints
        else "",
        f'<section class="launches" id="{part.id}-launch"><h3>Launch</h3>{render_launch_files(scene, part.cards)}</section>'
        if scene.launches
        else "",
    ]
    tree = render_tree(scene, worst, f"Kinematic tree of {part.title}")
    return f'<section class="kinematics" id="{part.id}-tree"><h3>Kinematic tree</h3>{tree}</section>{"".join(tables)}'
