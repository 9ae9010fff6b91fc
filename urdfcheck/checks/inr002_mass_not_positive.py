"""INR002 reports masses that are not greater than zero."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import FactUnavailableError, Finding, Located, Rule, Severity
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import compute_body_mass

# MuJoCo's mjMINVAL: what a consumer takes for zero.
ZERO = 1e-15
# What becomes of an inertia without mass, of a link that moves and of one that a fixed joint merges with a mass.
ALONE = {
    "gazebo": "drops the link and everything behind it, without a message",
    "mujoco": "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL",
}
FUSED = {
    "gazebo": "loads it, merged into the link that it is fixed to",
    "mujoco": "ignores the inertia",
}
# What Pinocchio and Drake do with a body without mass that has a mass to carry, and with one that has none.
LIGHT = "loads it without mass"
NAN = "computes NaN accelerations: a joint moves what has no mass (Drake stops with an error)"
SEVERITIES = {"root": Severity.INFO, "loose": Severity.WARNING}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    massless: list[Link] = []
    for link in model.links:
        if link.inertial is None or link.inertial.mass is None or link.inertial.mass > 0:
            continue
        mass, largest = link.inertial.mass, max(map(abs, link.inertial.inertia_components or (0.0,)))
        if mass < 0:
            yield rule.finding("negative", at=_locate(link), link=link.name, mass=mass)
        elif largest > ZERO:
            told = ALONE if _is_isolated(model, link) else FUSED
            yield rule.finding(
                "inertia_without_mass", at=_locate(link), consequences=told, link=link.name, largest=largest
            )
        else:
            massless.append(link)
    # Only these need the tree: whether a link of no mass matters is decided by what it is fixed to.
    kinds = [(link, _classify_massless_link(model, link)) for link in massless]
    carrying = _find_mass_carriers(model) if massless else set()
    for link, kind in kinds:
        if kind != "helper":
            without = LIGHT if model.tree.list_body_links(link.name)[0] in carrying else NAN
            told = {} if kind == "root" else dict.fromkeys(("pinocchio", "drake"), without)
            yield rule.finding(kind, at=_locate(link), severity=SEVERITIES.get(kind), consequences=told, link=link.name)
    helpers = [link for link, kind in kinds if kind == "helper"]
    if helpers and "bullet" not in model.targets:  # it assumes 1 kg for a link without <inertial>
        yield rule.finding(
            "helper",
            at=_locate(helpers[0]),
            related=[_locate(link) for link in helpers[1:]],
            severity=Severity.INFO,
            links=", ".join(link.name for link in helpers),
        )


def _locate(link: Link) -> Located:
    assert link.inertial is not None
    attribute = link.inertial.mass_attribute
    return link.inertial.element if attribute is None else attribute


def _classify_massless_link(model: Model, link: Link) -> str:
    """``helper``: a frame that nothing depends on; ``root``: part of the base, which need not move; ``loose``: a frame that
    a joint moves; ``zero``: the real defect."""
    body = model.tree.list_body_links(link.name)
    mass = compute_body_mass(model, body)
    if mass is None or mass > 0:
        return "helper"
    drawn = bool(link.visuals or link.collisions)
    carries = any(joint.type != "fixed" for name in body for joint in model.tree.child_joints[name])
    if model.tree.is_movable_link(link.name):
        return "zero" if drawn or carries else "loose"
    return "root" if drawn or carries else "helper"


def _is_isolated(model: Model, link: Link) -> bool:
    """Whether nothing that is fixed to the link has a mass; so it seems where the tree is broken."""
    try:
        body = model.tree.list_body_links(link.name)
    except FactUnavailableError:
        return True
    return not (compute_body_mass(model, body) or 0.0) > 0.0


def _find_mass_carriers(model: Model) -> set[str]:
    """The links that have a mass, or on which something hangs that has one."""
    found: set[str] = set()
    for name in reversed(model.tree.order):
        inertial = model.link_by_name[name].inertial
        behind = (joint.child for joint in model.tree.child_joints[name])
        if (inertial is not None and inertial.mass) or any(child in found for child in behind):
            found.add(name)
    return found
