"""INR002 reports masses that are not greater than zero."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.model import DeclaredMass, Link, Model
from urdfcheck.model.rigid_bodies import compute_body_mass, is_world_link

# MuJoCo's mjMINVAL: programs treat less as zero.
ZERO = 1e-15
# What programs do with an inertia without mass: on a link that moves, and on one fixed to a link with mass.
ALONE = {
    "gazebo": "drops the link and everything behind it",
    "mujoco": "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL",
}
FUSED = {
    "gazebo": "merges it into the link that it is fixed to",
    "mujoco": "ignores the inertia",
}
# On the base, which MuJoCo welds to the world whatever it weighs.
BASE = {
    "gazebo": "refuses the model: the conversion to SDF leaves it without links",
    "mujoco": "loads it: no joint moves the root of a URDF there",
}
# A negative mass that others of the body outweigh, and one on the base.
OUTWEIGHED = {"mujoco": "ignores the mass and the inertia of the link"}
WELDED = {
    "mujoco": "loads it: no joint moves the root of a URDF there",
    "bullet": "loads it if the base is fixed to the world; otherwise computes NaN accelerations",
}
# Pinocchio and Drake, on a body without mass: it carries a mass, or none at all.
LIGHT = "loads it without mass"
NAN = "computes NaN accelerations: the joint moves no mass (Drake stops with an error)"
SEVERITIES = {"root": Severity.INFO, "loose": Severity.WARNING}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    massless: list[DeclaredMass] = []
    for declared in model.masses:
        if declared.mass > 0:
            continue
        link, largest = declared.link, max(map(abs, declared.inertial.inertia_components or (0.0,)))
        if declared.mass < 0:
            yield rule.finding(
                "negative",
                at=declared.attribute,
                consequences=_predict_negative(model, link),
                link=link.name,
                mass=declared.mass,
            )
        elif is_world_link(model, link):
            continue  # it is fixed already, and programs leave it out
        elif largest > ZERO:
            yield _build_massless_inertia_finding(model, rule, declared, largest=largest)
        else:
            massless.append(declared)
    # The tree is built only for these: whether a link without mass matters depends on the links fixed to it.
    kinds = [(declared, _classify_massless_link(model, declared.link)) for declared in massless]
    carrying = _find_mass_carriers(model) if massless else set()
    if any(kind == "zero" for _, kind in kinds):
        if len(massless) == len(model.masses):  # no link has a mass: that of a frame without shapes would not be missed
            kinds = [(declared, kind) for declared, kind in kinds if kind != "loose"]
        # One list: a program that refuses the file does so for either.
        kinds = [(declared, "zero" if kind == "loose" else kind) for declared, kind in kinds]
    for declared, kind in kinds:
        if kind != "helper":
            without = LIGHT if model.tree.list_body_links(declared.link.name)[0] in carrying else NAN
            yield rule.finding(
                kind,
                at=declared.attribute,
                severity=SEVERITIES.get(kind),
                consequences={} if kind == "root" else dict.fromkeys(("pinocchio", "drake"), without),
                link=declared.link.name,
            )
    helpers = [declared for declared, kind in kinds if kind == "helper"]
    if helpers and "bullet" not in model.targets:  # it assumes 1 kg for a link without <inertial>
        yield rule.finding(
            "helper",
            at=helpers[0].attribute,
            related=[declared.attribute for declared in helpers[1:]],
            severity=Severity.INFO,
            links=", ".join(declared.link.name for declared in helpers),
        )


def _classify_massless_link(model: Model, link: Link) -> str:
    """Return the kind of a link without mass.

    ``helper``: a frame that nothing depends on; ``root``: a part of the base, which need not move; ``loose``: a frame that a
    joint moves; ``zero``: the real defect.
    """
    body = model.tree.list_body_links(link.name)
    mass = compute_body_mass(model, body)
    if mass is None or mass > 0:
        return "helper"
    drawn = bool(link.visuals or link.collisions)
    carries = any(joint.type != "fixed" for name in body for joint in model.tree.child_joints[name])
    if model.tree.is_movable_link(link.name):
        return "zero" if drawn or carries else "loose"
    return "root" if drawn or carries else "helper"


def _build_massless_inertia_finding(model: Model, rule: Rule, declared: DeclaredMass, *, largest: float) -> Finding:
    """Report an inertia without mass; on the root it is a warning at most, because Bullet fixes a base of mass 0 to the world."""
    link, welded = declared.link, _is_welded(model, declared.link)
    fused = not _is_isolated(model, link)
    is_root = welded and link.name == model.tree.root
    # Of a body alone it is Bullet's way to say that it never moves.
    lowered = Severity.WARNING if any(joint.is_movable for joint in model.joints) else Severity.INFO
    consequences = FUSED if fused else BASE if welded else ALONE
    return rule.finding(
        "base" if is_root else "inertia_without_mass",
        at=declared.attribute,
        severity=lowered if is_root else None,
        consequences={**consequences, "mujoco": BASE["mujoco"]} if welded else consequences,
        link=link.name,
        largest=largest,
    )


def _predict_negative(model: Model, link: Link) -> dict[str, str]:
    """Return what differs from the page: programs do not use the mass of a link that does not move, nor does MuJoCo if other
    links of the body have one."""
    if _is_welded(model, link):
        return WELDED
    try:
        body = model.tree.list_body_links(link.name)
    except FactUnavailableError:
        return {}
    inertials = (model.link_by_name[name].inertial for name in body)
    return OUTWEIGHED if any(i is not None and (i.mass or 0.0) > 0.0 for i in inertials) else {}


def _is_welded(model: Model, link: Link) -> bool:
    """Whether no joint moves the link, as far as the tree is known."""
    try:
        return not model.tree.is_movable_link(link.name)
    except FactUnavailableError:
        return False


def _is_isolated(model: Model, link: Link) -> bool:
    """Whether no link that is fixed to this one has a mass, or the tree is broken."""
    try:
        body = model.tree.list_body_links(link.name)
    except FactUnavailableError:
        return True
    return not (compute_body_mass(model, body) or 0.0) > 0.0


def _find_mass_carriers(model: Model) -> set[str]:
    """Return the names of links that have a mass themselves or behind them."""
    carriers: set[str] = set()
    for name in reversed(model.tree.order):
        inertial = model.link_by_name[name].inertial
        behind = (joint.child for joint in model.tree.child_joints[name])
        if (inertial is not None and inertial.mass) or any(child in carriers for child in behind):
            carriers.add(name)
    return carriers
