"""The repair of a tensor that no body can have, as an edit and in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Edit
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import build_inertia_tensor, check_inertia_validity
from urdfcheck.model.parts import Link
from urdfcheck.model.repairs.inertial_edits import InertialRepair, build_inertial_repair

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3

# A flat part's tensor that was typed with three digits may miss the triangle inequality by this share of its largest moment.
_TRIANGLE_SLACK = 5e-3
# A tensor whose digits are too few gets the nearest possible one as an edit where it changes less than this part.
SMALL_EXCESS = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class InertialProposal:
    """The repair of an inertial that cannot be right; empty where nothing is known."""

    edits: tuple[Edit, ...] = ()
    message: str = ""
    """What a message says about it, starting with its semicolon."""
    remedy: str = ""
    """How the advice begins."""
    comparison: str = ""
    """How the advice ends: numbers that are near the right ones at best, starting with a semicolon."""
    cause: str | None = None
    """The id of the cause on the pages of INR003 and INR004, where the numbers show one."""
    detail: str = ""
    """The parameter of the cause."""
    is_located: bool = False
    """Whether the wrong number is known, so that no other slip need be looked for."""
    oversize: str = ""
    """How many times the drawn part's moments these are, if no part of the drawn size can have them; empty otherwise."""


def is_possible_tensor(tensor: Mat3) -> bool:
    """Whether a body can have a tensor (3, 3), up to the digits that are usually typed."""
    validity = check_inertia_validity(tensor, _TRIANGLE_SLACK)
    return validity.positive_definite and validity.triangle_inequality


def replace_tensor(link: Link, components: Sequence[float], digits: int = 6) -> InertialRepair | None:
    """Build the change of the tensor alone."""
    inertial = link.inertial
    matrix = None if inertial is None else inertial.origin.matrix
    if inertial is None or inertial.mass is None or matrix is None:
        return None
    com, rotation = matrix[:3, 3], matrix[:3, :3]
    tensor = build_inertia_tensor(components)
    wanted = DeclaredInertial(mass=inertial.mass, com=com, tensor=tensor, rotation=rotation)
    return build_inertial_repair(inertial, wanted, digits)
