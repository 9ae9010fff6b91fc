"""INR004: inertia tensors are positive definite."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from urdfcheck.core import Edit, Finding, Located, Rule, Severity
from urdfcheck.core.text import listed
from urdfcheck.facts.inertials.inertia_tensor import Rounding, digits_needed, principal_moments, tensor, triangle_excess
from urdfcheck.model import Inertial, Link, Model
from urdfcheck.model.parts import TENSOR
from urdfcheck.model.repairs.inertial_edits import Proposal, proposal
from urdfcheck.model.rigid_bodies import body_tensor, is_point, whole_of

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
        if inertial is None or inertial.six is None:
            continue
        smallest, largest = _extremes(inertial.six)
        negative = [i for i in DIAGONAL if inertial.six[i] < 0]
        if is_point(inertial):
            points.append(link)
        elif negative or smallest < -rel_tol * largest:
            whole = whole_of(model, link)
            possible = whole is not None and whole.possible(rel_tol)
            fused = FUSED.format(whole.heaviest) if whole is not None and possible else ""
            typed = _typed(inertial, rel_tol)
            if smallest > -rounding * largest and typed.explained:
                yield _rounded(rule, link, typed, -smallest / largest, fused)
            elif whole is not None and possible and whole.negligible:
                helpers.append(link)
            elif negative:
                yield _negative(rule, link, negative, fused, proposal(model, link))
            else:
                yield _products(rule, link, smallest, fused, proposal(model, link))
        elif smallest <= rel_tol * largest and triangle_excess(tensor(inertial.six)) >= -rel_tol:
            lines.append(link)
    # Only these need the tree: a rod or a point is no defect where what is fixed to it makes the body whole.
    yield from _singular(rule, model, "point", points, rel_tol)
    yield from _singular(rule, model, "line", lines, rel_tol)
    if helpers:
        yield rule.finding(
            "helper",
            at=_tensor_place(helpers[0]),
            related=[_tensor_place(link) for link in helpers[1:]],
            severity=Severity.INFO,
            links=listed(link.name for link in helpers),
        )


def _extremes(six: Sequence[float]) -> tuple[float, float]:
    moments, _ = principal_moments(tensor(six))
    return float(moments[0]), float(abs(moments).max())


def _valid(six: Sequence[float]) -> bool:
    smallest, largest = _extremes(six)
    return smallest > 1e-9 * largest and triangle_excess(tensor(six)) >= -1e-9


def _typed(inertial: Inertial, rel_tol: float) -> Rounding:
    element = inertial.tensor_element
    assert element is not None
    return digits_needed([element.get(name) for name in TENSOR], rel_tol)


def _rounded(rule: Rule, link: Link, typed: Rounding, excess: float, fused: str) -> Finding:
    return rule.finding(
        "rounded",
        at=_tensor_place(link),
        severity=Severity.WARNING,
        consequences={"gazebo": MERGED if fused else REFUSED},
        link=link.name,
        excess=excess,
        typed=typed.typed_digits,
        digits=typed.digits,
    )


def _negative(rule: Rule, link: Link, negative: Sequence[int], fused: str, repair: Proposal) -> Finding:
    """A negative diagonal entry; when dropping the signs makes it possible, and nothing better is known, the fix does that."""
    inertial = link.inertial
    assert inertial is not None
    six = inertial.six
    assert six is not None
    mended = [abs(v) if i in DIAGONAL else v for i, v in enumerate(six)]
    sign = _valid(mended) and not repair.found
    return rule.finding(
        "negative_sign" if sign else "negative",
        at=_place(inertial, TENSOR[negative[0]]),
        cause="sign" if _valid(mended) else _cause(six),
        edits=_without_minus(inertial, negative) if sign else repair.edits,
        consequences={"gazebo": MERGED if fused else REFUSED},
        link=link.name,
        fused=fused,
        found=repair.found,
        remedy=repair.remedy,
        names=", ".join(f"{TENSOR[i]} = {six[i]:g}" for i in negative),
        values=" ".join(f'{TENSOR[i]}="{abs(six[i]):g}"' for i in negative),
    )


def _without_minus(inertial: Inertial, entries: Sequence[int]) -> list[Edit]:
    element = inertial.tensor_element
    assert element is not None
    edits = []
    for i in entries:
        attribute = element.attributes[TENSOR[i]]
        if not attribute.literal or attribute.span is None:
            return []
        edits.append(Edit(attribute.span, attribute.typed, attribute.typed.replace("-", "", 1)))
    return edits


def _products(rule: Rule, link: Link, smallest: float, fused: str, repair: Proposal) -> Finding:
    inertial = link.inertial
    assert inertial is not None
    six, place = inertial.six, inertial.tensor_element
    assert six is not None
    assert place is not None
    data: dict[str, Any] = {
        "link": link.name,
        "fused": fused,
        "consequences": {"gazebo": MERGED if fused else REFUSED},
        "found": repair.found,
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
            at=_place(inertial, TENSOR[worst]),
            cause=_cause(six),
            edits=repair.edits,
            product=TENSOR[worst],
            value=six[worst],
            bound=(six[a] * six[b]) ** 0.5,
            first=TENSOR[a],
            second=TENSOR[b],
            **data,
        )
    return rule.finding("products", at=place, cause=_cause(six), edits=repair.edits, **data)


def _cause(six: Sequence[float]) -> str | None:
    """Whether the six numbers make a possible body when they are read in another common order."""
    diagonal_first = [six[i] for i in (0, 3, 4, 1, 5, 2)]
    if _valid(diagonal_first):
        return "diagonal_first"
    # Rows of the full matrix xx xy xz | yx yy yz: the fourth number repeats the second.
    return "rows" if six[1] == six[3] != 0 else None


def _singular(rule: Rule, model: Model, message: str, links: Sequence[Link], rel_tol: float) -> Iterator[Finding]:
    """One warning for each link whose whole body is singular, one info for all the others together."""
    alone: list[Link] = []
    harmless: list[Link] = []
    for link in links:
        fused = body_tensor(model, model.tree.body(link.name))
        if fused is None:
            continue  # no mass, or a malformed inertial: other rules
        moments, _ = principal_moments(fused)
        singular = model.tree.moves(link.name) and moments[0] <= rel_tol * moments[2]
        (alone if singular else harmless).append(link)
    for link in alone:
        point = NAN if message == "point" and _on_its_axis(model, link) else "loads it as a point mass"
        told = dict.fromkeys(("pinocchio", "drake"), point) if message == "point" else None
        yield rule.finding(
            message, at=_tensor_place(link), severity=Severity.WARNING, consequences=told, links=_names([link])
        )
    if harmless:
        yield rule.finding(
            f"{message}_fixed",
            at=_tensor_place(harmless[0]),
            related=[_tensor_place(link) for link in harmless[1:]],
            severity=Severity.INFO,
            links=_names(harmless),
        )


def _on_its_axis(model: Model, link: Link) -> bool:
    """Whether the joint that moves a point turns it about itself, and nothing that hangs on it."""
    joint, inertial = model.tree.parent_joint[model.tree.body(link.name)[0]], link.inertial
    alone = len(model.tree.body(link.name)) == 1 and not model.tree.child_joints[link.name]
    centre = None if inertial is None else inertial.origin.xyz
    if not alone or joint.type == "prismatic" or joint.axis is None or centre is None:
        return False
    (x, y, z), (a, b, c) = centre, joint.axis
    return not any((y * c - z * b, z * a - x * c, x * b - y * a))


def _names(links: Sequence[Link]) -> str:
    return ", ".join(f"{link.name} ({link.inertial.mass:g} kg)" for link in links if link.inertial)


def _tensor_place(link: Link) -> Located:
    assert link.inertial is not None
    assert link.inertial.tensor_element is not None
    return link.inertial.tensor_element


def _place(inertial: Inertial, name: str) -> Located:
    element = inertial.tensor_element
    assert element is not None
    return element.attributes[name]
