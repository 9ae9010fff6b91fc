"""What can be typed at a place: elements, attributes, their values, and names that the model knows.

The text that is being typed rarely parses, so that the place is found by its tags, and names come from the last index.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from lsprotocol import types

from urdfcheck.core.records import dataclass
from urdfcheck.export.index.source_index import ARGUMENT, JOINT, LINK, MACRO, MATERIAL, PARAMETER, PROPERTY, NamePlace
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions
from urdfcheck.server.index_store import IndexStore, IndexView
from urdfcheck.server.names.file_names import iter_path_parts
from urdfcheck.server.names.typed_names import TAG, TypedName, iter_typed_names
from urdfcheck.source.text.grammar import CHILDREN, JOINT_TYPES, get_known_attributes

_BEGUN = re.compile(r"</?([^\s<>/\"']*)")
# What is no tag, with its end.
_OTHERS = (("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">"))
_ATTRIBUTE = re.compile(r"([^\s=\"']+)\s*=\s*(?:\"[^\"]*\"|'[^']*')")
_OPEN_VALUE = re.compile(r"([^\s=\"'<>]+)\s*=\s*([\"'])([^\"'<>]*)\Z")
_OPEN_EXPRESSION = re.compile(r"\$\{[^{}]*\Z")
_OPEN_ARGUMENT = re.compile(r"\$\(arg\s+[^()\s]*\Z")
_OPEN_COMMAND = re.compile(r"\$\([a-z]*\Z")
_TOKEN = re.compile(r"[\w:.-]*\Z")
# A token that is all of the last part of a path: it is what an edit replaces.
_PATH_PART = re.compile(r"(?:\A|[/\s])[\w:.-]*\Z")
_COMMANDS = ("arg", "dirname", "env", "eval", "find", "optenv")
# The attributes of xacro's own elements.
_XACRO = {
    "xacro:arg": ("name", "default"),
    "xacro:property": ("name", "value", "default", "scope", "remove"),
    "xacro:macro": ("name", "params"),
    "xacro:include": ("filename", "ns", "optional"),
    "xacro:if": ("value",),
    "xacro:unless": ("value",),
    "xacro:insert_block": ("name",),
    "xacro:call": ("macro",),
    "xacro:element": ("xacro:name",),
    "xacro:attribute": ("name", "value"),
}
# What the values of attributes are names of.
_NAMED = {
    ("parent", "link"): (LINK,),
    ("child", "link"): (LINK,),
    ("mimic", "joint"): (JOINT,),
    ("gazebo", "reference"): (LINK, JOINT),
    ("material", "name"): (MATERIAL,),
    ("joint", "name"): (JOINT,),
    ("xacro:insert_block", "name"): (PARAMETER,),
}
_NAMING = frozenset({"transmission", "ros2_control"})
# The elements and attributes that others than the reference parser read.
_OTHER_ELEMENTS = {
    "robot": ("gazebo", "ros2_control", "transmission"),
    "ros2_control": ("gpio", "hardware", "joint", "sensor"),
    "hardware": ("param", "plugin"),
    "transmission": ("actuator", "joint", "type"),
}
_COMPONENT_ELEMENTS = ("command_interface", "param", "state_interface")
_OTHER_ATTRIBUTES = {
    "gazebo": ("reference",),
    "plugin": ("filename", "name"),
    "ros2_control": ("name", "type"),
    "transmission": ("name",),
    **dict.fromkeys(("actuator", "command_interface", "gpio", "param", "sensor", "state_interface"), ("name",)),
}
_INTERFACES = ("acceleration", "effort", "position", "velocity")
_BOOLEANS = ("false", "true")
# The values among which an attribute chooses.
_VALUES = {
    ("joint", "type"): JOINT_TYPES,
    ("ros2_control", "type"): ("actuator", "sensor", "system"),
    ("command_interface", "name"): _INTERFACES,
    ("state_interface", "name"): _INTERFACES,
    ("xacro:property", "scope"): ("global", "parent"),
    ("xacro:property", "remove"): _BOOLEANS,
    ("xacro:include", "optional"): _BOOLEANS,
}
_KINDS = {
    LINK: types.CompletionItemKind.Class,
    JOINT: types.CompletionItemKind.Interface,
    MATERIAL: types.CompletionItemKind.Color,
    MACRO: types.CompletionItemKind.Function,
    PROPERTY: types.CompletionItemKind.Constant,
    PARAMETER: types.CompletionItemKind.Variable,
    ARGUMENT: types.CompletionItemKind.Variable,
}
TRIGGERS = ("<", '"', "'", "{", "(", ":", "/")


@dataclass(frozen=True, slots=True)
class _Choice:
    """Something that can be typed."""

    text: str
    kind: types.CompletionItemKind
    detail: str = ""
    inserted: str = ""
    """Where it differs from the text."""


@dataclass(frozen=True, slots=True)
class _TagPlace:
    """Where an offset is among the tags before it."""

    around: tuple[str, ...]
    """The open elements, the outermost first."""
    starts: tuple[int, ...]
    """The offsets of these."""
    tag: str
    """The element in whose start tag it is; empty between tags."""
    rest: str
    """The text of this tag behind its name."""

    @property
    def macros(self) -> set[int]:
        """The offsets of the macros around."""
        return {start for tag, start in zip(self.around, self.starts, strict=True) if tag == "xacro:macro"}


def complete(
    document: OpenDocument, offset: int, indexes: IndexStore, documents: DocumentStore
) -> list[types.CompletionItem]:
    """Return what can be typed at an offset."""
    views = list(indexes.view(document))
    before = document.text[:offset]
    positions = TextPositions(document.text, documents.encoding)
    match = _TOKEN.search(before)
    start = offset if match is None else match.start()
    range_ = positions.make_range(start, offset)
    names = _Names(views, tuple(iter_typed_names(document.text)))
    choices = {choice.text: choice for choice in _iter_choices(before, start, names)}
    choices.update((choice.text, choice) for choice in _iter_paths(before, document, documents))
    return [
        types.CompletionItem(
            label=choice.text,
            kind=choice.kind,
            detail=choice.detail or None,
            text_edit=types.TextEdit(range_, choice.inserted or choice.text),
        )
        for choice in choices.values()
    ]


def _iter_choices(before: str, start: int, names: _Names) -> Iterator[_Choice]:
    place = _find_place(before)
    if place is None:
        return
    value = _OPEN_VALUE.search(place.rest) if place.tag else None
    if value is not None:
        yield from _iter_values(place, value[1], value[3], names)
    elif place.tag and before[start - 1 : start].isspace():
        yield from _iter_attributes(place, names.views)
    elif before.endswith("<", 0, start):
        yield from _iter_elements(place, names)
    elif before.endswith("</", 0, start) and place.around:
        yield _Choice(place.around[-1], types.CompletionItemKind.Property, inserted=f"{place.around[-1]}>")


def _iter_paths(before: str, document: OpenDocument, documents: DocumentStore) -> Iterator[_Choice]:
    """Yield the packages, folders and files that may follow in the path that is being typed."""
    place = _find_place(before)
    value = None if place is None or not place.tag else _OPEN_VALUE.search(place.rest)
    if place is None or value is None or not _PATH_PART.search(value[3]):
        return
    for part in iter_path_parts(place.tag, value[1], value[3], Path(document.path), documents.find_reach()):
        kind = types.CompletionItemKind.Folder if part.is_folder else types.CompletionItemKind.File
        yield _Choice(part.name, kind, inserted=part.inserted)


def _find_place(before: str) -> _TagPlace | None:
    """Return where the end of a text is; None inside a comment or a section of plain text."""
    around: list[tuple[str, int]] = []
    at = before.find("<")
    while at >= 0:
        ending = next((end for begin, end in _OTHERS if before.startswith(begin, at)), None)
        tag = TAG.match(before, at)
        if ending is not None:
            end = before.find(ending, at)
            if end < 0:
                return None
            at = before.find("<", end)
        elif tag is None:
            begun, following = _BEGUN.match(before, at), before.find("<", at + 1)
            if following < 0 and begun is not None:  # the one that is being typed; its name is unknown until it ends
                is_named = begun.end() < len(before)
                return _make_place(around, begun[1] if is_named else "", before[begun.end() :])
            at = following
        else:
            _note_tag(around, tag)
            at = before.find("<", tag.end())
    return _make_place(around)


def _make_place(around: list[tuple[str, int]], tag: str = "", rest: str = "") -> _TagPlace:
    return _TagPlace(tuple(name for name, _ in around), tuple(start for _, start in around), tag, rest)


def _note_tag(around: list[tuple[str, int]], tag: re.Match[str]) -> None:
    """Note that an element begins or ends."""
    closing, name, rest = tag.groups()
    if closing:
        opened = [number for number, (known, _) in enumerate(around) if known == name]
        if opened:  # what was not closed in it ends too
            del around[opened[-1] :]
    elif not rest.endswith("/"):
        around.append((name, tag.start()))


def _iter_values(place: _TagPlace, attribute: str, typed: str, names: _Names) -> Iterator[_Choice]:
    key = place.tag, attribute
    if _OPEN_ARGUMENT.search(typed):
        yield from names.iter_choices(place, ARGUMENT)
    elif _OPEN_COMMAND.search(typed):
        yield from (_Choice(name, types.CompletionItemKind.Keyword) for name in _COMMANDS)
    elif _OPEN_EXPRESSION.search(typed):
        yield from names.iter_choices(place, PROPERTY, PARAMETER)
    elif key in _VALUES:
        yield from (_Choice(name, types.CompletionItemKind.EnumMember) for name in _VALUES[key])
    elif key == ("joint", "name") and not _NAMING.intersection(place.around):
        return  # it gets a new name
    else:
        yield from names.iter_choices(place, *_NAMED.get(key, ()))


def _iter_attributes(place: _TagPlace, views: list[IndexView]) -> Iterator[_Choice]:
    """Yield the attributes that an element may have and has not yet."""
    typed = set(_ATTRIBUTE.findall(place.rest))
    if place.tag in _XACRO:
        names: Iterable[str] = _XACRO[place.tag]
    elif place.tag.startswith("xacro:"):
        names = dict.fromkeys(name for view in views for name in _list_parameters(view, place.tag[6:]))
    else:
        names = sorted({*get_known_attributes(place.tag), *_OTHER_ATTRIBUTES.get(place.tag, ())})
    for name in names:
        if name not in typed:
            yield _Choice(name, types.CompletionItemKind.Field, inserted=f'{name}=""')


def _list_parameters(view: IndexView, macro: str) -> list[str]:
    """Return the parameters of a macro: those that are defined between its name and that of the next macro."""
    definitions = [place for place in view.model.index.names if place.is_definition]
    places = [place.span for place in definitions if place.kind == MACRO]
    found = []
    for own in (place.span for place in definitions if (place.kind, place.name) == (MACRO, macro)):
        later = [span.start for span in places if span.file == own.file and span.start > own.start]
        end = min(later, default=None)
        found += [
            place.name
            for place in definitions
            if place.kind == PARAMETER
            and place.span.file == own.file
            and place.span.start > own.start
            and (end is None or place.span.start < end)
        ]
    return found


def _iter_elements(place: _TagPlace, names: _Names) -> Iterator[_Choice]:
    """Yield the elements that the element around may hold, then those of xacro and the macros."""
    known = [tag for tag in reversed(place.around) if not tag.startswith("xacro:")] or ["robot"]
    inner: Iterable[str] = (*CHILDREN.get(known[0], ()), *_OTHER_ELEMENTS.get(known[0], ()))
    if "ros2_control" in known[1:2]:
        inner = _OTHER_ELEMENTS.get(known[0], _COMPONENT_ELEMENTS)
    elif "transmission" in known[1:2]:
        inner = ()
    for tag in sorted(inner):
        yield _Choice(tag, types.CompletionItemKind.Property)
    for tag in _XACRO:
        yield _Choice(tag, types.CompletionItemKind.Keyword)
    for choice in names.iter_choices(place, MACRO):
        yield _Choice(f"xacro:{choice.text}", choice.kind, choice.detail)


@dataclass(frozen=True, slots=True)
class _Names:
    """What is defined in the models that a document is a part of, and in its present text."""

    views: list[IndexView]
    typed: tuple[TypedName, ...]

    def iter_choices(self, place: _TagPlace, *kinds: str) -> Iterator[_Choice]:
        """Yield the names of some kinds that are known at a place."""
        known = {(own.kind, own.name) for own in self.typed if own.macro is None or own.macro in place.macros}
        for view in self.views:
            for own in view.model.index.names:
                is_local = own.kind == PARAMETER or own.scope is not None
                if own.is_definition and (not is_local or self._is_around(own, view, place)):
                    known.add((own.kind, own.name))
        for kind, name in sorted(known):
            if kind in kinds:
                yield _Choice(name, _KINDS[kind], detail=kind)

    @staticmethod
    def _is_around(own: NamePlace, view: IndexView, place: _TagPlace) -> bool:
        """Whether the macro of a property is around a place; parameters are taken from the text."""
        offsets = None if own.scope is None else view.find_offsets(own.scope)
        return offsets is not None and offsets[0] in place.macros
