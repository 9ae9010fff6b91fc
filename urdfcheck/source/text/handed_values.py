"""Where a value was typed that xacro only hands on: in a yaml file, a property or a macro call."""

from __future__ import annotations

import re
from collections.abc import Sequence

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import Attribute, Definition, flatten_definitions

# The search does not go to the end of the text from each of many places: the next opening bracket ends it.
EXPRESSION = re.compile(r"\$\{([^$}]*(?:\$(?!\{)[^$}]*)*)\}|\$\(eval\s([^$)]*(?:\$(?!\()[^$)]*)*)\)")
_STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
_OPERATOR = re.compile(r"[-+*/%(]")
_REFERENCE = re.compile(r"\s*\$\{[^{}]*\}\s*")
_NAME = re.compile(r"\s*\$\{\s*(\w+)\s*\}\s*")
# A property may be defined by another, and a call may hand on what its macro was given.
_MOST_STEPS = 50


@dataclass(frozen=True, slots=True)
class TypedValue:
    """A text that is the value of an attribute, and its place."""

    span: Span
    text: str


def is_computed(text: str) -> bool:
    """Whether a typed text computes a value, so that it can be wrong itself; ``${mass}`` only hands one on."""
    expressions = (a or b for a, b in EXPRESSION.findall(text))
    return any(_OPERATOR.search(_STRING.sub("", expression)) for expression in expressions)


def find_typed_value(attribute: Attribute) -> TypedValue | None:
    """Return the text that is an attribute's value: its own, or the one that its reference stands for.

    None where the value is computed, and where it is not plain which of several texts became it. The default value of a macro
    belongs to the macro.
    """
    if attribute.literal:
        return None if attribute.span is None else TypedValue(attribute.span, attribute.typed)
    typed, reads = attribute.typed, attribute.reads
    for _ in range(_MOST_STEPS):
        if not _REFERENCE.fullmatch(typed) or is_computed(typed):
            return None
        definition = _find_definition(typed, reads, attribute.value)
        if definition is None or definition.span is None:
            return None
        typed, reads = definition.text, definition.reads
        if _is_same_value(typed, attribute.value):
            return TypedValue(definition.span, typed)
    return None


def find_handed_text(attribute: Attribute) -> TypedValue | None:
    """Return the text that an attribute is given as a whole: ``${prefix}_arm`` of a call, where the macro has ``${parent}``.

    None where it is typed at the attribute, and where it is not plain which text it is.
    """
    found, typed, reads = None, attribute.typed, attribute.reads
    for _ in range(_MOST_STEPS):
        if not _NAME.fullmatch(typed):
            return found
        definition = _find_definition(typed, reads, attribute.value)
        if definition is None or definition.span is None or not definition.text:
            return None
        found, typed, reads = TypedValue(definition.span, definition.text), definition.text, definition.reads
    return None


def read_numbers(text: str) -> list[float] | None:
    """Return the numbers of a text that consists of nothing else."""
    try:
        return [float(word) for word in text.split()] or None
    except ValueError:
        return None


def _find_definition(reference: str, reads: Sequence[Definition], value: str) -> Definition | None:
    """Return the definition that a reference stands for: of its name, or the key of something that was loaded."""
    name = _NAME.fullmatch(reference)
    if name is not None:
        return next((found for found in reads if found.name == name[1]), None)
    keys = {
        found.span: found
        for found in flatten_definitions(reads)
        if found.kind == "yaml" and _is_same_value(found.text, value)
    }
    return next(iter(keys.values())) if len(keys) == 1 else None


def _is_same_value(text: str, value: str) -> bool:
    """Whether a text is a value; numbers may be written in another way."""
    if "$" in text:
        return False
    numbers = read_numbers(text)
    return text.strip() == value.strip() != "" if numbers is None else numbers == read_numbers(value)
