"""The names of the packages that ROS distributions have released: what rosdep may install although it is not here."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

# One name a line; tools/list_released_packages.py writes it from github.com/ros/rosdistro.
NAMES = Path(__file__).with_name("ros_packages.txt")


@lru_cache(maxsize=1)
def read_released_packages() -> frozenset[str]:
    """Return the names of all packages that a ROS distribution since Indigo has released."""
    return frozenset(NAMES.read_text(encoding="ascii").split())
