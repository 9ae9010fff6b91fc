"""An argument with which a xacro file leaves out what stops its expansion."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from urdfcheck.core import Location
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.source.load import Source
from urdfcheck.source.text.xml import Element

# The value with which a condition of this kind leaves out what is in it.
_SKIPPING = {"xacro:if": "false", "xacro:unless": "true"}
# A condition that is an argument, or a property.
_ARGUMENT = re.compile(r"\s*(?:\$\(arg\s+(\w+)\s*\)|\$\{\s*(\w+)\s*\})\s*")
# So many of them are tried.
_MOST_TRIED = 3


def find_skipping_argument(source: Source, at: Location) -> tuple[str, str] | None:
    """Return an argument with the value for which the conditions around an include leave it out, and the model expands.

    ``at``: where the expansion stops. The expansion is tried.

    :raises ModelTimeout: if the model's time is used up.
    """
    from urdfcheck.source.xacro.expand import expand_xacro  # few models need it

    tried: set[tuple[str, str]] = set()
    for name, value in _iter_conditions(source, at):
        if (name, value) in tried or len(tried) == _MOST_TRIED or source.arguments.get(name) == value:
            continue
        tried.add((name, value))
        arguments = {**source.arguments, name: value}
        expansion = expand_xacro(source.path, arguments, source.finder, extra_environment=source.environment)
        if any(problem.kind == "time-limit" for problem in expansion.problems):
            raise ModelTimeout
        if expansion.root is not None:
            return name, value
    return None


def _iter_conditions(source: Source, at: Location) -> Iterator[tuple[str, str]]:
    """Yield the arguments that decide conditions around a place, and around the includes of its file, with the value that each
    must have."""
    properties = _read_properties(source.trees)
    seen: set[str] = set()
    elements = [] if at.span is None else list(_find_elements(source.trees.get(at.span.file), at.span.start))
    while elements:
        element = elements.pop()
        above: Element | None = element
        while above is not None:
            condition = _ARGUMENT.fullmatch(above.get("value")) if above.tag in _SKIPPING else None
            name = None if condition is None else condition[1] or properties.get(condition[2])
            if name:
                yield name, _SKIPPING[above.tag]
            above = above.parent
        file = None if element.span is None else source.files.get(element.span.file)
        if file is not None and file.name not in seen:
            seen.add(file.name)
            elements += _find_includes(source, file.path.name)


def _find_elements(root: Element | None, offset: int) -> Iterator[Element]:
    """Yield the innermost element whose tag is at a place."""
    around = [e for e in ([] if root is None else root.walk()) if e.span and e.span.start <= offset < e.span.end]
    yield from around[-1:]


def _find_includes(source: Source, name: str) -> list[Element]:
    """Return the elements that include a file of this name."""
    elements = (element for tree in source.trees.values() for element in tree.walk())
    return [e for e in elements if e.tag == "xacro:include" and e.get("filename").rpartition("/")[2] == name]


def _read_properties(trees: Mapping[str, Element]) -> dict[str, str]:
    """Return the properties whose value is an argument, with the name of that."""
    elements = (element for tree in trees.values() for element in tree.walk() if element.tag == "xacro:property")
    values = ((element.get("name"), _ARGUMENT.fullmatch(element.get("value"))) for element in elements)
    return {name: value[1] for name, value in values if value is not None and value[1]}
