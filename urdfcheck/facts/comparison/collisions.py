"""Which parts collide in one version and not in the other, at the same joint positions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np

from urdfcheck.core.model_diff import CollisionDiff, MechanismEffect
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Bools, Indices
from urdfcheck.facts.comparison.alignment import PlacedPair
from urdfcheck.facts.comparison.bodies import BodyPair
from urdfcheck.facts.comparison.collision_units import ComparedUnit, find_changed_pairs, list_units
from urdfcheck.facts.comparison.home_pose import HomePose
from urdfcheck.facts.comparison.motion import LimitSamples, compute_displacements, describe_positions, sample_limits
from urdfcheck.facts.comparison.surfaces import GeometryReader
from urdfcheck.facts.motion.collision import Colliders
from urdfcheck.facts.motion.collision_geometry import PlacedGeometry
from urdfcheck.facts.motion.gaps import Gaps

# Parts with collision shapes; they make two million pairs.
MOST_UNITS = 2_000
# Pairs of shapes that coal compares in one version; with more, fewer configurations are compared.
_MOST_TESTS = 20_000
# Pairs of parts times configurations that are compared.
_MOST_PLACES = 4_000_000
# Pairs whose overlap is measured, and configurations in which it is, for each.
_MOST_MEASURED, _MEASURED_ROWS = 20, 4
# Pairs of shapes between which a distance is measured, and triangles of a shape above which it is not.
_MOST_GAPS, _MOST_FACES = 16, 50_000


def compare_collisions(pair: PlacedPair, bodies: Sequence[BodyPair], read: GeometryReader) -> CollisionDiff | None:
    """Compare which parts collide; None where no pair of parts has another geometry, motion or range, or where there are
    more than `MOST_UNITS`.

    :raises ImportError: when coal is not installed.
    """
    units = list_units(pair, bodies)
    if len(units) > MOST_UNITS:
        return None
    samples = sample_limits(pair)
    moved = (
        compute_displacements(pair.before, samples.joints.before, samples.joints.count),
        compute_displacements(pair.after, samples.joints.after, samples.joints.count),
    )
    changed = find_changed_pairs(pair, bodies, units, samples, moved)
    pairs = changed.pairs
    if not len(pairs):
        return None
    used = np.zeros(len(units), dtype=bool)
    used[pairs.ravel()] = True
    sides = [
        _PlacedSide.place(home, units, used, displaced, read, is_after=bool(number))
        for number, (home, displaced) in enumerate(zip((pair.before, pair.after), moved, strict=True))
    ]
    unread = sides[0].unread | sides[1].unread
    left_out = tuple(sorted({units[number].name for number in unread}))
    known = ~np.isin(pairs, sorted(unread)).any(axis=1)
    pairs = pairs[known]
    rows = _choose_rows(sides, pairs, samples.joints.count)
    hits = [
        side.detect(rows, pairs) & allowed[rows]
        for side, allowed in zip(sides, (samples.is_allowed_before, samples.is_allowed_after), strict=True)
    ]
    search = _Search(pair, units, sides, samples, rows)
    effects = search.list_effects(pairs, *hits, are_neighbours=changed.are_neighbours[known])
    return CollisionDiff(samples=len(rows), pairs=len(pairs), unread=left_out, effects=tuple(effects))


def _choose_rows(sides: Sequence[_PlacedSide], pairs: Indices, count: int) -> Indices:
    """Return the configurations that are compared: all, or the first and some of the others where that takes too long."""
    rows = _spread_rows(count, count * _MOST_PLACES // max(1, len(pairs) * count))
    tests = max(side.count_tests(rows, pairs) for side in sides)
    return rows[_spread_rows(len(rows), len(rows) * _MOST_TESTS // max(1, tests))]


def _spread_rows(count: int, most: int) -> Indices:
    """Return ``most`` of ``count`` numbers, at least two, the first and the last among them."""
    rows: Indices = np.unique(np.linspace(0, count - 1, max(2, min(count, most))).astype(np.int64))
    return rows


@dataclass(frozen=True, eq=False)
class _PlacedSide:
    """The shapes of one version."""

    placed: tuple[PlacedGeometry, ...]
    """At their places with all joints at zero; owners are numbers of units."""
    frames: Array
    """(N, U, 4, 4): displacements of the units."""
    unread: frozenset[int]
    """Units of which a shape could not be read."""

    @classmethod
    def place(
        cls,
        home: HomePose,
        units: Sequence[ComparedUnit],
        used: Bools,
        moved: Mapping[str, Array],
        read: GeometryReader,
        *,
        is_after: bool,
    ) -> _PlacedSide:
        """Read and place the shapes of the units that are used."""
        placed: list[PlacedGeometry] = []
        unread: set[int] = set()
        count = len(next(iter(moved.values())))
        frames = np.tile(np.eye(4), (count, len(units), 1, 1))
        for number in np.flatnonzero(used).tolist():
            links = units[number].after if is_after else units[number].before
            for link in links:
                frames[:, number] = moved[link]
                for shape in home.links[link].shapes:
                    if shape.role != "collision":
                        continue
                    geometry = read(shape) if shape.pose else None
                    if geometry is None:
                        unread.add(number)
                        continue
                    pose = home.frames[link] @ np.array(shape.pose).reshape(4, 4)
                    placed.append(PlacedGeometry(geometry, number, pose))
        return cls(tuple(placed), frames, frozenset(unread))

    @cached_property
    def colliders(self) -> Colliders:
        return Colliders(self.placed)

    @cached_property
    def owners(self) -> frozenset[int]:
        """Units that have a shape here."""
        return frozenset(placed.owner for placed in self.placed)

    def count_tests(self, rows: Indices, pairs: Indices) -> int:
        """Count the pairs of shapes that are left to coal."""
        known = pairs[self._mask_known(pairs)]
        return len(self.colliders.find_candidate_pairs(self.frames[rows], known).pair) if len(known) else 0

    def detect(self, rows: Indices, pairs: Indices) -> Bools:
        """Return which pairs meet (K, N); those of which a part has no shape here do not."""
        hits = np.zeros((len(pairs), len(rows)), dtype=bool)
        known = self._mask_known(pairs)
        if known.any():
            hits[known] = self.colliders.detect_collisions(self.frames[rows], pairs[known])
        return hits

    def _mask_known(self, pairs: Indices) -> Bools:
        return np.asarray(np.isin(pairs, sorted(self.owners)).all(axis=1))

    def measure_gap(self, row: int, one: int, other: int, gaps: Gaps) -> float | None:
        """Measure the distance (m) of two units; None where one has no shape here, or that takes too long."""
        ends = [
            [
                PlacedGeometry(placed.geometry, placed.owner, self.frames[row, number] @ placed.pose)
                for placed in self.placed
                if placed.owner == number
            ]
            for number in (one, other)
        ]
        is_large = any(
            p.geometry.faces is not None and len(p.geometry.faces) > _MOST_FACES for end in ends for p in end
        )
        if not all(ends) or len(ends[0]) * len(ends[1]) > _MOST_GAPS or is_large:
            return None
        return min(gaps.measure(a, b) for a in ends[0] for b in ends[1])


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """What is known about the pairs that were compared."""

    pair: PlacedPair
    units: Sequence[ComparedUnit]
    sides: Sequence[_PlacedSide]
    samples: LimitSamples
    rows: Indices

    def list_effects(
        self, pairs: Indices, before: Bools, after: Bools, *, are_neighbours: Bools
    ) -> Iterator[MechanismEffect]:
        """Yield the pairs that collide in one version only, at rest or anywhere.

        Those at rest come first, then those that collide most often, and neighbours, which may overlap, last. ``before``,
        ``after``: (K, N), which collide in which of the rows.
        """
        found: list[tuple[int, str, bool, Bools]] = []
        for place in range(len(pairs)):
            old, new = before[place], after[place]
            if old.any() != new.any():
                found.append((place, "pair-collides" if new.any() else "pair-clears", bool(new.any()), new | old))
            elif old[0] != new[0]:
                first = np.zeros(len(old), dtype=bool)
                first[0] = True
                found.append((place, "rest-collides" if new[0] else "rest-clears", bool(new[0]), first))
        found.sort(key=lambda entry: (are_neighbours[entry[0]], not entry[3][0], -int(entry[3].sum()), entry[0]))
        gaps = Gaps() if found else None
        for order, (place, name, is_new, hits) in enumerate(found):
            one, other = pairs[place].tolist()
            overlap = self._measure_overlap(one, other, hits, is_new=is_new, with_depth=order < _MOST_MEASURED)
            if overlap is None:
                continue  # they touch
            depth, row = overlap
            numbers = {"hits": float(hits.sum()), "samples": float(len(self.rows)), "at_rest": float(hits[0])}
            if np.isfinite(depth):
                numbers["depth"] = depth
            other_side = self.sides[0 if is_new else 1]
            allowed = self.samples.is_allowed_before if is_new else self.samples.is_allowed_after
            if gaps is not None and order < _MOST_MEASURED and allowed[row]:
                gap = other_side.measure_gap(row, one, other, gaps)
                if gap is not None:
                    numbers["gap"] = gap
            yield MechanismEffect(
                kind="collision",
                id=name,
                subject=f"link[{self.units[one].name}]",
                other=f"link[{self.units[other].name}]",
                numbers=numbers,
                words={"relation": "neighbours" if are_neighbours[place] else "apart"},
                configuration={} if row == 0 else self._describe_positions(one, other, row),
            )

    def _measure_overlap(
        self, one: int, other: int, hits: Bools, *, is_new: bool, with_depth: bool
    ) -> tuple[float, int] | None:
        """Return the deepest overlap (m) in some of the configurations, and its row; None where they touch and no more."""
        side = self.sides[1 if is_new else 0]
        met = np.flatnonzero(hits)
        picked = met[np.unique(np.linspace(0, len(met) - 1, _MEASURED_ROWS).astype(np.int64))]
        deepest: tuple[float, int] | None = None
        for row in self.rows[picked].tolist():
            overlap = side.colliders.find_deepest_overlap(side.frames[row], one, other, with_depth=with_depth)
            if overlap is not None and overlap.depth > (0.0 if deepest is None else deepest[0]):
                deepest = float(overlap.depth), int(row)
        return deepest

    def _describe_positions(self, one: int, other: int, row: int) -> dict[str, float]:
        """Return the positions of the joints that move one of two units and not the other."""
        units = self.units[one], self.units[other]
        is_old = all(unit.before for unit in units)
        home = self.pair.before if is_old else self.pair.after
        values = self.samples.joints.before if is_old else self.samples.joints.after
        chains = [describe_positions(home, values, unit.before[0] if is_old else unit.after[0], row) for unit in units]
        return {
            name: value
            for chain in chains
            for name, value in chain.items()
            if (name in chains[0]) != (name in chains[1])
        }
