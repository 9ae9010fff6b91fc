"""What xacro files define and what they read, as typed: without expanding, and so for every file and branch alike."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path, has_dependency_entry
from urdfcheck.source.text.grammar import CHILDREN
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.expressions import find_names
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter
from urdfcheck.system.files import read_regular, walk

# Files that a xacro file can include. Larger ones are expanded models or data, in which nobody writes expressions.
_INCLUDED_SUFFIXES = frozenset({".xacro", ".urdf", ".xml", ".gazebo", ".srdf"})
_MAX_BYTES = 500_000
# What hands arguments to a xacro file: launch files, tests and build files.
_CALLER_SUFFIXES = (".launch", ".launch.xml", ".py", ".cmake", "CMakeLists.txt", ".yaml", ".yml", ".sh", ".test")
# Files beyond this many are not looked through: then nobody knows who uses what.
_MOST_FILES = 20_000
# What URDF's own parser reads: no call of a macro, though one may have the name.
_URDF_TAGS = frozenset().union(*CHILDREN.values(), CHILDREN)
# Of all tags with xacro's prefix, those that call no macro.
_BUILT_IN = frozenset(
    ("macro", "property", "include", "arg", "if", "unless", "insert_block", "attribute", "element", "call")
)

# None may look to the end of the text from each of many places: what opens one, or its word, ends the search for its end.
# The attributes that each of xacro's own tags cannot do without, by which a tag without the prefix is known.
_REQUIRED_BY_TAG: Mapping[str, frozenset[str]] = {
    "macro": frozenset({"name"}),
    "include": frozenset({"filename"}),
    "property": frozenset({"name"}),
    "arg": frozenset({"name", "default"}),
    "if": frozenset({"value"}),
    "unless": frozenset({"value"}),
    "insert_block": frozenset({"name"}),
}
# What others than URDF's parser read: there such a tag may have a meaning of its own.
_FOREIGN_TAGS = frozenset({"gazebo", "transmission", "ros2_control", "sensor", "plugin", "mujoco", "cad"})

EXPRESSION = re.compile(r"\$\{([^$}]*(?:\$(?!\{)[^$}]*)*)\}|\$\(eval\s([^$)]*(?:\$(?!\()[^$)]*)*)\)")
_BLOCK = re.compile(r"""insert_block\s+name\s*=\s*["']([^"']+)["']""")
_FORWARDED = re.compile(r"""(?<![^\s:="'])([^\s:="']+)\s*:?=\s*\^""")
_CALLED = re.compile(r"""<xacro:([^\s<>/"'=]+)""")
_CALLED_BY_NAME = re.compile(r"""<xacro:call\s[^<>]{0,1000}?macro\s*=\s*["']([^"'<>]*)""")
_ARGUMENT = re.compile(r"\$\(arg\s+([^\s()]+)\s*\)")
_DECLARED = re.compile(r"""<xacro:arg\s[^<>]{0,1000}?name\s*=\s*["']([^"'<>]*)""")
# `name:=value` of a command, {"name": value} and name="…" of Python and CMake, name: of yaml.
_PASSED = re.compile(r"""(?<!\w)([A-Za-z_]\w*)["']?\s*(?::?=|:)""")


@dataclass(frozen=True, slots=True, eq=False)
class Macro:
    """A ``<xacro:macro>``; ``parameters`` without the asterisks of blocks, ``optional`` those that have a default, ``blocks``
    those that are elements."""

    element: Element
    name: str
    parameters: tuple[str, ...]
    optional: frozenset[str]
    blocks: frozenset[str]


def iter_elements_by_tag(trees: Mapping[str, Element], tag: str) -> Iterator[Element]:
    """Every element with this tag, file by file in document order."""
    for tree in trees.values():
        yield from (e for e in tree.walk() if e.tag == tag)


def collect_properties(trees: Mapping[str, Element]) -> dict[str, list[Attribute]]:
    """The name attribute of each definition of a property, by name; computed names and removals are left out."""
    found: dict[str, list[Attribute]] = {}
    for element in iter_elements_by_tag(trees, "xacro:property"):
        name = element.attributes.get("name")
        if name is not None and name.literal and "remove" not in element.attributes:
            found.setdefault(name.value, []).append(name)
    return found


def collect_macros(trees: Mapping[str, Element]) -> dict[str, Macro]:
    """The macros by name, each as its last definition makes it."""
    found: dict[str, Macro] = {}
    for element in iter_elements_by_tag(trees, "xacro:macro"):
        parameters, optional, blocks, rest = [], set(), set(), element.get("params")
        while rest.strip():
            parameter, default, rest = parse_next_parameter(rest)
            parameters.append(parameter.lstrip("*"))
            optional |= {parameter} if default is not None else set()
            blocks |= {parameter.lstrip("*")} if parameter.startswith("*") else set()
        name = element.get("name").removeprefix("xacro:")
        found[name] = Macro(element, name, tuple(parameters), frozenset(optional), frozenset(blocks))
    return found


def collect_read_names(tree: Element) -> set[str]:
    """Every name that an expression, an inserted block or a forwarding default of a file mentions."""
    found: set[str] = set()
    for element in tree.walk():
        if element.tag == "xacro:insert_block":
            found.add(element.get("name"))
        for attribute in element.attributes.values():
            if element.tag == "xacro:macro" and attribute.name == "params":
                found.update(_FORWARDED.findall(attribute.value))
            found |= _find_expression_names(attribute.value)
        found |= _find_expression_names(element.text)
    return found


def select_own_trees(source: Source) -> dict[str, Element]:
    """Of the files reached, those of the model's own package: the model's file alone where it belongs to none."""
    own = source.package
    return {
        name: tree
        for name, tree in source.trees.items()
        if name == source.name or (own is not None and own.path in source.files[name].path.absolute().parents)
    }


@dataclass(frozen=True, slots=True)
class XacroMentions:
    """What files mention: ``names`` that expressions, inserted blocks and forwarding defaults read, ``macros`` that are called
    (with expressions as typed) and ``arguments`` that are read, declared or handed over. ``complete``: whether all files that
    there are were looked through."""

    names: set[str] = field(default_factory=set)
    macros: set[str] = field(default_factory=set)
    arguments: set[str] = field(default_factory=set)
    complete: bool = True


@lru_cache(maxsize=1)
def collect_outside_mentions(source: Source) -> XacroMentions:
    """What files mention that were not reached: those in the model's package or folder, and in the packages around it those
    that name the package."""
    own = source.package
    found = XacroMentions()
    count = 0
    for folder, named in _iter_using_folders(source):
        if named and not source.finder.can_open(folder):
            if has_dependency_entry(folder, named):
                return replace(found, complete=False)
            continue
        for path in _iter_caller_files(folder, deep=own is not None):
            count += 1
            if count > _MOST_FILES:
                return replace(found, complete=False)
            if format_path(path) in source.trees or not source.finder.can_open(path):
                continue
            try:
                text = read_regular(path, _MAX_BYTES).decode("utf-8", "replace")
            except OSError:
                continue
            if named in text:
                _add_mentions(text, path, found)
    return found


def _iter_using_folders(source: Source) -> Iterator[tuple[Path, str]]:
    """The folders that may use what a model's files define, and what a file in them names where it does."""
    own = source.package
    if own is None:
        yield source.path.parent, ""
        return
    yield own.path, ""
    for folder in source.finder.list_workspace_packages().values():
        if folder != own.path and own.path not in folder.parents and folder not in own.path.parents:
            yield folder, own.name


def _add_mentions(text: str, path: Path, found: XacroMentions) -> None:
    if path.suffix in _INCLUDED_SUFFIXES:
        found.names.update(_BLOCK.findall(text), _FORWARDED.findall(text), _find_expression_names(text))
        found.macros.update(_strip_namespace(tag) for tag in _CALLED.findall(text))
        found.macros.update(map(_strip_namespace, _CALLED_BY_NAME.findall(text)))
        found.arguments.update(found.names, _ARGUMENT.findall(text), _DECLARED.findall(text))
    if path.name.endswith(_CALLER_SUFFIXES):
        found.arguments.update(_PASSED.findall(text))


def collect_called_macros(trees: Mapping[str, Element]) -> set[str]:
    """The macros that are called outside of their own definition, without the namespace; where the name is computed, its text
    as typed."""
    found: set[str] = set()
    for tree in trees.values():
        inside: list[tuple[Element, frozenset[str]]] = [(tree, frozenset())]
        while inside:
            element, macros_around = inside.pop()
            name = element.get("macro") if element.tag == "xacro:call" else element.tag.removeprefix("xacro:")
            if element.tag.startswith("xacro:") and _strip_namespace(name) not in macros_around:
                found.add(_strip_namespace(name))
            if element.tag == "xacro:macro":
                macros_around |= {_strip_namespace(element.get("name"))}
            inside += [(child, macros_around) for child in element.children]
    return found - _BUILT_IN


def collect_read_arguments(trees: Mapping[str, Element]) -> set[str]:
    """The arguments that anything reads: ``$(arg name)``, or an expression that mentions the name."""
    found: set[str] = set()
    for tree in trees.values():
        found |= collect_read_names(tree)
        for element in tree.walk():
            for text in (*(a.value for a in element.attributes.values()), element.text):
                found.update(_ARGUMENT.findall(text) if "$" in text else ())
    return found


def find_unprefixed_tags(trees: Mapping[str, Element]) -> list[Element]:
    """The elements that are xacro's own, or call a macro, but for the prefix: xacro leaves them as they are."""
    calls = {name: macro for name, macro in collect_macros(trees).items() if name not in _URDF_TAGS}
    found: list[Element] = []
    for tree in trees.values():
        below = [tree]
        while below:
            element = below.pop()
            if element.tag in _FOREIGN_TAGS:
                continue
            below += reversed(element.children)
            if _is_builtin(element) or _is_call(element, calls.get(element.tag)):
                found.append(element)
    return found


def _is_builtin(element: Element) -> bool:
    needed = _REQUIRED_BY_TAG.get(element.tag)
    return needed is not None and needed <= element.attributes.keys()


def _is_call(element: Element, macro: Macro | None) -> bool:
    if macro is None or element.parent is None or element.tag in _REQUIRED_BY_TAG:
        return False
    given = element.attributes.keys()
    return set(macro.parameters) - macro.optional <= {*given, *macro.blocks} and given <= set(macro.parameters)


def _strip_namespace(name: str) -> str:
    """A macro's name without the namespace that an include gave it."""
    return name if "$" in name else name.removeprefix("xacro:").rpartition(".")[2]


def has_unseen_includes(source: Source) -> bool:
    """Whether an include was not followed here that may lead to a file which :func:`collect_outside_mentions` does not read."""
    reached = {name.rsplit("/", 1)[-1] for name in source.trees}
    own = "" if source.package is None else f"$(find {source.package.name})"
    for include in iter_elements_by_tag(source.trees, "xacro:include"):
        filename = include.get("filename")
        outside = "$(find" in filename and not (own and own in filename)
        # Without a package the model's own folder is known, and nothing around or below it.
        outside |= source.package is None and ("/" in filename or "$" in filename)
        if outside and filename.rsplit("/", 1)[-1] not in reached:
            return True
    return False


def locate_expression(source: Source, problem: Problem, expression: str) -> Location:
    """Where the expression that failed was typed: at the problem's place, or in a definition that is read there."""

    def has_expression(location: Location) -> bool:
        span = location.span
        file = None if span is None else source.files.get(span.file)
        return span is not None and file is not None and expression in file.text[span.start : span.end]

    at = problem.location
    if not expression or has_expression(at):
        return at
    return next((Location(r.subject, r.span, at.via) for r in problem.related if has_expression(r)), at)


def _iter_caller_files(folder: Path, *, deep: bool) -> Iterator[Path]:
    for here, names, files in walk(folder):
        names[:] = [name for name in names if deep and not name.startswith(".")]
        for name in files:
            path = Path(here, name)
            if (path.suffix in _INCLUDED_SUFFIXES or name.endswith(_CALLER_SUFFIXES)) and path.is_file():
                yield path


def _find_expression_names(text: str) -> set[str]:
    if "$" not in text:
        return set()
    return {name for match in EXPRESSION.finditer(text) for name in find_names(match.group(1) or match.group(2) or "")}
