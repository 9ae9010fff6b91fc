"""INR002 reports masses that are not greater than zero."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.model import DeclaredMass, Link, Model
from urdfcheck.model.rigid_bodies import compute_body_mass, find_merged_body, is_world_link
from urdfcheck.model.stated_reasons import is_called_massless
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.model.use.simulators import has_elements, is_simulated, is_simulated_hardware
from urdfcheck.policy.consumers import SIMULATORS

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
# An inertia below this share of the body's smallest moment changes it by less than the cable of a part does (as in INR005).
_FELT = 0.02
# So many zeros for all links of a robot were written by a program, or for none of the masses (chosen).
_FEWEST = 4
# Programs that lose a body without mass, or refuse it, whatever hangs on it, as files name them.
_LOSING = re.compile(r"gazebo|ros_gz|ros_ign|gz_sim|mujoco|isaac", re.IGNORECASE)
_WRITE = "write the mass; if the link only marks a frame, remove its <inertial> or set the inertia to 0 too"
_WRITE_ONCE = "write the mass, unless that of {} includes it: then set the inertia to 0 too"
_REMOVE = "remove its <inertial> or set the inertia to 0 too if the link only marks a frame; otherwise write the mass"


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
    severities = SEVERITIES
    zeros = [one.link for one, kind in kinds if kind == "zero"]
    if _is_weightless(model, massless) or _are_joining_frames(model, zeros, carrying):
        severities = {**SEVERITIES, "zero": Severity.WARNING}
    for declared, kind in kinds:
        if kind != "helper":
            without = LIGHT if model.tree.list_body_links(declared.link.name)[0] in carrying else NAN
            yield rule.finding(
                kind,
                at=declared.attribute,
                severity=severities.get(kind),
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


def _is_weightless(model: Model, massless: Sequence[DeclaredMass]) -> bool:
    """Whether no link has a mass, and nothing known simulates the robot: a drawing whose zeros stand for what INR001 would not
    report as an error if it were missing. Without a package nothing shows what a robot is for that collides."""
    drawn = {link.name for link in model.links if link.visuals or link.collisions}
    if model.source.package is None and any(link.collisions for link in model.links):
        return False
    is_of_all = len(massless) == len(model.masses) >= _FEWEST and drawn <= {one.link.name for one in massless}
    return is_of_all and not SIMULATORS.intersection(model.targets) and not is_simulated(model)


def _are_joining_frames(model: Model, links: Sequence[Link], carrying: AbstractSet[str]) -> bool:
    """Whether links without mass are the frames between the axes of joints of several degrees of freedom, which carry a mass:
    Pinocchio, Drake and Bullet compute with them.

    Either a comment says that they have no mass, or nothing draws them, and neither the robot nor its package is for a program
    that loses them.
    """
    bodies = [model.tree.list_body_links(link.name) for link in links]
    parts = [model.link_by_name[name] for body in bodies for name in body]
    if not all(body[0] in carrying for body in bodies) or has_elements(model):
        return False
    if all(is_called_massless(model, link.element) for link in links):
        return True
    if any(part.visuals or part.collisions for part in parts):
        return False
    controls = model.robot.find_children("ros2_control")
    return not any(map(is_simulated_hardware, controls)) and not any(map(_LOSING.search, list_project_texts(model)))


def _build_massless_inertia_finding(model: Model, rule: Rule, declared: DeclaredMass, *, largest: float) -> Finding:
    """Report an inertia without mass; on the root it is a warning at most, because Bullet fixes a base of mass 0 to the world."""
    link, welded = declared.link, _is_welded(model, declared.link)
    fused = not _is_isolated(model, link)
    is_root = welded and link.name == model.tree.root
    merged = find_merged_body(model, link) if fused else None
    # Drake alone, which gives the link a mass, then moves the body otherwise.
    is_lost = merged is not None and largest <= _FELT * merged.moments[0] and "drake" not in model.targets
    # Of a body alone it is Bullet's way to say that it never moves.
    lowered = Severity.WARNING if any(joint.is_movable for joint in model.joints) else Severity.INFO
    consequences = FUSED if fused else BASE if welded else ALONE
    return rule.finding(
        "base" if is_root else "inertia_without_mass",
        at=declared.attribute,
        severity=lowered if is_root else Severity.WARNING if is_lost else None,
        consequences={**consequences, "mujoco": BASE["mujoco"]} if welded else consequences,
        link=link.name,
        largest=largest,
        repair=_describe_repair(link, "" if merged is None else merged.heaviest),
    )


def _describe_repair(link: Link, carrier: str) -> str:
    """Say what to do about an inertia without mass; ``carrier``: the heaviest link that it is fixed to, empty for none."""
    if not carrier:
        return _WRITE
    return _WRITE_ONCE.format(carrier) if link.visuals or link.collisions else _REMOVE


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
