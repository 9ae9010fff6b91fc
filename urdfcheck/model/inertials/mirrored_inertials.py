"""The inertials of both sides of a pair, compared as their drawings are related."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.facts.inertials.inertia_tensor import (
    check_inertia_validity,
    compute_mass_covariance,
    compute_solid_inertia,
    list_inertia_components,
)
from urdfcheck.facts.inertials.inertial_fit import compute_whitening, measure_inertial_mismatch
from urdfcheck.facts.inertials.twin_slips import TwinSlip, find_rounding, find_slip_between_twins
from urdfcheck.facts.likeness.mirror import (
    InertialDeviation,
    find_wrong_signs,
    measure_deviation,
    measure_principal_deviation,
)
from urdfcheck.facts.likeness.symmetry import is_axis_renaming
from urdfcheck.model.inertials.inertial_differences import have_one_tensor
from urdfcheck.model.inertials.typed_tensors import describe_typed_tensor
from urdfcheck.model.likeness.declared_inertials import copy_inertial, mirror_inertial, read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import MUCH_BETTER, MirrorPair, list_alike_links_elsewhere, mirror_pairs
from urdfcheck.model.likeness.shape_comparison import DIFFERENT
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor, Link
from urdfcheck.model.repairs.edits import AttributeChange
from urdfcheck.model.repairs.number_text import write_numbers
from urdfcheck.model.rigid_bodies import is_point_mass
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.xml import Attribute

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Causes that only the drawings of both sides together reveal.
CONTRADICTIONS = frozenset({"copied", "mirrored"})
# A mirror changes the signs of two of them; no part differs from its image in all three.
PRODUCTS = ("ixy", "ixz", "iyz")
# Numbers that were copied agree to within what rounding to three digits leaves.
COPIED = 0.005
# The mesh of one side decides unless the twin's COM or tensor fits it worse by this much.
WORSE_FIT = 0.1
# Drawings that differ by less, as a share of their size, are the same but for their facets (chosen).
FACETS = 1e-3
# Numbers that agree within this share of a length differ in signs only (chosen).
_SIGNED = 0.01
# Two COMs are far apart beyond this share of the drawn part's radius of gyration; of the way between them, the drawn part's is at
# the first quarter: three times as near to one as to the other.
_FAR_COM, _NEAR_IMAGE = 0.3, 0.25
# Two COMs are off their drawings alike if the difference is within this share of the drawn part's radius of gyration.
_OFF_ALIKE = 0.005
# A product of inertia below this share of the greatest moment has the sign of what is not drawn: cables, screws, a motor.
_CLEAR_PRODUCT = 0.05
# Mistakes that change the COM and the tensor.
_OF_ALL_LENGTHS = frozenset({"units", "mesh_scale"})
# Mass and moments of so many digits in all are not twice in a file by chance; a program that copies them may write fewer than the
# 16 that there are.
_TELLING_DIGITS, _COPIED_DIGITS = 6, 9
# This many like parts elsewhere that agree with one side, and none with the other, decide which one is wrong.
VOTES = 2


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PairSide:
    """A link of a pair: what its inertial says, and what it should say if its twin is right."""

    link: Link
    twin: Link
    actual: DeclaredInertial
    expected: DeclaredInertial
    """Of mirror image and copies of the twin's inertial that the drawings allow, the inertial that is nearest to ``actual``, or
    that of which ``actual`` has other signs only."""
    image: DeclaredInertial
    """The twin's inertial mirrored."""
    disallowed: tuple[DeclaredInertial, ...]
    """Copies of the twin's inertial that the drawings do not allow."""

    @property
    def deviation(self) -> InertialDeviation:
        """How far ``actual`` is from ``expected``. One tensor at two masses has other second moments per mass, and does
        not count as another difference than that of the masses."""
        deviation = measure_deviation(self.actual, self.expected)
        return replace(deviation, spread=0.0) if have_one_tensor(self.actual, self.expected, COPIED) else deviation


def compare_sides(model: Model, pair: MirrorPair) -> tuple[PairSide, PairSide] | None:
    """Compare both sides of a pair whose drawings are related; None when they are not, or no body has an inertial."""
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = get_possible_inertial(one), get_possible_inertial(other)
    if first is None or second is None or pair.drawn_as not in {"mirrored", "both", "copied"}:
        return None
    return (
        _make_side(pair, link=one, twin=other, actual=first, twin_numbers=second, inverse=True),
        _make_side(pair, link=other, twin=one, actual=second, twin_numbers=first, inverse=False),
    )


def fit_own_drawings_alike(
    model: Model,
    one: Link,
    other: Link,
    *,
    threshold: float,
    com_threshold: float = math.inf,
    linear: Array | None = None,
) -> bool:
    """Whether the inertials of two links relate alike to what each link draws, in density and in all second moments: then the
    parts differ as they are drawn, and no number is wrong. ``threshold``: as a share of a mass or a length.

    The second moments are compared along the axes in which declared and drawn ones differ most: a product of inertia with the
    wrong sign makes a difference on its side only. ``com_threshold``: how near the COM of each is to that of its drawing, in
    radii of gyration; farther COMs count if they are off alike, which ``linear`` (3, 3) shows, from the frame of the first link
    to that of the other.
    """
    related, offsets, are_near = [], [], True
    for link in (one, other):
        declared, drawn = read_declared_inertial(link), measure_link_geometry(model, link)
        if declared is None or drawn is None or not drawn.solid.volume > 0.0:
            return False
        covariance = drawn.solid.covariance
        if not np.linalg.eigvalsh(covariance)[0] > 0.0:
            return False
        white = compute_whitening(covariance)
        offsets.append((declared.com - drawn.solid.com) / math.sqrt(float(np.trace(covariance))))
        are_near &= float(np.linalg.norm(white @ (declared.com - drawn.solid.com))) <= com_threshold
        spread = np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)
        # A variance is the square of a length.
        related.append(np.array([declared.mass / drawn.solid.volume, *np.sqrt(np.maximum(spread, 0.0))]))
    if not are_near and (linear is None or float(np.linalg.norm(linear @ offsets[0] - offsets[1])) > _OFF_ALIKE):
        return False
    return bool((np.abs(related[0] - related[1]) <= threshold * np.maximum(*related)).all())


def get_comparable_inertial(link: Link) -> DeclaredInertial | None:
    """Return an inertial that a body can have and that was computed, not guessed; None for any other.

    The rules about one link report the others.
    """
    numbers = get_possible_inertial(link)
    return None if numbers is None or describe_typed_tensor(link) is not None else numbers


def get_possible_inertial(link: Link) -> DeclaredInertial | None:
    """Return an inertial that a body can have, computed or guessed; None for any other."""
    inertial, numbers = link.inertial, read_declared_inertial(link)
    if inertial is None or inertial.inertia_components is None or numbers is None or is_point_mass(inertial):
        return None
    valid = check_inertia_validity(numbers.tensor, rel_tol=1e-3)
    return numbers if valid.positive_definite and valid.triangle_inequality else None


def find_typed_side(one: Link, other: Link) -> Link | None:
    """Find the side whose tensor was typed, where the other's was computed for the same mass, and rounding does not make it."""
    described = [describe_typed_tensor(side) is not None for side in (one, other)]
    if described[0] == described[1]:
        return None
    typed, computed = (one, other) if described[0] else (other, one)
    coarse, fine = get_possible_inertial(typed), get_possible_inertial(computed)
    if coarse is None or fine is None or abs(coarse.mass - fine.mass) > COPIED * fine.mass:
        return None
    return None if find_rounding(coarse, fine) is not None else typed


def _make_side(
    pair: MirrorPair,
    *,
    link: Link,
    twin: Link,
    actual: DeclaredInertial,
    twin_numbers: DeclaredInertial,
    inverse: bool,
) -> PairSide:
    """Make one side; of mirror image and copies that the drawings allow, it expects the one nearest to its numbers.

    A part that is nearly its own mirror image allows more than one. Where none agrees, one that carries one drawing onto the
    other much better counts, if the numbers are its own apart from signs.
    """
    image = mirror_inertial(twin_numbers, pair, inverse=inverse)
    copies = [(copy_inertial(twin_numbers, copy, inverse=inverse), copy.mismatch) for copy in pair.copy_transforms]
    choices = [choice for choice in copies if choice[1] < DIFFERENT]
    if pair.drawn_as != "copied" and pair.mirror_mismatch is not None:
        choices.insert(0, (image, pair.mirror_mismatch))
    nearest, near_mismatch = min(choices, key=lambda choice: _measure_apart_from_mass(actual, choice[0]))
    best, mismatch = min(choices, key=lambda choice: choice[1])
    is_proven = near_mismatch > MUCH_BETTER * max(FACETS, mismatch)
    if is_proven and measure_deviation(actual, nearest).worst > _SIGNED and find_wrong_signs(actual, best, _SIGNED):
        nearest = best
    return PairSide(
        link=link,
        twin=twin,
        actual=actual,
        expected=nearest,
        image=image,
        disallowed=tuple(copy for copy, mismatch in copies if not mismatch < DIFFERENT),
    )


def _measure_apart_from_mass(actual: DeclaredInertial, expected: DeclaredInertial) -> tuple[float, float]:
    """Measure how far COM and tensor are from those expected, at either mass: masses that differ are as far apart in each of two
    images, and hide what is not. Of images that are as near, the one with the nearer COM comes first."""
    both = [measure_deviation(actual, replace(expected, mass=mass)) for mass in (expected.mass, actual.mass)]
    nearer = min(both, key=lambda deviation: max(deviation.com_offset, deviation.spread))
    return max(nearer.com_offset, nearer.spread), nearer.com_offset


def find_wrong_side(
    model: Model, pair: MirrorPair, both: Sequence[PairSide], threshold: float
) -> tuple[PairSide, tuple[str, ...]] | None:
    """Find the side that is wrong; None where nothing decides.

    Like parts elsewhere, whose names are returned, have its twin's numbers and none has its own. Where they do not decide,
    its drawing fits its twin's numbers much better.
    """
    numbers = [
        (name, declared)
        for name in list_alike_links_elsewhere(model, pair)
        if (declared := get_comparable_inertial(model.link_by_name[name])) is not None
    ]
    one, other = (
        tuple(name for name, n in numbers if measure_principal_deviation(n, side.actual).worst <= threshold)
        for side in both
    )
    if not one and len(other) >= VOTES:
        return both[0], other
    if not other and len(one) >= VOTES:
        return both[1], one
    suspects = [side for side in both if _is_misfit(model, side)]
    if not suspects:
        suspects = [side for side in both if _has_com_on_the_other_side(model, pair, side, threshold=threshold)]
    if not suspects:
        # The drawings show which COM was copied, and nothing shows which mass is right.
        others = [_keep_mass(side) for side in both if side.deviation.mass > threshold]
        suspects = [side for side in others if _has_com_on_the_other_side(model, pair, side, threshold=threshold)]
    return (suspects[0], ()) if len(suspects) == 1 else None


def _keep_mass(side: PairSide) -> PairSide:
    """Return a side of which everything is expected that the twin's numbers say but for its mass."""
    mass = side.actual.mass
    return replace(
        side,
        expected=replace(side.expected, mass=mass),
        image=replace(side.image, mass=mass),
        disallowed=tuple(replace(copy, mass=mass) for copy in side.disallowed),
    )


def _is_misfit(model: Model, side: PairSide) -> bool:
    """Whether the side's drawing explains its numbers by a mistake, and its twin's, COM and tensor alike, without one."""
    drawn = measure_link_geometry(model, side.link)
    if drawn is None:
        return False
    actual, expected = diagnose_inertial(side.actual, drawn, side.expected), diagnose_inertial(side.expected, drawn)
    if actual is None or expected is None or actual.judged_by != "twin":
        return False
    if not (actual.cause and actual.at_fault and expected.sound):
        return False
    fits = [measure_inertial_mismatch(n, drawn.solid.com, drawn.solid.covariance) for n in (side.actual, side.expected)]
    return all(twin_fit <= own_fit + WORSE_FIT for own_fit, twin_fit in zip(*fits, strict=True))


def _has_com_on_the_other_side(model: Model, pair: MirrorPair, side: PairSide, *, threshold: float) -> bool:
    """Whether the COM of the side's drawing is near that of the twin's image, in the direction in which the side's own is far:
    its COM is wrong, and the tensor that was copied with it."""
    drawn, deviation = measure_link_geometry(model, side.link), side.deviation
    is_whole = deviation.spread <= threshold or find_cause(pair, side, threshold) == "copied"
    if drawn is None or deviation.mass > threshold or deviation.com_offset <= threshold or not is_whole:
        return False
    return _is_com_of_image(side, drawn)


def _is_com_of_image(side: PairSide, drawn: VisualGeometry) -> bool:
    """Whether the COM of the side's drawing is near that of the twin's image, in the direction in which the side's own is far."""
    away = side.actual.com - side.expected.com
    is_far = float(np.linalg.norm(compute_whitening(drawn.solid.covariance) @ away)) > _FAR_COM
    # 0 at the twin's image, 1 at the side's own COM.
    place = float((drawn.solid.com - side.expected.com) @ away) / float(away @ away)
    return is_far and -1.0 < place < _NEAR_IMAGE


def is_tensor_against_drawing(model: Model, side: PairSide) -> bool:
    """Whether the twin's products of inertia have other signs than those of its drawing, or their image than those of the side's:
    then the twin's tensor, which has the signs of CAD programs perhaps, repairs nothing."""
    twin = read_declared_inertial(side.twin)
    known = [(side.link, side.expected), *([] if twin is None else [(side.twin, twin)])]
    return any(_has_opposite_products(model, link, numbers) for link, numbers in known)


def _has_opposite_products(model: Model, link: Link, numbers: DeclaredInertial) -> bool:
    """Whether a product of inertia that is clear in the numbers and in the drawing has opposite signs in them."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return False
    tensors = (numbers.inertia, compute_solid_inertia(drawn.solid, 1.0))
    declared, expected = (tensor[np.triu_indices(3, 1)] / np.abs(np.diag(tensor)).max() for tensor in tensors)
    is_clear = np.minimum(np.abs(declared), np.abs(expected)) > _CLEAR_PRODUCT
    return bool((is_clear & (declared * expected < 0.0)).any())


def limit_to_com(model: Model, side: PairSide, threshold: float) -> PairSide | None:
    """Return a wrong side with its own tensor, so that only its COM is to be written; None unless the drawing proves the COM."""
    drawn, actual, deviation = measure_link_geometry(model, side.link), side.actual, side.deviation
    if drawn is None or deviation.mass > threshold or deviation.com_offset <= threshold:
        return None
    return replace(side, expected=replace(actual, com=side.expected.com)) if _is_com_of_image(side, drawn) else None


def find_cause(pair: MirrorPair, side: PairSide, threshold: float) -> str | None:
    """Find why two inertials are not related as the drawings are; None where nothing explains all differences.

    ``copied`` or ``mirrored`` where the drawings were not; ``products_sign`` where the numbers are right but for the signs
    of all products; ``signs`` for other signs, in frames whose axes are mirror images: only there a mirror changes signs;
    ``decimal`` where one coordinate of the COM differs by a power of ten; ``rounded`` where one tensor is the other's, with too
    few digits.
    """
    if side.deviation.mass > threshold:
        return None
    is_off = side.deviation.worst > threshold  # else only digits may be missing
    if is_off and any(_is_derived_from(side, copy, threshold) for copy in side.disallowed):
        return "copied"
    if is_off and pair.drawn_as == "copied" and _is_derived_from(side, side.image, threshold):
        return "mirrored"
    if find_rounding(side.actual, side.expected) or find_rounding(side.expected, side.actual):
        return "rounded"
    if side.deviation.spread <= threshold and _has_slipped_coordinate(side):
        return "decimal"
    signs = find_wrong_signs(side.actual, side.expected, threshold)
    if signs == PRODUCTS:
        return "products_sign"
    return "signs" if signs and is_axis_renaming(pair.linear) else None


def find_half_turn(side: PairSide, threshold: float) -> str | None:
    """Find the axis of the link about which half a turn makes the twin's numbers those of the side, signs and all; None where
    none does: the part of one side may be used on the other, turned."""
    twin = read_declared_inertial(side.twin)
    if twin is None or side.deviation.mass > threshold:
        return None
    for axis, signs in zip("xyz", 2.0 * np.eye(3) - 1.0, strict=True):
        turn = np.diag(signs)
        turned = DeclaredInertial(twin.mass, turn @ twin.com, turn @ twin.inertia @ turn)
        if measure_deviation(side.actual, turned).worst <= COPIED and _is_derived_from(side, turned, threshold):
            return axis
    return None


def _has_slipped_coordinate(side: PairSide) -> bool:
    """Whether one coordinate of a COM is a power of ten times the expected one, and the others are as expected."""
    actual, expected = side.actual.com, side.expected.com
    off = np.abs(actual - expected) > COPIED * np.maximum(np.abs(actual), np.abs(expected)).max()
    ratio = float(actual[off][0] / expected[off][0]) if off.sum() == 1 and expected[off].all() else 0.0
    power = round(math.log10(ratio)) if ratio > 0.0 else 0
    return power != 0 and math.isclose(ratio, 10.0**power, rel_tol=COPIED)


def find_side_slip(both: Sequence[PairSide], threshold: float) -> TwinSlip | None:
    """Find the one mistake that explains all of the difference between two sides; None where none does.

    A mistake is found by what a mirror does not change. One of the tensor leaves the COM, which has to be the twin's image.
    """
    slip, deviation = find_slip_between_twins(both[0].actual, both[1].actual), both[1].deviation
    is_of_com = max(deviation.mass, deviation.spread) <= threshold
    if slip is None or deviation.com_offset <= threshold or is_of_com or slip.mistake.id in _OF_ALL_LENGTHS:
        return slip
    return None


def find_copied_side(model: Model, one: Link, other: Link) -> tuple[Link, Link] | None:
    """Find the side whose mass and tensor are those of a link that is no counterpart of either, to nine digits, and that link;
    None where neither side or both have such numbers."""
    found: list[tuple[Link, Link]] = []
    for side in (one, other):
        others = [link for link in model.links if remove_places(link.name) != remove_places(side.name)]
        source = find_same_numbers(model, side, others)
        found += [] if source is None else [(side, source)]
    return found[0] if len(found) == 1 else None


def find_same_numbers(model: Model, link: Link, others: Iterable[Link]) -> Link | None:
    """Find the first of some ``others`` with the mass and the tensor of a link, to nine digits; None where none has them, or so
    few digits that chance makes them equal."""
    declared = model.tensor_by_name[link.name]
    numbers = {declared.inertial.mass, *map(abs, declared.components)} - {None, 0.0}
    if sum(len(f"{number:.16g}".partition("e")[0].replace(".", "").strip("0")) for number in numbers) < _TELLING_DIGITS:
        return None
    typed = _round_typed_numbers(declared)
    for other in others:
        known = model.tensor_by_name.get(other.name)
        if known is not None and known.inertial.mass is not None and _round_typed_numbers(known) == typed:
            return other
    return None


def _round_typed_numbers(declared: DeclaredTensor) -> tuple[str, ...]:
    """Return mass and tensor with as many digits as a program writes that copies them."""
    numbers = (declared.inertial.mass or 0.0, *declared.components)
    return tuple(f"{number + 0.0:.{_COPIED_DIGITS}g}" for number in numbers)


def find_contradicted_links(model: Model, threshold: float = 0.01) -> frozenset[str]:
    """Find the links of pairs whose inertials were ``copied`` while the drawings are mirrored, or the reverse.

    None where the tree is broken.
    """
    links: set[str] = set()
    try:
        pairs = mirror_pairs(model)
    except FactUnavailableError:
        return frozenset()
    for pair in pairs:
        both = compare_sides(model, pair)
        if (
            both is not None
            and both[1].deviation.worst > threshold
            and find_cause(pair, both[1], threshold) in CONTRADICTIONS
        ):
            links |= {pair.one, pair.other}
    return frozenset(links)


def _is_derived_from(side: PairSide, source: DeclaredInertial, threshold: float) -> bool:
    """Whether the parts of an inertial that are wrong are those of ``source``."""
    expected, same = side.deviation, measure_deviation(side.actual, source)
    parts = ((expected.com_offset, same.com_offset), (expected.spread, same.spread))
    return all(share <= COPIED for wrong, share in parts if wrong > threshold)


def list_inertial_changes(side: PairSide, threshold: float = 0.0) -> list[AttributeChange]:
    """List what changes in the text of the side's inertial if its twin is right.

    Numbers that differ by rounding stay as they are, where the sides then agree to within ``threshold``, and so does a COM that
    agrees.
    """
    if side.deviation.com_offset <= threshold:
        side = replace(side, expected=replace(side.expected, com=side.actual.com))
    kept = _keep_near_numbers(side)
    deviation = measure_deviation(kept, side.expected)
    return _list_changes(side, kept if deviation.worst <= threshold else side.expected)


def _keep_near_numbers(side: PairSide) -> DeclaredInertial:
    """Return the expected numbers, with the side's own ones where these differ by no more than rounding, up to their sign."""
    actual, expected, turn = side.actual, side.expected, side.actual.rotation
    typed = turn.T @ expected.inertia @ turn
    reach = COPIED * max(float(np.linalg.norm(actual.com)), math.sqrt(float(np.trace(actual.tensor)) / actual.mass))
    return DeclaredInertial(
        mass=actual.mass if abs(actual.mass - expected.mass) <= COPIED * expected.mass else expected.mass,
        com=_keep_near(actual.com, expected.com, 0.01 * reach),
        tensor=_keep_near(actual.tensor, typed, 0.01 * COPIED * float(np.abs(typed).max())),
        rotation=turn,
    )


def _keep_near(actual: Array, expected: Array, least: float) -> Array:
    """Return the expected numbers, with the digits of ``actual`` where the magnitudes agree; below ``least`` all agree."""
    near = np.abs(np.abs(actual) - np.abs(expected)) <= np.maximum(COPIED * np.abs(expected), least)
    signed = np.where(np.abs(expected) <= least, actual, np.copysign(actual, expected))
    kept: Array = np.where(near, signed, expected)
    return kept


def _list_changes(side: PairSide, wanted: DeclaredInertial) -> list[AttributeChange]:
    inertial, turn = side.link.inertial, side.actual.rotation
    if inertial is None:
        return []
    changes: list[AttributeChange] = []
    if not _is_same_number(side.actual.mass, wanted.mass):
        changes.append(_write_change(inertial.mass_attribute, "mass", [wanted.mass]))
    com = _clear_rounding(wanted.com)
    if not all(map(_is_same_number, _clear_rounding(side.actual.com), com)):
        changes.append(_write_change(inertial.origin.get_attribute("xyz"), "xyz", com))
    tensor = _clear_rounding(np.array(list_inertia_components(turn.T @ wanted.inertia @ turn)))
    element = inertial.tensor_element
    for name, old, new in zip(TENSOR_NAMES, list_inertia_components(side.actual.tensor), tensor, strict=True):
        if not _is_same_number(old, new):
            attribute = None if element is None else element.attributes.get(name)
            changes.append(_write_change(attribute, name, [new]))
    return changes


def _write_change(attribute: Attribute | None, name: str, values: Sequence[float]) -> AttributeChange:
    typed = "" if attribute is None else attribute.value
    return AttributeChange(attribute, name, write_numbers(typed, values, digits=10))


def _clear_rounding(values: Array) -> list[float]:
    """Return values without what products of rotation matrices leave of a zero."""
    largest = float(np.abs(values).max())
    return [0.0 if abs(v) <= 1e-9 * largest else v for v in values.tolist()]


def _is_same_number(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-15)
