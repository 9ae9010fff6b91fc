"""What differs in the tree: links and joints that came, went, have another name or hang on another part."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from urdfcheck.core.mechanism import NO_TRACE, MechanismLink, RobotMechanism, Trace
from urdfcheck.core.model_diff import MechanismChange
from urdfcheck.facts.comparison.alignment import PlacedPair
from urdfcheck.facts.comparison.bodies import BodyPair
from urdfcheck.facts.comparison.contents import is_same_body, list_lost_shapes, sum_inertias
from urdfcheck.facts.comparison.home_pose import HomePose, is_same_pose

# A note is a difference of the description alone.
NOTE = "note"


def compare_structure(pair: PlacedPair, bodies: Sequence[BodyPair]) -> Iterator[MechanismChange]:
    """Yield the changes of the tree; those of the category `NOTE` leave every body and every joint as it was."""
    yield from _compare_roots(pair)
    yield from _compare_names(pair)
    split_before, split_after = _find_regrouped_links(pair, bodies)
    by_new = {new: old for old, new in pair.match.links.items()}
    yield from _list_lone_links(pair.before, pair.match.links, split_before, is_new=False)
    yield from _list_lone_links(pair.after, by_new, split_after, is_new=True)
    yield from _compare_parents(pair, bodies)


# -- the root ----------------------------------------------------------------------------------------------------------


def _compare_roots(pair: PlacedPair) -> Iterator[MechanismChange]:
    first, second = pair.before.mechanism, pair.after.mechanism
    before, after = (_trace_root(mechanism) for mechanism in (first, second))
    if first.is_grounded != second.is_grounded:
        words = {"before": first.root, "after": second.root, "held": "yes" if second.is_grounded else "no"}
        yield MechanismChange(
            category="structure", id="base", subject=f"link[{first.root}]", words=words, before=before, after=after
        )
    elif pair.match.links.get(first.root) != second.root:
        words = {"before": first.root, "after": second.root}
        yield MechanismChange(
            category="structure", id="root", subject=f"link[{first.root}]", words=words, before=before, after=after
        )


def _trace_root(mechanism: RobotMechanism) -> Trace:
    return next(link.traces.get("link", NO_TRACE) for link in mechanism.links if link.name == mechanism.root)


# -- names -------------------------------------------------------------------------------------------------------------


def _compare_names(pair: PlacedPair) -> Iterator[MechanismChange]:
    for old, new in pair.match.links.items():
        if old != new:
            yield MechanismChange(
                category="structure",
                id="link-renamed",
                subject=f"link[{old}]",
                new_name=new,
                numbers={"confidence": pair.match.confidences.get(old, 1.0)},
                words={"users": ", ".join(_list_users(pair.after.mechanism, old))},
                before=pair.before.links[old].traces.get("link", NO_TRACE),
                after=pair.after.links[new].traces.get("link", NO_TRACE),
            )
    for old, new in pair.match.joints.items():
        if old != new:
            yield MechanismChange(
                category="structure",
                id="joint-renamed",
                subject=f"joint[{old}]",
                new_name=new,
                words={"users": ", ".join(_list_users(pair.after.mechanism, old))},
                before=pair.before.joints[old].traces.get("joint", NO_TRACE),
                after=pair.after.joints[new].traces.get("joint", NO_TRACE),
            )


def _list_users(mechanism: RobotMechanism, name: str) -> list[str]:
    """Return what in the description still uses a name that no part has any longer; nothing where a part still has it."""
    if name in {*(link.name for link in mechanism.links), *(joint.name for joint in mechanism.joints)}:
        return []
    quoted = repr(name)
    users = [extra.label for extra in mechanism.extras if quoted in extra.content or f"[{name}]" in extra.label]
    users += [f"mimic of joint[{j.name}]" for j in mechanism.joints if j.mimic is not None and j.mimic[0] == name]
    return list(dict.fromkeys(users))


# -- links of one version only -----------------------------------------------------------------------------------------


def _find_regrouped_links(pair: PlacedPair, bodies: Sequence[BodyPair]) -> tuple[set[str], set[str]]:
    """Return the links of either version that only fixed joints hold and whose mass and shapes the same body has in the other."""
    lost_before, lost_after = list_lost_shapes(pair, bodies)
    before: set[str] = set()
    after: set[str] = set()
    for body in bodies:
        if not body.before or not body.after:
            continue
        olds = [(pair.before.links[n], pair.maps[n] @ pair.before.frames[n]) for n in body.before]
        news = [(pair.after.links[n], pair.after.frames[n]) for n in body.after]
        is_same_mass = is_same_body(sum_inertias(olds), sum_inertias(news))
        for home, names, lost, found in (
            (pair.before, body.before, lost_before, before),
            (pair.after, body.after, lost_after, after),
        ):
            for name in names:
                link, joint = home.links[name], home.joint_above.get(name)
                weighs = bool(link.mass)
                if name in lost or (weighs and not is_same_mass) or joint is None or joint.type != "fixed":
                    continue
                if weighs or link.shapes or home.joints_below[name]:
                    found.add(name)  # a frame alone, without anything on it, is what others use by its name
    return before, after


def _list_lone_links(
    home: HomePose, matched: Mapping[str, str], regrouped: set[str], *, is_new: bool
) -> Iterator[MechanismChange]:
    """Yield the links that only one version has; what hangs on such a link and is lone too comes and goes with it."""
    branches: dict[str, list[MechanismLink]] = {}
    top: dict[str, str] = {}
    for name in home.order:
        if name in matched:
            continue
        joint = home.joint_above.get(name)
        is_note = name in regrouped
        # What hangs on a lone root did not come or go with the root, which is reported as the root.
        parent = None if joint is None or joint.parent == home.order[0] else top.get(joint.parent)
        top[name] = name if parent is None or is_note != (parent in regrouped) else parent
        branches.setdefault(top[name], []).append(home.links[name])
    for name, links in branches.items():
        joint = home.joint_above.get(name)
        if joint is None:
            continue  # the root is reported as the root
        own, upper = home.links[name].traces.get("link", NO_TRACE), joint.traces.get("joint", NO_TRACE)
        trace = Trace((*own.places, *upper.places), tuple(dict.fromkeys((*own.calls, *upper.calls))))
        what = "added" if is_new else "removed"
        yield MechanismChange(
            category=NOTE if name in regrouped else "structure",
            id=("link-split" if is_new else "link-merged") if name in regrouped else f"link-{what}",
            subject=f"link[{name}]",
            numbers={"mass": sum(link.mass or 0.0 for link in links), "links": float(len(links))},
            words={
                "parent": joint.parent,
                "joint": joint.name,
                "type": joint.type,
                "links": ", ".join(link.name for link in links),
            },
            before=NO_TRACE if is_new else trace,
            after=trace if is_new else NO_TRACE,
        )


# -- parents -----------------------------------------------------------------------------------------------------------


def _compare_parents(pair: PlacedPair, bodies: Sequence[BodyPair]) -> Iterator[MechanismChange]:
    body_before = {name: number for number, body in enumerate(bodies) for name in body.before}
    body_after = {name: number for number, body in enumerate(bodies) for name in body.after}
    for old, new in pair.match.links.items():
        upper, lower = pair.before.joint_above.get(old), pair.after.joint_above.get(new)
        if upper is None or lower is None:
            continue
        if body_before[upper.parent] != body_after[lower.parent]:
            yield MechanismChange(
                category="structure",
                id="reparented",
                subject=f"link[{old}]",
                new_name="" if old == new else new,
                words={"before": upper.parent, "after": lower.parent},
                before=upper.traces.get("parent", NO_TRACE),
                after=lower.traces.get("parent", NO_TRACE),
            )
        elif pair.match.joints.get(upper.name) != lower.name and {upper.type, lower.type} != {"fixed"}:
            yield MechanismChange(
                category="structure",
                id="joint-replaced",
                subject=f"joint[{upper.name}]",
                new_name=lower.name,
                words={"link": old, "before": upper.type, "after": lower.type},
                before=upper.traces.get("joint", NO_TRACE),
                after=lower.traces.get("joint", NO_TRACE),
            )


# -- frames ------------------------------------------------------------------------------------------------------------


def list_frame_notes(pair: PlacedPair) -> Iterator[MechanismChange]:
    """Yield the links whose frame was moved while mass, shapes and children stayed."""
    for old in pair.before.order:
        new = pair.match.links.get(old)
        if new is None or old not in pair.reframed:
            continue
        taken = pair.maps[old] @ pair.before.frames[old]
        if not is_same_pose(taken, pair.after.frames[new]):
            upper, lower = pair.before.joint_above.get(old), pair.after.joint_above.get(new)
            yield MechanismChange(
                category=NOTE,
                id="frame-moved",
                subject=f"link[{old}]",
                new_name="" if old == new else new,
                before=NO_TRACE if upper is None else upper.traces.get("pose", NO_TRACE),
                after=NO_TRACE if lower is None else lower.traces.get("pose", NO_TRACE),
            )
