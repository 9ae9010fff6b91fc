"""The names of the packages that ROS distributions have released: what rosdep may install although it is not here."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

# One name a line, with the generations of ROS that have it (1, 2 or 12); tools/list_released_packages.py writes it from
# github.com/ros/rosdistro.
NAMES = Path(__file__).with_name("ros_packages.txt")


@lru_cache(maxsize=3)
def read_released_packages(generation: int | None = None) -> frozenset[str]:
    """Return the names of all packages that a ROS distribution since Indigo has released; only those of ROS 1 or 2 with a
    ``generation``."""
    lines = (line.split() for line in NAMES.read_text(encoding="ascii").splitlines())
    return frozenset(name for name, generations in lines if generation is None or str(generation) in generations)
