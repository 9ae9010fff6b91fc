"""What the names of links and joints say about wheels."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.model.parts import Joint

WHEEL_NAME = re.compile(r"wheel|tyre|tire", re.IGNORECASE)
# A part that carries a wheel is named after it and turns about another axis.
WHEEL_CARRIER_NAME = re.compile(
    r"steer|swivel|rotation|holder|fork|mount|bracket|knuckle|arm|leg|rocker|bogie|susp|axle", re.IGNORECASE
)
CASTER_NAME = re.compile(r"cast[eo]r", re.IGNORECASE)
# Wheels that turn freely, or are not wheels of a vehicle, or do not touch the ground.
NOT_DRIVEN_NAME = re.compile(r"caster|castor|roller|steer|swivel|fly_?wheel|reaction|momentum|spare", re.IGNORECASE)
# Wheels inside a track: the track stands on the ground, and its sprockets are often above it on purpose.
TRACK_NAME = re.compile(r"sprocket", re.IGNORECASE)
# Parts that turn freely by their names: no motor and no encoder has their zero.
PASSIVE_NAME = re.compile(r"passive|idler?(?![a-z])|roller", re.IGNORECASE)


def is_revolute_wheel(joint: Joint) -> bool:
    """Whether a revolute joint is a wheel's, by its name or its child's, and not that of what carries the wheel."""
    words = f"{joint.name} {joint.child}"
    return joint.type == "revolute" and bool(WHEEL_NAME.search(words)) and not WHEEL_CARRIER_NAME.search(words)
