"""Equal parts of a robot, such as its four thighs, and the primitives that stand for them in collisions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import PurePosixPath

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import split_name_words
from urdfcheck.facts.likeness.symmetry import LinkSignature, group_by_signature
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.sibling_joints import compute_link_signature
from urdfcheck.model.likeness.side_names import names_side, remove_places
from urdfcheck.model.parts import Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import compute_bounding_box

_PRIMITIVES = frozenset({"box", "cylinder", "sphere", "capsule"})
# Places that differ by less (m) are those of one hand's rounding.
_MIN_OFFSET = 1e-3
# Numbers that say how the frames of two links lie agree within this share: three typed digits.
_SAME = 0.005
# The diagonals of the boxes around collision shapes, to those around what is drawn, of 98 % of the published links (GEO003).
_LIKE_DRAWN = (0.49, 1.47)
# Two principal moments further apart than this share show how a frame is rotated.
_DISTINCT = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class OddPrimitives:
    """A link that collides with other primitives than the links that are the same part."""

    link: Link
    siblings: tuple[Link, ...]
    """The links that agree with each other."""
    own: tuple[Shape, ...]
    """The link's collision shapes that no shape of the siblings matches."""
    expected: tuple[Shape, ...]
    """Those of the first sibling that no shape of the link matches."""
    is_misplaced: bool
    """Whether the shapes have the right sizes, and lie elsewhere or are rotated."""
    is_certain: bool = True
    """Whether the file shows that this link is the wrong one."""


@fact
def list_equal_parts(model: Model) -> tuple[tuple[Link, ...], ...]:
    """Group two and more links that are one part: names that differ in nothing but places and numbers, and one inertial.

    They hang on joints of one type with equally many moving joints before them, draw meshes of one name, where these could not
    be compared, and collide with primitives only.

    :raises FactUnavailableError: when the tree is broken.
    """
    tree = model.tree
    kinds: dict[object, list[Link]] = {}
    for name in tree.order[1:]:
        link = model.link_by_name[name]
        if link.collisions and all(s.kind in _PRIMITIVES and s.size for s in link.collisions):
            kinds.setdefault((tree.parent_joint[name].type, _get_part_name(name)), []).append(link)
    alike: dict[object, list[tuple[Link, LinkSignature]]] = {}
    for kind, links in kinds.items():
        for link in links if len(links) > 1 else ():
            signature = compute_link_signature(model, link)
            if signature is not None and signature.mass > 0:
                depth = sum(joint.is_movable for joint in tree.find_path_to(link.name))
                key = kind, depth, _list_drawn_names(model, link)
                alike.setdefault(key, []).append((link, signature))
    groups = (
        tuple(members[i][0] for i in indices)
        for members in alike.values()
        for indices in group_by_signature([signature for _, signature in members])
    )
    return tuple(group for group in groups if len(group) > 1)


def find_odd_primitives(model: Model, group: Sequence[Link], *, differ: float) -> OddPrimitives | None:
    """Find the one link of three and more whose collision primitives differ from those of all others, which agree.

    Places are compared only where the frames are known to lie alike in all links, up to mirror images. None also where the
    drawing of the link differs too: then it is another part.

    :param differ: a greater share of a length is a difference.
    """
    if len(group) < 3:
        return None

    def is_same_size(one: Shape, other: Shape) -> bool:
        return _is_same_size(one, other, differ)

    def is_same_place(one: Shape, other: Shape) -> bool:
        return is_same_size(one, other) and _is_same_place(model, one, other, differ)

    criteria = [is_same_size, is_same_place] if _have_like_frames(group) else [is_same_size]
    for is_same in criteria:
        odd = _find_odd_link(group, is_same)
        if odd is not None:
            siblings = tuple(link for link in group if link is not odd)
            if _are_drawn_differently(odd, siblings[0], is_same_size) or _is_between(model, odd, siblings):
                return None
            own, expected = _list_unmatched(odd.collisions, siblings[0].collisions, is_same)
            return OddPrimitives(
                odd,
                siblings,
                own,
                expected,
                is_misplaced=is_same is is_same_place,
                is_certain=not _is_nearer_to_drawing(model, odd, siblings[0]),
            )
        if any(any(_list_unmatched(group[0].collisions, link.collisions, is_same)) for link in group[1:]):
            return None
    return None


def compare_two(model: Model, group: Sequence[Link], *, differ: float) -> OddPrimitives | None:
    """Compare the sizes of two equal parts; None where they or their drawings agree, and where each has the box around its own
    drawing.

    The wrong one is the first, and certain, where its shapes are not as large as what it draws, and those of the other are.
    Otherwise the two are compared only if their names say on which side they are.
    """
    if len(group) != 2:
        return None

    def is_same_size(one: Shape, other: Shape) -> bool:
        return _is_same_size(one, other, differ)

    one, other = group
    ratios = [_compare_with_drawing(model, link) for link in group]
    fits = [ratio is not None and _LIKE_DRAWN[0] <= ratio <= _LIKE_DRAWN[1] for ratio in ratios]
    is_certain = None not in ratios and fits[0] != fits[1]
    if is_certain and fits[0]:
        one, other = other, one
    own, expected = _list_unmatched(one.collisions, other.collisions, is_same_size)
    if not (own or expected) or _are_drawn_differently(one, other, is_same_size):
        return None
    if _is_between(model, one, [other]) or _is_between(model, other, [one]):
        return None
    if not is_certain and any(len(remove_places(link.name)) == len(split_name_words(link.name)) for link in group):
        return None
    if all(_is_box_of_drawing(model, link, differ) for link in group):
        return None
    return OddPrimitives(one, (other,), own, expected, is_misplaced=False, is_certain=is_certain)


def _is_nearer_to_drawing(model: Model, one: Link, other: Link) -> bool:
    """Whether the collision shapes of a link are nearer to the size of what it draws than those of an equal part."""
    ratios = [_compare_with_drawing(model, link) for link in (one, other)]
    errors = [abs(math.log(ratio)) for ratio in ratios if ratio is not None]
    return len(errors) == len(ratios) and errors[0] < errors[1]


def _compare_with_drawing(model: Model, link: Link) -> float | None:
    """Return how many times as large as what it draws a link's collision shapes are together; None where that is not known."""
    boxes = [
        compute_bounding_box(model, [(shape, np.eye(4)) for shape in shapes])
        for shapes in (link.visuals, link.collisions)
    ]
    drawn, solid = (None if box is None else float(np.linalg.norm(box[1] - box[0])) for box in boxes)
    return solid / drawn if solid and drawn else None


def _is_box_of_drawing(model: Model, link: Link, differ: float) -> bool:
    """Whether the collision shapes of a link fill the box around what it draws: then they follow from the drawing."""
    drawn, solid = (
        compute_bounding_box(model, [(shape, np.eye(4)) for shape in shapes])
        for shapes in (link.visuals, link.collisions)
    )
    if drawn is None or solid is None:
        return False
    return bool(np.abs(drawn - solid).max() <= differ * float(np.ptp(drawn, axis=0).max()))


def _find_odd_link(group: Sequence[Link], is_same: Callable[[Shape, Shape], bool]) -> Link | None:
    """Return the link that no other agrees with, where all others agree with each other."""

    def agree(one: Link, other: Link) -> bool:
        return not any(_list_unmatched(one.collisions, other.collisions, is_same))

    # Of three links two agree, and with one of these two all others but the odd one.
    for reference in group[:2]:
        differing = [link for link in group if not agree(reference, link)]
        if len(differing) == 1:
            return differing[0]
        if len(differing) == len(group) - 1 and all(agree(differing[0], link) for link in differing):
            return reference
    return None


def _list_unmatched(
    shapes: Sequence[Shape], others: Sequence[Shape], is_same: Callable[[Shape, Shape], bool]
) -> tuple[tuple[Shape, ...], tuple[Shape, ...]]:
    """Pair the shapes of two links, and return those of each link that are left."""
    left = list(others)
    alone = []
    for shape in shapes:
        match = next((other for other in left if is_same(shape, other)), None)
        if match is None:
            alone.append(shape)
        else:
            left.remove(match)
    return tuple(alone), tuple(left)


def _is_same_size(one: Shape, other: Shape, differ: float) -> bool:
    sizes = [sorted(shape.size or ()) if shape.kind == "box" else list(shape.size or ()) for shape in (one, other)]
    return one.kind == other.kind and all(
        math.isclose(abs(a), abs(b), rel_tol=differ) for a, b in zip(*sizes, strict=False)
    )


def _is_same_place(model: Model, one: Shape, other: Shape, differ: float) -> bool:
    """Whether two shapes fill boxes of one size at one place along the axes of their links' frames, or at its mirror images."""
    boxes = [compute_bounding_box(model, [(shape, np.eye(4))]) for shape in (one, other)]
    known = [box for box in boxes if box is not None]
    if len(known) < len(boxes):
        return True
    tolerance = max(_MIN_OFFSET, differ * float(np.linalg.norm(known[1][1] - known[1][0])))
    centres = [np.abs(box.mean(axis=0)) for box in known]
    extents = [box[1] - box[0] for box in known]
    return bool(
        np.linalg.norm(centres[0] - centres[1]) <= tolerance and np.abs(extents[0] - extents[1]).max() <= tolerance
    )


def _have_like_frames(group: Sequence[Link]) -> bool:
    """Whether COM and tensor show that the frames of equal parts lie alike, up to mirror images in the planes of the frames."""
    inertials = [link.inertial for link in group]
    tensors = [inertial.tensor_in_link for inertial in inertials if inertial is not None]
    places = [inertial.origin.xyz for inertial in inertials if inertial is not None]
    if len(tensors) != len(group) or any(tensor is None for tensor in tensors) or any(xyz is None for xyz in places):
        return False
    spread, centres = np.abs(np.array(tensors, dtype=float)), np.abs(np.array(places, dtype=float))
    moments = np.linalg.eigvalsh(np.array(tensors[0], dtype=float))
    return bool(
        (np.diff(moments) > _DISTINCT * moments[2]).all()
        and (np.abs(spread - spread[0]) <= _SAME * spread[0].max()).all()
        and (np.abs(centres - centres[0]) <= max(_SAME * centres[0].max(), _MIN_OFFSET)).all()
    )


def _are_drawn_differently(one: Link, other: Link, is_same: Callable[[Shape, Shape], bool]) -> bool:
    """Whether two links draw different primitives; of meshes, their surfaces agree (see `list_equal_parts`)."""
    drawn = [[shape for shape in link.visuals if shape.kind != "mesh"] for link in (one, other)]
    return any(_list_unmatched(drawn[0], drawn[1], is_same))


def _is_between(model: Model, link: Link, others: Sequence[Link]) -> bool:
    """Whether a link is on no side, where all ``others`` are, and draws meshes of its own that could not be read: the part in the
    middle may be another than those at its left and right, with the numbers copied."""
    if names_side(link.name) or not all(names_side(other.name) for other in others):
        return False
    own = _list_unread_files(model, link)
    return bool(own) and not any(own & _list_unread_files(model, other) for other in others)


def _list_unread_files(model: Model, link: Link) -> set[str]:
    files = (s.mesh_filename for s in link.visuals if model.meshes.get_facts(s) is None)
    return {file.value for file in files if file is not None}


def _get_part_name(name: str) -> tuple[str, ...]:
    """Return the words of a name without places and numbers: those of the part."""
    return tuple(word for word in remove_places(name) if not word.isdigit())


def _list_drawn_names(model: Model, link: Link) -> tuple[tuple[str, ...], ...]:
    """Return the names of the meshes that a link draws and that could not be read, without places.

    Numbers stay: ``standoff_2in.stl`` may be another part than ``standoff_8in.stl``.
    """
    files = [s.mesh_filename for s in link.visuals if s.mesh_filename is not None and model.meshes.get_facts(s) is None]
    return tuple(sorted(remove_places(PurePosixPath(file.value).stem) for file in files))
