"""One model's part of the report: its facts, findings, kinematic tree and tables."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.core.drop_test import DropTest
from urdfcheck.core.scene import Scene
from urdfcheck.output.html.consumers import render_consumers_table
from urdfcheck.output.html.contents import render_contents
from urdfcheck.output.html.drop import render_drop_test
from urdfcheck.output.html.findings import render_notes, render_problems
from urdfcheck.output.html.svg.launch import render_launch_files
from urdfcheck.output.html.svg.tree import render_tree
from urdfcheck.output.html.tables import render_joints_table, render_meshes_table, render_physics_table
from urdfcheck.output.html.text import escape_html, format_number, get_base_name
from urdfcheck.output.png import render_scene
from urdfcheck.output.shared.anchors import FindingCard, build_finding_cards, compute_severity_marks
from urdfcheck.output.shared.wording import format_count

MOST_VARIANTS = 6
# Width and height of the picture, in px.
STILL_SIZE = (960, 640)
PROBLEMS = (Severity.ERROR, Severity.WARNING)
STATUS_TEXTS = {
    "needs-arguments": "Not checked: the model cannot be expanded without arguments.",
    "failed": "Not checked: the model could not be expanded. The findings say why.",
}


@dataclass(frozen=True, slots=True)
class ReportPart:
    """A section of the report: a model, or the findings of a launch file or a package that belong to no model."""

    id: str
    title: str
    path: str
    info: ModelInfo | None
    cards: tuple[FindingCard, ...]
    scene: Scene | None
    counts: Mapping[Severity, int]
    drop: DropTest | None = None

    @property
    def file_label(self) -> str:
        """What tells it from another part of the same title."""
        if self.info is None:
            return self.path
        given = [f"{name}:={value}" for name, value in sorted(self.info.args.items())]
        return " ".join((get_base_name(self.path), *given))

    @property
    def sections(self) -> list[tuple[str, str]]:
        """Anchor and name of each section inside; none where there are only findings."""
        if self.scene is None:
            return []
        found = [(f"{self.id}-findings", "Findings"), (f"{self.id}-tree", "Tree")]
        found += [(f"{self.id}-drop", "Drop test")] if self.drop is not None else []
        found += [(f"{self.id}-consumers", "Programs"), (f"{self.id}-physics", "Physics")]
        found += [(f"{self.id}-meshes", "Meshes")]
        found += [(f"{self.id}-joints", "Joints")] if self.scene.joints else []
        found += [(f"{self.id}-launch", "Launch")] if self.scene.launches else []
        found += [(f"{self.id}-info", "Information")] if self.counts.get(Severity.INFO) else []
        return found


def collect_report_parts(run: Run) -> list[ReportPart]:
    """The models in the run's order, then whatever else has findings; of many variants of a model the first, and those of which
    there is something to tell."""
    first = {info.path: info.id for info in reversed(run.models)}
    variants = Counter(info.path for info in run.models)
    told = {finding.model for finding in run.findings}
    models = [i for i in run.models if variants[i.path] <= MOST_VARIANTS or i.id in told or first[i.path] == i.id]
    groups: dict[str, list[FindingCard]] = {info.id: [] for info in models}
    for card in build_finding_cards(run.findings):
        groups.setdefault(card.finding.model, []).append(card)
    infos = {info.id: info for info in run.models}
    scenes = {scene.model: scene for scene in run.scenes}
    drops = {drop.model: drop for drop in run.drops}
    parts = []
    for number_, (name, group) in enumerate(groups.items(), 1):
        info = infos.get(name)
        path = info.path if info else name
        title = (info.robot if info else "") or get_base_name(path) or "This run"
        counts: dict[Severity, int] = {}
        for card in group:
            if card.finding.suppressed is None:
                counts[card.finding.severity] = counts.get(card.finding.severity, 0) + 1
        parts.append(
            ReportPart(f"m{number_}", title, path, info, tuple(group), scenes.get(name), counts, drops.get(name))
        )
    return parts


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


def render_path(path: str, args: Mapping[str, str] = MappingProxyType({})) -> str:
    """A file, with the arguments that it was expanded with; it is broken between its folders where it is too long."""
    given = "".join(f" <code>{escape_html(k)}:={escape_html(v)}</code>" for k, v in args.items())
    return f'<p class="path"><code>{escape_html(path).replace("/", "/<wbr>")}</code>{given}</p>'


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
