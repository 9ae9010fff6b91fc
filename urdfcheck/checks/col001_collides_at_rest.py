"""COL001 reports links that overlap at rest although no joint connects them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.ground.up_axis import LyingMeshes, find_lying_meshes
from urdfcheck.model.motion.collisions import (
    CollisionPair,
    Contact,
    ensure_all_shapes_read,
    locate_geometry,
    self_collisions,
)
from urdfcheck.model.shapes.mesh_marks import round_significant


def check(model: Model, rule: Rule, *, graze: float, always: float) -> Iterator[Finding]:
    collisions = self_collisions(model)
    far = [(pair, pair.contact) for pair in collisions.pairs if pair.relation == "far" and pair.contact is not None]
    deep = [(pair, contact) for pair, contact in far if _is_deep_overlap(pair, contact, graze, always)]
    samples = collisions.sample_count
    fallen = find_lying_meshes(model) if deep else None
    if fallen is not None:
        sides = {id(shape) for shape in fallen.shapes}
        on_side = [item for item in deep if not sides.isdisjoint(map(id, item[1].shapes))]
        if any(pair.links in fallen.freed_pairs for pair, _ in on_side):
            yield _build_up_axis_finding(rule, on_side, fallen)
            deep = [item for item in deep if item not in on_side]
    by_design = [(pair, contact) for pair, contact in deep if samples > 1 and pair.hit_share >= always]
    for group in _group_by_shape([item for item in deep if item not in by_design]):
        yield _build_overlap_finding(model, rule, group, samples)
    if by_design:
        yield rule.finding(
            "always",
            at=locate_geometry(by_design[0][1].shapes[1]),
            related=[locate_geometry(contact.shapes[1]) for _, contact in by_design[1:]],
            severity=Severity.INFO,
            pairs=join_names(
                [f"{pair.links[0]} and {pair.links[1]} ({c.depth * 1e3:.3g} mm)" for pair, c in by_design]
            ),
            percent=round(100 * always),
            samples=samples,
        )
    ensure_all_shapes_read(collisions)


def _is_deep_overlap(pair: CollisionPair, contact: Contact, graze: float, always: float) -> bool:
    """Whether it is more than two links that touch, or that lean on each other where their joints end."""
    return not contact.touching and (contact.depth >= graze * contact.size or pair.hit_share >= 1 - always)


def _build_up_axis_finding(rule: Rule, met: Sequence[tuple[CollisionPair, Contact]], fallen: LyingMeshes) -> Finding:
    """All overlaps of meshes that lie on their sides: how deep they are says nothing before the meshes stand upright."""
    met = sorted(met, key=lambda item: -item[1].depth)
    sides = {id(shape) for shape in fallen.shapes}
    shapes = [shape for _, contact in met for shape in reversed(contact.shapes) if id(shape) in sides]
    first, *others = dict.fromkeys(locate_geometry(shape) for shape in (*shapes, *fallen.shapes))
    return rule.finding(
        "lying",
        at=first,
        related=others,
        cause="up_axis",
        pairs=join_names([f"{pair.links[0]} and {pair.links[1]} ({c.depth * 1e3:.3g} mm)" for pair, c in met]),
        count="1 pair of links" if len(met) == 1 else f"{len(met)} pairs of links",
        freed=sum(pair.links in fallen.freed_pairs for pair, _ in met),
        meshes=len(fallen.shapes),
        drawn=fallen.mirrored_as_drawn,
        upright=fallen.mirrored_upright,
    )


def _group_by_shape(met: Sequence[tuple[CollisionPair, Contact]]) -> Iterator[list[tuple[CollisionPair, Contact]]]:
    """The overlaps in groups that have a shape in common, its place in the contacts first: the shape of most overlaps takes
    all of its own, then that of most of the rest. Of two shapes with one overlap it is the one further from the root."""
    left = list(met)
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
    model: Model, rule: Rule, group: Sequence[tuple[CollisionPair, Contact]], samples: int
) -> Finding:
    pair, contact = group[0]
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
        link=pair.links[place],
        other=pair.links[1 - place],
        others=join_names([f"{name} ({c.depth * 1e3:.3g} mm)" for name, c in others]),
        count=len(group),
        depth=round_significant(contact.depth),
        millimetres=contact.depth * 1e3,
        normal=[round(v, 3) + 0.0 for v in contact.normal],
        point=point,
        place=" ".join(f"{v:g}" for v in point),
        frame=model.tree.root,
        seen=pair.hit_count,
        samples=samples,
    )


def _find_common_shape_index(group: Sequence[tuple[CollisionPair, Contact]]) -> int:
    """Which of the first contact's two shapes takes part in all contacts."""
    return next(
        place for place in (1, 0) if all(any(s is group[0][1].shapes[place] for s in c.shapes) for _, c in group)
    )
