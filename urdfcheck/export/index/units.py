"""The units in which URDF means its numbers."""

from __future__ import annotations

import re

_ATTRIBUTE = re.compile(r"(?:.*/)?([\w:-]+)(?:\[[^\[\]]*\])?@([\w:-]+)")
_TENSOR = dict.fromkeys((("inertia", name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")), "kg·m²")
_UNITS = {
    **_TENSOR,
    ("mass", "value"): "kg",
    ("origin", "xyz"): "m",
    ("origin", "rpy"): "rad",
    ("box", "size"): "m",
    ("sphere", "radius"): "m",
    **{(shape, name): "m" for shape in ("cylinder", "capsule") for name in ("radius", "length")},
}
# Of a joint that turns, and of one that slides.
_JOINT_UNITS = {
    **{("limit", name): ("rad", "m") for name in ("lower", "upper")},
    ("limit", "effort"): ("N·m", "N"),
    ("limit", "velocity"): ("rad/s", "m/s"),
    ("dynamics", "damping"): ("N·m·s/rad", "N·s/m"),
    ("dynamics", "friction"): ("N·m", "N"),
    ("mimic", "offset"): ("rad", "m"),
    ("safety_controller", "soft_lower_limit"): ("rad", "m"),
    ("safety_controller", "soft_upper_limit"): ("rad", "m"),
}
_TURNING, _SLIDING = frozenset({"revolute", "continuous"}), "prismatic"


def find_unit(subject: str, joint_type: str = "") -> str:
    """Return the unit of an attribute: ``kg`` of ``link[arm]/inertial/mass@value``; empty where it has none.

    ``joint_type``: of the joint that the attribute belongs to, without which some units are not known.
    """
    match = _ATTRIBUTE.fullmatch(subject)
    key = ("", "") if match is None else (match[1], match[2])
    if joint_type in _TURNING or joint_type == _SLIDING:
        return _UNITS.get(key) or _JOINT_UNITS.get(key, ("", ""))[joint_type == _SLIDING]
    return _UNITS.get(key, "")
