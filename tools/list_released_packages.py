"""Write the names of all released ROS packages: ``python tools/list_released_packages.py CHECKOUT``.

``CHECKOUT``: a clone of https://github.com/ros/rosdistro, whose ``distribution.yaml`` files list the packages of each repository.
"""

from __future__ import annotations

import sys
from pathlib import Path

import yaml

from urdfcheck.source.package.released_packages import NAMES

DISTRIBUTIONS = {
    1: ("indigo", "kinetic", "melodic", "noetic"),
    2: ("foxy", "galactic", "humble", "iron", "jazzy", "kilted", "rolling"),
}


def collect_names(checkout: Path) -> dict[str, set[int]]:
    """Collect the packages of all repositories, each with the generations of ROS that have it.

    A repository without a list of packages is a package itself, also if only its documentation is listed.
    """
    names: dict[str, set[int]] = {}
    for generation, distributions in DISTRIBUTIONS.items():
        for distribution in distributions:
            index = yaml.safe_load((checkout / distribution / "distribution.yaml").read_text(encoding="utf-8"))
            for repository, entry in index["repositories"].items():
                for name in (entry.get("release") or {}).get("packages", [repository]):
                    names.setdefault(name, set()).add(generation)
    return names


if __name__ == "__main__":
    found = collect_names(Path(sys.argv[1]))
    lines = (f"{name} {''.join(map(str, sorted(found[name])))}" for name in sorted(found))
    NAMES.write_text("\n".join(lines) + "\n", encoding="ascii")
