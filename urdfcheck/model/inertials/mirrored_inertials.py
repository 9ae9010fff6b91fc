"""The inertials of both sides of a pair, compared as their drawings are related."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.diagnosis import DeclaredInertial, diagnose_inertial, measure_inertial_mismatch
from urdfcheck.facts.inertials.inertia_tensor import check_inertia_validity, list_inertia_components
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.facts.likeness.mirror import (
    InertialDeviation,
    find_wrong_signs,
    measure_deviation,
    measure_principal_deviation,
)
from urdfcheck.model.likeness.declared_inertials import copy_inertial, mirror_inertial, read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import (
    MirrorPair,
    list_alike_links_elsewhere,
    mirror_pairs,
)
from urdfcheck.model.likeness.shape_comparison import DIFFERENT
from urdfcheck.model.parts import TENSOR_NAMES, Link
from urdfcheck.model.repairs.edits import AttributeChange
from urdfcheck.model.rigid_bodies import is_point_mass
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# Causes that only the drawings of both sides together tell.
CONTRADICTIONS = frozenset({"copied", "mirrored"})
# A mirror turns over two of them, and no part has all three in another sign than its image.
PRODUCTS = ("ixy", "ixz", "iyz")
# Numbers that were copied agree to within what rounding to three digits leaves.
COPIED = 0.005
# What the mesh says of one side is not outweighed by a COM or a tensor that fits it worse by so much.
WORSE_FIT = 0.1
# So many like parts elsewhere that agree with one side, and none with the other, say which one is wrong.
VOTES = 2


@dataclass(frozen=True, slots=True, eq=False)
class PairSide:
    """A link of a pair: what its inertial says, and what it should say if its ``twin`` is right: ``expected``, ``apart`` from
    what it says. ``image``: the twin's inertial mirrored; ``refused``: copies of it that the drawings do not allow."""

    link: Link
    twin: Link
    actual: DeclaredInertial
    expected: DeclaredInertial
    image: DeclaredInertial
    disallowed: tuple[DeclaredInertial, ...]

    @property
    def deviation(self) -> InertialDeviation:
        return measure_deviation(self.actual, self.expected)


def compare_sides(model: Model, pair: MirrorPair) -> tuple[PairSide, PairSide] | None:
    """Both sides of a pair whose drawings are related; None when they are not, or an inertial is not to be compared."""
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = get_comparable_inertial(one), get_comparable_inertial(other)
    if first is None or second is None or pair.drawn_as not in {"mirrored", "both", "copied"}:
        return None
    return _make_side(pair, one, other, first, second, back=True), _make_side(
        pair, other, one, second, first, back=False
    )


def get_comparable_inertial(link: Link) -> DeclaredInertial | None:
    """An inertial that a body can have and that somebody computed: what is not is told by the rules about one link."""
    inertial, numbers = link.inertial, read_declared_inertial(link)
    if inertial is None or inertial.inertia_components is None or numbers is None or is_point_mass(inertial):
        return None
    valid = check_inertia_validity(numbers.tensor, rel_tol=1e-3)
    computed = describe_placeholder(numbers.mass, inertial.inertia_components) is None
    return numbers if valid.positive_definite and valid.triangle_inequality and computed else None


def _make_side(
    pair: MirrorPair, link: Link, twin: Link, found: DeclaredInertial, numbers: DeclaredInertial, *, back: bool
) -> PairSide:
    """``expected``: of what the drawings allow, mirror image and copies, that which is nearest to what the link has."""
    image = mirror_inertial(numbers, pair, inverse=back)
    copies = [(copy_inertial(numbers, copy, inverse=back), copy.mismatch < DIFFERENT) for copy in pair.copy_transforms]
    allowed, refused = ([made for made, allowed in copies if allowed is which] for which in (True, False))
    choices = allowed if pair.drawn_as == "copied" else [image, *allowed]
    nearest = min(choices, key=lambda choice: measure_deviation(found, choice).worst)
    return PairSide(link, twin, found, nearest, image, tuple(refused))


def find_wrong_side(
    model: Model, pair: MirrorPair, both: Sequence[PairSide], threshold: float
) -> tuple[PairSide, tuple[str, ...]] | None:
    """The side that is wrong: like parts elsewhere, with their names, have its twin's numbers and none has its own; or where they
    do not decide, what it draws fits its twin's numbers much better. None where nothing decides."""
    numbers = [
        (n, found)
        for n in list_alike_links_elsewhere(model, pair)
        if (found := get_comparable_inertial(model.link_by_name[n])) is not None
    ]
    one, other = (
        tuple(n for n, d in numbers if measure_principal_deviation(d, s.actual).worst <= threshold) for s in both
    )
    if not one and len(other) >= VOTES:
        return both[0], other
    if not other and len(one) >= VOTES:
        return both[1], one
    suspects = [side for side in both if _is_misfit(model, side)]
    return (suspects[0], ()) if len(suspects) == 1 else None


def _is_misfit(model: Model, side: PairSide) -> bool:
    """Whether the side's drawing explains its numbers by a mistake, and its twin's, COM and tensor alike, without one."""
    drawn = measure_link_geometry(model, side.link)
    if drawn is None:
        return False
    verdict, right = diagnose_inertial(side.actual, drawn, side.expected), diagnose_inertial(side.expected, drawn)
    if (
        verdict is None
        or right is None
        or verdict.by != "twin"
        or not (verdict.cause and verdict.decided and right.sound)
    ):
        return False
    fits = [measure_inertial_mismatch(n, drawn.solid.com, drawn.solid.covariance) for n in (side.actual, side.expected)]
    return all(expected <= found + WORSE_FIT for found, expected in zip(*fits, strict=True))


def find_cause(pair: MirrorPair, side: PairSide, threshold: float) -> str | None:
    """Why two inertials are not related as the drawings are: ``copied`` or ``mirrored`` where the drawings were not, the numbers
    are right but for the signs of all products (``products_sign``) or other ``signs``; None where none of it explains all."""
    apart = side.deviation
    if apart.mass > threshold:
        return None
    if any(_is_derived_from(side, copy, threshold) for copy in side.disallowed):
        return "copied"
    if pair.drawn_as == "copied" and _is_derived_from(side, side.image, threshold):
        return "mirrored"
    signs = find_wrong_signs(side.actual, side.expected, threshold)
    return "products_sign" if signs == PRODUCTS else "signs" if signs else None


def find_contradicted_links(model: Model, threshold: float = 0.01) -> frozenset[str]:
    """The links of pairs whose inertials were ``copied`` while the drawings are mirrored, or ``mirrored`` while they are copies;
    none where the tree is broken."""
    found: set[str] = set()
    try:
        known = mirror_pairs(model)
    except FactUnavailableError:
        return frozenset()
    for pair in known:
        both = compare_sides(model, pair)
        if (
            both is not None
            and both[1].deviation.worst > threshold
            and find_cause(pair, both[1], threshold) in CONTRADICTIONS
        ):
            found |= {pair.one, pair.other}
    return frozenset(found)


def _is_derived_from(side: PairSide, made: DeclaredInertial, threshold: float) -> bool:
    """Whether the parts of an inertial that are wrong are those of ``made``."""
    apart, same = side.deviation, measure_deviation(side.actual, made)
    parts = ((apart.com_offset, same.com_offset), (apart.spread, same.spread))
    return all(share <= COPIED for wrong, share in parts if wrong > threshold)


def list_inertial_changes(side: PairSide) -> list[AttributeChange]:
    """What changes in the text of the side's inertial if its twin is right."""
    inertial, turn = side.link.inertial, side.actual.rotation
    assert inertial is not None
    tensor = turn.T @ side.expected.inertia @ turn
    wanted = [_clear_rounding(side.expected.com), _clear_rounding(np.array(list_inertia_components(tensor)))]
    found = [side.actual.com.tolist(), list_inertia_components(side.actual.tensor)]
    made: list[AttributeChange] = []
    if not _is_same_number(side.actual.mass, side.expected.mass):
        made.append(AttributeChange(inertial.mass_attribute, "mass", f"{side.expected.mass:.10g}"))
    if not all(map(_is_same_number, found[0], wanted[0])):
        made.append(
            AttributeChange(inertial.origin.get_attribute("xyz"), "xyz", " ".join(f"{v:.10g}" for v in wanted[0]))
        )
    for name, old, new in zip(TENSOR_NAMES, found[1], wanted[1], strict=True):
        if not _is_same_number(old, new):
            element = inertial.tensor_element
            made.append(AttributeChange(None if element is None else element.attributes.get(name), name, f"{new:.10g}"))
    return made


def _clear_rounding(values: Array) -> list[float]:
    """Without what products of rotation matrices leave of a zero."""
    largest = float(np.abs(values).max())
    return [0.0 if abs(v) <= 1e-9 * largest else v for v in values.tolist()]


def _is_same_number(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-15)
