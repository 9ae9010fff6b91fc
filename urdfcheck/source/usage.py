"""What xacro files define and what they read, as typed: without expanding, and so for every file and branch alike."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.files import read_regular, walk
from urdfcheck.source.expressions import names_in
from urdfcheck.source.load import Source
from urdfcheck.source.packages import display_name
from urdfcheck.source.parameters import next_parameter
from urdfcheck.source.problems import Problem
from urdfcheck.source.xml import Attribute, Element

# Files that a xacro file can include. Larger ones are expanded models or data, in which nobody writes expressions.
_INCLUDED = frozenset({".xacro", ".urdf", ".xml", ".gazebo", ".srdf"})
_LARGEST = 500_000

# None may look to the end of the text from each of many places: what opens one, or its word, ends the search for its end.
_EXPRESSION = re.compile(r"\$\{([^$}]*(?:\$(?!\{)[^$}]*)*)\}|\$\(eval\s([^$)]*(?:\$(?!\()[^$)]*)*)\)")
_BLOCK = re.compile(r"""insert_block\s+name\s*=\s*["']([^"']+)["']""")
_FORWARDED = re.compile(r"""(?<![^\s:="'])([^\s:="']+)\s*:?=\s*\^""")


@dataclass(frozen=True, slots=True, eq=False)
class Macro:
    """A ``<xacro:macro>``; ``parameters`` without the asterisks of blocks, ``optional`` those that have a default."""

    element: Element
    name: str
    parameters: tuple[str, ...]
    optional: frozenset[str]


def elements(trees: Mapping[str, Element], tag: str) -> Iterator[Element]:
    """Every element with this tag, file by file in document order."""
    for tree in trees.values():
        yield from (e for e in tree.walk() if e.tag == tag)


def properties(trees: Mapping[str, Element]) -> dict[str, list[Attribute]]:
    """The name attribute of each definition of a property, by name; computed names and removals are left out."""
    found: dict[str, list[Attribute]] = {}
    for element in elements(trees, "xacro:property"):
        name = element.attributes.get("name")
        if name is not None and name.literal and "remove" not in element.attributes:
            found.setdefault(name.value, []).append(name)
    return found


def macros(trees: Mapping[str, Element]) -> dict[str, Macro]:
    """The macros by name, each as its last definition makes it."""
    found: dict[str, Macro] = {}
    for element in elements(trees, "xacro:macro"):
        parameters, optional, rest = [], set(), element.get("params")
        while rest.strip():
            parameter, default, rest = next_parameter(rest)
            parameters.append(parameter.lstrip("*"))
            optional |= {parameter} if default is not None else set()
        name = element.get("name").removeprefix("xacro:")
        found[name] = Macro(element, name, tuple(parameters), frozenset(optional))
    return found


def names_read(tree: Element) -> set[str]:
    """Every name that an expression, an inserted block or a forwarding default of a file mentions."""
    found: set[str] = set()
    for element in tree.walk():
        if element.tag == "xacro:insert_block":
            found.add(element.get("name"))
        for attribute in element.attributes.values():
            if element.tag == "xacro:macro" and attribute.name == "params":
                found.update(_FORWARDED.findall(attribute.value))
            found |= _in_expressions(attribute.value)
        found |= _in_expressions(element.text)
    return found


def own_trees(source: Source) -> dict[str, Element]:
    """Of the files reached, those of the model's own package: the model's file alone where it belongs to none."""
    own = source.package
    return {
        name: tree
        for name, tree in source.trees.items()
        if name == source.name or (own is not None and own.path in source.files[name].path.absolute().parents)
    }


def names_read_elsewhere(source: Source) -> set[str]:
    """The names that files mention which were not reached, but lie in the model's package or folder."""
    folder = source.path.parent if source.package is None else source.package.path
    found: set[str] = set()
    for path in _files(folder, deep=source.package is not None):
        if display_name(path) in source.trees or not source.finder.allows(path):
            continue
        try:
            text = read_regular(path, _LARGEST).decode("utf-8", "replace")
        except OSError:
            continue
        found.update(_BLOCK.findall(text), _FORWARDED.findall(text), _in_expressions(text))
    return found


def reads_unseen_files(source: Source) -> bool:
    """Whether an include was not followed here that may lead to a file which :func:`names_read_elsewhere` does not read."""
    reached = {name.rsplit("/", 1)[-1] for name in source.trees}
    own = "" if source.package is None else f"$(find {source.package.name})"
    for include in elements(source.trees, "xacro:include"):
        filename = include.get("filename")
        outside = "$(find" in filename and not (own and own in filename)
        # Without a package the model's own folder is known, and nothing around or below it.
        outside |= source.package is None and ("/" in filename or "$" in filename)
        if outside and filename.rsplit("/", 1)[-1] not in reached:
            return True
    return False


def typed_at(source: Source, problem: Problem, expression: str) -> Location:
    """Where the expression that failed was typed: at the problem's place, or in a definition that is read there."""

    def types_it(location: Location) -> bool:
        span = location.span
        file = None if span is None else source.files.get(span.file)
        return span is not None and file is not None and expression in file.text[span.start : span.end]

    at = problem.location
    if not expression or types_it(at):
        return at
    return next((Location(r.subject, r.span, at.via) for r in problem.related if types_it(r)), at)


def _files(folder: Path, *, deep: bool) -> Iterable[Path]:
    for here, names, files in walk(folder):
        names[:] = [name for name in names if deep and not name.startswith(".")]
        yield from (p for name in files if (p := Path(here, name)).suffix in _INCLUDED and p.is_file())


def _in_expressions(text: str) -> set[str]:
    if "$" not in text:
        return set()
    return {name for match in _EXPRESSION.finditer(text) for name in names_in(match.group(1) or match.group(2) or "")}
