"""What an editor shows under the cursor: the evidence of findings, values of expressions, facts of links and joints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import PurePath

from lsprotocol import types

from urdfcheck.core import Applicability, Finding
from urdfcheck.core.text import format_angle, format_count, join_names, round_decimals
from urdfcheck.export.index.source_index import JOINT, LINK, ComputedText, ComputedUse, ValueSource, YamlKey
from urdfcheck.export.index.units import find_unit
from urdfcheck.server.diagnostics import ShownFinding
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions, find_word
from urdfcheck.server.index_store import IndexStore, IndexView
from urdfcheck.source.text.values import parse_number

# The elements in a link or joint that hold what its facts are about.
_DESCRIBED = re.compile(r"<(?:link|joint|inertial|mass|inertia|axis|limit|mimic|dynamics)\b[^<>]*\Z", re.DOTALL)
# The text in which the beginning of an element is looked for.
_LONGEST_TAG = 2_000
_JOINT_SUBJECT = re.compile(r"joint\[([^\[\]]*)\]")
# Parts that are described where a macro makes several of one text, those with the same facts as one.
_MOST_PARTS = 4
# Robots whose values are told where a file is a part of several: those that are open first.
_MOST_ROBOTS = 3
_SPECIAL = re.compile(r"([\\`*_{}\[\]<>()#+!|~-])")


def describe_position(
    document: OpenDocument,
    position: types.Position,
    indexes: IndexStore,
    documents: DocumentStore,
    shown: Iterable[ShownFinding],
) -> types.Hover | None:
    """Return what is known about a position; None if nothing is."""
    offset = TextPositions(document.text, documents.encoding).find_offset(position)
    parts = [_describe_finding(found.finding) for found in shown if _contains(found.range, position)]
    users = sorted(indexes.view(document), key=lambda view: documents.find_open(view.model.index.files[0]) is None)
    views = users[:_MOST_ROBOTS]
    for view in views:
        parts += [_describe_text(text, view, offset) for text in view.find_texts(offset)]
        key = view.find_yaml_key(offset)
        parts += [] if key is None else [_describe_yaml_key(key, view)]
    known = {line.strip() for part in parts for line in part.splitlines()}
    named = (part for view in views for part in _iter_named_parts(view, document.text, offset))
    parts += [part for part in named if not known.issuperset(map(str.strip, part.splitlines()))]
    sections = list(dict.fromkeys(filter(None, parts)))
    if not sections:
        return None
    if len(users) > len(views):
        sections.append(f"and {format_count(len(users) - len(views), 'more robot')}")
    return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, "\n\n---\n\n".join(sections)))


def _contains(range_: types.Range, position: types.Position) -> bool:
    return range_.start <= position <= range_.end


# -- findings ----------------------------------------------------------------------------------------------------------


def _describe_finding(finding: Finding) -> str:
    """Return the evidence of a finding, its cause, what programs do, and the repair."""
    lines = [f"**{finding.code}** {escape(finding.message)}"]
    if finding.cause_text:
        lines.append(escape(finding.cause_text))
    lines += [f"- {escape(program)}: {escape(text)}" for program, text in finding.consequences.items()]
    if finding.fix is not None:
        kind = " (may change the meaning)" if finding.fix.applicability is Applicability.UNSAFE else ""
        lines.append(f"Fix{kind}: {escape(finding.fix.title)}")
    return "\n\n".join(lines)


def escape(text: str) -> str:
    """Return a text in which nothing is Markdown: names may be a stranger's."""
    return _SPECIAL.sub(r"\\\1", " ".join(text.split()))


def quote(text: str) -> str:
    """Return a text as inline code."""
    fence = "``" if "`" in text else "`"
    space = " " if fence == "``" else ""
    return f"{fence}{space}{' '.join(text.split())}{space}{fence}"


# -- expressions -------------------------------------------------------------------------------------------------------


def _describe_text(text: ComputedText, view: IndexView, offset: int) -> str:
    """Return the value of a text with expressions, or of the word under the cursor where its words are those of the value."""
    place = view.find_offsets(text.span)
    word = None if place is None else _find_word(text.text, offset - place[0])
    lines: list[str] = []
    for use in text.uses:
        typed, value = _select_word(text.text, use.value, word)
        where = f" in {quote(use.subject)}" if len(text.uses) > 1 else ""
        unit = _describe_unit(use.subject, value, view)
        lines.append(f"{quote(typed)} = {quote(round_decimals(value)) if value else '(empty)'}{unit}{where}")
        if len(text.uses) == 1:
            lines += [_describe_source(source) for source in use.sources]
    if len(text.uses) > 1:
        lines += _list_varied_sources(text.uses)
    return "  \n".join(lines)


def _describe_unit(subject: str, value: str, view: IndexView) -> str:
    """Return the unit of a value, of one angle also its degrees: `` rad (90°)``."""
    types_by_name = {part.name: part.detail for part in view.model.index.parts if part.kind == JOINT}
    joint = _JOINT_SUBJECT.match(subject)
    unit = find_unit(subject, types_by_name.get(joint[1], "") if joint else "")
    number = parse_number(value)
    degrees = f" ({format_angle(number)})" if unit == "rad" and number is not None else ""
    return f" {unit}{degrees}" if unit and value else ""


def _find_word(text: str, offset: int) -> int | None:
    """Return which of the words of a text an offset is in; an expression with blanks belongs to one word."""
    words = list(_iter_words(text))
    return next((number for number, (start, end) in enumerate(words) if start <= offset <= end), None)


def _iter_words(text: str) -> Iterator[tuple[int, int]]:
    depth, start = 0, -1
    for index, character in enumerate(text):
        depth += (character in "{(") - (character in "})")
        if character.isspace() and depth <= 0:
            if start >= 0:
                yield start, index
            start = -1
        elif start < 0:
            start = index
    if start >= 0:
        yield start, len(text)


def _select_word(typed: str, value: str, word: int | None) -> tuple[str, str]:
    words = [typed[start:end] for start, end in _iter_words(typed)]
    values = value.split()
    if word is None or len(words) != len(values) or len(words) == 1 or "$" not in words[word]:
        return typed, value
    return words[word], values[word]


def _describe_source(source: ValueSource) -> str:
    """Return ``property base_mass = 116.0, base.urdf.xacro:26``."""
    typed = source.text and quote(source.text)
    became = quote(round_decimals(source.value)) if source.value else ""
    value = " = ".join(part for part in (typed, became) if part)
    place = "" if source.span is None else f", {escape(PurePath(source.span.file).name)}:{source.span.line}"
    return f"- {source.kind} {quote(source.name)}{f' = {value}' if value else ''}{place}"


def _describe_yaml_key(key: YamlKey, view: IndexView) -> str:
    """Return the key of a yaml file with its value, and what was computed from it."""
    place = view.find_offsets(key.span)
    typed = "" if place is None else view.document.text[slice(*place)]
    lines = [f"yaml {quote(key.name)} = {quote(typed)}"]
    lines += [f"- {quote(subject)}" for subject in key.subjects[:_MOST_PARTS]]
    if len(key.subjects) > _MOST_PARTS:
        lines.append(f"- and {len(key.subjects) - _MOST_PARTS} more")
    return "  \n".join(lines)


def _list_varied_sources(uses: tuple[ComputedUse, ...]) -> list[str]:
    """Return the sources that all uses have in common: the others differ from call to call."""
    common = [source for source in uses[0].sources if all(source in use.sources for use in uses)]
    return [_describe_source(source) for source in common]


# -- names -------------------------------------------------------------------------------------------------------------


def _iter_named_parts(view: IndexView, text: str, offset: int) -> Iterator[str]:
    """Yield what is known of the link or joint that is named at an offset, or whose element it is in."""
    names = {(place.kind, place.name) for place in view.find_names(offset)}
    index = view.model.index
    parts = [part for part in index.parts if (part.kind, part.name) in names]
    behind = offset + len(find_word(text, offset)[1])
    if not names and _DESCRIBED.search(text[max(0, behind - _LONGEST_TAG) : behind]):
        parts = [part for part in index.parts if any(view.covers(place, offset) for place in part.places[:1])]
    alike: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for part in parts:
        alike.setdefault((part.kind, part.facts), []).append(part.name)
    for (kind, facts), own in list(alike.items())[:_MOST_PARTS]:
        title = f"**{kind}{'s' if len(own) > 1 else ''} {escape(join_names(own))}**"
        yield "  \n".join((title, *map(escape, facts)))
    if len(alike) > _MOST_PARTS:
        yield f"and {sum(map(len, list(alike.values())[_MOST_PARTS:]))} more"
    for kind, name in sorted(names - {(part.kind, part.name) for part in parts}):
        if kind not in {LINK, JOINT}:
            yield from _describe_definition(view, kind, name)


def _describe_definition(view: IndexView, kind: str, name: str) -> Iterator[str]:
    """Yield what a property, argument or parameter stands for, as far as anything of the robot was computed from it."""
    sources = dict.fromkeys(
        source
        for text in view.model.index.texts
        for use in text.uses
        for source in use.sources
        if (source.kind, source.name) == (kind, name)
    )
    if sources:
        yield "  \n".join(map(_describe_source, list(sources)[:_MOST_PARTS]))
