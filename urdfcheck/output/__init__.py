"""Renderers: each module has ``render(run) -> str`` and sees a Run, never a Model."""

from __future__ import annotations

import importlib

# Type checkers take it for typing's, whose import takes a fifth of the time of --help.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from urdfcheck.core import Run

FORMATS = ("text", "concise", "agent", "json", "html", "sarif", "github", "gitlab", "junit", "rdjson", "markdown")
# A picture can only be written to a file.
PICTURE_FORMAT = "png"
# Formats that draw something: they need the scenes of a run.
DRAWING_FORMATS = frozenset({"html", "markdown", PICTURE_FORMAT})


def render(run: Run, output_format: str) -> str:
    """Render the run in a format of :data:`FORMATS`, whose module is imported only now."""
    rendered: str = importlib.import_module(f"urdfcheck.output.{output_format}").render(run)
    return rendered


def render_picture(run: Run) -> bytes:
    """Render the one model of a run as a :data:`PICTURE_FORMAT`.

    :raises UrdfcheckError: when there are several models, or none that can be drawn.
    """
    from urdfcheck.output import png

    return png.render(run)
