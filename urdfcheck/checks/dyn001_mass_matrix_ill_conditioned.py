"""DYN001 reports a link with so little inertia, compared with what it carries, that two joints move the same."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import list_carried_links, summarize_mass_matrix


def check(model: Model, rule: Rule, *, limit: float) -> Iterator[Finding]:
    summary = summarize_mass_matrix(model)
    if summary is None or summary.light_joint is None or not summary.condition_number > limit:
        return
    joint = summary.light_joint
    link = model.link_by_name[joint.child]
    yield rule.finding(
        "light",
        at=link if link.inertial is None else link.inertial,
        related=[joint],
        link=link.name,
        joint=joint.name,
        number=summary.condition_number,
        limit=limit,
        own=summary.own_inertia,
        moved=summary.moved_inertia,
        unit="kg" if joint.type == "prismatic" else "kg·m²",
        about="more" if joint.type == "prismatic" else "about every axis",
        enough=0.01 * summary.moved_inertia,
        between=[f"link[{name}]" for name in list_carried_links(model, joint)],
    )
