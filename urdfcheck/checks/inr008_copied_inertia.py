"""INR008 reports links of different shape with the same inertia tensor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_box_size, join_names
from urdfcheck.facts.inertials.certainty import VAST
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance, compute_solid_inertia
from urdfcheck.facts.inertials.mistakes.tensor_slips import find_filled_products
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.inertials.diagnosis_words import NOTABLE
from urdfcheck.model.inertials.habits.minor_findings import set_chosen_aside, set_lost_aside
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.inertial_effects import LIGHT, is_light, is_vast
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.parts import has_drawn_shape, is_dummy_shape
from urdfcheck.model.rigid_bodies import compute_body_tensor, is_point_mass
from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity, measure_role_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.inertia_tensor import Solid


# Tensors that agree in this many digits were copied.
_DIGITS = 9
_ROLES = ("visual", "collision")
# A copied COM may have been rounded, or come from a later export of the part, by this part of its distance from the origin.
_SAME_COM = 0.002
# Two shapes are of one size if no side differs by more than this share of the longest one (chosen).
_SAME_EXTENT = 0.1
# A number of fewer digits may be twice there by chance.
_TELLING_DIGITS = 4
# A tensor is about other axes than the drawn part's, and a COM is not that of the part, beyond these shares (chosen).
_TURNED, _AWAY = 0.25, 0.5


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _InertiaSignature:
    """A link with a tensor and a shape, both as logarithms (3,) of the eigenvalues of a covariance in m², ascending."""

    declared: DeclaredTensor
    role: str
    """The shapes that it is known by: ``visual``, or ``collision`` of a link that draws nothing."""
    mass: float
    """kg, as declared."""
    inertia: Array
    """Of the declared mass distribution."""
    solid: Array
    """Of the drawn solid at uniform density."""
    hull: Array
    """Of its convex hull at uniform density."""
    extent: Array
    """What is drawn along the axes of the link, in m."""
    is_in_place: bool
    """Whether the axes of the tensor and the COM are about those of the drawn solid."""

    def measure_shape_distance(self, other: _InertiaSignature) -> float:
        """Return the distance between the shapes, size included; 0 for equal, rotated or mirrored ones."""
        return min(_measure_distance(self.solid, other.solid), _measure_distance(self.hull, other.hull))

    def compare_moments(self, other: _InertiaSignature) -> float:
        """Return the largest ratio of principal moments of the drawn parts at their masses, as solids or hulls: the lesser."""
        weight = np.log(self.mass / other.mass)
        pairs = ((self.solid, other.solid), (self.hull, other.hull))
        return min(_compare_moments(first + weight, second) for first, second in pairs)

    @property
    def moment_misfit(self) -> float:
        """The largest ratio of a principal moment of the tensor to that of the drawn part at its mass, as a solid or a hull: the
        lesser."""
        return min(_compare_moments(self.inertia, drawn) for drawn in (self.solid, self.hull))

    @property
    def misfit(self) -> float:
        """The distance of the tensor from the link's own shape."""
        return _measure_distance(self.inertia, self.solid)


def check(model: Model, rule: Rule, *, shape: float, moments: float) -> Iterator[Finding]:
    findings = set_chosen_aside(model, rule, _check(model, rule, shape=shape, moments=moments), by_replaced=True)
    yield from set_lost_aside(model, rule, findings)


def _check(model: Model, rule: Rule, *, shape: float, moments: float) -> Iterator[Finding]:
    groups: dict[tuple[str, ...], list[DeclaredTensor]] = {}
    for declared in model.tensors:
        # A mirrored part has products of the other sign.
        groups.setdefault(tuple(f"{abs(v):.{_DIGITS}g}" for v in declared.components), []).append(declared)
    for tensors in groups.values():
        if len(tensors) > 1:
            parts = [part for declared in tensors if (part := _compute_signature(model, declared)) is not None]
            for role in _ROLES:  # a drawing is not compared with a collision shape
                alike = [part for part in parts if part.role == role]
                yield from _compare_shapes(model, rule, alike, shape, moments=moments)
    yield from _check_masses(model, rule, shape)


def _check_masses(model: Model, rule: Rule, shape: float) -> Iterator[Finding]:
    """Report links of different shape with the mass and the COM of one part, and each with its own tensor."""
    groups: dict[str, list[DeclaredTensor]] = {}
    for declared in model.tensors:
        mass, com = declared.inertial.mass, declared.inertial.origin.xyz
        if (
            mass is not None
            and com is not None
            and _has_telling_digits(mass)
            and sum(map(_has_telling_digits, com)) > 1
        ):
            groups.setdefault(f"{mass:.{_DIGITS}g}", []).append(declared)
    for tensors in groups.values():
        parts = [part for one in tensors if (part := _compute_signature(model, one, is_tensor=False)) is not None]
        for role in _ROLES:
            yield from _compare_masses(rule, [part for part in parts if part.role == role], shape)


def _compare_masses(rule: Rule, parts: Sequence[_InertiaSignature], shape: float) -> Iterator[Finding]:
    for i, part in enumerate(parts):
        for other in parts[:i]:
            names = [remove_places(one.declared.link.name) for one in (part, other)]
            same = np.allclose(np.abs(part.declared.components), np.abs(other.declared.components), rtol=1e-6, atol=0.0)
            if names[0] == names[1] or same or not part.measure_shape_distance(other) > shape:
                continue
            com, other_com = (np.abs(one.declared.inertial.origin.xyz or ()) for one in (part, other))
            if float(np.linalg.norm(com - other_com)) > _SAME_COM * float(np.linalg.norm(com)):
                continue
            finding = rule.finding(
                "mass",
                at=part.declared.inertial.element,
                related=[other.declared.inertial.element],
                links=part.declared.link.name,
                original=other.declared.link.name,
                role=part.role,
                mass=f"{part.declared.inertial.mass:g}",
                difference=_describe_difference(part, other),
            )
            subjects = (part.declared.element.subject, other.declared.element.subject)
            yield replace(finding, subjects=subjects)


def _has_telling_digits(value: float) -> bool:
    """Whether a number has so many digits that it is not twice there by chance."""
    return abs(value - float(f"{value:.{_TELLING_DIGITS - 1}g}")) > 1e-9 * abs(value)


def _compare_shapes(
    model: Model, rule: Rule, parts: Sequence[_InertiaSignature], shape: float, *, moments: float
) -> Iterator[Finding]:
    """Report the links with one tensor whose shapes, and so moments, differ from those of the part that it fits best."""
    if not parts:
        return
    original = min(parts, key=lambda part: part.misfit)
    # One part on several sides may be drawn or simplified differently, and rightly shares its tensor.
    part_name = remove_places(original.declared.link.name)
    others = [part for part in parts if remove_places(part.declared.link.name) != part_name]
    copies = [
        part
        for part in others
        if part.measure_shape_distance(original) > shape and part.compare_moments(original) >= moments
    ]
    # One estimate for parts of about one size is near to each of them.
    if not copies or all(part.moment_misfit < moments for part in (original, *copies)):
        return
    # If the tensor fits no part well, or several, which of them is the copy is not known: the finding is about all that have it.
    fits = original.misfit <= 2 * shape and original.is_in_place
    known = fits and 2 * shape < min(part.misfit for part in copies)
    for wrong in _split_by_extent(copies, original) if known else [list(parts)]:
        yield _build_finding(model, rule, wrong, original, known=known)


def _split_by_extent(copies: Sequence[_InertiaSignature], original: _InertiaSignature) -> list[list[_InertiaSignature]]:
    """Split copies by what they have of the original, for the repairs differ."""
    groups: dict[str, list[_InertiaSignature]] = {}
    for part in copies:
        groups.setdefault(_name_shared_numbers([part, original]), []).append(part)
    return list(groups.values())


def _name_shared_numbers(parts: Sequence[_InertiaSignature]) -> str:
    """Name what links with one tensor have in common: a mass of few digits may be twice there by chance."""
    coms = [one.declared.inertial.origin.xyz or (0.0, 0.0, 0.0) for one in parts]
    same_com = len({tuple(f"{abs(v):.{_DIGITS}g}" for v in com) for com in coms}) == 1 and any(coms[0])
    if len({f"{part.mass:.{_DIGITS}g}" for part in parts}) > 1:
        return "inertia tensor"
    if same_com:
        return "mass, COM and inertia tensor"
    return "mass and inertia tensor" if _has_telling_digits(parts[0].mass) else "inertia tensor"


def _build_finding(
    model: Model, rule: Rule, wrong: Sequence[_InertiaSignature], original: _InertiaSignature, *, known: bool
) -> Finding:
    worst = max(wrong, key=lambda part: part.measure_shape_distance(original))
    places = [part.declared.element for part in wrong]
    shared = _name_shared_numbers([*wrong, original])
    judged = inertial_diagnoses(model)
    explained = _list_explained(wrong, judged)
    vast = [name for name in explained if is_vast(model, model.link_by_name[name], judged[name])]
    finding = rule.finding(
        "copied" if known else "shared",
        at=places[0],
        related=[original.declared.element, *places[1:]] if known else places[1:],
        severity=Severity.ERROR
        if vast
        else Severity.INFO
        if all(_is_slight_part(model, part) for part in wrong)
        else None,
        links=join_names([part.declared.link.name for part in wrong]),
        original=original.declared.link.name,
        worst=worst.declared.link.name,
        shared=shared,
        claim="the inertia tensor is that" if shared == "inertia tensor" else f"{shared} are those",
        repair=_describe_repair(shared, original, known=known),
        equal=_describe_equality([*wrong, original]),
        role=original.role,
        difference=_describe_difference(worst, original),
        count=len(wrong),
        vast=f". For the mass of {join_names(vast)} it is more than {VAST:,.0f} times too large" if vast else "",
        # INR009 would look for a mistake in numbers that are those of another part.
        explains=[f"INR009 link[{name}]" for name in explained],
    )
    return replace(finding, subjects=tuple(dict.fromkeys(element.subject for element in places)))


def _is_slight_part(model: Model, part: _InertiaSignature) -> bool:
    """Whether a link is fixed to a body that its mass and its tensor hardly change."""
    link = part.declared.link
    if not is_light(model, link):
        return False
    whole = compute_body_tensor(model, model.pieces.list_body_links(link.name))
    return whole is not None and float(np.trace(part.declared.tensor)) < LIGHT * float(np.trace(whole))


def _describe_repair(shared: str, original: _InertiaSignature, *, known: bool) -> str:
    """Describe the repair: with the mass of another part, an inertia that is computed at it is as wrong."""
    if shared == "inertia tensor" and known:
        return "export the inertia again, or compute it from the drawn shape at the link's mass"
    if shared == "inertia tensor":
        return "export the inertias again, or compute them from the drawn shapes at the links' masses"
    why = f"they are those of {original.declared.link.name}" if known else "at least one link has those of another part"
    return f"export {shared.removesuffix(' tensor')} again: {why}"


def _describe_equality(parts: Sequence[_InertiaSignature]) -> str:
    """Say how equal the tensors are: a mirrored part has products of the other sign."""
    tensors = {part.declared.components for part in parts}
    signs = {tuple(value < 0 for value in components) for components in tensors}
    equal = "digit for digit" if len({tuple(map(abs, one)) for one in tensors}) == 1 else f"to {_DIGITS} digits"
    return equal if len(signs) == 1 else f"{equal}, apart from the signs of products"


def _list_explained(parts: Sequence[_InertiaSignature], judged: Mapping[str, DiagnosedInertial]) -> list[str]:
    """List the links of which the tensor alone disagrees with what they draw, and shows no mistake of its own for certain."""
    known = [(name, judged[name].diagnosis) for part in parts if (name := part.declared.link.name) in judged]
    return [
        name
        for name, diagnosis in known
        if (diagnosis.cause is None or not diagnosis.unique) and diagnosis.com_mismatch <= NOTABLE
    ]


def _compute_signature(model: Model, declared: DeclaredTensor, *, is_tensor: bool = True) -> _InertiaSignature | None:
    """Return what a link is compared by; None where it says nothing. ``is_tensor``: about its tensor, not its mass and COM."""
    link, mass = declared.link, declared.inertial.mass
    if mass is None or not mass > 0 or not has_drawn_shape(link) or is_point_mass(declared.inertial):
        return None
    if is_tensor and (
        _says_nothing(declared)
        or describe_placeholder(mass, declared.components)
        or find_filled_products(declared.components, declared.texts)
    ):
        return None
    role = "visual" if any(not is_dummy_shape(shape) for shape in link.visuals) else "collision"
    drawn = measure_role_geometry(model, link, role)
    # A mesh that programs read in different sizes (MSH008) is compared with nothing.
    if drawn is None or drawn.hull is None or has_unit_ambiguity(model, (link.name,)):
        return None
    return _InertiaSignature(
        declared=declared,
        role=role,
        mass=mass,
        inertia=_compute_log_eigenvalues(compute_mass_covariance(declared.tensor, mass)),
        solid=_compute_log_eigenvalues(drawn.solid.covariance),
        hull=_compute_log_eigenvalues(drawn.hull.covariance),
        extent=np.ptp(drawn.points, axis=0),
        is_in_place=_is_in_place(declared, drawn.solid, mass),
    )


def _is_in_place(declared: DeclaredTensor, solid: Solid, mass: float) -> bool:
    """Whether the axes of a tensor are about those of a ``solid`` of this ``mass`` (kg), and its COM is about there."""
    inertia, matrix = declared.inertial.tensor_in_link, declared.inertial.origin.matrix
    if inertia is None or matrix is None:
        return False
    uniform = compute_solid_inertia(solid, mass)
    moments = np.linalg.eigvalsh(inertia) - np.linalg.eigvalsh(uniform)
    turned = float(np.linalg.norm(inertia - uniform) - np.linalg.norm(moments))
    radius = float(np.sqrt(np.trace(solid.covariance)))
    off = float(np.linalg.norm(matrix[:3, 3] - solid.com))
    return turned <= _TURNED * float(np.linalg.norm(uniform)) and off <= _AWAY * radius


def _says_nothing(declared: DeclaredTensor) -> bool:
    """Whether equal tensors prove no copy: a multiple of the identity, or numbers of one digit."""
    ixx, ixy, ixz, iyy, iyz, izz = declared.components
    is_isotropic = ixx == iyy == izz and not any((ixy, ixz, iyz))
    return is_isotropic or all(float(f"{value:.0e}") == value for value in declared.components)


def _compute_log_eigenvalues(covariance: Array) -> Array:
    """Return the logarithms of the eigenvalues, none of them below the thickness of a sheet of that size."""
    values = np.linalg.eigvalsh(covariance)
    logarithms: Array = np.log(np.maximum(values, 1e-6 * max(float(values[-1]), 1e-300)))
    return logarithms


def _measure_distance(first: Array, second: Array) -> float:
    return float(np.linalg.norm(first - second))


def _compare_moments(first: Array, second: Array) -> float:
    """Return the largest ratio of the principal moments that two sets of logarithms of second moments give, at least 1."""
    moments = [np.sum(np.exp(values)) - np.exp(values) for values in (first, second)]
    return float(np.exp(np.abs(np.log(moments[0] / moments[1])).max()))


def _describe_difference(part: _InertiaSignature, other: _InertiaSignature) -> str:
    """Describe how two shapes differ: by the sizes that they are drawn in, or, where these are about the same, by how far what is
    drawn is spread. The solid box with the same second moments is larger than four legs far apart, and smaller than a ball."""
    names = [one.declared.link.name for one in (part, other)]
    longest = [np.sort(one.extent) for one in (part, other)]
    if float(np.abs(longest[0] - longest[1]).max()) > _SAME_EXTENT * float(max(longest[0][-1], longest[1][-1])):
        sizes = [format_box_size(one.extent, digits=2) for one in (part, other)]
        return f"{names[0]} measures {sizes[0]} along x, y and z, {names[1]} {sizes[1]}"
    boxes = [format_box_size(np.sqrt(12.0 * np.exp(one.solid))[::-1], digits=2) for one in (part, other)]
    return f"{names[0]} has the second moments of a solid box of {boxes[0]}, {names[1]} those of one of {boxes[1]}"
