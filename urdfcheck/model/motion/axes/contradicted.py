"""Joints whose axis, its sign or its place contradicts the parts on both sides, or leaves them apart; kept between runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.motion.axes.apart import ApartPart, find_apart_part
from urdfcheck.model.motion.axes.bearings import BearingMismatch, find_bearing_mismatches
from urdfcheck.model.motion.axes.bodies import DrawnBodies
from urdfcheck.model.motion.axes.sunken import SunkenSide, find_sunken_sides
from urdfcheck.model.motion.axes.sweeps import BlockedSide, find_blocked_sides
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Arrays = Mapping[str, NDArray[Any]]

_KINDS = ("beside", "tilted", "across")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Contradictions:
    """What contradicts the joints of a robot."""

    bearings: tuple[BearingMismatch, ...] = ()
    sides: tuple[BlockedSide, ...] = ()
    sunken: tuple[SunkenSide, ...] = ()
    apart: ApartPart | None = None


@fact
def find_contradicted_axes(model: Model) -> Contradictions:
    """Find the joints that turn about another line than their bearing, those whose limits fit the other side, and the one whose
    child touches nothing.

    :raises FactUnavailableError: when coal is not installed, the tree is broken, or an origin or an axis is malformed.
    """
    bodies = DrawnBodies(model)
    if len(bodies.shapes) < 2:
        return Contradictions()
    entry = model.cache.entry("axes", bodies.compute_key())
    names = [model.tree.parent_joint[name].name for name in model.tree.order[1:]]
    heads = list(bodies.shapes)
    try:
        return _read(entry["found"], names, heads)
    except KeyError:
        mismatches, blocked = find_bearing_mismatches(bodies), find_blocked_sides(bodies)
        sunken, apart = find_sunken_sides(bodies), find_apart_part(bodies)
        entry["found"] = {
            "bearings": np.array(
                [
                    (names.index(m.joint), _KINDS.index(m.kind), m.amount, *m.vector.tolist(), m.radius, m.hub)
                    for m in mismatches
                ]
            ).reshape(-1, 8),
            "sides": np.array(
                [
                    (
                        names.index(b.joint),
                        b.by_parent,
                        heads.index(b.by_others) if b.by_others else -1,
                        b.declared,
                        *b.contacts,
                        b.hits,
                    )
                    for b in blocked
                ]
            ).reshape(-1, 7),
            "sunken": np.array([(names.index(s.joint), s.declared, *s.shares) for s in sunken]).reshape(-1, 4),
            "sunken_into": np.array(
                [(number, heads.index(head)) for number, s in enumerate(sunken) for head in s.into]
            ).reshape(-1, 2),
            "apart": np.array(
                [(names.index(a.joint), heads.index(a.nearest), a.gap, a.size, a.others) for a in (apart,) if a]
            ).reshape(-1, 5),
        }
        return Contradictions(bearings=tuple(mismatches), sides=tuple(blocked), sunken=tuple(sunken), apart=apart)


def _read(arrays: Arrays, names: list[str], heads: list[str]) -> Contradictions:
    mismatches = [
        BearingMismatch(
            joint=names[int(row[0])],
            kind=_KINDS[int(row[1])],
            amount=float(row[2]),
            vector=row[3:6],
            radius=float(row[6]),
            hub=float(row[7]),
        )
        for row in arrays["bearings"]
    ]
    blocked = [
        BlockedSide(
            joint=names[int(row[0])],
            by_parent=bool(row[1]),
            by_others=heads[int(row[2])] if row[2] >= 0 else "",
            declared=float(row[3]),
            contacts=(float(row[4]), float(row[5])),
            hits=int(row[6]),
        )
        for row in arrays["sides"]
    ]
    sunken = [
        SunkenSide(
            joint=names[int(row[0])],
            declared=float(row[1]),
            shares=(float(row[2]), float(row[3])),
            into=tuple(heads[int(head)] for owner, head in arrays["sunken_into"] if owner == number),
        )
        for number, row in enumerate(arrays["sunken"])
    ]
    apart = [
        ApartPart(
            joint=names[int(row[0])],
            nearest=heads[int(row[1])],
            gap=float(row[2]),
            size=float(row[3]),
            others=int(row[4]),
        )
        for row in arrays["apart"]
    ]
    return Contradictions(
        bearings=tuple(mismatches), sides=tuple(blocked), sunken=tuple(sunken), apart=apart[0] if apart else None
    )
