"""The variables that every shell of ROS sets, for models that are expanded where ROS is not installed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from urdfcheck.source.package.finder import Package
from urdfcheck.source.text.problems import IN_EXPRESSION, Problem
from urdfcheck.source.xacro.ros_variables import FIRST_GENERATION, KNOWN_VARIABLES, VARIABLE
from urdfcheck.system.observing.questions import read_variable

_UNSET = re.compile(r"environment variable '([^']*)' is not set")
# The distribution of each version of ROS that is used most; of the first, the last one.
_DISTRIBUTIONS = {"1": "noetic", "2": "jazzy"}


def find_unset_variable(problems: Iterable[Problem]) -> str | None:
    """Return the variable of ROS without which an expansion stopped, as the name of an argument; None if it did not."""
    for problem in problems:
        match = _UNSET.match(problem.message.split(IN_EXPRESSION)[0]) if problem.kind == "expansion-failed" else None
        if match is not None and match[1] in KNOWN_VARIABLES:
            return f"{VARIABLE}{match[1]}"
    return None


def choose_variable(name: str, arguments: Mapping[str, str], package: Package | None) -> str:
    """Return the value of a variable of ROS that is not set, such as fits those that are set, and the package.

    ``name``: as :func:`find_unset_variable` returns it.
    """
    version = _find_version(arguments) or _find_version_of_package(package)
    values = {"ROS_DISTRO": _DISTRIBUTIONS[version], "ROS_VERSION": version, "ROS_PYTHON_VERSION": "3"}
    return values[name.removeprefix(VARIABLE)]


def _find_version(arguments: Mapping[str, str]) -> str:
    """Return the version of ROS that the variables say, which are set or given; empty if none does."""
    version, distribution = (
        arguments.get(f"{VARIABLE}{name}") or read_variable(name) or "" for name in ("ROS_VERSION", "ROS_DISTRO")
    )
    if version not in _DISTRIBUTIONS and distribution:
        version = "1" if distribution in FIRST_GENERATION else "2"
    return version if version in _DISTRIBUTIONS else ""


def _find_version_of_package(package: Package | None) -> str:
    """Return 1 for a package that only catkin builds, else 2: one that both build is for both."""
    root = None if package is None else package.root
    texts = [] if root is None else [e.text.strip() for e in root.walk() if e.tag in {"buildtool_depend", "build_type"}]
    is_first = "catkin" in texts and not any(text.startswith("ament") for text in texts)
    return "1" if is_first else "2"
