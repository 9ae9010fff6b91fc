"""One model's part of the report: its facts, findings, kinematic tree and tables."""

from __future__ import annotations

import base64

from urdfcheck.core import Finding, ModelInfo, Run, Severity
from urdfcheck.core.scene import Scene
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html, format_number, render_path, render_prose
from urdfcheck.output.html.program_outcomes import mark_programs
from urdfcheck.output.html.report_parts import ReportPart
from urdfcheck.output.html.sections.drop_test_section import render_drop_test
from urdfcheck.output.html.sections.finding_groups import render_notes, render_problems
from urdfcheck.output.html.sections.launch_section import render_launch_files
from urdfcheck.output.html.sections.page_header import render_command
from urdfcheck.output.html.sections.program_strip import render_program_strip
from urdfcheck.output.html.sections.tree_section import render_tree
from urdfcheck.output.html.tables.consumers_table import render_consumers_table
from urdfcheck.output.html.tables.joints_table import render_joints_table
from urdfcheck.output.html.tables.meshes_table import render_meshes_table
from urdfcheck.output.html.tables.physics_table import render_physics_table
from urdfcheck.output.shared.anchors import compute_severity_marks
from urdfcheck.output.shared.robot_picture import render_scene
from urdfcheck.output.shared.verdict.not_checked import build_command, explain_unchecked, is_accepted
from urdfcheck.output.shared.wording import describe_found_arguments, format_count

# Width and height of the picture, in px.
STILL_SIZE = (960, 640)
PROBLEMS = (Severity.ERROR, Severity.WARNING)


def render_model(run: Run, part: ReportPart, *, is_only_model: bool) -> str:
    """Render a part of the report. ``is_only_model``: no other model is drawn, so that the toolbar links to its sections."""
    image = _render_still_image(part) if is_only_model else ""
    head = f'<section class="model" id="{part.id}">{_render_model_head(run, part, is_only_model)}'
    problems = render_problems(
        run,
        part.cards,
        model_file=part.path,
        is_checked=part.is_checked,
        is_lost=_is_lost(run, part),
        set_aside=part.set_aside,
    )
    if not any(c.finding.suppressed is None and c.finding.severity in PROBLEMS for c in part.cards) and part.shared:
        problems = ""  # not the sentence that there is none
    notes = render_notes(run, part.cards, model_file=part.path, id_prefix=part.id)
    body = f'<section class="findings" id="{part.id}-findings">{problems}{_render_shared(part)}{notes}</section>'
    return f"{head}{body}{image}{_render_scene_sections(run, part)}</section>"


def render_part_strip(run: Run, part: ReportPart) -> str:
    """Render what each program does with the model of a part; nothing for a part that is not drawn and has no table of it."""
    if part.scene is None:
        return ""
    known, listed = _list_known_findings(run, part), [card.finding for card in part.all_cards]
    return render_program_strip(known, run.rules, part=part.id, listed=listed)


def _is_lost(run: Run, part: ReportPart) -> bool:
    """Whether a program loses the model or a part of it, so that no tick may say that there is nothing to report."""
    return part.scene is not None and any(
        mark.kind == "error" for mark in mark_programs(_list_known_findings(run, part), run.rules)
    )


def _render_model_head(run: Run, part: ReportPart, is_only_model: bool) -> str:
    title = escape_html(part.title)
    info = part.info
    if info is None:
        path = render_path(part.path) if part.path != part.title and part.path else ""
        return f'<div class="head"><h2>{title}</h2>{path}</div>'
    facts = [format_count(info.links, "link"), format_count(info.joints, "joint")]
    facts += [f"{format_number(info.mass)} kg"] if info.mass is not None else []
    told = describe_found_arguments(info)
    found = f'<p class="facts">{escape_html(told[:1].upper() + told[1:])}</p>' if told else ""
    if len(run.models) == 1:
        # The header of the page has the rest.
        return f'<div class="head"><h2 class="sr">{title}</h2>{found}</div>'
    status = "" if part.is_checked else _render_status(info)
    state = status or f'<p class="facts">{" · ".join(facts)}</p>'
    links = "" if is_only_model or not part.sections else _render_section_links(part)
    path = render_path(info.path, info.args)
    return f'<div class="head"><h2>{title}</h2>{path}{state}{render_part_strip(run, part)}{found}{links}</div>'


def _render_shared(part: ReportPart) -> str:
    """Render links to the findings that this model shares with another, where their cards are."""
    items = "".join(
        f'<li><a href="#{card.anchors[0]}">{render_glyph(card.finding.severity)} {escape_html(card.finding.code)} '
        f"{escape_html(card.finding.name)}</a> <code>{escape_html(', '.join(card.finding.subjects[:1]))}</code></li>"
        for card in part.shared
        if card.finding.suppressed is None
    )
    return f'<h4>Shared with other models, listed there</h4><ul class="subjects">{items}</ul>' if items else ""


def _render_status(info: ModelInfo) -> str:
    """Render why a model was not checked, and the command that may check it."""
    command = build_command(info)
    accepted = " (accepted)" if is_accepted(info) else ""
    reason = render_prose(explain_unchecked(info))
    return f'<p class="status">{render_glyph("unchecked")} Not checked{accepted}: {reason}</p>{render_command(command)}'


def _render_still_image(part: ReportPart) -> str:
    """Render a picture of the robot for browsers without scripts or WebGL; the style hides it from others."""
    width, height = STILL_SIZE
    picture = b"" if part.scene is None else render_scene(part.scene, width, height)
    return render_still(picture, f"{part.title} with all joints at zero, seen from the front, right and above")


def render_still(picture: bytes, description: str) -> str:
    """Render a PNG of `STILL_SIZE` for browsers without 3D; nothing without one."""
    if not picture:
        return ""
    width, height = STILL_SIZE
    source = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
    return f'<img class="still" width="{width}" height="{height}" alt="{escape_html(description)}" src="{source}">'


def _render_section_links(part: ReportPart) -> str:
    """Render links to the sections of a part, and a button for a page whose 3D view can show one of several robots."""
    items = "".join(f'<li><a href="#{anchor}">{name}</a></li>' for anchor, name in part.sections)
    shown = '<button type="button" class="in-3d" hidden>Show in 3D</button>'
    name = part.title if part.info is None else f"{part.title}, {part.info.id}"
    return f'<nav class="way" aria-label="Sections of {escape_html(name)}"><ul>{items}</ul>{shown}</nav>'


def _list_known_findings(run: Run, part: ReportPart) -> list[Finding]:
    """Return the findings of a part, and the notes that nobody asked for: programs do not load a model because a note is left
    out."""
    model = "" if part.info is None else part.info.id
    return [*(card.finding for card in part.all_cards), *(f for f in run.unrequested if model in f.subjects_by_model)]


def _render_scene_sections(run: Run, part: ReportPart) -> str:
    scene = part.scene
    if scene is None:
        return ""

    def render_section(css_class: str, anchor: str, title: str, content: str, note: str = "") -> str:
        # A browser opens a fold whose content is the target of a link, but not a fold that is itself the target.
        return (
            f'<details class="section {css_class}"><summary><h3>{title}</h3> <small>{note}</small></summary>'
            f'<div id="{part.id}-{anchor}">{content}</div></details>'
        )

    marks = compute_severity_marks(part.all_cards, scene.frames)
    tree = render_tree(scene, marks, f"Kinematic tree of {part.title}")
    programs = render_consumers_table(_list_known_findings(run, part), run.rules)
    links, joints = format_count(len(scene.links), "link"), format_count(len(scene.joints), "joint")
    sections = [
        render_section("consumers", "consumers", "In each program", programs),
        render_section("kinematics", "tree", "Kinematic tree", tree, links),
        render_section("physics", "physics", "Physics", render_physics_table(scene, marks), links),
        render_section("meshes", "meshes", "Meshes and shapes", render_meshes_table(scene), _count_shapes(scene)),
    ]
    if scene.joints:
        sections.append(render_section("joints", "joints", "Joints", render_joints_table(scene, marks), joints))
    if part.drop is not None:
        sections.append(render_section("drop", "drop", "Drop test", render_drop_test(part.drop)))
    if scene.launches:
        launches = render_launch_files(scene, part.cards)
        files = format_count(len(scene.launches), "launch file")
        sections.append(render_section("launches", "launch", "Launch", launches, files))
    return f'<div class="sections">{"".join(sections)}</div>'


def _count_shapes(scene: Scene) -> str:
    shapes = sum(shape.file is None for link in scene.links for shape in link.shapes)
    counts = ((len(scene.meshes), "mesh file"), (shapes, "other shape"))
    return ", ".join(format_count(count, word) for count, word in counts if count)
