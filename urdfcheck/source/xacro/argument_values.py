"""The values that a xacro's arguments can have, and sets of them that cover most of the variants of the robot.

Nothing is evaluated. The values come from the argument's declaration, from the literals that expressions compare it with, from
the keys of a yaml dictionary that it indexes, and from the files that a path with the argument in it can mean.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from itertools import combinations, product
from math import prod
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.handed_values import EXPRESSION
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, parse_xml
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS
from urdfcheck.source.xacro.ros_variables import KNOWN_VARIABLES, VARIABLE
from urdfcheck.system.observing.questions import read_variable

# Up to this number, every combination is a variant; beyond it, each value alone, and each pair of values in some variant.
MOST_COMBINATIONS = 32
# Limits on arguments and values that are varied, and on files that are read. Of a hundred robots, the one with most
# arguments has 79, of which 24 are switches.
MOST_ARGUMENTS, MOST_VALUES, MOST_FILES = 48, 16, 400
# Limit on the trees of included files that are kept.
_MOST_INCLUDED = 64
# The longest expression of published robots has 166 characters.
MOST_CHARACTERS = 2_000

_VARIABLE_READ = re.compile(r"""env[\s('"]+(\w+)""")

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
# The attributes with paths that the expansion reads.
_PATH_ATTRIBUTES = {"xacro:include": ("filename",), "xacro:arg": ("default",), "xacro:property": ("value", "default")}
# How many times a parameter is passed on to another macro.
_MAX_PASSED_ON = 4
# What begins a further word of a file name.
_SEPARATORS = ("_", "-", ".")
# xacro:call counts as a call: its attributes are parameters too.
_NOT_CALLS = BUILT_IN_TAGS - {"call"}


@dataclass(frozen=True, slots=True)
class ArgumentChoice:
    """An argument with the values that it may have, the default first; ``default`` is None if it has none."""

    name: str
    default: str | None
    values: tuple[str, ...]
    is_default_missing: bool = False
    """Whether files exist for the other values only: `robots/$(arg model)/…` without a folder of the default's name."""

    @property
    def existing_values(self) -> tuple[str, ...]:
        """The values, without a default that has no files."""
        return tuple(v for v in self.values if not (self.is_default_missing and v == self.default))


@dataclass(slots=True)
class _ArgumentUsage:
    """What the text says about one argument."""

    defaults: list[str | None] = field(default_factory=list)
    values: dict[str, None] = field(default_factory=dict)
    in_macros: dict[str, None] = field(default_factory=dict)
    """Values that are compared with a macro parameter to which the argument is passed."""
    in_condition: bool = False
    in_paths: set[str] = field(default_factory=set)
    """Values for which a file exists."""


def find_argument_choices(
    path: Path, finder: PackageFinder, included: dict[str, Element | None] | None = None
) -> list[ArgumentChoice]:
    """Return the arguments of a xacro that have more than one known value, in the order of their declarations.

    ``included``: see `read_included_trees`.
    """
    trees = read_included_trees(path, finder, included)
    variables = _find_variables(trees)
    usages = _find_arguments(trees)
    if not usages:
        return variables
    _ExpressionReader(trees, finder, usages).read()
    for tree, folder in trees:
        for element in tree.walk():
            for text in _list_paths(element):
                fitting = _list_path_values(text, folder, finder)
                for name, value, _ in (
                    _drop_misfits(fitting, trees, finder) if element.tag == "xacro:include" else fitting
                ):
                    if name in usages and not _is_rest_of_name(value, usages[name]):
                        usages[name].values[value] = None
                        usages[name].in_paths.add(value)
    choices = [_make_choice(name, usage) for name, usage in usages.items()]
    return variables + [choice for choice in choices if len(choice.values) > 1]


def _find_variables(trees: Sequence[tuple[Element, Path]]) -> list[ArgumentChoice]:
    """Return the variables of ROS by which a model may decide, as arguments; the first value is that of this environment."""
    texts = [
        text
        for tree, _ in trees
        for element in tree.walk()
        for text in _list_texts(element)
        if "env" in text and (element.tag.startswith("xacro:") or "${" in text or "$(eval" in text)
    ]
    names = {name for text in texts for name in _VARIABLE_READ.findall(text)}
    choices = []
    for name in sorted(names & KNOWN_VARIABLES.keys()):
        here = read_variable(name) or ""
        values = tuple(dict.fromkeys((here, *KNOWN_VARIABLES[name])))
        choices.append(ArgumentChoice(f"{VARIABLE}{name}", here, values))
    return choices


def _find_arguments(trees: Sequence[tuple[Element, Path]]) -> dict[str, _ArgumentUsage]:
    """Return the arguments that are declared, and then those that are only read: they need not be declared."""
    usages: dict[str, _ArgumentUsage] = {}
    for tree, _ in trees:
        for element in tree.walk():
            if element.tag == "xacro:arg" and element.get("name"):
                usage = usages.setdefault(element.get("name"), _ArgumentUsage())
                usage.defaults.append(element.get("default") if "default" in element.attributes else None)
    for tree, _ in trees:
        for element in tree.walk():
            for text in _list_texts(element):
                for name in _ARGUMENT_DEMAND.findall(text) if "$(arg" in text else ():
                    usages.setdefault(name, _ArgumentUsage())
    return usages


def _is_rest_of_name(value: str, usage: _ArgumentUsage) -> bool:
    """Whether a value that a file's name shows is a part of it: ``_gripper`` of ``xarm_gripper.yaml`` beside ``xarm6.yaml``."""
    return value.startswith(_SEPARATORS) and any(d and not d.startswith(_SEPARATORS) for d in usage.defaults)


def _list_paths(element: Element) -> list[str]:
    """Return the paths of an element as typed: of files that it includes, and of yaml files that it loads."""
    attributes = [element.get(name) for name in _PATH_ATTRIBUTES.get(element.tag, ())]
    loads = [a or b for text in _list_texts(element) if "load_yaml" in text for a, b in _LOAD.findall(text)]
    return [*filter(_is_file_name, attributes), *loads]


def _is_file_name(text: str) -> bool:
    return "/" in text or text.endswith((".xacro", ".urdf", ".yaml"))


def _make_choice(name: str, usage: _ArgumentUsage) -> ArgumentChoice:
    default = next((d for d in usage.defaults if d is not None), None)
    if default is not None:
        optional = _OPTIONAL.fullmatch(default.strip())
        default = (optional[1] if optional else default).strip()
    values = dict(usage.values)
    # A parameter that is compared with several values and never with the default may have been computed anew on the way.
    if not default or default in usage.in_macros or len(usage.in_macros) == 1:
        values.update(usage.in_macros)
    plain = (default or "").lower()
    if plain in {"true", "false"} or (default is None and usage.in_condition and not values):
        is_capitalized = (default or "")[:1].isupper()
        values = dict.fromkeys(word.capitalize() if is_capitalized else word for word in ("true", "false"))
    elif plain in {"0", "1"} and usage.in_condition and not values:
        values = dict.fromkeys(("1", "0"))
    if default is not None:
        values = {default: None, **values}
    is_missing = default is not None and bool(usage.in_paths) and default not in usage.in_paths
    return ArgumentChoice(name, default, tuple(values)[:MOST_VALUES], is_missing)


def build_argument_sets(choices: Sequence[ArgumentChoice]) -> list[dict[str, str]]:
    """Return sets of arguments, the smallest first; an argument with its default is left out.

    These are all combinations if they are few, else each value alone, and enough sets for each pair of values to be in one.
    """
    values = [c.values for c in choices]
    if prod(map(len, values)) <= MOST_COMBINATIONS:
        rows: list[tuple[str, ...]] = list(product(*values))
    else:
        base = tuple(v[0] for v in values)
        rows = [base]
        rows += [(*base[:i], v, *base[i + 1 :]) for i, known in enumerate(values) for v in known[1:]]
        rows += _cover_pairs(values, rows)
    sets = [{c.name: v for c, v in zip(choices, row, strict=True) if v != c.default} for row in dict.fromkeys(rows)]
    return sorted(sets, key=len)


def _cover_pairs(values: Sequence[Sequence[str]], rows: Sequence[tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """Yield rows so that, with those given, each pair of values is in a row; each row covers most of the pairs that are left."""
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


def read_included_trees(
    path: Path, finder: PackageFinder, included: dict[str, Element | None] | None = None
) -> list[tuple[Element, Path]]:
    """Return the file and all files that it can include, each with its folder.

    ``included``: the trees of included files by path, kept by who asks for many models, which mostly include the same ones.
    """
    trees: list[tuple[Element, Path]] = []
    queue, visited = [path.absolute()], set[str]()
    while queue and len(visited) < MOST_FILES:
        file = queue.pop(0)
        real = os.path.realpath(file)
        if real in visited or not finder.can_open(file):
            continue
        visited.add(real)
        place = str(file)
        tree = included[place] if included is not None and place in included else _read_tree(file)
        if included is not None and trees and len(included) < _MOST_INCLUDED:
            included[place] = tree
        if tree is None:
            continue
        trees.append((tree, file.parent))
        for element in tree.walk():
            if element.tag == "xacro:include":
                queue += _find_included_files(element.get("filename"), file.parent, finder)
    return trees


def _read_tree(file: Path) -> Element | None:
    try:
        return parse_xml(SourceFile.read(file, format_path(file)))
    except (OSError, XmlError):
        return None


def _resolve_path(text: str, folder: Path, finder: PackageFinder) -> str | None:
    """Return a path as typed with its packages looked up; None if one is not found."""
    if len(text) > MOST_CHARACTERS:
        return None
    packages = {name: finder.find(name) for name in _FIND.findall(text)}
    if None in packages.values():
        return None
    text = _FIND.sub(lambda m: str(packages[m[1]]), text)
    text = text.replace("$(dirname)", str(folder))
    return text if os.path.isabs(text) else str(folder / text)


def _find_included_files(text: str, folder: Path, finder: PackageFinder) -> list[Path]:
    """Return the files that an include may mean: one, or if the path contains an argument, each that fits."""
    path = _resolve_path(text, folder, finder)
    if path is None:
        return []
    if "$" not in path:
        return [finder.find_source(Path(path))]
    return [Path(file) for _, _, file in _iter_fitting_files(path, finder)]


def _list_path_values(text: str, folder: Path, finder: PackageFinder) -> list[tuple[str, str, str]]:
    """Return argument, value and file for each value with which a path leads to a file."""
    path = _resolve_path(text, folder, finder)
    return [] if path is None else list(_iter_fitting_files(path, finder))


def _drop_misfits(
    fitting: Sequence[tuple[str, str, str]], trees: Sequence[tuple[Element, Path]], finder: PackageFinder
) -> list[tuple[str, str, str]]:
    """Return the files of an include with an argument without those that lack a macro which the model calls in any case.

    ``ros2_control/$(arg type).xacro`` finds the files of all robots of a package, and each robot calls its own macro.
    """
    candidates = {format_path(Path(file)) for _, _, file in fitting}
    defined = {_get_file(tree): _list_macros(tree) for tree, _ in trees if _get_file(tree) in candidates}
    chosen = candidates - _list_plain_includes(trees, finder)
    outside = [tree for tree, _ in trees if _get_file(tree) not in chosen]
    called = {
        element.tag.removeprefix("xacro:")
        for tree in outside
        for element in tree.walk()
        if element.tag.startswith("xacro:") and not _depends_on_condition(element)
    }
    needed = called.difference(*map(_list_macros, outside)).intersection(set().union(*defined.values()))
    able = [found for found in fitting if needed <= defined.get(format_path(Path(found[2])), set())]
    return able or list(fitting)


def _list_plain_includes(trees: Sequence[tuple[Element, Path]], finder: PackageFinder) -> set[str]:
    """Return the files that includes name without an argument."""
    elements = (
        (element, folder) for tree, folder in trees for element in tree.walk() if element.tag == "xacro:include"
    )
    paths = (_resolve_path(element.get("filename"), folder, finder) for element, folder in elements)
    return {format_path(Path(path)) for path in paths if path is not None and "$" not in path}


def _get_file(tree: Element) -> str:
    return "" if tree.span is None else tree.span.file


def _list_macros(tree: Element) -> set[str]:
    macros = (element.get("name") for element in tree.walk() if element.tag == "xacro:macro")
    return {name.removeprefix("xacro:") for name in macros}


def _depends_on_condition(element: Element) -> bool:
    """Whether an element is in a condition, or in a macro, which may never be called."""
    around = element.parent
    while around is not None:
        if around.tag in {"xacro:if", "xacro:unless", "xacro:macro"}:
            return True
        around = around.parent
    return False


def _iter_fitting_files(path: str, finder: PackageFinder) -> Iterator[tuple[str, str, str]]:
    """Yield argument, value and file for each value that leads to a file; the path has one argument, in one of its names."""
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
    for entry in names[: 10 * MOST_FILES]:
        value = entry[len(before) : len(entry) - len(after)]
        if not entry.startswith((".", "_")) and value and entry == before + value + after:
            file = "/".join((folder, entry, *parts[varied[0] + 1 :]))
            if os.path.isfile(file):
                yield name, value, file


class _ExpressionReader:
    """Finds the values that expressions compare arguments with, under the names of properties and macro parameters too."""

    def __init__(
        self, trees: Sequence[tuple[Element, Path]], finder: PackageFinder, usages: Mapping[str, _ArgumentUsage]
    ) -> None:
        self.finder = finder
        self.usages = usages
        # Elements by the macro that they are in, "" outside of macros.
        self.scopes: dict[str, list[Element]] = {"": []}
        # Properties that are loaded from yaml, with each path as typed and the folder of the file that names it.
        self.tables: dict[str, set[tuple[str, Path]]] = {}
        # By macro, the arguments whose value a property or parameter has.
        self.aliases: dict[str, dict[str, set[str]]] = {"": {}}
        for tree, folder in trees:
            for element in tree.walk():
                self.scopes.setdefault(_find_enclosing_macro(element), []).append(element)
                if element.tag == "xacro:property":
                    for a, b in _LOAD.findall(element.get("value")):
                        self.tables.setdefault(element.get("name"), set()).add((a or b, folder))

    def read(self) -> None:
        """Add the values to the usages."""
        for _ in range(_MAX_PASSED_ON):
            for scope, elements in self.scopes.items():
                visible = self.get_visible_aliases(scope)
                for element in elements:
                    self.add_aliases(element, scope, visible)
        for scope, elements in self.scopes.items():
            visible = self.get_visible_aliases(scope)
            for element in elements:
                for text in _list_texts(element):
                    if "$" in text:
                        self.read_text(text, element, visible, in_macro=bool(scope))

    def get_visible_aliases(self, scope: str) -> dict[str, set[str]]:
        """Return the aliases that are known in a macro."""
        return {**self.aliases[""], **self.aliases.get(scope, {})}

    def add_aliases(self, element: Element, scope: str, visible: Mapping[str, set[str]]) -> None:
        """Note the property that an element defines as an argument, or the parameters to which it passes arguments."""
        tag = element.tag.removeprefix("xacro:")
        if tag == "property":
            passed = [(scope, element.get("name"), element.get("value"))]
        elif element.tag.startswith("xacro:") and tag not in _NOT_CALLS:
            passed = [(tag, attribute.name, attribute.value) for attribute in element.attributes.values()]
        else:
            return
        for macro, name, value in passed:
            for argument in _find_passed_arguments(value, visible):
                self.aliases.setdefault(macro, {}).setdefault(name, set()).add(argument)

    def read_text(self, text: str, element: Element, aliases: Mapping[str, set[str]], *, in_macro: bool) -> None:
        """Add the values that the expressions of a text compare arguments with."""
        typed = [a or b for a, b in EXPRESSION.findall(text)]
        expressions = [
            _mark_arguments(expression, aliases) for expression in typed if len(expression) <= MOST_CHARACTERS
        ]
        for expression in expressions:
            for names, value in self.iter_compared_values(expression):
                for usage in self.list_usages(names):
                    (usage.in_macros if in_macro else usage.values).setdefault(value)
        if element.tag in {"xacro:if", "xacro:unless"}:
            for expression in expressions or [_mark_arguments(text, {})]:
                for names in re.findall(_MARK, expression):
                    for usage in self.list_usages(names):
                        usage.in_condition = True

    def iter_compared_values(self, expression: str) -> Iterator[tuple[str, str]]:
        """Yield the names of arguments, as a mark holds them, and a value that they are compared with."""
        yield from ((names, value) for names, _, value in _COMPARED.findall(expression))
        yield from ((names, value) for _, value, names in _COMPARING.findall(expression))
        for names, values in _AMONG.findall(expression):
            yield from ((names, value) for _, value in _LITERAL.findall(values))
        for table, names in _INDEX.findall(expression):
            for file, folder in sorted(self.tables.get(table, ())):
                yield from ((names, key) for key in _read_keys(file, folder, self.finder))

    def list_usages(self, names: str) -> list[_ArgumentUsage]:
        """Return the usages of the arguments that a mark holds."""
        return [self.usages[name] for name in names.split("\0") if name in self.usages]


def _find_enclosing_macro(element: Element) -> str:
    """Return the macro that an element is in; empty outside macros."""
    around = element.parent
    while around is not None:
        if around.tag == "xacro:macro":
            return around.get("name").removeprefix("xacro:")
        around = around.parent
    return ""


def _find_passed_arguments(text: str, aliases: Mapping[str, set[str]]) -> set[str]:
    """Return the arguments that a value passes on unchanged."""
    if "$" not in text or len(text) > MOST_CHARACTERS:
        return set()
    marked = _mark_arguments(EXPRESSION.sub(lambda m: m[1] or m[2], text), aliases)
    match = re.fullmatch(rf"\s*{_MARK}\s*", marked)
    return set(match[1].split("\0")) if match else set()


def _mark_arguments(text: str, aliases: Mapping[str, set[str]]) -> str:
    """Return the text with each argument, under any of its names, between two marks."""
    text = text.replace("\x01", "").replace("\x02", "")
    text = _REFERENCE.sub(lambda m: f"\x01{m[2] or m[3]}\x02", text)
    parts = re.split(r"(\x01[^\x02]*\x02)", text)
    return "".join(
        part if part.startswith("\x01") else _NAME.sub(lambda m: _mark_name(m[1], aliases), part) for part in parts
    )


def _mark_name(name: str, aliases: Mapping[str, set[str]]) -> str:
    arguments = aliases.get(name)
    return f"\x01{chr(0).join(sorted(arguments))}\x02" if arguments else name


def _read_keys(text: str, folder: Path, finder: PackageFinder) -> list[str]:
    """Return the keys of the dictionary in a yaml file."""
    from urdfcheck.source.text.yaml.reader import parse_located_yaml
    from urdfcheck.source.text.yaml.values import YamlReadError

    path = _resolve_path(text, folder, finder)
    if path is None or "$" in path or not finder.can_open(Path(path)):
        return []
    try:
        content = parse_located_yaml(SourceFile.read(Path(path), format_path(Path(path)), declares=False))
        return [] if content is None else [key.text for key, _ in content.entries]
    except (OSError, XmlError, YamlReadError):
        return []


def _list_texts(element: Element) -> list[str]:
    return [*(a.value for a in element.attributes.values()), element.text]
