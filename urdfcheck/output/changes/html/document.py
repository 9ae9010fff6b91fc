"""The whole comparison as one document: the claim, the robot before and after, then the evidence."""

from __future__ import annotations

import json
from collections.abc import Sequence

from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, UNKNOWN, Diff, ModelDiff
from urdfcheck.core.text import format_count
from urdfcheck.output.changes.html.cause_frames import render_causes
from urdfcheck.output.changes.html.change_rows import render_changes
from urdfcheck.output.changes.html.compared_models import ComparedModel, OtherFindings, collect_compared_models
from urdfcheck.output.changes.html.consequence_rows import has_consequences, render_consequences
from urdfcheck.output.changes.html.drawn_changes import build_versions_data
from urdfcheck.output.changes.html.finding_lists import list_rules, render_findings
from urdfcheck.output.changes.html.notes import render_idle_edits, render_notes
from urdfcheck.output.changes.html.repair_steps import describe_steps, render_steps
from urdfcheck.output.changes.html.seam_rows import render_seams
from urdfcheck.output.changes.png import draw_versions
from urdfcheck.output.changes.summary import count_findings, describe_verdict, get_label, list_harm
from urdfcheck.output.changes.text import has_headline
from urdfcheck.output.html.glyphs import SYMBOLS, render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.page_frame import read_asset, read_frame_script, read_style_sheet, render_document_head
from urdfcheck.output.html.sections.appendix import render_rule_pages
from urdfcheck.output.html.sections.key_help import VIEWER_KEYS, render_key_help
from urdfcheck.output.html.sections.model_section import STILL_SIZE, render_still
from urdfcheck.output.html.sections.page_header import render_brand_line, render_verdict
from urdfcheck.output.html.viewer.viewer_page import read_viewer_style, render_viewer, render_viewer_scripts
from urdfcheck.output.shared.escaping import escape_for_html, escape_for_json

KEYS = (
    ("j, k", "next and previous row"),
    *VIEWER_KEYS,
    ("b", "hold: the other version in 3D, before or after"),
    ("Esc", "clear the selection"),
    ("?", "this list"),
)
# Of a verdict: how the claim looks. A change is no defect.
_LOOKS = {UNKNOWN: "unchecked", COSMETIC: "ok", IDENTICAL: "ok"}


def render(diff: Diff) -> str:
    """Render the whole document; equal comparisons give equal bytes."""
    models, others = collect_compared_models(diff)
    drawn = [model for model in models if model.is_drawn]
    title = models[0].title if len(models) == 1 else format_count(len(models), "robot")
    main = (
        _render_missing(diff),
        *(_render_model(diff, model, drawn, is_only=len(models) == 1) for model in models if not model.is_same),
        render_seams(diff),
        _render_others(diff, others),
        _render_same(diff, models),
        render_rule_pages(rules) if (rules := list_rules(diff)) else "",
        _render_about(diff),
    )
    body = escape_for_html(f"""{SYMBOLS}
<a class="skip" href="#content">Skip to the changes</a>
<div class="page">
{_render_header(diff, models, title)}
{render_viewer() if drawn else ""}
<div class="column">
{_render_navigation(diff, models, has_rules=bool(rules))}
<main id="content">
{"".join(main)}
</main>
</div>
</div>
{render_key_help(KEYS)}
""")
    scripts, allowed = _render_scene_scripts(diff, models) if drawn else ("", [])
    own = read_frame_script() + read_asset("changes.js")
    style = read_style_sheet() + read_asset("changes.css") + (read_viewer_style() if drawn else "")
    return f"""{render_document_head(f"{title}: before and after", style, [*allowed, own])}<body>
{body}{scripts}<script>{own}</script>
</body>
</html>
"""


def _render_scene_scripts(diff: Diff, models: Sequence[ComparedModel]) -> tuple[str, list[str]]:
    """Render what draws the robots; return it and the texts of its scripts. ASCII JSON needs no escaping in HTML."""
    data, geometry = build_versions_data(models, diff.steps)
    return render_viewer_scripts(escape_for_json(json.dumps(data, separators=(",", ":"), allow_nan=False)), geometry)


# -- the head ----------------------------------------------------------------------------------------------------------


def _render_header(diff: Diff, models: Sequence[ComparedModel], title: str) -> str:
    seams = [f"{format_count(len(diff.seams), 'change')} around the robot"] if diff.seams else []
    steps = [f"steps: {describe_steps(diff)}"] if diff.steps else []
    harm = "".join(f"<li><b>{escape_html(text)}</b></li>" for text in list_harm(diff))
    facts = [*_count_changes(models), *seams, *steps, count_findings(diff)]
    items = harm + "".join(f"<li>{escape_html(fact)}</li>" for fact in facts)
    return (
        f'<header class="top">{render_brand_line(diff.version)}<h1>{escape_html(title)}</h1>'
        f"{_render_versions(diff.before, diff.after)}"
        f'{render_verdict(_LOOKS.get(diff.verdict, "info"), describe_verdict(diff))}<ul class="facts">{items}</ul></header>'
    )


def _render_versions(before: str, after: str) -> str:
    names = (escape_html(name).replace("/", "/<wbr>") for name in (before, after))
    old, new = (f"<code>{name}</code>" for name in names)
    return f'<p class="path">{old} <span class="to">→</span> {new}</p>'


def _count_changes(models: Sequence[ComparedModel]) -> list[str]:
    """Return how many changes there are of each kind, in the order of the models."""
    counts: dict[str, int] = {}
    for model in models:
        for change in () if model.found is None else model.found.changes:
            counts[get_label(change.category)] = counts.get(get_label(change.category), 0) + 1
    total = format_count(sum(counts.values()), "change")
    return [f"{total}: {', '.join(f'{count} {label}' for label, count in counts.items())}"] if counts else []


def _render_navigation(diff: Diff, models: Sequence[ComparedModel], *, has_rules: bool) -> str:
    """Render links to the sections of the only robot, or to the robots that changed."""
    shown = [model for model in models if not model.is_same]
    links = _list_sections(models[0]) if len(models) == 1 else [(model.id, model.title) for model in shown]
    links = [*((f"{model.id}-steps", "Steps") for model in models if diff.steps), *links]
    links += [("around", "Around the robot")] if diff.seams else []
    links += [("rules", "Rules")] if has_rules else []
    links.append(("about", "About"))
    items = "".join(f'<li><a href="#{anchor}">{escape_html(name)}</a></li>' for anchor, name in links)
    back = '<div class="state" hidden><button type="button" id="back" hidden></button></div>'
    return f'<div class="bar"><nav aria-label="Contents"><ul>{items}</ul></nav>{back}</div>'


def _list_sections(model: ComparedModel) -> list[tuple[str, str]]:
    """Return anchor and name of each section that a model has."""
    found = model.found
    sections: list[tuple[str, str, object]] = [("findings", "Findings", model.new or model.gone)]
    if found is not None:
        sections = [
            ("changes", "Changes", found.changes),
            ("follows", "What follows", has_consequences(found)),
            ("causes", "Causes", found.causes),
            *sections,
            ("notes", "Notes", model.difference.notes),
            ("idle", "Unused edits", model.difference.idle_edits),
        ]
    return [(f"{model.id}-{anchor}", name) for anchor, name, content in sections if content]


# -- the models --------------------------------------------------------------------------------------------------------


def _render_model(diff: Diff, model: ComparedModel, drawn: Sequence[ComparedModel], *, is_only: bool) -> str:
    picture = draw_versions(model.difference, model.before, model.after, *STILL_SIZE) if drawn == [model] else b""
    alternative = (
        f"{model.title} before (orange) and after (green), all joints at zero, from the front, right and above"
    )
    parts = (
        _render_model_head(model, is_only=is_only),
        render_still(picture, alternative),
        render_steps(diff, model),
        render_changes(diff, model),
        render_consequences(model),
        render_causes(diff, model),
        render_findings(diff, model.id, model.new, model.gone),
        render_notes(model),
        render_idle_edits(diff, model),
    )
    return f'<section class="model" id="{model.id}">{"".join(parts)}</section>'


def _render_model_head(model: ComparedModel, *, is_only: bool) -> str:
    difference = model.difference
    matched = (
        f'<p class="facts">matched by {escape_html(difference.matched_by)}</p>'
        if difference.before and difference.after and difference.matched_by in {"name", "structure"}
        else ""
    )
    title = escape_html(model.title)
    if is_only:
        # The header of the page has the rest.
        return f'<div class="head"><h2 class="sr">{title}</h2>{matched}</div>'
    shown = '<button type="button" class="in-3d whole" hidden>Show in 3D</button>' if model.is_drawn else ""
    verdict = render_verdict(_LOOKS.get(difference.verdict, "info"), difference.headline)
    return f'<div class="head"><h2>{title}</h2>{_render_ids(difference)}{verdict}{matched}{shown}</div>'


def _render_ids(difference: ModelDiff) -> str:
    if difference.before == difference.after or not (difference.before and difference.after):
        return f'<p class="path"><code>{escape_html(difference.after or difference.before)}</code></p>'
    return _render_versions(difference.before, difference.after)


def _render_same(diff: Diff, models: Sequence[ComparedModel]) -> str:
    """Render the names of the models that are identical, folded."""
    same = [model for model in models if model.is_same]
    if not same:
        return ""
    if len(models) == 1:
        sentence = f'<p class="clean ok">{render_glyph("ok")} Both versions are equal.</p>'
        return f'<section class="model" id="{same[0].id}">{sentence}{render_steps(diff, same[0])}</section>'
    items = "".join(f"<li><code>{escape_html(model.name)}</code></li>" for model in same)
    count = format_count(len(same), "robot is", "robots are")
    return f'<details class="fold ok"><summary><h3>{count} identical</h3></summary><ul class="plain">{items}</ul></details>'


def _render_others(diff: Diff, others: OtherFindings) -> str:
    """Render the findings of launch files and packages."""
    cards = render_findings(diff, "others", others.new, others.gone)
    return f'<section class="model" id="others"><h2>Launch files and packages</h2>{cards}</section>' if cards else ""


def _render_missing(diff: Diff) -> str:
    """Render what could not be compared, and what of the versions was left out."""
    failures = [failure for failure in diff.failures if not has_headline(diff, failure)]
    if not failures and not diff.notes:
        return ""
    items = "".join(f"<li>{escape_html(text)}</li>" for text in (*failures, *diff.notes))
    kind = "" if failures else " unchecked"
    return f'<section class="failures{kind}"><h2>What was not compared</h2><ul>{items}</ul></section>'


def _render_about(diff: Diff) -> str:
    models = format_count(len(diff.models), "model")
    return (
        f'<section id="about"><h2>How this page was made</h2><p>urdfcheck {escape_html(diff.version)} compared {models}. '
        "It ran nothing of the robot's own code, and this file loads nothing from anywhere.</p></section>"
    )
