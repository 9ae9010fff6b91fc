"""INR004 reports inertia tensors that are not positive definite."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from urdfcheck.core import Edit, Finding, Located, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import (
    TensorRounding,
    build_inertia_tensor,
    compute_principal_moments,
    compute_triangle_excess,
    measure_tensor_rounding,
)
from urdfcheck.model import Inertial, Link, Model
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.model.repairs.inertial_edits import InertialProposal, propose_repair
from urdfcheck.model.rigid_bodies import compute_body_tensor, find_merged_body, is_point_mass

DIAGONAL = (0, 3, 5)
PRODUCTS = {1: (0, 3), 2: (0, 5), 4: (3, 5)}
# Gazebo judges the sum of what fixed joints join.
REFUSED = "refuses the model: the link has an invalid inertia (sdformat error 18)"
MERGED = "loads it: it merges what fixed joints join, and judges the sum"
NAN = "computes NaN accelerations: the point lies on the axis, and nothing resists (Drake stops with an error)"
FUSED = "; only together with {} and whatever else is fixed to it is the body a possible one"


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    points: list[Link] = []
    lines: list[Link] = []
    helpers: list[Link] = []
    for link in model.links:
        inertial = link.inertial
        if inertial is None or inertial.inertia_components is None:
            continue
        smallest, largest = _compute_moment_extremes(inertial.inertia_components)
        negative = [i for i in DIAGONAL if inertial.inertia_components[i] < 0]
        if is_point_mass(inertial):
            points.append(link)
        elif negative or smallest < -rel_tol * largest:
            whole = find_merged_body(model, link)
            possible = whole is not None and whole.is_physically_valid(rel_tol)
            fused = FUSED.format(whole.heaviest) if whole is not None and possible else ""
            typed = _count_typed_digits(inertial, rel_tol)
            if smallest > -rounding * largest and typed.explained_by_rounding:
                yield _build_rounded_finding(rule, link, typed, -smallest / largest, fused)
            elif whole is not None and possible and whole.link_is_negligible:
                helpers.append(link)
            elif negative:
                yield _build_negative_finding(rule, link, negative, fused, propose_repair(model, link))
            else:
                yield _build_product_finding(rule, link, smallest, fused, propose_repair(model, link))
        elif (
            smallest <= rel_tol * largest
            and compute_triangle_excess(build_inertia_tensor(inertial.inertia_components)) >= -rel_tol
        ):
            lines.append(link)
    # Only these need the tree: a rod or a point is no defect where what is fixed to it makes the body whole.
    yield from _check_singular_links(rule, model, "point", points, rel_tol)
    yield from _check_singular_links(rule, model, "line", lines, rel_tol)
    if helpers:
        yield rule.finding(
            "helper",
            at=_locate_tensor(helpers[0]),
            related=[_locate_tensor(link) for link in helpers[1:]],
            severity=Severity.INFO,
            links=join_names(link.name for link in helpers),
        )


def _compute_moment_extremes(six: Sequence[float]) -> tuple[float, float]:
    moments, _ = compute_principal_moments(build_inertia_tensor(six))
    return float(moments[0]), float(abs(moments).max())


def _is_valid_inertia(six: Sequence[float]) -> bool:
    smallest, largest = _compute_moment_extremes(six)
    return smallest > 1e-9 * largest and compute_triangle_excess(build_inertia_tensor(six)) >= -1e-9


def _count_typed_digits(inertial: Inertial, rel_tol: float) -> TensorRounding:
    element = inertial.tensor_element
    assert element is not None
    return measure_tensor_rounding([element.get(name) for name in TENSOR_NAMES], rel_tol)


def _build_rounded_finding(rule: Rule, link: Link, typed: TensorRounding, excess: float, fused: str) -> Finding:
    return rule.finding(
        "rounded",
        at=_locate_tensor(link),
        severity=Severity.WARNING,
        consequences={"gazebo": MERGED if fused else REFUSED},
        link=link.name,
        excess=excess,
        typed=typed.typed_digits,
        digits=typed.digits,
    )


def _build_negative_finding(
    rule: Rule, link: Link, negative: Sequence[int], fused: str, repair: InertialProposal
) -> Finding:
    """A negative diagonal entry; when dropping the signs makes it possible, and nothing better is known, the fix does that."""
    inertial = link.inertial
    assert inertial is not None
    six = inertial.inertia_components
    assert six is not None
    mended = [abs(v) if i in DIAGONAL else v for i, v in enumerate(six)]
    sign = _is_valid_inertia(mended) and not repair.message
    return rule.finding(
        "negative_sign" if sign else "negative",
        at=_locate(inertial, TENSOR_NAMES[negative[0]]),
        cause="sign" if _is_valid_inertia(mended) else _guess_cause(six),
        edits=_propose_edits(inertial, negative) if sign else repair.edits,
        consequences={"gazebo": MERGED if fused else REFUSED},
        link=link.name,
        fused=fused,
        found=repair.message,
        remedy=repair.remedy,
        names=", ".join(f"{TENSOR_NAMES[i]} = {six[i]:g}" for i in negative),
        values=" ".join(f'{TENSOR_NAMES[i]}="{abs(six[i]):g}"' for i in negative),
    )


def _propose_edits(inertial: Inertial, entries: Sequence[int]) -> list[Edit]:
    element = inertial.tensor_element
    assert element is not None
    edits = []
    for i in entries:
        attribute = element.attributes[TENSOR_NAMES[i]]
        if not attribute.literal or attribute.span is None:
            return []
        edits.append(Edit(attribute.span, attribute.typed, attribute.typed.replace("-", "", 1)))
    return edits


def _build_product_finding(rule: Rule, link: Link, smallest: float, fused: str, repair: InertialProposal) -> Finding:
    inertial = link.inertial
    assert inertial is not None
    six, place = inertial.inertia_components, inertial.tensor_element
    assert six is not None
    assert place is not None
    data: dict[str, Any] = {
        "link": link.name,
        "fused": fused,
        "consequences": {"gazebo": MERGED if fused else REFUSED},
        "found": repair.message,
        "remedy": repair.remedy,
        "smallest": smallest,
    }
    # |Ixy| > sqrt(Ixx Iyy) alone already makes the tensor indefinite; else it takes all three products together.
    excess = {i: abs(six[i]) - (six[a] * six[b]) ** 0.5 for i, (a, b) in PRODUCTS.items()}
    worst = max(excess, key=lambda i: excess[i])
    a, b = PRODUCTS[worst]
    if excess[worst] > 0:
        return rule.finding(
            "product",
            at=_locate(inertial, TENSOR_NAMES[worst]),
            cause=_guess_cause(six),
            edits=repair.edits,
            product=TENSOR_NAMES[worst],
            value=six[worst],
            bound=(six[a] * six[b]) ** 0.5,
            first=TENSOR_NAMES[a],
            second=TENSOR_NAMES[b],
            **data,
        )
    return rule.finding("products", at=place, cause=_guess_cause(six), edits=repair.edits, **data)


def _guess_cause(six: Sequence[float]) -> str | None:
    """Whether the six numbers make a possible body when they are read in another common order."""
    diagonal_first = [six[i] for i in (0, 3, 4, 1, 5, 2)]
    if _is_valid_inertia(diagonal_first):
        return "diagonal_first"
    # Rows of the full matrix xx xy xz | yx yy yz: the fourth number repeats the second.
    return "rows" if six[1] == six[3] != 0 else None


def _check_singular_links(
    rule: Rule, model: Model, message: str, links: Sequence[Link], rel_tol: float
) -> Iterator[Finding]:
    """One warning for each link whose whole body is singular, one info for all the others together."""
    alone: list[Link] = []
    harmless: list[Link] = []
    for link in links:
        fused = compute_body_tensor(model, model.tree.list_body_links(link.name))
        if fused is None:
            continue  # no mass, or a malformed inertial: other rules
        moments, _ = compute_principal_moments(fused)
        singular = model.tree.is_movable_link(link.name) and moments[0] <= rel_tol * moments[2]
        (alone if singular else harmless).append(link)
    for link in alone:
        point = NAN if message == "point" and _is_on_joint_axis(model, link) else "loads it as a point mass"
        told = dict.fromkeys(("pinocchio", "drake"), point) if message == "point" else None
        yield rule.finding(
            message,
            at=_locate_tensor(link),
            severity=Severity.WARNING,
            consequences=told,
            links=_format_links_with_mass([link]),
        )
    if harmless:
        yield rule.finding(
            f"{message}_fixed",
            at=_locate_tensor(harmless[0]),
            related=[_locate_tensor(link) for link in harmless[1:]],
            severity=Severity.INFO,
            links=_format_links_with_mass(harmless),
        )


def _is_on_joint_axis(model: Model, link: Link) -> bool:
    """Whether the joint that moves a point turns it about itself, and nothing that hangs on it."""
    joint, inertial = model.tree.parent_joint[model.tree.list_body_links(link.name)[0]], link.inertial
    alone = len(model.tree.list_body_links(link.name)) == 1 and not model.tree.child_joints[link.name]
    centre = None if inertial is None else inertial.origin.xyz
    if not alone or joint.type == "prismatic" or joint.axis is None or centre is None:
        return False
    (x, y, z), (a, b, c) = centre, joint.axis
    return not any((y * c - z * b, z * a - x * c, x * b - y * a))


def _format_links_with_mass(links: Sequence[Link]) -> str:
    return ", ".join(f"{link.name} ({link.inertial.mass:g} kg)" for link in links if link.inertial)


def _locate_tensor(link: Link) -> Located:
    assert link.inertial is not None
    assert link.inertial.tensor_element is not None
    return link.inertial.tensor_element


def _locate(inertial: Inertial, name: str) -> Located:
    element = inertial.tensor_element
    assert element is not None
    return element.attributes[name]
