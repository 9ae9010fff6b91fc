"""Which names a part, a property, an argument or a macro may be given."""

from __future__ import annotations

import builtins
import keyword
import math
import re
from collections.abc import Collection, Sequence

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import (
    ARGUMENT,
    JOINT,
    LINK,
    MACRO,
    MATERIAL,
    PARAMETER,
    PROPERTY,
    YAML_KEY,
    SourceIndex,
)
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS

ROBOT_KINDS = frozenset({LINK, JOINT, MATERIAL})
RENAMED_KINDS = ROBOT_KINDS | {PROPERTY, PARAMETER, ARGUMENT, MACRO, YAML_KEY}
_VARIABLES = frozenset({PROPERTY, PARAMETER})
# What expressions of xacro know by themselves.
_KNOWN_IN_EXPRESSIONS = frozenset({*dir(math), *dir(builtins), "xacro", "python", "arg"})
_IDENTIFIER = re.compile(r"[^\W\d]\w*")
_ARGUMENT = re.compile(r"[\w.-]+")
_TAG = re.compile(r"[^\W\d][\w.-]*")
_PART = re.compile(r"[^\s<>&\"'${}/]+")


def explain_invalid_name(kind: str, name: str) -> str:
    """Return why something of a kind cannot have a name; empty if it can."""
    what = f"`{name}` cannot be the name of {'an' if kind == ARGUMENT else 'a'} {kind}"
    if not name.strip():
        return f"The name of {'an' if kind == ARGUMENT else 'a'} {kind} cannot be empty."
    if kind in _VARIABLES:
        if not _IDENTIFIER.fullmatch(name) or keyword.iskeyword(name):
            return f"{what}: an expression reads letters, digits and underscores, and no digit first."
        if name.startswith("__"):
            return f"{what}: xacro refuses names that begin with two underscores."
        if name in _KNOWN_IN_EXPRESSIONS:
            return f"{what}: expressions already know `{name}`."
    if kind == ARGUMENT and not _ARGUMENT.fullmatch(name):
        return f"{what}: it may have letters, digits, underscores, hyphens and dots."
    if kind == MACRO and name in BUILT_IN_TAGS:
        return f"{what}: `xacro:{name}` is xacro's own."
    if kind == MACRO and not _TAG.fullmatch(name):
        return f"{what}: it becomes a tag, `xacro:{name}`."
    if kind == YAML_KEY and not _TAG.fullmatch(name):
        return f"{what}: it may have letters, digits, underscores, hyphens and dots, and no digit first."
    if kind in ROBOT_KINDS and not _PART.fullmatch(name):
        return f"{what}: blanks, slashes, quotation marks, brackets and $ have another meaning to some reader."
    return ""


def explain_taken_name(
    indexes: Sequence[SourceIndex], kind: str, name: str, mappings: Collection[Span | None] = ()
) -> str:
    """Return where something else of a kind already has a name in one of the models; empty if it is free.

    ``mappings``: those of a key of yaml.
    """
    kinds = _VARIABLES if kind in _VARIABLES else frozenset({kind})
    for index in indexes:
        for place in index.names:
            is_apart = kind == YAML_KEY and place.scope not in mappings
            if place.is_definition and place.kind in kinds and place.name == name and not is_apart:
                article = "An" if place.kind == ARGUMENT else "A"
                return f"{article} {place.kind} is already called `{name}` ({place.span.file}:{place.span.line})."
    return ""
