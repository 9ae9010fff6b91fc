"""INR003 reports inertia tensors whose principal moments break the triangle inequality."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import merge_identical
from urdfcheck.core.text import join_names, join_numbers
from urdfcheck.facts.inertials.engine_floors import GAZEBO_MERGES
from urdfcheck.facts.small_matrices import compute_excess
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.fixed_joint_lumping import predict_gazebo
from urdfcheck.model.rigid_bodies import find_merged_body, is_point_mass, is_world_link
from urdfcheck.model.use.other_programs import is_merged_wherever_loaded
from urdfcheck.source.text.engine_reactions import has_mujoco_option
from urdfcheck.source.text.handed_values import find_typed_value

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.inertia_tensor import TensorRounding

# Where ixx, iyy and izz are in ``ixx ixy ixz iyy iyz izz``.
_DIAGONAL = (0, 3, 5)
# The smallest moment of a rod is 6 (r/l)^2 of its largest. A rod of a metre with this share is a wire, 0.26 mm thick: what has
# less was never measured on a part.
_WIRE = 1e-7
# What to look for in numbers that were typed, and in those that the file computes.
_COPIED = "; in copied numbers look for a lost decimal point or a wrong unit"
_COMPUTED = ", or correct the formula that computes it"

# What MuJoCo does where the file has this option (checked with MuJoCo 4.0).
_BALANCED = "replaces the three moments by their mean: balanceinertia is set"


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    # Copies of one finger are one finding.
    findings = _check_each_link(model, rule, rel_tol=rel_tol, rounding=rounding)
    merged = merge_identical(rule, findings, "link", varying=("other", "whole"))
    if not has_mujoco_option(model.robot, "balanceinertia", "true"):
        yield from merged
        return
    for finding in merged:
        if finding.message_id != "helper":  # only MuJoCo minds
            yield replace(finding, consequences={**finding.consequences, "mujoco": _BALANCED})


def _check_each_link(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    helpers: list[DeclaredTensor] = []
    for declared in model.tensors:
        if is_point_mass(declared.inertial):
            continue
        excess = -compute_excess(declared.moments)
        if not excess > rel_tol:  # INR004 covers a tensor whose largest moment is not positive
            continue
        # Most models have no such tensor, and do without what a repair needs.
        from urdfcheck.facts.inertials.inertia_tensor import measure_tensor_rounding
        from urdfcheck.model.inertials.habits.rotor_inertias import find_rotor_inertias
        from urdfcheck.model.inertials.proposals.possible_tensors import propose_repair
        from urdfcheck.model.inertials.proposals.repeated_formulas import describe_repeated_formula
        from urdfcheck.model.inertials.proposals.undone_mistakes import has_mistake

        whole = find_merged_body(model, declared.link)
        is_fused = whole is not None and whole.is_physically_valid(rel_tol)
        typed = measure_tensor_rounding(declared.texts, rel_tol)
        gazebo = predict_gazebo(model, declared.link, whole, rel_tol)
        data = _collect_data(declared, excess, typed)
        ignored = _predict_world(model, declared)
        if excess < rounding and typed.explained_by_rounding:
            if has_mistake(model, declared.link, "own_missing"):
                continue  # more digits would not make the tensor right: INR009 reports it
            yield _build_rounded_finding(model, rule, declared, gazebo=gazebo, data=data)
            continue
        if whole is not None and is_fused:
            if whole.link_is_negligible and gazebo == GAZEBO_MERGES:
                is_copied = describe_repeated_formula(declared)  # INR020 has the repair, for all that the macro makes
                if declared.moments[0] >= -rel_tol * declared.moments[2] and not is_copied:  # else INR004
                    helpers.append(declared)
                continue
            data |= {"other": whole.heaviest, "whole": join_numbers(whole.moments, digits=4)}
            message = "fused"
        else:
            message = "violated"
        if declared.link.name in (rotors := find_rotor_inertias(model)):
            yield rule.finding("rotor", at=declared.element, cause="rotor", link=declared.link.name, count=len(rotors))
            continue
        if formula := describe_repeated_formula(declared):
            yield rule.finding(
                message,
                at=declared.element,
                consequences={"gazebo": gazebo},
                found="",
                remedy=f"{formula}, or ",
                claim="inertia breaks the triangle inequality",
                reason=f"by {data['percent']:.3g} %",
                **data | {"slips": "", "comparison": ""},
            )
            continue
        repair = propose_repair(model, declared.link)
        is_filled = repair.cause == "products_filled"
        # Rounding of next to nothing, which Gazebo does not mind, is not worth more than a light helper.
        is_merged = message == "fused" and gazebo == GAZEBO_MERGES
        is_lost = is_merged and whole is not None and whole.tensor_is_negligible and repair.cause == "digits"
        data |= {"slips": ""} if repair.is_located or repair.cause else {}
        yield rule.finding(
            message,
            at=declared.element,
            severity=Severity.WARNING
            if ignored or is_lost or (is_merged and not model.targets and is_merged_wherever_loaded(model))
            else None,
            consequences={"gazebo": gazebo} | ignored,
            cause=repair.cause,
            edits=repair.edits,
            found=repair.message,
            remedy=repair.remedy,
            comparison=repair.comparison,
            detail=repair.detail,
            claim="impossible inertia" if is_filled else "inertia breaks the triangle inequality",
            reason=repair.detail if is_filled else f"by {data['percent']:.3g} %",
            **data,
        )
    if helpers:
        from urdfcheck.facts.inertials.mistakes.tensor_slips import find_filled_products

        slips = {find_filled_products(declared.components, declared.texts) for declared in helpers}
        slip = slips.pop() if len(slips) == 1 else None
        yield rule.finding(
            "helper",
            at=helpers[0].element,
            related=[declared.element for declared in helpers[1:]],
            severity=Severity.WARNING,
            cause=None if slip is None else slip.id,
            detail="" if slip is None else slip.detail,
            links=join_names(declared.link.name for declared in helpers),
        )


def _predict_world(model: Model, declared: DeclaredTensor) -> dict[str, str]:
    """Return what programs do with a link that stands for the world; nothing for any other."""
    if not is_world_link(model, declared.link):
        return {}
    told = {"gazebo": "ignores the link: a root named world is the world"}
    if declared.link.element.get("drake_ignore").strip() == "true":
        told["drake"] = "ignores the link: it has drake_ignore"
    return told


def _build_rounded_finding(
    model: Model, rule: Rule, declared: DeclaredTensor, *, gazebo: str, data: dict[str, Any]
) -> Finding:
    """Report a tensor that rounding explains, with the repair of a mistake but not with the drawn part's numbers.

    More digits do not repair a tensor that no part of the drawn size has, or that only a line of points has: that is the error.
    """
    from urdfcheck.model.inertials.proposals.possible_tensors import propose_repair
    from urdfcheck.model.inertials.proposals.tensor_sizes import find_thicker_part

    repair = propose_repair(model, declared.link)
    consequences = {"gazebo": gazebo}
    if repair.oversize:
        return rule.finding(
            "oversized",
            at=declared.element,
            consequences=consequences,
            found=repair.message,
            remedy=repair.remedy,
            comparison=repair.comparison,
            times=repair.oversize,
            **data,
        )
    thicker = None if repair.message else find_thicker_part(model, declared)
    is_line = not repair.message and declared.moments[0] < _WIRE * declared.moments[2]
    if thicker is not None or is_line:
        return rule.finding(
            "thin",
            at=declared.element,
            severity=Severity.WARNING,
            consequences=consequences,
            smallest="a ten-millionth of the largest"
            if thicker is None
            else f"a tenth of the drawn part's ({join_numbers(thicker, digits=3)})",
            remedy="" if thicker is None else repair.remedy,
            comparison=repair.comparison,
            **data,
        )
    return rule.finding(
        "rounded",
        at=declared.element,
        edits=repair.edits if repair.message else (),
        severity=Severity.WARNING,
        consequences=consequences,
        found=repair.message,
        remedy=repair.remedy if repair.message else "",
        **data,
    )


def _collect_data(declared: DeclaredTensor, excess: float, typed: TensorRounding) -> dict[str, Any]:
    moments = declared.moments
    # The eigenvalue solver leaves a residue of a zero, which is not a number to print.
    shown = [0.0 if abs(m) < 1e-12 * moments[2] else m for m in moments]
    digits = 4 if excess > 1e-3 else 6  # enough to show the difference
    return {
        "link": declared.link.name,
        "moments": join_numbers(shown, digits=digits),
        "sum": float(f"{shown[0] + shown[1]:.{digits}g}"),
        "excess": excess,
        "percent": excess * 100,
        "typed": typed.typed_digits,
        "digits": typed.digits,
        "slips": _describe_slips(declared),
    }


def _describe_slips(declared: DeclaredTensor) -> str:
    from urdfcheck.model.inertials.proposals.zero_moments import list_zero_moment_sources

    if sources := list_zero_moment_sources(declared):
        return f", or give {join_names(sources)} another value than 0"
    return _COPIED if _is_copied(declared) else _COMPUTED


def _is_copied(declared: DeclaredTensor) -> bool:
    """Whether all moments were typed as numbers, and none is computed in the file."""
    return all(find_typed_value(declared.get_attribute(i)) is not None for i in _DIAGONAL)
