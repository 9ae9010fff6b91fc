"""The findings of one model, a card each: errors and warnings, and apart from them information."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Confidence, Finding, Fix, Location, Run, Severity, Span
from urdfcheck.output.html.anchors import Card
from urdfcheck.output.html.code import code_frame, diff, place
from urdfcheck.output.html.consumers import NAMES
from urdfcheck.output.html.glyphs import glyph, words
from urdfcheck.output.html.groups import FileGroup, active, by_file
from urdfcheck.output.html.text import base_name, esc, plural, prose

MOST_SUBJECTS = 6
MOST_EDITS = 4
MOST_FRAMES = 8
MOST_NOTES = 5
SHOWN_DIGITS = 8

CONFIDENCE = {
    Confidence.PROOF: "follows from the file, whatever the author meant",
    Confidence.STRONG: "a named pattern with very few false alarms",
    Confidence.HEURISTIC: "a hint: judge for yourself",
}
APPLICABILITY = {
    "safe": "safe to apply as shown",
    "unsafe": "review it before it is applied",
    "display": "by hand",
}


def problems_html(run: Run, cards: Sequence[Card], own: str, prefix: str) -> str:
    """Errors and warnings. ``own`` is the model's file; ``prefix`` makes the ids of the groups unique."""
    parts = []
    for severity in (Severity.ERROR, Severity.WARNING):
        if group := active(cards, severity):
            parts.append(_group(severity, prefix, len(group), _by_file(run, group, own)))
    if not parts:
        found = "No errors and no warnings." if active(cards, Severity.INFO) else "No findings."
        parts.append(f'<p class="clean">{glyph("ok")} {found}</p>')
    return "\n".join(parts)


def notes_html(run: Run, cards: Sequence[Card], own: str, prefix: str) -> str:
    """Information, folded by file when there is much of it, and what was suppressed; empty when there is neither."""
    parts = []
    if group := active(cards, Severity.INFO):
        shown = _by_file(run, group, own) if len(group) <= MOST_NOTES else _folded(run, group, own)
        parts.append(_group(Severity.INFO, prefix, len(group), shown))
    suppressed = [c for c in cards if c.finding.suppressed is not None]
    if suppressed:
        parts.append(
            f'<details class="suppressed"><summary>{len(suppressed)} known: {_known(suppressed)}</summary>'
            f"{_by_file(run, suppressed, own)}</details>"
        )
    return "\n".join(parts)


def _known(cards: Sequence[Card]) -> str:
    """Who says of how many of these findings that they are known."""
    kinds = Counter(c.finding.suppressed.kind for c in cards if c.finding.suppressed is not None)
    return ", ".join(f"{kinds[kind]} in the {kind}" for kind in ("source", "configuration", "baseline") if kinds[kind])


def _group(severity: Severity, prefix: str, count: int, body: str) -> str:
    return (
        f'<section class="group {severity}">'
        f'<h3 id="{prefix}-{severity}">{glyph(severity)} {count} {words(count, severity)}</h3>{body}</section>'
    )


def _by_file(run: Run, cards: Sequence[Card], own: str) -> str:
    groups = by_file(cards, own)
    is_plain = len(groups) == 1 and groups[0].file in ("", own)
    return "\n".join(f"{'' if is_plain else _file_head(group)}{_cards(run, group)}" for group in groups)


def _folded(run: Run, cards: Sequence[Card], own: str) -> str:
    return "\n".join(
        f'<details class="fold"><summary>{_file_head(group)} <span class="count">{len(group.cards)}</span></summary>'
        f"{_cards(run, group)}</details>"
        for group in by_file(cards, own)
    )


def _file_head(group: FileGroup) -> str:
    if not group.file:
        return '<h4 class="file">the model as a whole</h4>'
    return f'<h4 class="file">{group.kind} <code>{esc(group.file)}</code></h4>'


def _cards(run: Run, group: FileGroup) -> str:
    return f'<div class="cards">{"".join(_card(run, card) for card in group.cards)}</div>'


def _card(run: Run, card: Card) -> str:
    finding = card.finding
    body = (
        f"{_variants(run, finding)}{_subjects(card)}{_source(run, finding.location.span)}{_via(run, finding.location.via)}"
        f"{_related(run, finding.related)}{_explanation(finding)}"
        f"{'' if finding.fix is None else _fix(run, finding.fix)}{_foot(finding)}"
    )
    if finding.severity == Severity.INFO:
        # Many, and none of them urgent: one line each until it is asked for.
        span = finding.location.span
        name = "Details" if span is None else f"<code>{esc(base_name(place(span)))}</code>"
        body = f'<details class="more"><summary>{name}</summary>{body}</details>'
    reason = "" if finding.suppressed is None else f'<p class="reason">Known, {esc(str(finding.suppressed))}</p>'
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
        f'<h5>{glyph(finding.severity)} <span class="severity">{finding.severity}</span> {code}</h5>'
        f'<a class="permalink" href="#{card.ids[0]}"><span aria-hidden="true">#</span>'
        f'<span class="sr">link to this finding: {esc(finding.code)} {esc(finding.location.subject)}</span></a>'
    )


def _variants(run: Run, finding: Finding) -> str:
    """With which arguments a finding is there, where not all variants of the model have it."""
    given = " ".join(f"<code>{esc(n)}:={esc(v)}</code>" for n, v in sorted(run.arguments_of(finding).items()))
    others = len(finding.variants) - 1
    also = f"in {plural(others, 'other variant')}" if others > 0 else ""
    said = f"With {given}{', and ' if also else ''}{also}" if given else f"Also {also}" if also else ""
    return f'<p class="variants">{said}.</p>' if said else ""


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
    return f'<details class="related"><summary>Related places ({len(related)})</summary><ul>{items}</ul></details>'


def _explanation(finding: Finding) -> str:
    parts = []
    if finding.why is not None:
        parts.append(f'<div class="why"><h6>Why</h6><p>{prose(finding.why)}</p></div>')
    if finding.consequences:
        rows = "".join(
            f"<div><dt>{esc(', '.join(consumers))}</dt><dd>{prose(effect)}</dd></div>"
            for effect, consumers in _by_effect(finding.consequences).items()
        )
        parts.append(f'<div class="then"><h6>What follows</h6><dl>{rows}</dl></div>')
    hidden = finding.data.get("hides", ())
    if hidden:
        parts.append(f'<p class="hides">Set aside on the same element until this is repaired: {_codes(hidden)}</p>')
    return f'<div class="explanation">{"".join(parts)}</div>' if parts else ""


def _by_effect(consequences: Mapping[str, str]) -> dict[str, list[str]]:
    """Consumers that do the same thing share a line."""
    effects: dict[str, list[str]] = {}
    for consumer, effect in consequences.items():
        effects.setdefault(effect, []).append(NAMES.get(consumer, consumer))
    return effects


def _codes(codes: Iterable[object]) -> str:
    return ", ".join(f"<code>{esc(str(code))}</code>" for code in codes)


def _fix(run: Run, fix: Fix) -> str:
    how = APPLICABILITY[str(fix.applicability)]
    edits = diff(run.sources, fix.edits) if fix.edits else ""
    if len(fix.edits) > MOST_EDITS:
        edits = f"<details><summary>{plural(len(fix.edits), 'edit')}</summary>{edits}</details>"
    return f'<div class="fix"><h6>Repair <span class="how">{how}</span></h6><p>{prose(fix.title)}</p>{edits}</div>'


def _foot(finding: Finding) -> str:
    """Who wants to name the finding elsewhere finds the whole fingerprint in the title and in the card's address."""
    prints = "".join(
        f'<span>fingerprint <data class="print" value="{p}" title="{p}">{p[:SHOWN_DIGITS]}</data></span>'
        for p in finding.fingerprints[:1]
    )
    return f"<footer><span><b>{finding.confidence}</b>: {CONFIDENCE[finding.confidence]}</span> {prints}</footer>"
