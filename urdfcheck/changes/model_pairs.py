"""Which model of one version is which of the other: by path, then by name, then by structure."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence

from urdfcheck.core import ModelInfo
from urdfcheck.core.mechanism import RobotMechanism
from urdfcheck.core.records import dataclass

# Least share of the names of links and joints that two models have in common to be two versions of one.
LEAST_OVERLAP = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionedModel:
    """A model of one version."""

    info: ModelInfo
    path: str
    """From the folder of the version."""
    mechanism: RobotMechanism | None
    """None where there is no robot."""
    texts: Mapping[str, str]
    """Texts of the files that its parts were typed in, by name."""
    problem: str = ""
    """Why there is no robot."""


@dataclass(frozen=True, slots=True)
class ModelPair:
    """Two versions of one model; None where a version does not have it. ``matched_by``: named | path | name | structure."""

    before: VersionedModel | None
    after: VersionedModel | None
    matched_by: str


def pair_models(
    before: Sequence[VersionedModel], after: Sequence[VersionedModel], *, are_named: bool = True
) -> list[ModelPair]:
    """Pair the models of two versions, in the order of the first; those that only the second has come last.

    ``are_named``: whether two lone models are versions of one because the user says so.
    """
    if are_named and len(before) == len(after) == 1:
        return [ModelPair(before[0], after[0], "named")]
    left, right = list(before), list(after)
    found: dict[int, ModelPair] = {}
    keys: tuple[tuple[str, Callable[[VersionedModel], Hashable]], ...] = (
        ("path", lambda model: (model.path, tuple(sorted(model.info.args.items())))),
        ("path", lambda model: model.path),
        ("name", lambda model: os.path.basename(model.path)),
        ("name", lambda model: model.info.robot or id(model)),
    )
    for way, make_key in keys:
        for one, two in list(_match_unique(left, right, make_key)):
            found[id(one)] = ModelPair(one, two, way)
            left.remove(one)
            right.remove(two)
    for one, two in list(_match_alike(left, right)):
        found[id(one)] = ModelPair(one, two, "structure")
        left.remove(one)
        right.remove(two)
    pairs = [found.get(id(model), ModelPair(model, None, "path")) for model in before]
    return pairs + [ModelPair(None, model, "path") for model in right]


def _match_unique(
    before: Sequence[VersionedModel], after: Sequence[VersionedModel], make_key: Callable[[VersionedModel], Hashable]
) -> Iterator[tuple[VersionedModel, VersionedModel]]:
    """Yield the models that have one key, where only one of each version has it."""
    olds, news = Counter(map(make_key, before)), Counter(map(make_key, after))
    by_key = {make_key(model): model for model in after}
    for model in before:
        key = make_key(model)
        if olds[key] == news[key] == 1:
            yield model, by_key[key]


def _match_alike(
    before: Sequence[VersionedModel], after: Sequence[VersionedModel]
) -> Iterator[tuple[VersionedModel, VersionedModel]]:
    """Yield the models that have most names in common, at least half of them."""
    scores = sorted(
        ((_measure_overlap(one, two), i, j) for i, one in enumerate(before) for j, two in enumerate(after)),
        key=lambda entry: (-entry[0], entry[1], entry[2]),
    )
    used: tuple[set[int], set[int]] = (set(), set())
    for score, i, j in scores:
        if score >= LEAST_OVERLAP and i not in used[0] and j not in used[1]:
            used[0].add(i)
            used[1].add(j)
            yield before[i], after[j]


def _measure_overlap(first: VersionedModel, second: VersionedModel) -> float:
    """Return the share of the names of links and joints that two models have in common; 0 where one has none."""
    if first.mechanism is None or second.mechanism is None:
        return 0.0
    names = [
        {link.name for link in mechanism.links} | {joint.name for joint in mechanism.joints}
        for mechanism in (first.mechanism, second.mechanism)
    ]
    return len(names[0] & names[1]) / max(len(names[0] | names[1]), 1)
