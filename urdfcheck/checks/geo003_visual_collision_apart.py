"""GEO003 reports collision geometry that is not at the place of the visual, or not about as large."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import FactUnavailableError, Finding, Located, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_box_size
from urdfcheck.facts.median import compute_medians
from urdfcheck.model import Link, Model
from urdfcheck.model.ground.wheel_shapes import find_wheel_size_differences
from urdfcheck.model.parts import is_dummy_shape, locate_geometry
from urdfcheck.model.rigid_bodies import RigidLinkGroup, list_neighbour_links, list_rigid_bodies
from urdfcheck.model.shapes.bounds import compute_bounding_box
from urdfcheck.model.shapes.mesh_sizes import get_mesh_scale
from urdfcheck.model.shapes.outside_collisions import iter_outside_collisions, list_mesh_readings

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Flat shapes have boxes without volume: each box is enlarged by this fraction of its diagonal.
_PADDING = 0.01
# Factors between units of length: the ratio of a mesh in a wrong unit, to within the rounding of a hull.
_UNITS = {1000.0: "millimetres and metres", 100.0: "centimetres and metres", 25.4: "inches and millimetres",
          39.37: "inches and metres", 10.0: "millimetres and centimetres"}  # fmt: skip
_UNIT_TOL = 0.02
# A piece that strayed has less than this part of the surface.
_STRAY_AREA = 0.2
# Ratio of the diagonals up to which a neighbour's shape may stand for a part, rather than contain it or be in it.
_ALIKE = 1.5
# A shape is of the part with which it shares this much of the smaller box.
_OWN = 0.5
# A shape is about a joint if its middle is as near as this share of its diagonal: chosen; 0.002 in the hips of Go1 and B2-W.
_ABOUT = 0.1
# Boxes with edges that agree to this share are about one shape.
_SAME_SHAPE = 0.1
# So many other drawings with the same primitives show that these stand for parts that hardly touch anything (chosen).
_OTHER_TOKENS = 2
# A scale changes all edges of a box: those that agree to this factor had none.
_SAME_EDGE = 1.1


@dataclass(frozen=True, slots=True, eq=False)
class _BoxPair:
    """The bounding boxes of visual and collision geometry, along the axes of one frame."""

    visual_box: Array
    """(2, 3) in m"""
    collision_box: Array
    """(2, 3) in m"""

    @property
    def ratio(self) -> float:
        """The diagonal of the collision box over that of the visual box."""
        return _measure_diagonal(self.collision_box) / _measure_diagonal(self.visual_box)

    @property
    def overlap(self) -> float:
        """The common volume of the boxes over that of the smaller box; 1 if it lies inside the larger one."""
        a, b = _pad_box(self.visual_box), _pad_box(self.collision_box)
        shared = np.maximum(0.0, np.minimum(a[1], b[1]) - np.maximum(a[0], b[0])).prod()
        return float(shared / min((a[1] - a[0]).prod(), (b[1] - b[0]).prod()))

    @property
    def is_one_shape(self) -> bool:
        """Whether both boxes have the same edges, about."""
        edges = [box[1] - box[0] for box in (self.visual_box, self.collision_box)]
        return bool((np.abs(edges[0] - edges[1]) <= _SAME_SHAPE * np.maximum(*edges)).all())

    @property
    def offset(self) -> float:
        """The distance between the middles of the boxes in m."""
        return float(np.linalg.norm(self.collision_box.mean(axis=0) - self.visual_box.mean(axis=0)))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _StrayPieces:
    """Small bodies of a mesh that are far from all others."""

    place: Located
    role: str
    """``visual`` or ``collision``."""
    distance: float
    """From the middle of all others in m."""
    triangles: int
    total: int
    """Triangles of the mesh."""

    def describe(self, link: Link) -> dict[str, Any]:
        return {
            "link": link.name,
            "role": self.role,
            "other": "collision" if self.role == "visual" else "visual",
            "distance": float(f"{self.distance:.3g}"),
            "triangles": self.triangles,
            "total": self.total,
        }


def check(
    model: Model, rule: Rule, *, overlap: float, ratio: float, covered: float, gap: float, wheel_ratio: float
) -> Iterator[Finding]:
    reported: set[str] = set()

    def is_reported(link: Link) -> bool:
        return any(subject.startswith(f"link[{link.name}]") for subject in reported)

    all_outside = list(iter_outside_collisions(model, gap=gap, covered=covered))
    # One of several shapes that is elsewhere makes the box around them larger.
    strayed = {outside.link.name for outside in all_outside if len(outside.link.collisions) > 1}
    for finding in _compare_bodies(model, rule, overlap=overlap, ratio=ratio, covered=covered):
        if finding.message_id == "size" and finding.severity is Severity.INFO and finding.data["link"] in strayed:
            continue
        reported.update(finding.subjects)
        yield finding
    for outside in all_outside:
        if not is_reported(outside.link):
            xyz = outside.shape.origin.get_attribute("xyz")
            yield rule.finding(
                "outside",
                at=outside.shape if xyz is None else xyz,
                link=outside.link.name,
                kind=outside.shape.kind,
                distance=float(f"{outside.distance:.3g}"),
                typed="0 0 0" if xyz is None else xyz.value,
            )
    for odd in find_wheel_size_differences(model, ratio=wheel_ratio):
        link = model.link_by_name[odd.wheel.joint.child]
        if not is_reported(link):
            yield rule.finding(
                "wheel",
                at=locate_geometry(link.collisions[0]),
                related=[locate_geometry(link.visuals[0])],
                link=link.name,
                radius=odd.radius * 1e3,
                drawn=odd.drawn * 1e3,
                factor=max(odd.radius / odd.drawn, odd.drawn / odd.radius),
                larger="larger" if odd.radius > odd.drawn else "smaller",
                effect=_describe_wheel_effect(odd.radius - odd.drawn),
            )


def _describe_wheel_effect(excess: float) -> str:
    if excess > 0:
        return f"the drawn wheel hovers {excess * 1e3:.3g} mm above the ground"
    return f"the drawn wheel sinks {-excess * 1e3:.3g} mm into the ground"


def _compare_bodies(model: Model, rule: Rule, *, overlap: float, ratio: float, covered: float) -> Iterator[Finding]:
    def classify_pair(pair: _BoxPair) -> str | None:
        if not 1 / ratio <= pair.ratio <= ratio:
            return "size"
        return "apart" if pair.overlap < overlap else None

    for body in list_rigid_bodies(model):
        links = [model.link_by_name[name] for name in body.links]
        compared = [(link, _compare_links(model, [link], classify_pair)) for link in links]
        suspects = [(link, *mismatch) for link, mismatch in compared if mismatch is not None]
        # The collision geometry for one link's visual may belong to another link that is fixed to it.
        if not suspects or (len(links) > 1 and _compare_links(model, links, classify_pair) is None):
            continue
        for link, message, pair in suspects:
            if message == "apart" and (
                _is_covered(model, body, link, pair, covered) or _holds_joint(model, link, pair)
            ):
                continue
            if message == "size" and _is_ground(model, pair):
                continue
            stray = _find_stray_pieces(model, link, pair, ratio) if message == "size" else None
            if stray is not None:
                yield rule.finding("stray", at=stray.place, **stray.describe(link))
                continue
            units = _guess_unit_mismatch(pair.ratio)
            owner = None if units else _find_owner(model, body, link)
            is_stand_in = message == "size" and not units and _is_stand_in(link, pair)
            alike = _describe_like_tokens(model, link) if is_stand_in else ""
            keeps_room = message == "size" and not units and owner is None and _keeps_room(link, pair)
            meant = _find_drawn_neighbour(model, body, link, pair) if message == "apart" and owner is None else None
            repair = _describe_repair(message, pair, owner)
            exchanged = None if units or owner is not None else _find_exchanged(model, body, link, overlap)
            if exchanged is not None:
                names = f"{link.name} and {exchanged.name}"
                repair = (
                    f"exchange the <collision> of {names}, with origins that leave both in place at rest, "
                    f"if each is the other's; otherwise {repair}"
                )
            elif is_stand_in:
                repair = f"nothing if so little of it is to touch anything; otherwise {repair}"
            elif keeps_room:
                repair = f"nothing if more room is meant to be kept; otherwise {repair}"
            elif meant is not None:
                repair = f"nothing if it is meant for {meant.name}, which is drawn there; otherwise {repair}"
            elif message == "apart" and owner is None and (around := _find_drawn_around(model, body, link, pair)):
                repair = (
                    f"move it to {around.name}, which is drawn there, if it is meant for that link; otherwise {repair}"
                )
            yield rule.finding(
                "token" if alike else message,
                at=_locate(link, message),
                severity=Severity.INFO
                if alike or meant is not None or (keeps_room and len(link.collisions) > 1)
                else None,
                cause="units" if units else "neighbour" if owner else "exchanged" if exchanged else None,
                repair=repair,
                alike=alike,
                owner=owner.link.name if owner else exchanged.name if exchanged else "",
                twin=owner.twin if owner else "",
                **_collect_data(link, pair, units),
            )


def _is_covered(model: Model, body: RigidLinkGroup, link: Link, pair: _BoxPair, covered: float) -> bool:
    """Whether the collision geometry of a link of the body in front or behind already is where ``link`` is drawn, at rest.

    A cylinder about a joint's axis may belong to either of the links that the joint connects. Collision geometry as large as the
    visual, edge by edge, is its own.
    """
    if pair.is_one_shape:
        return False
    home = np.linalg.inv(model.frames[link.name])
    for name in list_neighbour_links(model, body):
        placed = [(s, home @ model.frames[name]) for s in model.link_by_name[name].collisions if not is_dummy_shape(s)]
        box = compute_bounding_box(model, placed)
        if box is None or not _measure_diagonal(box):
            continue
        stand_in = _BoxPair(pair.visual_box, box)
        if stand_in.overlap >= covered and 1 / _ALIKE <= stand_in.ratio <= _ALIKE:
            return True
    return False


def _holds_joint(model: Model, link: Link, pair: _BoxPair) -> bool:
    """Whether the collision geometry of a link is about one of its joints, where the link on the other side is drawn: the next
    one, where a smaller shape may be anywhere along the axis, or the one before if that has collision geometry too.

    Along its own axis a shape may have strayed into the link before, by a wrong sign: there it must be at the joint. So must
    one with the edges of the visual, which is the link's own."""
    box = compute_bounding_box(model, [(s, np.eye(4)) for s in link.collisions if not is_dummy_shape(s)])
    home = np.linalg.inv(model.frames[link.name])
    before = model.tree.parent_joint.get(link.name)
    sides = [(joint, joint.child, home @ model.frames[joint.child]) for joint in model.tree.child_joints[link.name]]
    if before is not None and model.link_by_name[before.parent].collisions:
        sides.append((before, before.parent, np.eye(4)))
    for joint, name, place in sides:
        visuals = [
            (shape, home @ model.frames[name])
            for shape in model.link_by_name[name].visuals
            if not is_dummy_shape(shape)
        ]
        drawn = compute_bounding_box(model, visuals)
        if not joint.is_movable or box is None or drawn is None or not _measure_diagonal(drawn):
            continue
        away = box.mean(axis=0) - place[:3, 3]
        # What is as large as the other link's drawing may be meant for that link.
        is_part = _ALIKE * _measure_diagonal(box) < _measure_diagonal(drawn) and not pair.is_one_shape
        if is_part and joint is not before and joint.type != "prismatic" and joint.name in model.axes:
            axis = home[:3, :3] @ model.axes[joint.name]
            away = away - (away @ axis) * axis
        if float(np.linalg.norm(away)) <= _ABOUT * _measure_diagonal(box) and _BoxPair(drawn, box).overlap >= _OWN:
            return True
    return False


def _is_ground(model: Model, pair: _BoxPair) -> bool:
    """Whether a sheet is drawn on top of a larger slab, and nothing moves: the ground of a simulation."""
    drawn, solid = pair.visual_box, pair.collision_box
    sheet = _PADDING * _measure_diagonal(drawn)
    is_top = drawn[1, 2] - drawn[0, 2] <= sheet and abs(float(solid[1, 2] - drawn[1, 2])) <= sheet
    return is_top and pair.ratio > 1 and not any(joint.is_movable for joint in model.joints)


def _keeps_room(link: Link, pair: _BoxPair) -> bool:
    """Whether primitives are around all that a link draws: a planner may be meant to stay away."""
    shapes = [shape for shape in link.collisions if not is_dummy_shape(shape)]
    (least, most), (low, high) = _pad_box(pair.collision_box), pair.visual_box
    is_around = bool((least <= low).all() and (high <= most).all())
    return is_around and all(shape.kind != "mesh" for shape in shapes)


def _is_stand_in(link: Link, pair: _BoxPair) -> bool:
    """Whether what collides is smaller, and primitives inside what the link draws, or at its origin, where nothing was placed."""
    if pair.ratio >= 1.0 or any(shape.kind == "mesh" for shape in link.collisions):
        return False
    inside = (pair.visual_box[0] <= pair.collision_box[0]).all() and (pair.collision_box[1] <= pair.visual_box[1]).all()
    return bool(inside) or all(not any(shape.origin.xyz or ()) for shape in link.collisions)


def _list_drawings(link: Link) -> tuple[object, ...]:
    """List what a link draws, wherever."""
    return tuple(
        (shape.kind, shape.size, "" if shape.mesh_filename is None else shape.mesh_filename.value)
        for shape in link.visuals
    )


def _describe_like_tokens(model: Model, link: Link) -> str:
    """Say which other links have the small primitives of a link, so that the author chose what touches: the counterpart of a link
    that carries others, or several that draw other things; nothing without them."""
    from urdfcheck.model.likeness.mirror_pairs import mirror_pairs  # loaded only where a finding is made

    sizes = [(shape.kind, shape.size) for shape in link.collisions]
    like = {
        other.name
        for other in model.links
        if other is not link and other.visuals and [(shape.kind, shape.size) for shape in other.collisions] == sizes
    }
    # One macro makes wheels that all have one slip: only different parts show a choice.
    drawings = {_list_drawings(model.link_by_name[name]) for name in like} - {_list_drawings(link)}
    if len(drawings) >= _OTHER_TOKENS:
        return f"as those of {len(like)} other links"
    if not like or not any(joint.is_movable for joint in model.tree.child_joints[link.name]):
        return ""
    try:
        known = mirror_pairs(model)
    except FactUnavailableError:
        return ""  # an origin elsewhere is malformed
    twins = {name for pair in known if link.name in (pair.one, pair.other) for name in (pair.one, pair.other)}
    return "as on the other side of the robot" if twins & like else ""


@dataclass(frozen=True, slots=True)
class _Owner:
    """The link to which collision geometry belongs that another link has."""

    link: Link
    twin: str
    """Its counterpart, which has the like geometry itself."""


def _find_owner(model: Model, body: RigidLinkGroup, link: Link) -> _Owner | None:
    """Find the link in front or behind that is drawn where the collision geometry of ``link`` is, at rest, if it has none itself
    and its counterpart on the other side has such geometry, and the counterpart of ``link`` has not."""
    from urdfcheck.model.likeness.mirror_pairs import mirror_pairs  # loaded only where a finding is made

    try:
        known = mirror_pairs(model)
    except FactUnavailableError:
        return None  # an origin elsewhere is malformed
    pairs = [names for pair in known for names in ((pair.one, pair.other), (pair.other, pair.one))]
    twins = [other for one, other in pairs if one == link.name]
    count = sum(not is_dummy_shape(shape) for shape in link.collisions)
    for neighbour in _iter_drawn_neighbours(model, body, link):
        if neighbour.collisions:
            continue
        for twin in (other for one, other in pairs if one == neighbour.name):
            has_own = len(model.link_by_name[twin].collisions) == count
            if has_own and any(len(model.link_by_name[other].collisions) < count for other in twins):
                return _Owner(neighbour, twin)
    return None


def _find_exchanged(model: Model, body: RigidLinkGroup, link: Link, overlap: float) -> Link | None:
    """Find the link in front or behind with which ``link`` may have exchanged its collision geometry: what collides of either is,
    at rest, where the other is drawn, and of one of them not where it is drawn itself."""
    home = np.linalg.inv(model.frames[link.name])
    boxes = _compute_role_boxes(model, link, np.eye(4))
    for name in list_neighbour_links(model, body):
        others = _compute_role_boxes(model, model.link_by_name[name], home @ model.frames[name])
        if boxes is None or others is None:
            continue
        (drawn, solid), (other_drawn, other_solid) = boxes, others
        crosswise = (_BoxPair(drawn, other_solid).overlap, _BoxPair(other_drawn, solid).overlap)
        own = (_BoxPair(drawn, solid).overlap, _BoxPair(other_drawn, other_solid).overlap)
        # A box around the other link, or around all, overlaps everything that is drawn in it.
        ratios = (_measure_diagonal(a) / _measure_diagonal(b) for a, b in ((drawn, other_solid), (other_drawn, solid)))
        is_as_large = all(1 / _ALIKE <= ratio <= _ALIKE for ratio in ratios)
        if is_as_large and min(crosswise) >= _OWN and min(own) < overlap and max(own) < min(crosswise):
            return model.link_by_name[name]
    return None


def _compute_role_boxes(model: Model, link: Link, place: Array) -> tuple[Array, Array] | None:
    """Return the boxes of what a link draws and of what collides of it, along other axes; None if one has no size."""
    boxes = [
        compute_bounding_box(model, [(shape, place) for shape in shapes if not is_dummy_shape(shape)])
        for shapes in (link.visuals, link.collisions)
    ]
    drawn, solid = boxes
    if drawn is None or solid is None or not _measure_diagonal(drawn) or not _measure_diagonal(solid):
        return None
    return drawn, solid


def _find_drawn_around(model: Model, body: RigidLinkGroup, link: Link, pair: _BoxPair) -> Link | None:
    """Find the link in front or behind that is drawn where the collision geometry of ``link`` is, whatever its size."""
    if pair.is_one_shape:
        return None
    return next(_iter_drawn_neighbours(model, body, link, is_any_size=True), None)


def _find_drawn_neighbour(model: Model, body: RigidLinkGroup, link: Link, pair: _BoxPair) -> Link | None:
    """Find the link in front or behind for which the collision geometry of ``link`` may be meant; none if it is as large, edge by
    edge, as what ``link`` draws: then it is its own."""
    return None if pair.is_one_shape else next(_iter_drawn_neighbours(model, body, link), None)


def _iter_drawn_neighbours(
    model: Model, body: RigidLinkGroup, link: Link, *, is_any_size: bool = False
) -> Iterator[Link]:
    """Yield the links in front and behind that are drawn where the collision geometry of ``link`` is, at rest, about as large."""
    home = np.linalg.inv(model.frames[link.name])
    box = compute_bounding_box(model, [(s, np.eye(4)) for s in link.collisions if not is_dummy_shape(s)])
    for name in list_neighbour_links(model, body):
        neighbour = model.link_by_name[name]
        drawn = compute_bounding_box(
            model, [(s, home @ model.frames[name]) for s in neighbour.visuals if not is_dummy_shape(s)]
        )
        if box is None or drawn is None or not _measure_diagonal(drawn):
            continue
        fit = _BoxPair(drawn, box)
        if fit.overlap >= _OWN and (is_any_size or 1 / _ALIKE <= fit.ratio <= _ALIKE):
            yield neighbour


def _describe_repair(message: str, pair: _BoxPair, owner: _Owner | None) -> str:
    if owner is not None:
        return f"move the <collision> to {owner.link.name}, with the <origin> that leaves it in its place at rest"
    if message == "apart":
        return "give the <collision> the <origin> that puts it where the visual is, or the reverse if the visual is out of place"
    edges = [box[1] - box[0] for box in (pair.visual_box, pair.collision_box)]
    both = "give collision and visual the same size, whichever is right"
    if (np.maximum(*edges) <= _SAME_EDGE * np.minimum(*edges)).any():
        return f"{both}; a scale is not the cause, because one edge agrees"
    return f"{both}; for a mesh check its scale first"


def _compare_links(
    model: Model, links: Sequence[Link], classify: Callable[[_BoxPair], str | None]
) -> tuple[str, _BoxPair] | None:
    """Return the message about links of one body together, and their boxes; None if they agree or are not known.

    Programs differ in whether they apply COLLADA's unit and up-axis (MSH008): a disagreement counts if it is there in all
    readings of the meshes. It is measured as RViz and Gazebo draw it.
    """
    pairs = _measure_boxes(model, links)
    verdicts = [verdict for pair in pairs if (verdict := classify(pair)) is not None]
    return (verdicts[0], pairs[0]) if pairs and len(verdicts) == len(pairs) else None


def _measure_boxes(model: Model, links: Sequence[Link]) -> list[_BoxPair]:
    """Measure links of one body in each reading of their meshes; nothing if a box is not known or has no size."""
    drawn, colliding = (
        [
            (shape, frame)
            for link, frame in zip(links, _compute_link_poses(model, links), strict=True)
            for shape in getattr(link, role)
            if not is_dummy_shape(shape)
        ]
        for role in ("visuals", "collisions")
    )
    pairs = []
    for unit, upright in list_mesh_readings(model, (shape for shape, _ in (*drawn, *colliding))):
        boxes = [
            compute_bounding_box(model, shapes, apply_unit=unit, apply_up_axis=upright) for shapes in (drawn, colliding)
        ]
        if boxes[0] is None or boxes[1] is None or not _measure_diagonal(boxes[0]) or not _measure_diagonal(boxes[1]):
            return []
        pairs.append(_BoxPair(boxes[0], boxes[1]))
    return pairs


def _compute_link_poses(model: Model, links: Sequence[Link]) -> list[Array]:
    """Return the pose (4, 4) of links of one body in the frame of the first of them."""
    if len(links) == 1:
        return [np.eye(4)]
    home = np.linalg.inv(model.frames[links[0].name])
    return [home @ model.frames[link.name] for link in links]


def _find_stray_pieces(model: Model, link: Link, pair: _BoxPair, ratio: float) -> _StrayPieces | None:
    """Find the small bodies of a mesh that alone make one role of a link so much larger than the other; None without them."""
    from urdfcheck.facts.mesh.topology import label_components  # loaded only where a finding is made

    role, other = ("collision", pair.visual_box) if pair.ratio > 1 else ("visual", pair.collision_box)
    for shape in link.collisions if role == "collision" else link.visuals:
        facts, scale = model.meshes.get_facts(shape), get_mesh_scale(model, shape, True)
        if facts is None or scale is None or len(facts.components) < 2:
            continue
        corners = (facts.vertices * scale)[facts.faces]
        labels = label_components(facts.faces, len(facts.vertices))
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        middle = compute_medians(corners.mean(axis=1))
        distances = np.full(int(labels.max()) + 1, np.inf)  # of the nearest corner of each body
        np.minimum.at(distances, labels, np.linalg.norm(corners - middle, axis=2).min(axis=1))
        order = np.sort(distances)
        is_far = (distances >= order[1 + int(np.argmax(np.diff(order)))])[labels]
        near, far = corners[~is_far].reshape(-1, 3), corners[is_far].reshape(-1, 3)
        box = np.array((near.min(axis=0), near.max(axis=0)))
        is_alike = 1 / ratio <= _measure_diagonal(box) / _measure_diagonal(other) <= ratio
        if is_alike and area[is_far].sum() < _STRAY_AREA * area.sum():
            distance = float(np.linalg.norm(far.mean(axis=0) - box.mean(axis=0)))
            place = shape if shape.geometry_element is None else shape.geometry_element
            return _StrayPieces(
                place=place, role=role, distance=distance, triangles=int(is_far.sum()), total=len(is_far)
            )
    return None


def _locate(link: Link, message: str) -> Located:
    """Return the origin or the shape of the wrong collision geometry; the link if it has several."""
    if len(link.collisions) > 1:
        return link
    (collision,) = link.collisions
    xyz = collision.origin.get_attribute("xyz")
    if message == "apart":
        return collision if xyz is None else xyz
    return collision if collision.geometry_element is None else collision.geometry_element


def _collect_data(link: Link, pair: _BoxPair, units: str | None) -> dict[str, Any]:
    larger = pair.ratio > 1
    factor = pair.ratio if larger else 1 / pair.ratio
    return {
        "link": link.name,
        "offset": float(f"{pair.offset:.4g}"),
        "factor": float(f"{factor:.4g}"),
        "larger": "larger" if larger else "smaller",
        "drawn": format_box_size(pair.visual_box[1] - pair.visual_box[0]),
        "collision": format_box_size(pair.collision_box[1] - pair.collision_box[0]),
        "overlap": float(f"{pair.overlap:.3g}"),
        "units": units or "",
    }


def _guess_unit_mismatch(ratio: float) -> str | None:
    factor = max(ratio, 1 / ratio)
    return next((name for unit, name in _UNITS.items() if math.isclose(factor, unit, rel_tol=_UNIT_TOL)), None)


def _pad_box(box: Array) -> Array:
    margin = _PADDING * _measure_diagonal(box)
    return np.array((box[0] - margin, box[1] + margin))


def _measure_diagonal(box: Array) -> float:
    return float(np.linalg.norm(box[1] - box[0]))
