"""The left and the right of a robot: pairs of links that are each other's mirror image, or copies of one part."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.mirror import MirrorPlane, PartOutline, find_mirror_plane, measure_outline_mismatch
from urdfcheck.facts.median import compute_median
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.shape_comparison import (
    ALIKE,
    DIFFERENT,
    compute_centroid,
    get_outline,
    is_alike,
    is_comparable,
    list_alike_links,
    propose_motions,
)
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Origins are mirror images to within a careful hand measurement, or this share of the group's size.
PLACE, PLACE_SHARE = 1e-3, 2e-3
# The normals of planes that are tried first: left and right, front and back, above and below.
NORMALS = tuple(np.eye(3)[[1, 0, 2]])
# Of two ways to bring a part to the other side, both within the tolerance, one is proven by a mismatch so many times smaller.
MUCH_BETTER = 3.0
# Axes are parallel within 1° (cosine), and so many pairs that are not along them show another plane.
_PARALLEL, _MIN_FIRM = 0.99985, 2
# A plane is across an axis if the places of two parts are mirror images to within this share of their distance (chosen: 20°).
_TILTED = 0.35
# Mismatches below this are what products of rotation matrices leave.
_ROUNDING = 1e-9
# More joints of one kind than this that no name distinguishes are a chain or a ring, without left and right.
_MOST_ALIKE = 32


@dataclass(frozen=True, slots=True, eq=False)
class CopyTransform:
    """``x -> rotation x + translation`` takes what one link draws to where another draws the same part."""

    rotation: Array
    translation: Array
    mismatch: float
    """By how much the two differ then, as a share of the part's size."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MirrorPair:
    """Two links on either side of a mirror plane."""

    one: str
    other: str
    plane: MirrorPlane
    """In root coordinates, all joints at zero."""
    linear: Array
    """(3, 3). With ``shift`` it takes coordinates in the frame of ``one`` to those of its mirror image in the frame of
    ``other``.
    """
    shift: Array
    """(3,), metres."""
    mirror_mismatch: float | None
    """By how much what they draw differs from mirror images, as a share of its size; None where a shape is not known."""
    copy_transforms: tuple[CopyTransform, ...]
    """How one part may have been copied from ``one`` to ``other``: as it is in both frames, or as its shapes are placed.
    Empty where a shape is not known.
    """
    uses_shift: bool
    """Whether they are mirror images with ``shift`` but not without it: the frames are at other points of the same part."""
    is_alike: bool | None
    """Whether both draw parts of one shape, wherever in their frames; None where a shape of either is not known, or there
    is none.
    """
    agreeing_pairs: int
    """The number of pairs of the group that are mirrored in place."""
    is_named: bool
    """Whether the names say that they are a pair."""
    ancestry: tuple[frozenset[str], frozenset[str]]
    """Either link and all links on which it hangs."""

    @property
    def copy_mismatch(self) -> float | None:
        """By how much what they draw differs from one part, as a share of its size; None where it is not known."""
        return min((copy.mismatch for copy in self.copy_transforms), default=None)

    @property
    def drawn_as(self) -> str | None:
        """``mirrored``, ``copied``, ``both`` (a symmetric part), ``neither``; None where it is not known."""
        if self.mirror_mismatch is None or self.copy_mismatch is None:
            return None
        if self.mirror_mismatch < ALIKE:
            return "mirrored" if self.copy_mismatch > DIFFERENT else "both"
        if self.copy_mismatch < ALIKE:
            return "copied" if self.mirror_mismatch > DIFFERENT else "both"
        return "neither"

    def is_attached_to(self, above: MirrorPair) -> bool:
        """Whether the pair is another one, or hangs on it."""
        one, other = self.ancestry
        return (above.one in one and above.other in other) or (above.one in other and above.other in one)

    @property
    def is_in_place(self) -> bool:
        """Whether the frames' origins are mirror images."""
        return bool(np.linalg.norm(self.shift) <= PLACE)


def list_alike_links_elsewhere(model: Model, pair: MirrorPair) -> tuple[str, ...]:
    """Return the links outside a pair that draw parts of its shape, mirrored or not, wherever in their frames."""
    return tuple(name for name in list_alike_links(model, pair.one) if name != pair.other)


@fact
def list_named_pairs(model: Model) -> tuple[tuple[str, str], ...]:
    """List the links whose names differ in nothing but the side.

    :raises FactUnavailableError: when the tree is broken.
    """
    return tuple(pair_by_name(model.tree.order))


@fact
def mirror_pairs(model: Model) -> tuple[MirrorPair, ...]:
    """Find left and right links, those nearest to the root first.

    Names reveal the pairs; where names say nothing, mirrored places and mirrored drawings do. The planes are fitted for
    each group of pairs that hang on the same body.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    order = {name: i for i, name in enumerate(model.tree.order)}
    names = [(one, other) for one, other in list_named_pairs(model) if not _is_in_line(model, one, other)]
    pairs = [pair for group in _group_by_body(model, names) for pair in _match_group(model, group)]
    paired = {name for names_ in names for name in names_}
    pairs += _pair_by_geometry(model, [name for name in model.tree.order if name not in paired])
    return tuple(sorted(pairs, key=lambda p: (order[p.one], order[p.other])))


def _is_in_line(model: Model, one: str, other: str) -> bool:
    """Whether one link hangs on the other: the axes of an arm may be called L and R."""
    return _find_common_body(model, one, other) in {one, other}


def _group_by_body(model: Model, names: Iterable[tuple[str, str]]) -> list[list[tuple[str, str]]]:
    """Group the pairs that part at the same body: the fingers of a hand, the arms of a torso."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for one, other in names:
        groups.setdefault(_find_common_body(model, one, other), []).append((one, other))
    return list(groups.values())


def _find_common_body(model: Model, one: str, other: str) -> str:
    """Return the first link of the nearest body on which both links hang, or to which they are fixed."""
    body = model.tree.root
    for first, second in zip(model.tree.find_path_to(one), model.tree.find_path_to(other), strict=False):
        if first is not second:
            break
        body = body if first.type == "fixed" else first.child
    return body


def _find_common_link(model: Model, one: str, other: str) -> str:
    """Return the last link on which both links hang."""
    paths = [[joint.parent for joint in model.tree.find_path_to(name)] for name in (one, other)]
    shared = [first for first, second in zip(*paths, strict=False) if first == second]
    return shared[-1] if shared else model.tree.root


def _match_group(model: Model, group: Sequence[tuple[str, str]]) -> Iterator[MirrorPair]:
    """Yield the pairs of a group that has a mirror plane; each link in one of them, with the partner that lies nearest."""
    counts: dict[str, int] = {}
    for name in (name for names in group for name in names):
        counts[name] = counts.get(name, 0) + 1
    single = [names for names in group if counts[names[0]] == counts[names[1]] == 1]
    normals = list(NORMALS)
    for link in (_find_common_body(model, *group[0]), _find_common_link(model, *group[0])):
        # A link that is fixed to the body by angles like 1.57 has axes beside those of the body.
        normals += [axis for axis in model.frames[link][:3, :3].T if not any((axis == n).all() for n in normals)]
    fitted = (
        _fit_mirror_plane(model, single or group, normals)
        or _fit_some_pairs(model, single, normals, _hang_on_one_link)
        or _fit_some_pairs(model, single, normals, _are_moved)
    )
    if fitted is None:
        return
    plane, agreeing = fitted
    taken: set[str] = set()
    for names in sorted(group, key=lambda names: _measure_misplacement(model, plane, names)):
        if not taken & set(names):
            taken |= set(names)
            yield _make_pair(model, plane, names, agreeing=agreeing, named=True)


def _measure_misplacement(model: Model, plane: MirrorPlane, names: tuple[str, str]) -> float:
    one, other = (model.frames[name][:3, 3] for name in names)
    # In whole micrometres: rounding must not decide between partners at one place.
    return round(float(np.linalg.norm(plane.reflect_points(one) - other)) * 1e6)


def _fit_mirror_plane(
    model: Model, group: Sequence[tuple[str, str]], normals: Sequence[Array]
) -> tuple[MirrorPlane, int] | None:
    ones, others = (np.array([model.frames[names[side]][:3, 3] for names in group]) for side in (0, 1))
    size = float(np.linalg.norm(np.ptp(np.concatenate((ones, others)), axis=0)))
    tolerance = max(PLACE, PLACE_SHARE * size)
    fitted = find_mirror_plane(ones, others, normals=normals, tolerance=tolerance)
    if fitted is not None:
        return _refit_without_hinges(model, group, fitted, tolerance=tolerance)
    if size > PLACE:
        return None
    # All frames are at one place, as those of a gripper that opens by sliding: the parts show where the sides are.
    drawn = [(compute_centroid(model, a), compute_centroid(model, b)) for a, b in group]
    known = [(a, b) for a, b in drawn if a is not None and b is not None]
    if not known:
        return None
    ones, others = (np.array([places[side] for places in known]) for side in (0, 1))
    found = find_mirror_plane(ones, others, normals=normals, tolerance=PLACE)
    if found is None or len(known) > 1 or any(found[0].normal is normal for normal in normals):
        return found
    # A single pair has a plane whatever it is like: that of two parts of which one is tilted is beside an axis.
    across = find_mirror_plane(ones, others, normals=normals, tolerance=_TILTED * float(np.linalg.norm(ones - others)))
    return across if across is not None and any(across[0].normal is normal for normal in normals) else found


def _fit_some_pairs(
    model: Model,
    group: Sequence[tuple[str, str]],
    normals: Sequence[Array],
    counts: Callable[[Model, str, str], bool],
) -> tuple[MirrorPlane, int] | None:
    """Fit the plane to some pairs only, where it is across an axis."""
    some = [names for names in group if counts(model, *names)]
    if not some or len(some) == len(group):
        return None
    fitted = _fit_mirror_plane(model, some, normals)
    return fitted if fitted and any(abs(float(fitted[0].normal @ normal)) > _PARALLEL for normal in normals) else None


def _hang_on_one_link(model: Model, one: str, other: str) -> bool:
    """Whether two links hang on one: a joint out of its place takes all pairs behind it along, which may be most of the group."""
    before = model.tree.parent_joint
    return before[one].parent == before[other].parent


def _are_moved(model: Model, one: str, other: str) -> bool:
    """Whether joints move both links: sensors, marks and covers are where there is room for them."""
    before = model.tree.parent_joint
    return before[one].is_movable and before[other].is_movable


def _refit_without_hinges(
    model: Model, group: Sequence[tuple[str, str]], fitted: tuple[MirrorPlane, int], *, tolerance: float
) -> tuple[MirrorPlane, int]:
    """Return the plane of the pairs whose frames do not lie anywhere along an axis across the plane, where it is another one and
    mirrors as many pairs: where along its axis a hinge is, is a choice, also for what is fixed to it."""
    plane, agreeing = fitted
    firm = [names for names in group if not any(_is_hinged_across(model, plane.normal, name) for name in names)]
    if not firm or len(firm) == len(group):
        return fitted
    ones, others = (np.array([model.frames[names[side]][:3, 3] for names in firm]) for side in (0, 1))
    again = find_mirror_plane(ones, others, normals=[plane.normal], tolerance=tolerance)
    if again is None or again[1] < _MIN_FIRM or abs(again[0].offset - plane.offset) <= PLACE:
        return fitted
    if abs(float(again[0].normal @ plane.normal)) < _PARALLEL:
        return fitted  # one pair that is out of its place spans a plane that leans
    mirrored = [_measure_misplacement(model, again[0], names) <= tolerance * 1e6 for names in group]
    return (again[0], sum(mirrored)) if sum(mirrored) >= agreeing else fitted


def _is_hinged_across(model: Model, normal: Array, name: str) -> bool:
    """Whether the last joint that moves a link turns it about an axis along a direction (3,)."""
    moving = [joint for joint in model.tree.find_path_to(name) if joint.is_movable]
    if not moving or moving[-1].type not in {"revolute", "continuous"} or moving[-1].name not in model.axes:
        return False
    return abs(float(model.axes[moving[-1].name] @ normal)) > _PARALLEL


def _make_pair(model: Model, plane: MirrorPlane, names: tuple[str, str], *, agreeing: int, named: bool) -> MirrorPair:
    linear, shift = plane.relate_frames(*(model.frames[name] for name in names))
    one, other = (get_outline(model, name) for name in names)
    mirror_mismatch: float | None = None
    copies: tuple[CopyTransform, ...] = ()
    uses_shift = False
    if one is not None and other is not None and is_comparable(model, *names):
        with_shift, without_shift = (
            measure_outline_mismatch(one, other, linear=linear, shift=shift),
            measure_outline_mismatch(one, other, linear=linear, shift=np.zeros(3)),
        )
        mirror_mismatch, uses_shift = min(with_shift, without_shift), with_shift < ALIKE <= without_shift
        copies = tuple(
            CopyTransform(turn, move, measure_outline_mismatch(one, other, linear=turn, shift=move))
            for turn, move in propose_motions(model, *names)
        )
        if mirror_mismatch < ALIKE:
            copies += _find_better_images(one, other, linear, mirror_mismatch=mirror_mismatch)
    first, second = (frozenset((name, *(joint.child for joint in model.tree.find_path_to(name)))) for name in names)
    return MirrorPair(
        one=names[0],
        other=names[1],
        plane=plane,
        linear=linear,
        shift=shift,
        mirror_mismatch=mirror_mismatch,
        copy_transforms=copies,
        uses_shift=uses_shift,
        is_alike=is_alike(model, *names),
        agreeing_pairs=agreeing,
        is_named=named,
        ancestry=(first, second),
    )


def _find_better_images(
    one: PartOutline, other: PartOutline, linear: Array, *, mirror_mismatch: float
) -> tuple[CopyTransform, ...]:
    """Find the images that carry what one link draws onto what the other draws, in frames at one point of the part, much better
    than the mirror does: the best half turn, and other mirrors. A part that is nearly its own mirror image may be on the other
    side by a half turn, or its mesh be mirrored by a scale in its own axes."""
    if mirror_mismatch <= _ROUNDING:
        return ()
    found: list[CopyTransform] = []
    still, limit = np.zeros(3), mirror_mismatch / MUCH_BETTER
    for signs in (1.0 - 2.0 * np.eye(3), 2.0 * np.eye(3) - 1.0):
        images = [linear @ np.diag(row) for row in signs]
        copies = [
            CopyTransform(t, still, measure_outline_mismatch(one, other, linear=t, shift=still, limit=limit))
            for t in images
        ]
        found.append(min(copies, key=lambda copy: copy.mismatch))
    return tuple(copy for copy in found if copy.mismatch < limit)


def _pair_by_geometry(model: Model, names: Sequence[str]) -> list[MirrorPair]:
    """Pair links whose names say nothing: like joints that carry like parts, mirrored in place and as drawn."""
    kinds: dict[tuple[str, int], list[str]] = {}
    for name in names:
        joint = model.tree.parent_joint.get(name)
        if joint is not None and joint.is_movable and get_outline(model, name) is not None:
            kinds.setdefault((joint.type, sum(j.is_movable for j in model.tree.find_path_to(name))), []).append(name)
    alike = [
        (one, other)
        for members in kinds.values()
        if len(members) <= _MOST_ALIKE
        for one, other in combinations(members, 2)
        if is_alike(model, one, other)
    ]
    pairs: list[MirrorPair] = []
    for group in _group_by_body(model, alike):
        best: list[MirrorPair] = []
        for normal in NORMALS:
            matched = _match_mirror_images(model, group, normal)
            if len(matched) > len(best):
                best = matched
        pairs += best
    return pairs


def _match_mirror_images(model: Model, group: Sequence[tuple[str, str]], normal: Array) -> list[MirrorPair]:
    """Match the pairs of the plane with this normal that mirrors most places of a group.

    None unless that is most of the group's links, and most of these are drawn mirrored as well.
    """
    least = 0.6 * len({name for names in group for name in names}) / 2
    ones, others = (np.array([model.frames[names[side]][:3, 3] for names in group]) for side in (0, 1))
    apart = np.abs((others - ones) @ normal) > PLACE
    chosen: list[tuple[str, str]] = []
    best = MirrorPlane(normal, 0.0)
    for offset in dict.fromkeys(np.round(((ones + others) / 2.0 @ normal)[apart] / PLACE).tolist()):
        near = apart & (np.abs((ones + others) / 2.0 @ normal - offset * PLACE) <= PLACE)
        plane = MirrorPlane(normal, compute_median(((ones + others) / 2.0 @ normal)[near]))
        mirrored = apart & (np.linalg.norm(plane.reflect_points(ones) - others, axis=1) <= PLACE)
        matched: dict[str, tuple[str, str]] = {}
        for names in (names for names, fits in zip(group, mirrored, strict=True) if fits):
            if not matched.keys() & set(names):
                matched[names[0]] = matched[names[1]] = names
        if len(matched) > 2 * len(chosen):
            chosen, best = list(dict.fromkeys(matched.values())), plane
    if len(chosen) < least:
        return []
    pairs = [_make_pair(model, best, names, agreeing=len(chosen), named=False) for names in chosen]
    drawn = [pair for pair in pairs if pair.drawn_as in {"mirrored", "both"}]
    return drawn if len(drawn) >= least else []
