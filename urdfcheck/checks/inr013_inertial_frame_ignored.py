"""INR013 reports inertial frames whose rotation changes the tensor, because some programs ignore it."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Located, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.small_matrices import IDENTITY, make_tensor, measure_change, turn_tensor
from urdfcheck.model import CompleteInertial, Link, Model
from urdfcheck.model.repairs.edits import edit_all_numbers
from urdfcheck.source.text.xml import Element

# A rewritten number has the digits of a double, less the two that the rotation costs.
DIGITS = 14


@dataclass(frozen=True, slots=True, eq=False)
class _RotatedInertial:
    """An inertial whose frame is rotated."""

    declared: CompleteInertial
    origin: Element
    relative_change: float
    """The largest change of the tensor by the rotation, over its largest principal moment."""

    @property
    def place(self) -> Located:
        return self.origin.attributes.get("rpy", self.origin)


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    rotated = [part for declared in model.inertials if (part := _measure_rotation(declared, rel_tol)) is not None]
    if not rotated:
        return
    worst = max(rotated, key=lambda part: part.relative_change)
    # Numbers that are wrong in their frame stay wrong in another.
    right = [part for part in rotated if not _has_known_mistake(model, part.declared.link)]
    edits = {edit.span.start: edit for part in right for edit in _propose_edits(part)}
    yield rule.finding(
        "turned",
        at=worst.place,
        related=[part.place for part in rotated if part is not worst],
        edits=edits.values(),
        count="one link has" if len(rotated) == 1 else f"{len(rotated)} links have",
        links=join_names(part.declared.link.name for part in rotated),
        worst=worst.declared.link.name,
        percent=100 * worst.relative_change,
    )


def _measure_rotation(declared: CompleteInertial, rel_tol: float) -> _RotatedInertial | None:
    """Measure what the rotation of an inertial frame changes; None without a mass, a rotation or a noticeable change."""
    origin = declared.inertial.origin.element
    rotation, typed = declared.placement.rotation, make_tensor(declared.components)
    if not declared.mass or origin is None or rotation == IDENTITY:
        return None
    largest = max(map(abs, declared.moments))
    change = measure_change(turn_tensor(rotation, typed), typed)
    return _RotatedInertial(declared, origin, change / largest) if largest > 0 and change > rel_tol * largest else None


def _has_known_mistake(model: Model, link: Link) -> bool:
    from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses  # heavy, and needed for few robots only

    judged = inertial_diagnoses(model).get(link.name)
    return judged is not None and judged.diagnosis.at_fault and judged.diagnosis.cause is not None


def _propose_edits(part: _RotatedInertial) -> list[Edit]:
    """Return the edits that write the tensor in the link's axes and no rotation; nothing if one of the numbers is computed."""
    tensor = part.declared.tensor_in_link
    residue = 1e-12 * float(abs(tensor).max())
    values = [tensor[i, j] if abs(tensor[i, j]) > residue else 0.0 for i in range(3) for j in range(i, 3)]
    components = [(part.declared.get_attribute(i), f"{value:.{DIGITS}g}") for i, value in enumerate(values)]
    return edit_all_numbers([(part.origin.attributes.get("rpy"), "0 0 0"), *components])
