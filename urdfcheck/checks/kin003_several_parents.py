"""KIN003 reports links that are the child of several joints."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.link_graph import KinematicGraph


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    graph = KinematicGraph.from_model(model)
    in_loops = {joint for loop in graph.find_loops() for joint in loop}
    for link, joints in graph.map_parent_joints().items():
        # The joints of a loop are KIN004's, the second joint of a name is KIN001's.
        counted = [j for j in joints if j not in in_loops and (not j.name or model.joint_by_name[j.name] is j)]
        if len(counted) > 1:
            yield rule.finding(
                "several",
                at=counted[1].child_location,
                related=[j.child_location for j in counted if j is not counted[1]],
                link=link,
                joints=", ".join(f"{j.name} (from {j.parent})" for j in counted),
                parents=[j.parent for j in counted],
            )
