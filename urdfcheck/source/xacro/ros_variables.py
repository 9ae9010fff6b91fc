"""The variables that every shell of ROS sets, and by which a xacro decides."""

from __future__ import annotations

from collections.abc import Mapping

# What the name of an argument begins with that stands for a variable of the environment: `env:ROS_DISTRO`.
VARIABLE = "env:"
# The distributions of ROS that are or were in use, and what they set.
KNOWN_VARIABLES: Mapping[str, tuple[str, ...]] = {
    "ROS_DISTRO": ("noetic", "humble", "jazzy", "kilted", "lyrical", "rolling"),
    "ROS_PYTHON_VERSION": ("3", "2"),
    "ROS_VERSION": ("2", "1"),
}
FIRST_GENERATION = frozenset({"noetic"})
