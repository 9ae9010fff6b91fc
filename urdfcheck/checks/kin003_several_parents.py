"""KIN003 reports links that are the child of several joints."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.link_graph import KinematicGraph
from urdfcheck.model.repairs.edits import edit_values


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    graph = KinematicGraph.from_model(model)
    in_loops = {joint for loop in graph.find_loops() for joint in loop}
    declared = Counter(link.name for link in model.links)
    for link, joints in graph.map_parent_joints().items():
        # The joints of a loop are KIN004's, the second joint of a name is KIN001's.
        counted = [j for j in joints if j not in in_loops and (not j.name or model.joint_by_name[j.name] is j)]
        if len(counted) <= declared[link]:
            continue  # each of several links of one name has its joint: KIN001 reports the name
        meant = graph.find_meant_child(counted) if len(counted) == 2 else None
        if meant is not None:
            yield _build_slip_finding(rule, graph, *meant, other=next(j for j in counted if j is not meant[0]))
        elif len(counted) > 1:
            roots = graph.find_roots_above(link)
            is_same_pair = len({j.parent for j in counted}) == 1
            yield rule.finding(
                "repeated" if is_same_pair else "several" if len(roots) < 2 else "roots",
                at=counted[1].child_location,
                related=[j.child_location for j in counted if j is not counted[1]],
                link=link,
                joints=", ".join(f"{j.name} (from {j.parent})" for j in counted),
                names=join_names(j.name for j in counted),
                parent=counted[0].parent,
                parents=[j.parent for j in counted],
                roots=join_names(roots),
                repair=_describe_motions(counted) if is_same_pair else _describe_way_to_one_root(graph, counted, roots),
            )


def _describe_motions(joints: Sequence[Joint]) -> str:
    """Say what to do with joints between the same two links: those that move along or about other axes may all be meant."""
    motions = {(joint.type, joint.axis) for joint in joints if joint.is_movable}
    if len(motions) < 2:
        return "delete all of these joints but one"
    return "delete all of these joints but one; if several motions are meant, put a link between one joint and the next"


def _describe_way_to_one_root(graph: KinematicGraph, joints: Sequence[Joint], roots: Sequence[str]) -> str:
    """Say how one of several roots remains.

    A root that carries nothing but the link (``world``) was meant to carry the robot: by its other root.
    """
    parents = [joint.parent for joint in graph.edges]
    bare = [joint for joint in joints if joint.parent in roots and parents.count(joint.parent) == 1]
    if len(joints) == len(roots) == 2 and len(bare) == 1:
        (other,) = (root for root in roots if root != bare[0].parent)
        return f"write `{other}` as the child of {bare[0].name}"
    return (
        "keep one of the joints; give the root above the other a parent in the same tree, or delete what is only there"
    )


def _build_slip_finding(rule: Rule, graph: KinematicGraph, joint: Joint, meant: str, *, other: Joint) -> Finding:
    """Report a joint that names the child of another joint instead of the one it was made for, which is then a second root."""
    return rule.finding(
        "slip",
        at=joint.child_location,
        related=[other.child_location],
        edits=() if joint.child_attribute is None else edit_values([(joint.child_attribute, meant)]),
        explains=[f"KIN005 link[{link}]" for link in graph.links] if len(graph.find_components()) == 2 else [],
        joint=joint.name,
        link=joint.child,
        meant=meant,
        other=other.name,
        parents=[joint.parent, other.parent],
    )
