"""What other links say that a link's inertial should be."""

from __future__ import annotations

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.model.likeness.declared_inertials import estimate_from_twin
from urdfcheck.model.likeness.identical_parts import estimate_from_copies
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.robot import Model


@dataclass(frozen=True, slots=True, eq=False)
class InertialReference:
    """What other links say that the numbers of one should be."""

    numbers: DeclaredInertial
    """In the link's frame."""
    links: tuple[str, ...]
    """The names of the links that say so."""
    trusted: bool
    """Whether several agree."""


def collect_references(model: Model) -> dict[str, InertialReference]:
    """Return what other links say that one's numbers should be, by name.

    The others are those that draw the same part, else that on the other side.
    """
    try:
        pairs = mirror_pairs(model)
        copied = estimate_from_copies(model, excluded={frozenset((pair.one, pair.other)) for pair in pairs})
    except FactUnavailableError:
        return {}
    references = {
        name: InertialReference(copy.expected, tuple(link.name for link in copy.by), trusted=len(copy.by) > 1)
        for name, copy in copied.items()
    }
    for pair in pairs:
        for name, other in ((pair.one, pair.other), (pair.other, pair.one)):
            if name in references:
                continue
            twin = estimate_from_twin(model, model.link_by_name[name], [pair])
            if twin is not None:
                references[name] = InertialReference(twin, (other,), trusted=False)
    return references
