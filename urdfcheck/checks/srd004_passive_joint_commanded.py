"""SRD004 reports joints that the SRDF declares passive but a controller commands."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.model import Model
from urdfcheck.model.motion.controllers import collect_command_interfaces, find_controller_configs
from urdfcheck.model.motion.planning_limits import list_own_srdfs


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    passive = [
        (srdf, name)
        for srdf in list_own_srdfs(model)
        for element in srdf.root.find_children("passive_joint")
        if (name := element.attributes.get("name")) is not None and name.value.strip() in model.joint_by_name
    ]
    if not passive:
        return
    offered = collect_command_interfaces(model) or {}
    plans: dict[str, Located] = {
        joint.text: joint
        for associated in find_controller_configs(model)
        for controller in associated.configuration.controllers
        if controller.dialect == "moveit"
        for joint in controller.joints
    }
    for _, name in passive:
        joint = name.value.strip()
        if offered.get(joint):
            yield rule.finding(
                "interface",
                at=name,
                related=[model.joint_by_name[joint]],
                joint=joint,
                interfaces=", ".join(sorted(offered[joint])),
            )
        elif joint in plans:
            yield rule.finding("controller", at=name, related=[plans[joint]], joint=joint)
