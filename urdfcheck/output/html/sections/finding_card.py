"""One finding as a card."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from urdfcheck.core import Confidence, Finding, Fix, Location, Run, Span
from urdfcheck.output.html.element_names import render_data_attribute
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html, render_prose
from urdfcheck.output.html.sections.code_listing import render_code_frame, render_diff
from urdfcheck.output.shared.anchors import FindingCard, parse_element_key
from urdfcheck.output.shared.verdict.effects import list_effects
from urdfcheck.output.shared.verdict.not_checked import explain_block
from urdfcheck.output.shared.wording import (
    describe_models,
    format_count,
    format_place,
    get_base_name,
)

MOST_SUBJECTS = 6
MOST_EDITS = 4
MOST_FRAMES = 8
SHOWN_DIGITS = 8

CONFIDENCE_TEXTS = {
    Confidence.PROOF: "follows from the file, whatever the author meant",
    Confidence.STRONG: "a named pattern with very few false alarms",
    Confidence.HEURISTIC: "a hint: judge for yourself",
}
APPLICABILITY_TEXTS = {
    "safe": "safe to apply as shown",
    "unsafe": "review it before it is applied",
    "display": "by hand",
}


def render_card(run: Run, card: FindingCard, is_open: bool) -> str:
    """Render a finding; ``is_open``: whether its details are unfolded."""
    finding = card.finding
    details = (
        _render_variants(run, finding),
        _render_subjects(card),
        _render_call_chain(run, card),
        _render_explanation(run, finding),
        "" if finding.fix is None else _render_fix(run, finding.fix),
        _render_related(run, finding.related),
        _render_card_footer(card),
    )
    span = finding.location.span
    summary = "Details" if span is None else _render_place(span)
    file = "" if span is None else escape_html(span.file)
    css_class, reason = f"card {finding.severity}", ""
    if finding.suppressed is not None:
        css_class += " known"
        reason = f'<p class="reason">Known, {escape_html(str(finding.suppressed))}</p>'
    return (
        f'<article class="{css_class}" id="{card.anchors[0]}" tabindex="-1" data-code="{escape_html(finding.code)}" '
        f'data-confidence="{finding.confidence}" data-file="{file}">{_render_card_header(run, card)}'
        f'<p class="headline">{escape_html(finding.headline)}</p><p class="message">{render_prose(finding.message)}</p>{reason}'
        f'<details class="more"{" open" if is_open else ""}><summary>{summary}</summary>{"".join(details)}</details></article>'
    )


def _render_card_header(run: Run, card: FindingCard) -> str:
    finding = card.finding
    code = escape_html(finding.code)
    rule = f'<span class="rule-code">{code}</span> {escape_html(finding.name)}'
    if finding.code in run.rules:
        rule = f'<a href="#rule-{code}">{rule}</a>'
    button = '<button type="button" class="in-3d" hidden>Show in 3D</button>' if _has_element(finding) else ""
    return (
        f'<header><h4>{render_glyph(finding.severity)} <span class="severity">{finding.severity}</span> {rule}</h4>{button}'
        f'<a class="permalink" href="#{card.anchors[0]}"><span aria-hidden="true">#</span>'
        f'<span class="sr">link to this finding: {code} {escape_html(finding.location.subject)}</span></a></header>'
    )


def _has_element(finding: Finding) -> bool:
    """Whether a finding is about a link or a joint."""
    return any(parse_element_key(subject) is not None for subject in finding.subjects)


def _render_variants(run: Run, finding: Finding) -> str:
    """Render the models that share a finding, and the arguments with which it appears if not all variants have it."""
    arguments = " ".join(
        f"<code>{escape_html(n)}:={escape_html(v)}</code>"
        for n, v in sorted(run.find_variant_arguments(finding).items())
    )
    if models := describe_models(run, finding):
        with_ = f" with {arguments}" if arguments else ""
        return f'<p class="variants">In {escape_html(models)}{with_}.</p>'
    others = len(finding.variants) - 1
    also = f"in {format_count(others, 'other variant')}" if others > 0 else ""
    sentence = f"With {arguments}{', and ' if also else ''}{also}" if arguments else f"Also {also}" if also else ""
    return f'<p class="variants">{sentence}.</p>' if sentence else ""


def _render_subjects(card: FindingCard) -> str:
    # Every subject has its own fingerprint and anchor; the anchor of the first is the card's.
    anchors = ["", *(f' id="{i}"' for i in card.anchors[1:])]
    items = [
        f"<li{render_data_attribute(parse_element_key(subject))}{anchor}><code>{escape_html(subject)}</code></li>"
        for subject, anchor in zip(card.finding.subjects, anchors, strict=False)
    ]
    if len(items) <= MOST_SUBJECTS:
        return f'<ul class="subjects">{"".join(items)}</ul>'
    head, rest = "".join(items[:MOST_SUBJECTS]), "".join(items[MOST_SUBJECTS:])
    return (
        f'<ul class="subjects">{head}</ul><details><summary>{len(items) - MOST_SUBJECTS} more places '
        f'made by the same text</summary><ul class="subjects">{rest}</ul></details>'
    )


def _render_source(run: Run, span: Span | None) -> str:
    if span is None:
        return ""
    shown = render_code_frame(run.sources, span, 0)
    return f'<figure class="frame"><figcaption>{_render_place(span)}</figcaption>{shown}</figure>'


def _render_call_chain(run: Run, card: FindingCard) -> str:
    """Render the text of the finding; with macros or includes, all calls from the outermost on, linked in both directions."""
    span, via = card.finding.location.span, card.finding.location.via
    if span is None:
        return ""
    if not via:
        # The summary line above shows the place.
        shown = render_code_frame(run.sources, span)
        return f'<figure class="frame">{shown}</figure>' if shown else ""
    steps = [*via, span]
    last = len(steps) - 1
    ids = [f"{card.anchors[0]}-at{number}" for number in range(len(steps))]
    items = []
    for i, step in enumerate(steps):
        before = f'<a href="#{ids[i - 1]}">called at {_render_file_line(steps[i - 1])}</a>' if i else ""
        after = f'<a href="#{ids[i + 1]}">brings in {_render_file_line(steps[i + 1])}</a>' if i < last else ""
        is_quoted = i < MOST_FRAMES // 2 or i > last - MOST_FRAMES // 2
        shown = render_code_frame(run.sources, step, 2 if i == last else 0) if is_quoted else ""
        items.append(
            f'<li id="{ids[i]}"><figure class="frame"><figcaption>{_render_place(step)}'
            f'<span class="steps">{before}{after}</span></figcaption>{shown}</figure></li>'
        )
    calls = "a macro call or include" if len(via) == 1 else f"{len(via)} macro calls or includes"
    return f'<div class="via"><h5>Brought here by {calls}</h5><ol class="chain">{"".join(items)}</ol></div>'


def _render_place(span: Span) -> str:
    """Render a place; on a narrow page the style hides its folder."""
    name = get_base_name(span.file)
    folder = span.file[: len(span.file) - len(name)]
    shown = f'<span class="folder">{escape_html(folder)}</span>' if folder else ""
    return f'<code title="{escape_html(format_place(span))}">{shown}{escape_html(format_place(span)[len(folder) :])}</code>'


def _render_file_line(span: Span) -> str:
    return f"<code>{escape_html(get_base_name(span.file))}:{span.line}</code>"


def _render_related(run: Run, related: Sequence[Location]) -> str:
    if not related:
        return ""
    items = "".join(
        f"<li><code>{escape_html(r.subject)}</code>{_render_source(run, r.span)}</li>" for r in related[:MOST_FRAMES]
    )
    items += "".join(
        f"<li><code>{escape_html(r.subject)}</code>"
        + (f" <code>{escape_html(format_place(r.span))}</code></li>" if r.span else "</li>")
        for r in related[MOST_FRAMES:]
    )
    return f'<details class="related"><summary>Related places ({len(related)})</summary><ul>{items}</ul></details>'


def _render_explanation(run: Run, finding: Finding) -> str:
    parts = []
    if block := explain_block(run, finding):
        parts.append(f'<div class="why"><h5>Not checked</h5><p>{render_prose(block)}</p></div>')
    if finding.cause_text is not None:
        parts.append(f'<div class="why"><h5>Why</h5><p>{render_prose(finding.cause_text)}</p></div>')
    if effects := list_effects(run, finding):
        rows = [f"<div><dt>{escape_html(names)}</dt><dd>{render_prose(effect)}</dd></div>" for names, effect in effects]
        parts.append(f'<div class="then"><h5>What follows</h5><dl>{"".join(rows)}</dl></div>')
    hidden = finding.data.get("hides", ())
    if hidden:
        parts.append(
            f'<p class="hides">Set aside on the same element until this is repaired: {_render_codes(hidden)}</p>'
        )
    return f'<div class="explanation">{"".join(parts)}</div>' if parts else ""


def _render_codes(codes: Iterable[object]) -> str:
    return ", ".join(f"<code>{escape_html(str(code))}</code>" for code in codes)


def _render_fix(run: Run, fix: Fix) -> str:
    how = APPLICABILITY_TEXTS[str(fix.applicability)]
    edits = button = ""
    if fix.edits:
        edits = render_diff(run.sources, fix.edits)
        button = '<button type="button" class="act copy-diff" hidden>Copy diff</button>'
    if len(fix.edits) > MOST_EDITS:
        edits = f"<details><summary>{format_count(len(fix.edits), 'edit')}</summary>{edits}</details>"
    return (
        f'<div class="fix"><div class="fix-head"><h5>Repair <span class="how">{how}</span></h5>{button}</div>'
        f"<p>{render_prose(fix.title)}</p>{edits}</div>"
    )


def _render_card_footer(card: FindingCard) -> str:
    """Render the confidence and the fingerprint, which is whole in its tooltip and in the card's address."""
    finding = card.finding
    fingerprint = "".join(
        f'<span>fingerprint <data class="print" value="{text}" title="{text}">{text[:SHOWN_DIGITS]}</data></span>'
        for text in finding.fingerprints[:1]
    )
    return (
        f"<footer><span><b>{finding.confidence}</b>: {CONFIDENCE_TEXTS[finding.confidence]}</span> {fingerprint} "
        '<button type="button" class="act copy-link" hidden>Copy link</button></footer>'
    )
