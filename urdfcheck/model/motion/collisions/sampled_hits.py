"""In which configurations, sampled over the joints' limits, pairs of links meet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions.setup import CollisionSetup
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Bools, Indices

    Arrays = Mapping[str, NDArray[Any]]

# Configurations whose placements are in memory together.
_BATCH_SIZE = 500


def detect_hits(setup: CollisionSetup, configurations: JointConfigurations, pair_indices: Indices) -> Bools:
    """Return whether some pairs (n,) meet in each of some configurations, as an array (n, N)."""
    batches = [
        setup.colliders.detect_collisions(
            setup.compute_placements(
                JointConfigurations(configurations.joints, configurations.values[start : start + _BATCH_SIZE])
            ),
            setup.pairs[pair_indices],
        )
        for start in range(0, len(configurations.values), _BATCH_SIZE)
    ]
    return np.concatenate(batches, axis=1)


def pack_hits(hits: Bools) -> Arrays:
    """Pack an array (n, N) for the cache: rows that hold a hit, as bits."""
    met = np.flatnonzero(hits.any(axis=1))
    return {"met": met, "hits": np.packbits(hits[met], axis=1), "count": np.array(hits.shape[1])}


def unpack_hits(arrays: Arrays, pair_count: int) -> Bools:
    """Return the array (n, N) that `pack_hits` packed, of ``pair_count`` rows."""
    count = int(arrays["count"])
    hits = np.zeros((pair_count, count), dtype=bool)
    hits[arrays["met"]] = np.unpackbits(arrays["hits"], axis=1, count=count)
    return hits


def sample_evenly(model: Model, count: int) -> JointConfigurations:
    """Sample ``count`` configurations that spread each joint evenly over its range, followers where ``<mimic>`` puts them.

    A Latin hypercube (McKay, Beckman and Conover, 1979): every joint takes its values in another order.
    """
    drawn = poses.sample_configurations(model, count + 1)
    ranks = np.argsort(np.argsort(drawn.values[1:], axis=0, kind="stable"), axis=0, kind="stable")
    low, high = np.array([poses.get_sampling_range(joint) for joint in drawn.joints]).reshape(-1, 2).T
    return poses.apply_mimics(JointConfigurations(drawn.joints, low + (ranks + 0.5) / count * (high - low)))
