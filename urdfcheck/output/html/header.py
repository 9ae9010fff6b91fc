"""The head of the report: what was checked, the verdict, and the way to each model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.output.html.glyphs import ORDER, badges, glyph, words
from urdfcheck.output.html.model import Part
from urdfcheck.output.html.text import NONE, base_name, esc, number, plural

MOST_NAMES = 3
MOST_FILES = 5
DEPTHS = {"source": "source only", "mesh": "source and meshes", "full": "full"}


def title_of(run: Run) -> str:
    """The robots' names while they fit, then how many models there are."""
    if not run.models:
        return "No models"
    if len(run.models) > MOST_NAMES:
        return plural(len(run.models), "model")
    return ", ".join(dict.fromkeys(map(_robot_name, run.models)))


def _robot_name(info: ModelInfo) -> str:
    return info.robot or base_name(info.path)


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
    facts: list[tuple[str, str]] = []
    if len(run.models) > MOST_NAMES:
        facts.append(("Robots", _names(list(dict.fromkeys(map(_robot_name, run.models))))))
    if len(run.models) == 1:
        # A sum over models, often two versions of one robot, would mean nothing.
        info = run.models[0]
        facts += [("Links", str(info.links)), ("Joints", str(info.joints))]
        facts += [("Mass", f"{number(info.mass)} kg")] if info.mass is not None else []
    facts += [("Depth", DEPTHS[run.tier]), _files(run)]
    return '<dl class="facts">' + "".join(f"<div><dt>{k}</dt><dd>{v}</dd></div>" for k, v in facts) + "</dl>"


def _names(names: Sequence[str]) -> str:
    shown = ", ".join(f"<code>{esc(name)}</code>" for name in names[:MOST_NAMES])
    return shown + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")


def _files(run: Run) -> tuple[str, str]:
    """The models and every other file with findings, below the folder that they share."""
    spans = (finding.location.span for finding in run.findings)
    paths = list(dict.fromkeys([*(info.path for info in run.models), *(span.file for span in spans if span)]))
    folder = _shared_folder(paths) if len(paths) > 1 else ""
    items = "".join(
        f"<li><code>{esc(path[len(folder) :].lstrip('/') if folder else path)}</code></li>" for path in paths
    )
    listed = f"<ul>{items}</ul>" if paths else NONE
    if len(paths) > MOST_FILES:
        listed = f"<details><summary>{len(paths)} files</summary>{listed}</details>"
    name = "Files" if len(paths) > 1 else "File"
    return f"{name} in <code>{esc(folder)}/</code>" if folder else name, listed


def _shared_folder(paths: Sequence[str]) -> str:
    shared = []
    for names in zip(*(path.split("/")[:-1] for path in paths), strict=False):
        if len(set(names)) > 1:
            break
        shared.append(names[0])
    return "/".join(shared)


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
    """A row per model with its counts; the sections of each only where there are few."""
    titles = [part.title for part in parts]
    rows = "".join(
        f'<li><a href="#{part.id}"><span class="name">{esc(part.title)}{_file(part, titles)}</span>'
        f'<span class="badges">{badges(part.counts)}</span></a>{_sections(part) if len(parts) <= MOST_NAMES else ""}</li>'
        for part in parts
    )
    rest = [("rules", "Rules behind the findings")] if has_rules else []
    rest += [("skipped", "Skipped checks"), ("checks", "Checks"), ("about", "How it was made")]
    more = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in rest)
    return f'<nav aria-label="Contents"><ul class="models">{rows}</ul><ul>{more}</ul></nav>'


def _file(part: Part, titles: Sequence[str]) -> str:
    """What tells parts of one name apart."""
    if titles.count(part.title) == 1:
        return ""
    if part.info is None:
        return f" <small>{esc(part.path)}</small>"
    given = [f"{name}:={value}" for name, value in sorted(part.info.args.items())]
    return f" <small>{esc(' '.join((base_name(part.path), *given)))}</small>"


def _sections(part: Part) -> str:
    items = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections)
    return f"<ul>{items}</ul>" if items else ""
