"""GEO003: what a link collides with is where it is drawn, and about as large."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import bodies
from urdfcheck.model.shapes.bounds import bounds, is_token

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
class _Pair:
    """The boxes (2, 3) round what is drawn and what collides, in m along the axes of one frame."""

    drawn: Array
    collision: Array

    @property
    def ratio(self) -> float:
        """How many times as long as the drawn box's diagonal the other's is."""
        return _diagonal(self.collision) / _diagonal(self.drawn)

    @property
    def overlap(self) -> float:
        """Volume that the boxes share over that of the smaller one; 1 where it lies inside the larger one."""
        a, b = _padded(self.drawn), _padded(self.collision)
        shared = np.maximum(0.0, np.minimum(a[1], b[1]) - np.maximum(a[0], b[0])).prod()
        return float(shared / min((a[1] - a[0]).prod(), (b[1] - b[0]).prod()))

    @property
    def offset(self) -> float:
        """Distance between the middles of the boxes in m."""
        return float(np.linalg.norm(self.collision.mean(axis=0) - self.drawn.mean(axis=0)))


def check(model: Model, rule: Rule, *, overlap: float, ratio: float) -> Iterator[Finding]:
    def kind(pair: _Pair) -> str | None:
        if not 1 / ratio <= pair.ratio <= ratio:
            return "size"
        return "apart" if pair.overlap < overlap else None

    for body in bodies(model):
        links = [model.link_by_name[name] for name in body.links]
        suspects = [link for link in links if _verdict(model, [link], kind) is not None]
        # What one link draws, another that is fixed to it may collide with.
        if not suspects or (len(links) > 1 and _verdict(model, links, kind) is None):
            continue
        for link in suspects:
            found = _verdict(model, [link], kind)
            assert found is not None
            message, pair = found
            cause = _unit(pair.ratio)
            yield rule.finding(
                message, at=_place(link, message), cause="units" if cause else None, **_data(link, pair, cause)
            )


def _verdict(model: Model, links: Sequence[Link], kind: Callable[[_Pair], str | None]) -> tuple[str, _Pair] | None:
    """What is wrong with some links of one body together, and their boxes; None when that is nothing or not known.

    Programs differ in whether they follow COLLADA's unit and up-axis, which MSH008 is about: a disagreement counts
    when it is there however the meshes are read. It is told as RViz and Gazebo draw it.
    """
    pairs = _pairs(model, links)
    verdicts = [verdict for pair in pairs if (verdict := kind(pair)) is not None]
    return (verdicts[0], pairs[0]) if pairs and len(verdicts) == len(pairs) else None


def _pairs(model: Model, links: Sequence[Link]) -> list[_Pair]:
    drawn, colliding = (
        [
            (shape, frame)
            for link, frame in zip(links, _frames(model, links), strict=True)
            for shape in getattr(link, role)
            if not is_token(shape)
        ]
        for role in ("visuals", "collisions")
    )
    meshes = [facts for shape, _ in (*drawn, *colliding) if (facts := model.meshes.facts_of(shape)) is not None]
    units = (True, False) if any(facts.unit not in {None, 1.0} for facts in meshes) else (True,)
    uprights = (False, True) if any(facts.up_axis in {"X_UP", "Y_UP"} for facts in meshes) else (False,)
    pairs = []
    for unit in units:
        for upright in uprights:
            boxes = [bounds(model, shapes, unit=unit, upright=upright) for shapes in (drawn, colliding)]
            if boxes[0] is None or boxes[1] is None or not _diagonal(boxes[0]) or not _diagonal(boxes[1]):
                return []
            pairs.append(_Pair(boxes[0], boxes[1]))
    return pairs


def _frames(model: Model, links: Sequence[Link]) -> list[Array]:
    """Where links of one body stand, seen from the first of them."""
    if len(links) == 1:
        return [np.eye(4)]
    home = np.linalg.inv(model.frames[links[0].name])
    return [home @ model.frames[link.name] for link in links]


def _place(link: Link, message: str) -> Located:
    """The collision that is wrong: where it is put, or its shape; the link where it has several."""
    if len(link.collisions) > 1:
        return link
    (collision,) = link.collisions
    xyz = collision.origin.attribute("xyz")
    if message == "apart":
        return collision if xyz is None else xyz
    return collision if collision.shape is None else collision.shape


def _data(link: Link, pair: _Pair, units: str | None) -> dict[str, Any]:
    larger = pair.ratio > 1
    factor = pair.ratio if larger else 1 / pair.ratio
    return {
        "link": link.name,
        "offset": float(f"{pair.offset:.4g}"),
        "factor": float(f"{factor:.4g}"),
        "larger": "larger" if larger else "smaller",
        "drawn": _size(pair.drawn),
        "collision": _size(pair.collision),
        "overlap": float(f"{pair.overlap:.3g}"),
        "units": units or "",
    }


def _unit(ratio: float) -> str | None:
    factor = max(ratio, 1 / ratio)
    return next((name for unit, name in _UNITS.items() if math.isclose(factor, unit, rel_tol=_UNIT_TOL)), None)


def _padded(box: Array) -> Array:
    margin = _PADDING * _diagonal(box)
    return np.array((box[0] - margin, box[1] + margin))


def _size(box: Array) -> str:
    return " × ".join(f"{edge:.3g}" for edge in box[1] - box[0]) + " m"


def _diagonal(box: Array) -> float:
    return float(np.linalg.norm(box[1] - box[0]))
