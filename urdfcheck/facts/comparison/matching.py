"""Which link and joint of one version is which of the other: by name, then by tree, frame, geometry and inertia."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

import numpy as np

from urdfcheck.core.mechanism import MechanismLink, RobotMechanism
from urdfcheck.core.records import dataclass
from urdfcheck.facts.comparison.home_pose import HomePose, compute_home_pose, is_same_number, measure_shift

# Least share of the evidence that must agree for a link to be the same under another name, and least weight of what agrees:
# the place in the tree alone is not enough.
LEAST_CONFIDENCE, LEAST_WEIGHT = 0.6, 0.35
# By how much the best candidate must exceed the next one.
LEAST_LEAD = 0.05
# Of more pairs of candidates under one parent none is matched: published robots have up to a dozen children of one link.
MOST_CANDIDATES = 10_000
# A frame that is nearer than this, in m and rad, to where the other one is: the same place, to the accuracy of a drawing.
_NEAR = 1e-3


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Correspondence:
    """Which part of the first version is which of the second."""

    links: Mapping[str, str]
    joints: Mapping[str, str]
    confidences: Mapping[str, float]
    """Of links with another name in the second version: how much of the evidence agrees, within (0, 1]."""


def match_mechanisms(before: RobotMechanism, after: RobotMechanism) -> Correspondence:
    """Match links and joints: equal names first, then what is alike at the same place of the tree."""
    first, second = compute_home_pose(before), compute_home_pose(after)
    links = {name: name for name in first.links if name in second.links}
    confidences = dict(_match_below_joints(first, second, links))
    confidences.update(_match_renamed(first, second, links))
    links = {name: links[name] for name in first.order if name in links}
    return Correspondence(links=links, joints=_match_joints(first, second, links), confidences=confidences)


def _match_below_joints(first: HomePose, second: HomePose, links: dict[str, str]) -> Iterator[tuple[str, float]]:
    """Match links with different names below joints of one name, from the ends inwards, and note them in ``links``.

    Yields them with their confidence. What hangs on them, and on what they hang, need not be matched yet.
    """
    taken = set(links.values())
    for old in reversed(first.order):
        upper = first.joint_above.get(old)
        if old in links or upper is None or upper.name not in second.joints:
            continue
        new = second.joints[upper.name].child
        if new in taken:
            continue
        confidence, weight = _weigh_evidence(first, second, links, taken, (old, new))
        if confidence >= LEAST_CONFIDENCE and weight >= LEAST_WEIGHT:
            links[old] = new
            taken.add(new)
            yield old, confidence


def _match_renamed(first: HomePose, second: HomePose, links: dict[str, str]) -> Iterator[tuple[str, float]]:
    """Match links with different names, from the root outwards, and note them in ``links``; yield them with their confidence.

    Candidates are the roots, and the links that hang on two matched ones.
    """
    taken = set(links.values())
    yield from _select_pairs(first, second, links, taken, ([first.mechanism.root], [second.mechanism.root]))
    for parent in first.order:
        if parent in links:
            olds = [joint.child for joint in first.joints_below[parent]]
            news = [joint.child for joint in second.joints_below[links[parent]]]
            yield from _select_pairs(first, second, links, taken, (olds, news))


def _select_pairs(
    first: HomePose,
    second: HomePose,
    links: dict[str, str],
    taken: set[str],
    candidates: tuple[Sequence[str], Sequence[str]],
) -> Iterator[tuple[str, float]]:
    """Match those of the candidates that are clearly alike; note them in ``links`` and ``taken``."""
    olds = [name for name in candidates[0] if name not in links]
    news = [name for name in candidates[1] if name not in taken]
    if len(olds) * len(news) > MOST_CANDIDATES:
        return
    scores = {(old, new): _weigh_evidence(first, second, links, taken, (old, new)) for old in olds for new in news}
    for (old, new), (confidence, weight) in sorted(scores.items(), key=lambda item: -item[1][0]):
        if confidence < LEAST_CONFIDENCE or weight < LEAST_WEIGHT or old in links or new in taken:
            continue
        rivals = (
            other
            for (one, two), (other, _) in scores.items()
            if (one == old) != (two == new) and one not in links and two not in taken
        )
        if confidence - max(rivals, default=0.0) >= LEAST_LEAD:
            links[old] = new
            taken.add(new)
            yield old, confidence


def _weigh_evidence(
    first: HomePose, second: HomePose, links: Mapping[str, str], taken: AbstractSet[str], names: tuple[str, str]
) -> tuple[float, float]:
    """Return the share of the evidence that agrees for two links at the same place of the tree, and its weight."""
    old, new = names
    one, two = first.links[old], second.links[new]
    upper, lower = first.joint_above.get(old), second.joint_above.get(new)
    evidence: list[tuple[float, bool]] = []
    if upper is not None and lower is not None:
        evidence.append((0.05, upper.type == lower.type))
        poses = (np.array(joint.pose).reshape(4, 4) for joint in (upper, lower))
        evidence.append((0.2, max(measure_shift(*poses)) < _NEAR))
        evidence.append((0.2, upper.name == lower.name))
    if old in new or new in old:  # a prefix came or went; other names prove nothing
        evidence.append((0.15, True))
    if one.shapes or two.shapes:
        evidence.append((0.25, _list_geometries(one) == _list_geometries(two)))
    if one.has_inertial or two.has_inertial:
        same = is_same_number(one.mass, two.mass) and len(one.tensor) == len(two.tensor)
        evidence.append((0.2, same and np.allclose(one.tensor, two.tensor, rtol=1e-5, atol=1e-12)))
    children = {links[j.child] for j in first.joints_below[old] if j.child in links}
    others = {j.child for j in second.joints_below[new] if j.child in taken}
    if children or others:
        evidence.append((0.2, children == others))
    elif not first.joints_below[old] and not second.joints_below[new]:
        evidence.append((0.05, True))
    else:
        evidence.append((0.1, len(first.joints_below[old]) == len(second.joints_below[new])))
    agreed = sum(weight for weight, agrees in evidence if agrees)
    return agreed / sum(weight for weight, _ in evidence), agreed


def _list_geometries(link: MechanismLink) -> list[tuple[str, str, str, tuple[float, ...]]]:
    return sorted(
        (
            shape.role,
            shape.kind,
            shape.digest or shape.mesh.rpartition("/")[2],
            tuple(float(f"{value:.6g}") for value in shape.size),
        )
        for shape in link.shapes
    )


def _match_joints(first: HomePose, second: HomePose, links: Mapping[str, str]) -> dict[str, str]:
    """Match the joints above matched links, then the rest by name."""
    joints: dict[str, str] = {}
    taken: set[str] = set()
    above = {
        upper.name: second.joint_above[new].name
        for old, new in links.items()
        if (upper := first.joint_above.get(old)) is not None and new in second.joint_above
    }
    # A joint that keeps its name and its child is certain; one that has only a child in common may have changed its name.
    for keeps_name in (True, False):
        for old, new in above.items():
            if old in joints or new in taken or (old == new) != keeps_name:
                continue
            if not keeps_name and (old in second.joints or new in first.joints):
                continue  # a joint was put in between, or taken out: the other version has this one elsewhere
            joints[old] = new
            taken.add(new)
    return joints
