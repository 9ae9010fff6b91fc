"""The differences of two mechanisms: structure, motion, limits, mass, shapes and everything else."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from urdfcheck.core.mechanism import MechanismExtra, RobotMechanism, Trace
from urdfcheck.core.model_diff import CATEGORIES, CollisionDiff, MechanismChange, MechanismDiff, MechanismEffect
from urdfcheck.facts.arrays import Mat4, Vec3
from urdfcheck.facts.comparison.alignment import PlacedPair, align_links
from urdfcheck.facts.comparison.bodies import BodyPair, pair_bodies
from urdfcheck.facts.comparison.contents import compare_masses, compare_shapes
from urdfcheck.facts.comparison.home_pose import HomePose, compute_home_pose, invert_pose
from urdfcheck.facts.comparison.joint_loads import compare_joint_inertias, compare_torques
from urdfcheck.facts.comparison.joints import compare_joints
from urdfcheck.facts.comparison.matching import Correspondence, match_mechanisms
from urdfcheck.facts.comparison.motion import compute_displacements, measure_shifts, sample_joints
from urdfcheck.facts.comparison.stances import compare_stances
from urdfcheck.facts.comparison.structure import NOTE, compare_structure, list_frame_notes
from urdfcheck.facts.comparison.surfaces import GeometryReader, SurfaceComparison

# What may change how a robot stands; of a link without collision shapes the drawn ones count.
_STANDING = frozenset({"structure", "kinematic", "dynamic", "collision", "visual"})
# What may change the inertia of a joint, apart from places, which are reported as such.
_ACCELERATING = frozenset({"structure", "dynamic"})
# What may move a link, load a joint or bring two shapes together.
_COLLIDING = frozenset({"structure", "kinematic", "limits", "collision"})
_MOVING, _LOADING = frozenset({"structure", "kinematic"}), frozenset({"structure", "kinematic", "dynamic"})


def compare_mechanisms(
    before: RobotMechanism, after: RobotMechanism, read: GeometryReader | None = None, *, with_collisions: bool = True
) -> MechanismDiff:
    """Compare two versions of a robot. Without changes they move and weigh alike, which is proven, not sampled.

    ``read``: gives the geometry of shapes; without it, surfaces and collisions are not compared.
    """
    with np.errstate(all="ignore"):  # numbers that overflow are findings, not warnings of numpy
        return _compare_placed(_place_pair(before, after, match_mechanisms(before, after)), read, with_collisions)


def _compare_placed(pair: PlacedPair, read: GeometryReader | None, with_collisions: bool) -> MechanismDiff:
    before, after = pair.before.mechanism, pair.after.mechanism
    bodies = pair_bodies(pair)
    found = [
        *compare_structure(pair, bodies),
        *compare_joints(pair),
        *(change for body in bodies for change in compare_masses(pair, body)),
        *compare_shapes(pair, bodies, SurfaceComparison(read)),
        *_compare_robot_names(before, after),
        *_compare_extras(before, after),
    ]
    notes = [*(change for change in found if change.category == NOTE), *list_frame_notes(pair)]
    changes = [change for change in found if change.category != NOTE]
    changes.sort(key=lambda change: CATEGORIES.index(change.category))
    categories = {change.category for change in changes}
    shifts, torques, count = [], [], 0
    effects: list[MechanismEffect] = []
    if categories & _LOADING:
        samples = sample_joints(pair)
        moved = (
            compute_displacements(pair.before, samples.before, samples.count),
            compute_displacements(pair.after, samples.after, samples.count),
        )
        count = samples.count
        if categories & _MOVING:
            shifts = measure_shifts(pair, samples, *moved)
        if categories & _ACCELERATING:
            effects += compare_joint_inertias(pair, samples, *moved)
        torques = sorted(compare_torques(pair, *moved), key=lambda t: -abs(t.after - t.before) / max(t.before, t.after))
    if categories & _STANDING:
        effects += compare_stances(pair)
    collisions = None
    if read is not None and with_collisions and categories & _COLLIDING:
        collisions = _compare_collisions(pair, bodies, read)
    masses = [sum(link.mass or 0.0 for link in mechanism.links) for mechanism in (before, after)]
    return MechanismDiff(
        changes=tuple(changes),
        notes=tuple(notes),
        shifts=tuple(shifts),
        torques=tuple(torques),
        mass=(masses[0], masses[1]),
        com_shift=float(np.linalg.norm(_compute_com(pair.after) - _compute_com(pair.before))) if all(masses) else 0.0,
        samples=count,
        collisions=collisions,
        effects=(*(() if collisions is None else collisions.effects), *effects),
        root_pose=tuple(map(float, _compute_root_pose(pair).ravel())),
    )


def _compare_collisions(pair: PlacedPair, bodies: Sequence[BodyPair], read: GeometryReader) -> CollisionDiff | None:
    from urdfcheck.facts.comparison.collisions import compare_collisions  # loads coal, which masses do not need

    try:
        return compare_collisions(pair, bodies, read)
    except ImportError:  # coal has no wheels for every platform, and urdfcheck-core leaves out scipy too
        return None


def _place_pair(before: RobotMechanism, after: RobotMechanism, match: Correspondence) -> PlacedPair:
    """Place both versions in the frame of the link that is nearest to the roots and that both have."""
    anchor = next((link.name for link in before.links if link.name in match.links), None)
    new_anchor = None if anchor is None else match.links[anchor]
    return align_links(compute_home_pose(before, anchor), compute_home_pose(after, new_anchor), match)


def _compute_root_pose(pair: PlacedPair) -> Mat4:
    """Return the pose of the first version's root in the frame of the second's."""
    old, new = (home.frames[home.mechanism.root] for home in (pair.before, pair.after))
    pose: Mat4 = invert_pose(new) @ old
    return pose


def _compute_com(home: HomePose) -> Vec3:
    """Return the COM of the whole robot with all joints at zero; zero for a robot without mass."""
    weights = [(link.mass or 0.0, home.frames[name], link.com or (0.0, 0.0, 0.0)) for name, link in home.links.items()]
    total = sum(mass for mass, _, _ in weights)
    places = ((mass, frame[:3, :3] @ np.array(com) + frame[:3, 3]) for mass, frame, com in weights)
    com: Vec3 = sum((mass * place for mass, place in places), np.zeros(3)) / (total or 1.0)
    return com


def _compare_robot_names(before: RobotMechanism, after: RobotMechanism) -> Iterator[MechanismChange]:
    if before.name != after.name:
        words = {"before": before.name, "after": after.name}
        traces = before.name_trace, after.name_trace
        yield MechanismChange(
            category="extension", id="robot-renamed", subject="robot", words=words, before=traces[0], after=traces[1]
        )


def _compare_extras(before: RobotMechanism, after: RobotMechanism) -> Iterator[MechanismChange]:
    """Yield what else is written differently, one change for each label; the order of the elements means nothing."""
    olds, news = _group_extras(before.extras), _group_extras(after.extras)
    for label in dict.fromkeys((*olds, *news)):
        one, two = olds.get(label, []), news.get(label, [])
        gone = Counter(extra.content for extra in one) - Counter(extra.content for extra in two)
        came = Counter(extra.content for extra in two) - Counter(extra.content for extra in one)
        if not gone and not came:
            continue
        what = "extra-changed" if gone and came else "extra-removed" if gone else "extra-added"
        yield MechanismChange(
            category="extension",
            id=what,
            subject=label,
            before=_join_traces(extra.trace for extra in one if extra.content in gone),
            after=_join_traces(extra.trace for extra in two if extra.content in came),
        )


def _join_traces(traces: Iterable[Trace]) -> Trace:
    known = list(traces)
    places = dict.fromkeys(span for trace in known for span in trace.places)
    calls = dict.fromkeys(span for trace in known for span in trace.calls)
    return Trace(tuple(places), tuple(calls))


def _group_extras(extras: tuple[MechanismExtra, ...]) -> dict[str, list[MechanismExtra]]:
    groups: dict[str, list[MechanismExtra]] = {}
    for extra in extras:
        groups.setdefault(extra.label, []).append(extra)
    return groups
