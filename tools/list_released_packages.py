"""Write the names of all released ROS packages: ``python tools/list_released_packages.py CHECKOUT``.

``CHECKOUT``: a clone of https://github.com/ros/rosdistro, whose ``distribution.yaml`` files list the packages of each repository.
"""

from __future__ import annotations

import sys
from pathlib import Path

import yaml

from urdfcheck.source.package.released_packages import NAMES

DISTRIBUTIONS = (
    *("indigo", "kinetic", "melodic", "noetic"),
    *("foxy", "galactic", "humble", "iron", "jazzy", "kilted", "rolling"),
)


def collect_names(checkout: Path) -> set[str]:
    """Collect the names of the packages of all released repositories; one without a list is a package itself."""
    names: set[str] = set()
    for distribution in DISTRIBUTIONS:
        index = yaml.safe_load((checkout / distribution / "distribution.yaml").read_text(encoding="utf-8"))
        for repository, entry in index["repositories"].items():
            if release := entry.get("release"):
                names.update(release.get("packages", [repository]))
    return names


if __name__ == "__main__":
    NAMES.write_text("\n".join(sorted(collect_names(Path(sys.argv[1])))) + "\n", encoding="ascii")
