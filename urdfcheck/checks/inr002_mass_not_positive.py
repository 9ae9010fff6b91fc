"""INR002: masses are greater than zero."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.model import Link, Model
from urdfcheck.model.body import body_mass

# MuJoCo's mjMINVAL: what a consumer takes for zero.
ZERO = 1e-15
SEVERITIES = {"root": Severity.INFO, "loose": Severity.WARNING}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    massless: list[Link] = []
    for link in model.links:
        if link.inertial is None or link.inertial.mass is None or link.inertial.mass > 0:
            continue
        mass, largest = link.inertial.mass, max(map(abs, link.inertial.six or (0.0,)))
        if mass < 0:
            yield rule.finding("negative", at=_place(link), link=link.name, mass=mass)
        elif largest > ZERO:
            yield rule.finding("inertia_without_mass", at=_place(link), link=link.name, largest=largest)
        else:
            massless.append(link)
    # Only these need the tree: whether a link of no mass matters is decided by what it is fixed to.
    kinds = [(link, _kind(model, link)) for link in massless]
    for link, kind in kinds:
        if kind != "helper":
            yield rule.finding(kind, at=_place(link), severity=SEVERITIES.get(kind), link=link.name)
    helpers = [link for link, kind in kinds if kind == "helper"]
    if helpers and "bullet" not in model.targets:  # it assumes 1 kg for a link without <inertial>
        yield rule.finding(
            "helper",
            at=_place(helpers[0]),
            related=[_place(link) for link in helpers[1:]],
            severity=Severity.INFO,
            links=", ".join(link.name for link in helpers),
        )


def _place(link: Link) -> Located:
    assert link.inertial is not None
    attribute = link.inertial.mass_attribute
    return link.inertial.element if attribute is None else attribute


def _kind(model: Model, link: Link) -> str:
    """``helper``: a frame that nothing depends on; ``root``: part of the base, which need not move; ``loose``: a frame that
    a joint moves; ``zero``: the real defect."""
    body = model.tree.body(link.name)
    mass = body_mass(model, body)
    if mass is None or mass > 0:
        return "helper"
    drawn = bool(link.visuals or link.collisions)
    carries = any(joint.type != "fixed" for name in body for joint in model.tree.child_joints[name])
    if model.tree.moves(link.name):
        return "zero" if drawn or carries else "loose"
    return "root" if drawn or carries else "helper"
