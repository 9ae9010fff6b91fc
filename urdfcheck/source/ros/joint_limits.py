"""``joint_limits.yaml`` of a MoveIt configuration: limits for planning that replace those of the model."""

from __future__ import annotations

from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.ros.yaml_files import read_located_yaml
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue

# Above joint_limits are only the names of parameters' owners: /**, ros__parameters, robot_description_planning.
_MOST_LEVELS = 4
_PARAMETERS, _PLANNING = "ros__parameters", "robot_description_planning"


@dataclass(frozen=True, slots=True, eq=False)
class JointLimits:
    """The settings of one joint. ``joint`` is its name as typed, ``entry`` the settings."""

    joint: YamlValue
    entry: YamlValue

    def get_setting(self, name: str) -> YamlValue | None:
        """Return one setting: ``max_velocity`` …"""
        return self.entry.get(name)

    def get_number(self, name: str) -> float | None:
        """Return a setting as a number; None if it is not set, or not a plain number."""
        value = self.entry.get(name)
        return None if value is None else value.number

    def is_on(self, flag: str) -> bool:
        """Whether ``has_velocity_limits`` or the like is set, and not to no."""
        value = self.entry.get(flag)
        return value is not None and not value.is_false

    def is_off(self, flag: str) -> bool:
        """Whether ``has_velocity_limits`` or the like is set to no."""
        value = self.entry.get(flag)
        return value is not None and value.is_false


def read_joint_limits(path: Path, finder: PackageFinder) -> tuple[JointLimits, ...]:
    """Read the joints of a file in order; none if it is not such a file, cannot or may not be read, or MoveIt does not find them:
    in a file of parameters it reads those below ``robot_description_planning`` only."""
    try:
        value = read_located_yaml(path, finder)
    except YamlReadError:
        return ()
    owners: list[str] = []
    for _ in range(_MOST_LEVELS):
        limits = None if value is None else value.get("joint_limits")
        if limits is not None:
            if _PARAMETERS in owners and _PLANNING not in owners:
                return ()
            return tuple(JointLimits(joint, entry) for joint, entry in limits.entries if entry.is_mapping)
        below = [] if value is None else [(key.text, inner) for key, inner in value.entries if inner.is_mapping]
        if len(below) != 1:
            return ()
        owners.append(below[0][0])
        value = below[0][1]
    return ()
