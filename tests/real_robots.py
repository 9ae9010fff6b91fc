"""The robots of a folder that URDFCHECK_CORPUS names."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

# Expands only when it is started in its own folder: its includes are relative to the working directory.
STARTED_ELSEWHERE = {"kosakanishkdev/ROS:robot"}


def list_robots(folder: Path) -> list[dict[str, Any]]:
    """The entries of ``corpus.json`` that can be checked as they lie there.

    Left out: `STARTED_ELSEWHERE`, and robots of which a package was not collected.
    """
    entries: list[dict[str, Any]] = json.loads((folder / "corpus.json").read_text(encoding="utf-8"))
    return [
        entry
        for entry in entries
        if entry["id"] not in STARTED_ELSEWHERE and all((folder / root).is_dir() for root in entry["package_roots"])
    ]


def list_repositories(folder: Path) -> list[Path]:
    """The repositories in a folder without a ``corpus.json``."""
    return sorted(path for path in folder.iterdir() if path.is_dir())
