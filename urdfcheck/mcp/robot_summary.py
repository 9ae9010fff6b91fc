"""A robot on one page: its tree with masses, joints and limits, and how far it reaches."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core.scene import Scene, SceneJoint, SceneLink
from urdfcheck.mcp.chain_reach import ChainReach, measure_reaches
from urdfcheck.output.shared.kinematic_forest import LINK, REPEATED, TreeNode, build_forest

# Chains whose reach is told; the rest is counted.
MOST_REACHES = 4
_ROTARY = frozenset({"revolute", "continuous"})


def summarize_robot(scene: Scene) -> str:
    """Return the totals of a robot and its kinematic tree, a line for each link with the joint above it."""
    links = {link.name: link for link in scene.links}
    joints = {joint.name: joint for joint in scene.joints}
    moving = [joint for joint in scene.joints if joint.type != "fixed"]
    masses = [
        link.inertial.mass for link in scene.links if link.inertial is not None and link.inertial.mass is not None
    ]
    lines = [
        f"{scene.model}: {len(links)} links, {len(moving)} moving joints"
        f" ({sum(joint.mimic is not None for joint in moving)} mimic), {sum(masses):.4g} kg in {len(masses)} links"
    ]
    reaches = measure_reaches(scene)
    lines += map(_format_reach, reaches[:MOST_REACHES])
    if len(reaches) > MOST_REACHES:
        lines.append(f"… and {len(reaches) - MOST_REACHES} shorter chains")
    lines += [_format_node(node, links, joints) for node in build_forest(scene)]
    return "\n".join(lines)


def _format_reach(reach: ChainReach) -> str:
    return f"reach: {reach.tip} comes {reach.found:.3g} m away from {reach.first_joint}, and never more than {reach.limit:.3g} m"


def _format_node(node: TreeNode, links: dict[str, SceneLink], joints: dict[str, SceneJoint]) -> str:
    edge = "" if node.edge is None else f"{_format_edge(node, joints)} → "
    link = links.get(node.name) if node.kind == LINK else None
    facts = ", ".join(_list_link_facts(link)) if link is not None else f"{node.kind}: no such link here"
    if node.kind == REPEATED:
        facts = "above already"
    return f"{'  ' * node.depth}{edge}{node.name}{f' ({facts})' if facts else ''}"


def _format_edge(node: TreeNode, joints: dict[str, SceneJoint]) -> str:
    assert node.edge is not None
    joint = joints.get(node.edge.name) if node.edge.is_joint else None
    if joint is None:
        return node.edge.kind
    return f"{joint.name}: {', '.join(_list_joint_facts(joint))}"


def _list_joint_facts(joint: SceneJoint) -> Iterator[str]:
    yield joint.type
    if joint.type == "fixed":
        return
    if joint.axis is not None:
        yield f"axis {' '.join(f'{value:.3g}' for value in joint.axis)}"
    if joint.lower is not None and joint.upper is not None:
        scale, unit = (180 / math.pi, "°") if joint.type in _ROTARY else (1000.0, " mm")
        yield f"{scale * joint.lower:.4g}…{scale * joint.upper:.4g}{unit}"
    if joint.effort is not None:
        yield f"effort {joint.effort:.4g}"
    if joint.velocity is not None:
        yield f"velocity {joint.velocity:.4g}"
    if joint.mimic is not None:
        name, multiplier, offset = joint.mimic
        yield f"mimics {multiplier:.4g} × {name} + {offset:.4g}"


def _list_link_facts(link: SceneLink) -> Iterator[str]:
    if link.inertial is not None and link.inertial.mass is not None:
        yield f"{link.inertial.mass:.4g} kg"
    if link.density is not None:
        yield f"{link.density:.4g} kg/m³"
    visuals = sum(shape.role == "visual" for shape in link.shapes)
    collisions = sum(shape.role == "collision" for shape in link.shapes)
    if visuals or collisions:
        yield f"{visuals} visual, {collisions} collision"
