"""Where a finding is to be repaired: a macro hands on what a yaml file or a call gives it, and may be right for other calls."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Location, Span
from urdfcheck.source.text.handed_values import find_typed_value, read_numbers
from urdfcheck.source.text.xml import Attribute, Element, flatten_definitions

# The rules about elements as they are written.
_MARKUP = "XML"
# The rules about files that a model names: a file is wrong whichever call names it.
_FILES = ("PKG", "MSH")

# An element: its subject and the calls that made it.
_Place = tuple[str, tuple[Span, ...]]


def locate_typed_values(findings: Sequence[Finding], root: Element | None, texts: Mapping[str, str]) -> list[Finding]:
    """Move findings about numbers or names that a macro hands on, ``${mass}``, to the yaml value or the argument that has them.

    The text of the macro becomes the last step that brought the number in (``via``), so that a comment there still suppresses the
    finding. A finding stays where the macro computes a number or types one itself, or where it is not plain which of several
    texts became the number.

    :param root: the expanded model.
    :param texts: files by name.
    """
    if root is None:
        return list(findings)
    handed = {
        place.span
        for finding in findings
        if finding.location.via and "${" in _get_text(finding.location.span, texts)
        for place in (finding.location, *finding.related)
    }
    makers = _index_by_subject(root, handed) if handed else {}
    located = [_move(finding, makers) for finding in findings]
    return _locate_own_calls(located, root, texts)


def _index_by_subject(root: Element, spans: Iterable[Span | None]) -> dict[str, tuple[Attribute, ...]]:
    """Return for the elements and attributes with these texts the attributes that hold their numbers, by subject."""
    wanted = set(spans)
    found: dict[str, tuple[Attribute, ...]] = {}
    for element in root.walk():
        if element.span in wanted:
            found.setdefault(element.subject, tuple(element.attributes.values()))
        for attribute in element.attributes.values():
            if attribute.span in wanted:
                found.setdefault(attribute.location.subject, (attribute,))
    return found


def _move(finding: Finding, makers: Mapping[str, Sequence[Attribute]]) -> Finding:
    here = finding.location
    # A finding about an element that has a name is about the element; one about the name itself is about the name.
    places = _find_typed_places(makers.get(here.subject, ()), may_be_name="@" in here.subject)
    if here.span is None or not places or _is_about_markup(finding) or _is_right_elsewhere(finding, places, makers):
        return finding
    first, last = places[0], places[-1]
    # The values of a block are a line each; between others there is text that has nothing to do with it.
    is_block = last.line - first.line < len(places)
    span = replace(first, end=last.end, end_line=last.end_line, end_col=last.end_col) if is_block else first
    return replace(
        finding,
        location=Location(here.subject, span, (*here.via, here.span)),
        related=tuple(place for place in finding.related if place.span != span),
    )


def _is_right_elsewhere(finding: Finding, places: Sequence[Span], makers: Mapping[str, Sequence[Attribute]]) -> bool:
    """Whether a value is also that of an element with which a finding compares, and which is typed apart: the value is right
    there, and what is wrong is that this element has it, too."""
    others = [
        attribute
        for place in finding.related
        if place.subject not in finding.subjects and place.span != finding.location.span
        for attribute in makers.get(place.subject, ())
        if not attribute.literal
    ]
    return any(_find_typed_place(attribute, may_be_name=True) in places for attribute in others)


def _is_about_markup(finding: Finding) -> bool:
    """Whether an element itself is wrong, whatever its values are: it is typed in the macro, and no value of a call brings it."""
    return finding.code.startswith(_MARKUP) and "@" not in finding.location.subject


def _find_typed_places(attributes: Sequence[Attribute], *, may_be_name: bool) -> list[Span]:
    """Return the places of the values of these attributes, in one file and in its order; none if one of them is elsewhere, or is
    no number and may not be a name."""
    places: dict[Span, None] = {}
    for attribute in attributes:
        if attribute.literal and set(attribute.value.split()) <= {"0", "0.0"}:
            continue
        place = None if attribute.literal else _find_typed_place(attribute, may_be_name=may_be_name)
        if place is None:
            return []
        places[place] = None
    return sorted(places) if len({place.file for place in places}) == 1 else []


def _find_typed_place(attribute: Attribute, *, may_be_name: bool) -> Span | None:
    """Return the place of the text that a reference stands for, if it is this number or name."""
    typed = find_typed_value(attribute) if may_be_name or read_numbers(attribute.value) is not None else None
    return None if typed is None else typed.span


def _get_content(span: Span | None, texts: Mapping[str, str]) -> str:
    """Return the text behind a start tag, up to the next tag."""
    tag = _get_text(span, texts)
    is_start = span is not None and tag.startswith("<") and tag.endswith(">") and not tag.endswith("/>")
    if span is None or not is_start:
        return ""
    text = texts[span.file]
    return text[span.end : max(text.find("<", span.end), span.end)]


def _get_text(span: Span | None, texts: Mapping[str, str]) -> str:
    return "" if span is None else texts.get(span.file, "")[span.start : span.end]


# -- the call of a macro that is right for others -----------------------------------------------------------------------


def _locate_own_calls(findings: list[Finding], root: Element, texts: Mapping[str, str]) -> list[Finding]:
    """Move findings about some of the elements that a line with ``${…}`` makes to the call that makes theirs.

    The line is right for the other calls, so what this call gives it is wrong. A finding whose repair edits the line stays there.
    """
    handed = [number for number, finding in enumerate(findings) if _is_handed(finding, texts)]
    if not handed:
        return findings
    owners = _find_owners(root, {findings[number].location.via for number in handed})
    concerned = _collect_concerned(findings)
    moved = list(findings)
    for number in handed:
        finding = findings[number]
        owner, made = owners.get((_strip_attribute(finding.location.subject), finding.location.via), (None, ()))
        if owner is None or not _reads_parameter(owner, finding.location, texts):
            continue
        right = [e.via for e in made if not concerned[finding.code].touches(e.subject)]
        moved[number] = replace(
            finding,
            location=_move_to_call(finding.location, right, texts),
            related=tuple(
                _move_to_call(place, right, texts)
                if place.span == finding.location.span and place.subject in finding.subjects
                else place
                for place in finding.related
            ),
        )
    return moved


def _is_handed(finding: Finding, texts: Mapping[str, str]) -> bool:
    """Whether a finding is at a text of a macro that depends on the call, and no edit says what to change there."""
    has_edits = finding.fix is not None and bool(finding.fix.edits)
    if has_edits or not finding.location.via or finding.code.startswith(_FILES) or _is_about_markup(finding):
        return False
    return "${" in _get_text(finding.location.span, texts) + _get_content(finding.location.span, texts)


def _reads_parameter(owner: Element, place: Location, texts: Mapping[str, str]) -> bool:
    """Whether the text of a place, in or of an element, has a parameter of a macro: of the content, any expression counts."""
    named = [attribute for attribute in owner.attributes.values() if attribute.location.subject == place.subject]
    reads = (read for attribute in named or owner.attributes.values() for read in attribute.reads)
    is_content = place.span != owner.span and not named
    return (
        is_content
        or "${" in _get_content(place.span, texts)
        or any(read.kind == "parameter" for read in flatten_definitions(reads))
    )


def _find_owners(root: Element, calls: Collection[tuple[Span, ...]]) -> dict[_Place, tuple[Element, list[Element]]]:
    """Return each element that these calls make, by its subject and calls, with all elements of the same text."""
    found = [element for element in root.walk() if element.via in calls]
    made: dict[Span | None, list[Element]] = {element.span: [] for element in found}
    for element in root.walk():
        if element.span in made:
            made[element.span].append(element)
    return {(element.subject, element.via): (element, made[element.span]) for element in found}


class _Concerned:
    """Elements that findings of one rule are about, or name."""

    def __init__(self) -> None:
        self.subjects: set[str] = set()
        self.around: set[str] = set()

    def add(self, subject: str) -> None:
        subject = _strip_attribute(subject)
        self.subjects.add(subject)
        self.around.update(_list_around(subject))

    def touches(self, subject: str) -> bool:
        """Whether an element is one of these, is in one, or has one in it."""
        return subject in self.around or not self.subjects.isdisjoint(_list_around(subject))


def _collect_concerned(findings: Iterable[Finding]) -> dict[str, _Concerned]:
    concerned: dict[str, _Concerned] = {}
    for finding in findings:
        own = concerned.setdefault(finding.code, _Concerned())
        for subject in (finding.location.subject, *finding.subjects, *(place.subject for place in finding.related)):
            own.add(subject)
    return concerned


def _list_around(subject: str) -> list[str]:
    """Return a subject and those of the elements around it."""
    steps = subject.split("/")
    return ["/".join(steps[:number]) for number in range(1, len(steps) + 1)]


def _strip_attribute(subject: str) -> str:
    return subject.rpartition("@")[0] or subject


def _move_to_call(place: Location, right: Sequence[tuple[Span, ...]], texts: Mapping[str, str]) -> Location:
    """Return the innermost call at which the calls of a place leave those of all elements that are right."""
    others = right
    for depth, call in enumerate(reversed(place.via), start=1):
        if not others or place.span is None:
            break
        others = [via for via in others if len(via) >= depth and via[-depth] == call]
        if not others and not _get_text(call, texts).startswith("<xacro:include"):
            at = len(place.via) - depth
            return Location(place.subject, call, (*place.via[:at], *place.via[at + 1 :], place.span))
    return place
