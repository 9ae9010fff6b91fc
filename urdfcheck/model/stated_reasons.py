"""Elements of which a comment beside them says what their numbers are for: they were chosen, and are not a slip."""

from __future__ import annotations

import re

from urdfcheck.core.text import split_name_words
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import COMMENT, Attribute, Definition, Element

# A comment that ends where the element begins, and one that begins where a value of its line ends.
_COMMENT_BEFORE = re.compile(r"<!--((?:(?!-->).)*)-->\s*\Z", re.DOTALL)
_COMMENT_BEHIND = re.compile(r"[^\r\n<]*<!--(.*?)-->", re.DOTALL)
# How far before an element its comment begins, at most (characters).
_REACH = 600
# A link that stands for no part. Dummy numbers are another matter.
_DUMMY_LINK = re.compile(r"\bdummy[ -](?:link|body|frame)s?\b", re.IGNORECASE)
# A link or joint that is there for its frame: it is drawn in RViz, or a controller's model has it.
_VIRTUAL_PART = re.compile(
    r"\bvirtual\b|\bfor (?:the )?(?:visuali[sz]|display|rviz|tf)|\b(?:allows?|helps?) (?:\w+ )?(?:visuali[sz]|display)",
    re.IGNORECASE,
)
# A link that has no mass, and is to have none.
_MASSLESS = re.compile(
    r"\bmass-?less\b|\b(?:null|zero|no|without(?: a| any)?) mass(?:es)?\b|\b(?:fake|virtual|dummy|fictitious) (?:link|bod)",
    re.IGNORECASE,
)
_FIRST_LINK = re.compile(r"<link\b")
# What denies the words behind it: "not a virtual link", "no virtual joint", "isn't for visualization".
_DENIAL = re.compile(r"(?:(?:\bnot|\bnever|n't)\s+(?:\w+\s+){0,2}|\b(?:no|non)[\s-]+)\Z", re.IGNORECASE)
# So many characters before the words are searched for it: two words between are shorter (chosen).
_DENIAL_REACH = 100
# Words that give a reason for the numbers. That they are dummies is none, for they may still have to be replaced; nor is that an
# inertial is needed, whatever it says.
_REASON = re.compile(
    r"stabili|unstab|instab|avoid|prevent|\bhack|\bnon-?\s?zero|\bpruned|bolt(?:ed|ing) down|\bon purpose|intentional|deliberate"
    r"|\b(?:null|blank|minimal|smallest)(?: valid)? inerti|work-?\s?around|\bdrift|\btweaked\b|\bhappy\b"
    r"|\b(?:in|de)creased (?:to|for|so|because)\b"
    # what a simulation does with other numbers
    r"|\b(?:robot|model|simulation|simulator|gazebo|it)\s+(?:to\s+)?"
    r"(?:explodes?|oscill?[ai]\w*|shakes?|vibrates?|jitters?|blows?\s+up)\b"
    r"|\b(?:can\s?not|can't|doesn't|does\s+not)\s+(?:handle|cope\s+with|like)\s+(?:the\s+)?(?:realistic|real|true|actual|small)\b",
    re.IGNORECASE,
)
# Words that warn of the numbers: whoever wrote them does not want them to be relied on.
_DISCLAIMER = re.compile(
    r"\bnot\s+(?:\w+\s+)?reliable\b|\bunreliable\b|\b(?:should|must)\s+not\s+be\s+(?:used|relied)\b"
    r"|\bdo\s+not\s+rely\b|\bnot\s+(?:meant|intended|suitable)\s+for\s+(?:model|simulat|dynamic)",
    re.IGNORECASE,
)
# What a comment above a macro or a property is about, where it gives the reason for masses and inertias.
_ABOUT_DYNAMICS = re.compile(r"inerti|\bmass|\bheav|\blight|simulat|gazebo|physic|unstab|instab|stabili", re.IGNORECASE)
_MACRO_BEFORE = re.compile(r"<(?:\w+:)?macro\b")
# Words in the name of a macro that say that what it makes stands for no part.
_EMPTY = frozenset({"empty", "null", "blank", "virtual", "massless", "negligible", "tiny", "epsilon", "eps"})
_CALL = re.compile(r"<(?:\w+:)?([\w.-]+)")
# A comment about several macros.
_MACROS = re.compile(r"\bmacros\b", re.IGNORECASE)
_MACRO_END = re.compile(r"</(?:\w+:)?macro\s*>")
# A comment above lines of properties with no blank line between them.
_COMMENT_ABOVE = re.compile(
    r"<!--((?:(?!-->).)*)-->[ \t]*\r?\n(?:[ \t]*<(?:\w+:)?property\b[^<>]*/>[ \t]*\r?\n)*[ \t]*<(?:\w+:)?property\b[^<>]*\Z",
    re.DOTALL,
)


def has_stated_reason(model: Model, element: Element) -> bool:
    """Whether a comment in an element, or right before it, says why its numbers are what they are."""
    return any(map(_REASON.search, _list_comments(model, element)))


def has_disclaimer(model: Model, element: Element) -> bool:
    """Whether a comment in an element, or right before it, says that its numbers are not to be relied on."""
    return any(map(_DISCLAIMER.search, _list_comments(model, element)))


def _list_comments(model: Model, element: Element) -> list[str]:
    """List the comments in an element, and the one right before it."""
    span = element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None:
        return []
    end = max(file.text.find(f"</{element.tag}", span.start), span.start)
    return [*COMMENT.findall(file.text, span.start, end), _find_comment_before(file.text, span.start)]


def is_called_dummy(model: Model, link: Element) -> bool:
    """Whether a comment right before a link says that it is a dummy link: a frame that a program wants as a body."""
    return _says(_DUMMY_LINK, model, link)


def is_called_virtual(model: Model, element: Element) -> bool:
    """Whether a comment right before a link or joint says that it is virtual, or there to be drawn."""
    return _says(_VIRTUAL_PART, model, element)


def is_called_massless(model: Model, link: Element) -> bool:
    """Whether a comment right before a link, or before the first link of its file, says that it or others have no mass."""
    span = link.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None:
        return False
    if _says(_MASSLESS, model, link):
        return True
    first = _FIRST_LINK.search(file.text)  # one in a comment is before the others, too
    above = [] if first is None else COMMENT.findall(file.text, 0, first.start())
    return any(_has_undenied(_MASSLESS, comment) for comment in above)


def _says(words: re.Pattern[str], model: Model, element: Element) -> bool:
    """Whether a comment right before an element has words that nothing before them denies."""
    span = element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None:
        return False
    return _has_undenied(words, _find_comment_before(file.text, span.start))


def _has_undenied(words: re.Pattern[str], comment: str) -> bool:
    """Whether a comment has words that nothing before them denies."""
    starts = (found.start() for found in words.finditer(comment))
    return any(_DENIAL.search(comment, max(0, start - _DENIAL_REACH), start) is None for start in starts)


def _find_comment_before(text: str, place: int) -> str:
    """Return the comment right before a place; empty if there is none."""
    before = _COMMENT_BEFORE.search(text[max(0, place - _REACH) : place])
    return "" if before is None else before[1]


def has_reason_above_macro(model: Model, element: Element) -> bool:
    """Whether a comment right before the macro that makes an element says why its masses and inertias are what they are, or one
    before the first macro of the file that is about all its macros."""
    span = element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None or not element.via:
        return False
    starts = [found.start() for found in _MACRO_BEFORE.finditer(file.text, 0, span.start)]
    if not starts or _MACRO_END.search(file.text, starts[-1], span.start) is not None:
        return False
    if _gives_reason_for_dynamics(_find_comment_before(file.text, starts[-1])):
        return True
    above = _find_comment_before(file.text, starts[0])
    return _MACROS.search(above) is not None and _gives_reason_for_dynamics(above)


def is_called_empty(model: Model, element: Element) -> bool:
    """Whether the name of a macro that makes an element says that it stands for no part: ``empty_inertial``."""
    calls = [
        _CALL.match(file.text, span.start)
        for span in element.via
        if (file := model.source.files.get(span.file)) is not None
    ]
    return any(
        not _EMPTY.isdisjoint(word.lower() for word in split_name_words(call[1])) for call in calls if call is not None
    )


def has_reason_at_definition(model: Model, definition: Definition) -> bool:
    """Whether a comment above a property, or above the block of properties that it is in, says why masses and inertias are what
    they are."""
    span = definition.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None or definition.kind != "property":
        return False
    before = _COMMENT_ABOVE.search(file.text[max(0, span.start - _REACH) : span.start])
    return before is not None and _gives_reason_for_dynamics(before[1])


def _gives_reason_for_dynamics(comment: str) -> bool:
    return _REASON.search(comment) is not None and _ABOUT_DYNAMICS.search(comment) is not None


@fact
def collect_reasoned_joints(model: Model) -> frozenset[str]:
    """Collect the joints with such a comment, and those of the same name on other sides."""
    known = {joint.name for joint in model.joints if has_stated_reason(model, joint.element)}
    places = {remove_places(name) for name in known}
    return frozenset(j.name for j in model.joints if j.name in known or remove_places(j.name) in places)


def has_reason_behind(model: Model, attribute: Attribute) -> bool:
    """Whether a comment on the line where the number of an attribute was typed says why it is what it is."""
    span = attribute.location.span
    file = None if span is None else model.source.files.get(span.file)
    behind = None if span is None or file is None else _COMMENT_BEHIND.match(file.text, span.end)
    return behind is not None and _REASON.search(behind[1]) is not None


def has_commented_child(model: Model, element: Element, tag: str) -> bool:
    """Whether a comment in an element holds a child ``<tag>`` of it that was left out, also as ``<!--tag …/-->``."""
    span = element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None or file.text.endswith("/>", span.start, span.end):
        return False
    name = re.escape(tag)
    child = re.compile(rf"<{name}[\s>]|\A{name}(?:>|\s+\w+=)")
    for found in re.compile(rf"<!--(.*?)(?:-->|\Z)|</{re.escape(element.tag)}\b", re.DOTALL).finditer(
        file.text, span.end
    ):
        if found[1] is None:
            return False
        if child.search(found[1]):
            return True
    return False
