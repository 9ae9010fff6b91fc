"""The grammar of URDF as its reference parser reads it: which element stands where, and which attributes are numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from urdfcheck.source.xml import Element

# What urdfdom reads inside each element (URDF 1.0 to 1.2). A tag means the same wherever it may stand.
CHILDREN: Mapping[str, frozenset[str]] = {
    "robot": frozenset({"link", "joint", "material"}),
    "link": frozenset({"inertial", "visual", "collision"}),
    "inertial": frozenset({"origin", "mass", "inertia"}),
    "visual": frozenset({"origin", "geometry", "material"}),
    "collision": frozenset({"origin", "geometry"}),
    "geometry": frozenset({"box", "cylinder", "sphere", "mesh", "capsule"}),
    "material": frozenset({"color", "texture"}),
    "joint": frozenset(
        {"origin", "parent", "child", "axis", "calibration", "dynamics", "limit", "mimic", "safety_controller"}
    ),
}

# How many numbers each numeric attribute holds.
NUMBERS: Mapping[str, Mapping[str, int]] = {
    "origin": {"xyz": 3, "rpy": 3, "quat_xyzw": 4},
    "mass": {"value": 1},
    "inertia": {"ixx": 1, "ixy": 1, "ixz": 1, "iyy": 1, "iyz": 1, "izz": 1},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"scale": 3},
    "color": {"rgba": 4},
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "effort": 1, "velocity": 1, "acceleration": 1, "deceleration": 1, "jerk": 1},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "safety_controller": {"soft_lower_limit": 1, "soft_upper_limit": 1, "k_position": 1, "k_velocity": 1},
    "calibration": {"rising": 1, "falling": 1},
}


def elements(robot: Element) -> Iterator[Element]:
    """The elements of a robot that the reference parser reads, in document order; extensions are not entered."""
    stack = [robot]
    while stack:
        element = stack.pop()
        yield element
        allowed = CHILDREN.get(element.tag, frozenset())
        stack.extend(child for child in reversed(element.children) if child.tag in allowed)


def loss(element: Element) -> str:
    """What urdfdom does when an element cannot be read, as it does it today (checked with urdfdom 6).

    It stops reading a link at the first part that fails: inertial, then visuals, then collisions.
    """
    if element.tag in {"color", "texture"}:
        return "leaves the colour out"
    while element.parent is not None and element.parent.tag not in {"robot", "link"}:
        element = element.parent
    return {
        "inertial": "drops the inertial, and with it every visual and collision of the link",
        "visual": "drops every visual and collision of the link",
        "collision": "drops every collision of the link",
        "material": "leaves the material out",
    }.get(element.tag, "refuses the whole file")


def is_unexpanded(text: str) -> bool:
    """Whether a value still holds a substitution that only xacro resolves."""
    return "${" in text or "$(" in text
