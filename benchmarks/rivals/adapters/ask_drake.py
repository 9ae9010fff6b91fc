"""Drake's parser, and the plant finalized, without shapes: with them Drake refuses each robot that has STL files."""

from __future__ import annotations

from collections.abc import Iterator

from printed import capture_lines
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield why it refuses the file, and its warnings."""
    with capture_lines() as lines:
        try:
            _load(file)
            refused = ""
        except (RuntimeError, ValueError, SystemExit) as error:  # the last for a condition of its own that fails
            refused = " ".join(str(error).split())
    if refused:
        yield "error", "refused", "", refused
    for line in lines:
        if "warning" in line:
            yield "warning", "warning", "", line.partition("[warning]")[2].strip() or line


def _load(file: str) -> None:
    plant = MultibodyPlant(time_step=0.001)
    Parser(plant).AddModels(file)
    plant.Finalize()
