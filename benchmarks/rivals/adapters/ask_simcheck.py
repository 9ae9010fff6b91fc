"""simcheck by default, with MuJoCo, which is the engine that its distribution installs."""

from __future__ import annotations

from collections.abc import Iterator

import ask_simcheck_static


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield what it reports."""
    yield from ask_simcheck_static.ask(file, ("mujoco",))
