"""Where names are defined and used: those of the robot after expansion, and those of xacro as typed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import (
    ARGUMENT,
    FILE,
    JOINT,
    LINK,
    MACRO,
    MATERIAL,
    PARAMETER,
    PROPERTY,
    NamePlace,
)
from urdfcheck.source.load import Source
from urdfcheck.source.text.handed_values import EXPRESSION
from urdfcheck.source.text.xml import Attribute, Definition, Element
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter
from urdfcheck.source.xacro.usage import iter_elements_by_tag, strip_namespace

# The attributes that name a link or joint elsewhere.
_REFERENCES = {
    ("parent", "link"): LINK,
    ("child", "link"): LINK,
    ("mimic", "joint"): JOINT,
}
# Elements around a joint or link that is only named there.
_NAMING = frozenset({"transmission", "ros2_control"})
_WORD = re.compile(r"(?<![\w.'\"])[^\W\d]\w*")
_STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
_ARGUMENT = re.compile(r"\$\(arg\s+([^\s()]+)\s*\)")
# What stands before the last literal part of a path.
_BEFORE_PATH = re.compile(r".*[)}]", re.DOTALL)
_BREAK = re.compile(r"[\r\n\t]")


def list_name_places(source: Source) -> tuple[NamePlace, ...]:
    """Return the places of all names in a model's files, each once, in no particular order."""
    places = dict.fromkeys(_iter_robot_names(source))
    if source.is_xacro:
        places.update(dict.fromkeys((*_XacroNames(source).iter_places(), *_iter_includes(source))))
    return tuple(places)


def _iter_robot_names(source: Source) -> Iterator[NamePlace]:
    """Yield the places of links, joints and materials; without a robot, as far as they are typed literally."""
    root = source.root if source.root is not None and source.root.tag == "robot" else source.main_tree
    if root is None:
        return
    names = {kind: {e.get("name") for e in root.find_children(kind)} for kind in (LINK, JOINT)}
    for element in root.walk():
        for attribute in element.attributes.values():
            found = None if attribute.span is None else _classify(element, attribute, names)
            if found is not None and attribute.span is not None and "$" not in attribute.value:
                yield NamePlace(found[0], attribute.value, attribute.span, found[1])


def _classify(element: Element, attribute: Attribute, names: Mapping[str, set[str]]) -> tuple[str, bool] | None:
    """Return what an attribute names, and whether it defines that; None for all others."""
    tag, name, parent = element.tag, attribute.name, element.parent
    if (tag, name) in _REFERENCES:
        return _REFERENCES[tag, name], False
    if tag == "gazebo" and name == "reference":
        return next(((kind, False) for kind, known in names.items() if attribute.value in known), None)
    if name != "name" or parent is None:
        return None
    if tag == MATERIAL:
        return MATERIAL, bool(element.children)
    if tag in names:
        if parent.tag == "robot":
            return tag, True
        if parent.tag in _NAMING:
            return tag, False
    return None


def _iter_includes(source: Source) -> Iterator[NamePlace]:
    """Yield the names of included files, where only one file that was read ends as the name does."""
    for element in iter_elements_by_tag(source.trees, "xacro:include"):
        filename = element.attributes.get("filename")
        tail = "" if filename is None else _BEFORE_PATH.sub("", filename.value).lstrip("./")
        meant = [file for name, file in source.files.items() if tail and f"/{name}".endswith(f"/{tail}")]
        if filename is not None and filename.span is not None and len(meant) == 1:
            yield NamePlace(FILE, meant[0].name, filename.span, False, (meant[0].make_span(0, 0),))


class _XacroNames:
    """The names of xacro in the files of a model.

    What an expression reads is known exactly where it was evaluated; elsewhere the scopes say it: the parameters of the macro
    around it, then properties.
    """

    def __init__(self, source: Source) -> None:
        self.files = source.files
        self.trees = source.trees
        self.reads = _collect_reads(source)
        self.parameters: dict[int, dict[str, Span]] = {}
        self.definitions: list[NamePlace] = []
        for tree in self.trees.values():
            for element in tree.walk():
                self._define(element)
        self.known = {
            kind: {p.name for p in self.definitions if p.kind == kind} for kind in (PROPERTY, ARGUMENT, MACRO)
        }

    def iter_places(self) -> Iterator[NamePlace]:
        """Yield all places."""
        yield from self.definitions
        for tree in self.trees.values():
            waiting: list[tuple[Element, Mapping[str, Span]]] = [(tree, {})]
            while waiting:
                element, scope = waiting.pop()
                scope = {**scope, **self.parameters[id(element)]} if id(element) in self.parameters else scope
                yield from self._iter_uses(element, scope)
                waiting += [(child, scope) for child in reversed(element.children)]

    def _define(self, element: Element) -> None:
        kind = {"xacro:property": PROPERTY, "xacro:arg": ARGUMENT, "xacro:macro": MACRO}.get(element.tag)
        name = element.attributes.get("name")
        if kind is None or name is None or name.span is None or not name.literal:
            return
        typed = strip_namespace(name.value) if kind == MACRO else name.value
        self.definitions.append(NamePlace(kind, typed, name.span, True))
        if kind == MACRO and "params" in element.attributes:
            found = dict(self._iter_parameters(element.attributes["params"]))
            self.parameters[id(element)] = found
            self.definitions += [NamePlace(PARAMETER, one, span, True) for one, span in found.items()]

    def _iter_parameters(self, params: Attribute) -> Iterator[tuple[str, Span]]:
        """Yield the parameters of a macro, each with the place of its name."""
        if params.span is None or params.span.file not in self.files:
            return
        text = rest = _BREAK.sub(" ", params.typed)
        while rest.strip():
            start = len(text) - len(rest) + len(rest) - len(rest.lstrip())
            name, _, rest = parse_next_parameter(rest)
            plain = name.lstrip("*")
            start += len(name) - len(plain)
            if text.startswith(plain, start):
                yield plain, self._make_span(params, start, len(plain))

    def _make_span(self, attribute: Attribute, start: int, length: int) -> Span:
        assert attribute.span is not None  # of a typed one
        at = attribute.span.start + start
        return self.files[attribute.span.file].make_span(at, at + length)

    def _iter_uses(self, element: Element, scope: Mapping[str, Span]) -> Iterator[NamePlace]:
        if element.span is not None and element.tag.startswith("xacro:"):
            name = strip_namespace(element.tag)
            if name not in BUILT_IN_TAGS and name in self.known[MACRO]:
                start = element.span.start + 1 + len(element.tag) - len(name)
                yield NamePlace(MACRO, name, self.files[element.span.file].make_span(start, start + len(name)), False)
        block = element.attributes.get("name") if element.tag == "xacro:insert_block" else None
        if block is not None and block.span is not None and block.value in scope:
            yield NamePlace(PARAMETER, block.value, block.span, False, (scope[block.value],))
        for attribute in element.attributes.values():
            if "$" in attribute.typed and attribute.span is not None and attribute.span.file in self.files:
                yield from self._iter_read_names(attribute, scope)

    def _iter_read_names(self, attribute: Attribute, scope: Mapping[str, Span]) -> Iterator[NamePlace]:
        """Yield the names that the expressions of an attribute read."""
        for match in _ARGUMENT.finditer(attribute.typed):
            if match[1] in self.known[ARGUMENT]:
                yield NamePlace(ARGUMENT, match[1], self._make_span(attribute, match.start(1), len(match[1])), False)
        for match in EXPRESSION.finditer(attribute.typed):
            group = 1 if match[1] is not None else 2
            expression = _STRING.sub(lambda string: "'" * len(string[0]), match[group])
            for word in _WORD.finditer(expression):
                span = self._make_span(attribute, match.start(group) + word.start(), len(word[0]))
                if group == 2 and word[0] in self.known[ARGUMENT]:
                    yield NamePlace(ARGUMENT, word[0], span, False)
                elif word[0] in scope:
                    yield NamePlace(PARAMETER, word[0], span, False, (scope[word[0]],))
                elif word[0] in self.known[PROPERTY]:
                    assert attribute.span is not None  # of a typed one
                    yield NamePlace(PROPERTY, word[0], span, False, self.reads.get((attribute.span, word[0]), ()))


def _collect_reads(source: Source) -> Mapping[tuple[Span, str], tuple[Span, ...]]:
    """Return for each evaluated text and each property in it the names of the definitions that were read."""
    names = {a.span: n.span for tree in source.trees.values() for a, n in _iter_property_values(tree)}
    found: dict[tuple[Span, str], dict[Span, None]] = {}
    seen: set[int] = set()
    elements = () if source.root is None else source.root.walk()
    waiting: list[tuple[Span | None, Sequence[Definition]]] = [
        (attribute.span, attribute.reads)
        for element in elements
        for attribute in element.attributes.values()
        if attribute.reads
    ]
    while waiting:
        place, reads = waiting.pop()
        for definition in reads:
            name = names.get(definition.span)
            if place is not None and definition.kind == PROPERTY and name is not None:
                found.setdefault((place, definition.name), {})[name] = None
            if id(definition) not in seen:
                seen.add(id(definition))
                waiting.append((definition.span, definition.reads))
    return {key: tuple(spans) for key, spans in found.items()}


def _iter_property_values(tree: Element) -> Iterator[tuple[Attribute, Attribute]]:
    """Yield the value of each property in a file with its name."""
    for element in tree.walk():
        name = element.attributes.get("name") if element.tag == "xacro:property" else None
        value = element.attributes.get("value") or element.attributes.get("default")
        if name is not None and value is not None and name.span is not None:
            yield value, name
