"""What went wrong while a model was read, as plain records that the checks of the same kind turn into findings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from urdfcheck.core import Location


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """``kind`` names what happened; the check that reports it picks it by this name.

    ``related`` are the definitions that led there, nearest first.
    """

    kind: str
    message: str
    location: Location
    data: Mapping[str, Any] = field(default_factory=dict)
    related: tuple[Location, ...] = ()
