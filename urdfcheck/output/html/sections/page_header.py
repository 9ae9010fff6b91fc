"""The head of the report: what was checked, and the verdict."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import ModelInfo, Run
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html, format_number, render_path, render_prose
from urdfcheck.output.shared.verdict.claim import state_claim
from urdfcheck.output.shared.verdict.not_checked import build_command
from urdfcheck.output.shared.wording import format_count, get_base_name

MOST_NAMES = 3
CHECKED_DEPTHS = {"source": "source only", "mesh": "source, meshes", "full": "source, meshes, dynamics"}


def make_report_title(run: Run) -> str:
    """Make the title: the names of the robots if they fit, else the number of models; without models, the file's name."""
    if not run.models:
        return get_base_name(next(iter(run.unit_ids))) if len(run.unit_ids) == 1 else "No models"
    if len(run.models) > MOST_NAMES:
        return format_count(len(run.models), "model")
    return ", ".join(dict.fromkeys(map(_get_robot_name, run.models)))


def _get_robot_name(info: ModelInfo) -> str:
    return info.robot or get_base_name(info.path)


def render_header(run: Run, title: str, index_file: str = "", *, strip: str = "") -> str:
    """Render the header; ``index_file``: the page with the list of all models, for a page of a folder.

    ``strip``: what each program does with the only model."""
    kind, sentence = state_claim(run)
    index_link = f'<a class="back" href="{escape_html(index_file)}">All models</a>' if index_file else ""
    path = render_path(run.models[0].path, run.models[0].args) if len(run.models) == 1 else ""
    command = build_command(run.models[0]) if len(run.models) == 1 else ""
    return (
        f'<header class="top">{render_brand_line(run.versions.get("urdfcheck", ""), index_link)}'
        f"<h1>{escape_html(title)}</h1>{path}{render_verdict(kind, sentence)}"
        f"{render_command(command)}{strip}{_render_facts(run)}</header>"
    )


def render_brand_line(version: str, index_link: str = "") -> str:
    """Render the name of the program and the buttons, which the page's script reveals: without it they do nothing."""
    buttons = (
        '<button type="button" class="act fold-3d" id="fold" aria-controls="viewer" hidden>Hide 3D</button>'
        '<button type="button" class="act" id="theme" hidden>Theme: auto</button>'
        '<button type="button" class="act" id="help" aria-haspopup="dialog" hidden>Keys</button>'
    )
    return (
        f'<div class="line"><p class="brand">urdfcheck <span>{escape_html(version)}</span></p>'
        f'{index_link}<div class="buttons">{buttons}</div></div>'
    )


def render_verdict(kind: str, sentence: str) -> str:
    """Render the claim of the page; ``kind``: error | warning | info | ok | unchecked."""
    return f'<p class="verdict {kind}">{render_glyph(kind)} <span>{render_prose(sentence)}</span></p>'


def render_command(command: str) -> str:
    """Render a command to copy; empty without one."""
    if not command:
        return ""
    copy = '<button type="button" class="act copy-command" hidden>Copy</button>'
    return f'<p class="command"><code>{escape_html(command)}</code> {copy}</p>'


def _render_facts(run: Run) -> str:
    facts: list[str] = []
    if len(run.models) > MOST_NAMES:
        facts.append(_render_robot_names(list(dict.fromkeys(map(_get_robot_name, run.models)))))
    if len(run.models) == 1 and not run.unchecked_models:
        # A sum over models is meaningless: they are often versions of one robot.
        info = run.models[0]
        facts += [format_count(info.links, "link"), format_count(info.joints, "joint")]
        facts += [f"{format_number(info.mass)} kg"] if info.mass is not None else []
    if not run.models or len(run.unchecked_models) < len(run.models):
        facts.append(f"checked: {CHECKED_DEPTHS[run.tier]}")
    items = "".join(f"<li>{fact}</li>" for fact in (*facts, *_list_files(run)))
    return f'<ul class="facts">{items}</ul>' if items else ""


def _render_robot_names(names: Sequence[str]) -> str:
    shown = ", ".join(f"<code>{escape_html(name)}</code>" for name in names[:MOST_NAMES])
    return shown + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")


def _list_files(run: Run) -> list[str]:
    """List the models and all other files with findings, below the folder that they share; nothing for a single model."""
    spans = (finding.location.span for finding in run.findings)
    paths = list(dict.fromkeys([*(info.path for info in run.models), *(span.file for span in spans if span)]))
    if not paths or (len(paths) < 2 and len(run.models) == 1):
        return []
    if len(paths) == 1:
        return [f"<code>{escape_html(paths[0])}</code>"]
    folder = _find_shared_folder(paths)
    items = "".join(
        f"<li><code>{escape_html(path[len(folder) :].lstrip('/') if folder else path)}</code></li>" for path in paths
    )
    where = f"in <code>{escape_html(folder)}/</code>" if folder else ""
    return [f"<details><summary>{len(paths)} files</summary>{where}<ul>{items}</ul></details>"]


def _find_shared_folder(paths: Sequence[str]) -> str:
    shared = []
    for names in zip(*(path.split("/")[:-1] for path in paths), strict=False):
        if len(set(names)) > 1:
            break
        shared.append(names[0])
    return "/".join(shared)
