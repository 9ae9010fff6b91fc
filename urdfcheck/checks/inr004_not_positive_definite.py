"""INR004 reports inertia tensors that are not positive definite."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.engine_floors import GAZEBO_MERGES, MUJOCO_REFUSAL, is_refused_by_mujoco
from urdfcheck.facts.inertials.placeholders import describe_unknown_mass
from urdfcheck.facts.small_matrices import compute_excess, compute_moments, make_tensor
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.fixed_joint_lumping import predict_gazebo
from urdfcheck.model.parts import TENSOR_NAMES, has_drawn_shape
from urdfcheck.model.repairs.edits import edit_all_numbers
from urdfcheck.model.rigid_bodies import POINT_RADIUS, find_merged_body, is_point_mass, list_whole_bodies, weigh_body
from urdfcheck.model.use.display import is_loaded_for_frames
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.inertia_tensor import TensorRounding
    from urdfcheck.model.inertials.proposals.tensor_repairs import InertialProposal

DIAGONAL = (0, 3, 5)
PRODUCTS = {1: (0, 3), 2: (0, 5), 4: (3, 5)}
NAN = "computes NaN accelerations: the point is on the joint's axis (Drake stops with an error)"
# Bars of so many masses do not have one tensor.
_FEWEST_MASSES = 3
# A tensor of a point has a third moment below this share of the others: digits leave no more.
_OF_POINT = 1e-3
# Causes that are about the places of the six numbers.
_OF_ORDER, _IN_ORDER = frozenset({"diagonal_first", "rows", "slot_repeated"}), ", in the order ixx ixy ixz iyy iyz izz"
# What to write where nothing is drawn.
_FORMULAS = {
    "line": "write the third moment too: ½·m·r² for a bar of mass m and radius r",
    "point": "write the inertia tensor: 0.4·m·r² on the diagonal for a ball of mass m and radius r",
}
# Moments are those of the drawn part within this share (chosen): undrawn parts change them by less.
_LIKE_DRAWN = 0.25
_MEANT_POINT = ", unless a point mass is meant, which only MuJoCo refuses"
_BY_SHAPE = "compute the tensor from the shape of the part and its mass"
FUSED = "; merged with {} and everything else fixed to it, the body is possible"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _IndefiniteTensor:
    """A tensor with a negative diagonal entry or principal moment, and what the message about it needs."""

    declared: DeclaredTensor
    smallest: float
    """The smallest principal moment in kg m²."""
    largest: float
    """The largest absolute principal moment in kg m²."""
    rounding: TensorRounding
    fused: str
    """The end of the message if the links that are fixed together have a possible tensor, else empty."""
    gazebo: str
    """What Gazebo does with the link."""


def _is_point_about_origin(declared: DeclaredTensor) -> bool:
    from urdfcheck.model.inertials.proposals.zero_moments import is_point_about_origin  # only broken tensors ask for it

    return is_point_about_origin(declared)


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    points: list[DeclaredTensor] = []
    lines: list[DeclaredTensor] = []
    helpers: list[DeclaredTensor] = []
    terms: list[tuple[DeclaredTensor, bool, bool]] = []
    for declared in model.tensors:
        components = declared.components
        moments = declared.moments
        smallest, largest = moments[0], max(map(abs, moments))
        if is_point_mass(declared.inertial):
            points.append(declared)
        elif smallest <= _OF_POINT * largest and _is_point_about_origin(declared):
            is_rounded = smallest > -rounding * largest and _measure_rounding(declared, rel_tol).explained_by_rounding
            terms.append((declared, smallest >= -rel_tol * largest, is_rounded))
        elif any(components[i] < 0 for i in DIAGONAL) or smallest < -rel_tol * largest:
            whole = find_merged_body(model, declared.link)
            possible = whole is not None and whole.is_physically_valid(rel_tol)
            wrong = _IndefiniteTensor(
                declared=declared,
                smallest=smallest,
                largest=largest,
                rounding=_measure_rounding(declared, rel_tol),
                fused=FUSED.format(whole.heaviest) if whole is not None and possible else "",
                gazebo=predict_gazebo(model, declared.link, whole, rel_tol),
            )
            if smallest > -rounding * largest and wrong.rounding.explained_by_rounding:
                yield _build_rounded_finding(rule, wrong)
            elif whole is not None and possible and whole.link_is_negligible and wrong.gazebo == GAZEBO_MERGES:
                helpers.append(declared)
            else:
                yield _build_indefinite_finding(model, rule, wrong)
        elif smallest <= rel_tol * largest and compute_excess(moments) >= -rel_tol:
            lines.append(declared)
    if terms:
        yield _build_term_finding(rule, terms)
    # The tree is built only for these: a rod or a point is harmless if the links fixed to it complete the body.
    yield from _check_singular_links(model, rule, "point", links=points, rel_tol=rel_tol)
    yield from _check_singular_links(model, rule, "line", links=lines, rel_tol=rel_tol)
    if helpers:
        finding = rule.finding(
            "helper",
            at=helpers[0].element,
            related=[declared.element for declared in helpers[1:]],
            severity=Severity.WARNING,
            links=join_names(declared.link.name for declared in helpers),
        )
        # One more link is a new finding, also for a baseline that has the others.
        yield replace(finding, subjects=tuple(declared.element.location.subject for declared in helpers))


def _measure_rounding(declared: DeclaredTensor, rel_tol: float) -> TensorRounding:
    from urdfcheck.facts.inertials.inertia_tensor import measure_tensor_rounding  # only broken tensors need numpy

    return measure_tensor_rounding(declared.texts, rel_tol)


def _is_possible(components: Sequence[float]) -> bool:
    """Whether the components are those of a possible body."""
    moments = compute_moments(make_tensor(components))
    return moments[0] > 1e-9 * max(map(abs, moments)) and compute_excess(moments) >= -1e-9


def _build_rounded_finding(rule: Rule, wrong: _IndefiniteTensor) -> Finding:
    return rule.finding(
        "rounded",
        at=wrong.declared.element,
        severity=Severity.WARNING,
        consequences={"gazebo": wrong.gazebo},
        link=wrong.declared.link.name,
        excess=-wrong.smallest / wrong.largest,
        typed=wrong.rounding.typed_digits,
        digits=wrong.rounding.digits,
    )


def _build_term_finding(rule: Rule, terms: Sequence[tuple[DeclaredTensor, bool, bool]]) -> Finding:
    """Report tensors of points at the COMs, about the links' origins: one mistake, whichever side of zero digits leave the third
    moment on. ``terms``: each with whether it is possible, and whether rounding explains that it is not."""
    from urdfcheck.model.inertials.proposals.zero_moments import describe_slipped_point

    first, *others = (declared for declared, _, _ in terms)
    is_possible = all(possible for _, possible, _ in terms)
    slips = [(one.link.name, slip) for one in (first, *others) if (slip := describe_slipped_point(one))]
    finding = rule.finding(
        "term",
        at=first.element,
        related=[declared.element for declared in others],
        severity=Severity.WARNING if all(possible or rounded for _, possible, rounded in terms) else None,
        consequences=dict.fromkeys(("gazebo", "drake", "pinocchio"), "loads it") if is_possible else {},
        links=join_names(declared.link.name for declared, _, _ in terms),
        claim=f"that of a point of {first.inertial.mass:.4g} kg at the COM"
        if not others
        else f"that of a point at the COM ({first.link.name}: of {first.inertial.mass:.4g} kg)",
        slips="".join(f". {name}: the point has {slip} as the COM has" for name, slip in slips),
        # A tensor about another point is larger than any about the COM.
        explains=[f"{code} link[{one.link.name}]" for one in (first, *others) for code in ("INR005", "INR009")],
    )
    return replace(finding, subjects=tuple(one.element.location.subject for one in (first, *others)))


def _build_indefinite_finding(model: Model, rule: Rule, wrong: _IndefiniteTensor) -> Finding:
    negative = [i for i in DIAGONAL if wrong.declared.components[i] < 0]
    if negative:
        return _build_negative_finding(model, rule, wrong, entries=negative)
    return _build_product_finding(model, rule, wrong)


def _build_negative_finding(model: Model, rule: Rule, wrong: _IndefiniteTensor, *, entries: Sequence[int]) -> Finding:
    """Report negative diagonal ``entries``.

    The edit drops their signs if that makes the tensor possible and no better repair is known.
    """
    declared, components = wrong.declared, wrong.declared.components
    repair = _propose_repair(model, declared)
    only_sign = _is_possible_without_signs(declared) and not _has_unexplained_sibling(model, declared)
    message = "negative_sign" if only_sign and not repair.message else "negative"
    return rule.finding(
        message,
        at=declared.get_attribute(entries[0]),
        cause="sign" if only_sign else repair.cause or _guess_cause(components),
        edits=_drop_signs(declared, entries) if message == "negative_sign" else repair.edits,
        consequences={"gazebo": wrong.gazebo},
        link=declared.link.name,
        fused=wrong.fused,
        found=repair.message,
        remedy=repair.remedy,
        comparison=repair.comparison,
        detail=repair.detail,
        names=", ".join(f"{TENSOR_NAMES[i]} = {components[i]:g}" for i in entries),
        values=" ".join(f'{TENSOR_NAMES[i]}="{abs(components[i]):g}"' for i in entries),
    )


def _is_possible_without_signs(declared: DeclaredTensor) -> bool:
    return _is_possible([abs(v) if i in DIAGONAL else v for i, v in enumerate(declared.components)])


def _has_unexplained_sibling(model: Model, declared: DeclaredTensor) -> bool:
    """Whether another link has negative moments that are impossible without their signs too: both then have one mistake, as a
    parallel-axis term that was subtracted, unless the numbers without signs are those of the drawn part."""
    if not any(
        any(other.components[i] < 0 for i in DIAGONAL) and not _is_possible_without_signs(other)
        for other in model.tensors
    ):
        return False
    from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor

    drawn = compute_drawn_tensor(model, declared)
    if drawn is None:
        return True
    expected = [drawn[i][i] for i in range(3)]
    return any(
        abs(abs(declared.components[i]) - value) > _LIKE_DRAWN * abs(value)
        for i, value in zip(DIAGONAL, expected, strict=True)
    )


def _propose_repair(model: Model, declared: DeclaredTensor) -> InertialProposal:
    # Most models have no such tensor, and do without what a repair needs.
    from urdfcheck.model.inertials.proposals.possible_tensors import propose_repair

    return propose_repair(model, declared.link)


def _drop_signs(declared: DeclaredTensor, entries: Sequence[int]) -> list[Edit]:
    attributes = [declared.get_attribute(i) for i in entries]
    return edit_all_numbers((attribute, attribute.value.replace("-", "", 1)) for attribute in attributes)


def _build_product_finding(model: Model, rule: Rule, wrong: _IndefiniteTensor) -> Finding:
    declared, components = wrong.declared, wrong.declared.components
    repair = _propose_repair(model, declared)
    # |Ixy| > sqrt(Ixx Iyy) alone makes the tensor indefinite; otherwise all three products together do.
    bounds = {i: (components[a] * components[b]) ** 0.5 for i, (a, b) in PRODUCTS.items()}
    worst = max(bounds, key=lambda i: abs(components[i]) - bounds[i])
    alone = abs(components[worst]) > bounds[worst]
    a, b = PRODUCTS[worst]
    pair = abs(components[worst]), bounds[worst]
    rounded = ([f"{value:.{digits}g}" for value in pair] for digits in range(4, 18))
    shown = next((texts for texts in rounded if texts[0] != texts[1]), ["", ""])  # equal ones are not reported alone
    single = {
        "shown": f"-{shown[0]}" if components[worst] < 0.0 else shown[0],
        "limit": shown[1],
        "product": TENSOR_NAMES[worst],
        "value": components[worst],
        "bound": bounds[worst],
        "first": TENSOR_NAMES[a],
        "second": TENSOR_NAMES[b],
    }
    cause = repair.cause or _guess_cause(components)
    # With a moment of zero no product of its axis is possible, however small: the moment is what is wrong.
    zeros = [i for i in DIAGONAL if components[i] == 0.0]
    zero = zeros[0] if alone and len(zeros) == 1 and zeros[0] in PRODUCTS[worst] else None
    if zero is not None:
        single["moment"] = TENSOR_NAMES[zero]
    return rule.finding(
        "zero" if zero is not None else "product" if alone else "products",
        at=declared.get_attribute(zero if zero is not None else worst) if alone else declared.element,
        cause=cause,
        order=_IN_ORDER if cause in _OF_ORDER else "",
        edits=repair.edits,
        consequences={"gazebo": wrong.gazebo},
        **(single if alone else {}),
        link=declared.link.name,
        fused=wrong.fused,
        found=repair.message,
        remedy=repair.remedy,
        comparison=repair.comparison,
        detail=repair.detail,
        smallest=wrong.smallest,
    )


def _guess_cause(components: Sequence[float]) -> str | None:
    """Return the cause if the six numbers, read in another common order, make a possible body."""
    diagonal_first = [components[i] for i in (0, 3, 4, 1, 5, 2)]
    if _is_possible(diagonal_first):
        return "diagonal_first"
    # In the rows of the full matrix, xx xy xz | yx yy yz, the fourth number repeats the second.
    xx, xy, xz, yx, yy, yz = components
    is_possible_row = xx * yy > xy * xy and xx > 0.0 and (xy, xz, yz) != (xx, xx, xx)
    return "rows" if xy == yx != 0 and is_possible_row else None


def _check_singular_links(
    model: Model, rule: Rule, message: str, *, links: Sequence[DeclaredTensor], rel_tol: float
) -> Iterator[Finding]:
    """Warn about each link whose whole body is singular, and report all others together: a warning for lines, which MuJoCo
    refuses in each link before it adds up those that fixed joints connect."""
    placeholders = _describe_placeholders(model, links) if message == "line" else {}
    bodies = {name: body for body in list_whole_bodies(model) for name in body.links} if links else {}
    alone: list[tuple[DeclaredTensor, str]] = []
    harmless: list[DeclaredTensor] = []
    for declared in links:
        name = declared.link.name
        body = bodies.get(name)
        fused = None if body is None else weigh_body(model, body.links)
        if body is None or fused is None:
            continue  # not known to the last link, no mass, or a malformed inertial: other rules
        moments = fused.moments
        singular = body.is_movable and moments[0] <= rel_tol * moments[2]
        if singular:
            is_point = moments[2] <= fused.mass * POINT_RADIUS**2
            alone.append((declared, "" if is_point else _join_other_masses(model, name, body.links)))
        else:
            harmless.append(declared)
    for declared, others in alone:
        point = NAN if message == "point" and _is_on_joint_axis(model, declared) else "loads it as a point mass"
        of_point = dict.fromkeys(("pinocchio", "drake"), point) if message == "point" else {}
        remedy = _collect_remedy(model, message, [declared], placeholders.get(declared.components))
        if message == "point" and point != NAN:
            remedy["remedy"] += _MEANT_POINT  # the textbook's pendulum is one
        is_of_points = message == "point" and bool(others)
        if is_of_points:
            remedy["others"] = others
        yield rule.finding(
            "points" if is_of_points else message,
            at=declared.element,
            severity=Severity.INFO if is_loaded_for_frames(model) else Severity.WARNING,
            cause="placeholder" if declared.components in placeholders else None,
            consequences={**({} if is_of_points else of_point), **_predict_mujoco(message, [declared])},
            links=_format_masses([declared]),
            names=declared.link.name,
            **remedy,
        )
    refused = [declared for declared in harmless if message == "line" and is_refused_by_mujoco(declared.components)]
    severe = Severity.INFO if refused and is_loaded_for_frames(model) else Severity.WARNING
    for group, severity in ((refused, severe), ([d for d in harmless if d not in refused], Severity.INFO)):
        if group:
            described = {placeholders.get(declared.components) for declared in group}
            shared = described.pop() if len(described) == 1 else None
            yield rule.finding(
                f"{message}_fixed",
                at=group[0].element,
                cause=None if shared is None else "placeholder",
                related=[declared.element for declared in group[1:]],
                severity=severity,
                consequences=_predict_mujoco(message, group),
                links=_format_masses(group),
                names=join_names(declared.link.name for declared in group),
                refusal="; MuJoCo refuses it" if group is refused else "",
                **_collect_remedy(model, message, group, shared),
            )


def _join_other_masses(model: Model, name: str, body: Sequence[str]) -> str:
    """Name the links of a ``body`` that have mass, without the one of this ``name``."""
    heavy = {declared.link.name for declared in model.masses if declared.mass > 0}
    return join_names(other for other in body if other != name and other in heavy)


def _describe_placeholders(model: Model, lines: Sequence[DeclaredTensor]) -> dict[tuple[float, ...], str]:
    """Describe the tensors of a line that links of three masses or more share, of one digit each: they are not rods. Those of a
    drawn part, rounded by the program that wrote them, are not placeholders."""
    shared: dict[tuple[float, ...], list[float]] = {}
    for declared in lines:
        if declared.inertial.mass is not None:
            shared.setdefault(declared.components, []).append(declared.inertial.mass)
    described = {}
    for components, masses in shared.items():
        is_typed_short = all(float(f"{value:.0e}") == value for value in components)
        alike = [declared for declared in lines if declared.components == components]
        if len(set(masses)) >= _FEWEST_MASSES and is_typed_short and not any(_is_rounded(model, one) for one in alike):
            moments = ", ".join(f"{components[i]:g}" for i in DIAGONAL)
            described[components] = (
                f". {len(masses)} links of {min(masses):.3g} to {max(masses):.3g} kg have these numbers ({moments})"
            )
    return described


def _is_rounded(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a tensor is that of what the link draws, rounded to the digits typed."""
    from urdfcheck.facts.inertials.mistakes.wrong_formulas import is_rounding_of
    from urdfcheck.model.inertials.proposals.drawn_inertials import compute_drawn_tensor

    drawn = compute_drawn_tensor(model, declared)
    return drawn is not None and is_rounding_of(declared.tensor, drawn)


def _collect_remedy(
    model: Model, message: str, links: Sequence[DeclaredTensor], placeholder: str | None
) -> dict[str, Any]:
    """Collect what to write: the drawn part's numbers where they are known, for it need not be a bar or a ball. The formulas
    of these are for links that draw nothing."""
    from urdfcheck.model.inertials.proposals.drawn_inertials import (
        describe_drawn_inertial,
        draws_part,
        format_comparison,
    )

    remedy = _FORMULAS[message]
    unknown = {describe_unknown_mass(declared.inertial.mass or 0.0) for declared in links}
    zeros = _list_zero_factors(links[0]) if len(links) == 1 and message == "point" else []
    if zeros:
        typed = " and ".join(f"{name} = 0" for name in zeros)
        remedy = f"correct {typed}: the tensor is computed from {'it' if len(zeros) == 1 else 'them'}"
    elif len(unknown) == 1 and unknown != {""}:
        remedy = f"{unknown.pop()}, and the tensor"
    elif placeholder is not None:
        remedy = "compute the tensor of each link from its mesh or dimensions and its mass"
    elif len(links) == 1 and message == "point" and (by_twin := _ask_twin(model, links[0])):
        remedy = by_twin
    elif (drawn := describe_drawn_inertial(model, links[0].link)) and not draws_part(model, links[0].link):
        remedy = _BY_SHAPE + (format_comparison(drawn) if len(links) == 1 else "")
    elif drawn:
        remedy = (
            f"write {drawn}"
            if len(links) == 1
            else f"{links[0].link.name}: write {drawn}; each of the others has its own repair"
        )
    elif any(has_drawn_shape(declared.link) for declared in links):  # a part of some shape: no bar, no ball
        remedy = _BY_SHAPE
    return {"found": placeholder or "", "remedy": remedy}


def _ask_twin(model: Model, declared: DeclaredTensor) -> str:
    """Describe what to write for a zero tensor if the link on the other side has one, and what is drawn; empty otherwise."""
    from urdfcheck.model.inertials.proposals.drawn_inertials import (
        compute_drawn_tensor,
        describe_drawn_inertial,
        draws_part,
    )
    from urdfcheck.model.inertials.proposals.like_links import describe_zero_by_twin

    drawn = describe_drawn_inertial(model, declared.link) if draws_part(model, declared.link) else ""
    uniform = compute_drawn_tensor(model, declared) if drawn else None
    return describe_zero_by_twin(model, declared, uniform, drawn=drawn)


def _list_zero_factors(declared: DeclaredTensor) -> list[str]:
    """List the names with the value 0 from which all three moments are computed."""
    moments = [declared.get_attribute(i) for i in DIAGONAL]
    zeros = [{one.name for one in at.collect_definitions() if parse_number(one.value) == 0.0} for at in moments]
    return sorted(set().union(*zeros)) if all(zeros) else []


def _predict_mujoco(message: str, links: Sequence[DeclaredTensor]) -> dict[str, str]:
    """Return what differs from the page: MuJoCo refuses the residue of a zero, and loads a line that is a little thick."""
    if any(is_refused_by_mujoco(declared.components) for declared in links):
        return {"mujoco": MUJOCO_REFUSAL}
    return {"mujoco": "loads it"} if message == "line" else {}


def _is_on_joint_axis(model: Model, declared: DeclaredTensor) -> bool:
    """Whether a joint rotates the point about itself, with nothing behind it."""
    name = declared.link.name
    body = model.pieces.list_body_links(name)
    joint, centre = model.pieces.parent_joint.get(body[0]), declared.inertial.origin.xyz
    alone = len(body) == 1 and not model.pieces.child_joints[name]
    if not alone or joint is None or joint.type == "prismatic" or joint.axis is None or centre is None:
        return False
    (x, y, z), (a, b, c) = centre, joint.axis
    return not any((y * c - z * b, z * a - x * c, x * b - y * a))


def _format_masses(links: Sequence[DeclaredTensor]) -> str:
    return ", ".join(f"{declared.link.name} ({declared.inertial.mass:g} kg)" for declared in links)
