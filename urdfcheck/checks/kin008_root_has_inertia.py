"""KIN008 reports root links with an inertia, which some programs ignore and others need."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if not model.joints:
        return  # a single body
    root = model.mass_by_name.get(model.tree.root)
    if root is None or not root.mass:
        return
    masses = [declared.mass for declared in model.masses if declared.mass >= 0]
    if len(masses) < sum(link.inertial is not None for link in model.links):
        return  # a sum that includes a wrong mass is meaningless
    total = sum(masses)
    body = set(model.tree.list_body_links(model.tree.root))
    fixed = [declared for declared in model.masses if declared.link.name in body and declared.mass > 0]
    carried = [declared.link.name for declared in fixed if declared.link is not root.link]
    yield rule.finding(
        "ignored",
        at=root.inertial.element,
        link=root.link.name,
        mass=root.mass,
        total=total,
        rest=total - root.mass,
        moving=total - sum(declared.mass for declared in fixed),
        carried=f": {join_names(carried)}, fixed to it, {'is' if len(carried) == 1 else 'are'} lost too"
        if carried
        else "",
    )
