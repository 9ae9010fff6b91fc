"""XAC007 reports tags of xacro and calls of macros without the prefix."""

from __future__ import annotations

import fnmatch
import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import format_count, format_repetition, join_names
from urdfcheck.policy.superseding import WHOLE_RULE
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.model_role import has_unprefixed_calls, list_unprefixed_calls
from urdfcheck.source.ros.distributions import is_only_before
from urdfcheck.source.text.grammar import list_single_tags
from urdfcheck.source.text.handed_values import EXPRESSION
from urdfcheck.source.text.problems import find_lacking
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element, SourceFile
from urdfcheck.source.uses_elsewhere import is_kept_unused, is_no_robot
from urdfcheck.source.xacro.usage import (
    ANY_TAG,
    collect_lost_tags,
    collect_macros,
    collect_read_arguments,
    collect_uncalled_links,
    defines_itself,
    explain_refusal,
    find_unprefixed_tags,
    iter_elements_by_tag,
    list_strange_tags,
    read_macro,
)

# At most so many tags of one file are listed, and renamed by one fix.
_MAX_EDITED = 500

# What programs do with a robot whose links are all in macros that it does not call (KIN007).
WITHOUT_LINKS = {
    "urdfdom": "refuses the file: no link elements found",
    "bullet": "refuses the file: no links found",
    "mujoco": "creates an empty model",
    "drake": "creates an empty model",
}
# What programs do with an <inertial> that has a call in the place of its <inertia>.
WITHOUT_INERTIA = {
    "urdfdom": "drops the inertial, and with it every visual and collision of the link",
    "mujoco": "refuses the file: an <inertial> lacks its <inertia>",
}
# What programs do with a joint that has a call or a block in the place of its <limit> (JNT004).
WITHOUT_LIMIT = {
    "urdfdom": "refuses the file: a joint lacks its <limit>",
    "bullet": "refuses the file: a joint lacks its <limit>",
}
# Rules that measure a robot where its joints put it.
_RULES_ABOUT_PLACES = (
    "COL001",
    "COL002",
    "COL005",
    "COL006",
    "DYN004",
    "DYN005",
    "DYN006",
    "DYN007",
    "SYM001",
    "SYM002",
)
_RULES_ABOUT_MASS = ("INR015", "INR016", "DYN004", "DYN005", "DYN006", "DYN007")
# What an element lacks, with the rules that report this of the link or the joint, and those that measure a robot by it.
_LACKING: tuple[tuple[str, str, tuple[str, ...], tuple[str, ...]], ...] = (
    ("joint", "limit", ("JNT004",), ("COL002", "COL005")),
    ("joint", "axis", ("JNT003", "JNT015", "JNT021"), (*_RULES_ABOUT_PLACES, "SYM005")),
    ("joint", "origin", ("JNT015", "JNT021"), _RULES_ABOUT_PLACES),
    ("link", "inertial", ("INR001",), _RULES_ABOUT_MASS),
    ("link", "collision", ("GEO002",), ()),
    ("inertial", "mass", ("INR001", "INR002"), _RULES_ABOUT_MASS),
    ("inertial", "inertia", ("INR001",), ()),
    ("inertial", "origin", ("INR006", "INR009"), ()),
)

# Rules whose findings say what a robot lacks, or measure it as a whole: without the parts of a call it is not the author's robot.
_RULES_ABOUT_WHOLE_ROBOTS = (
    *("COL003", "CTL001", "CTL002", "CTL004", "CTL007", "DYN004", "DYN005", "DYN006", "DYN007", "GZB001", "INR015"),
    *("INR016", "JNT009", "KIN005", "KIN010", "LCH005", "SRD001", "SRD003"),
)
# Tags that only give a name a value.
_VALUE_TAGS = frozenset({"property", "arg"})
_DECLARATION = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
# A constant of mathematics that differs by less was rounded: XAC005 measures this.
_ROUNDED = 5e-5


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    own_trees = select_own_trees(source)
    left_over = _find_places_in_robot(source)
    by_file: dict[str, list[Element]] = {}
    for element in find_unprefixed_tags(source.trees):
        span = element.span
        if span is None or _calls_itself(element):
            continue
        if span.file in own_trees or (span.file, span.start) in left_over or _stops_expansion(source, element):
            by_file.setdefault(span.file, []).append(element)
    explained = _list_explained(source) if by_file and source.is_xacro else []
    for name, all_found in by_file.items():
        circular = [element for element in all_found if source.is_xacro and defines_itself(element)]
        if circular:
            yield _build_circular_finding(source, rule, circular)
        found = [element for element in all_found if element not in circular]
        refused = {id(e): refusal for e in found if source.is_xacro and (refusal := explain_refusal(e)) is not None}
        for reason, remedy in dict.fromkeys(refused.values()):
            group = [element for element in found if refused.get(id(element)) == (reason, remedy)]
            yield _build_refused_finding(source, rule, group, reason, remedy)
        found = [element for element in found if id(element) not in refused]
        if not found:
            continue
        message, severity = _find_message(source, found)
        elements = _sort_by_weight(source, found)
        tags = Counter(e.tag for e in elements)
        standing = _list_standing(source, elements)
        finding = rule.finding(
            message,
            at=elements[0],
            related=elements[1:_MAX_EDITED],
            edits=_propose_edits(elements, source.trees[name], source.files[name])
            if source.is_xacro and message not in {"dead", "left"} and not standing
            else [],
            severity=severity,
            tag=elements[0].tag,
            tags=list(tags),
            others="" if len(tags) == 1 else f" and {format_count(len(tags) - 1, 'other tag')}",
            lack="lacks" if len(tags) == 1 else "lack",
            listed=join_names(f"<{tag}>{format_repetition(times)}" for tag, times in tags.items()),
            times=format_repetition(len(elements)) if len(tags) == 1 else "",
            more=_describe_further_edits(tags, source.trees[name])
            + _describe_release(source, name)
            + _describe_standing(standing),
            # What follows from the tags that are left in the robot does not follow from those in a macro that is not called.
            explains=explained if not left_over.isdisjoint(_collect_places(elements)) else [],
            consequences=_describe_consequences(source, elements) or _describe_kept(standing),
        )
        # No program loads it, or the project keeps the robot on releases whose xacro expands it.
        is_harmless = finding.severity is Severity.ERROR and (
            is_kept_unused(source) or is_no_robot(source) or is_only_before("noetic", source.finder)
        )
        if is_harmless:
            finding = replace(finding, severity=Severity.WARNING, blocks_check=source.root is None)
        yield replace(finding, subjects=tuple(dict.fromkeys(e.subject for e in elements[:_MAX_EDITED])))


def _calls_itself(element: Element) -> bool:
    """Whether an element would call the macro that it is in, under no condition: with the prefix xacro would never end, and so it
    is a tag of another program."""
    outer = element.parent
    while outer is not None and outer.tag not in {"xacro:macro", "xacro:if", "xacro:unless"}:
        outer = outer.parent
    return outer is not None and outer.tag == "xacro:macro" and outer.get("name") == element.tag


def _build_circular_finding(source: Source, rule: Rule, elements: Sequence[Element]) -> Finding:
    """Report together the properties of a file whose values read their own names: xacro copies them, and the prefix stops it."""
    name = elements[0].get("name")
    finding = rule.finding(
        "circular",
        at=elements[0],
        related=elements[1:_MAX_EDITED],
        severity=Severity.INFO,
        edits=[edit for element in elements[:_MAX_EDITED] for edit in build_removal_edits(element, source.files)],
        names=join_names(element.get("name") for element in elements),
        name=name,
        noun="property" if len(elements) == 1 else "properties",
        lack="lacks" if len(elements) == 1 else "lack",
        have="has its own name in its value" if len(elements) == 1 else "have their own names in their values",
        them="it" if len(elements) == 1 else "them",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(e.subject for e in elements[:_MAX_EDITED])))


def _build_refused_finding(
    source: Source, rule: Rule, elements: Sequence[Element], reason: str, remedy: str
) -> Finding:
    """Report together the definitions of a file at which xacro stops once they have the prefix, so that no edit adds it."""
    computed = _read_expressions(source)
    used = {id(element) for element in elements if _is_used(source, element, computed)}
    elements = sorted(elements, key=lambda element: id(element) not in used)
    tag = elements[0].tag
    severity = Severity.WARNING if source.root is not None and tag != "macro" else None
    finding = rule.finding(
        "refused",
        at=elements[0],
        related=elements[1:_MAX_EDITED],
        severity=severity if used else Severity.INFO,
        tag=tag,
        times=format_repetition(len(elements)),
        names=join_names((element.get("name") or "no name" for element in elements), 3),
        reason=reason,
        remedy=remedy,
        deletion="" if used else ", or delete what nothing uses",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(e.subject for e in elements[:_MAX_EDITED])))


def _is_used(source: Source, element: Element, computed: str) -> bool:
    """Whether ``computed``, the expressions of the files, holds the name of a property, a mere text there, or a tag calls a
    macro."""
    if element.tag == "macro":
        return not _is_uncalled(source, element)
    name = element.get("name")
    return name != "" and name in computed and re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", computed) is not None


def _read_expressions(source: Source) -> str:
    """Return all expressions of the files, one below the other."""
    return "\n".join(
        expression[0]
        for tree in source.trees.values()
        for inner in tree.walk()
        for text in (*(a.value for a in inner.attributes.values()), inner.text)
        for expression in EXPRESSION.finditer(text)
    )


def _find_message(source: Source, elements: Sequence[Element]) -> tuple[str, Severity | None]:
    """Return the message about the tags of a file, and its severity where that is not the rule's.

    A model that is expanded has every value that it reads: a value that lacks the prefix takes no link from it.
    """
    made = [e for e in elements if not (e.tag in _VALUE_TAGS or _is_uncalled(source, e))]
    if not source.is_xacro:
        return ("plain", Severity.WARNING) if made else ("left", Severity.INFO)
    is_dead = not made and all(_is_dead(source, element) for element in elements)
    if source.root is None:
        if is_dead and _has_read_all(source):
            return "dead", Severity.INFO
        return "halted", Severity.WARNING if is_dead else None  # only a file that was not read may need it
    if made:
        return ("unprefixed", None) if _is_reached(source, made) else ("unreached", Severity.WARNING)
    return ("dead", Severity.INFO) if is_dead else ("value", Severity.WARNING)


def _is_reached(source: Source, elements: Sequence[Element]) -> bool:
    """Whether a tag is left in the robot, or would be there if those that are had the prefix: in the macros that they call. What
    an include would bring is not known."""
    assert source.root is not None  # only an expanded model has a robot
    left, places = find_unprefixed_tags(source.trees, source.root), _collect_places(elements)
    if any(tag.tag == "include" for tag in left) or not places.isdisjoint(_collect_places(left)):
        return True
    called = _iter_called_macros(source, [tag.tag for tag in left])
    return any(not places.isdisjoint(_collect_places(macro.walk())) for macro in called)


def _has_read_all(source: Source) -> bool:
    """Whether a model that could not be expanded includes no file that was not read: such a file might use anything."""
    read = {PurePosixPath(name).name for name in source.files}
    included = (
        element
        for tree in source.trees.values()
        for element in tree.walk()
        if element.tag.removeprefix("xacro:") == "include"
    )
    return all(PurePosixPath(element.get("filename")).name in read for element in included)


def _is_uncalled(source: Source, element: Element) -> bool:
    """Whether an element defines a macro and no file has a tag of its name: the robot lacks nothing without it."""
    called = (e for tree in source.trees.values() for e in tree.walk())
    return element.tag == "macro" and all(e.tag.removeprefix("xacro:") != element.get("name") for e in called)


def _describe_further_edits(tags: Collection[str], root: Element) -> str:
    """Say what else is needed: the declaration of the prefix, and what belongs to files that could not be included."""
    more = "" if "xmlns:xacro" in root.attributes else f", and declare the prefix: `<{root.tag} {_DECLARATION} …>`"
    if "include" not in tags:
        return more
    calls = list_strange_tags(root)
    more += "; the included files were not read and may lack it too"
    if calls:
        more += f", as may the calls of their macros: {join_names((f'<{tag}>' for tag in calls), 3)}"
    return more


def _describe_release(source: Source, name: str) -> str:
    """Name the other way for a file of a package that is not in the repository: it may be older than this ROS."""
    package = source.finder.find_package_of(source.files[name].path.absolute())
    root = source.finder.find_repository()
    if package is None or root is None or package.path.absolute().is_relative_to(root):
        return ""
    return f"; or use a release of {package.name} for ROS Noetic or ROS 2"


def _is_dead(source: Source, element: Element) -> bool:
    """Whether a value or an uncalled macro without the prefix changes nothing: nothing reads the name, or it has that value from
    elsewhere, as from xacro's own constants."""
    if element.tag == "macro":
        return True
    name, key = element.get("name"), "value" if element.tag == "property" else "default"
    constant, typed = getattr(math, name, None) if element.tag == "property" else None, parse_number(element.get(key))
    if isinstance(constant, float) and typed is not None and math.isclose(typed, constant, rel_tol=_ROUNDED):
        return True
    read = collect_read_arguments(source.trees)
    others = [e for e in iter_elements_by_tag(source.trees, f"xacro:{element.tag}") if e.get("name") == name]
    return name not in read or (bool(others) and all(e.get(key) == element.get(key) for e in others))


def _sort_by_weight(source: Source, elements: Sequence[Element]) -> list[Element]:
    """Return elements in the order of what the robot misses: calls that make links or joints, what else makes something,
    values."""

    def weigh(element: Element) -> int:
        return 0 if _makes_parts(source, element) else 2 if element.tag in _VALUE_TAGS else 1

    return sorted(elements, key=weigh)


def _makes_parts(source: Source, call: Element) -> bool:
    """Whether the macro that a tag would call makes links or joints, itself or by those that it calls."""
    return any(
        made.tag in {"link", "joint"} for macro in _iter_called_macros(source, [call.tag]) for made in macro.walk()
    )


def _iter_called_macros(source: Source, names: Iterable[str]) -> Iterator[Element]:
    """Yield the definitions of the macros with these names, and of all that they call, with or without the prefix."""
    macros = collect_macros(source.trees)
    left, visited = list(names), set[str]()
    while left:
        macro = macros.get(name := left.pop())
        if macro is not None and name not in visited:
            visited.add(name)
            yield macro.element
            left += [element.tag.removeprefix("xacro:") for element in macro.element.walk()]


def _describe_consequences(source: Source, elements: Sequence[Element]) -> dict[str, str]:
    """Return what programs do with the robot, where that is not what they do with an element that they do not know."""
    root = source.root
    if root is None:
        return {}
    places = _collect_places(elements)
    # A tag in a macro that is not called either loses only what it would make itself.
    if not places.isdisjoint(_collect_places(list_unprefixed_calls(source, root))) and not root.find_children("link"):
        return WITHOUT_LINKS
    lacking = {needed for part in root.walk() if (needed := _find_lost_need(source, part, places))}
    # What makes a parser refuse the file counts more than what it drops.
    return (WITHOUT_INERTIA if "inertia" in lacking else {}) | (WITHOUT_LIMIT if "limit" in lacking else {})


def _list_standing(source: Source, elements: Sequence[Element]) -> list[Element]:
    """Return the elements of the robot beside calls at these places that may be there only once, and that the calls would make
    again: the values of a generator, which the call was to replace."""
    if source.root is None or not source.is_xacro:
        return []
    macros, places = collect_macros(source.trees), _collect_places(elements)
    standing: dict[int, Element] = {}
    for call in find_unprefixed_tags(source.trees, source.root, only_calls=True):
        if call.parent is None or call.span is None or (call.span.file, call.span.start) not in places:
            continue
        made = {child.tag for child in macros[call.tag].element.children} & list_single_tags(call.parent)
        standing |= {id(child): child for child in call.parent.children if child.tag in made}
    return list(standing.values())


def _describe_standing(standing: Sequence[Element]) -> str:
    """Say what else must be done where the calls would make elements that are there already."""
    if not standing:
        return ""
    places = dict.fromkeys(f"{e.span.file}:{e.span.line}" for e in standing if e.span is not None)
    tags = list(dict.fromkeys(f"<{element.tag}>" for element in standing))
    listed, verb = join_names(tags), "is" if len(places) == 1 else "are"
    return f", and delete the {listed} beside it ({join_names(places, 3)}); or delete the call if the {listed} {verb} right"


def _describe_kept(standing: Sequence[Element]) -> dict[str, str]:
    tags = join_names(dict.fromkeys(f"<{element.tag}>" for element in standing))
    return {"urdfdom": f"ignores it, and reads the {tags} beside it"} if standing else {}


def _find_lost_need(source: Source, part: Element, places: Collection[tuple[str, int]]) -> str:
    """Return what parsers need in an inertial or a joint and tags in it, which are at these places, would insert; else empty."""
    needed = "inertia" if part.tag == "inertial" else "limit" if _needs_limit(part) else ""
    is_left = any(c.span is not None and (c.span.file, c.span.start) in places for c in part.children)
    if not needed or not is_left or part.find_child(needed) is not None:
        return ""
    return needed if not collect_lost_tags(source.trees, part).isdisjoint((needed, ANY_TAG)) else ""


def _needs_limit(element: Element) -> bool:
    return element.tag == "joint" and element.get("type") in {"revolute", "prismatic"}


def _list_explained(source: Source) -> list[str]:
    """Return what follows from the tags, as claims of the findings that they explain."""
    root = source.root
    if root is None:
        return []
    # The links of a robot without links are in the macros that it does not call, and so is its mass.
    explained = [f"{code} {root.subject}" for code in ("KIN007", "INR001") if has_unprefixed_calls(source, root)]
    if any(_makes_parts(source, call) for call in find_unprefixed_tags(source.trees, root, only_calls=True)):
        explained += [f"{code} {WHOLE_RULE}" for code in _RULES_ABOUT_WHOLE_ROBOTS]
    macros = collect_macros(source.trees)
    without_inertial = {
        call.parent.subject
        for call in find_unprefixed_tags(source.trees, root, only_calls=True)
        if call.parent is not None and any(made.tag == "inertial" for made in macros[call.tag].element.walk())
    }
    explained += [f"INR001 {link}" for link in sorted(without_inertial)]
    explained += _list_lacking(source, root)
    return explained + _list_joints_to(collect_uncalled_links(source.trees, root), root)


def _list_lacking(source: Source, root: Element) -> list[str]:
    """Return the claims about links and joints which lack what blocks, conditions and calls in them would insert."""
    parents = {id(e.parent): e.parent for e in find_unprefixed_tags(source.trees, root) if e.parent not in (None, root)}
    explained: dict[str, None] = {}
    for element in filter(None, parents.values()):
        part, lost = element, collect_lost_tags(source.trees, element)
        while part.parent is not None and part.parent is not root:
            part = part.parent
        for parent, tag, codes, measuring in _LACKING:
            if parent == element.tag and element.find_child(tag) is None and not lost.isdisjoint((tag, ANY_TAG)):
                explained.update(dict.fromkeys(f"{code} {part.subject}" for code in codes))
                explained.update(dict.fromkeys(f"{code} {WHOLE_RULE}" for code in measuring))
    return list(explained)


def _list_joints_to(made: set[str], root: Element) -> list[str]:
    """Return the joints of which all missing links are those that the calls would make, as claims of what explains KIN002."""
    links = {link.get("name") for link in root.find_children("link")}
    explained: list[str] = []
    for joint in root.find_children("joint") if made else ():
        ends = (joint.find_child(tag) for tag in ("parent", "child"))
        missing = {end.get("link") for end in ends if end is not None} - links
        if missing and all(any(fnmatch.fnmatchcase(name, pattern) for pattern in made) for name in missing):
            explained.append(f"KIN002 {joint.subject}")
    return explained


def _find_places_in_robot(source: Source) -> set[tuple[str, int]]:
    """Return the files and offsets of the tags that are left in the robot: the file of another package is wrong there too."""
    if source.root is None or not source.is_xacro:
        return set()
    return _collect_places(find_unprefixed_tags(source.trees, source.root))


def _stops_expansion(source: Source, element: Element) -> bool:
    """Whether an element would give a value to what the expansion did not find, in whichever package it is typed.

    A macro without the prefix is expanded where it is typed, and there its parameters have no values.
    """
    lacking = {
        name for p in source.find_problems("expansion-failed") for _, name in [find_lacking(p) or ("", "")] if name
    }
    parameters = read_macro(element).parameters if lacking and element.tag == "macro" else ()
    return not lacking.isdisjoint({element.get("name"), *parameters})


def _collect_places(elements: Iterable[Element]) -> set[tuple[str, int]]:
    """Return the files and offsets of elements: those of a tag as it is typed, and of what is left of it in the robot."""
    return {(element.span.file, element.span.start) for element in elements if element.span is not None}


def _propose_edits(elements: Sequence[Element], root: Element, file: SourceFile) -> list[Edit]:
    """Return edits that add the prefix to all start and end tags.

    Nothing if the prefix is not declared or an end tag is not found: half of the edits would be worse than none.
    """
    edits: list[Edit] = []
    for element in elements if len(elements) <= _MAX_EDITED else ():
        places = _find_tag_offsets(element, file.text)
        if not places or "xmlns:xacro" not in root.attributes:
            return []
        tag = element.tag
        edits += [Edit(file.make_span(at, at + len(tag)), tag, f"xacro:{tag}") for at in places]
    return edits


def _find_tag_offsets(element: Element, text: str) -> list[int]:
    """Return the offsets of an element's name in its start tag and its end tag; nothing if the end tag is not certain."""
    if element.span is None:
        return []
    start = element.span.start + 1
    if text.endswith("/>", 0, element.span.end):
        return [start]
    inside = [(e.tag, e.span.end) for e in element.walk() if e.span is not None]
    last = max(end for _, end in inside)
    end = re.compile(rf"</{re.escape(element.tag)}\s*>").search(text, last)
    if end is None or any(tag == element.tag for tag, _ in inside[1:]) or "<!--" in text[last : end.start()]:
        return []
    return [start, end.start() + 2]
