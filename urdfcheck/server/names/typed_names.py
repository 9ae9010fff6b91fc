"""The names that the text of an editor defines itself: while one types, the last index has not all of them yet."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core.records import dataclass
from urdfcheck.export.index.source_index import ARGUMENT, JOINT, LINK, MACRO, MATERIAL, PARAMETER, PROPERTY
from urdfcheck.source.text.xml import COMMENT
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter

# A tag, whose values hold no "<": one that is being typed is none.
TAG = re.compile(r"""<(/?)([^\s<>/"']+)((?:"[^"<]*"|'[^'<]*'|[^<>"'])*)>""")
_ATTRIBUTE = r"""(?<![\w:]){}\s*=\s*(["'])(.*?)\1"""
_NAME, _PARAMS, _TYPE = (re.compile(_ATTRIBUTE.format(name), re.DOTALL) for name in ("name", "params", "type"))
_SCOPE = re.compile(r"\bscope\s*=")
_DEFINED = {
    "link": LINK,
    "joint": JOINT,
    "material": MATERIAL,
    "xacro:property": PROPERTY,
    "xacro:arg": ARGUMENT,
    "xacro:macro": MACRO,
}
_BLANK = re.compile(r"[\r\n\t]")


@dataclass(frozen=True, slots=True)
class TypedName:
    """A name that a text defines."""

    kind: str
    name: str
    macro: int | None
    """The offset of the macro in which alone it is known: that of a parameter or a property."""


def iter_typed_names(text: str) -> Iterator[TypedName]:
    """Yield the names that are typed without expressions, also in a text that does not parse."""
    macros: list[int] = []
    for match in TAG.finditer(COMMENT.sub(lambda comment: " " * len(comment[0]), text)):
        closing, tag, rest = match.groups()
        name, kind = _NAME.search(rest), _DEFINED.get(tag)
        if tag == "xacro:macro":
            if closing:
                del macros[-1:]
            elif not rest.endswith("/"):
                macros.append(match.start())
                yield from (TypedName(PARAMETER, own, match.start()) for own in _iter_parameters(rest))
        if closing or kind is None or name is None or not _defines(kind, name[2], rest):
            continue
        is_local = kind == PROPERTY and bool(macros) and not _SCOPE.search(rest)
        yield TypedName(kind, name[2], macros[-1] if is_local else None)


def _defines(kind: str, name: str, rest: str) -> bool:
    """Whether a tag defines its name: others use those of joints and materials. ``rest``: its text behind its own name."""
    if kind == JOINT:
        return bool(name) and "$" not in name and _TYPE.search(rest) is not None
    return bool(name) and "$" not in name and not (kind == MATERIAL and rest.endswith("/"))


def _iter_parameters(tag: str) -> Iterator[str]:
    """Yield the parameters that the tag of a macro declares."""
    params = _PARAMS.search(tag)
    rest = "" if params is None else _BLANK.sub(" ", params[2])
    while rest.strip():
        name, _, rest = parse_next_parameter(rest)
        yield name.lstrip("*")
