"""INR011 reports joints between bodies of very different mass."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import FactUnavailableError, Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.materials import DENSEST, LIGHTEST
from urdfcheck.model import Joint, Model
from urdfcheck.model.inertials.habits.stated_purposes import has_stated_purpose
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.rigid_bodies import compute_body_mass, list_rigid_bodies

# A shaft of some grams on a vehicle of a tonne is a part (kg); a milligram is a placeholder, or another unit.
LEAST_PART = 5e-3
# At most this (kg), a moving body counts as massless (`mass` of INR012, which reports it).
_NO_MASS = 1e-6
_SLIDES = frozenset({"prismatic", "planar", "floating"})
# A body has the name of a link that makes most of its mass.
_MOST = 0.5
# From here on (kg) a mass is printed without decimals.
_LARGE = 1000.0


@dataclass(frozen=True, slots=True, eq=False)
class _JointMasses:
    """A joint between two bodies with mass."""

    joint: Joint
    parent_mass: float
    """kg of the body before the joint."""
    child_mass: float
    """kg of the body behind the joint."""

    @property
    def ratio(self) -> float:
        return self.child_mass / self.parent_mass


def check(model: Model, rule: Rule, *, light: float, heavy: float, absurd: float) -> Iterator[Finding]:
    pairs = [
        pair for pair in _collect_joint_masses(model) if not (_has_no_mass(model, pair) or _is_chosen(model, pair))
    ]
    root = frozenset(model.tree.list_body_links(model.tree.root))
    # The slack keeps 1/1000 itself, which has no exact double, from being below 1/1000.
    most = light * (1 - 1e-9)
    lighter = [
        pair
        for pair in pairs
        if pair.ratio < most
        and not _is_small_part(model, pair)
        and not (pair.joint.parent in root and _is_on_stand(model, pair, most))
    ]
    # The root may be bolted to the world; its mass then does not matter.
    heavier = [
        pair
        for pair in pairs
        if pair.ratio > heavy * (1 + 1e-9)
        and pair.joint.parent not in root
        and not _is_of_virtual_base(model, pair.joint.parent)
    ]
    # A body that is too light for what it carries is reported once.
    reported = {name for pair in heavier for name in model.tree.list_body_links(pair.joint.parent)}
    lighter = [pair for pair in lighter if pair.joint.child not in reported]
    if lighter:
        yield _build_finding(model, rule, "light", worst_first=sorted(lighter, key=lambda pair: pair.ratio))
    if heavier:
        heavier.sort(key=lambda pair: -pair.ratio)
        is_plain = heavier[0].ratio > absurd or any(_is_implausible(model, pair) for pair in heavier)
        yield _build_finding(model, rule, "heavy" if is_plain else "uneven", worst_first=heavier)


def _collect_joint_masses(model: Model) -> list[_JointMasses]:
    bodies = list_rigid_bodies(model)
    masses = ((body, compute_body_mass(model, body.links) or 0.0) for body in bodies)
    mass_of = {name: mass for body, mass in masses for name in body.links}
    joints = [model.tree.parent_joint[body.links[0]] for body in bodies if body.is_movable]
    return [
        _JointMasses(joint, mass_of[joint.parent], mass_of[joint.child])
        for joint in joints
        if mass_of[joint.parent] > 0 and mass_of[joint.child] > 0
    ]


def _has_no_mass(model: Model, pair: _JointMasses) -> bool:
    """Whether a body beside the joint weighs next to nothing and moves: then that is the mistake."""
    moves = model.tree.list_body_links(pair.joint.parent)[0] in model.tree.parent_joint
    return pair.child_mass <= _NO_MASS or (moves and pair.parent_mass <= _NO_MASS)


def _is_chosen(model: Model, pair: _JointMasses) -> bool:
    """Whether a comment gives a reason for the masses of the lighter body beside the joint."""
    lighter = pair.joint.child if pair.ratio < 1.0 else pair.joint.parent
    weighed = [name for name in model.tree.list_body_links(lighter) if name in model.mass_by_name]
    return any(has_stated_purpose(model, model.link_by_name[name]) for name in weighed)


def _is_small_part(model: Model, pair: _JointMasses) -> bool:
    """Whether the child may well weigh so little, and neither density says otherwise."""
    return pair.child_mass >= LEAST_PART and not _is_implausible(model, pair)


def _is_implausible(model: Model, pair: _JointMasses) -> bool:
    """Whether the density of a body beside the joint is that of no part."""
    bodies = [model.tree.list_body_links(name) for name in (pair.joint.child, pair.joint.parent)]
    return any(_has_implausible_density(model, body) for body in bodies)


def _is_of_virtual_base(model: Model, link: str) -> bool:
    """Whether slides of which nothing is drawn lead from the root to the body of a link: they stand for a base that drives or
    flies, as programs in joint coordinates have it."""
    path = model.tree.find_path_to(link)
    bodies = [model.tree.list_body_links(name) for name in (model.tree.root, link, *(joint.child for joint in path))]
    is_drawn = any(has_drawn_shape(model.link_by_name[name]) for body in bodies for name in body)
    return not is_drawn and any(joint.type in _SLIDES for joint in path)


def _is_on_stand(model: Model, pair: _JointMasses, least: float) -> bool:
    """Whether a child is light beside what its parent is fixed to, such as a stand, but not beside the parent itself."""
    own = compute_body_mass(model, (pair.joint.parent,)) or 0.0
    return own > 0.0 and pair.child_mass >= least * own


def _build_finding(model: Model, rule: Rule, message: str, *, worst_first: list[_JointMasses]) -> Finding:
    """Report all joints together, at the most extreme."""
    worst, *rest = worst_first
    others = [pair.joint.name for pair in rest]
    finding = rule.finding(
        message,
        at=worst.joint,
        related=[pair.joint for pair in rest],
        joint=worst.joint.name,
        child=worst.joint.child,
        parent=worst.joint.parent,
        child_body=_describe_body(model, worst.joint.child, worst.child_mass),
        parent_body=_describe_body(model, worst.joint.parent, worst.parent_mass),
        child_mass=worst.child_mass,
        parent_mass=worst.parent_mass,
        suspects=_describe_suspects(model, worst.joint),
        times=max(worst.ratio, 1 / worst.ratio),
        also=f" (also {join_names(others)})" if others else "",
    )
    return replace(finding, subjects=tuple(pair.joint.location.subject for pair in worst_first))


def _describe_body(model: Model, link: str, mass: float) -> str:
    """Name a link with the ``mass`` (kg) of its body, and say where most of that is the mass of links fixed to it."""
    own = compute_body_mass(model, (link,)) or 0.0
    name = link if own > _MOST * mass else f"{link} and what is fixed to it"
    return f"{name} ({f'{mass:,.0f}' if mass >= _LARGE else f'{mass:.3g}'} kg)"


def _describe_suspects(model: Model, joint: Joint) -> str:
    """Name the body beside the joint whose density is implausible, or both unless that is exactly one of them.

    The name of a body is that of its heaviest link.
    """
    bodies_of = [model.tree.list_body_links(name) for name in (joint.child, joint.parent)]
    wrong = [body for body in bodies_of if _has_implausible_density(model, body)]
    suspects = wrong if len(wrong) == 1 else bodies_of
    return " and ".join(max(body, key=lambda name: compute_body_mass(model, (name,)) or 0.0) for body in suspects)


def _has_implausible_density(model: Model, body: tuple[str, ...]) -> bool:
    from urdfcheck.model.shapes.visual_solid import measure_links_volume  # most models need no volume here

    try:
        volume = measure_links_volume(model, [model.link_by_name[name] for name in body])
    except FactUnavailableError:  # meshes are not read
        return False
    density = (compute_body_mass(model, body) or 0.0) / volume if volume else LIGHTEST
    return not LIGHTEST <= density <= DENSEST
