"""yourdfpy: its loader with meshes, and its own ``validate``."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import yourdfpy


class _Kept(logging.Handler):
    """Keeps what is logged."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.records: list[logging.LogRecord] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.records.append(record)


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield why it refuses the file, what it logs at warning or above, and the errors of its validation."""
    kept = _Kept()
    logging.getLogger().addHandler(kept)
    try:
        model = yourdfpy.URDF.load(file, load_collision_meshes=True)
    except Exception as error:  # whatever its parser or its mesh library raises
        yield "error", "refused", "", f"{type(error).__name__}: {error}"
        return
    finally:
        logging.getLogger().removeHandler(kept)
    if not model.validate():
        for found in model.errors:
            yield "error", "validate", "", str(found)
    for record in kept.records:
        severity = "error" if record.levelno >= logging.ERROR else "warning"
        yield severity, "log", "", " ".join(record.getMessage().split())
