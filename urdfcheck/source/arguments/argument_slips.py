"""Arguments that are read where a sibling of theirs is meant: a block was copied, and one name in it was left."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import split_name_words
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.usage import ARGUMENT


@dataclass(frozen=True, slots=True, eq=False)
class ArgumentSlip:
    """A place that reads an argument where its sibling is meant, which nothing reads."""

    attribute: Attribute
    read: str
    beside: str
    """The argument of the same part that the element reads, too."""


def find_argument_slip(name: str, declared: Collection[str], trees: Mapping[str, Element]) -> ArgumentSlip | None:
    """Return the only place that shows that an unread argument is meant there.

    The element reads another argument of the same part (``front_xyz`` beside ``rear_rpy``, where ``front_rpy`` is not read), and
    another one reads those of the other part together (``rear_xyz``, ``rear_rpy``).
    """
    siblings = {other: words for other in declared if (words := _find_difference(name, other)) is not None}
    together = [read for tree in trees.values() for read in _iter_reads(tree)] if siblings else []
    slips = [
        ArgumentSlip(attribute, read, beside)
        for one in together
        for read, attribute in one.items()
        if read in siblings and (beside := _find_beside(one, read, *siblings[read], together))
    ]
    return slips[0] if len(slips) == 1 else None


def _find_difference(name: str, other: str) -> tuple[str, str] | None:
    """Return the one word in which two names differ, of each; None if they differ in more than a word, or in a number."""
    words, others = split_name_words(name), split_name_words(other)
    differing = [pair for pair in zip(words, others, strict=False) if pair[0] != pair[1]]
    return differing[0] if len(words) == len(others) > 1 and len(differing) == 1 else None


def _iter_reads(tree: Element) -> Iterator[dict[str, Attribute]]:
    """Yield the arguments that an element reads, each with its attribute, of each element that reads several."""
    for element in tree.walk():
        texts = [attribute for attribute in element.attributes.values() if "$(arg" in attribute.value]
        read = {name: attribute for attribute in texts for name in ARGUMENT.findall(attribute.value)}
        if len(texts) > 1 and element.tag != "xacro:arg":
            yield read


def _find_beside(
    one: Mapping[str, Attribute], read: str, own: str, wrong: str, together: Iterable[Mapping[str, Attribute]]
) -> str:
    """Return the argument of the part that is meant that an element reads in another attribute; empty if it reads another of the
    wrong part, or no element reads that other with the one that was read here."""
    words = {name: split_name_words(name) for name, attribute in one.items() if attribute is not one[read]}
    if any(wrong in typed for typed in words.values()):
        return ""
    for name in (name for name, typed in words.items() if own in typed):
        counterpart = [wrong if word == own else word for word in words[name]]
        if any(read in other and any(split_name_words(n) == counterpart for n in other) for other in together):
            return name
    return ""
