"""The findings of one model, a card each: errors and warnings, and apart from them information."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from urdfcheck.core import Confidence, Finding, Fix, Location, Run, Severity, Span
from urdfcheck.output.html.code import code_frame, diff
from urdfcheck.output.html.glyphs import glyph, words
from urdfcheck.output.html.groups import FileGroup, active, by_file
from urdfcheck.output.html.text import base_name, esc, prose
from urdfcheck.output.shared.anchors import Card, element, names_it
from urdfcheck.output.shared.wording import NAMES, by_effect, place, plural

MOST_SUBJECTS = 6
MOST_EDITS = 4
MOST_FRAMES = 8
MOST_NOTES = 5
# So many errors and warnings of a model are shown open; of more, the errors only.
MOST_OPEN = 12
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
    groups = [(severity, active(cards, severity)) for severity in (Severity.ERROR, Severity.WARNING)]
    few = sum(len(group) for _, group in groups) <= MOST_OPEN
    for severity, group in groups:
        if group:
            is_open = few or severity == Severity.ERROR
            parts.append(_group(severity, prefix, len(group), _by_file(run, group, own, is_open)))
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
    told = f'<span class="count">{count}</span> {words(count, severity)}'
    head = f'<h3 id="{prefix}-{severity}">{glyph(severity)} <span>{told}</span></h3>'
    return f'<section class="group {severity}">{head}{body}</section>'


def _by_file(run: Run, cards: Sequence[Card], own: str, is_open: bool = False) -> str:
    groups = by_file(cards, own)
    is_plain = len(groups) == 1 and groups[0].file in ("", own)
    return "\n".join(
        f'<div class="of-file">{"" if is_plain else _file_head(group)}{_cards(run, group, is_open)}</div>'
        for group in groups
    )


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


def _cards(run: Run, group: FileGroup, is_open: bool = False) -> str:
    return f'<div class="cards">{"".join(_card(run, card, is_open) for card in group.cards)}</div>'


def _card(run: Run, card: Card, is_open: bool) -> str:
    finding = card.finding
    body = (
        f"{_variants(run, finding)}{_subjects(card)}{_chain(run, card)}{_explanation(finding)}"
        f"{'' if finding.fix is None else _fix(run, finding.fix)}{_related(run, finding.related)}{_foot(card)}"
    )
    span = finding.location.span
    name = "Details" if span is None else _place(span)
    known, reason = "", ""
    if finding.suppressed is not None:
        known, reason = " known", f'<p class="reason">Known, {esc(str(finding.suppressed))}</p>'
    file = "" if span is None else esc(span.file)
    return (
        f'<article class="card {finding.severity}{known}" id="{card.ids[0]}" tabindex="-1" data-code="{esc(finding.code)}" '
        f'data-confidence="{finding.confidence}" data-file="{file}">{_head(run, card)}'
        f'<p class="message">{prose(finding.message)}</p>{reason}'
        f'<details class="more"{" open" if is_open else ""}><summary>{name}</summary>{body}</details></article>'
    )


def _head(run: Run, card: Card) -> str:
    finding = card.finding
    code = f'<span class="rule-code">{esc(finding.code)}</span> {esc(finding.name)}'
    if finding.code in run.rules:
        code = f'<a href="#rule-{esc(finding.code)}">{code}</a>'
    shown = '<button type="button" class="in-3d" hidden>Show in 3D</button>' if _elements(finding) else ""
    return (
        f'<header><h4>{glyph(finding.severity)} <span class="severity">{finding.severity}</span> {code}</h4>{shown}'
        f'<a class="permalink" href="#{card.ids[0]}"><span aria-hidden="true">#</span>'
        f'<span class="sr">link to this finding: {esc(finding.code)} {esc(finding.location.subject)}</span></a></header>'
    )


def _elements(finding: Finding) -> bool:
    """Whether it is about a link or a joint."""
    return any(element(subject) is not None for subject in finding.subjects)


def _variants(run: Run, finding: Finding) -> str:
    """With which arguments a finding is there, where not all variants of the model have it."""
    given = " ".join(f"<code>{esc(n)}:={esc(v)}</code>" for n, v in sorted(run.arguments_of(finding).items()))
    others = len(finding.variants) - 1
    also = f"in {plural(others, 'other variant')}" if others > 0 else ""
    said = f"With {given}{', and ' if also else ''}{also}" if given else f"Also {also}" if also else ""
    return f'<p class="variants">{said}.</p>' if said else ""


def _subjects(card: Card) -> str:
    # Every subject has a fingerprint of its own, so each one is an anchor; that of the first is the card.
    anchors = ["", *(f' id="{i}"' for i in card.ids[1:])]
    items = [
        f"<li{names_it(element(subject))}{anchor}><code>{esc(subject)}</code></li>"
        for subject, anchor in zip(card.finding.subjects, anchors, strict=False)
    ]
    if len(items) <= MOST_SUBJECTS:
        return f'<ul class="subjects">{"".join(items)}</ul>'
    head, rest = "".join(items[:MOST_SUBJECTS]), "".join(items[MOST_SUBJECTS:])
    return (
        f'<ul class="subjects">{head}</ul><details><summary>{len(items) - MOST_SUBJECTS} more places '
        f'made by the same text</summary><ul class="subjects">{rest}</ul></details>'
    )


def _source(run: Run, span: Span | None) -> str:
    if span is None:
        return ""
    shown = code_frame(run.sources, span, 0)
    return f'<figure class="frame"><figcaption>{_place(span)}</figcaption>{shown}</figure>'


def _chain(run: Run, card: Card) -> str:
    """Where the text stands; where macros or includes brought it there, all calls from the outermost on, linked both ways."""
    span, via = card.finding.location.span, card.finding.location.via
    if span is None:
        return ""
    if not via:
        # The line above it says where it is.
        shown = code_frame(run.sources, span)
        return f'<figure class="frame">{shown}</figure>' if shown else ""
    steps = [*via, span]
    last = len(steps) - 1
    ids = [f"{card.ids[0]}-at{number}" for number in range(len(steps))]
    items = []
    for i, step in enumerate(steps):
        before = f'<a href="#{ids[i - 1]}">called at {_line_of(steps[i - 1])}</a>' if i else ""
        after = f'<a href="#{ids[i + 1]}">brings in {_line_of(steps[i + 1])}</a>' if i < last else ""
        is_quoted = i < MOST_FRAMES // 2 or i > last - MOST_FRAMES // 2
        shown = code_frame(run.sources, step, 2 if i == last else 0) if is_quoted else ""
        items.append(
            f'<li id="{ids[i]}"><figure class="frame"><figcaption>{_place(step)}'
            f'<span class="steps">{before}{after}</span></figcaption>{shown}</figure></li>'
        )
    calls = "a macro call or include" if len(via) == 1 else f"{len(via)} macro calls or includes"
    return f'<div class="via"><h5>Brought here by {calls}</h5><ol class="chain">{"".join(items)}</ol></div>'


def _place(span: Span) -> str:
    """Where there is little room, the style leaves the folder out."""
    name = base_name(span.file)
    folder = span.file[: len(span.file) - len(name)]
    shown = f'<span class="folder">{esc(folder)}</span>' if folder else ""
    return f'<code title="{esc(place(span))}">{shown}{esc(place(span)[len(folder) :])}</code>'


def _line_of(span: Span) -> str:
    return f"<code>{esc(base_name(span.file))}:{span.line}</code>"


def _related(run: Run, related: Sequence[Location]) -> str:
    if not related:
        return ""
    items = "".join(f"<li><code>{esc(r.subject)}</code>{_source(run, r.span)}</li>" for r in related[:MOST_FRAMES])
    items += "".join(
        f"<li><code>{esc(r.subject)}</code>" + (f" <code>{esc(place(r.span))}</code></li>" if r.span else "</li>")
        for r in related[MOST_FRAMES:]
    )
    return f'<details class="related"><summary>Related places ({len(related)})</summary><ul>{items}</ul></details>'


def _explanation(finding: Finding) -> str:
    parts = []
    if finding.why is not None:
        parts.append(f'<div class="why"><h5>Why</h5><p>{prose(finding.why)}</p></div>')
    if finding.consequences:
        rows = "".join(
            f"<div><dt>{esc(', '.join(NAMES.get(c, c) for c in consumers))}</dt><dd>{prose(effect)}</dd></div>"
            for effect, consumers in by_effect(finding.consequences).items()
        )
        parts.append(f'<div class="then"><h5>What follows</h5><dl>{rows}</dl></div>')
    hidden = finding.data.get("hides", ())
    if hidden:
        parts.append(f'<p class="hides">Set aside on the same element until this is repaired: {_codes(hidden)}</p>')
    return f'<div class="explanation">{"".join(parts)}</div>' if parts else ""


def _codes(codes: Iterable[object]) -> str:
    return ", ".join(f"<code>{esc(str(code))}</code>" for code in codes)


def _fix(run: Run, fix: Fix) -> str:
    how = APPLICABILITY[str(fix.applicability)]
    edits = copied = ""
    if fix.edits:
        edits = diff(run.sources, fix.edits)
        copied = '<button type="button" class="act copy-diff" hidden>Copy diff</button>'
    if len(fix.edits) > MOST_EDITS:
        edits = f"<details><summary>{plural(len(fix.edits), 'edit')}</summary>{edits}</details>"
    return (
        f'<div class="fix"><div class="fix-head"><h5>Repair <span class="how">{how}</span></h5>{copied}</div>'
        f"<p>{prose(fix.title)}</p>{edits}</div>"
    )


def _foot(card: Card) -> str:
    """Who wants to name the finding elsewhere finds the whole fingerprint in the title and in the card's address."""
    finding = card.finding
    prints = "".join(
        f'<span>fingerprint <data class="print" value="{p}" title="{p}">{p[:SHOWN_DIGITS]}</data></span>'
        for p in finding.fingerprints[:1]
    )
    return (
        f"<footer><span><b>{finding.confidence}</b>: {CONFIDENCE[finding.confidence]}</span> {prints} "
        '<button type="button" class="act copy-link" hidden>Copy link</button></footer>'
    )
