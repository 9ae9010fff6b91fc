"""Parts of published robots whose numbers other descriptions copy, often with a drawing of their own."""

from __future__ import annotations

import math

from urdfcheck.facts.arrays import Mat3

# Mass (kg) and moments (kg·m²), as typed in the description of the robot.
_PARTS = {
    (0.82573504, 2.2124416e-03, 2.1193702e-03, 2.0064271e-03): "the base of TurtleBot3 Burger",
    (1.3729096, 8.7002718e-03, 8.6195418e-03, 1.4612727e-02): "the base of TurtleBot3 Waffle",
    (1.3729096, 4.2111447e-02, 4.2111447e-02, 7.5254874e-02): "the base of TurtleBot3 Waffle",
    (2.8498940e-02, 1.1175580e-05, 1.1192413e-05, 2.0712558e-05): "a wheel of TurtleBot3",
}
# Numbers that were copied agree to six digits at least.
_COPIED = 1e-6


def name_published_part(mass: float, tensor: Mat3) -> str:
    """Name the part of a published robot that has this ``mass`` (kg) and ``tensor`` (3, 3) in kg·m²; empty where none has."""
    own = (mass, *tensor.diagonal().tolist())
    for numbers, name in _PARTS.items():
        if all(math.isclose(one, other, rel_tol=_COPIED) for one, other in zip(own, numbers, strict=True)):
            return name
    return ""
