"""Where the names of xacro are defined and used, as typed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.export.index.source_index import ARGUMENT, FILE, MACRO, PARAMETER, PROPERTY, NamePlace
from urdfcheck.source.load import Source
from urdfcheck.source.text.handed_values import EXPRESSION
from urdfcheck.source.text.tokens import find_name_span
from urdfcheck.source.text.xml import Attribute, Definition, Element
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter
from urdfcheck.source.xacro.usage import iter_elements_by_tag, strip_namespace

_WORD = re.compile(r"(?<![\w.'\"])[^\W\d]\w*")
_STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
_ARGUMENT = re.compile(r"\$\(arg\s+([^\s()]+)\s*\)")
_ARGUMENT_CALL = re.compile(r"""\barg\(\s*(['"])([^'"]+)\1\s*\)""")
# What stands before the last literal part of a path.
_BEFORE_PATH = re.compile(r".*[)}]", re.DOTALL)
_BREAK = re.compile(r"[\r\n\t]")


def iter_xacro_names(source: Source) -> Iterator[NamePlace]:
    """Yield the places of the properties, parameters, arguments and macros of a xacro file, and of what it includes."""
    yield from _XacroNames(source).iter_places()
    yield from _iter_includes(source)


def _iter_includes(source: Source) -> Iterator[NamePlace]:
    """Yield the names of included files, where only one file that was read ends as the name does."""
    for element in iter_elements_by_tag(source.trees, "xacro:include"):
        filename = element.attributes.get("filename")
        tail = "" if filename is None else _BEFORE_PATH.sub("", filename.value).lstrip("./")
        meant = [file for name, file in source.files.items() if tail and f"/{name}".endswith(f"/{tail}")]
        if filename is not None and filename.span is not None and len(meant) == 1:
            yield NamePlace(FILE, meant[0].name, filename.span, False, (meant[0].make_span(0, 0),))


@dataclass(frozen=True, slots=True)
class _NameScope:
    """What is known at an element besides what is known everywhere."""

    parameters: Mapping[str, Span] = field(default_factory=dict)
    """Those of the macros around it, with the places at which they are declared."""
    macro: Element | None = None
    """The innermost macro around it."""


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
        self.by_macro: dict[str, list[dict[str, Span]]] = {}
        self.local_properties: set[tuple[str, Span]] = set()
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
            waiting: list[tuple[Element, _NameScope]] = [(tree, _NameScope())]
            while waiting:
                element, scope = waiting.pop()
                if element.tag == "xacro:macro":
                    own = self.parameters.get(id(element), {})
                    scope = _NameScope({**scope.parameters, **own}, element)
                yield from self._iter_uses(element, scope)
                waiting += [(child, scope) for child in reversed(element.children)]

    def _define(self, element: Element) -> None:
        kind = {"xacro:property": PROPERTY, "xacro:arg": ARGUMENT, "xacro:macro": MACRO}.get(element.tag)
        name = element.attributes.get("name")
        if kind is None or name is None or name.span is None or not name.literal:
            return
        typed = strip_namespace(name.value) if kind == MACRO else name.value
        span = self._make_span(name, len(name.value) - len(typed), len(typed))
        macro = _find_scope(element) if kind == PROPERTY else None
        scope = None if macro is None else macro.span
        parameter = self.parameters.get(id(macro), {}).get(typed)
        if parameter is not None:  # it gets another value
            self.definitions.append(NamePlace(PARAMETER, typed, span, False, (parameter,)))
            return
        if scope is not None:
            self.local_properties.add((typed, scope))
        self.definitions.append(NamePlace(kind, typed, span, True, scope=scope))
        if kind == MACRO:
            params = element.attributes.get("params")
            found = {} if params is None else dict(self._iter_parameters(params))
            self.parameters[id(element)] = found
            self.by_macro.setdefault(typed, []).append(found)
            self.definitions += [NamePlace(PARAMETER, one, place, True) for one, place in found.items()]

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
        return self._make_file_span(attribute.span, start, length)

    def _make_file_span(self, text: Span, start: int, length: int) -> Span:
        return self.files[text.file].make_span(text.start + start, text.start + start + length)

    def _iter_uses(self, element: Element, scope: _NameScope) -> Iterator[NamePlace]:
        if element.span is None or element.span.file not in self.files:
            return
        if element.tag.startswith("xacro:"):
            yield from self._iter_calls(element, scope)
        for attribute in element.attributes.values():
            if "$" in attribute.typed and attribute.span is not None:
                yield from self._iter_read_names(attribute.typed, attribute.span, scope)
        if "$" in element.text:
            file = self.files[element.span.file]
            end = file.text.find("<", element.span.end)
            place = file.make_span(element.span.end, len(file.text) if end < 0 else end)
            yield from self._iter_read_names(file.text[place.start : place.end], place, scope)

    def _iter_calls(self, element: Element, scope: _NameScope) -> Iterator[NamePlace]:
        """Yield the macro that an element calls and the parameters that it gives, or the block that it inserts."""
        assert element.span is not None  # of a typed one
        name = strip_namespace(element.tag)
        if name not in BUILT_IN_TAGS and name in self.known[MACRO]:
            yield NamePlace(
                MACRO, name, self._make_file_span(element.span, 1 + len(element.tag) - len(name), len(name)), False
            )
            for attribute in element.attributes.values():
                declared = tuple(known[attribute.name] for known in self.by_macro[name] if attribute.name in known)
                span = find_name_span(attribute, self.files)
                if declared and span is not None:
                    yield NamePlace(PARAMETER, attribute.name, span, False, declared)
        block = element.attributes.get("name") if element.tag == "xacro:insert_block" else None
        if block is not None and block.span is not None:
            yield from self._iter_variable(block.value, block.span, block.span, scope)

    def _iter_read_names(self, typed: str, at: Span, scope: _NameScope) -> Iterator[NamePlace]:
        """Yield the names that the expressions of a text read."""
        for match in _ARGUMENT.finditer(typed):
            if match[1] in self.known[ARGUMENT]:
                yield NamePlace(ARGUMENT, match[1], self._make_file_span(at, match.start(1), len(match[1])), False)
        for match in EXPRESSION.finditer(typed):
            group = 1 if match[1] is not None else 2
            start = match.start(group)
            for call in _ARGUMENT_CALL.finditer(match[group]):
                if call[2] in self.known[ARGUMENT]:
                    span = self._make_file_span(at, start + call.start(2), len(call[2]))
                    yield NamePlace(ARGUMENT, call[2], span, False)
            expression = _STRING.sub(lambda string: "'" * len(string[0]), match[group])
            for word in _WORD.finditer(expression):
                span = self._make_file_span(at, start + word.start(), len(word[0]))
                if group == 2 and word[0] in self.known[ARGUMENT]:
                    yield NamePlace(ARGUMENT, word[0], span, False)
                else:
                    yield from self._iter_variable(word[0], span, at, scope)

    def _iter_variable(self, name: str, span: Span, text: Span, scope: _NameScope) -> Iterator[NamePlace]:
        """Yield the parameter or property that a name in a text means there."""
        macro = None if scope.macro is None else scope.macro.span
        if name in scope.parameters:
            yield NamePlace(PARAMETER, name, span, False, (scope.parameters[name],))
        elif name in self.known[PROPERTY]:
            local = macro if macro is not None and (name, macro) in self.local_properties else None
            yield NamePlace(PROPERTY, name, span, False, self.reads.get((text, name), ()), scope=local)


def _find_scope(element: Element) -> Element | None:
    """Return the macro that a property is local to; None if it is known beyond it."""
    if element.get("scope") in {"parent", "global"}:
        return None
    around = element.parent
    while around is not None and around.tag != "xacro:macro":
        around = around.parent
    return around


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
