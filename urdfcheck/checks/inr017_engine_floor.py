"""INR017 reports inertia tensors that are possible but too small for MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.facts.inertials.engine_floors import MUJOCO_LEAST_MOMENT, is_refused_by_mujoco
from urdfcheck.facts.small_matrices import compute_excess
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.rigid_bodies import is_point_mass

# Below this part of the largest moment the smallest is that of a line or of no body: INR004.
_REL_TOL = 1e-9


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    small = [d for d in model.tensors if is_refused_by_mujoco(d.components) and _is_possible_body(d)]
    if not small:
        return
    small.sort(key=_compute_smallest_moment)
    first, others = small[0], [declared.link.name for declared in small[1:]]
    yield build_group_finding(
        rule,
        "small",
        [declared.element for declared in small],
        link=first.link.name,
        smallest=_compute_smallest_moment(first),
        least=MUJOCO_LEAST_MOMENT,
        others=f"; also on {format_count(len(others), 'other link')} ({join_names(others)})" if others else "",
    )


def _is_possible_body(declared: DeclaredTensor) -> bool:
    """Whether a solid body can have the tensor; INR003 and INR004 cover the others."""
    moments = declared.moments
    return (
        not is_point_mass(declared.inertial)
        and moments[0] > _REL_TOL * moments[2]
        and compute_excess(moments) >= -_REL_TOL
    )


def _compute_smallest_moment(declared: DeclaredTensor) -> float:
    return declared.moments[0]
