"""COL001 reports non-adjacent links that overlap at rest."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from itertools import permutations
from typing import TYPE_CHECKING

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.core.text import format_count, format_length, join_names, join_numbers
from urdfcheck.model import Joint, Model, Shape
from urdfcheck.model.gazebo import list_loop_joints
from urdfcheck.model.motion.collisions.at_rest import Contact
from urdfcheck.model.motion.collisions.self_collisions import (
    CollisionPair,
    SelfCollisions,
    ensure_all_shapes_read,
    self_collisions,
)
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions, semantic_descriptions_of_parts
from urdfcheck.model.parts import locate_geometry
from urdfcheck.model.shapes.mesh_marks import round_significant
from urdfcheck.model.use.display import is_without_dynamics

if TYPE_CHECKING:
    from urdfcheck.model.motion.collisions.lying_meshes import LyingMeshes
    from urdfcheck.model.motion.collisions.restored_origins import RestoredOrigin

# A telescope slides in two stages; one joint makes its links adjacent.
_LEAST_STAGES = 2
# The pads of a closed gripper are pressed together: by 0.6 mm in Fetch's model, 1.7 mm in that of PR2.
_PADS = 2.0
# Drawn parts that stand for collision shapes overlap by so many times the slight depth without a meaning (chosen).
_DRAWN = 5.0
# A shallow overlap is less than this part of the smaller shape.
_SHALLOW_SHARE = 0.02
# A deep one is at least this part.
_DEEP_SHARE = 0.1
# What MoveIt does with a pair that the SRDF disables, and what is to be done about the pair there.
_DISABLED = "ignores the pair: the SRDF disables it"
_INTENDED = "disable the pair in other programs too if the overlap is intended (the SRDF does for MoveIt)"
_TO_DISABLE = "add <disable_collisions> for the pair to the SRDF if the overlap is intended"
_TO_EXCLUDE = "exclude the pair in every collision checker if the overlap is intended"
# Where each link has joints of its own, and the two meet in some poses only, what excludes the pair hides those.
_TO_START = (
    "start in another pose if this one is not needed (the links meet in {count} of {samples}: keep the pair checked)"
)
# Of the configurations.
_RARELY, _USUALLY = 0.05, 0.5
# An arm has at least so many joints that move (chosen): a finger has fewer, as a rule.
_ARM_JOINTS = 4
# Cosine of the angle between the stages: 0.1°.
_PARALLEL = 1 - 1.5e-6


def check(model: Model, rule: Rule, *, graze: float, always: float, slight: float) -> Iterator[Finding]:
    collisions = self_collisions(model)
    pairs = _drop_joined_by_loops(model, [pair for pair in collisions.pairs if pair.relation == "far"])
    far = [(pair, pair.contact) for pair in pairs if pair.contact is not None]
    deep = [(pair, contact) for pair, contact in far if _is_deep_overlap(pair, contact, graze=graze, always=always)]
    samples = collisions.sample_count
    fallen = _find_lying_meshes(model) if deep else None
    if fallen is not None:
        sides = {id(shape) for shape in fallen.shapes}
        on_side = [item for item in deep if not sides.isdisjoint(map(id, item[1].shapes))]
        if any(pair.links in fallen.freed_pairs for pair, _ in on_side):
            yield _build_up_axis_finding(rule, on_side, fallen)
            deep = [item for item in deep if item not in on_side]
    restored = _find_restored_origins(collisions, deep) if deep else []
    for origin in restored:
        yield _build_displaced_finding(rule, origin, slight=slight)
    freed = {pair.links for origin in restored for pair in origin.freed}
    deep = [item for item in deep if item[0].links not in freed]
    by_design = [
        (pair, contact)
        for pair, contact in deep
        if samples > 1 and pair.hit_share >= always and not _should_come_apart(collisions, pair, contact)
    ]
    rest = [item for item in deep if item not in by_design]
    by_design_pairs = {frozenset(pair.links) for pair, _ in by_design}
    nested = [item for item in rest if _is_telescope(model, item[0])]
    bars = [item for item in rest if item not in nested and _is_linkage_bar(model, item[0], by_design_pairs)]
    shallow = [
        item
        for item in rest
        if item not in nested
        and item not in bars
        and (_is_shallow(item[1], slight) or (item[1].depth < _PADS * slight and _meets_at_stop(model, item[0])))
    ]
    harmless = [*nested, *bars, *shallow]
    for group in _group_by_shape([item for item in rest if item not in harmless]):
        is_unused = (
            all(_is_drawing(model, pair, contact, slight) for pair, contact in group)
            and is_without_dynamics(model)
            and not semantic_descriptions(model)
        )
        yield _build_overlap_finding(collisions, rule, group, is_unused=is_unused)
    for message, overlaps in (("nested", nested), ("bar", bars), ("slight", shallow)):
        if overlaps:
            yield rule.finding(
                message,
                at=locate_geometry(overlaps[0][1].shapes[1]),
                related=[locate_geometry(contact.shapes[1]) for _, contact in overlaps[1:]],
                severity=Severity.INFO,
                pairs=_join_pairs(overlaps),
                slight=format_length(slight),
            )
    if by_design:
        yield rule.finding(
            "always",
            at=locate_geometry(by_design[0][1].shapes[1]),
            related=[locate_geometry(contact.shapes[1]) for _, contact in by_design[1:]],
            severity=Severity.INFO,
            pairs=_join_pairs(by_design),
            one=by_design[0][0].links[0],
            other=by_design[0][0].links[1],
            millimetres=by_design[0][1].depth * 1e3,
            more=f" (+{len(by_design) - 1})" if len(by_design) > 1 else "",
            percent=round(100 * always),
            samples=samples,
        )
    ensure_all_shapes_read(collisions)


def _drop_joined_by_loops(model: Model, pairs: Sequence[CollisionPair]) -> Sequence[CollisionPair]:
    """Leave out the links that joints of ``<gazebo>`` blocks make one body, or neighbours: they may overlap as such do."""
    loops = list_loop_joints(model)
    if not loops:
        return pairs
    body = {name: model.tree.list_body_links(name)[0] for name in model.link_by_name}
    for kind, one, other in loops:
        if kind == "fixed":
            old, new = body[other], body[one]
            body = {name: new if head == old else head for name, head in body.items()}
    ends = [(joint.parent, joint.child) for joint in model.joints] + [(one, other) for _, one, other in loops]
    adjacent = {frozenset((body[one], body[other])) for one, other in ends}
    return [
        pair
        for pair in pairs
        if len(bodies := frozenset(body[name] for name in pair.links)) == 2 and bodies not in adjacent
    ]


def _find_lying_meshes(model: Model) -> LyingMeshes | None:
    # Most models have no deep overlap, and do without what explains one.
    from urdfcheck.model.motion.collisions.lying_meshes import find_lying_meshes

    return find_lying_meshes(model)


def _find_restored_origins(
    collisions: SelfCollisions, overlaps: Sequence[tuple[CollisionPair, Contact]]
) -> list[RestoredOrigin]:
    from urdfcheck.model.motion.collisions.restored_origins import find_restored_origins

    return find_restored_origins(collisions, [pair for pair, _ in overlaps])


def _is_shallow(contact: Contact, slight: float) -> bool:
    """Whether an overlap is as deep as shapes are inaccurate; in a tiny robot it is not if it is much of a shape."""
    return contact.depth < min(slight, _SHALLOW_SHARE * contact.size)


def _is_drawing(model: Model, pair: CollisionPair, contact: Contact, slight: float) -> bool:
    """Whether the visuals of two links, which are their collision shapes too, overlap by a few millimetres."""
    drawn = [{_name_mesh(shape) for shape in model.link_by_name[name].visuals} for name in pair.links]
    used = [_name_mesh(shape) for shape in contact.shapes]
    is_drawn = all(mesh and any(mesh in meshes for meshes in drawn) for mesh in used)
    return is_drawn and contact.depth < min(_DRAWN * slight, _DEEP_SHARE * contact.size)


def _name_mesh(shape: Shape) -> str:
    return "" if shape.mesh_filename is None else shape.mesh_filename.value


def _meets_at_stop(model: Model, pair: CollisionPair) -> bool:
    """Whether two links hardly ever overlap but at rest, where each joint between them is at a limit: a closed gripper."""
    spans = [joint.position_range for joint in _list_joints_between(model, pair)]
    return pair.hit_share <= _RARELY and all(span is not None and _get_rest(span) in span for span in spans)


def _are_crossed_arms(collisions: SelfCollisions, pair: CollisionPair) -> bool:
    """Whether two links are parts of two arms, each of several joints, which hardly ever meet but at rest, and are not drawn
    apart there: each shape is where its part is. Two legs must be apart at rest."""
    ways = _list_own_joints(collisions.setup.model, pair)
    if pair.hit_share > _RARELY or min(map(len, ways)) < _ARM_JOINTS:
        return False
    # Few pairs get here.
    from urdfcheck.model.ground.support_polygon import LEG
    from urdfcheck.model.motion.collisions.drawn_hits import is_drawn_apart

    if any(LEG.search(f"{joint.name} {joint.child}") for way in ways for joint in way):
        return False
    return not is_drawn_apart(collisions, pair, at_rest=True)


def _list_own_joints(model: Model, pair: CollisionPair) -> list[list[Joint]]:
    """Return for each link of a pair the joints that move it and not the other."""
    one, other = (model.tree.find_path_to(name) for name in pair.links)
    return [[j for j in path if j.is_movable and j not in rest] for path, rest in ((one, other), (other, one))]


def _describe_exclusion(collisions: SelfCollisions, pairs: Sequence[CollisionPair]) -> str:
    """Say whether collision checkers may leave pairs out, before the repairs of the model."""
    model, samples = collisions.setup.model, collisions.sample_count
    for pair in pairs:
        if pair.hit_share < _USUALLY and all(_list_own_joints(model, pair)):
            return _TO_START.format(count=round(pair.hit_share * samples), samples=samples)
    return _TO_DISABLE if semantic_descriptions(model) else _TO_EXCLUDE


def _list_joints_between(model: Model, pair: CollisionPair) -> list[Joint]:
    """Return the joints that move one link of a pair against the other."""
    one, other = (model.tree.find_path_to(name) for name in pair.links)
    joints = (*(j for j in one if j not in other), *(j for j in other if j not in one))
    return [joint for joint in joints if joint.is_movable]


def _should_come_apart(collisions: SelfCollisions, pair: CollisionPair, contact: Contact) -> bool:
    """Whether two links each have their own slide and overlap deeply, as they are drawn too: fingers that hold nothing."""
    model = collisions.setup.model
    one, other = (model.tree.find_path_to(name) for name in pair.links)
    ways = [[j for j in path if j.is_movable and j not in rest] for path, rest in ((one, other), (other, one))]
    if contact.depth < _DEEP_SHARE * contact.size or not all(
        way and all(joint.type == "prismatic" for joint in way) for way in ways
    ):
        return False
    from urdfcheck.model.motion.collisions.drawn_hits import is_drawn_apart  # few pairs get here

    return not is_drawn_apart(collisions, pair)


def _get_rest(span: tuple[float, float]) -> float:
    """Return the value of a joint at rest: zero, or the limit nearest to it."""
    return min(max(0.0, span[0]), span[1])


def _describe_pose(model: Model, pairs: Sequence[CollisionPair]) -> str:
    """Say where the joints between the links of some pairs are at rest."""
    between = {
        joint.name: joint for pair in pairs for joint in _list_joints_between(model, pair) if joint.mimic is None
    }
    spans = {name: span for name, joint in between.items() if (span := joint.position_range) is not None}
    away = [f"{name} at {rest:.4g}" for name, span in spans.items() if (rest := _get_rest(span)) != 0]
    return f"{join_names(away, 3)}: the limits nearest to zero" if away else "all joints at zero"


def _is_at_unused_pose(model: Model, pair: CollisionPair) -> bool:
    """Whether two links overlap in a pose that the robot is never in, and most others are free of the overlap.

    A joint that moves one of them cannot be at zero, for which JNT019 wants a start from elsewhere, and no other joint between
    them is at a limit.
    """
    between = _list_joints_between(model, pair)
    inside = all(
        (span := joint.position_range) is None or span[0] < 0 < span[1] or _get_rest(span) != 0 for joint in between
    )
    moving = [joint for name in pair.links for joint in model.tree.find_path_to(name) if joint.is_movable]
    spans = [span for joint in moving if joint.mimic is None and (span := joint.position_range) is not None]
    return inside and pair.hit_share < _USUALLY and any(_get_rest(span) != 0 for span in spans)


def _is_telescope(model: Model, pair: CollisionPair) -> bool:
    """Whether two links are parts of one telescope: all joints that move one against the other slide along one direction."""
    inner, outer = (model.tree.find_path_to(name) for name in reversed(pair.links))
    moving = [joint for joint in inner if joint.type != "fixed" and joint not in outer]
    if not _is_fixed_beyond(inner, outer):
        return False  # two fingers of a gripper
    axes = [model.axes.get(joint.name) for joint in moving if joint.type == "prismatic"]
    known = [axis for axis in axes if axis is not None]
    if len(known) < len(moving) or len(known) < _LEAST_STAGES:
        return False
    return all(abs(float(axis @ known[0])) > _PARALLEL for axis in known)


def _is_linkage_bar(model: Model, pair: CollisionPair, by_design: AbstractSet[frozenset[str]]) -> bool:
    """Whether two links are a bar of a linkage and the part that it slides into: one slide moves everything between them, and a
    third link, which slides along one of them as that moves, overlaps the other by design, as a tube around both does."""
    moving = _list_joints_between(model, pair)
    drives = {joint.name if joint.mimic is None else joint.mimic.get("joint").strip() for joint in moving}
    if len(drives) != 1 or all(joint.type == "prismatic" for joint in moving):
        return False
    drive = next((joint for joint in model.joints if joint.name in drives), None)
    if drive is None or drive.type != "prismatic":
        return False
    return any(
        tube.type == "prismatic"
        and tube.mimic is not None
        and tube.mimic.get("joint").strip() in drives
        and any(
            tube.parent == bar and frozenset((tube.child, other)) in by_design
            for bar, other in permutations(pair.links)
        )
        for tube in model.joints
    )


def _is_fixed_beyond(inner: Sequence[Joint], outer: Sequence[Joint]) -> bool:
    """Whether the path to the inner link goes on from the body of the outer one, or from one that is fixed to it."""
    shared = sum(1 for one, other in zip(inner, outer, strict=False) if one is other)
    return all(joint.type == "fixed" for joint in outer[shared:])


def _join_pairs(overlaps: Sequence[tuple[CollisionPair, Contact]]) -> str:
    return join_names([f"{pair.links[0]} and {pair.links[1]} ({c.depth * 1e3:.3g} mm)" for pair, c in overlaps], 3)


def _is_deep_overlap(pair: CollisionPair, contact: Contact, *, graze: float, always: float) -> bool:
    """Whether two links overlap, rather than touch or rest against each other at the end of a joint's range."""
    return not contact.touching and (contact.depth >= graze * contact.size or pair.hit_share >= 1 - always)


def _build_up_axis_finding(
    rule: Rule, overlaps: Sequence[tuple[CollisionPair, Contact]], fallen: LyingMeshes
) -> Finding:
    """Report all overlaps of meshes that lie on their side together: their depth means nothing until the meshes are upright."""
    overlaps = sorted(overlaps, key=lambda item: -item[1].depth)
    sides = {id(shape) for shape in fallen.shapes}
    shapes = [shape for _, contact in overlaps for shape in reversed(contact.shapes) if id(shape) in sides]
    first, *others = dict.fromkeys(locate_geometry(shape) for shape in (*shapes, *fallen.shapes))
    return rule.finding(
        "lying",
        at=first,
        related=others,
        cause="up_axis",
        pairs=_join_pairs(overlaps),
        count=format_count(len(overlaps), "pair of links", "pairs of links"),
        freed=sum(pair.links in fallen.freed_pairs for pair, _ in overlaps),
        meshes=len(fallen.shapes),
        drawn=fallen.mirrored_as_drawn,
        upright=fallen.mirrored_upright,
    )


def _build_displaced_finding(rule: Rule, restored: RestoredOrigin, *, slight: float) -> Finding:
    """Report the overlaps of a link and the displaced collision shape that causes them as one."""
    contacts = [(pair, pair.contact) for pair in restored.freed if pair.contact is not None]
    contacts.sort(key=lambda item: -item[1].depth)
    shapes = {id(shape) for _, contact in contacts for shape in contact.shapes}
    first = next((one for one in restored.shapes if id(one.collision.shape) in shapes), restored.shapes[0])
    link = first.link.name
    others = [(next(name for name in pair.links if name != link), contact) for pair, contact in contacts]
    xyz = first.collision.shape.origin.get_attribute("xyz")
    return rule.finding(
        "displaced",
        at=first.collision.place,
        related=[
            *(one.collision.place for one in restored.shapes if one is not first),
            *(one.visual.place for one in restored.shapes),
            *(locate_geometry(shape) for _, contact in contacts for shape in contact.shapes),
        ],
        severity=Severity.INFO if all(_is_shallow(contact, slight) for _, contact in contacts) else None,
        cause="rpy_in_xyz" if first.has_angles_as_position else None,
        edits=[edit for one in restored.shapes for edit in one.propose_edits()],
        confidence=Confidence.STRONG,
        link=link,
        other=others[0][0],
        others=join_names([f"{name} ({contact.depth * 1e3:.3g} mm)" for name, contact in others]),
        more=f" and {format_count(len(others) - 1, 'more link')}" if len(others) > 1 else "",
        count=len(others),
        depth=round_significant(contacts[0][1].depth),
        millimetres=contacts[0][1].depth * 1e3,
        moved=float(f"{first.moved:.4g}"),
        degrees=math.degrees(first.turned),
        gap=first.describe_gap(),
        mesh=first.collision.what,
        xyz="" if xyz is None else xyz.value,
        explains=[f"{code} {first.link.element.label}" for code in ("GEO003", "GEO005")],
    )


def _group_by_shape(overlaps: Sequence[tuple[CollisionPair, Contact]]) -> Iterator[list[tuple[CollisionPair, Contact]]]:
    """Group overlaps by a common shape, the deepest first.

    The shape with most overlaps takes all its overlaps, then that with most of the rest. Of two shapes with one overlap, it is
    the one further from the root.
    """
    left = list(overlaps)
    while left:
        counts: dict[int, int] = {}
        for _, contact in left:
            for shape in reversed(contact.shapes):
                counts[id(shape)] = counts.get(id(shape), 0) + 1
        common = max(counts, key=lambda key: counts[key])
        group = [item for item in left if common in map(id, item[1].shapes)]
        left = [item for item in left if item not in group]
        yield sorted(group, key=lambda item: -item[1].depth)


def _build_overlap_finding(
    collisions: SelfCollisions, rule: Rule, group: Sequence[tuple[CollisionPair, Contact]], *, is_unused: bool
) -> Finding:
    model, samples = collisions.setup.model, collisions.sample_count
    pair, contact = group[0]
    is_disabled = {frozenset(p.links) for p, _ in group} <= _list_disabled_pairs(model)
    place = _find_common_shape_index(group)
    shape, other = contact.shapes[place], contact.shapes[1 - place]
    others = [(p.links[p.links.index(pair.links[place]) - 1], c) for p, c in group]
    point = [round(v, 4) + 0.0 for v in contact.point]
    return rule.finding(
        "overlap" if len(group) == 1 else "several",
        at=locate_geometry(shape),
        related=[
            locate_geometry(other),
            *(locate_geometry(s) for _, c in group[1:] for s in c.shapes if s is not shape),
        ],
        severity=Severity.INFO
        if is_unused
        or is_disabled
        or all(_is_at_unused_pose(model, p) or _are_crossed_arms(collisions, p) for p, _ in group)
        else None,
        consequences={"moveit": _DISABLED} if is_disabled else None,
        srdf=_INTENDED if is_disabled else _describe_exclusion(collisions, [p for p, _ in group]),
        pose=_describe_pose(model, [p for p, _ in group]),
        link=pair.links[place],
        other=pair.links[1 - place],
        others=join_names([f"{name} ({c.depth * 1e3:.3g} mm)" for name, c in others]),
        count=len(group),
        more=len(group) - 1,
        depth=round_significant(contact.depth),
        millimetres=contact.depth * 1e3,
        normal=[round(v, 3) + 0.0 for v in contact.normal],
        point=point,
        place=join_numbers(point, separator=" "),
        frame=model.tree.root,
        seen=pair.hit_count,
        samples=samples,
    )


def _list_disabled_pairs(model: Model) -> set[frozenset[str]]:
    """List the pairs that a semantic description of a robot of this name tells MoveIt not to check: also of the xacro that this
    file was made from, and that of the robot whose file this one includes."""
    srdfs = (*semantic_descriptions(model), *semantic_descriptions_of_parts(model))
    return {pair.key for srdf in srdfs for pair in srdf.disabled_pairs}


def _find_common_shape_index(group: Sequence[tuple[CollisionPair, Contact]]) -> int:
    """Return the index of the first contact's shape that takes part in all contacts."""
    return next(
        place for place in (1, 0) if all(any(s is group[0][1].shapes[place] for s in c.shapes) for _, c in group)
    )
