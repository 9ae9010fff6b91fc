"""KIN003 reports links that are the child of several joints."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Joint, Model
from urdfcheck.model.link_graph import KinematicGraph

# What the name of a joint adds to that of the link to which it leads.
_JOINT_WORD = re.compile(r"_?joint$", re.IGNORECASE)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    graph = KinematicGraph.from_model(model)
    in_loops = {joint for loop in graph.find_loops() for joint in loop}
    for link, joints in graph.map_parent_joints().items():
        # The joints of a loop are KIN004's, the second joint of a name is KIN001's.
        counted = [j for j in joints if j not in in_loops and (not j.name or model.joint_by_name[j.name] is j)]
        if len(counted) > 1:
            slips = [(j, meant) for j in counted if (meant := _guess_child(graph, j)) is not None]
            at = slips[0][0] if len(slips) == 1 else counted[1]
            yield rule.finding(
                "several",
                at=at.child_location,
                related=[j.child_location for j in counted if j is not at],
                slip=f"write {slips[0][1]} as the child of {at.name}; otherwise " if len(slips) == 1 else "",
                link=link,
                joints=", ".join(f"{j.name} (from {j.parent})" for j in counted),
                parents=[j.parent for j in counted],
            )


def _guess_child(graph: KinematicGraph, joint: Joint) -> str | None:
    """Return the link to which a joint leads by its name, if no joint leads there and the joint does not start from it."""
    parents = graph.map_parent_joints()
    stem = _JOINT_WORD.sub("", joint.name)
    above = {joint.parent}
    queue = [joint.parent]
    while queue:
        queue = [one.parent for name in queue for one in parents.get(name, ()) if one.parent not in above]
        above.update(queue)
    named = [link for link in graph.links if link in {stem, f"{stem}_link"} and link not in above]
    return next((link for link in named if not parents.get(link)), None) if stem else None
