"""The definitions and reads in xacro files as typed: without expansion, and therefore in every file and branch."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.grammar import CHILDREN
from urdfcheck.source.text.handed_values import EXPRESSION
from urdfcheck.source.text.remembered import tree_fact
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.expressions.compile_expression import find_names
from urdfcheck.source.xacro.file_contents import BUILT_IN_TAGS
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter

# Tags of URDF itself: they do not call a macro, though a macro may have the name.
_URDF_TAGS = frozenset().union(*CHILDREN.values(), CHILDREN)
# The attributes that each of xacro's own tags requires, by which a tag without the prefix is recognised.
_REQUIRED_BY_TAG: Mapping[str, frozenset[str]] = {
    "macro": frozenset({"name"}),
    "include": frozenset({"filename"}),
    "property": frozenset({"name"}),
    "arg": frozenset({"name", "default"}),
    "if": frozenset({"value"}),
    "unless": frozenset({"value"}),
    "insert_block": frozenset({"name"}),
}
# Stands for the tags of what a file does not show.
ANY_TAG = "*"
# Tags of a package's manifest, with which early models name their authors.
_MANIFEST_TAGS = frozenset({"author", "description", "license", "maintainer", "review", "url", "version"})
# Elements of other parsers than URDF's: a tag inside them may mean something else.
_FOREIGN_TAGS = frozenset({"gazebo", "transmission", "ros2_control", "sensor", "plugin", "mujoco", "cad"})

# None of these patterns searches to the end of the text from each of many places: the next opening bracket ends the search.
FORWARDED = re.compile(r"""(?<![^\s:="'])([^\s:="']+)\s*:?=\s*\^""")
ARGUMENT = re.compile(r"\$\(arg\s+([^\s()]+)\s*\)")
# The same with a computed name, `$(arg tof_${index}_xyz)`: xacro evaluates the name first. And what is computed in it.
_COMPUTED_ARGUMENT = re.compile(
    r"\$\(arg\s+((?:[^\s(){}$]|\$\{[^{}]*\})*\$\{[^{}]*\}(?:[^\s(){}$]|\$\{[^{}]*\})*)\s*\)"
)
_COMPUTED_PART = re.compile(r"\$\{[^{}]*\}")
_PARAMETER = re.compile(r"\$\{\s*(\w+)\s*\}")
# What is computed in a name, in whichever notation.
_COMPUTED = re.compile(r"\$\{[^{}]*\}|\$\([^()]*\)")
_RENAMING = "write another name, also where it is used"
# A macro may call another one many times, and that yet another: so many different calls are followed.
_MOST_CALLS = 1_000
_CONDITIONS = {"xacro:if": "if", "xacro:unless": "unless"}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Macro:
    """A ``<xacro:macro>``."""

    element: Element
    name: str
    parameters: tuple[str, ...]
    """Names without the asterisks of blocks."""
    optional: frozenset[str]
    """Parameters with a default."""
    blocks: frozenset[str]
    """Parameters that are elements."""


def iter_elements_by_tag(trees: Mapping[str, Element], tag: str) -> Iterator[Element]:
    """Yield every element with this tag, file by file in document order."""
    for tree in trees.values():
        yield from _group_by_tag(tree).get(tag, ())


def read_argument_defaults(trees: Mapping[str, Element]) -> dict[str, str]:
    """Return the defaults of a model's arguments, as typed: of several, xacro takes the first."""
    found: dict[str, str] = {}
    for declared in iter_elements_by_tag(trees, "xacro:arg"):
        if "default" in declared.attributes:
            found.setdefault(declared.get("name"), declared.get("default"))
    return found


@tree_fact
def _group_by_tag(tree: Element) -> dict[str, list[Element]]:
    groups: dict[str, list[Element]] = {}
    for element in tree.walk():
        groups.setdefault(element.tag, []).append(element)
    return groups


def collect_properties(trees: Mapping[str, Element]) -> dict[str, list[Attribute]]:
    """Return the name attribute of each property definition, by name; computed names and removals are left out."""
    properties: dict[str, list[Attribute]] = {}
    for element in iter_elements_by_tag(trees, "xacro:property"):
        name = element.attributes.get("name")
        if name is not None and name.literal and "remove" not in element.attributes:
            properties.setdefault(name.value, []).append(name)
    return properties


def collect_macros(trees: Mapping[str, Element]) -> dict[str, Macro]:
    """Return the macros by name; the last definition of a name counts."""
    return {name: definitions[-1] for name, definitions in _collect_definitions(trees).items()}


def _collect_definitions(trees: Mapping[str, Element]) -> dict[str, list[Macro]]:
    """Return all definitions of each macro."""
    macros: dict[str, list[Macro]] = {}
    for tree in trees.values():
        for macro in _list_macros(tree):
            macros.setdefault(macro.name, []).append(macro)
    return macros


@tree_fact
def _list_macros(tree: Element) -> list[Macro]:
    return [read_macro(element) for element in _group_by_tag(tree).get("xacro:macro", ())]


def read_macro(element: Element) -> Macro:
    """Read the definition of a macro, whether or not its tag has xacro's prefix."""
    parameters, optional, blocks, rest = [], set(), set(), element.get("params")
    while rest.strip():
        parameter, default, rest = parse_next_parameter(rest)
        parameters.append(parameter.lstrip("*"))
        optional |= {parameter} if default is not None else set()
        blocks |= {parameter.lstrip("*")} if parameter.startswith("*") else set()
    return Macro(
        element=element,
        name=element.get("name").removeprefix("xacro:"),
        parameters=tuple(parameters),
        optional=frozenset(optional),
        blocks=frozenset(blocks),
    )


def find_typed(trees: Mapping[str, Element], element: Element) -> Element | None:
    """Return an element of the robot as its file has it."""
    tree = None if element.span is None else trees.get(element.span.file)
    return None if tree is None else _index_by_span(tree).get(element.span)


def is_inserted(trees: Mapping[str, Element], parent: Element, child: Element) -> bool:
    """Whether ``<xacro:insert_block>`` brings an element of the robot into its parent: it is typed neither there nor in a macro
    that is called there."""
    typed = find_typed(trees, parent)
    if child.span is None or (typed is not None and any(child.span == each.span for each in typed.walk())):
        return False
    return child.via[: len(parent.via)] != parent.via or len(child.via) == len(parent.via)


@tree_fact
def _index_by_span(tree: Element) -> dict[Span | None, Element]:
    return {element.span: element for element in tree.walk()}


@tree_fact
def collect_read_names(tree: Element) -> frozenset[str]:
    """Return every name that an expression, an inserted block or a forwarding default of a file mentions."""
    names: set[str] = set()
    for element in tree.walk():
        if element.tag == "xacro:insert_block":
            names.add(element.get("name"))
        for attribute in element.attributes.values():
            if element.tag == "xacro:macro" and attribute.name == "params":
                names.update(FORWARDED.findall(attribute.value))
            names |= find_expression_names(attribute.value)
        names |= find_expression_names(element.text)
    return frozenset(names)


def collect_called_macros(trees: Mapping[str, Element]) -> set[str]:
    """Return the macros that are called outside their own definition, without namespace; a computed name as typed."""
    return set().union(*map(_collect_calls, trees.values())) - BUILT_IN_TAGS


@tree_fact
def _collect_calls(tree: Element) -> frozenset[str]:
    called: set[str] = set()
    inside: list[tuple[Element, frozenset[str]]] = [(tree, frozenset())]
    while inside:
        element, macros_around = inside.pop()
        name = element.get("macro") if element.tag == "xacro:call" else element.tag.removeprefix("xacro:")
        if element.tag.startswith("xacro:") and strip_namespace(name) not in macros_around:
            called.add(strip_namespace(name))
        if element.tag == "xacro:macro":
            macros_around |= {strip_namespace(element.get("name"))}
        inside += [(child, macros_around) for child in element.children]
    return frozenset(called)


def collect_read_arguments(trees: Mapping[str, Element]) -> set[str]:
    """Return the arguments that are read by ``$(arg name)`` or by an expression that mentions the name."""
    return set().union(*map(collect_read_names, trees.values()), *map(_collect_substituted, trees.values()))


@tree_fact
def _collect_substituted(tree: Element) -> frozenset[str]:
    texts = (text for e in tree.walk() for text in (*(a.value for a in e.attributes.values()), e.text) if "$" in text)
    return frozenset(name for text in texts for name in ARGUMENT.findall(text))


def collect_computed_arguments(trees: Mapping[str, Element]) -> set[str]:
    """Return the names of arguments that are computed where they are read, as typed: ``tof_${index}_xyz``."""
    return set().union(*map(_collect_computed, trees.values()))


@tree_fact
def _collect_computed(tree: Element) -> frozenset[str]:
    texts = (text for e in tree.walk() for text in (*(a.value for a in e.attributes.values()), e.text) if "$" in text)
    return frozenset(name for text in texts for name in find_computed_arguments(text))


def find_computed_arguments(text: str) -> list[str]:
    """Return the names of the arguments that a text reads and whose names it computes, as typed."""
    return _COMPUTED_ARGUMENT.findall(text) if "$(arg" in text else []


def list_content_arguments(trees: Mapping[str, Element], element: Element) -> list[str]:
    """List the arguments of which the text in an element of the robot is made, also by the properties and the calls that hand
    them on."""
    typed = find_typed(trees, element)
    texts = [] if typed is None else [typed.text]
    calls = {span: tree for span in element.via if (tree := trees.get(span.file)) is not None}
    given = [call for span, tree in calls.items() if (call := _index_by_span(tree).get(span)) is not None]
    properties = list(iter_elements_by_tag(trees, "xacro:property"))
    seen: set[str] = set()
    found: dict[str, None] = {}
    while texts:
        text = texts.pop()
        found |= dict.fromkeys(ARGUMENT.findall(text))
        names = set(_PARAMETER.findall(text)) - seen
        seen |= names
        texts += [call.get(name) for call in given for name in names]
        texts += [each.get("value") for each in properties if each.get("name") in names]
    return list(found)


def may_be_name(typed: str, name: str) -> bool:
    """Whether a name that is computed, as typed, may be this one."""
    pattern = ".*".join(map(re.escape, _COMPUTED_PART.split(typed)))
    return re.fullmatch(pattern, name) is not None


def find_unprefixed_tags(
    trees: Mapping[str, Element], robot: Element | None = None, *, only_calls: bool = False
) -> list[Element]:
    """Return the elements that only lack the prefix to be xacro's own or a macro call: xacro leaves them as they are.

    ``robot``: the expanded root, to find what is left of them there instead of in the files as typed. ``only_calls``: leave
    out xacro's own.
    """
    calls = {name: macros for name, macros in _collect_definitions(trees).items() if name not in _URDF_TAGS}
    wanted = {*calls, *(() if only_calls else _REQUIRED_BY_TAG)}
    unprefixed: list[Element] = []
    for tree in trees.values() if robot is None else [robot]:
        below = [] if wanted.isdisjoint(_group_by_tag(tree)) else [tree]
        while below:
            element = below.pop()
            if element.tag in _FOREIGN_TAGS:
                continue
            below += reversed(element.children)
            if (not only_calls and _is_builtin(element)) or any(
                _is_call(element, macro) for macro in calls.get(element.tag, ())
            ):
                unprefixed.append(element)
    return unprefixed


def collect_lost_tags(trees: Mapping[str, Element], element: Element) -> set[str]:
    """Return the tags that an expanded element lacks because what would put them there lacks the prefix: calls, conditions and
    inserted blocks directly in it. ``ANY_TAG`` stands for what is not known."""
    macros, lost = collect_macros(trees), set[str]()
    for tag in find_unprefixed_tags(trees, element):
        if tag.parent is not element:
            continue
        if tag.tag == "insert_block":
            lost |= _find_block_tags(trees, tag)
        elif tag.tag in {"if", "unless"}:
            lost.update(inner.tag for child in tag.children for inner in child.walk())
        elif tag.tag == "include":
            lost.add(ANY_TAG)
        elif tag.tag not in _REQUIRED_BY_TAG:
            lost.update(inner.tag for inner in macros[tag.tag].element.walk())
    return lost


def _find_block_tags(trees: Mapping[str, Element], block: Element) -> set[str]:
    """Return the tags of what the call gives for a block; ``ANY_TAG`` where that is not typed in the call."""
    place = block.via[-1] if block.via else None
    typed = trees[place.file].walk() if place is not None and place.file in trees else ()
    call = next((e for e in typed if e.span is not None and e.span.start == place.start), None) if place else None
    macro = None if call is None else collect_macros(trees).get(strip_namespace(call.tag))
    name = block.get("name")
    if call is None or macro is None or name not in macro.blocks:
        return {ANY_TAG}
    number = [parameter for parameter in macro.parameters if parameter in macro.blocks].index(name)
    given = call.children[: number + 1]
    if len(given) <= number or any(e.tag.startswith("xacro:") for e in given):
        return {ANY_TAG}
    is_content = f"**{name}" in macro.element.get("params").split()
    tags = {e.tag for e in given[number].children} if is_content else {given[number].tag}
    return {ANY_TAG if tag.startswith("xacro:") else tag for tag in tags}


def defines_itself(element: Element) -> bool:
    """Whether the value of a property reads the name that it defines: with the prefix of xacro it is a circle."""
    return element.tag.endswith("property") and element.get("name") in find_expression_names(element.get("value"))


def explain_refusal(element: Element) -> tuple[str, str] | None:
    """Return why xacro stops at a definition with its prefix, whatever the files hold, and what must be done; None where it does
    not.

    Arguments may have any name.
    """
    kind, name = element.tag.removeprefix("xacro:"), element.get("name")
    if kind == "macro" and name == "call":
        return "no macro may have the name `call`", _RENAMING
    if kind == "macro" and "." in name:
        return "the name of a macro must not contain a dot", _RENAMING
    if kind != "property":
        return None
    if not name:
        return "its name is empty", "give it a name"
    known = _COMPUTED.sub("x", name)
    if not known.isidentifier() or keyword.iskeyword(known) or known.startswith("__"):
        return "the name of a property must be a Python identifier, without `__` before it", _RENAMING
    given = [key for key in ("value", "default", "remove") if key in element.attributes]
    return (f"a property has either {given[0]} or {given[1]}", "keep one of the two") if len(given) > 1 else None


def list_strange_tags(tree: Element) -> list[str]:
    """Return the tags directly in a root that no parser of robots knows: calls of macros in other files may lack the prefix.

    What a file says about its author and its license, in the tags of a package's manifest, calls nothing.
    """
    known = _URDF_TAGS | _FOREIGN_TAGS | _MANIFEST_TAGS | _REQUIRED_BY_TAG.keys()
    return list(dict.fromkeys(e.tag for e in tree.children if ":" not in e.tag and e.tag not in known))


def _is_builtin(element: Element) -> bool:
    needed = _REQUIRED_BY_TAG.get(element.tag)
    return needed is not None and needed <= element.attributes.keys()


def collect_uncalled_links(trees: Mapping[str, Element], robot: Element) -> set[str]:
    """Return the names of the links that the calls left in the robot would make with their prefix, themselves and through the
    macros that they call: as patterns, with ``*`` for what is computed."""
    macros = collect_macros(trees)
    left = [
        (call.tag, {n: a.value for n, a in call.attributes.items()})
        for call in find_unprefixed_tags(trees, robot, only_calls=True)
    ]
    names, visited = set[str](), set[str]()
    while left:
        tag, given = left.pop()
        macro = macros.get(tag)
        if macro is None or (key := f"{tag} {sorted(given.items())}") in visited or len(visited) > _MOST_CALLS:
            continue
        visited.add(key)
        for made in macro.element.walk():
            if made.tag == "link":
                names.add(_fill_in(made.get("name"), given))
            elif made is not macro.element:
                left.append(
                    (made.tag.removeprefix("xacro:"), {n: _fill_in(a.value, given) for n, a in made.attributes.items()})
                )
    return names


def _fill_in(text: str, given: Mapping[str, str]) -> str:
    """Return a text with the values of parameters, and ``*`` for every other expression."""
    filled = _PARAMETER.sub(lambda match: given.get(match[1], "*"), text)
    return EXPRESSION.sub("*", filled)


def _is_call(element: Element, macro: Macro) -> bool:
    if element.parent is None or element.tag in _REQUIRED_BY_TAG:
        return False
    given = element.attributes.keys()
    return set(macro.parameters) - macro.optional <= {*given, *macro.blocks} and given <= set(macro.parameters)


def strip_namespace(name: str) -> str:
    """Return a macro's name without the namespace that an include gave it."""
    return name if "$" in name else name.removeprefix("xacro:").rpartition(".")[2]


def find_expression_names(text: str) -> set[str]:
    """Return every identifier in the expressions of a text."""
    if "$" not in text:
        return set()
    return {name for match in EXPRESSION.finditer(text) for name in find_names(match.group(1) or match.group(2) or "")}


@dataclass(frozen=True, slots=True, eq=False)
class Condition:
    """The ``<xacro:if>`` or ``<xacro:unless>`` nearest around a definition."""

    element: Element

    def __str__(self) -> str:
        return f"{_CONDITIONS[self.element.tag]} `{self.element.get('value').strip()}`"


def find_conditions(
    trees: Mapping[str, Element], name: str, place: Span | None, tag: str = "xacro:property"
) -> tuple[Condition, ...]:
    """Return the conditions under which a property, or a macro, is defined; empty if one of its definitions has none.

    :param place: where the property is missing; what is defined around it or after it has another cause.
    """
    found: dict[str, Condition] = {}
    for definition in iter_elements_by_tag(trees, tag):
        if definition.get("name") != name or "remove" in definition.attributes:
            continue
        element = _find_condition_element(definition)
        if element is None or _ends_after(element, place):
            return ()
        condition = Condition(element)
        found.setdefault(str(condition), condition)
    return tuple(found.values())


def list_condition_arguments(trees: Mapping[str, Element], conditions: Iterable[Condition]) -> tuple[str, ...]:
    """Return the arguments that conditions read, in the order in which they are met.

    They read them themselves, or by way of properties and of parameters of the macros around the conditions.
    """
    conditions, found = tuple(conditions), dict[str, None]()
    texts, seen = [condition.element.get("value") for condition in conditions], set[str]()
    while texts:
        text = texts.pop(0)
        found.update(dict.fromkeys(ARGUMENT.findall(text)))
        for name in _iter_names(text):
            if name not in seen:
                seen.add(name)
                definitions = (e for e in iter_elements_by_tag(trees, "xacro:property") if e.get("name") == name)
                texts += [definition.get("value") for definition in definitions]
                texts += _list_given_values(trees, conditions, name)
    return tuple(found)


def _list_given_values(trees: Mapping[str, Element], conditions: Iterable[Condition], name: str) -> list[str]:
    """Return what calls give a parameter of the macros around conditions."""
    macros = set()
    for condition in conditions:
        element = condition.element.parent
        while element is not None and element.tag != "xacro:macro":
            element = element.parent
        macros |= set() if element is None else {element.get("name").removeprefix("xacro:")}
    return [call.get(name) for macro in sorted(macros) for call in iter_elements_by_tag(trees, f"xacro:{macro}")]


def collect_definitions(trees: Mapping[str, Element]) -> dict[str, list[Element]]:
    """Return what gives each name of properties and arguments its value, as far as the names are typed."""
    found: dict[str, list[Element]] = {}
    for tag in ("xacro:property", "xacro:arg"):
        for element in iter_elements_by_tag(trees, tag):
            found.setdefault(element.get("name"), []).append(element)
    return found


def list_definitions(definitions: Mapping[str, Sequence[Element]], text: str) -> list[Element]:
    """Return those of some definitions that a text reads, itself or by way of others, in the order in which they are met."""
    found: list[Element] = []
    texts, seen = [text], set[str]()
    while texts:
        text = texts.pop(0)
        for name in (*_iter_names(text), *ARGUMENT.findall(text)):
            if name not in seen:
                seen.add(name)
                met = definitions.get(name, ())
                found += met
                texts += [element.get(value) for element in met for value in ("value", "default")]
    return found


def _iter_names(text: str) -> Iterator[str]:
    for match in EXPRESSION.finditer(text):
        yield from sorted(find_names(match[1] or match[2]))


def _find_condition_element(definition: Element) -> Element | None:
    """Return the condition nearest around a definition, in the same macro."""
    element = definition.parent
    while element is not None and element.tag != "xacro:macro":
        if element.tag in _CONDITIONS:
            return element
        element = element.parent
    return None


def _ends_after(element: Element, place: Span | None) -> bool:
    """Whether an element holds a place or follows it: then the condition is not why nothing is defined there."""
    lines = [child.span.line for child in element.walk() if child.span is not None]
    if place is None or element.span is None or not lines:
        return True
    return element.span.file == place.file and place.line <= max(lines)
