"""Whether a robot works under water, where a part of each weight is carried."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import PurePosixPath

from urdfcheck.core.text import split_name_words
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import Element

_AFLOAT = re.compile(r"buoyan|hydrodynam|underwater", re.IGNORECASE)
# Words of names that a robot under water has: those of links, joints, plugins and mesh files.
_SUBMERSIBLE = frozenset(
    {
        "rov",
        "bluerov",
        "auv",
        "uuv",
        "thruster",
        "thrusters",
        "buoyancy",
        "submarine",
        "submersible",
        "subsea",
        "underwater",
        # Reach Robotics' arms for vehicles under water
        "bravo5",
        "bravo7",
    }
)


def has_buoyancy_plugin(model: Model) -> bool:
    """Whether a plugin makes the robot float."""
    return any(_AFLOAT.search(plugin.get("filename") + plugin.get("name")) for plugin in _list_plugins(model))


def find_submersible_name(model: Model) -> str | None:
    """Return a name by which the robot works under water, where a part of each weight is carried; None if there is none."""
    files = (shape.mesh_filename for link in model.links for shape in (*link.visuals, *link.collisions))
    names = (
        model.name,
        *(link.name for link in model.links),
        *(joint.name for joint in model.joints),
        *(PurePosixPath(file.value).stem for file in files if file is not None),
        *(plugin.get(key) for plugin in _list_plugins(model) for key in ("filename", "name")),
    )
    return next((name for name in names if not _SUBMERSIBLE.isdisjoint(_generate_words(name))), None)


def _generate_words(name: str) -> Iterator[str]:
    """Yield the words of a name in lower case, and each with the number that follows it: ``bravo7`` of ``Bravo 7``."""
    words = [word.lower() for word in split_name_words(name)]
    yield from words
    yield from (f"{word}{number}" for word, number in pairwise(words) if number.isdigit())


def _list_plugins(model: Model) -> list[Element]:
    return [plugin for gazebo in model.robot.find_children("gazebo") for plugin in gazebo.find_children("plugin")]
