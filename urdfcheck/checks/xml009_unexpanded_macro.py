"""XML009 reports xacro that remains unexpanded."""

from __future__ import annotations

import builtins
import keyword
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.core.text import format_count, join_names, truncate_text
from urdfcheck.source.load import Source, has_unbound_xacro
from urdfcheck.source.text.engine_reactions import describe_missing_mesh
from urdfcheck.source.text.grammar import NUMERIC_ATTRIBUTES, SUBSTITUTION, is_unexpanded, iter_urdf_elements
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import find_includer_of_namesake

# The reactions of Drake, Bullet and yourdfpy to the file, by whether a number is missing in it.
CONSEQUENCES = {
    False: {"drake": "loads it", "bullet": "loads it", "yourdfpy": "loads it"},
    True: {
        "drake": "refuses the file",
        "yourdfpy": "refuses the file",
        "bullet": "replaces the number by 0, or refuses the file",
    },
}


_DECLARING = "declare `xmlns:xacro` in the root element and "
_RUNNING_XACRO = (
    'load what xacro makes of it (ROS 1: `command="xacro …"` instead of `textfile`; '
    "ROS 2: `Command(['xacro ', path])`)"
)
# A path of a mesh or texture in a package, which every program of ROS finds as package:// too.
_RESOURCE = re.compile(r"((?:file://)?\$\(find ([\w.-]+)\))/[^$]*")
_ARGUMENT = re.compile(r"\$\(arg ([\w.-]+)\)")
# No other one is in it: without that, the end of each of many that nothing closes would be searched anew.
_EXPRESSION = re.compile(r"(?<!\$)\$\{([^$}]*(?:\$(?!\{)[^$}]*)*)\}")
_QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")
# A name in an expression, which is neither an attribute nor an exponent.
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
# What an expression of xacro knows without a property.
_KNOWN_NAMES = frozenset({*dir(builtins), *dir(math), "xacro", "radians", "degrees", "true", "false"})
# What xacro reads and writes nothing for.
_DEFINITIONS = frozenset({"<xacro:arg>", "<xacro:macro>", "<xacro:property>"})


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    root = source.root
    if root is None or root.tag != "robot":
        return
    if source.is_xacro:
        names = _find_harmless_names(root)
        for element in iter_urdf_elements(root):
            for where, text, number in _find_unexpanded_xacro(element):
                if where in names:
                    yield _build_names_finding(rule, where, text, "1 substitution of xacro")
                    continue
                consequences = _predict_consequences([element], is_number_missing=number)
                yield rule.finding("left", at=where, consequences=consequences, text=_shorten_expression(text))
        return
    if has_unbound_xacro(source):
        return  # XML001: xacro cannot read it either
    in_gazebo = {id(inner) for block in root.find_children("gazebo") for inner in block.walk()}
    read, unread = (
        [
            place
            for element in root.walk()
            if (id(element) in in_gazebo) == inside
            for place in _find_unexpanded_xacro(element)
        ]
        for inside in (False, True)
    )
    if read or unread:
        yield _build_plain_finding(source, root, rule, [*read, *unread], has_read=bool(read))


def _build_plain_finding(
    source: Source, root: Element, rule: Rule, left: list[tuple[Location, str, bool]], *, has_read: bool
) -> Finding:
    """Report all xacro of a plain URDF together; as a note if the launch files of its package replace all of it.

    :param has_read: whether URDF parsers read some of it: they ignore what is in <gazebo>.
    """
    from urdfcheck.source.launch.passed_arguments import find_replaced_texts, is_handed_as_it_is  # few models need it

    replaced = find_replaced_texts(source.path, source.finder)
    remaining = [place for place in left if not _is_replaced(place[1], replaced)]
    tags = sum(text.startswith("<") for _, text, _ in remaining or left)
    # One attribute may hold several.
    substitutions = sum(_count_substitutions(text) for _, text, _ in remaining or left)
    counts = ((tags, "xacro element"), (substitutions, "substitution"))
    held = " and ".join(format_count(count, what) for count, what in counts if count)
    contents = held + (" of xacro" if counts[1][0] else "")
    where, text, _ = (remaining or left)[0]
    texts = [text for _, text, _ in remaining]
    if remaining and _is_left_over(source, texts):
        return rule.finding("leftover", at=where, severity=Severity.INFO, text=text, held=held)
    if remaining and _find_harmless_names(root).issuperset(place for place, *_ in remaining):
        return _build_names_finding(rule, where, text, contents)
    report = partial(rule.finding, at=where, text=_shorten_expression(text), held=held, contents=contents)
    is_handed = bool(remaining) and is_handed_as_it_is(source.path, source.finder)
    if remaining and has_read and source.is_part and not is_handed:
        return report(
            "included",
            severity=Severity.INFO,
            consequences=_predict_mesh_consequences(iter_urdf_elements(root)),
            repair=_describe_repair(source, texts),
        )
    if remaining and not has_read:
        handed = [place for plugin in root.walk() if plugin.tag == "plugin" for place in _find_all_unexpanded(plugin)]
        is_lost = is_handed or (not source.is_part and _find_undefined_name(texts) is not None)
        return report(
            "gazebo",
            severity=Severity.WARNING if is_lost else Severity.INFO,
            consequences={"gazebo": "loads it; a plugin gets the text as typed"} if remaining[0] in handed else None,
            repair=_describe_repair(source, texts),
        )
    undefined = _find_undefined_name(texts)
    twin = None if undefined is None or is_handed else find_includer_of_namesake(source, undefined)
    if twin is not None:
        return report(
            "twin",
            severity=Severity.INFO,
            consequences=_predict_mesh_consequences(iter_urdf_elements(root)),
            name=undefined,
            includer=twin.name,
        )
    if remaining and (names := _list_handed_arguments(texts)):
        return rule.finding(
            "part",
            at=where,
            severity=Severity.WARNING,
            consequences=_predict_mesh_consequences(iter_urdf_elements(root)),
            contents=contents,
            names=join_names(names),
            count=format_count(len(names), "argument"),
        )
    if remaining:
        return report(
            "not_expanded",
            consequences=_predict_consequences(
                iter_urdf_elements(root), is_number_missing=any(number for *_, number in remaining)
            ),
            repair=_describe_repair(source, texts),
        )
    place = next(location for known, location in replaced.items() if known in text)
    launch = Path(place.file).name
    return rule.finding(
        "replaced",
        at=where,
        related=[place],
        severity=Severity.INFO,
        consequences=_predict_mesh_consequences(iter_urdf_elements(root)),
        text=_shorten_expression(text),
        contents=contents,
        launch=launch,
    )


def _build_names_finding(rule: Rule, where: Location, text: str, contents: str) -> Finding:
    return rule.finding(
        "material",
        at=where,
        severity=Severity.INFO,
        text=_shorten_expression(text),
        contents=contents,
        remain="remains" if contents.startswith("1 ") else "remain",
    )


def _find_harmless_names(root: Element) -> set[Location]:
    """Return the places of the names of materials that have a colour or a texture under this name as it is typed: to a parser any
    text is a name."""
    materials = [element for element in iter_urdf_elements(root) if element.tag == "material"]
    defined = {material.get("name") for material in materials if material.children and material.parent is root}
    return {
        material.attributes["name"].location
        for material in materials
        if "name" in material.attributes and (material.children or material.get("name") in defined)
    }


def _count_substitutions(text: str) -> int:
    return 0 if text.startswith("<") else max(1, len(SUBSTITUTION.findall(text)))


def _list_handed_arguments(texts: Sequence[str]) -> list[str]:
    """List the arguments that a file reads where it holds nothing else of xacro, so that only a file that includes it can give
    them. Empty elsewhere."""
    names = [match[1] for text in texts for match in _ARGUMENT.finditer(text)]
    is_alone = all(not is_unexpanded(_ARGUMENT.sub("", text)) and not text.startswith("<") for text in texts)
    return list(dict.fromkeys(names)) if is_alone else []


def _is_left_over(source: Source, texts: Iterable[str]) -> bool:
    """Whether all that is left are elements of xacro that add nothing: definitions, and in what xacro has made, calls of macros
    whose definition is commented out."""
    text = source.files[source.name].text
    calls = [left for left in texts if left not in _DEFINITIONS]
    return not calls or (source.is_output_of_xacro and all(_is_commented_out(call, text) for call in calls))


def _is_commented_out(call: str, text: str) -> bool:
    """Whether a text defines the macro of a call that is left: if that were not in a comment, it would be left as an element."""
    name = re.fullmatch(r"<xacro:([\w.-]+)>", call)
    return name is not None and re.search(rf"macro\s+name=[\"']{re.escape(name[1])}[\"']", text) is not None


def _describe_repair(source: Source, texts: Sequence[str]) -> str:
    """Say how what is left is expanded: in what xacro has made, by running it again."""
    if source.is_output_of_xacro and all(text.startswith("<xacro:") for text in texts):
        call = next(text for text in texts if text not in _DEFINITIONS)
        return (
            f"include the file that defines {call} in the xacro of which this file was made, and run xacro again; or delete "
            "what is left, if the robot needs nothing of it"
        )
    unknown = _find_undefined_name(texts)
    root = source.main_tree
    if unknown is not None and root is not None and (definition := _find_unprefixed_definition(root, unknown)):
        line = "" if definition.span is None else f" of line {definition.span.line}"
        return (
            f"write `<xacro:{definition.tag}` for the `<{definition.tag}`{line} and the others like it, "
            f"{_DECLARING if 'xmlns:xacro' not in root.attributes else ''}{_RUNNING_XACRO}"
        )
    if unknown is not None:
        return (
            f"write the value in its place; the file does not define {unknown}, so xacro expands it only in a file that defines "
            "that and includes this one"
        )
    has_tags = any(text.startswith("<") for text in texts)
    declaring = _DECLARING if has_tags and root is not None and "xmlns:xacro" not in root.attributes else ""
    return f"{_describe_package_paths(source, texts)}{declaring}{_RUNNING_XACRO}"


def _find_unprefixed_definition(root: Element, name: str) -> Element | None:
    """Return the property of this name that lacks xacro's prefix."""
    return next((e for e in root.walk() if e.tag == "property" and e.get("name") == name), None)


def _describe_package_paths(source: Source, texts: Sequence[str]) -> str:
    """Say how the paths are written for which nothing has to be expanded; empty if anything else than these is left."""
    root = source.root
    assert root is not None  # it was checked
    named = [e.get("filename") for e in iter_urdf_elements(root) if e.tag in {"mesh", "texture"}]
    found = [match for name in named if (match := _RESOURCE.fullmatch(name)) is not None]
    if sorted(match[0] for match in found) != sorted(texts):
        return ""
    return f"write `package://{found[0][2]}/…` for `{found[0][1]}/…`, or "


def _find_undefined_name(texts: Sequence[str]) -> str | None:
    """Return the first name of an expression of xacro that nothing in a plain URDF without elements of xacro defines."""
    if any(text.startswith("<xacro:") for text in texts):
        return None
    expressions = (match[1] for text in texts for match in _EXPRESSION.finditer(text))
    names = (name for expression in expressions for name in _NAME.findall(_QUOTED.sub("", expression)))
    return next((name for name in names if name not in _KNOWN_NAMES and not keyword.iskeyword(name)), None)


def _predict_consequences(elements: Iterable[Element], *, is_number_missing: bool) -> dict[str, str]:
    """Predict the reactions to the unexpanded texts of elements; a missing number is the worse one."""
    meshes = _predict_mesh_consequences(elements)
    return CONSEQUENCES[False] | meshes | (CONSEQUENCES[True] if is_number_missing else {})


def _predict_mesh_consequences(elements: Iterable[Element]) -> dict[str, str]:
    """Predict the reactions to mesh paths that are not expanded: those to missing meshes (PKG002)."""
    paths = [element for element in elements if element.tag == "mesh" and is_unexpanded(element.get("filename") or "")]
    if not paths:
        return {}
    whole = {
        "pinocchio": "refuses the geometry of the whole robot",
        "drake": "refuses the file",
        "bullet": "refuses the file",
    }
    return whole | describe_missing_mesh(paths)


def _is_replaced(text: str, replaced: Iterable[str]) -> bool:
    """Whether nothing of xacro is left in a text after these replacements."""
    for known in replaced:
        text = text.replace(known, "")
    return not text.startswith("<xacro:") and not is_unexpanded(text)


def _find_all_unexpanded(element: Element) -> Iterator[tuple[Location, str, bool]]:
    """Yield the places of xacro in an element and in all below it."""
    for inner in element.walk():
        yield from _find_unexpanded_xacro(inner)


def _find_unexpanded_xacro(element: Element) -> Iterator[tuple[Location, str, bool]]:
    """Yield the places of xacro in one element, each with its whole text and whether a number should be there."""
    numbers = NUMERIC_ATTRIBUTES.get(element.tag, {})
    if element.tag.startswith("xacro:"):
        yield element.location, f"<{element.tag}>", False
    for attribute in element.attributes.values():
        if is_unexpanded(attribute.value):
            yield attribute.location, attribute.value, attribute.name in numbers
    if is_unexpanded(element.text):
        yield element.location, element.text, False


def _shorten_expression(text: str) -> str:
    match = SUBSTITUTION.search(text)
    return truncate_text(match.group(0) if match else text.strip(), 60)
