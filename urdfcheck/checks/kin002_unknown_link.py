"""KIN002 reports joints whose parent or child link does not exist."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names, spell_breaks
from urdfcheck.model import Joint, Model
from urdfcheck.model.link_graph import KinematicGraph
from urdfcheck.model.repairs.edits import edit_values
from urdfcheck.model.use.other_programs import find_attaching_program, find_handing_argument, is_named_in_package
from urdfcheck.source.load import expand_edited
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.xml import Attribute

_ADDING = 'add `<link name="{called}"/>` if no other file is to bring it, or {naming}'
# Beside a root, the link alone would be a second one.
_CARRYING = '{naming}, or add `<link name="{called}"/>` and the joint that carries it'
# Another file may have been meant to complete this one, as an upper body does a lower one.
_COMPLETING = "if {file}, which has {called}, completes this one, include both from one robot; otherwise "
# Or be cut from it.
_TAKING = "take what is missing from {file}, which has the same robot name and {called}; otherwise "
_ATTACHING = 'include {file} from the robot that has {called}; to load it alone, add `<link name="{called}"/>` there'
# That robot has the link already: one more in this file would be a second one there.
_INCLUDED = (
    "load {file}, which includes this file and has {called}; to load this one alone, include it from a xacro file with "
    '`<link name="{called}"/>`'
)
# Where no other file names the link, its robot is not known: it may be of another repository, or be put together by a program.
_LEFT_OVER = (
    "no other robot file here names {called}: hand the file to a robot that has {called}, or correct the name; to load it alone, "
    'add `<link name="{called}"/>` there'
)
# Nor is it where a launch file gives the file to one of another package.
_HANDED_ON = (
    "nothing if the launch file that gets this file as {argument} adds it to a robot with {called}; to load it alone, "
    'add `<link name="{called}"/>` there'
)

# Drake has a body of this name, which a file need not declare.
_WORLD = {"world": {"drake": "loads it: the name is that of its world body"}}
_OF_DRAKE = (
    "for programs other than Drake, which has a body of this name, "
    'add `<link name="{called}"/>`: Drake reads the file with it too'
)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    graph = KinematicGraph.from_model(model)
    # One missing link is one mistake, however many joints name it.
    unknown: dict[str, list[tuple[Joint, Attribute]]] = {}
    for joint in graph.broken:
        for element in (joint.element.find_child("parent"), joint.element.find_child("child")):
            name = element.attributes.get("link") if element is not None else None
            if element is not None and name is not None and name.value and name.value not in graph.links:
                unknown.setdefault(name.value, []).append((joint, name))
    fragment = _build_fragment_finding(rule, model, graph, unknown)
    if fragment is not None:
        yield fragment
        return
    for called, places in unknown.items():
        yield _build_started_finding(rule, model, called, places) or _build_finding(rule, model, graph, places)


def _build_fragment_finding(
    rule: Rule, model: Model, graph: KinematicGraph, unknown: Mapping[str, list[tuple[Joint, Attribute]]]
) -> Finding | None:
    """Report a file whose unknown links are all parents that another model of the same robot has, or to which a program attaches
    it; None if it is not one."""
    attributes = [attribute for places in unknown.values() for _, attribute in places]
    is_attached = all(a.owner.tag == "parent" for a in attributes)
    is_attached = is_attached and all(_guess_link(graph, meant) is None for meant in unknown.values())
    if not (attributes and is_attached) or _has_root(model, graph):
        return None
    from urdfcheck.model.likeness.whole_models import (
        find_whole_model,
        find_xincluding_file,
    )  # loaded only for such a file

    whole = find_whole_model(model, unknown.keys())
    program = find_attaching_program(model, unknown) if whole is None else None
    including = find_xincluding_file(model) if whole is None and program is None else None
    user = whole or including
    if user is None and program is None:
        return None
    finding = rule.finding(
        "fragment" if whole is not None else "attached" if including is None else "xincluded",
        at=attributes[0],
        related=[a.location for a in attributes[1:10]],
        severity=Severity.INFO,
        robot=spell_breaks(model.robot.get("name")),
        links=join_names(map(spell_breaks, unknown), 3),
        file=program if user is None else format_path(user),
    )
    return replace(finding, subjects=tuple(attribute.location.subject for attribute in attributes))


def _build_started_finding(
    rule: Rule, model: Model, called: str, places: list[tuple[Joint, Attribute]]
) -> Finding | None:
    """Report a link that only the defaults of the arguments leave out; None if it is not one.

    Every file that starts the model passes values with which the link exists.
    """
    from urdfcheck.model.use.started_variants import find_needed_variant  # few models need it

    needed = find_needed_variant(model.source, lambda variant: called in variant.list_names("link"))
    if needed is None:
        return None
    attributes = [attribute for _, attribute in places]
    finding = rule.finding(
        "default",
        at=attributes[0],
        related=[*(a.location for a in attributes[1:10]), *needed.list_declarations()],
        severity=Severity.WARNING,
        called=spell_breaks(called),
        where=_describe_places(places),
        **needed.shown,
    )
    return replace(finding, subjects=tuple(attribute.location.subject for attribute in attributes))


def _has_root(model: Model, graph: KinematicGraph) -> bool:
    """Whether a link has no parent: then the file is a robot, and a joint with an unknown parent is wrong."""
    return not {joint.child for joint in model.joints}.issuperset(graph.links)


def _build_finding(rule: Rule, model: Model, graph: KinematicGraph, places: list[tuple[Joint, Attribute]]) -> Finding:
    """Report all places that name one unknown link."""
    attributes = [attribute for _, attribute in places]
    called = attributes[0].value
    related = [*(a.location for a in attributes[1:10]), *(d.location for d in attributes[0].collect_definitions())]
    is_child = any(attribute.owner.tag == "child" for attribute in attributes)
    # It needs a name of the robot too, whose lack is no finding of its own in a part.
    is_refused = is_child or "name" not in model.robot.attributes
    data: dict[str, Any] = {
        "called": spell_breaks(called),
        "where": _describe_places(places),
        "consequences": {"yourdfpy": "refuses the file" if is_refused else "loads it"} | _WORLD.get(called, {}),
    }
    near = _guess_link(graph, places)
    is_shared = _makes_other_names(model, attributes)
    edits = [] if near is None or is_shared else edit_values((attribute, near) for attribute in attributes)
    if edits and not _connects(model, graph, edits):
        near, edits = None, []
    if near is None:
        from urdfcheck.model.likeness.whole_models import find_including_robot  # loaded only for such a file

        links = join_names(graph.links) or "none"
        has_root = _has_root(model, graph)
        # What a xacro file without a root or without a name hangs on is in the file that includes it.
        is_part = model.source.is_xacro and not is_child and (not has_root or "name" not in model.robot.attributes)
        alone = _CARRYING if has_root and not is_child else _ADDING
        # To hang a robot without a root on one of its own links would close a loop.
        hangs = is_part or (not has_root and not is_child)
        including = find_including_robot(model, called)
        argument = find_handing_argument(model) if hangs and including is None else ""
        if including is not None:
            file, template = format_path(including), _INCLUDED
        elif argument:
            file, template = "", _HANDED_ON
        elif hangs:
            file, template = Path(model.source.name).name, _choose_attachment(model, called)
        else:
            file, begin = _find_rest(model, called)
            template = begin + alone
        # Where neither a package nor a robot that includes the file shows what loads it, it may be for Drake alone.
        is_for_drake = called in _WORLD and not is_child and model.source.package is None and including is None
        template = _OF_DRAKE if is_for_drake else template
        data["repair"] = template.format(
            called=data["called"], file=file, naming=_describe_naming(attributes[0]), argument=argument
        )
        # Without a name no program takes it for a robot: nothing includes it, or the run would not check it by itself.
        is_scrap = is_part and "name" not in model.robot.attributes
        # With one it may be a robot, if anything starts it.
        is_unused = (is_part or template is _ATTACHING) and not is_named_in_package(model)
        is_unused |= template is _HANDED_ON
        finding = rule.finding(
            "unknown",
            at=attributes[0],
            related=related,
            links=links,
            severity=Severity.INFO if is_scrap else Severity.WARNING if is_unused or is_for_drake else None,
            **data,
        )
    else:
        where = ", here if the value makes no other names, otherwise where a macro makes this name of it" * is_shared
        data["repair"] = f"write `{spell_breaks(near)}`{where}"
        finding = rule.finding("near", at=attributes[0], related=related, edits=edits, near=spell_breaks(near), **data)
    return replace(finding, subjects=tuple(attribute.location.subject for attribute in attributes))


def _guess_link(graph: KinematicGraph, places: Sequence[tuple[Joint, Attribute]]) -> str | None:
    """Return the link that all places that name one unknown link probably mean; none with which a joint would close a loop."""
    attribute = places[0][1]
    near = graph.guess_link(attribute.owner.tag, attribute.value)
    is_wrong = near is not None and any(_closes_loop(graph, joint, at, near) for joint, at in places)
    return None if is_wrong else near


def _closes_loop(graph: KinematicGraph, joint: Joint, attribute: Attribute, near: str) -> bool:
    """Whether a joint would lead back to a link above it with the link ``near`` instead of an unknown one."""
    if attribute.owner.tag == "parent":
        return graph.is_above(joint.child, near)
    return graph.is_above(near, joint.parent)


def _connects(model: Model, graph: KinematicGraph, edits: Sequence[Edit]) -> bool:
    """Whether a xacro with these edits still has all its links, and no joint lacks another one than before."""
    if not model.source.is_xacro:
        return True
    root = expand_edited(model.source, edits).root
    if root is None:
        return False
    links = {element.get("name") for element in root.find_children("link")}
    named = {
        e.get("link") for joint in root.find_children("joint") for e in joint.children if e.tag in ("parent", "child")
    }
    unknown = {link for joint in graph.broken for link in (joint.parent, joint.child)}.difference(graph.links)
    return links == set(graph.links) and (named - links) < unknown


def _makes_other_names(model: Model, attributes: list[Attribute]) -> bool:
    """Whether a parameter of which these values were made is in others too: ``${name}`` and ``${name}_link``."""
    handed = {d.span for a in attributes for d in a.collect_definitions() if d.kind == "parameter"}
    own, root = set(map(id, attributes)), model.source.root
    others = (a for e in root.walk() for a in e.attributes.values()) if handed and root is not None else ()
    return any(id(a) not in own and any(d.span in handed for d in a.collect_definitions()) for a in others)


def _describe_naming(attribute: Attribute) -> str:
    """Say where an existing link is to be named: in the call or the argument that hands the name over, if it is handed over."""
    handed = attribute.collect_definitions()[:1]
    for definition in handed:
        if definition.kind == "parameter" and attribute.typed.strip() == f"${{{definition.name}}}":
            return f"pass an existing link as {definition.name}"
        if definition.kind == "argument" and attribute.typed.strip() == f"$(arg {definition.name})":
            return f"give the argument {definition.name} an existing link"
    return "name an existing link"


def _choose_attachment(model: Model, called: str) -> str:
    from urdfcheck.model.likeness.whole_models import is_named_elsewhere  # loaded only for such a file

    return _ATTACHING if is_named_elsewhere(model, called) else _LEFT_OVER


def _find_rest(model: Model, called: str) -> tuple[str, str]:
    """Return the name of another robot file with a link of this name, and the begin of a repair with it; empty without one."""
    from urdfcheck.model.likeness.whole_models import (
        find_defining_file,
        find_whole_model,
    )  # loaded only for such a file

    whole = find_whole_model(model, {called})
    if whole is not None:
        return format_path(whole), _TAKING
    found = find_defining_file(model, called)
    return ("", "") if found is None else (format_path(found), _COMPLETING)


def _describe_places(places: list[tuple[Joint, Attribute]]) -> str:
    """Return ``the parent of joints a, b and c and the child of joint d``."""
    joints: dict[str, list[str]] = {}
    for joint, attribute in places:
        joints.setdefault(attribute.owner.tag, []).append(joint.name)
    return " and ".join(
        f"the {role} of {'joint' if len(names) == 1 else 'joints'} {_format_names(names)}"
        for role, names in joints.items()
    )


def _format_names(names: list[str]) -> str:
    return join_names(names, 3) if len(names) > 3 else " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
