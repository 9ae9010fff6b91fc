"""GEO003 reports collision geometry that is not where the link is drawn, or not about as large."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import list_rigid_bodies
from urdfcheck.model.shapes.bounds import compute_bounding_box, is_dummy_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# Flat shapes have boxes without volume: each is made thicker by this fraction of its diagonal.
_PADDING = 0.01
# Factors between units of length; a mesh in one of them has one of these as its ratio, to within rounding of a hull.
_UNITS = {1000.0: "millimetres and metres", 100.0: "centimetres and metres", 25.4: "inches and millimetres",
          39.37: "inches and metres", 10.0: "millimetres and centimetres"}  # fmt: skip
_UNIT_TOL = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class _BoxPair:
    """The boxes (2, 3) round what is drawn and what collides, in m along the axes of one frame."""

    visual_box: Array
    collision_box: Array

    @property
    def ratio(self) -> float:
        """How many times as long as the drawn box's diagonal the other's is."""
        return _measure_diagonal(self.collision_box) / _measure_diagonal(self.visual_box)

    @property
    def overlap(self) -> float:
        """Volume that the boxes share over that of the smaller one; 1 where it lies inside the larger one."""
        a, b = _pad_box(self.visual_box), _pad_box(self.collision_box)
        shared = np.maximum(0.0, np.minimum(a[1], b[1]) - np.maximum(a[0], b[0])).prod()
        return float(shared / min((a[1] - a[0]).prod(), (b[1] - b[0]).prod()))

    @property
    def offset(self) -> float:
        """Distance between the middles of the boxes in m."""
        return float(np.linalg.norm(self.collision_box.mean(axis=0) - self.visual_box.mean(axis=0)))


def check(model: Model, rule: Rule, *, overlap: float, ratio: float) -> Iterator[Finding]:
    def classify_pair(pair: _BoxPair) -> str | None:
        if not 1 / ratio <= pair.ratio <= ratio:
            return "size"
        return "apart" if pair.overlap < overlap else None

    for body in list_rigid_bodies(model):
        links = [model.link_by_name[name] for name in body.links]
        suspects = [link for link in links if _compare_links(model, [link], classify_pair) is not None]
        # What one link draws, another that is fixed to it may collide with.
        if not suspects or (len(links) > 1 and _compare_links(model, links, classify_pair) is None):
            continue
        for link in suspects:
            found = _compare_links(model, [link], classify_pair)
            assert found is not None
            message, pair = found
            cause = _guess_unit_mismatch(pair.ratio)
            yield rule.finding(
                message, at=_locate(link, message), cause="units" if cause else None, **_collect_data(link, pair, cause)
            )


def _compare_links(
    model: Model, links: Sequence[Link], classify: Callable[[_BoxPair], str | None]
) -> tuple[str, _BoxPair] | None:
    """What is wrong with some links of one body together, and their boxes; None when that is nothing or not known.

    Programs differ in whether they follow COLLADA's unit and up-axis, which MSH008 is about: a disagreement counts
    when it is there however the meshes are read. It is told as RViz and Gazebo draw it.
    """
    pairs = _measure_boxes(model, links)
    verdicts = [verdict for pair in pairs if (verdict := classify(pair)) is not None]
    return (verdicts[0], pairs[0]) if pairs and len(verdicts) == len(pairs) else None


def _measure_boxes(model: Model, links: Sequence[Link]) -> list[_BoxPair]:
    drawn, colliding = (
        [
            (shape, frame)
            for link, frame in zip(links, _compute_link_poses(model, links), strict=True)
            for shape in getattr(link, role)
            if not is_dummy_shape(shape)
        ]
        for role in ("visuals", "collisions")
    )
    meshes = [facts for shape, _ in (*drawn, *colliding) if (facts := model.meshes.get_facts(shape)) is not None]
    units = (True, False) if any(facts.unit not in {None, 1.0} for facts in meshes) else (True,)
    uprights = (False, True) if any(facts.up_axis in {"X_UP", "Y_UP"} for facts in meshes) else (False,)
    pairs = []
    for unit in units:
        for upright in uprights:
            boxes = [
                compute_bounding_box(model, shapes, apply_unit=unit, apply_up_axis=upright)
                for shapes in (drawn, colliding)
            ]
            if (
                boxes[0] is None
                or boxes[1] is None
                or not _measure_diagonal(boxes[0])
                or not _measure_diagonal(boxes[1])
            ):
                return []
            pairs.append(_BoxPair(boxes[0], boxes[1]))
    return pairs


def _compute_link_poses(model: Model, links: Sequence[Link]) -> list[Array]:
    """Where links of one body stand, seen from the first of them."""
    if len(links) == 1:
        return [np.eye(4)]
    home = np.linalg.inv(model.frames[links[0].name])
    return [home @ model.frames[link.name] for link in links]


def _locate(link: Link, message: str) -> Located:
    """The collision that is wrong: where it is put, or its shape; the link where it has several."""
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
        "drawn": _format_box_size(pair.visual_box),
        "collision": _format_box_size(pair.collision_box),
        "overlap": float(f"{pair.overlap:.3g}"),
        "units": units or "",
    }


def _guess_unit_mismatch(ratio: float) -> str | None:
    factor = max(ratio, 1 / ratio)
    return next((name for unit, name in _UNITS.items() if math.isclose(factor, unit, rel_tol=_UNIT_TOL)), None)


def _pad_box(box: Array) -> Array:
    margin = _PADDING * _measure_diagonal(box)
    return np.array((box[0] - margin, box[1] + margin))


def _format_box_size(box: Array) -> str:
    return " × ".join(f"{edge:.3g}" for edge in box[1] - box[0]) + " m"


def _measure_diagonal(box: Array) -> float:
    return float(np.linalg.norm(box[1] - box[0]))
