"""COL004 reports pairs of links that always collide and that the SRDF does not disable."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import compile_names, format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, ensure_all_shapes_read, self_collisions
from urdfcheck.model.motion.moveit_pairs import (
    TOUCHING,
    SetupAssistantPair,
    classify_link_pairs,
    do_surfaces_meet_at_default,
    find_moved_links,
    find_overlapping_hit,
    measure_default_depth,
)
from urdfcheck.model.motion.poses import get_sampling_range
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.use.display import is_checked_for_collisions
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.source.ros.srdf import Srdf, is_set_up_for_another
from urdfcheck.source.uses_elsewhere import iter_user_texts

# Where MoveIt's programs read an SRDF.
_PARAMETER = "robot_description_semantic"
# COL001 warns of overlaps that are deeper (m), but for poses in which a robot never is.
_DEEP = 2e-3
# Files that install an SRDF or say what a package has, and give it to no program.
_BUILD_FILES = frozenset({"CMakeLists.txt", "package.xml", "setup.py"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # A file without groups or pairs is a part that others include, or is still empty.
    # One that was made for another file of this robot says nothing about the pairs of this one.
    srdfs = [
        srdf
        for srdf in semantic_descriptions(model)
        if (srdf.disabled_pairs or srdf.root.find_children("group")) and not is_set_up_for_another(srdf, model.source)
    ]
    if not srdfs:
        return
    # Of several descriptions (with and without a gripper), the one for this robot covers the most of it.
    srdf = max(srdfs, key=lambda srdf: (len(srdf.grouped_links & model.link_by_name.keys()), len(srdf.disabled_pairs)))
    moved = find_moved_links(model, srdf)
    # Links that it does not name are others than it was made for, where it names some that the model lacks.
    is_of_variant = not srdf.named_links <= model.link_by_name.keys()
    always: list[tuple[SetupAssistantPair, float | None]] = []
    by_default: list[tuple[SetupAssistantPair, float | None]] = []
    reported = 0
    for j in classify_link_pairs(model):
        is_always = j.is_always_for_moveit and _are_joints_moved(model, j.pair)
        meets = is_always or j.meets_at_default
        if not meets or moved.isdisjoint(j.pair.links) or any(s.is_pair_disabled(*j.pair.links) for s in srdfs):
            continue
        if is_of_variant and not srdf.named_links.issuperset(j.pair.links):
            continue
        depth = measure_default_depth(model, j.pair) if j.meets_at_default else None
        if not is_always and _overlaps_at_rest(j.pair):
            reported += 1
            continue  # COL001 warns of the pair, and says what MoveIt does with it
        is_still = not is_always or j.pair.relation == "fixed"
        if depth and is_still and not do_surfaces_meet_at_default(model, j.pair):
            continue
        does_overlap = find_overlapping_hit(model, j.pair) is not None if depth is None else depth > TOUCHING
        if does_overlap:
            (always if is_always else by_default).append((j, depth))
    is_note = bool(always) and _is_for_other_programs(model, srdf)
    for message, pairs in (("always", always), ("default", by_default)):
        if pairs:
            yield rule.finding(
                message,
                at=srdf.root,
                severity=Severity.INFO if message == "default" or is_note else None,
                robot=model.name,
                count=format_count(len(pairs), "pair of links collides", "pairs of links collide"),
                pairs=join_names((_format_pair(j, depth) for j, depth in pairs), most=4),
                beside=f", beside {reported} that COL001 reports" if reported and message == "default" else "",
                lines=join_names((_format_srdf_line(j) for j, _ in pairs), most=4),
                samples=f"{len(pairs[0][0].pair.hits):,}",
            )
    ensure_all_shapes_read(self_collisions(model))


def _is_for_other_programs(model: Model, srdf: Srdf) -> bool:
    """Whether files of a project give the semantic description to a program, and none of them names MoveIt or another program
    that checks for collisions: what reads the description may read only its groups and states. Not where it becomes MoveIt's
    parameter, which a planner in another project may read."""
    own = compile_names((srdf.path.name,))
    users = iter_user_texts(model.source)
    texts = [drop_comments(text) for path, text in users if path.name not in _BUILD_FILES]
    is_read = any(map(own.search, texts)) and not any(_PARAMETER in text for text in texts)
    return model.source.package is not None and is_read and not is_checked_for_collisions(model)


def _are_joints_moved(model: Model, pair: CollisionPair) -> bool:
    """Whether all joints between two links were moved: those whose limits give no range stay where they are."""
    first, second = ({joint.name: joint for joint in model.tree.find_path_to(link)} for link in pair.links)
    between = [{**first, **second}[name] for name in first.keys() ^ second.keys()]
    return not any(joint.is_movable and _has_unknown_range(joint) for joint in between)


def _has_unknown_range(joint: Joint) -> bool:
    """Whether a joint is not sampled although its limits do not lock it: they are inverted (JNT005) or malformed."""
    lower, upper = get_sampling_range(joint)
    return lower == upper and joint.get_limit_value("lower") != joint.get_limit_value("upper")


def _overlaps_at_rest(pair: CollisionPair) -> bool:
    contact = pair.contact
    return pair.relation == "far" and contact is not None and not contact.touching and contact.depth > _DEEP


def _format_pair(judged: SetupAssistantPair, depth: float | None) -> str:
    return " and ".join(judged.pair.links) + (f" ({1000 * depth:.3g} mm)" if depth is not None else "")


def _format_srdf_line(judged: SetupAssistantPair) -> str:
    first, second = sorted(judged.pair.links)
    return f'<disable_collisions link1="{first}" link2="{second}" reason="{judged.reason}"/>'
