"""The left and the right of a robot: pairs of links that are each other's mirror image, or copies of one part."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.likeness.mirror import MirrorPlane, find_mirror_plane, measure_deviation, measure_outline_mismatch
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.shape_signature import ALIKE, DIFFERENT, ShapeComparer

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Origins are mirror images to within a careful hand measurement, or this share of the group's size.
PLACE, PLACE_SHARE = 1e-3, 2e-3
# The planes that are tried first: left and right, front and back, above and below.
NORMALS = tuple(np.eye(3)[[1, 0, 2]])
# Words of a name: camel case, digits and punctuation part them.
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^A-Za-z\d]+")
_SIDES = re.compile(r"left|right", re.IGNORECASE)
_OTHER: Mapping[str, str] = {"left": "right", "right": "left", "l": "r", "r": "l"}
# Names with more words that could tell a side than this are not names of a side.
_MOST = 4
# More joints of one kind than this that no name tells apart are a chain or a ring, and have no left and right.
_MOST_ALIKE = 32


@dataclass(frozen=True, slots=True, eq=False)
class CopyTransform:
    """``x -> turn x + move`` takes what one link draws to where another draws the same part, but for ``mismatch`` (a share of
    its size)."""

    rotation: Array
    translation: Array
    mismatch: float


@dataclass(frozen=True, slots=True, eq=False)
class MirrorPair:
    """Two links on either side of a mirror ``plane`` (root coordinates, all joints at zero).

    ``linear`` (3, 3) and ``shift`` (3,) take coordinates in the frame of ``one`` to those of its mirror image in the frame of
    ``other``. ``mirrored``: by how much what they draw differs from mirror images, as a share of its size, and ``copies``: how
    one part may have been copied from ``one`` to ``other``: as it stands in both frames, or as its shapes are placed. None
    and none where a shape is not known. ``slides``: it is mirrored with ``shift``, without which it is not: the frames lie
    at other places of the same part. ``alike``: whether both draw parts of one shape wherever in their frames; None where a
    shape of either is not known, or there is none. ``agreeing`` pairs of the group are mirrored in place. ``named``: the
    names say that they are a pair. ``lines``: either link and all that it hangs on.
    """

    one: str
    other: str
    plane: MirrorPlane
    linear: Array
    shift: Array
    mirror_mismatch: float | None
    copy_transforms: tuple[CopyTransform, ...]
    uses_shift: bool
    is_alike: bool | None
    agreeing_pairs: int
    is_named: bool
    comparer: ShapeComparer
    ancestry: tuple[frozenset[str], frozenset[str]]

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

    @property
    def alike_links(self) -> tuple[str, ...]:
        """The links outside the pair that draw parts of its shape, mirrored or not, wherever in their frames."""
        return tuple(name for name in self.comparer.list_alike(self.one) if name != self.other)

    def is_attached_to(self, above: MirrorPair) -> bool:
        """Whether the pair is another, or hangs on it."""
        one, other = self.ancestry
        return (above.one in one and above.other in other) or (above.one in other and above.other in one)

    @property
    def is_in_place(self) -> bool:
        """Whether the frames' origins are mirror images."""
        return bool(np.linalg.norm(self.shift) <= PLACE)


def mirror_pairs(model: Model) -> tuple[MirrorPair, ...]:
    """Left and right links, those nearest to the root first.

    Pairs are told by their names; where names say nothing, by mirrored places and mirrored drawings. The planes are found
    for each group of pairs that hang on the same body.

    :raises Unavailable: when the tree is broken or an origin is malformed.
    """
    order = {name: i for i, name in enumerate(model.tree.order)}
    names = [(one, other) for one, other in _pair_by_name(order) if not _is_in_line(model, one, other)]
    looks = ShapeComparer(model)
    found = [pair for group in _group_by_body(model, names) for pair in _match_group(model, group, looks)]
    known = {name for names_ in names for name in names_}
    found += _pair_by_geometry(model, [name for name in model.tree.order if name not in known], looks)
    return tuple(sorted(found, key=lambda p: (order[p.one], order[p.other])))


def estimate_from_twin(model: Model, link: Link, among: Iterable[MirrorPair] | None = None) -> DeclaredInertial | None:
    """The inertial of the other side's link, mirrored and in the frame of this one. ``among``: the pairs, where they are known.

    Only where what both draw says that the parts are mirror images, and their poses are. Of a symmetric part, which a copy
    may stand for as well, it is the copy where that is nearer to what this link declares.
    """
    own = read_declared_inertial(link)
    for pair in mirror_pairs(model) if among is None else among:
        if link.name not in {pair.one, pair.other} or pair.drawn_as not in {"mirrored", "both"}:
            continue
        back = pair.one == link.name
        other = read_declared_inertial(model.link_by_name[pair.other if back else pair.one])
        if other is not None:
            choices = [mirror_inertial(other, pair, inverse=back)]
            choices += [
                copy_inertial(other, copy, inverse=back) for copy in pair.copy_transforms if copy.mismatch < DIFFERENT
            ]
            return choices[0] if own is None else min(choices, key=lambda one: measure_deviation(own, one).worst)
    return None


def read_declared_inertial(link: Link) -> DeclaredInertial | None:
    """What the link's ``<inertial>`` says; None when there is none, a number is malformed or the mass is not positive."""
    inertial = link.inertial
    if inertial is None or inertial.mass is None or not inertial.mass > 0 or inertial.tensor is None:
        return None
    matrix = inertial.origin.matrix
    return None if matrix is None else DeclaredInertial(inertial.mass, matrix[:3, 3], inertial.tensor, matrix[:3, :3])


def mirror_inertial(numbers: DeclaredInertial, pair: MirrorPair, *, inverse: bool = False) -> DeclaredInertial:
    """The inertial of ``pair.one`` as that of ``pair.other`` should be; with ``back`` the other way round.

    It keeps the tensor and mirrors its axes, which are turned over so that they stay right-handed.
    """
    linear = pair.linear.T if inverse else pair.linear
    shift = np.zeros(3)
    if pair.uses_shift:
        shift = -pair.linear.T @ pair.shift if inverse else pair.shift
    # -1 turns an improper rotation into a proper one, and leaves every tensor as it is.
    return DeclaredInertial(numbers.mass, linear @ numbers.com + shift, numbers.tensor, -linear @ numbers.rotation)


def copy_inertial(numbers: DeclaredInertial, copy: CopyTransform, *, inverse: bool = False) -> DeclaredInertial:
    """The inertial of one link as that of another that holds the same part; with ``back`` the other way round."""
    turn, move = (
        (copy.rotation.T, -copy.rotation.T @ copy.translation) if inverse else (copy.rotation, copy.translation)
    )
    return DeclaredInertial(numbers.mass, turn @ numbers.com + move, numbers.tensor, turn @ numbers.rotation)


def _pair_by_name(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Names that differ in nothing but the side, each pair once, in the order of the names."""
    known = list(names)
    place = {name: i for i, name in enumerate(known)}
    words = {word for name in known for word in _WORDS.findall(name)}
    for name in known:
        for other in dict.fromkeys(_list_other_side_names(name, words)):
            if place.get(other, -1) > place[name]:
                yield name, other


def _list_other_side_names(name: str, known: Set[str]) -> Iterator[str]:
    """What a name may be on the other side: every choice of its words that tell a side, changed for one that is ``known``."""
    words = _WORDS.findall(name)
    others = [[other for other in _list_other_side_words(word) if other in known] for word in words]
    places = [i for i, options in enumerate(others) if options]
    if len(places) > 2 * _MOST:
        return
    for count in range(1, min(len(places), _MOST) + 1):
        for chosen in combinations(places, count):
            choices = [""]
            for i, word in enumerate(words):
                options = others[i] if i in chosen else [word]
                choices = [before + option for before in choices for option in options]
            yield from choices


def _list_other_side_words(word: str) -> Iterator[str]:
    """A word of the other side: ``left``, ``l``, ``lf``, ``fl``, ``larm``. Whether that means anything, the other name tells."""
    if _SIDES.search(word):
        yield _SIDES.sub(lambda match: _match_case(_OTHER[match.group().lower()], match.group()), word)
        return
    for place in dict.fromkeys((0, len(word) - 1)):
        other = _OTHER.get(word[place].lower())
        if other is not None:
            yield word[:place] + _match_case(other, word[place]) + word[place + 1 :]


def _match_case(word: str, like: str) -> str:
    """The word in capitals, or with a capital, like the other."""
    if like.isupper():
        return word.upper()
    return word.capitalize() if like[0].isupper() else word


def _is_in_line(model: Model, one: str, other: str) -> bool:
    """Whether one link hangs on the other: the axes of an arm may be called L and R."""
    return _find_common_body(model, one, other) in {one, other}


def _group_by_body(model: Model, names: Iterable[tuple[str, str]]) -> list[list[tuple[str, str]]]:
    """Pairs that part at the same body: the fingers of a hand, the arms of a torso."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for one, other in names:
        groups.setdefault(_find_common_body(model, one, other), []).append((one, other))
    return list(groups.values())


def _find_common_body(model: Model, one: str, other: str) -> str:
    """The first link of the nearest body that both links hang on, or are fixed to."""
    found = model.tree.root
    for first, second in zip(model.tree.find_path_to(one), model.tree.find_path_to(other), strict=False):
        if first is not second:
            break
        found = found if first.type == "fixed" else first.child
    return found


def _match_group(model: Model, group: Sequence[tuple[str, str]], looks: ShapeComparer) -> Iterator[MirrorPair]:
    """The pairs of a group that has a mirror plane; each link in one of them, with the partner that lies nearest."""
    counts: dict[str, int] = {}
    for name in (name for names in group for name in names):
        counts[name] = counts.get(name, 0) + 1
    single = [names for names in group if counts[names[0]] == counts[names[1]] == 1]
    body = model.frames[_find_common_body(model, *group[0])][:3, :3]
    fitted = _fit_mirror_plane(model, single or group, (*NORMALS, *body.T), looks)
    if fitted is None:
        return
    plane, agreeing = fitted
    taken: set[str] = set()
    for names in sorted(group, key=lambda names: _measure_misplacement(model, plane, names)):
        if not taken & set(names):
            taken |= set(names)
            yield _make_pair(model, plane, names, looks, agreeing, named=True)


def _measure_misplacement(model: Model, plane: MirrorPlane, names: tuple[str, str]) -> float:
    one, other = (model.frames[name][:3, 3] for name in names)
    # In micrometres: rounding must not decide between partners at one place.
    return round(float(np.linalg.norm(plane.reflect_points(one) - other)) * 1e6)


def _fit_mirror_plane(
    model: Model, group: Sequence[tuple[str, str]], normals: Sequence[Array], looks: ShapeComparer
) -> tuple[MirrorPlane, int] | None:
    ones, others = (np.array([model.frames[names[side]][:3, 3] for names in group]) for side in (0, 1))
    size = float(np.linalg.norm(np.ptp(np.concatenate((ones, others)), axis=0)))
    found = find_mirror_plane(ones, others, normals, tolerance=max(PLACE, PLACE_SHARE * size))
    if found is not None or size > PLACE:
        return found
    # All frames at one place, as those of a gripper that opens by sliding: the parts tell where the sides are.
    drawn = [(looks.compute_centroid(a), looks.compute_centroid(b)) for a, b in group]
    known = [(a, b) for a, b in drawn if a is not None and b is not None]
    return find_mirror_plane([a for a, _ in known], [b for _, b in known], normals, tolerance=PLACE) if known else None


def _make_pair(
    model: Model, plane: MirrorPlane, names: tuple[str, str], looks: ShapeComparer, agreeing: int, *, named: bool
) -> MirrorPair:
    linear, shift = plane.relate_frames(*(model.frames[name] for name in names))
    one, other = (looks.get_outline(name) for name in names)
    mirrored: float | None = None
    copies: tuple[CopyTransform, ...] = ()
    slides = False
    if one is not None and other is not None and looks.is_comparable(*names):
        moved, still = (
            measure_outline_mismatch(one, other, linear=linear, shift=shift),
            measure_outline_mismatch(one, other, linear=linear, shift=np.zeros(3)),
        )
        mirrored, slides = min(moved, still), moved < ALIKE <= still
        copies = tuple(
            CopyTransform(turn, move, measure_outline_mismatch(one, other, linear=turn, shift=move))
            for turn, move in looks.propose_motions(*names)
        )
    first, second = (frozenset((name, *(joint.child for joint in model.tree.find_path_to(name)))) for name in names)
    alike = looks.is_alike(*names)
    return MirrorPair(
        *names, plane, linear, shift, mirrored, copies, slides, alike, agreeing, named, looks, (first, second)
    )


def _pair_by_geometry(model: Model, names: Sequence[str], looks: ShapeComparer) -> list[MirrorPair]:
    """Pairs among links whose names say nothing: like joints that carry like parts, mirrored in place and as drawn."""
    kinds: dict[tuple[str, int], list[str]] = {}
    for name in names:
        joint = model.tree.parent_joint.get(name)
        if joint is not None and joint.is_movable and looks.get_outline(name) is not None:
            kinds.setdefault((joint.type, sum(j.is_movable for j in model.tree.find_path_to(name))), []).append(name)
    alike = [
        (one, other)
        for members in kinds.values()
        if len(members) <= _MOST_ALIKE
        for one, other in combinations(members, 2)
        if looks.is_alike(one, other)
    ]
    found: list[MirrorPair] = []
    for group in _group_by_body(model, alike):
        best: list[MirrorPair] = []
        for normal in NORMALS:
            matched = _match_mirror_images(model, group, normal, looks)
            if len(matched) > len(best):
                best = matched
        found += best
    return found


def _match_mirror_images(
    model: Model, group: Sequence[tuple[str, str]], normal: Array, looks: ShapeComparer
) -> list[MirrorPair]:
    """The pairs of the plane with this normal that mirrors most places of a group, where that is most of its links and most of
    these are drawn mirrored as well."""
    least = 0.6 * len({name for names in group for name in names}) / 2
    ones, others = (np.array([model.frames[names[side]][:3, 3] for names in group]) for side in (0, 1))
    apart = np.abs((others - ones) @ normal) > PLACE
    chosen: list[tuple[str, str]] = []
    best = MirrorPlane(normal, 0.0)
    for offset in dict.fromkeys(np.round(((ones + others) / 2.0 @ normal)[apart] / PLACE).tolist()):
        near = apart & (np.abs((ones + others) / 2.0 @ normal - offset * PLACE) <= PLACE)
        plane = MirrorPlane(normal, float(np.median(((ones + others) / 2.0 @ normal)[near])))
        mirrored = apart & (np.linalg.norm(plane.reflect_points(ones) - others, axis=1) <= PLACE)
        matched: dict[str, tuple[str, str]] = {}
        for names in (names for names, fits in zip(group, mirrored, strict=True) if fits):
            if not matched.keys() & set(names):
                matched[names[0]] = matched[names[1]] = names
        if len(matched) > 2 * len(chosen):
            chosen, best = list(dict.fromkeys(matched.values())), plane
    if len(chosen) < least:
        return []
    found = [_make_pair(model, best, names, looks, len(chosen), named=False) for names in chosen]
    drawn = [pair for pair in found if pair.drawn_as in {"mirrored", "both"}]
    return drawn if len(drawn) >= least else []
