"""One finding as a card."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from urdfcheck.core import Confidence, Finding, Fix, Location, Run, Span, Verdict
from urdfcheck.output.html.element_names import render_data_attribute, render_element_name
from urdfcheck.output.html.file_groups import MODEL, classify_file
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html, render_prose
from urdfcheck.output.html.program_outcomes import is_affected, list_affected_programs, mark_effect
from urdfcheck.output.html.sections.code_listing import render_code_frame, render_diff
from urdfcheck.output.shared.anchors import FindingCard, parse_element_key
from urdfcheck.output.shared.verdict.effects import (
    describe_verdict,
    drops_only_data,
    generalize_effect,
    has_own_subject,
    join_programs,
    list_effects,
)
from urdfcheck.output.shared.verdict.finding_details import describe_own_repair
from urdfcheck.output.shared.verdict.not_checked import explain_block
from urdfcheck.output.shared.wording import (
    describe_models,
    format_count,
    format_place,
    get_base_name,
)
from urdfcheck.policy.consumers import get_verdict

MOST_SUBJECTS = 6
# Elements named in the line with the place.
MOST_NAMES = 3
# Other places named there.
MOST_PLACES = 2
MOST_EDITS = 4
MOST_FRAMES = 8
SHOWN_DIGITS = 8

CONFIDENCE_TEXTS = {
    Confidence.PROOF: "follows from the file, whatever the author meant",
    Confidence.STRONG: "a named pattern with very few false alarms",
    Confidence.HEURISTIC: "a hint: judge for yourself",
}
APPLICABILITY_TEXTS = {
    "safe": "safe to apply",
    "unsafe": "review first",
    "display": "manual",
}
FIX_TAGS = {"safe": "safe fix", "unsafe": "fix", "display": "fix by hand"}


def render_card(run: Run, card: FindingCard, *, model_file: str = "", is_first: bool = False) -> str:
    """Render a finding, folded to its claim and its place; ``is_first``: with the line of code and who minds.

    ``model_file``: the model's own file, which needs no word for what it is."""
    finding = card.finding
    file = "" if finding.location.span is None else escape_html(finding.location.span.file)
    css_class, reason = f"card {finding.severity}{' first' if is_first else ''}", ""
    if finding.suppressed is not None:
        css_class += " known"
        reason = f'<p class="reason">Known, {escape_html(str(finding.suppressed))}</p>'
    programs = list_affected_programs(finding)
    affected = f' data-programs="{" ".join(programs)}"' if programs else ""
    details = (
        f'<p class="message">{render_prose(finding.message)}</p>',
        _render_occurrences(finding),
        _render_explanation(run, finding),
        "" if finding.fix is None else _render_fix(run, finding.fix),
        _render_evidence(run, card),
    )
    return (
        f'<article class="{css_class}" id="{card.anchors[0]}" tabindex="-1" data-code="{escape_html(finding.code)}" '
        f'data-confidence="{finding.confidence}" data-file="{file}"{affected}>'
        f"{_render_card_header(run, finding)}{_render_place_line(card, model_file)}{reason}{_render_code(run, finding)}"
        f'{_render_minds(run, finding)}<details class="more"><summary><span class="sr">Details of {escape_html(finding.code)}, '
        f"{escape_html(finding.location.subject)}</span></summary>{''.join(details)}</details></article>"
    )


def _render_card_header(run: Run, finding: Finding) -> str:
    code = escape_html(finding.code)
    rule = f'<span class="rule-code">{code}</span><span class="sr"> {escape_html(finding.name)}</span>'
    if finding.code in run.rules:
        rule = f'<a href="#rule-{code}" title="{escape_html(finding.name)}">{rule}</a>'
    return (
        f'<header><h4>{render_glyph(finding.severity)}<span class="sr severity">{finding.severity}</span> '
        f'<span class="headline">{escape_html(finding.headline)}</span></h4><span class="rule-name">{rule}</span></header>'
    )


def _render_place_line(card: FindingCard, model_file: str) -> str:
    """Render where to type: the place, the elements, and whether there is a repair."""
    finding = card.finding
    span = finding.location.span
    parts = []
    if span is not None:
        kind = classify_file(span.file, model_file)
        word = f'<span class="kind">{kind}</span> ' if kind not in ("", MODEL) else ""
        parts.append(f"<span>{word}{_render_file_line(span)}{_render_other_places(finding, span)}</span>")
    keys = list(dict.fromkeys(filter(None, map(parse_element_key, finding.subjects))))
    if finding.fix is not None and finding.fix.edits:
        parts.append(f'<span class="tag">{FIX_TAGS[str(finding.fix.applicability)]}</span>')
    if keys:
        parts.append(
            '<button type="button" class="in-3d" title="Show in 3D" aria-label="Show in 3D" hidden>3D</button>'
        )
    # Names that the headline has in full need no repetition.
    if any(key[-1] not in finding.headline for key in keys[:MOST_NAMES]):
        rest = f" and {len(keys) - MOST_NAMES} more" if len(keys) > MOST_NAMES else ""
        parts.append(f'<span class="names">{", ".join(map(render_element_name, keys[:MOST_NAMES]))}{rest}</span>')
    return f'<p class="at">{"".join(parts)}</p>' if parts else ""


def _render_other_places(finding: Finding, first: Span) -> str:
    """Render the other places of one kind of mistake; nothing for a finding of one place."""
    spans = {own.location.span: None for own in finding.list_occurrences() if own.location.span is not None}
    others = [span for span in spans if span != first]
    if not finding.occurrences:
        return ""
    shown = "".join(
        f" {_render_place_code(span, f':{span.line}') if span.file == first.file else _render_file_line(span)}"
        for span in others[:MOST_PLACES]
    )
    rest = f" and {len(others) - MOST_PLACES} more" if len(others) > MOST_PLACES else ""
    return f'{shown}{rest} <b class="times">×{len(finding.occurrences)}</b>'


def _render_code(run: Run, finding: Finding) -> str:
    """Render the text to change; a closed card hides all but the lines that are meant."""
    span = finding.location.span
    if span is None:
        return ""
    shown = render_code_frame(run.sources, span, 1)
    return (
        f'<figure class="frame typed"><figcaption>{_render_place(span)}</figcaption>{shown}</figure>' if shown else ""
    )


def _render_minds(run: Run, finding: Finding) -> str:
    """Render what programs do with the defect, apart from those that load what was typed, the worst first."""
    groups: dict[tuple[int, str, str], list[str]] = {}
    for program in finding.consequences:
        if is_affected(finding, program):
            verdict = get_verdict(finding.consequences, program)
            kind = mark_effect(finding, program, run.rules)
            effect = finding.consequences[program]
            own = effect if verdict is Verdict.LOADS or drops_only_data(effect) else ""
            groups.setdefault((-verdict, kind, own), []).append(program)
    phrases = [
        f'<span class="{kind}">{render_glyph(kind) if kind != "ok" else "·"} <b>{escape_html(join_programs(names))}'
        f"{':' if own and has_own_subject(own) else ''}</b> "
        f"{render_prose(_describe_effect(own, Verdict(-rank), len(names)))}</span>"
        for (rank, kind, own), names in sorted(groups.items())
    ]
    return f'<p class="minds">{"".join(phrases)}</p>' if phrases else ""


def _describe_effect(own: str, verdict: Verdict, count: int) -> str:
    """Say what programs do, in a sentence of their own where there is one."""
    if not own:
        return describe_verdict(verdict, count)
    return generalize_effect(own, count) if drops_only_data(own) else own


def _render_evidence(run: Run, card: FindingCard) -> str:
    """Render what few readers need, folded: each program's sentence, the way to the text, related places, the fingerprint."""
    finding = card.finding
    parts = (
        _render_variants(run, finding),
        _render_consequences(run, finding),
        _render_subjects(card),
        _render_call_chain(run, card),
        _render_related(run, finding.related),
        _render_hidden_rules(finding),
        _render_card_footer(card),
    )
    names = ["programs"] if finding.consequences else []
    names += ["macro calls"] if finding.location.via else []
    names += [format_count(len(finding.related), "related place")] if finding.related else []
    told = f": {', '.join(names)}" if names else ""
    return f'<details class="evidence screen"><summary>Details{told}</summary>{"".join(parts)}</details>'


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


def _render_occurrences(finding: Finding) -> str:
    """Render the places of one kind of mistake, each with what is said of it."""
    items = [
        "<li>"
        + ("" if own.location.span is None else f"{_render_file_line(own.location.span)} ")
        + f"{escape_html(own.headline + describe_own_repair(own, finding))}</li>"
        for own in finding.occurrences
    ]
    if not items:
        return ""
    head, rest = "".join(items[:MOST_SUBJECTS]), "".join(items[MOST_SUBJECTS:])
    more = f"<details><summary>{len(items) - MOST_SUBJECTS} more</summary><ul>{rest}</ul></details>" if rest else ""
    return f'<div class="occurrences"><h5>{len(items)} places</h5><ul>{head}</ul>{more}</div>'


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
    source = "" if card.finding.occurrences else " places made by the same text"
    return (
        f'<ul class="subjects">{head}</ul><details><summary>{len(items) - MOST_SUBJECTS} more{source}</summary>'
        f'<ul class="subjects">{rest}</ul></details>'
    )


def _render_source(run: Run, span: Span | None) -> str:
    if span is None:
        return ""
    shown = render_code_frame(run.sources, span, 0)
    return f'<figure class="frame"><figcaption>{_render_place(span)}</figcaption>{shown}</figure>'


def _render_call_chain(run: Run, card: FindingCard) -> str:
    """Render all calls of macros and includes from the outermost on, linked in both directions; nothing without any."""
    span, via = card.finding.location.span, card.finding.location.via
    if span is None or not via:
        return ""
    steps = [*via, span]
    last = len(steps) - 1
    ids = [f"{card.anchors[0]}-at{number}" for number in range(len(steps))]
    items = []
    for i, step in enumerate(steps):
        before = f'<a href="#{ids[i - 1]}">called at {_name_step(steps[i - 1])}</a>' if i else ""
        after = f'<a href="#{ids[i + 1]}">brings in {_name_step(steps[i + 1])}</a>' if i < last else ""
        is_quoted = i < MOST_FRAMES // 2 or i > last - MOST_FRAMES // 2
        shown = render_code_frame(run.sources, step, 0) if is_quoted else ""
        items.append(
            f'<li id="{ids[i]}"><figure class="frame"><figcaption>{_render_place(step)}'
            f'<span class="steps">{before}{after}</span></figcaption>{shown}</figure></li>'
        )
    calls = "a macro call or include" if len(via) == 1 else f"{len(via)} macro calls or includes"
    return f'<div class="via"><h5>Expanded from {calls}</h5><ol class="chain">{"".join(items)}</ol></div>'


def _render_place(span: Span) -> str:
    """Render a place with its folder."""
    name = get_base_name(span.file)
    folder = span.file[: len(span.file) - len(name)]
    shown = f'<span class="folder">{escape_html(folder)}</span>' if folder else ""
    return _render_place_code(span, f"{shown}{escape_html(format_place(span)[len(folder) :])}")


def _render_file_line(span: Span) -> str:
    """Render a place by the name of its file and the line."""
    return _render_place_code(span, f"{escape_html(get_base_name(span.file))}:{span.line}")


def _render_place_code(span: Span, shown: str) -> str:
    """Render a place with all of it in the tooltip, which the page's script offers to copy."""
    return f'<code class="place" title="{escape_html(format_place(span))}">{shown}</code>'


def _name_step(span: Span) -> str:
    return f"<code>{escape_html(get_base_name(span.file))}:{span.line}</code>"


def _render_related(run: Run, related: Sequence[Location]) -> str:
    if not related:
        return ""
    items = "".join(
        f"<li><code>{escape_html(r.subject)}</code>{_render_source(run, r.span)}</li>" for r in related[:MOST_FRAMES]
    )
    items += "".join(
        f"<li><code>{escape_html(r.subject)}</code>{f' {_render_place(r.span)}' if r.span else ''}</li>"
        for r in related[MOST_FRAMES:]
    )
    return f'<div class="related"><h5>Related places</h5><ul>{items}</ul></div>'


def _render_explanation(run: Run, finding: Finding) -> str:
    parts = []
    if block := explain_block(run, finding):
        parts.append(f'<p class="why"><b>Not checked:</b> {render_prose(block)}</p>')
    if finding.cause_text is not None:
        parts.append(f'<p class="why"><b>Why:</b> {render_prose(finding.cause_text)}</p>')
    return "".join(parts)


def _render_consequences(run: Run, finding: Finding) -> str:
    rows = [
        f"<div><dt>{escape_html(names)}</dt><dd>{render_prose(effect)}</dd></div>"
        for names, effect in list_effects(run, finding)
    ]
    return f'<div class="then"><h5>In simulators</h5><dl>{"".join(rows)}</dl></div>' if rows else ""


def _render_hidden_rules(finding: Finding) -> str:
    hidden = finding.data.get("hides", ())
    return (
        f'<p class="hides">Not reported on the same element until this is repaired: {_render_codes(hidden)}</p>'
        if hidden
        else ""
    )


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
        f'<div class="fix"><div class="fix-head"><h5>Fix <span class="how">{how}</span></h5>{button}</div>'
        f"<p>{render_prose(fix.title)}</p>{edits}</div>"
    )


def _render_card_footer(card: FindingCard) -> str:
    """Render the confidence and the fingerprint, which is whole in its tooltip and in the card's address."""
    finding = card.finding
    fingerprint = "".join(
        f'<span>fingerprint <data class="print" value="{text}" title="{text}">{text[:SHOWN_DIGITS]}</data></span>'
        for text in finding.fingerprints[:1]
    )
    link = f'<a class="permalink" href="#{card.anchors[0]}">link to this finding</a>'
    return (
        f"<footer><span>{escape_html(finding.name)} · <b>{finding.confidence}</b>: "
        f"{CONFIDENCE_TEXTS[finding.confidence]}</span> {fingerprint} {link} "
        '<button type="button" class="act copy-link" hidden>Copy link</button></footer>'
    )
