"""The inertials of both sides of a pair, compared as their drawings are related."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Unavailable
from urdfcheck.facts.inertials.diagnosis import Declared, diagnose, mismatch
from urdfcheck.facts.inertials.inertia_tensor import six_of, validity
from urdfcheck.facts.inertials.placeholders import placeholder
from urdfcheck.facts.likeness.mirror import Deviation, deviation, principal_deviation, wrong_signs
from urdfcheck.model.likeness.mirror_pairs import Pair, copy_of, declared, mirror_image
from urdfcheck.model.parts import TENSOR, Link
from urdfcheck.model.repairs.edits import Change
from urdfcheck.model.rigid_bodies import is_point
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.shape_signature import DIFFERENT
from urdfcheck.model.shapes.visual_solid import geometry

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
WORSE = 0.1
# So many like parts elsewhere that agree with one side, and none with the other, say which one is wrong.
VOTES = 2


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """A link of a pair: what its inertial says, and what it should say if its ``twin`` is right: ``expected``, ``apart`` from
    what it says. ``image``: the twin's inertial mirrored; ``refused``: copies of it that the drawings do not allow."""

    link: Link
    twin: Link
    found: Declared
    expected: Declared
    image: Declared
    refused: tuple[Declared, ...]

    @property
    def apart(self) -> Deviation:
        return deviation(self.found, self.expected)


def sides(model: Model, pair: Pair) -> tuple[Side, Side] | None:
    """Both sides of a pair whose drawings are related; None when they are not, or an inertial is not to be compared."""
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = comparable(one), comparable(other)
    if first is None or second is None or pair.drawn not in {"mirrored", "both", "copied"}:
        return None
    return _side(pair, one, other, first, second, back=True), _side(pair, other, one, second, first, back=False)


def comparable(link: Link) -> Declared | None:
    """An inertial that a body can have and that somebody computed: what is not is told by the rules about one link."""
    inertial, numbers = link.inertial, declared(link)
    if inertial is None or inertial.six is None or numbers is None or is_point(inertial):
        return None
    valid = validity(numbers.tensor, rel_tol=1e-3)
    computed = placeholder(numbers.mass, inertial.six) is None
    return numbers if valid.positive_definite and valid.triangle and computed else None


def _side(pair: Pair, link: Link, twin: Link, found: Declared, numbers: Declared, *, back: bool) -> Side:
    """``expected``: of what the drawings allow, mirror image and copies, that which is nearest to what the link has."""
    image = mirror_image(numbers, pair, back=back)
    copies = [(copy_of(numbers, copy, back=back), copy.mismatch < DIFFERENT) for copy in pair.copies]
    allowed, refused = ([made for made, allowed in copies if allowed is which] for which in (True, False))
    choices = allowed if pair.drawn == "copied" else [image, *allowed]
    nearest = min(choices, key=lambda choice: deviation(found, choice).worst)
    return Side(link, twin, found, nearest, image, tuple(refused))


def wrong_side(model: Model, pair: Pair, both: Sequence[Side], note: float) -> tuple[Side, tuple[str, ...]] | None:
    """The side that is wrong: like parts elsewhere, with their names, have its twin's numbers and none has its own; or where they
    do not decide, what it draws fits its twin's numbers much better. None where nothing decides."""
    numbers = [(n, found) for n in pair.like if (found := comparable(model.link_by_name[n])) is not None]
    one, other = (tuple(n for n, d in numbers if principal_deviation(d, s.found).worst <= note) for s in both)
    if not one and len(other) >= VOTES:
        return both[0], other
    if not other and len(one) >= VOTES:
        return both[1], one
    suspects = [side for side in both if _misfits(model, side)]
    return (suspects[0], ()) if len(suspects) == 1 else None


def _misfits(model: Model, side: Side) -> bool:
    """Whether the side's drawing explains its numbers by a mistake, and its twin's, COM and tensor alike, without one."""
    drawn = geometry(model, side.link)
    if drawn is None:
        return False
    verdict, right = diagnose(side.found, drawn, side.expected), diagnose(side.expected, drawn)
    if (
        verdict is None
        or right is None
        or verdict.by != "twin"
        or not (verdict.cause and verdict.decided and right.sound)
    ):
        return False
    fits = [mismatch(n, drawn.solid.com, drawn.solid.covariance) for n in (side.found, side.expected)]
    return all(expected <= found + WORSE for found, expected in zip(*fits, strict=True))


def cause_of(pair: Pair, side: Side, note: float) -> str | None:
    """Why two inertials are not related as the drawings are: ``copied`` or ``mirrored`` where the drawings were not, the numbers
    are right but for the signs of all products (``products_sign``) or other ``signs``; None where none of it explains all."""
    apart = side.apart
    if apart.mass > note:
        return None
    if any(_made_as(side, copy, note) for copy in side.refused):
        return "copied"
    if pair.drawn == "copied" and _made_as(side, side.image, note):
        return "mirrored"
    signs = wrong_signs(side.found, side.expected, note)
    return "products_sign" if signs == PRODUCTS else "signs" if signs else None


def contradicted(model: Model, note: float = 0.01) -> frozenset[str]:
    """The links of pairs whose inertials were ``copied`` while the drawings are mirrored, or ``mirrored`` while they are copies;
    none where the tree is broken."""
    found: set[str] = set()
    try:
        known = model.pairs
    except Unavailable:
        return frozenset()
    for pair in known:
        both = sides(model, pair)
        if both is not None and both[1].apart.worst > note and cause_of(pair, both[1], note) in CONTRADICTIONS:
            found |= {pair.one, pair.other}
    return frozenset(found)


def _made_as(side: Side, made: Declared, note: float) -> bool:
    """Whether the parts of an inertial that are wrong are those of ``made``."""
    apart, same = side.apart, deviation(side.found, made)
    parts = ((apart.place, same.place), (apart.spread, same.spread))
    return all(share <= COPIED for wrong, share in parts if wrong > note)


def changes(side: Side) -> list[Change]:
    """What changes in the text of the side's inertial if its twin is right."""
    inertial, turn = side.link.inertial, side.found.rotation
    assert inertial is not None
    tensor = turn.T @ side.expected.inertia @ turn
    wanted = [_rounded(side.expected.com), _rounded(np.array(six_of(tensor)))]
    found = [side.found.com.tolist(), six_of(side.found.tensor)]
    made: list[Change] = []
    if not _same(side.found.mass, side.expected.mass):
        made.append(Change(inertial.mass_attribute, "mass", f"{side.expected.mass:.10g}"))
    if not all(map(_same, found[0], wanted[0])):
        made.append(Change(inertial.origin.attribute("xyz"), "xyz", " ".join(f"{v:.10g}" for v in wanted[0])))
    for name, old, new in zip(TENSOR, found[1], wanted[1], strict=True):
        if not _same(old, new):
            element = inertial.tensor_element
            made.append(Change(None if element is None else element.attributes.get(name), name, f"{new:.10g}"))
    return made


def _rounded(values: Array) -> list[float]:
    """Without what products of rotation matrices leave of a zero."""
    largest = float(np.abs(values).max())
    return [0.0 if abs(v) <= 1e-9 * largest else v for v in values.tolist()]


def _same(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-15)
