"""One model's part of the report: its facts, findings, kinematic tree and tables."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.core.drop_test import Drop
from urdfcheck.core.scene import Scene
from urdfcheck.output.html.consumers import consumers_table
from urdfcheck.output.html.contents import contents_html
from urdfcheck.output.html.drop import drop_html
from urdfcheck.output.html.findings import notes_html, problems_html
from urdfcheck.output.html.svg.launch import launch_html
from urdfcheck.output.html.svg.tree import tree_html
from urdfcheck.output.html.tables import joints_table, meshes_table, physics_table
from urdfcheck.output.html.text import base_name, esc, number
from urdfcheck.output.png import png
from urdfcheck.output.shared.anchors import Card, cards, marks
from urdfcheck.output.shared.wording import plural

MOST_VARIANTS = 6
# Width and height of the picture, in px.
STILL = (960, 640)
PROBLEMS = (Severity.ERROR, Severity.WARNING)
STATUS = {
    "needs-arguments": "Not checked: the model cannot be expanded without arguments.",
    "failed": "Not checked: the model could not be expanded. The findings say why.",
}


@dataclass(frozen=True, slots=True)
class Part:
    """A section of the report: a model, or the findings of a launch file or a package that belong to no model."""

    id: str
    title: str
    path: str
    info: ModelInfo | None
    cards: tuple[Card, ...]
    scene: Scene | None
    counts: Mapping[Severity, int]
    drop: Drop | None = None

    @property
    def file(self) -> str:
        """What tells it from another part of the same title."""
        if self.info is None:
            return self.path
        given = [f"{name}:={value}" for name, value in sorted(self.info.args.items())]
        return " ".join((base_name(self.path), *given))

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


def parts_of(run: Run) -> list[Part]:
    """The models in the run's order, then whatever else has findings; of many variants of a model the first, and those of which
    there is something to tell."""
    first = {info.path: info.id for info in reversed(run.models)}
    variants = Counter(info.path for info in run.models)
    told = {finding.model for finding in run.findings}
    models = [i for i in run.models if variants[i.path] <= MOST_VARIANTS or i.id in told or first[i.path] == i.id]
    groups: dict[str, list[Card]] = {info.id: [] for info in models}
    for card in cards(run.findings):
        groups.setdefault(card.finding.model, []).append(card)
    infos = {info.id: info for info in run.models}
    scenes = {scene.model: scene for scene in run.scenes}
    drops = {drop.model: drop for drop in run.drops}
    parts = []
    for number_, (name, group) in enumerate(groups.items(), 1):
        info = infos.get(name)
        path = info.path if info else name
        title = (info.robot if info else "") or base_name(path) or "This run"
        counts: dict[Severity, int] = {}
        for card in group:
            if card.finding.suppressed is None:
                counts[card.finding.severity] = counts.get(card.finding.severity, 0) + 1
        parts.append(Part(f"m{number_}", title, path, info, tuple(group), scenes.get(name), counts, drops.get(name)))
    return parts


def model_html(run: Run, part: Part, *, alone: bool) -> str:
    """``alone``: no other model is drawn in this report, so that the bar has the way to its sections."""
    head = f'<section class="model" id="{part.id}">{_head(run, part, alone)}{_still(part) if alone else ""}'
    # Beside the drawing where the page is wide, if there is anything to put there.
    beside = " beside" if part.scene is not None and any(part.counts.get(s) for s in PROBLEMS) else ""
    problems = problems_html(run, part.cards, part.path, part.id)
    body = f'<section class="findings{beside}" id="{part.id}-findings">{problems}</section>'
    notes = notes_html(run, part.cards, part.path, part.id)
    last = f'<section class="findings">{notes}</section>' if notes else ""
    return head + body + _scene(run, part) + last + "</section>"


def _head(run: Run, part: Part, alone: bool) -> str:
    lines = contents_html(part.cards, part.path)
    info = part.info
    if info is None:
        path = path_html(part.path) if part.path != part.title and part.path else ""
        return f'<div class="head"><h2>{esc(part.title)}</h2>{path}{lines}</div>'
    facts = [plural(info.links, "link"), plural(info.joints, "joint")]
    facts += [f"{number(info.mass)} kg"] if info.mass is not None else []
    status = f'<p class="status">{STATUS[info.status]}</p>' if info.status in STATUS else ""
    if len(run.models) == 1:
        # The head of the page has said the rest.
        return f'<div class="head"><h2 class="sr">{esc(part.title)}</h2>{status}{lines}</div>'
    told = status or f'<p class="facts">{" · ".join(facts)}</p>'
    way = "" if alone or not part.sections else _way(part)
    return f'<div class="head"><h2>{esc(part.title)}</h2>{path_html(info.path, info.args)}{told}{way}{lines}</div>'


def _still(part: Part) -> str:
    """The robot for a browser without scripts or WebGL; the style hides it from any other."""
    picture = b"" if part.scene is None else png(part.scene, *STILL)
    if not picture:
        return ""
    told = f"{part.title} with all joints at zero, seen from the front, right and above"
    source = base64.b64encode(picture).decode()
    return f'<img class="still" width="{STILL[0]}" height="{STILL[1]}" alt="{esc(told)}" src="data:image/png;base64,{source}">'


def path_html(path: str, args: Mapping[str, str] = MappingProxyType({})) -> str:
    """A file, with the arguments that it was expanded with; it is broken between its folders where it is too long."""
    given = "".join(f" <code>{esc(k)}:={esc(v)}</code>" for k, v in args.items())
    return f'<p class="path"><code>{esc(path).replace("/", "/<wbr>")}</code>{given}</p>'


def _way(part: Part) -> str:
    """The links to its sections, and a button for a page whose 3D view can show one robot of several."""
    items = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections)
    shown = '<button type="button" class="in-3d" hidden>Show in 3D</button>'
    name = part.title if part.info is None else f"{part.title}, {part.info.id}"
    return f'<nav class="way" aria-label="Sections of {esc(name)}"><ul>{items}</ul>{shown}</nav>'


def _scene(run: Run, part: Part) -> str:
    scene = part.scene
    if scene is None:
        return ""
    worst = marks(part.cards, scene.frames)
    programs = consumers_table((card.finding for card in part.cards), run.rules)
    tables: Sequence[str] = [
        "" if part.drop is None else f'<section class="drop" id="{part.id}-drop">{drop_html(part.drop)}</section>',
        f'<section class="consumers" id="{part.id}-consumers"><h3>In each program</h3>{programs}</section>',
        f'<section class="physics" id="{part.id}-physics"><h3>Physics</h3>{physics_table(scene, worst)}</section>',
        f'<section class="meshes" id="{part.id}-meshes"><h3>Meshes and shapes</h3>{meshes_table(scene)}</section>',
        f'<section class="joints" id="{part.id}-joints"><h3>Joints</h3>{joints_table(scene, worst)}</section>'
        if scene.joints
        else "",
        f'<section class="launches" id="{part.id}-launch"><h3>Launch</h3>{launch_html(scene, part.cards)}</section>'
        if scene.launches
        else "",
    ]
    tree = tree_html(scene, worst, f"Kinematic tree of {part.title}")
    return f'<section class="kinematics" id="{part.id}-tree"><h3>Kinematic tree</h3>{tree}</section>{"".join(tables)}'
