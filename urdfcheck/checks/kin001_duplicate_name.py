"""KIN001 reports links and joints that share a name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Location, Rule, Severity, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.link_graph import KinematicGraph
from urdfcheck.model.use.gazebo_starts import is_left_out_of_gazebo
from urdfcheck.model.use.simulators import is_started_in_simulator

if TYPE_CHECKING:
    from urdfcheck.model.use.started_variants import StartedVariant

# MuJoCo needs a joint's name only where something refers to it.
MUJOCO = {"link": "refuses the file: repeated name", "joint": "replaces the second name by an empty one"}


@dataclass(frozen=True, slots=True, eq=False)
class _SharedValue:
    """What two uses of a macro have in common though they should differ. ``span``, ``via``: where the second gets it."""

    span: Span | None
    via: tuple[Span, ...]
    why: str
    repair: str
    related: tuple[Location, ...] = ()


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    holders: dict[str, list[str]] = {}
    for joint in model.joints:
        holders.setdefault(joint.child, []).append(joint.name)
    yield from _check_repeated_names(model, model.links, "link", rule, holders)
    yield from _check_joints(model, rule)
    # Converters merge the two links of a fixed joint: its name disappears before it can clash.
    shared = [j for j in model.joint_by_name.values() if j.name in model.link_by_name and j.name and j.type != "fixed"]
    if shared:
        names = [joint.name for joint in shared]
        links = [_locate_name(model.link_by_name[name]) for name in names]
        proposed = f"{names[0]}_joint"
        finding = rule.finding(
            "shared",
            at=_locate_name(shared[0]),
            severity=Severity.INFO if is_left_out_of_gazebo(model) or _is_without_mass(model) else Severity.WARNING,
            related=links[:10],
            who="a link and a joint share the name" if len(names) == 1 else "links and joints share the names",
            names=join_names(names),
            example="" if proposed in {*model.link_by_name, *model.joint_by_name} else f", such as {proposed}",
        )
        yield replace(finding, subjects=tuple(_locate_name(joint).subject for joint in shared))


def _is_without_mass(model: Model) -> bool:
    """Whether no link has a mass and nothing simulates this robot: Gazebo would drop every link, so the model is not for it."""
    return all(link.inertial is None for link in model.links) and not is_started_in_simulator(model)


def _find_needed_variant(model: Model, kind: str) -> StartedVariant | None:
    """Return what gives all parts of a kind their own names, if every file that starts the model passes it."""
    from urdfcheck.model.use.started_variants import find_needed_variant  # few models need it

    def has_own_names(variant: StartedVariant) -> bool:
        names = variant.list_names(kind)
        return 0 < len(names) == len({*names})

    return find_needed_variant(model.source, has_own_names)


def _check_repeated_names(
    model: Model, parts: Sequence[Link] | Sequence[Joint], kind: str, rule: Rule, holders: Mapping[str, Sequence[str]]
) -> Iterator[Finding]:
    """Report parts of one name. ``holders``: the joints of which a link is the child, by its name."""
    first: dict[str, Link | Joint] = {}
    again = [part for part in parts if part.name and first.setdefault(part.name, part) is not part]
    needed = _find_needed_variant(model, kind) if again else None
    for part in again:
        at, other = _locate_name(part), _locate_name(first[part.name])
        if needed is not None:
            yield rule.finding(
                "default",
                at=at,
                related=[other, *needed.list_declarations()],
                severity=Severity.WARNING,
                kind=kind,
                called=part.name,
                **needed.shown,
            )
            continue
        shared = _find_shared_value(first[part.name], part)
        yield rule.finding(
            "repeated" if shared is None else "passed",
            at=at if shared is None else Location(at.subject, shared.span, shared.via),
            related=[other] if shared is None else [*shared.related, at, other],
            consequences={"mujoco": MUJOCO[kind]},
            kind=kind,
            called=part.name,
            why="" if shared is None else shared.why,
            repair=_describe_renaming(first[part.name], part, holders.get(part.name, ()))
            if shared is None
            else shared.repair,
        )


def _describe_renaming(first: Link | Joint, second: Link | Joint, held: Sequence[str]) -> str:
    """Say what another name for one of two parts takes. ``held``: the joints of which a link of this name is the child."""
    if first.element.attributes["name"].span == second.element.attributes["name"].span:
        return "include its file or call its macro once, or put a parameter that each call sets before the name: `${prefix}`"
    if len(held) > 1 and len(set(held)) == 1:
        return f"delete one with its joint {held[0]} if it is a copy, or rename both"
    if len(held) > 1:
        more = "" if len(held) == 2 else f" or {len(held) - 2} more"
        which = f"{' or '.join(held[:2])}{more}"
        return f"rename one of them, and the child of the joint that holds it: {which}; a copy, delete with its joint"
    return "rename one of them, or delete it if it is a copy"


def _find_shared_value(first: Link | Joint, second: Link | Joint) -> _SharedValue | None:
    """Return what gives two parts one name that one line of a macro makes of its parameters; None for names of another origin."""
    one, two = first.element.attributes["name"], second.element.attributes["name"]
    calls = [call for other, call in zip(first.element.via, second.element.via, strict=False) if call != other]
    if one.span != two.span or not calls:
        return None
    ones, twos = one.collect_definitions(), two.collect_definitions()
    own = [definition for definition in twos if definition.span not in {d.span for d in ones}]
    others = [definition for definition in ones if definition.span not in {d.span for d in twos}]
    # A macro hands it on to another one, mostly under the same name.
    names = list(dict.fromkeys(definition.name for definition in own or twos if definition.kind == "parameter"))
    hands_on = all(inner in outer.reads for outer, inner in pairwise(own))
    if own and others and hands_on and own[-1].name != others[-1].name:  # two arguments, which have one value
        told = f"{others[-1].name} and {own[-1].name}"
        related = (others[-1].location,)
        return _SharedValue(own[-1].span, (), f"{told} have the same value", f"give {told} different values", related)
    if not names:
        return None
    passed = " and ".join(names)
    return _SharedValue(
        calls[0],
        second.element.via[: second.element.via.index(calls[0])],
        f"both calls pass the same {passed}" if own else f"both calls leave {passed} at the default",
        f"pass another {' or '.join(names)} in one of the calls",
    )


def _check_joints(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report joints of one name; where they have one child too, another name alone would leave it with two parents."""
    declared = Counter(link.name for link in model.links)
    copies = [j for j in model.joints if j.name and _is_copy(model.joint_by_name[j.name], j, declared)]
    copied = set(map(id, copies))
    yield from _check_repeated_names(model, [j for j in model.joints if id(j) not in copied], "joint", rule, {})
    for joint in copies:
        meant = _find_meant_child(model, joint) if len(copies) == 1 else ""
        is_explained = meant and len(KinematicGraph.from_model(model).find_components()) == 2
        yield rule.finding(
            "copied",
            at=_locate_name(joint),
            related=[_locate_name(model.joint_by_name[joint.name])],
            explains=[f"KIN005 link[{link.name}]" for link in model.links] if is_explained else [],
            called=joint.name,
            child=joint.child,
            meant=f" (perhaps {meant}, which has no joint)" if meant else "",
        )


def _is_copy(first: Joint, joint: Joint, declared: Mapping[str, int]) -> bool:
    """Whether a joint has the child of the first one of its name, and is not that of a second link of the child's name."""
    return first is not joint and first.child == joint.child != "" and declared[joint.child] == 1


def _find_meant_child(model: Model, joint: Joint) -> str:
    """Return the link that is declared just before a joint and has none, or nothing: the copy may be meant for it."""
    parts = [child for child in model.robot.children if child.tag in {"link", "joint"}]
    before = parts[parts.index(joint.element) - 1]
    name = before.get("name") if before.tag == "link" else ""
    return "" if any(other.child == name for other in model.joints) else name


def _locate_name(part: Link | Joint) -> Location:
    attribute = part.element.attributes.get("name")
    return part.location if attribute is None else attribute.location
