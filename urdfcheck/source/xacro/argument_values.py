"""Which robots a xacro with arguments can be: the values that its text asks for, and sets of them that show most of what differs.

Nothing is evaluated: an argument is known by its declaration, by what expressions compare it with, by the keys of a dictionary
from yaml that it is an index of, and by the files that a path with it in the middle can mean.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, product
from math import prod
from pathlib import Path

from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, parse_xml
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS
from urdfcheck.source.xacro.usage import EXPRESSION

# Up to here every combination is a variant; beyond it each value by itself, and each pair of values in one of them.
MOST_COMBINATIONS = 32
# Arguments and values that are varied, and files that are read. The widest of a hundred robots has 79 arguments, of which 24
# are switches.
MOST_ARGUMENTS, MOST_VALUES, MOST_FILES = 48, 16, 400
# The longest expression of published robots has 166 characters.
MOST_CHARACTERS = 2_000

_ARGUMENT = r"""\$\(arg\s+([^\s()$]+)\s*\)"""
_ARGUMENT_DEMAND = re.compile(_ARGUMENT)
_REFERENCE = re.compile(rf"""(['"]?){_ARGUMENT}\1|(?<![\w.])(?:xacro\.)?arg\(\s*['"]([^'"]+)['"]\s*\)""")
_NAME = re.compile(r"""(?<![\w.'"])([A-Za-z_]\w*)(?![\w'"(])""")
_MARK = r"\x01([^\x01\x02]*)\x02"
_COMPARED = re.compile(rf"""{_MARK}\s*[=!]=\s*(['"])([^'"$]*)\2""")
_COMPARING = re.compile(rf"""(['"])([^'"$]*)\1\s*[=!]=\s*{_MARK}""")
_AMONG = re.compile(rf"""{_MARK}\s+(?:not\s+)?in\s*[\[({{]([^\])}}]*)[\])}}]""")
_INDEX = re.compile(rf"""([A-Za-z_]\w*)\s*\[\s*{_MARK}\s*\]""")
_LITERAL = re.compile(r"""(['"])([^'"$]*)\1""")
_LOAD = re.compile(r"""load_yaml\(\s*(?:'([^']*)'|"([^"]*)")\s*\)""")
_OPTIONAL = re.compile(r"\$\(optenv\s+\S+\s*([^)]*)\)")
_FIND = re.compile(r"\$\(find\s+([^)\s]+)\s*\)")
# Where paths are written that the expansion reads.
_PATH_ATTRIBUTES = {"xacro:include": ("filename",), "xacro:arg": ("default",), "xacro:property": ("value", "default")}
_NOT_CALLS = BUILT_IN_TAGS - {"call"}


@dataclass(frozen=True, slots=True)
class ArgumentChoice:
    """An argument with the values that it may have, the default first; ``default`` is None where there is none."""

    name: str
    default: str | None
    values: tuple[str, ...]


@dataclass(slots=True)
class _ArgumentUsage:
    """What the text says of one argument; ``in_macros`` what is compared with the parameter of a macro that it is handed to."""

    defaults: list[str | None] = field(default_factory=list)
    values: dict[str, None] = field(default_factory=dict)
    in_macros: dict[str, None] = field(default_factory=dict)
    in_condition: bool = False


def find_argument_choices(path: Path, finder: PackageFinder) -> list[ArgumentChoice]:
    """The arguments of a xacro of which more than one value is known, in the order of their declarations."""
    trees = _read_included_trees(path, finder)
    seen: dict[str, _ArgumentUsage] = {}
    for tree, _ in trees:
        for element in tree.walk():
            if element.tag == "xacro:arg" and element.get("name"):
                known = seen.setdefault(element.get("name"), _ArgumentUsage())
                known.defaults.append(element.get("default") if "default" in element.attributes else None)
    for tree, _ in trees:  # an argument that must be given need not be declared
        for element in tree.walk():
            for text in _list_texts(element):
                for name in _ARGUMENT_DEMAND.findall(text) if "$(arg" in text else ():
                    seen.setdefault(name, _ArgumentUsage())
    if not seen:
        return []
    _read_expressions(trees, finder, seen)
    for tree, folder in trees:
        for element in tree.walk():
            typed = [text for name in _PATH_ATTRIBUTES.get(element.tag, ()) if _is_file_name(text := element.get(name))]
            typed += [a or b for text in _list_texts(element) if "load_yaml" in text for a, b in _LOAD.findall(text)]
            for text in typed:
                for name, value in _iter_path_values(text, folder, finder):
                    if name in seen:
                        seen[name].values[value] = None
    return [choice for name, known in seen.items() if len((choice := _make_choice(name, known)).values) > 1]


def _is_file_name(text: str) -> bool:
    return "/" in text or text.endswith((".xacro", ".urdf", ".yaml"))


def _make_choice(name: str, seen: _ArgumentUsage) -> ArgumentChoice:
    default = next((d for d in seen.defaults if d is not None), None)
    if default is not None:
        optional = _OPTIONAL.fullmatch(default.strip())
        default = (optional[1] if optional else default).strip()
    values = dict(seen.values)
    # A parameter that is compared with several values and never with the default may have been computed anew on the way.
    if not default or default in seen.in_macros or len(seen.in_macros) == 1:
        values.update(seen.in_macros)
    plain = (default or "").lower()
    if plain in {"true", "false"} or (default is None and seen.in_condition and not values):
        values = dict.fromkeys(
            word.capitalize() if (default or "")[:1].isupper() else word for word in ("true", "false")
        )
    elif plain in {"0", "1"} and seen.in_condition and not values:
        values = dict.fromkeys(("1", "0"))
    if default is not None:
        values = {default: None, **values}
    return ArgumentChoice(name, default, tuple(values)[:MOST_VALUES])


def build_argument_sets(choices: Sequence[ArgumentChoice]) -> list[dict[str, str]]:
    """Sets of arguments, the plainest first: all combinations where they are few, else each value by itself and as many sets as
    it takes for each pair of values to be together in one. An argument with its default is left out."""
    values = [c.values for c in choices]
    if prod(map(len, values)) <= MOST_COMBINATIONS:
        rows: list[tuple[str, ...]] = list(product(*values))
    else:
        base = tuple(v[0] for v in values)
        rows = [base]
        rows += [(*base[:i], v, *base[i + 1 :]) for i, known in enumerate(values) for v in known[1:]]
        rows += _cover_pairs(values, rows)
    found = [{c.name: v for c, v in zip(choices, row, strict=True) if v != c.default} for row in dict.fromkeys(rows)]
    return sorted(found, key=len)


def _cover_pairs(values: Sequence[Sequence[str]], rows: Sequence[tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """Rows that, with those given, have each pair of values in one of them, each filled with what covers most of what is left."""
    places = range(len(values))
    left = {((i, a), (j, b)): None for i, j in combinations(places, 2) for a in values[i] for b in values[j]}
    for row in rows:
        for pair in combinations(list(enumerate(row)), 2):
            left.pop(pair, None)
    while left:
        (i, a), (j, b) = next(iter(left))
        chosen = {i: a, j: b}
        for place in places:
            if place not in chosen:

                def count_new_pairs(value: str, place: int = place, chosen: Mapping[int, str] = chosen) -> int:
                    pairs = (sorted(((place, value), other)) for other in chosen.items())
                    return sum((first, second) in left for first, second in pairs)

                chosen[place] = max(values[place], key=count_new_pairs)  # of equal ones the first: the default
        for pair in combinations(sorted(chosen.items()), 2):
            left.pop(pair, None)
        yield tuple(chosen[place] for place in places)


# -- reading -----------------------------------------------------------------------------------------------------------


def _read_included_trees(path: Path, finder: PackageFinder) -> list[tuple[Element, Path]]:
    """The file and all that it can include, each with its folder."""
    found: list[tuple[Element, Path]] = []
    queue, known = [path.absolute()], set[str]()
    while queue and len(known) < MOST_FILES:
        file = queue.pop(0)
        real = os.path.realpath(file)
        if real in known or not finder.can_open(file):
            continue
        known.add(real)
        try:
            tree = parse_xml(SourceFile.read(file, format_path(file)))
        except (OSError, XmlError):
            continue
        found.append((tree, file.parent))
        for element in tree.walk():
            if element.tag == "xacro:include":
                queue += _find_included_files(element.get("filename"), file.parent, finder)
    return found


def _resolve_path(text: str, folder: Path, finder: PackageFinder) -> str | None:
    """A path as typed with its packages looked up; None where one is not found."""
    if len(text) > MOST_CHARACTERS:
        return None
    packages = {name: finder.find(name) for name in _FIND.findall(text)}
    if None in packages.values():
        return None
    text = _FIND.sub(lambda m: str(packages[m[1]]), text)
    text = text.replace("$(dirname)", str(folder))
    return text if os.path.isabs(text) else str(folder / text)


def _find_included_files(text: str, folder: Path, finder: PackageFinder) -> list[Path]:
    """The files that an include may mean: one, or where an argument stands in the path, each that fits."""
    path = _resolve_path(text, folder, finder)
    if path is None:
        return []
    if "$" not in path:
        return [Path(path)]
    return [Path(found) for _, _, found in _iter_fitting_files(path, finder)]


def _iter_path_values(text: str, folder: Path, finder: PackageFinder) -> Iterator[tuple[str, str]]:
    """Arguments and their values for which a path with an argument in it leads to a file."""
    path = _resolve_path(text, folder, finder)
    if path is not None:
        yield from ((name, value) for name, value, _ in _iter_fitting_files(path, finder))


def _iter_fitting_files(path: str, finder: PackageFinder) -> Iterator[tuple[str, str, str]]:
    """Argument, value and file, for each value with which a path leads to one; the path has one argument in one of its names."""
    arguments = set(_ARGUMENT_DEMAND.findall(path))
    if len(arguments) != 1 or "$" in _ARGUMENT_DEMAND.sub("", path):
        return
    (name,) = arguments
    parts = _ARGUMENT_DEMAND.sub("\0", path).split("/")
    varied = [i for i, part in enumerate(parts) if "\0" in part]
    folder = "/".join(parts[: varied[0]])
    if len(varied) != 1 or parts[varied[0]].count("\0") != 1 or not folder or not finder.can_open(Path(folder)):
        return
    before, after = parts[varied[0]].split("\0")
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return
    for there in names[: 10 * MOST_FILES]:
        value = there[len(before) : len(there) - len(after)]
        if not there.startswith((".", "_")) and value and there == before + value + after:
            file = "/".join((folder, there, *parts[varied[0] + 1 :]))
            if os.path.isfile(file):
                yield name, value, file


def _read_expressions(
    trees: Sequence[tuple[Element, Path]], finder: PackageFinder, seen: Mapping[str, _ArgumentUsage]
) -> None:
    """What expressions compare arguments with, under whatever name of a property or parameter of a macro they do."""
    scopes: dict[str, list[Element]] = {"": []}
    tables: dict[str, set[tuple[str, Path]]] = {}
    for tree, folder in trees:
        for element in tree.walk():
            scopes.setdefault(_find_enclosing_macro(element), []).append(element)
            if element.tag == "xacro:property":
                for a, b in _LOAD.findall(element.get("value")):
                    tables.setdefault(element.get("name"), set()).add((a or b, folder))
    aliases: dict[str, dict[str, set[str]]] = {"": {}}
    for _ in range(4):  # a parameter that is handed on, and on
        for scope, elements in scopes.items():
            here = {**aliases[""], **aliases.get(scope, {})}
            for element in elements:
                kind = element.tag.removeprefix("xacro:")
                if kind == "property":
                    for name in _find_passed_arguments(element.get("value"), here):
                        aliases.setdefault(scope, {}).setdefault(element.get("name"), set()).add(name)
                elif element.tag.startswith("xacro:") and kind not in _NOT_CALLS:
                    for attribute in element.attributes.values():
                        for name in _find_passed_arguments(attribute.value, here):
                            aliases.setdefault(kind, {}).setdefault(attribute.name, set()).add(name)
    for scope, elements in scopes.items():
        here = {**aliases[""], **aliases.get(scope, {})}
        for element in elements:
            for text in _list_texts(element):
                if "$" in text:
                    _read_element_text(text, element, bool(scope), here, seen, tables, finder)


def _find_enclosing_macro(element: Element) -> str:
    """The macro that an element stands in; empty outside of all."""
    around = element.parent
    while around is not None:
        if around.tag == "xacro:macro":
            return around.get("name").removeprefix("xacro:")
        around = around.parent
    return ""


def _find_passed_arguments(text: str, aliases: Mapping[str, set[str]]) -> set[str]:
    """The arguments that a value hands on as they are."""
    if "$" not in text or len(text) > MOST_CHARACTERS:
        return set()
    marked = _mark_arguments(EXPRESSION.sub(lambda m: m[1] or m[2], text), aliases)
    match = re.fullmatch(rf"\s*{_MARK}\s*", marked)
    return set(match[1].split("\0")) if match else set()


def _mark_arguments(text: str, aliases: Mapping[str, set[str]]) -> str:
    """The text with each argument, under whatever name, between two marks."""
    text = text.replace("\x01", "").replace("\x02", "")
    text = _REFERENCE.sub(lambda m: f"\x01{m[2] or m[3]}\x02", text)
    parts = re.split(r"(\x01[^\x02]*\x02)", text)
    return "".join(
        part if part.startswith("\x01") else _NAME.sub(lambda m: _mark_name(m[1], aliases), part) for part in parts
    )


def _mark_name(name: str, aliases: Mapping[str, set[str]]) -> str:
    meant = aliases.get(name)
    return f"\x01{chr(0).join(sorted(meant))}\x02" if meant else name


def _read_element_text(
    text: str,
    element: Element,
    in_macro: bool,
    aliases: Mapping[str, set[str]],
    seen: Mapping[str, _ArgumentUsage],
    tables: Mapping[str, set[tuple[str, Path]]],
    finder: PackageFinder,
) -> None:
    def add_value(arguments: str, value: str) -> None:
        for name in arguments.split("\0"):
            if name in seen:
                (seen[name].in_macros if in_macro else seen[name].values).setdefault(value)

    expressions = [
        _mark_arguments(typed, aliases) for a, b in EXPRESSION.findall(text) if len(typed := a or b) <= MOST_CHARACTERS
    ]
    for expression in expressions:
        for names, _, value in _COMPARED.findall(expression):
            add_value(names, value)
        for _, value, names in _COMPARING.findall(expression):
            add_value(names, value)
        for names, values in _AMONG.findall(expression):
            for _, value in _LITERAL.findall(values):
                add_value(names, value)
        for table, names in _INDEX.findall(expression):
            for file, folder in sorted(tables.get(table, ())):
                for key in _read_keys(file, folder, finder):
                    add_value(names, key)
    if element.tag in {"xacro:if", "xacro:unless"}:
        for expression in expressions or [_mark_arguments(text, {})]:
            for names in re.findall(_MARK, expression):
                for name in names.split("\0"):
                    if name in seen:
                        seen[name].in_condition = True


def _read_keys(text: str, folder: Path, finder: PackageFinder) -> list[str]:
    """The keys of a dictionary in a yaml file."""
    from urdfcheck.source.text.yaml import YamlReadError, parse_located_yaml

    path = _resolve_path(text, folder, finder)
    if path is None or "$" in path or not finder.can_open(Path(path)):
        return []
    try:
        found = parse_located_yaml(SourceFile.read(Path(path), format_path(Path(path))))
        return [] if found is None else [key.text for key, _ in found.entries]
    except (OSError, XmlError, YamlReadError):
        return []


def _list_texts(element: Element) -> list[str]:
    return [*(a.value for a in element.attributes.values()), element.text]
