"""Robots whose two driven wheels have names that say neither wheel nor side."""

from __future__ import annotations

import re
from copy import deepcopy
from dataclasses import replace

from defects import list_driven
from made import MobileRobot


def rename_wheels(robot: MobileRobot) -> MobileRobot | None:
    """Return the robot with other names for its two driven wheels, wherever they are written; None where it has more wheels."""
    if len(list_driven(robot)) != 2:
        return None
    root, names = deepcopy(robot.root), {}
    for joint in root.findall("joint"):
        child = joint.find("child")
        if child is not None and joint.get("name") in {robot.left, robot.right}:
            new = "rad_a" if joint.get("name") == robot.left else "rad_b"
            names |= {child.get("link", ""): new, joint.get("name", ""): f"{new}_joint"}
    for element in root.iter():
        element.attrib |= {key: names[value] for key, value in element.attrib.items() if value in names}
        if element.text and element.text.strip() in names:
            element.text = names[element.text.strip()]
    words = re.compile("|".join(rf"\b{re.escape(name)}\b" for name in names))
    files = {
        path: words.sub(lambda match: names[match[0]], content) if isinstance(content, str) else content
        for path, content in robot.files.items()
    }
    return replace(robot, root=root, files=files, left=names[robot.left], right=names[robot.right])
