"""The parts whose collisions are compared, and the pairs of them that an edit can make collide or free."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from urdfcheck.core.mechanism import MechanismLink
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Bools, Indices
from urdfcheck.facts.comparison.alignment import PlacedPair
from urdfcheck.facts.comparison.bodies import BodyPair
from urdfcheck.facts.comparison.contents import has_moved_shapes, list_lost_shapes
from urdfcheck.facts.comparison.home_pose import ANGLE_TOLERANCE, HomePose
from urdfcheck.facts.comparison.motion import LimitSamples

# Displacements that differ by less move two parts alike: rounding adds up along the chain.
_SAME_MOTION = 4.0 * ANGLE_TOLERANCE
# Groups of units that move alike; and the number from which those are counted that are alone.
_MOST_GROUPS, _LONE = 60, 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedUnit:
    """A link with its collision shapes in both versions, or a body whose shapes were shared out among its links anew."""

    name: str
    """Of the link, or of the body's first one: in the first version, or in the second where the first does not have it."""
    before: tuple[str, ...]
    """Links of the first version; empty where it does not have it."""
    after: tuple[str, ...]
    """Links of the second version; empty where it does not have it."""
    bodies: tuple[int | None, int | None]
    """Numbers of the bodies that it is part of."""


def list_units(pair: PlacedPair, bodies: Sequence[BodyPair]) -> tuple[ComparedUnit, ...]:
    """Return the parts of both versions that have collision shapes."""
    lost_before, lost_after = list_lost_shapes(pair, bodies)
    old_by_new = {new: old for old, new in pair.match.links.items()}
    numbers_after = {name: number for number, body in enumerate(bodies) for name in body.after}
    numbers_before = {name: number for number, body in enumerate(bodies) for name in body.before}
    found: list[ComparedUnit] = []
    whole: set[int] = set()
    for number, body in enumerate(bodies):
        olds = [name for name in body.before if _collides(pair.before.links[name])]
        news = [name for name in body.after if _collides(pair.after.links[name])]
        shared = [name for name in olds if name not in pair.match.links and name not in lost_before]
        shared += [name for name in news if name not in old_by_new and name not in lost_after]
        if shared and olds and news:
            found.append(ComparedUnit(name=body.head, before=tuple(olds), after=tuple(news), bodies=(number, number)))
            whole.add(number)
    for old, number in numbers_before.items():
        new = pair.match.links.get(old)
        later = None if new is None else numbers_after[new]
        has_old, has_new = _collides(pair.before.links[old]), new is not None and _collides(pair.after.links[new])
        if (has_old or has_new) and number not in whole and later not in whole:
            before, after = (old,) if has_old else (), (new,) if has_new and new is not None else ()
            found.append(ComparedUnit(name=old, before=before, after=after, bodies=(number, later)))
    for new, number in numbers_after.items():
        if new not in old_by_new and number not in whole and _collides(pair.after.links[new]):
            found.append(ComparedUnit(name=new, before=(), after=(new,), bodies=(None, number)))
    return tuple(found)


def _collides(link: MechanismLink) -> bool:
    return any(shape.role == "collision" for shape in link.shapes)


@dataclass(frozen=True, slots=True, eq=False)
class ChangedPairs:
    """Pairs of units whose shapes, relative motion or range of motion differ."""

    pairs: Indices
    """(K, 2), numbers of units."""
    are_neighbours: Bools
    """(K,), whether one hangs on the other."""


def find_changed_pairs(
    pair: PlacedPair,
    bodies: Sequence[BodyPair],
    units: Sequence[ComparedUnit],
    samples: LimitSamples,
    moved: tuple[Mapping[str, Array], Mapping[str, Array]],
) -> ChangedPairs:
    """Find the pairs that an edit can make collide or free.

    Parts of one body are left out, and neighbours of which one version has only one: a part is fastened where it touches.
    """
    one, other = np.triu_indices(len(units), 1)
    edited = np.array([_is_edited(pair, unit) for unit in units], dtype=bool)
    motions = np.array(_group_motions(pair, units, *moved), dtype=np.int64)
    ranged = np.array(_number_ranges(pair, units, samples), dtype=np.int64)
    differs = edited[one] | edited[other] | (motions[one] != motions[other]) | (ranged[one] != ranged[other])
    is_pair, is_neighbour = np.zeros(len(one), dtype=bool), np.zeros(len(one), dtype=bool)
    exists = np.ones(len(one), dtype=bool)
    for side, home in enumerate((pair.before, pair.after)):
        number = np.array([-1 if unit.bodies[side] is None else unit.bodies[side] for unit in units], dtype=np.int64)
        shaped = np.array([bool((unit.before, unit.after)[side]) for unit in units], dtype=bool)
        above = _list_parents(home, bodies, side)
        a, b = number[one], number[other]
        known = (a >= 0) & (b >= 0)
        differs &= ~(known & (a == b))
        is_neighbour |= known & ((above[a] == b) | (above[b] == a))
        is_pair |= shaped[one] & shaped[other]
        exists &= shaped[one] & shaped[other]
    chosen = differs & is_pair & (exists | ~is_neighbour)
    return ChangedPairs(np.column_stack((one, other))[chosen], is_neighbour[chosen])


def _is_edited(pair: PlacedPair, unit: ComparedUnit) -> bool:
    """Whether the collision shapes of a unit are others, or elsewhere on it."""
    if not unit.before or not unit.after:
        return True
    return has_moved_shapes(pair, unit.before, unit.after)


def _group_motions(
    pair: PlacedPair, units: Sequence[ComparedUnit], before: Mapping[str, Array], after: Mapping[str, Array]
) -> list[int]:
    """Return the number of a group for each unit: units of one group are displaced alike by the edit in all configurations.

    A unit of one version only is alone in its group, and so are the others where there are many groups.
    """
    groups: list[Array] = []
    numbers: list[int] = []
    for place, unit in enumerate(units):
        number = _LONE + place
        if unit.before and unit.after and len(groups) < _MOST_GROUPS:
            old = unit.before[0]
            new = pair.match.links.get(old, unit.after[0])
            displaced = after[new] @ pair.maps[old] @ np.linalg.inv(before[old])
            known = (n for n, group in enumerate(groups) if float(np.abs(group - displaced).max()) <= _SAME_MOTION)
            number = next(known, len(groups))
            if number == len(groups):
                groups.append(displaced)
        numbers.append(number)
    return numbers


def _number_ranges(pair: PlacedPair, units: Sequence[ComparedUnit], samples: LimitSamples) -> list[int]:
    """Return the same number for units above which the same joints may go to other positions than before."""
    known: dict[frozenset[str], int] = {}
    return [known.setdefault(_list_ranged_joints(pair, unit, samples), len(known)) for unit in units]


def _list_ranged_joints(pair: PlacedPair, unit: ComparedUnit, samples: LimitSamples) -> frozenset[str]:
    """Return the joints above a unit that may go to other positions than before, as the first version names them."""
    names: set[str] = set()
    joint = pair.before.joint_above.get(unit.before[0]) if unit.before and samples.ranged else None
    while joint is not None:
        leader = joint.name if joint.mimic is None else joint.mimic[0]
        if leader in samples.ranged:
            names.add(joint.name)  # two that follow one leader need not move alike
        joint = pair.before.joint_above.get(joint.parent)
    return frozenset(names)


def _list_parents(home: HomePose, bodies: Sequence[BodyPair], side: int) -> Indices:
    """Return for each body of a version (0 or 1) the number of the one on which it hangs; -2 for none, also at the end."""
    numbers = {name: number for number, body in enumerate(bodies) for name in (body.before, body.after)[side]}
    parents = np.full(len(bodies) + 1, -2, dtype=np.int64)
    for joint in home.joints.values():
        child, parent = numbers[joint.child], numbers[joint.parent]
        if child != parent:
            parents[child] = parent
    return parents
