"""What MoveIt plans with: the joints of planning groups, and the limits that apply to them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.core.records import dataclass
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model
from urdfcheck.source.ros.joint_limits import JointLimits, read_joint_limits
from urdfcheck.source.ros.srdf import Srdf, is_configured_for
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.source.text.xml import Element

# The file that MoveIt Setup Assistant writes beside the semantic description.
LIMITS_FILE = "joint_limits.yaml"


@dataclass(frozen=True, slots=True)
class PositionRange:
    """Positions (rad or m) that MoveIt plans in."""

    lower: float
    upper: float
    source: str
    """Where a bound comes from."""


def list_own_srdfs(model: Model) -> list[Srdf]:
    """Return the semantic descriptions of the model's name that cannot be another robot's."""
    return [srdf for srdf in semantic_descriptions(model) if is_configured_for(srdf, model.source)]


def load_joint_limits(model: Model, srdf: Srdf) -> tuple[JointLimits, ...]:
    """Load the limits beside a semantic description; none if they are another robot's, and a file beside them is this one's."""
    folder, finder = srdf.path.parent, model.source.finder
    limits = read_joint_limits(folder / LIMITS_FILE, finder)
    if limits and not _name_joints(model, limits):
        others = (path for path in sorted(folder.glob(f"*{LIMITS_FILE}")) if path.name != LIMITS_FILE)
        if any(_name_joints(model, read_joint_limits(path, finder)) for path in others):
            return ()
    return limits


def _name_joints(model: Model, limits: Iterable[JointLimits]) -> bool:
    return any(entry.joint.text in model.joint_by_name for entry in limits)


def collect_group_joints(model: Model, srdf: Srdf) -> dict[str, frozenset[str]]:
    """Collect the joints of each planning group with those of the groups in it: RobotModel::addJointModelGroup of MoveIt.

    Of groups that contain each other in a circle only some joints.

    :raises FactUnavailableError: when the tree is broken.
    """
    joints_by_group: dict[str, frozenset[str]] = {}
    visited: set[str] = set()
    stack = list(srdf.groups)[::-1]
    while stack:
        name = stack[-1]
        group = srdf.groups[name]
        inner = [e.get("name").strip() for e in group.find_children("group")]
        waiting = [other for other in inner if other in srdf.groups and other not in visited]
        if name not in visited and waiting:
            visited.add(name)
            stack += waiting
            continue
        visited.add(name)
        stack.pop()
        if name not in joints_by_group:
            joints_by_group[name] = collect_listed_joints(model, srdf, group).union(
                *(joints_by_group.get(other, frozenset()) for other in inner)
            )
    return joints_by_group


def collect_listed_joints(model: Model, srdf: Srdf, group: Element) -> frozenset[str]:
    """Collect the joints that a planning group names, those above its links and those along its chains.

    The joints of the groups in it are not among them.

    :raises FactUnavailableError: when the tree is broken.
    """
    joints = {e.get("name").strip() for e in group.find_children("joint")}
    for link in group.find_children("link"):
        joints |= _get_joint_above(model, srdf, link.get("name").strip())
    for chain in group.find_children("chain"):
        ends = [chain.get(end).strip() for end in ("base_link", "tip_link")]
        if all(end in model.link_by_name for end in ends):
            # A chain may lead over a common ancestor: the joints that are on only one of the two ways from the root.
            base, tip = ({joint.name for joint in model.tree.find_path_to(end)} for end in ends)
            joints |= base ^ tip
    return frozenset(joints)


def _get_joint_above(model: Model, srdf: Srdf, link: str) -> frozenset[str]:
    """Return the joint on which a link hangs; the virtual joints for the root."""
    joint = model.tree.parent_joint.get(link)
    return srdf.virtual_joints if joint is None else frozenset((joint.name,))


def compute_position_range(joint: Joint, limits: Mapping[str, JointLimits]) -> PositionRange | None:
    """Compute the range of a joint as MoveIt does: its limits, narrowed by its soft limits, replaced by joint_limits.yaml.

    None where it has no range, or one that is inverted or malformed.
    """
    if joint.type not in {"revolute", "prismatic"} or joint.limit is None:
        return None
    lower, upper, source = joint.get_limit_value("lower"), joint.get_limit_value("upper"), "its limit"
    safety = joint.element.find_child("safety_controller")
    if safety is not None and lower is not None and upper is not None:
        soft = [
            read_attribute_number(safety, f"soft_{end}_limit") if f"soft_{end}_limit" in safety.attributes else 0.0
            for end in ("lower", "upper")
        ]
        if soft[0] is None or soft[1] is None:
            return None
        if soft[0] > lower or soft[1] < upper:
            lower, upper, source = max(lower, soft[0]), min(upper, soft[1]), "its soft limit (safety_controller)"
    entry = limits.get(joint.name)
    if entry is not None:
        typed = entry.get_number("min_position"), entry.get_number("max_position")
        if typed != (None, None):
            lower, upper = (lower if typed[0] is None else typed[0]), (upper if typed[1] is None else typed[1])
            source = f"the limit in {LIMITS_FILE}"
    return None if lower is None or upper is None or lower >= upper else PositionRange(lower, upper, source)
