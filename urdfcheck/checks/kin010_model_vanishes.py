"""KIN010 reports models that are empty after the conversion to SDF, for Gazebo."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import list_rigid_bodies
from urdfcheck.model.use.gazebo_starts import is_left_out_of_gazebo

# libsdformat takes a smaller mass for zero (gz::math::equal).
_NO_MASS = 1e-6
# A model in which more of the moving bodies have no inertial is displayed, and INR001 says what it lacks: of published models
# with a massless root, 5 of 6 in one that is only displayed, 12 of 20 in a hand that is simulated.
_DRAWING_SHARE = 0.75
# A root whose mass is typed as 0 is how files for Bullet say that it is part of the world.
_STATIC = "; nothing if the model is for Bullet only, where a root of mass 0 is fixed to the world"
_FIXED = {"bullet": "replaces the free base by one fixed to the world"}
_KEPT = frozenset({"preserveFixedJoint", "disableFixedJointLumping"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if not model.links:
        return  # KIN007
    if all(link.inertial is None for link in model.links):
        yield _build_drawing_finding(model, rule, _describe_lack(len(model.links)))
        return
    root = model.tree.root
    # A root of this name is the world: each part below it is converted separately.
    heads = [joint.child for joint in model.tree.child_joints[root]] if root == "world" else [root]
    preserved = _list_preserved_joints(model)
    bodies = {head: [model.link_by_name[name] for name in _list_merged_links(model, head, preserved)] for head in heads}
    if not bodies or any(_has_mass(links) for links in bodies.values()):
        return
    if _is_only_drawn(model):
        return
    bare, moving = _count_bare_bodies(model)
    if bare > _DRAWING_SHARE * moving:
        yield _build_drawing_finding(model, rule, f"the root and {bare} of {moving} moving bodies have no")
        return
    head, links = next(iter(bodies.items()))
    attached = {joint.name for link in links for joint in model.tree.child_joints[link.name] if joint.type != "fixed"}
    is_static = len(bodies) == 1 and links[0].inertial is not None and links[0].inertial.mass == 0
    is_bare = not any(declared.mass for declared in model.masses)  # no body is lost that a simulator would move
    is_still = is_static and not any(j.is_movable for j in model.joints)
    is_note = is_still or is_bare or is_left_out_of_gazebo(model)
    root_mass = sum(link.inertial.mass or 0.0 for link in links if link.inertial is not None)
    yield rule.finding(
        "tiny" if root_mass > 0.0 else "vanishes",
        at=links[0],
        link=head,
        # Below a link called world each part is converted by itself.
        role="root" if head == root else f"on {root},",
        own=root_mass,
        lack=_describe_lack_of_mass(links[0]),
        with_it=f" (with {join_names(link.name for link in links[1:])}, fixed to it)" if len(links) > 1 else "",
        count=len(model.links),
        joints=join_names(joint.name for joint in model.joints if joint.name in attached),
        mass=sum(declared.mass for declared in model.masses),
        # Such as the ground that comes with PyBullet, and obstacles that stand on it.
        severity=Severity.INFO if is_note and not root_mass else None,
        below=_describe_carriers(model, preserved, links),
        also=_STATIC if is_static else "",
        consequences=_FIXED if is_static else None,
    )


def _build_drawing_finding(model: Model, rule: Rule, which: str) -> Finding:
    return rule.finding("drawing", at=model.name_location, severity=Severity.INFO, which=which)


def _count_bare_bodies(model: Model) -> tuple[int, int]:
    """Return how many of the bodies that joints move draw something and have no inertial (INR001), and how many draw
    something."""
    links = [[model.link_by_name[name] for name in body.links] for body in list_rigid_bodies(model) if body.is_movable]
    drawn = [body for body in links if any(link.visuals for link in body)]
    return sum(all(link.inertial is None for link in body) for body in drawn), len(drawn)


def _is_only_drawn(model: Model) -> bool:
    """Whether every mass is 0, that of a drawn link which moves among them: INR002 reports it as an error that Gazebo drops."""
    if any(declared.mass for declared in model.masses):
        return False
    return any(d.link.visuals and model.tree.is_movable_link(d.link.name) for d in model.masses)


def _list_merged_links(model: Model, head: str, preserved: frozenset[str]) -> list[str]:
    """Return the links that the conversion merges into ``head``: those behind fixed joints that nothing preserves."""
    queue, merged = [head], []
    while queue:
        merged.append(queue.pop())
        joints = model.tree.child_joints[merged[-1]]
        queue.extend(joint.child for joint in joints if joint.type == "fixed" and joint.name not in preserved)
    return merged


def _describe_carriers(model: Model, preserved: frozenset[str], dropped: list[Link]) -> str:
    """Name the links that would be dropped next, with what they carry, if one that is dropped had a mass."""
    tree = model.tree
    heads = [joint.child for joint in model.joints if joint.type != "fixed" or joint.name in preserved]
    merged = {head: [model.link_by_name[name] for name in _list_merged_links(model, head, preserved)] for head in heads}
    heavy = {step.child for head, links in merged.items() if _has_mass(links) for step in tree.find_path_to(head)}
    bare = {head for head, links in merged.items() if not _has_mass(links)} - {link.name for link in dropped}
    carriers = [name for name in tree.order if name in bare & heavy]
    return f" (and {join_names(carriers)} below it, which would be dropped next)" if carriers else ""


def _list_preserved_joints(model: Model) -> frozenset[str]:
    """Return the names of the joints that a Gazebo extension keeps."""
    return frozenset(
        gazebo.get("reference")
        for gazebo in model.robot.find_children("gazebo")
        if any(child.tag in _KEPT and child.text.strip().lower() in {"true", "1"} for child in gazebo.children)
    )


def _has_mass(links: list[Link]) -> bool:
    """Whether a link has a mass, or a wrong one: not a number, negative, or 0 with an inertia (INR002)."""
    inertials = [link.inertial for link in links if link.inertial is not None]
    return any(
        i.mass is None or i.mass < 0 or i.mass > _NO_MASS or (i.mass == 0 and any(i.inertia_components or ()))
        for i in inertials
    )


def _describe_lack_of_mass(link: Link) -> str:
    """Return what a link must get: a mass whose moments of inertia are 0 is refused too."""
    if link.inertial is None:
        return "an <inertial>"
    return "a mass" if any(link.inertial.inertia_components or ()) else "a mass and moments of inertia"


def _describe_lack(links: int) -> str:
    return "the only link has no" if links == 1 else f"none of the {links} links has an"
