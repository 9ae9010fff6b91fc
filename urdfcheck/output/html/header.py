"""The head of the report: what was checked, the verdict, and the way to each model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.output.html.glyphs import ORDER, badges, glyph, words
from urdfcheck.output.html.model import Part
from urdfcheck.output.html.text import esc, number, plural

MOST_FILES = 3
DEPTHS = {"source": "source only", "mesh": "source and meshes", "full": "full"}


def title_of(run: Run) -> str:
    """The robot's name, or how many models there are."""
    if len(run.models) == 1:
        return robot_name(run.models[0])
    return plural(len(run.models), "model")


def robot_name(info: ModelInfo) -> str:
    return info.robot or file_name(info)


def file_name(info: ModelInfo) -> str:
    return info.path.replace("\\", "/").rsplit("/", 1)[-1]


def header_html(run: Run) -> str:
    counts = {severity: run.count(severity) for severity in ORDER}
    kind, verdict = _verdict(run, counts)
    tiles = "".join(
        f'<li class="tile {s}{"" if counts[s] else " none"}">{glyph(s)} <b>{counts[s]}</b> {words(counts[s], s)}</li>'
        for s in ORDER
    )
    return (
        f'<header class="top"><p class="brand">urdfcheck <span>{esc(run.versions.get("urdfcheck", ""))}</span></p>'
        f'<h1>{esc(title_of(run))}</h1><p class="verdict {kind}">{glyph(kind)} {esc(verdict)}</p>'
        f'<ul class="tiles" aria-label="Findings by severity">{tiles}</ul>{_facts(run)}{_filter(counts)}</header>'
    )


def _verdict(run: Run, counts: Mapping[Severity, int]) -> tuple[str, str]:
    unread = sum(info.status != "checked" for info in run.models)
    if run.failures:
        return "error", "Not finished: a part of urdfcheck itself failed, so this verdict is incomplete"
    if not run.models and not run.findings:
        return "warning", "Nothing was checked"
    if counts[Severity.ERROR]:
        return "error", f"{plural(counts[Severity.ERROR], 'error')} to repair"
    if unread:
        return "warning", f"{plural(unread, 'model')} of {len(run.models)} could not be checked"
    if counts[Severity.WARNING]:
        return "warning", f"No errors, {plural(counts[Severity.WARNING], 'warning')} to look at"
    return "ok", "No errors and no warnings"


def _facts(run: Run) -> str:
    paths = list(dict.fromkeys(info.path for info in run.models))
    robots = list(dict.fromkeys(robot_name(info) for info in run.models))
    masses = [info.mass for info in run.models if info.mass is not None]
    facts = []
    if len(run.models) > 1:
        facts.append(("Robots", _names(robots)))
    facts.append(("Files" if len(paths) > 1 else "File", _names(paths)))
    facts.append(("Links", str(sum(info.links for info in run.models))))
    facts.append(("Joints", str(sum(info.joints for info in run.models))))
    if len(run.models) == 1 and masses:
        facts.append(("Mass", f"{number(math.fsum(masses))} kg"))
    facts.append(("Depth", DEPTHS[run.tier]))
    return '<dl class="facts">' + "".join(f"<div><dt>{k}</dt><dd>{v}</dd></div>" for k, v in facts) + "</dl>"


def _names(names: Sequence[str]) -> str:
    shown = ", ".join(f"<code>{esc(name)}</code>" for name in names[:MOST_FILES])
    return shown + (f" and {len(names) - MOST_FILES} more" if len(names) > MOST_FILES else "")


def _filter(counts: Mapping[Severity, int]) -> str:
    """Check boxes that the style acts upon. Hidden where there is no style, because then they would do nothing."""
    present = [s for s in ORDER if counts[s]]
    if len(present) < 2:
        return ""
    boxes = "".join(
        f'<label class="{s}"><input type="checkbox" id="show-{s}" checked> {words(2, s)}</label>' for s in present
    )
    return f'<fieldset class="filter" hidden><legend>Show</legend>{boxes}</fieldset>'


def nav_html(parts: Sequence[Part], has_rules: bool) -> str:
    """A row per model with its counts; the sections of a model only where there is one model."""
    titles = [part.title for part in parts]
    rows = "".join(
        f'<li><a href="#{part.id}"><span class="name">{esc(part.title)}{_file(part, titles)}</span>'
        f'<span class="badges">{badges(part.counts)}</span></a>{_sections(part) if len(parts) == 1 else ""}</li>'
        for part in parts
    )
    rest = [("rules", "Rules behind the findings")] if has_rules else []
    rest += [("skipped", "Skipped checks"), ("checks", "Checks"), ("about", "How it was made")]
    more = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in rest)
    return f'<nav aria-label="Contents"><ul class="models">{rows}</ul><ul>{more}</ul></nav>'


def _file(part: Part, titles: Sequence[str]) -> str:
    """What tells models of one name apart."""
    if part.info is None or titles.count(part.title) == 1:
        return ""
    return f" <small>{esc(file_name(part.info))}</small>"


def _sections(part: Part) -> str:
    items = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections)
    return f"<ul>{items}</ul>"
