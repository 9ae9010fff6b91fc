"""SRD005 reports joints that MoveIt 2 plans for and that have no acceleration limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.planning_limits import (
    LIMITS_FILE,
    collect_group_joints,
    list_own_srdfs,
    load_joint_limits,
)
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.ros.joint_limits import JointLimits
from urdfcheck.source.ros.srdf import Srdf
from urdfcheck.system.files import read_regular

# The pipeline's file, with the adapters that MoveIt runs; without one, moveit_configs_utils takes its own.
_PIPELINE, _TIMING = "ompl_planning.yaml", "TimeOptimal"
_MOVING = frozenset({"revolute", "continuous", "prismatic"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    checked: set[Path] = set()
    for srdf in list_own_srdfs(model):
        folder = srdf.path.parent
        if folder in checked or not _is_for_ros_2(srdf, model.source.finder):
            continue
        checked.add(folder)
        limits = {entry.joint.text: entry for entry in load_joint_limits(model, srdf)}
        if limits and _times_trajectories(folder, model.source.finder):
            yield from _check_limits(model, rule, srdf, limits)


def _is_for_ros_2(srdf: Srdf, finder: PackageFinder) -> bool:
    package = finder.find_package_of(srdf.path.absolute())
    return package is not None and package.depends_on_ament


def _times_trajectories(folder: Path, finder: PackageFinder) -> bool:
    """Whether the pipeline runs AddTimeOptimalParameterization, as far as its file says."""
    for path in (folder / _PIPELINE, folder.parent / _PIPELINE):
        if finder.can_open(path):
            try:
                return _TIMING in read_regular(path).decode("utf-8", "replace")
            except OSError:
                continue
    return True


def _check_limits(model: Model, rule: Rule, srdf: Srdf, limits: Mapping[str, JointLimits]) -> Iterator[Finding]:
    """Report the joints of planning groups whose acceleration has no limit."""
    passive = {e.get("name").strip() for e in srdf.root.find_children("passive_joint")}
    planned = frozenset().union(*collect_group_joints(model, srdf).values()) - passive
    joints = [j.name for j in model.joints if j.name in planned and j.type in _MOVING and j.mimic is None]
    prefix = _find_prefix(joints, limits)
    if prefix is not None:
        first = next(entry for name, entry in limits.items() if prefix + name in joints)
        yield rule.finding(
            "prefix", at=first.joint, prefix=prefix, name=first.joint.text, count=len(limits), file=LIMITS_FILE
        )
        return
    known = [name for name in joints if name in limits]
    if 2 * len(known) < len(limits):
        return  # it is for another robot
    missing = [name for name in joints if not _has_limit(limits.get(name))]
    if not missing:
        return
    places = [_locate_missing(limits[name]) for name in missing if name in limits]
    yield rule.finding(
        "missing",
        at=places[0] if places else next(iter(limits.values())).joint.location,
        related=places[1:],
        joints=join_names(missing),
        count=len(missing),
        noun="joint" if len(missing) == 1 else "joints",
    )


def _has_limit(entry: JointLimits | None) -> bool:
    """Whether MoveIt takes an acceleration limit from an entry: only where the flag is yes."""
    flag = None if entry is None else entry.get_setting("has_acceleration_limits")
    if entry is None or flag is None or flag.is_false:
        return False
    return entry.get_setting("max_acceleration") is not None


def _locate_missing(entry: JointLimits) -> Location:
    """Return the place of the flag, or of the joint's name without one."""
    return (entry.get_setting("has_acceleration_limits") or entry.joint).location


def _find_prefix(joints: list[str], limits: Mapping[str, JointLimits]) -> str | None:
    """Return the prefix that makes the names of all limits those of joints, if none of them is one as it is."""
    if len(limits) < 2 or any(name in limits for name in joints):
        return None
    first = next(iter(limits))
    for prefix in (name.removesuffix(first) for name in joints if name.endswith(first)):
        if all(prefix + name in joints for name in limits):
            return prefix
    return None
