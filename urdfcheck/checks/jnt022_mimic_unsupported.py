"""JNT022 reports joints with a `<mimic>` that the simulator does not couple with their leaders."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.gazebo import is_for_new_gazebo
from urdfcheck.model.motion.controllers import collect_controlled_joints
from urdfcheck.model.use.gazebo_starts import names_mimic_engine


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    followers = [joint for joint in model.joints if _has_leader(model, joint)]
    if not followers:
        return
    is_for_gazebo = "gazebo" in model.targets if model.targets else is_for_new_gazebo(model)
    if is_for_gazebo:
        driven = collect_controlled_joints(model) | _list_plugin_words(model)
        free = [joint for joint in followers if joint.name not in driven]
        if free and not any("mimic" in word.lower() for word in driven) and not names_mimic_engine(model):
            yield _build_finding(rule, "gazebo", free)
    endless = [joint for joint in followers if joint.type == "continuous"]
    if "isaac" in model.targets and endless:
        yield _build_finding(rule, "isaac", endless)


def _has_leader(model: Model, joint: Joint) -> bool:
    """Whether a joint moves and follows another that moves; what is wrong with the others is JNT009's."""
    leader = None if joint.mimic is None else model.joint_by_name.get(joint.mimic.get("joint"))
    return joint.is_movable and leader is not None and leader.is_movable and leader is not joint


def _list_plugin_words(model: Model) -> set[str]:
    """Return the names and texts in the plugins of Gazebo: one for mimic joints is called so, or names its joints."""
    plugins = [e for block in model.robot.find_children("gazebo") for e in block.walk() if e.tag == "plugin"]
    texts = [inner.text.strip() for plugin in plugins for inner in plugin.walk()]
    return {*texts, *(plugin.get(name) for plugin in plugins for name in ("filename", "name"))}


def _build_finding(rule: Rule, message: str, joints: list[Joint]) -> Finding:
    elements = [joint.mimic for joint in joints if joint.mimic is not None]
    return rule.finding(
        message,
        at=elements[0],
        related=elements[1:],
        joints=join_names(joint.name for joint in joints),
        joint=joints[0].name,
        verb="follows" if len(joints) == 1 else "follow",
    )
