"""Where a value was typed that xacro only hands on: in a yaml file, a property or a macro call."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import Attribute, Definition, SourceFile, flatten_definitions

# The search does not go to the end of the text from each of many places: the next opening bracket ends it.
EXPRESSION = re.compile(r"\$\{([^$}]*(?:\$(?!\{)[^$}]*)*)\}|\$\(eval\s([^$)]*(?:\$(?!\()[^$)]*)*)\)")
_STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
_OPERATOR = re.compile(r"[-+*/%(]")
_REFERENCE = re.compile(r"\s*\$\{[^{}]*\}\s*")
_NAME = re.compile(r"\s*\$\{\s*(\w+)\s*\}\s*")
_ARGUMENT = re.compile(r"\s*\$\(arg\s+([^\s()]+)\s*\)\s*")
# A parameter with its default, which another value may precede; and a text as it is.
_PARAMETER, _WHOLE = (
    re.compile(r"""[^\s:=]+\s*:?=\s*(?:\^\|?)?(['"]?)(.*)\1""", re.DOTALL),
    re.compile(r"()(.*)", re.DOTALL),
)
# How a zero is typed.
_ZEROS = frozenset({"0", "0.0", "0."})
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


def list_zero_sources(attributes: Iterable[Attribute]) -> list[str]:
    """List the properties, arguments and parameters that are 0, of those from which the values of attributes are computed."""
    definitions = (definition for attribute in attributes for definition in attribute.collect_definitions())
    return list(dict.fromkeys(f"{d.kind} {d.name}" for d in definitions if d.value.strip() in _ZEROS))


def find_handed_text(attribute: Attribute, files: Mapping[str, SourceFile]) -> TypedValue | None:
    """Return the text that an attribute is given as a whole: ``${prefix}_arm`` of a call, where the macro has ``${parent}``.

    It may be the default of a parameter or of an argument, too. None where the text is typed at the attribute, and where it is
    not plain which one it is.
    """
    found, typed, reads = None, attribute.typed, attribute.reads
    for _ in range(_MOST_STEPS):
        name = _NAME.fullmatch(typed) or _ARGUMENT.fullmatch(typed)
        if name is None:
            return found if "$" in typed or typed.strip() == attribute.value.strip() else None
        definition = next((read for read in reads if read.name == name[1]), None)
        found = None if definition is None else _find_text(definition, files)
        if definition is None or found is None:
            return None
        typed, reads = found.text, definition.reads
    return None


def _find_text(definition: Definition, files: Mapping[str, SourceFile]) -> TypedValue | None:
    """Return what is typed at a definition: of a parameter of a macro, its default."""
    span = definition.span
    if span is None or definition.text or span.file not in files:
        return TypedValue(span, definition.text) if span is not None and definition.text else None
    text = files[span.file].text[span.start : span.end]
    default = _PARAMETER.fullmatch(text) if definition.kind == "parameter" else _WHOLE.fullmatch(text)
    if default is None or not default[2]:
        return None
    start = span.start + default.start(2)
    return TypedValue(files[span.file].make_span(start, start + len(default[2])), default[2])


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
