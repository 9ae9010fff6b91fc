"""The common mistakes in an ``<inertial>``, and how often each is made."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
    from urdfcheck.facts.inertials.inertia_tensor import Solid
    from urdfcheck.facts.inertials.inertial_fit import Reference

# Natural logarithm of how often a mistake is made, relative to no mistake: e⁻³ = 1 in 20, e⁻⁵ = 1 in 150. A name in brackets is
# a rarer or likelier form of the mistake, or one that stands for several values.
#
# No prior was fitted. They are steps of half a nat by plausibility, and the parts that benchmarks/accuracy keeps for tuning
# decided which to keep. "Confirmed" counts the findings in 104 published robots that a person read and found true
# (benchmarks/accuracy/labels.tsv, 2026-11-21). "Suspected" counts links that a prototype named among 2,291 links of 286
# published files, unread.
LOG_PRIORS = {
    "none": 0.0,
    # Suspected: 30 links with some wrong unit. CAD programs report g and mm; pounds and tonnes are rarer.
    "inertia_unit": -3.0,
    "inertia_unit (lb, t)": -4.0,
    "inertia_unit (a power of ten)": -5.0,  # not a unit in use
    "mass_unit": -3.0,  # g
    "mass_unit (lb, mg, t)": -4.0,
    "com_unit": -3.0,
    # Several numbers in the units of one program; half a nat less than one of them alone.
    "units": -3.5,
    "units (g and g·m²)": -4.0,  # the mass in g, and the inertia per that mass
    "units (mg and mg·m²)": -5.0,
    "mesh_scale": -3.5,  # millimetres
    "mesh_scale (cm, in)": -4.5,
    "about_origin": -2.5,  # CAD programs print the tensor about the origin beside that about the COM
    # Half a nat less: SolidWorks and others print it with products of the other sign ("positive tensor notation").
    "positive_notation": -3.0,
    "steiner_twice": -3.5,  # less obvious: the theorem was known
    "steiner_missing": -4.5,  # confirmed: 15 links of 2 robots; needs several pieces
    "own_missing": -4.5,  # confirmed: 7 links of 1 robot; needs several pieces
    "one_piece": -4.0,  # confirmed: 1
    "products_sign": -2.5,  # confirmed: 6 links of 4 robots; suspected: 54 links of 16 files
    "axes_permuted": -3.5,  # confirmed: 1; each of five orders
    "slots_swapped": -5.0,  # a slip of the hand; each of 15 pairs
    "quarter_turn": -4.0,  # each of six
    "slots_shifted": -5.0,  # each of two ways
    # A product equals a moment to the last digit, which chance does in one part of thousands.
    "slots_shifted (a product repeats a moment)": 3.0,
    "com_missing": -2.5,  # confirmed: 5 links of 4 robots
    "com_missing (tensor about the origin)": -3.5,  # confirmed: 21 links of 1 robot
    "unmirrored": -3.0,
    "unmirrored (the tensor alone)": -9.0,  # signs of all products are likelier: only where one of them is right already
    # Evidence, not frequency: the product that a flip of all three would make wrong is right, in size and sign.
    "unmirrored (the tensor alone, product by product)": -1.0,
    "unmirrored (has a twin)": -2.0,  # a part with a mirror image is the one whose numbers were copied
    "rpy_missing": -3.0,  # confirmed: 1
    "rpy_twice": -3.5,
    "diagonal_first": -3.0,  # the order of MuJoCo's fullinertia
    # Two of six numbers are equal to the last digit, which chance does in one part of thousands: evidence, not frequency.
    "row_major": 8.0,
    "row_major (of zeros)": 0.0,
    "one_sign": -4.5,  # a slip of the hand; each of nine numbers
    # A slip of the hand; each of ten numbers and six powers of ten, half a nat less per digit; or all of the COM's, or of the
    # tensor's.
    "decimal_point": -4.5,
    "rounded": -2.5,  # to so few decimals that the drawn part's numbers round to the typed ones
    "wrong_formula": -2.5,  # each of the formulas for another solid; only for one box, cylinder or sphere
    "wrong_formula (other axes)": -4.0,
    "shell": -3.0,  # suspected: 24 links
    "bounding_box": -3.0,  # suspected: 25 links
    "convex_hull": -3.5,
    "other_mass": -3.5,  # confirmed: 10 links of 2 robots; spread over all masses, see `_REVISION`
}
# The ids of the mistakes that can be named.
HYPOTHESES = tuple(name for name in LOG_PRIORS if "(" not in name and name != "none")

# A mistake that changes less, a seventh of the mass or the second moments, is not reported.
EFFECT = 0.15
# In a part of more pieces, nobody mistakes one for the whole.
_MOST_PIECES = 6

# URDF's order of the components, and their places in the matrix.
COMPONENT_NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
COMPONENT_INDICES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistake:
    """One mistake with its parameter."""

    id: str
    """One of `HYPOTHESES`, or ``none``."""
    detail: str = ""
    """The parameter, such as a unit."""
    log_prior: float
    factor: float = 1.0
    """How many times as large as drawn the part is."""
    borrowed: tuple[int, int] = (0, 0)
    """Degrees of freedom of the tensor and of the COM that are taken from the reference to undo the mistake."""
    source_body: Solid | None = None
    """The body whose numbers were taken for the part's."""


@dataclass(frozen=True, eq=False)
class Suspect:
    """An inertial, and what it is compared with."""

    declared: DeclaredInertial
    reference: Reference
    geometry: VisualGeometry | None

    @cached_property
    def has_turned_frame(self) -> bool:
        return bool(np.abs(self.declared.rotation - np.eye(3)).max() > 1e-6)

    @cached_property
    def parallel_axis_shift(self) -> Mat3:
        """What the parallel-axis theorem adds from the COM to the link's origin, in the inertial frame's axes."""
        mass, lever = self.declared.mass, self.declared.rotation.T @ self.declared.com
        return compute_parallel_axis_term(mass, lever)


def make_mistake(prior: str, detail: str = "", *, penalty: float = 0.0) -> Mistake:
    """Make a mistake whose ``prior`` is a name of `LOG_PRIORS`, made less likely by ``penalty`` nats."""
    return Mistake(id=prior.partition(" (")[0], detail=detail, log_prior=LOG_PRIORS[prior] - penalty)
