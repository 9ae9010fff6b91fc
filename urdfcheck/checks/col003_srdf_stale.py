"""COL003 reports `<disable_collisions>` of an SRDF that name unknown links, repeat a pair or hide a collision."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from urdfcheck.core import Applicability, Finding, Rule, Severity
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, format_count, format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.model.likeness.sibling_robots import package_names
from urdfcheck.model.motion.collisions.drawn_hits import is_drawn_apart
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, ensure_all_shapes_read, self_collisions
from urdfcheck.model.motion.moveit_pairs import classify_link_pairs, find_overlapping_hit
from urdfcheck.model.motion.planning_limits import collect_listed_joints
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.source.ros.srdf import Srdf, SrdfPair, is_set_up_for_another
from urdfcheck.source.text.tokens import build_removal_edits, build_replacement_edits
from urdfcheck.source.text.xml import Attribute

# The reasons that Setup Assistant writes; any other is the author's own.
REASONS = ("Never", "Default", "Always", "Adjacent")


# A pair that collides in half of the samples or more (chosen) may have been disabled so that the planner finds any way at all.
_MEANT = (
    'write reason="User" if the collision is to be ignored on purpose; otherwise correct the collision shapes: without the line '
    "the planner avoids most poses"
)
_HAND = 'write reason="User": a hand touches itself where it closes, and MoveIt plans with the joints of an arm'
_STALE = (
    "delete the line, or regenerate the block (urdfcheck srdf, or Setup Assistant with dense sampling); "
    'write reason="User" where contact is meant, as of fingers'
)

# Links that collide; of a smaller robot one may touch none of the others (chosen: an arm with a gripper has a dozen).
_LARGE = 20


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for srdf in semantic_descriptions(model):
        yield from _check_unknown_links(model, rule, srdf)
        yield from _check_duplicate_pairs(rule, srdf)
    yield from _check_hidden_collisions(model, rule)


def _check_unknown_links(model: Model, rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    """Report each name that no link has."""
    if model.source.is_part:
        return  # the file that includes the model may have these links
    if not srdf.grouped_links <= model.link_by_name.keys():
        return  # the planning groups also name unknown links: it describes a larger variant of the robot
    if _is_of_namesake(model, srdf) or is_set_up_for_another(srdf, model.source):
        return
    uses: dict[str, list[Attribute]] = {}
    for pair in srdf.disabled_pairs:
        for index, name in enumerate(pair.links):
            attribute = pair.get_link(index)
            if attribute is not None and name not in model.link_by_name:
                uses.setdefault(name, []).append(attribute)
    elsewhere = package_names(model)
    unused = model.link_by_name.keys() - {name for pair in srdf.disabled_pairs for name in pair.links}
    for name, attributes in uses.items():
        if elsewhere.can_package_have("link", name):
            continue
        near = find_only_near_name(name, unused, SLIP_LIKENESS)
        yield rule.finding(
            "unknown",
            at=attributes[0],
            related=attributes[1:],
            edits=build_replacement_edits(attributes, near) if near is not None else (),
            link=name,
            count=format_count(len(attributes), "pair"),
            near=format_name_hint(name, unused),
        )


def _is_of_namesake(model: Model, srdf: Srdf) -> bool:
    """Whether a semantic description beside this one names links of the model only: then this one, which does not, may be that of
    another robot of the same name."""
    return any(
        other.disabled_pairs and other.named_links <= model.link_by_name.keys()
        for other in semantic_descriptions(model)
        if other is not srdf and other.path.parent == srdf.path.parent
    )


def _check_duplicate_pairs(rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    first: dict[frozenset[str], SrdfPair] = {}
    for pair in srdf.disabled_pairs:
        before = first.setdefault(pair.key, pair)
        if before is pair or before.element.span == pair.element.span:  # one line of a macro called twice
            continue
        yield rule.finding(
            "duplicate",
            at=pair.element,
            related=[before.element],
            severity=Severity.INFO,
            edits=() if pair.element.via else build_removal_edits(pair.element, srdf.files),
            applicability=Applicability.SAFE,
            first=pair.links[0],
            second=pair.links[1],
            reasons=f" (as {before.reason} and as {pair.reason})" if before.reason != pair.reason else "",
        )


def _check_hidden_collisions(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report disabled pairs that Setup Assistant would leave enabled.

    The pairs with one reason are one finding, at the pair that collides most.
    """
    # What was made for another file of this robot is compared with that one.
    srdfs = [srdf for srdf in semantic_descriptions(model) if not is_set_up_for_another(srdf, model.source)]
    if not any(srdf.disabled_pairs for srdf in srdfs):
        return
    missed = {
        frozenset(judged.pair.links): judged.pair for judged in classify_link_pairs(model) if judged.reason is None
    }
    for srdf in srdfs:
        left_out = _list_left_out(model, srdf)
        for reason in REASONS:
            disabled = ((p, missed[p.key]) for p in srdf.disabled_pairs if p.reason == reason and p.key in missed)
            hidden = [(p, pair, hit) for p, pair in disabled if (hit := find_overlapping_hit(model, pair)) is not None]
            hidden.sort(key=lambda item: -item[1].hit_count)
            messages = [_find_message(model, reason, item[1], left_out) for item in hidden]
            for message in dict.fromkeys(sorted(messages, key=(reason.lower(), "left-out", "enclosed").index)):
                group = [item for item, own in zip(hidden, messages, strict=True) if own == message]
                yield _build_hidden_finding(model, rule, srdf, group, message)
    ensure_all_shapes_read(self_collisions(model))


def _find_message(model: Model, reason: str, pair: CollisionPair, left_out: AbstractSet[str]) -> str:
    if reason == "Never" and is_drawn_apart(self_collisions(model), pair):
        return "enclosed"
    return "left-out" if reason == "Never" and left_out >= set(pair.links) else reason.lower()


def _list_left_out(model: Model, srdf: Srdf) -> set[str]:
    """List the links of a large robot that are disabled with every other link: they were left out as a whole, not by sampling."""
    solid = {link.name for link in model.links if link.collisions}
    partners: dict[str, set[str]] = {}
    for pair in srdf.disabled_pairs:
        for name, other in (pair.links, pair.links[::-1]):
            partners.setdefault(name, set()).add(other)
    return {name for name, others in partners.items() if len(solid) >= _LARGE and solid - {name} <= others}


def _build_hidden_finding(
    model: Model, rule: Rule, srdf: Srdf, hidden: Sequence[tuple[SrdfPair, CollisionPair, int]], message: str
) -> Finding:
    """Report disabled pairs with one reason, at the first of them; with each its first sampled collision."""
    (worst, pair, first_hit), more = hidden[0], [disabled for disabled, _, _ in hidden[1:]]
    pose = self_collisions(model).poses.to_values_by_name(first_hit)
    between = _select_joints_between(model, pair, pose)
    is_of_hand = all(_are_of_hand(model, srdf, _select_joints_between(model, p, pose)) for _, p, _ in hidden)
    return rule.finding(
        message,
        at=worst.element,
        related=[disabled.element for disabled in more],
        severity=None if message == "never" and not is_of_hand else Severity.INFO,
        first=worst.links[0],
        second=worst.links[1],
        hits=pair.hit_count,
        samples=f"{len(pair.hits):,}",
        repair=_HAND if is_of_hand else _MEANT if 2 * pair.hit_count >= len(pair.hits) else _STALE,
        more=_format_more_pairs(more),
        pose=pose,
        at_pose=join_names(f"{name} = {value:.3g}" for name, value in between.items()),
    )


def _are_of_hand(model: Model, srdf: Srdf, joints: Iterable[str]) -> bool:
    """Whether only joints of end effectors, and joints of no group, move two links against each other."""
    hands = {element.get("group").strip() for element in srdf.root.find_children("end_effector")}
    listed: dict[bool, set[str]] = {True: set(), False: set()}
    for name, group in srdf.groups.items():
        listed[name in hands].update(collect_listed_joints(model, srdf, group))
    return bool(listed[True]) and not (listed[False] - listed[True]).intersection(joints)


def _select_joints_between(model: Model, pair: CollisionPair, pose: Mapping[str, float]) -> dict[str, float]:
    """Return the positions of the joints that move the two links against each other."""
    one, other = ({joint.name for joint in model.tree.find_path_to(link)} for link in pair.links)
    return {name: value for name, value in pose.items() if name in one ^ other}


def _format_more_pairs(pairs: Sequence[SrdfPair]) -> str:
    if not pairs:
        return ""
    return f"; also {join_names((f'{p.links[0]} and {p.links[1]}' for p in pairs), most=3)}"
