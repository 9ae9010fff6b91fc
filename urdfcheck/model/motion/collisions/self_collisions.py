"""Which links of a robot collide with each other, each result computed when it is first needed and kept between runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model.fact import fact
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions.at_rest import Contact, compare_at_rest, read_contact
from urdfcheck.model.motion.collisions.proven_apart import prove_apart
from urdfcheck.model.motion.collisions.sampled_hits import detect_hits, pack_hits, sample_evenly, unpack_hits
from urdfcheck.model.motion.collisions.setup import CollisionSetup, Relation
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.parts import Shape
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Bools, Indices

    Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CollisionPair:
    """Two links with collision geometry."""

    links: tuple[str, str]
    """Their names, the first one nearer to the root (tree order)."""
    relation: Relation
    """``fixed``: both belong to one rigid body. ``adjacent``: one body hangs on the other by ``joint``, or by several joints
    with no collision geometry between them, of which ``joint`` is the last (a ball joint written as three hinges). ``far``:
    all others."""
    joint: str | None
    meets_at_neutral: bool
    """Whether they meet at the neutral pose."""
    contact: Contact | None
    """How they meet there; None where they do not, or where they are ``fixed``."""
    is_complete: bool
    """Whether no shape of either link had to be left out (see `SelfCollisions.skipped_shapes`); otherwise they may meet where
    nothing was detected."""
    _index: int
    _collisions: SelfCollisions

    @property
    def hits(self) -> Bools:
        """Whether they meet in each configuration (N,) of `SelfCollisions.poses`; faces in one plane may count.

        The far pairs that overlap at the neutral pose are computed together, when one of them is needed; all other pairs
        are computed when one of these is.
        """
        return self._collisions.get_hits(self._index)

    @property
    def range_share(self) -> float:
        """Of neighbours that overlap at the neutral pose: the share of `SelfCollisions.spread_poses` in which they meet."""
        return self._collisions.compute_range_share(self._index)

    @property
    def is_proven_apart(self) -> bool:
        """Whether it is proven that they meet in no configuration.

        Spheres around their shapes, swept along the chain of joints over the joints' ranges, do not reach each other; or the
        two are one body, and do not meet.
        """
        return self.is_complete and bool(self._collisions.proven_apart[self._index])

    @property
    def hit_count(self) -> int:
        """The number of sampled configurations in which they meet."""
        return int(self.hits.sum())

    @property
    def hit_share(self) -> float:
        """The share of the sampled configurations in which they meet."""
        return self.hit_count / len(self.hits)

    @property
    def is_always_in_collision(self) -> bool:
        """Whether they meet in every sampled configuration."""
        return bool(self.hits.all())

    @property
    def is_never_in_collision(self) -> bool:
        """Whether they meet in no sampled configuration; `is_proven_apart` says whether that is a proof."""
        return not self.hits.any()

    @property
    def first_hit(self) -> int | None:
        """The first sampled configuration in which they meet."""
        return int(self.hits.argmax()) if self.hits.any() else None


@dataclass(frozen=True, eq=False)
class SelfCollisions:
    """The self-collisions of a robot."""

    setup: CollisionSetup
    cache_entry: MutableMapping[str, Arrays]
    """Where results are kept between runs."""
    rest_results: Arrays
    """The arrays of `compare_at_rest`."""

    @property
    def sample_count(self) -> int:
        """N, the number of sampled configurations."""
        return max(1, self.setup.model.samples)

    @cached_property
    def poses(self) -> JointConfigurations:
        """The N configurations, the first of them neutral."""
        return poses.sample_configurations(self.setup.model, self.sample_count)

    @cached_property
    def spread_poses(self) -> JointConfigurations:
        """Configurations (N/5, J) spread evenly over each joint's range: enough for neighbours, which one joint usually moves."""
        return sample_evenly(self.setup.model, max(1, self.sample_count // 5))

    @cached_property
    def skipped_shapes(self) -> tuple[Shape, ...]:
        """Collision shapes that could not be placed (an unreadable mesh, a malformed number, an unknown kind of geometry)."""
        return tuple(shape for _, shape in self.setup.unusable_shapes)

    @cached_property
    def pairs(self) -> tuple[CollisionPair, ...]:
        """All pairs of links with collision geometry that could be read, in tree order."""
        setup, arrays = self.setup, self.rest_results
        contacts = {k: read_contact(setup, arrays, row) for row, k in enumerate(arrays["contacts"].tolist())}
        met, incomplete = set(arrays["met"].tolist()), {name for name, _ in setup.unusable_shapes}
        names = [link.name for link in setup.links]
        return tuple(
            CollisionPair(
                links=(names[a], names[b]),
                relation=relation,
                joint=joint,
                meets_at_neutral=k in met,
                contact=contacts.get(k),
                is_complete=names[a] not in incomplete and names[b] not in incomplete,
                _index=k,
                _collisions=self,
            )
            for k, ((a, b), (relation, joint)) in enumerate(zip(setup.pairs.tolist(), setup.relations, strict=True))
        )

    @cached_property
    def proven_apart(self) -> Bools:
        """Whether it is proven that the links of each pair (K,) meet in no configuration, see `CollisionPair.is_proven_apart`."""
        try:
            known: Bools = self.cache_entry["never"]["proven"]
            return known
        except KeyError:
            proven = prove_apart(self.setup)
            proven[self._fixed_mask] = True
            proven[self.rest_results["met"]] = False
            self.cache_entry["never"] = {"proven": proven}
            return proven

    def get_hits(self, pair_index: int) -> Bools:
        """Return whether a pair meets in each configuration (N,), see `CollisionPair.hits`."""
        row = np.flatnonzero(self._far_overlaps == pair_index)
        hits: Bools = self._far_hits[row[0]] if len(row) else self._all_hits[pair_index]
        return hits

    def compute_range_share(self, pair_index: int) -> float:
        """Return the share of configurations in which neighbours meet, see `CollisionPair.range_share`."""
        (row,) = np.flatnonzero(self._find_overlapping_pairs("adjacent") == pair_index)
        return float(self._neighbour_hits[row].mean())

    @cached_property
    def _fixed_mask(self) -> Bools:
        return np.array([relation == "fixed" for relation, _ in self.setup.relations], dtype=bool)

    def _find_overlapping_pairs(self, relation: Relation) -> Indices:
        """Return the indices of the pairs of a relation that overlap at the neutral pose."""
        overlapping: Indices = self.rest_results["contacts"][self.rest_results["depth"] > 0]
        selected: Indices = overlapping[[self.setup.relations[k][0] == relation for k in overlapping.tolist()]]
        return selected

    @cached_property
    def _neighbour_hits(self) -> Bools:
        return self._recall_or_detect("neighbours", self._find_overlapping_pairs("adjacent"), lambda: self.spread_poses)

    @cached_property
    def _far_overlaps(self) -> Indices:
        return self._find_overlapping_pairs("far")

    @cached_property
    def _far_hits(self) -> Bools:
        return self._recall_or_detect("far", self._far_overlaps, lambda: self.poses)

    @cached_property
    def _all_hits(self) -> Bools:
        """(K, N)."""
        _ = self.poses  # raises for too many joints before anything is computed
        hits = np.zeros((len(self._fixed_mask), self.sample_count), dtype=bool)
        hits[self.rest_results["met"][self._fixed_mask[self.rest_results["met"]]]] = True
        others = ~self._fixed_mask & ~self.proven_apart
        others[self._far_overlaps] = False
        hits[others] = self._recall_or_detect("others", np.flatnonzero(others), lambda: self.poses)
        hits[self._far_overlaps] = self._far_hits
        return hits

    def _recall_or_detect(self, group: str, pair_indices: Indices, sample: Callable[[], JointConfigurations]) -> Bools:
        """Return whether some pairs meet in each of some configurations, from the cache where it holds the group."""
        if not len(pair_indices):
            return np.zeros((0, self.sample_count), dtype=bool)
        group = f"{group}-{self.sample_count}"
        try:
            arrays = self.cache_entry[group]
        except KeyError:
            arrays = self.cache_entry[group] = pack_hits(detect_hits(self.setup, sample(), pair_indices))
        return unpack_hits(arrays, len(pair_indices))


@fact
def self_collisions(model: Model) -> SelfCollisions:
    """Compare all pairs of links at the neutral pose, or recall the result of an earlier run.

    :raises FactUnavailableError: when coal is not installed, or when the tree, an origin or an axis is broken.
    """
    setup = CollisionSetup.from_model(model)
    entry = model.cache.entry("collision", setup.compute_key())
    try:
        arrays = entry["rest"]
    except KeyError:
        arrays = entry["rest"] = compare_at_rest(setup)
    return SelfCollisions(setup, entry, arrays)


def ensure_all_shapes_read(collisions: SelfCollisions) -> None:
    """Refuse to call a model clean whose shapes were not all compared.

    :raises FactUnavailableError: when shapes had to be left out.
    """
    if collisions.skipped_shapes:
        names = list(dict.fromkeys(shape.element.subject.split("]")[0] + "]" for shape in collisions.skipped_shapes))
        raise FactUnavailableError(f"collision shapes could not be measured and were left out: {join_names(names)}")
