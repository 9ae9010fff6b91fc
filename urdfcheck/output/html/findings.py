"""The findings of one model: grouped by severity, then file; one card each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Confidence, Finding, Fix, Location, Run, Severity, Span
from urdfcheck.output.html.anchors import Card
from urdfcheck.output.html.code import code_frame, diff, place
from urdfcheck.output.html.glyphs import ORDER, glyph, words
from urdfcheck.output.html.text import esc, plural, prose

MOST_SUBJECTS = 6
MOST_EDITS = 4
MOST_FRAMES = 8

CONSUMERS = {
    "bullet": "Bullet",
    "drake": "Drake",
    "gazebo": "Gazebo",
    "isaac": "Isaac Sim",
    "kdl": "KDL",
    "moveit": "MoveIt",
    "mujoco": "MuJoCo",
    "pinocchio": "Pinocchio",
    "ros": "ROS",
    "ros2_control": "ros2_control",
    "rviz": "RViz",
    "sdf": "SDFormat",
    "sdformat": "SDFormat",
    "urdfdom": "urdfdom",
    "xacro": "xacro",
}
CONFIDENCE = {
    Confidence.PROOF: "follows from the numbers in the file, whatever the author meant",
    Confidence.STRONG: "a named pattern with very few false alarms",
    Confidence.HEURISTIC: "a hint: judge for yourself",
}
APPLICABILITY = {
    "safe": "safe: --fix applies it",
    "unsafe": "review it before it is applied",
    "display": "by hand",
}


def findings_html(run: Run, cards: Sequence[Card], prefix: str) -> str:
    """The groups of a model's cards; ``prefix`` makes the ids of the groups unique."""
    shown = [c for c in cards if c.finding.suppressed is None]
    suppressed = [c for c in cards if c.finding.suppressed is not None]
    parts = []
    for severity in ORDER:
        group = [c for c in shown if c.finding.severity == severity]
        if group:
            title = f"{len(group)} {words(len(group), severity)}"
            parts.append(
                f'<section class="group {severity}">'
                f'<h3 id="{prefix}-{severity}">{glyph(severity)} {title}</h3>{_by_file(run, group)}</section>'
            )
    if not shown:
        parts.append(f'<p class="clean">{glyph("ok")} No findings.</p>')
    if suppressed:
        parts.append(
            f'<details class="suppressed"><summary>{len(suppressed)} suppressed in the source</summary>'
            f"{_by_file(run, suppressed)}</details>"
        )
    return "\n".join(parts)


def _by_file(run: Run, cards: Sequence[Card]) -> str:
    files: dict[str, list[Card]] = {}
    for card in cards:
        span = card.finding.location.span
        files.setdefault("" if span is None else span.file, []).append(card)
    parts = []
    for file, group in files.items():
        if len(files) > 1:
            name = f"<code>{esc(file)}</code>" if file else "the model as a whole"
            parts.append(f'<p class="file">{name}</p>')
        parts += [_card(run, card) for card in group]
    return "\n".join(parts)


def _card(run: Run, card: Card) -> str:
    finding = card.finding
    body = (
        f"{_subjects(card)}{_source(run, finding.location.span)}{_via(run, finding.location.via)}"
        f"{_related(run, finding.related)}{_explanation(finding)}"
        f"{'' if finding.fix is None else _fix(run, finding.fix)}{_foot(finding)}"
    )
    if finding.severity == Severity.INFO:
        # Many, and none of them urgent: one line each until it is asked for.
        span = finding.location.span
        name = "Details" if span is None else f"<code>{esc(place(span))}</code>"
        body = f'<details class="more"><summary>{name}</summary>{body}</details>'
    reason = "" if finding.suppressed is None else f'<p class="reason">Suppressed: {esc(finding.suppressed)}</p>'
    return (
        f'<article class="card {finding.severity}" id="{card.ids[0]}">{_head(run, card)}'
        f'<p class="message">{prose(finding.message)}</p>{reason}{body}</article>'
    )


def _head(run: Run, card: Card) -> str:
    finding = card.finding
    code = f'<span class="rule-code">{esc(finding.code)}</span> {esc(finding.name)}'
    if finding.code in run.rules:
        code = f'<a href="#rule-{esc(finding.code)}">{code}</a>'
    return (
        f'<h4>{glyph(finding.severity)} <span class="severity">{finding.severity}</span> {code}</h4>'
        f'<a class="permalink" href="#{card.ids[0]}"><span aria-hidden="true">#</span>'
        f'<span class="sr">link to this finding: {esc(finding.code)} {esc(finding.location.subject)}</span></a>'
    )


def _subjects(card: Card) -> str:
    subjects = card.finding.subjects
    items = [f"<li><code>{esc(subjects[0])}</code></li>"] if subjects else []
    # Every subject has a fingerprint of its own, so each one is an anchor.
    items += [f'<li id="{i}"><code>{esc(s)}</code></li>' for s, i in zip(subjects[1:], card.ids[1:], strict=True)]
    if len(items) <= MOST_SUBJECTS:
        return f'<ul class="subjects">{"".join(items)}</ul>'
    head, rest = "".join(items[:MOST_SUBJECTS]), "".join(items[MOST_SUBJECTS:])
    return (
        f'<ul class="subjects">{head}</ul><details><summary>{len(items) - MOST_SUBJECTS} more places '
        f'made by the same text</summary><ul class="subjects">{rest}</ul></details>'
    )


def _source(run: Run, span: Span | None, context: int = 2) -> str:
    if span is None:
        return ""
    shown = code_frame(run.sources, span, context)
    return f'<figure class="frame"><figcaption><code>{esc(place(span))}</code></figcaption>{shown}</figure>'


def _via(run: Run, via: Sequence[Span]) -> str:
    if not via:
        return ""
    items = "".join(f"<li>{_source(run, span, 0)}</li>" for span in via)
    calls = "a macro call or include" if len(via) == 1 else f"{len(via)} macro calls or includes, outermost first"
    return f'<details class="via"><summary>Brought here by {calls}</summary><ol>{items}</ol></details>'


def _related(run: Run, related: Sequence[Location]) -> str:
    if not related:
        return ""
    items = "".join(f"<li><code>{esc(r.subject)}</code>{_source(run, r.span, 0)}</li>" for r in related[:MOST_FRAMES])
    items += "".join(
        f"<li><code>{esc(r.subject)}</code>" + (f" <code>{esc(place(r.span))}</code></li>" if r.span else "</li>")
        for r in related[MOST_FRAMES:]
    )
    return f'<details class="related"><summary>Compare with ({len(related)})</summary><ul>{items}</ul></details>'


def _explanation(finding: Finding) -> str:
    parts = []
    if finding.cause is not None:
        parts.append(f'<div class="why"><h5>Why</h5><p>{prose(finding.cause.text)}</p></div>')
    if finding.consequences:
        rows = "".join(
            f"<div><dt>{esc(', '.join(consumers))}</dt><dd>{prose(effect)}</dd></div>"
            for effect, consumers in _by_effect(finding.consequences).items()
        )
        parts.append(f'<div class="then"><h5>What follows</h5><dl>{rows}</dl></div>')
    hidden = finding.data.get("hides", ())
    if hidden:
        parts.append(f'<p class="hides">Set aside on the same element until this is repaired: {_codes(hidden)}</p>')
    return f'<div class="explanation">{"".join(parts)}</div>' if parts else ""


def _by_effect(consequences: Mapping[str, str]) -> dict[str, list[str]]:
    """Consumers that do the same thing share a line."""
    effects: dict[str, list[str]] = {}
    for consumer, effect in consequences.items():
        effects.setdefault(effect, []).append(CONSUMERS.get(consumer, consumer))
    return effects


def _codes(codes: Iterable[object]) -> str:
    return ", ".join(f"<code>{esc(str(code))}</code>" for code in codes)


def _fix(run: Run, fix: Fix) -> str:
    how = APPLICABILITY[str(fix.applicability)]
    edits = diff(run.sources, fix.edits) if fix.edits else ""
    if len(fix.edits) > MOST_EDITS:
        edits = f"<details><summary>{plural(len(fix.edits), 'edit')}</summary>{edits}</details>"
    return f'<div class="fix"><h5>Repair <span class="how">{how}</span></h5><p>{prose(fix.title)}</p>{edits}</div>'


def _foot(finding: Finding) -> str:
    prints = f'<span class="print">{esc(finding.fingerprints[0])}</span>' if finding.subjects else ""
    return (
        f"<footer><span><b>{finding.confidence}</b>: {CONFIDENCE[finding.confidence]}</span> "
        f"<span>fingerprint {prints}</span></footer>"
    )
