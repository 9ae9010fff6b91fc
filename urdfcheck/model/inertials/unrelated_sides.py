"""The inertials of a pair of which no drawing says how the sides are related: what mirror images and copies have in common."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_length, join_numbers
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.twin_slips import TwinSlip, find_slip_between_twins
from urdfcheck.facts.likeness.mirror import InertialDeviation, measure_principal_deviation
from urdfcheck.model.inertials.mirrored_inertials import (
    COPIED,
    find_copied_side,
    find_typed_side,
    fit_own_drawings_alike,
    get_possible_inertial,
)
from urdfcheck.model.inertials.proposals.mistake_names import describe_mistake
from urdfcheck.model.likeness.mirror_pairs import MirrorPair
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# Solids are one part, and in one place of two frames, to within this share of a volume or a length.
_SAME_SOLID = 0.01
# A COM is away from the frame from this share of the radius of gyration on (chosen).
_FAR_COM = 0.1
# By how many places a decimal point slips to do the same as these units.
_PLACES = {"cm": "two", "mm": "three"}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class UnlikeSides:
    """Two counterparts whose masses, principal moments or COMs differ."""

    one: Link
    other: Link
    numbers: tuple[DeclaredInertial, DeclaredInertial]
    deviation: InertialDeviation
    slip: TwinSlip | None
    """The one mistake that explains all of the difference."""
    typed: Link | None
    """The side whose tensor was typed, where the other's was computed."""
    copied: tuple[Link, Link] | None
    """The side with the numbers of a link that is not a counterpart of either, and that link."""
    lost: Link | None
    """The side whose COM is 0 0 0, where that of the other is not, and all else agrees."""
    are_drawn: bool
    """Whether the shapes of both sides are known."""

    @property
    def wrong(self) -> Link:
        """The side that is wrong; the second one where nothing shows it."""
        if (known := self.typed or self.lost) is not None:
            return known
        is_first = self.slip.is_first if self.slip is not None else False
        return self.one if is_first or (self.copied is not None and self.copied[0] is self.one) else self.other

    @property
    def right(self) -> Link:
        """The side that is not `wrong`."""
        return self.other if self.wrong is self.one else self.one

    @property
    def is_explained(self) -> bool:
        """Whether the cause of the difference is known."""
        return any(found is not None for found in (self.slip, self.typed, self.copied, self.lost))

    @property
    def ratio(self) -> float:
        """How many times the tensor of one side is that of the other, at least 1."""
        ratio = float(np.trace(self.numbers[0].tensor)) / float(np.trace(self.numbers[1].tensor))
        return max(ratio, 1.0 / ratio)

    def is_of_one_part(self, threshold: float) -> bool:
        """Whether the masses agree, or the radii of gyration: two parts that differ have neither in common."""
        return min(self.deviation.mass, self.deviation.spread) <= threshold

    def describe_differences(self, threshold: float) -> str:
        """Say what differs by more than the share ``threshold``."""
        first, second = self.numbers
        differences = []
        if self.deviation.mass > threshold:
            differences.append(f"masses of {first.mass:.4g} and {second.mass:.4g} kg")
        if self.deviation.spread > threshold or (self.slip is not None and self.slip.mistake.id == "rounded"):
            moments = _format_principal_moments(first), _format_principal_moments(second)
            differences.append(f"principal moments of ({moments[0]}) and ({moments[1]}) kg·m²")
        if not differences:
            distances = [format_length(float(np.linalg.norm(numbers.com))) for numbers in self.numbers]
            differences.append(f"COMs {distances[0]} and {distances[1]} from their frames")
        return " and ".join(differences)


def compare_unrelated_sides(model: Model, pair: MirrorPair, *, threshold: float) -> UnlikeSides | None:
    """Compare the inertials of a named pair whose drawings are not related; None where they agree or may differ.

    Frames that are not mirror images may belong to parts that are not: there, only one mistake that explains all counts, and the
    numbers of a third link. Sides that carry other joints, such as a finger with a suction pad, are other parts.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    if pair.drawn_as not in {None, "neither"} or not pair.is_named:
        return None
    one, other = (model.link_by_name[name] for name in (pair.one, pair.other))
    first, second = get_possible_inertial(one), get_possible_inertial(other)
    if first is None or second is None:
        return None
    deviation, slip = measure_principal_deviation(second, first), find_slip_between_twins(first, second)
    is_one_part = pair.is_in_place and deviation.worst <= threshold
    lost = _find_lost_com((first, second)) if is_one_part else None
    if pair.is_alike is False:
        # Two parts may have any numbers; those of one part were copied, and then without the COM.
        if lost is None or deviation.worst > COPIED or _is_drawn_about_frame(model, (one, other)[lost]):
            return None
        slip = None
    if is_one_part and slip is None and lost is None and _are_at_one_point(model, one, other):
        deviation = replace(deviation, com_offset=_measure_com_gap(first, second))
    is_unlike = deviation.worst > threshold or lost is not None
    copied = find_copied_side(model, one, other) if slip is None and is_unlike else None
    is_comparable = pair.is_in_place or copied is not None
    if slip is None and not (is_comparable and is_unlike and _carry_alike(model, one, other)):
        return None
    is_of_com = lost is not None or deviation.com_offset > threshold
    if slip is None and not is_of_com and fit_own_drawings_alike(model, one, other, threshold=threshold):
        return None
    return UnlikeSides(
        one=one,
        other=other,
        numbers=(first, second),
        deviation=deviation,
        slip=slip,
        typed=find_typed_side(one, other) if slip is None and deviation.spread > threshold else None,
        copied=copied,
        lost=None if slip is not None or lost is None else (one, other)[lost],
        are_drawn=pair.drawn_as is not None,
    )


def describe_slip(slip: TwinSlip) -> str:
    """Say which mistake it is."""
    if slip.mistake.id == "com_unit":
        places = _PLACES.get(slip.mistake.detail)
        return f"the COM in {slip.mistake.detail}" + (f", or its decimal point {places} places off" if places else "")
    return describe_mistake(slip.mistake.id, slip.mistake.detail)


def _find_lost_com(numbers: tuple[DeclaredInertial, DeclaredInertial]) -> int | None:
    """Return which of two COMs is 0 0 0, where the other one is as far from its frame as matters; None where neither is."""
    is_zero = [not one.com.any() for one in numbers]
    if is_zero[0] == is_zero[1]:
        return None
    far = numbers[is_zero[0]]
    radius = math.sqrt(float(np.trace(far.inertia)) / (2.0 * far.mass))
    return is_zero.index(True) if float(np.linalg.norm(far.com)) > _FAR_COM * radius else None


def _is_drawn_about_frame(model: Model, link: Link) -> bool:
    """Whether what a link draws has its COM at the link's origin, or is not known."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return True
    radius = math.sqrt(max(0.0, float(np.trace(drawn.solid.covariance))))
    return float(np.linalg.norm(drawn.solid.com)) <= _FAR_COM * radius


def _are_at_one_point(model: Model, one: Link, other: Link) -> bool:
    """Whether two links show one solid, as far from both frames: the shapes that are known show it, if only those that collide.

    Then the COMs are as far from the frames, too, however the frames are turned or mirrored.
    """
    drawn = [measure_link_geometry(model, link) for link in (one, other)]
    if drawn[0] is None or drawn[1] is None:
        return False
    solids = [each.solid for each in drawn if each is not None]
    size = math.sqrt(max(0.0, float(np.trace(solids[0].covariance))))
    spreads = [np.sqrt(np.maximum(np.linalg.eigvalsh(solid.covariance), 0.0)) for solid in solids]
    distances = [float(np.linalg.norm(solid.com)) for solid in solids]
    is_one_solid = math.isclose(solids[0].volume, solids[1].volume, rel_tol=_SAME_SOLID)
    is_one_solid &= float(np.abs(spreads[0] - spreads[1]).max()) <= _SAME_SOLID * size
    return is_one_solid and abs(distances[0] - distances[1]) <= _SAME_SOLID * size


def _measure_com_gap(first: DeclaredInertial, second: DeclaredInertial) -> float:
    """Measure by how much more one COM is away from its frame than the other, as a share of the radius of gyration."""
    radius = math.sqrt(float(np.trace(first.inertia)) / (2.0 * first.mass))
    return abs(float(np.linalg.norm(first.com)) - float(np.linalg.norm(second.com))) / radius


def _carry_alike(model: Model, one: Link, other: Link) -> bool:
    """Whether equally many joints of each type hang on both links."""
    kinds = [Counter(joint.type for joint in model.tree.child_joints[link.name]) for link in (one, other)]
    return kinds[0] == kinds[1]


def _format_principal_moments(numbers: DeclaredInertial) -> str:
    return join_numbers(np.linalg.eigvalsh(numbers.inertia), digits=3)
