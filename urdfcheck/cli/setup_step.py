"""What ``urdfcheck init`` does to a file."""

from __future__ import annotations

from pathlib import Path

from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupStep:
    """What happens to a file."""

    path: Path
    verb: str
    """wrote | extended | kept."""
    text: str | None = None
    """Its content afterwards; None where it stays as it is."""
    added: str = ""
    """The new part of the content."""
    reason: str = ""
    """Why it stays as it is."""
