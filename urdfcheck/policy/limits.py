"""How much time and memory the check of one model may take."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ResourceLimits:
    """``seconds`` of the clock for one model, launch file or package; ``memory`` in MiB for the process that checks it.

    The defaults are generous: of 110 robots none took 4 seconds or 220 MiB, without a cache.
    """

    seconds: float = 300.0
    memory: int = 4096
